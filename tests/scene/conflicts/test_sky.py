"""What a sky does not go together with, in a sentence at its place."""

from __future__ import annotations

import pytest

from sailviz.errors import SceneError
from sailviz.scene.loading import load_scene

EARTH = {
    "title": "t",
    "body": "earth",
    "start": {"kind": "circular", "altitude_km": 1000},
    "propagation": {"duration_d": 10},
    "device": {"kind": "solar-sail", "area_m2": 32, "mass_kg": 5},
    "epoch": "2026-03-20",
}
SUN = {**EARTH, "body": "sun", "start": {"kind": "circular", "radius_au": 1}}
OWN = {**EARTH, "body": {"name": "Altaira", "mu_km3_s2": 1.4e11}, "start": {"kind": "circular", "radius_au": 1}}
ELECTRIC = {"kind": "electric-sail", "characteristic_acceleration_mm_s2": 0.3}
AIR = {"kind": "exponential", "density_kg_m3": 1e-14, "scale_height_km": 90}


def around(**parts):
    return {"environment": parts}


def law(kind, **more):
    return {"steering": {"kind": kind, **more}}


REFUSED = [
    (EARTH, around(gravity_of=["earth"]), "environment.gravity_of", "the central body pulls already"),
    (EARTH, around(gravity_of=["earth-moon"]), "environment.gravity_of", "the central body pulls already"),
    (SUN, around(gravity_of=["sun"]), "environment.gravity_of", "the central body pulls already"),
    (SUN, around(gravity_of=["earth-moon", "moon"]), "environment.gravity_of", "both together"),
    (SUN, around(gravity_of=["moon", "moon"]), "environment.gravity_of", "twice"),
    (OWN, around(gravity_of=["mars"]), "environment.gravity_of", "where Altaira is among the planets is not known"),
    (SUN, around(gravity_of=["mars"], third_body={}), "environment.gravity_of", "one sky at a time"),
    (SUN, around(gravity_of=["plato"]), "environment.gravity_of[0]", "not allowed here"),
    (SUN, around(gravity_of=[]), "environment.gravity_of", "needs 1 or more"),
    ({**SUN, "epoch": None}, around(gravity_of=["mars"]), "epoch", "where the bodies stand needs a date: epoch"),
    ({**EARTH, "epoch": None}, around(shadow_of=["moon"]), "epoch", "needs a date"),
    ({**EARTH, "epoch": None, "body": "mars"}, {}, "epoch", "as seen from mars needs a date"),
    (EARTH, around(third_body={}), "environment.third_body", "goes round the Sun"),
    (EARTH, around(shadow_of=["sun"]), "environment.shadow_of", "the Sun is the light"),
    (SUN, around(shadow_of=["earth-moon"]), "environment.shadow_of", "earth-moon has no radius"),
    ({**EARTH, "device": {"kind": "none"}}, around(shadow_of=["moon"]), "environment.shadow_of", "from a solar sail"),
    (EARTH, {"ephemeris": "de422"}, "ephemeris", 'Did you mean "de421"'),
    (EARTH, {"ephemeris": "mine.bsp"}, "ephemeris", "there is no file"),
    (EARTH, {"ephemeris": "../mine.bsp"}, "ephemeris", "leads out of the folder"),
    (EARTH, {"ephemeris": "de421", "epoch": "2060-01-01"}, "ephemeris", "1899 to 2053; this run goes beyond"),
    (SUN, {"frame": "equator-of-date"}, "frame", 'known for body = "earth"'),
    (EARTH, {"frame": "icrf", **around(j2=True)}, "environment.j2", "counts from the Earth's equator"),
    (EARTH, {"frame": "icfr"}, "frame", 'Did you mean "icrf"'),
    (EARTH, law("orbital", pitch_deg=30), "steering.kind", 'from the Sun line: kind = "sun-frame"'),
    (EARTH, law("meridian", pitch_deg=30), "steering.kind", "from the Sun line"),
    (EARTH, law("optimal", costates=[1, 1, 1]), "steering.kind", "was solved for light at the centre"),
    (OWN, law("optimal", costates=[1, 1, 1]), "steering.kind", "was solved for light at the centre"),
    (
        {**OWN, "device": ELECTRIC}, law("smoothed-transfer", radius_au=1.5, costates=[1.0, 1.0, 1.0]),
        "steering.kind", "was solved for light at the centre",
    ),
    (
        OWN, {"start": {"kind": "displaced", "radius_au": 0.9, "elevation_deg": 10, "rate_ratio": 1}}, "start.kind",
        "was solved for light at the centre",
    ),
    (EARTH, {"ensemble": [{"name": "a"}]}, "ensemble[0]", "a solar sail or an electric sail round the Sun"),
    (SUN, {"ensemble": [{"name": "a"}], **around(gravity_of=["mars"])}, "ensemble[0]", "no gravity but the Sun's"),
    (OWN, {"start": {"kind": "heliostationary", "radius_au": 1}}, "start.kind", "was solved for light at the centre"),
    (EARTH, {"approximation": [{"kind": "first-order"}]}, "approximation[0]", "was solved for light at the centre"),
    (
        EARTH, law("locally-optimal", goal="energy", minimum_perigee_km=300), "steering.minimum_perigee_km",
        "counts from the centre",
    ),
    (EARTH, law("locally-optimal", goal="energy", margin_km=300), "steering", "give that too"),
    (EARTH, law("radial", in_shadow="edge-on"), "steering", "steered by the light"),
    (EARTH, law("locally-optimal", goal="perige"), "steering.goal", 'Did you mean "perigee"'),
    (EARTH, around(magnetosphere="none"), "environment.magnetosphere", "from an electric sail"),
    ({**SUN, "device": ELECTRIC}, around(magnetosphere="shue-1998"), "environment.magnetosphere", "is the Earth's"),
    (
        {**EARTH, "device": ELECTRIC}, around(solar_wind={"kind": "gamma", "shape": 2.0, "scale_nPa": 1.0, "seed": 3}),
        "environment.magnetosphere", "nominal wind",
    ),
    (EARTH, {"device": {**ELECTRIC, "mass_kg": 5, "drag_area": "attitude"}, **around(atmosphere=AIR)},
     "device.drag_area", "for a solar sail that gives its area"),
    (EARTH, {"device": {**EARTH["device"], "edge_area_m2": 1}}, "device.edge_area_m2", 'drag_area = "attitude"'),
    (OWN, {"light": {"kind": "ephemeris"}}, "light.kind", "is not known"),
    (
        OWN, {"light": {"kind": "fixed", "direction": [1, 0, 0], "distance_au": 1},
              "device": {"kind": "solar-sail", "lightness_number": 0.1}},
        "device.lightness_number", "light.mu",
    ),
    (EARTH, {"light": {"kind": "fixed"}}, "light", "needs direction"),
    (EARTH, {"light": {"kind": "centre", "longitude_deg": 3}}, "light", "belongs to kind"),
    (EARTH, {"light": {"kind": "center"}}, "light.kind", 'Did you mean "centre"'),
    ({**SUN, "device": {"kind": "none"}}, {"light": {"kind": "centre"}}, "light.kind", "light pushes a sail"),
]  # fmt: skip


@pytest.mark.parametrize(("base", "change", "place", "words"), REFUSED)
def test_what_a_sky_does_not_go_together_with_is_said_where_it_stands(base, change, place, words):
    given = {key: value for key, value in {**base, **change}.items() if value is not None}
    with pytest.raises(SceneError) as caught:
        load_scene(given)
    found = {fault.where: f"{fault.what} {fault.hint}" for fault in caught.value.faults}
    assert words in found.get(place, ""), found


@pytest.mark.parametrize(
    "change",
    [
        {},
        {"body": "moon", "start": {"kind": "circular", "altitude_km": 1000}, **around(gravity_of=["earth", "sun"])},
        {"body": "saturn", "start": {"kind": "circular", "altitude_km": 100_000}},
        {"ephemeris": "series"},
        {"frame": "ecliptic-j2000", **around(gravity_of=["moon"], shadow_of=["earth", "moon"])},
        {"light": {"kind": "fixed", "direction": [0, 0, 1], "distance_au": 1}},
        law("sun-frame", pitch_deg=20, clock_deg=30, reference="orbit"),
        law("lyapunov", semi_major_axis_km=9000, in_shadow="edge-on"),
        {"device": {**EARTH["device"], "drag_area": "attitude", "edge_area_m2": 0.1}, **around(atmosphere=AIR)},
    ],
)
def test_what_goes_together_is_taken(change):
    load_scene({**EARTH, **change})


def test_a_kernel_that_is_not_installed_is_named_with_its_extra(monkeypatch):
    from sailviz.scene.conflicts import moments

    monkeypatch.setattr(moments, "find_spec", lambda name: None)
    with pytest.raises(SceneError, match=r'extra "ephemeris": pip install "sailviz\[ephemeris\]"'):
        load_scene({**EARTH, "ephemeris": "de421"})


def test_the_series_go_by_two_names_and_are_one():
    first, second = (load_scene({**EARTH, "ephemeris": name}) for name in ("series", "mean-elements"))
    assert first.identity() == second.identity()


def test_scenes_without_a_sky_are_what_they_were():
    resolved = load_scene("displaced/circular").resolved()
    assert "light" not in resolved
    assert "frame" not in resolved
    assert not {"gravity_of", "shadow_of", "magnetosphere"} & set(resolved["environment"])
    assert resolved["environment"]["shadow"] == "cylinder"
