"""A craft begins on a conic that exists, above the body, where its steering means something, with mass to burn."""

from __future__ import annotations

import numpy as np
import pytest

from sailviz.constants import STANDARD_GRAVITY
from sailviz.errors import SceneError
from sailviz.scene.conflicts.records import start_of
from sailviz.scene.conflicts.starts import STARTS
from sailviz.scene.known_starts import OemStart, PlanetStart, SmallBodyStart, TleStart
from sailviz.scene.loading import load_scene
from sailviz.shipped import shipped_scenes
from sailviz.simulation.bodies import body_of
from sailviz.simulation.start import design_of, initial_state

SAIL = {"kind": "solar-sail", "lightness_number": 0.05}
BASE = {
    "title": "t",
    "start": {"kind": "circular", "radius_au": 1},
    "device": SAIL,
    "propagation": {"duration_d": 1, "outputs": 3},
}
EARTH = {"body": "earth", "device": {"kind": "none"}}


def said(**parts) -> dict[str, str]:
    """Place -> sentence of what is wrong with a scene; {} if nothing is."""
    try:
        load_scene({**BASE, **parts})
    except SceneError as error:
        return {fault.where: fault.what for fault in error.faults}
    return {}


def conic(a, e, nu=0.0):
    return {"start": {"kind": "elements", "semi_major_axis_au": a, "eccentricity": e, "true_anomaly_deg": nu}}


@pytest.mark.parametrize(
    ("e", "nu"), [(1.2, 170), (2, 120), (2, -120), (2, 240), (2, 180), (2, 120 + 3600), (1.2, 146.4426903), (1e6, 90.1)]
)
def test_a_hyperbola_has_no_point_beyond_its_asymptote(e, nu):
    assert "no point at this true_anomaly" in said(**conic(-1, e, nu))["start"]


@pytest.mark.parametrize(("e", "nu"), [(1.2, 146.44), (2, 119.999), (2, -119.999), (2, 360 * 5 + 10), (1e6, 90)])
def test_a_hyperbola_has_its_points_within_the_asymptotes(e, nu):
    assert said(**conic(-1000, e, nu)) == {}


@pytest.mark.parametrize(("a", "e"), [(1, 1.5), (-1, 0.5), (1, 1), (-1, 1), (0, 2), (0, 0.5), (1, 1 + 1e-15)])
def test_size_and_eccentricity_of_a_conic_agree(a, e):
    assert "eccentricity < 1" in said(**conic(a, e))["start"] or "a parabola" in said(**conic(a, e))["start"]


INSIDE = [
    {"start": {"kind": "cartesian", "position_km": [3e5, 3e5, 3e5], "velocity_km_s": [0, 0, 1]}},
    {"start": {"kind": "cartesian", "position_km": [695_700, 0, 0], "velocity_km_s": [0, 1, 0]}},
    {"start": {"kind": "circular", "radius_km": 695_700}},
    {"start": {"kind": "heliostationary", "radius_km": 1000}},
    {"start": {"kind": "displaced", "radius_km": 600_000, "elevation_deg": 5, "rate_ratio": 1}},
    {"start": {"kind": "lagrange-point", "radius_au": 0.9, "position_offset_au": [-0.9, 0, 0]}},
    {"start": {"kind": "spiral", "radius_km": 600_000}},
    {"start": {"kind": "planet-following", "planet": "earth", "elevation_deg": 1, "radius_ratio": 1e-3}},
    {"start": {"kind": "flat-ellipse", "semi_latus_rectum_km": 600_000, "eccentricity": 0.1, "height_km": 1}},
    {**EARTH, "start": {"kind": "elements", "semi_major_axis_km": 10_000, "eccentricity": 0.5}},
    {**EARTH, "start": {"kind": "circular", "altitude_km": 1e-20}},
    {
        **EARTH,
        "start": {
            "kind": "circular",
            "mean_altitude_km": 5,
            "inclination_deg": 90,
            "argument_of_latitude_deg": 90,
        },
        "environment": {"j2": True},
    },
    {
        "device": {"kind": "none"},
        "body": {"mu_km3_s2": 4e5},
        "start": {"kind": "cartesian", "position_km": [0, 0, 0], "velocity_km_s": [1, 0, 0]},
    },
]


@pytest.mark.parametrize("parts", INSIDE, ids=lambda parts: parts["start"]["kind"])
def test_no_start_lies_inside_the_body_or_on_its_surface(parts):
    assert "this point is" in said(**parts)["start"]


def test_an_ellipse_may_dip_below_the_surface_where_the_craft_begins_above_it():
    start = {"kind": "elements", "semi_major_axis_km": 10_000, "eccentricity": 0.5, "true_anomaly_deg": 180}
    assert said(**EARTH, start=start) == {}
    assert "surface" in said(**EARTH, start={"kind": "circular", "radius_km": 6378.137})["start"]
    assert said(**EARTH, start={"kind": "circular", "radius_km": 6378.138}) == {}


@pytest.mark.parametrize("name", sorted(shipped_scenes()))
def test_the_point_that_is_checked_is_the_point_that_is_flown(name):
    """But for the local time of the node, which turns it about the pole, and planets to a part in a hundred."""
    scene = load_scene(name)
    point = start_of(scene).point(scene, scene.start)
    if isinstance(scene.start, TleStart):  # which SGP4 knows
        assert point is None
        return
    position, velocity = initial_state(scene, body_of(scene), design_of(scene))
    assert np.hypot(*point[:2]) == pytest.approx(np.hypot(*position[:2]), rel=0.01)
    assert np.linalg.norm(point) == pytest.approx(np.linalg.norm(position), rel=0.01)
    moving = start_of(scene).velocity(scene, scene.start)
    assert moving is None or np.allclose(moving, velocity, rtol=1e-9, atol=1e-9 * np.linalg.norm(velocity))


def test_every_kind_of_start_says_where_it_begins():
    looked_up = [TleStart, OemStart, PlanetStart, SmallBodyStart]  # by arrays, once the scene is planned
    assert [kind for kind, fits in STARTS.items() if fits.point.__name__ == "nowhere"] == looked_up


REST = {"kind": "cartesian", "position_au": [1, 0, 0.2], "velocity_km_s": [0, 0, 0]}
FALL = {**REST, "velocity_km_s": [-5, 0, -1]}
THRUSTER = {"kind": "thruster", "acceleration_mm_s2": 0.1}
TABLE = {"kind": "table", "time_d": [0, 1], "pitch_deg": [10, 10], "clock_deg": [90, 90]}


@pytest.mark.parametrize(
    "start", [REST, FALL, {"kind": "heliostationary", "radius_au": 1}], ids=["rest", "fall", "held"]
)
@pytest.mark.parametrize(
    ("device", "steering"),
    [
        (SAIL, {"kind": "orbital", "pitch_deg": 10}),
        (SAIL, TABLE),
        (SAIL, {"kind": "locally-optimal", "goal": "inclination"}),
        (SAIL, {"kind": "lyapunov", "semi_major_axis_au": 1.5}),
        (THRUSTER, {"kind": "circumferential"}),
    ],
    ids=["orbital", "table", "locally-optimal", "lyapunov", "circumferential"],
)
def test_without_angular_momentum_the_orbital_frame_is_undefined(start, device, steering):
    if start["kind"] == "heliostationary" and device is THRUSTER:
        start = REST
    assert (
        "without angular momentum the orbital frame" in said(start=start, device=device, steering=steering)["steering"]
    )


def test_steering_that_needs_no_orbital_frame_flies_from_rest():
    for steering in (
        {"kind": "sun-facing"},
        {"kind": "inertial", "direction": [1, 0, 0]},
        {**TABLE, "frame": "meridian"},
    ):
        assert said(start=REST, steering=steering) == {}
    assert "velocity is undefined" in said(start=REST, device=THRUSTER, steering={"kind": "tangential"})["steering"]
    assert said(start=FALL, device=THRUSTER, steering={"kind": "tangential"}) == {}


def test_on_the_polar_axis_there_is_no_meridian():
    start = {"kind": "cartesian", "position_au": [0, 0, 1], "velocity_km_s": [30, 0, 0]}
    assert "no meridian" in said(start=start, steering={"kind": "meridian", "pitch_deg": 10})["steering"]
    assert said(start=start, steering={"kind": "orbital", "pitch_deg": 10}) == {}


def burning(active=None, steering=None, days=10.0, phase=(), **parts):
    device = {"kind": "thruster", "thrust_N": 1, "mass_kg": 100, "specific_impulse_s": 100, **parts}
    if active:
        device["active_d"] = active
    found = said(
        device=device, steering=steering or {"kind": "radial"}, propagation={"duration_d": days}, phase=list(phase)
    )
    return found.get("device.specific_impulse_s", "")


def test_a_thruster_may_not_burn_the_whole_mass():
    """m c / F is the time to nothing, c = g I_sp; one per cent before it there is something left."""
    days = 100 * STANDARD_GRAVITY * 100 / 86_400
    assert burning(days=0.99 * days) == ""
    assert f"burnt after {days:.6g} d" in burning(days=1.01 * days)
    assert burning(days=2 * days, active=[[0, 0.99 * days]]) == ""
    assert f"burnt after {days + 1:.6g} d" in burning(days=10, active=[[0, 0.5], [1.5, 9]])
    halved = {"kind": "table", "time_d": [0, 10], "pitch_deg": [0, 0], "clock_deg": [0, 0], "throttle": [0.5, 0.5]}
    assert f"burnt after {2 * days:.6g} d" in burning(steering=halved)
    falling = {**halved, "throttle": [1, 0]}
    assert f"burnt after {10 * (1 - np.sqrt(1 - days / 5)):.6g} d" in burning(steering=falling)


def test_a_thruster_at_constant_acceleration_loses_mass_by_an_exponential_that_has_an_end_too():
    endless = {"kind": "thruster", "acceleration_mm_s2": 1e6, "mass_kg": 1, "specific_impulse_s": 1}
    assert "nothing of the mass" in said(device=endless, steering={"kind": "radial"})["device.specific_impulse_s"]
    assert said(device={**endless, "acceleration_mm_s2": 1}, steering={"kind": "radial"}) == {}


@pytest.mark.parametrize("direction", [[0, 0, 0], [1e-300, 0, 0], [1e200, 0, 0], [float("nan"), 0, 0], [1, 0]])
def test_a_direction_has_a_length_that_can_be_divided_by(direction):
    assert any(place.startswith("steering") for place in said(steering={"kind": "inertial", "direction": direction}))


def test_any_direction_of_moderate_length_is_that_of_its_unit_vector():
    assert said(steering={"kind": "inertial", "direction": [3, 4, 0]}) == {}


ALWAYS = {"name": "on"}
NEVER = {"name": "off", "device": {"on": False}}


@pytest.mark.parametrize(
    ("phases", "share"),
    [
        ([{**ALWAYS, "until": "duration_d = 1"}, NEVER], None),
        ([{**NEVER, "until": "duration_d = 4"}, {**ALWAYS, "until": "time_d = 5"}, {**NEVER, "name": "end"}], None),
        ([{**NEVER, "until": "time_d = 4"}, ALWAYS], 4.0),
        ([{"name": "half", "until": "duration_d = 4", "device": {"throttle": 0.125}}, ALWAYS], 3.5),
        ([{**ALWAYS, "until": "radius_au = 0.5"}, NEVER], None),  # nobody knows when
        ([{**ALWAYS, "until": "radius_au = 0.5"}, {"name": "half", "device": {"throttle": 0.5}}], "half"),
        ([{**ALWAYS, "until": "radius_au = 0.5"}, {**ALWAYS, "name": "too"}], 0.0),
    ],
)
def test_propellant_is_counted_phase_by_phase(phases, share):
    """share : days by which the mass is burnt later than without phases."""
    days = 100 * STANDARD_GRAVITY * 100 / 86_400  # 1.135 to nothing
    found = burning(phase=phases)
    if share is None:
        assert found == ""
    else:
        later = 2 * days if share == "half" else days + share
        assert f"burnt after {later:.6g} d" in found
