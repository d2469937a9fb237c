"""Each kind of section has its record of facts, and what does not fit together is said in a sentence."""

from __future__ import annotations

from datetime import date
from typing import Annotated, get_args, get_origin

import pytest
from pydantic import BaseModel

from sailviz.errors import SceneError
from sailviz.scene import device, environment, sections, start, steering
from sailviz.scene.conflicts import moments
from sailviz.scene.conflicts.approximations import APPROXIMATIONS
from sailviz.scene.conflicts.devices import CONTROLS, DEVICES
from sailviz.scene.conflicts.ensembles import ENSEMBLES
from sailviz.scene.conflicts.starts import STARTS
from sailviz.scene.conflicts.steerings import STEERINGS
from sailviz.scene.conflicts.surroundings import ATMOSPHERES, IONOSPHERES, IRRADIANCES, WINDS
from sailviz.scene.loading import load_scene
from sailviz.scene.units_in_keys import words_of_kind


def classes(annotation) -> set[type[BaseModel]]:
    """Section classes of a union, however deeply."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return {annotation}
    parts = get_args(annotation)[:1] if get_origin(annotation) is Annotated else get_args(annotation)
    return {found for part in parts for found in classes(part)}


def field(model, name):
    return classes(model.model_fields[name].annotation)


@pytest.mark.parametrize(
    ("union", "records"),
    [
        (classes(start.Start), STARTS),
        (field(device.SolarSail, "control") | field(device.ElectricSail, "control"), CONTROLS),
        (field(sections.Ensemble, "control"), CONTROLS),
        (classes(environment.Winds), WINDS),
        (field(environment.Environment, "irradiance"), IRRADIANCES),
        (field(environment.Environment, "ionosphere"), IONOSPHERES),
        (field(environment.Environment, "atmosphere"), ATMOSPHERES),
        (classes(sections.Approximation), APPROXIMATIONS),
        ({sections.Ensemble, sections.Chaos}, ENSEMBLES),
    ],
)
def test_each_kind_of_section_has_a_record_and_no_record_is_of_nothing(union, records):
    assert union == set(records)


def test_no_facts_are_of_a_device_or_a_steering_that_is_not_there():
    """One that says nothing has those of OTHER_DEVICE and OTHER_STEERING."""
    words = {word for kind in classes(steering.Steering) for word in words_of_kind(kind)}
    assert set(STEERINGS) <= words
    assert set(DEVICES) <= classes(device.Devices)


SUN = {"title": "t", "start": {"kind": "circular", "radius_au": 1}, "propagation": {"duration_d": 10}}
EARTH = {**SUN, "body": "earth", "start": {"kind": "circular", "altitude_km": 700}}
SAIL = {"kind": "solar-sail", "lightness_number": 0.05}
ELECTRIC = {"kind": "electric-sail", "characteristic_acceleration_mm_s2": 0.5}
THRUSTER = {"kind": "thruster", "acceleration_mm_s2": 0.1}
BRAKE = {"kind": "plasma-brake", "mass_kg": 10, "tether_length_km": 5}
FORCE = {"kind": "exponential-force", "force_per_length_nN_m": 10, "scale_height_km": 100}
TABLE = {"kind": "iri-2020"}
GAMMA = {"kind": "gamma", "shape": 2.0, "scale_nPa": 1.0, "seed": 3}
SPIRAL = {"kind": "spiral", "radius_au": 1}
HELD = {"kind": "displaced", "radius_au": 0.9, "elevation_deg": 5, "rate_ratio": 1}
TRACK = {"kind": "planet-following", "planet": "earth", "elevation_deg": 2}
MANY = {"name": "many"}


def law(kind, **more):
    return {"steering": {"kind": kind, **more}}


def around(**parts):
    return {"environment": parts}


CONFLICTS = [  # base, what is changed, place, the words that say why
    (EARTH, {"device": SAIL, **law("orbital", pitch_deg=30)}, "steering.kind", "is steered from the Sun line"),
    (SUN, {"device": THRUSTER}, "steering.kind", "a thruster needs a direction"),
    (SUN, {"device": SAIL, **law("tangential")}, "steering.kind", "a thruster's law"),
    (SUN, {"device": THRUSTER, **law("locally-optimal", goal="energy")}, "steering.kind", "steers a solar sail"),
    (
        SUN,
        {
            "device": SAIL,
            "start": {"kind": "circular", "radius_au": 1, "inclination_deg": 1},
            **law("optimal", costates=[1, 0.1, 1]),
        },
        "steering.costates",
        "planar flight",
    ),
    (SUN, {"device": SAIL, **law("as designed")}, "steering.kind", "displaced, heliostationary, lagrange-point"),
    (SUN, {"device": THRUSTER, **law("radial"), "start": HELD}, "start.kind", "held by a solar sail"),
    (SUN, {"device": {**ELECTRIC, "model": "updated"}, "start": HELD}, "device.model", '"final" model'),
    (SUN, {"device": SAIL, "start": TRACK}, "start.kind", 'steering "as designed"'),
    (EARTH, {"device": {"kind": "none"}, "target": {"planet": "mars"}}, "target.planet", "goes round the Sun"),
    (EARTH, {"device": {"kind": "none"}, **around(third_body={})}, "environment.third_body", "goes round the Sun"),
    (SUN, {"device": ELECTRIC, "start": SPIRAL}, "start.kind", "flown by a solar sail"),
    (SUN, {"device": SAIL, "start": SPIRAL}, "steering.kind", "needs a fixed pitch"),
    (SUN, {"device": SAIL, "start": SPIRAL, **law("orbital", pitch_deg=30)}, "steering.clock", "clock_deg = 90"),
    (
        SUN,
        {"device": SAIL, **law("smoothed-transfer", radius_au=1.5, costates=[1, 0.1, 1])},
        "steering.kind",
        "flown by an electric sail",
    ),
    (SUN, {"device": SAIL, "approximation": [{"kind": "quasi-circular"}]}, "approximation[0]", "circular orbit"),
    (SUN, {"device": SAIL, "approximation": [{"kind": "first-order"}] * 2}, "approximation[1].name", "the same name"),
    (SUN, {"device": {**ELECTRIC, "model": "original"}, "ensemble": [MANY]}, "ensemble[0]", "falls as 1/r"),
    (SUN, {"device": SAIL, "ensemble": [MANY]}, "ensemble[0].name", "in steady sunlight"),
    (SUN, {"device": ELECTRIC, "ensemble": [MANY]}, "ensemble[0].name", "in a steady wind"),
    (SUN, {"device": ELECTRIC, "chaos": [MANY]}, "environment.solar_wind", "one gamma-distributed pressure"),
    (SUN, {"device": ELECTRIC, "ensemble": [{**MANY, "control": {"kind": "electrochromic"}}]},
     "ensemble[0].control", "controls its voltage"),
    ({**EARTH, **around(ionosphere=TABLE, solar_flux_sfu=100)}, {"device": BRAKE, "ensemble": [MANY]},
     "ensemble[0]", "round the Sun"),
    (SUN, {"device": SAIL, **around(solar_wind=GAMMA)}, "environment.solar_wind", "acts on an electric sail only"),
    (SUN, {"device": ELECTRIC, **around(solar_wind={**GAMMA, "redraw_s": 0.01})},
     "environment.solar_wind.redraw_s", "86,400,000 draws, more than the 10,000,000 that limits.draws allows"),
    (SUN, {"device": {**SAIL, "control": {"kind": "electrochromic"}}}, "device.control", "nothing to control"),
    (SUN, {"device": BRAKE}, "environment.ionosphere", "needs an ionosphere"),
    (SUN, {"device": SAIL, **law("spinning", plane="along-track")}, "steering.kind", "for a plasma-brake tether"),
    ({**EARTH, **around(ionosphere=FORCE)}, {"device": BRAKE, **law("spinning", plane="along-track")},
     "environment.ionosphere", "a spinning tether needs a density"),
    ({**EARTH, **around(ionosphere=FORCE)}, {"device": {**BRAKE, "power_W": 1}}, "device.power_W", "with a density"),
    ({**EARTH, **around(ionosphere=TABLE)}, {"device": BRAKE}, "environment.solar_flux", "tables need the sun's level"),
    ({**EARTH, **around(ionosphere=TABLE, solar_flux_sfu=300)}, {"device": BRAKE},
     "environment.solar_flux_sfu", "the ionosphere table reaches from 70 to 193 sfu"),
    ({**EARTH, **around(ionosphere=FORCE)}, {"device": {**BRAKE, "tether_length_km": 600}},
     "device.tether_length_km", "longer than the 500 km"),
    (SUN, {"device": SAIL, **law("orbital", pitch_deg=100)}, "steering.pitch_deg", "beyond 90 deg"),
    (SUN, {"device": SAIL, "propagation": {"duration_yr": 300}}, "propagation.duration_yr", "292 years"),
    (SUN, {"device": SAIL, "epoch": date(1650, 1, 1)}, "epoch", "outside the years 1678 to 2262"),
]  # fmt: skip


@pytest.mark.parametrize(("base", "change", "place", "words"), CONFLICTS)
def test_what_does_not_fit_together_is_said_where_it_stands(base, change, place, words):
    scene = {**base, **change}
    with pytest.raises(SceneError) as caught:
        load_scene(scene)
    assert [fault.where for fault in caught.value.faults if words in fault.what] == [place]


def test_an_ephemeris_that_is_not_installed_is_named_with_its_extra(monkeypatch):
    monkeypatch.setattr(moments, "find_spec", lambda name: None)
    with pytest.raises(SceneError, match=r"sailviz\[ephemeris\]"):
        load_scene({**SUN, "device": SAIL, "ephemeris": "de421", "epoch": date(2030, 1, 1)})


def test_names_of_ensembles_are_listed_in_the_order_of_the_file():
    """Not in that of a set, which differs from one run of Python to the next."""
    many = [{"name": name} for name in ("windy", "calm", "Held", "free")]
    expect = [{"quantity": "radius_au", "value": 1, "within": 1, "ensemble": "zzz", "statistic": "mean", "at": "end"}]
    with pytest.raises(SceneError, match="Allowed: windy, calm, Held, free"):
        load_scene({**SUN, "device": ELECTRIC, "ensemble": many, "expect": expect, **around(solar_wind=GAMMA)})


@pytest.mark.parametrize("device", [{"kind": "none"}, THRUSTER, BRAKE], ids=lambda device: device["kind"])
def test_an_ensemble_of_a_craft_without_control_is_refused_in_a_sentence(device):
    with pytest.raises(SceneError, match="an ensemble flies a solar sail or an electric sail"):
        load_scene({**SUN, "device": device, "ensemble": [MANY]})
