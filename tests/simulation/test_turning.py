"""Scenes of craft that turn: what their recordings say, and the torque of those that are held by their steering."""

from __future__ import annotations

import numpy as np
import pytest

import sailviz
from sailviz import frames
from sailviz.constants import AU, MU_EARTH, RADIATION_PRESSURE, RADIUS_EARTH
from sailviz.errors import SceneError
from sailviz.exchange.aem import read_aem
from sailviz.propulsion.solar_sail import FILMS
from sailviz.run.quantities import VALUES
from sailviz.shapes import membranes, structures
from sailviz.shapes.facets import Coefficients, Shape, Surface
from sailviz.simulation import simulate
from sailviz.simulation.mass_properties import of_shape

TUMBLING = {
    "title": "tumbles",
    "epoch": "2030-01-01",
    "start": {"kind": "circular", "radius_au": 1},
    "device": {
        "kind": "solar-sail",
        "mass_kg": 14,
        "film": "jpl-2015",
        "back": "black",
        "shape": {"kind": "square", "side_m": 9},
    },
    "attitude": {
        "kind": "free",
        "inertia_kg_m2": [60, 62, 115],
        "centre_of_mass_m": [0.05, 0, 0.3],
        "pitch_deg": 20,
        "clock_deg": 70,
        "roll_deg": 15,
        "rates_deg_s": [0.01, 0, 0.02],
        "sun_angle_limit_deg": 45,
    },
    "propagation": {"duration_h": 6, "outputs": 37, "tolerance": 1e-12},
    "event": [{"body_rate_deg_s": 0.06, "name": "fast"}, {"nutation_deg": 40, "name": "leans"}],
}


@pytest.fixture(scope="module")
def tumbled():
    return simulate(TUMBLING)


def test_a_craft_starts_as_pitch_clock_and_roll_say(tumbled):
    first = tumbled.attitude
    assert np.degrees([first.pitch[0], first.clock[0]]) == pytest.approx((20, 70), abs=1e-9)
    axes = frames.rotation(first.quaternion[0])
    assert axes[:, 2] == pytest.approx(first.normal[0], abs=1e-14)
    plain = frames.body_axes(first.normal[:1], frames.rtn(tumbled.position[:1], tumbled.velocity[:1])[..., 1])[0]
    assert plain[:, 0] @ axes[:, 0] == pytest.approx(np.cos(np.radians(15)), abs=1e-12)
    assert np.cross(plain[:, 0], axes[:, 0]) @ axes[:, 2] == pytest.approx(np.sin(np.radians(15)), abs=1e-12)


def test_recorded_momentum_changes_by_the_recorded_torque(tumbled):
    """By Simpson's rule over the rows: what is recorded belongs together, whatever made it."""
    fine = simulate({**TUMBLING, "propagation": {"duration_min": 12, "outputs": 361, "tolerance": 1e-12}})
    axes = frames.rotation(fine.attitude.quaternion)
    torque = sum(
        np.stack([fine.environment[f"{kind}_torque_{axis}_N_m"] for axis in "xyz"], -1) for kind in ("light", "gravity")
    )
    inertial = frames.from_frame(axes, torque)
    h = fine.time[1]
    whole = h / 3 * (inertial[0] + 4 * inertial[1:-1:2].sum(0) + 2 * inertial[2:-1:2].sum(0) + inertial[-1])
    gained = fine.attitude.motion["angular_momentum_N_m_s"]
    assert gained[-1] - gained[0] == pytest.approx(whole, abs=1e-7 * np.linalg.norm(whole))
    body = fine.attitude.motion["rate_rad_s"] * np.array([60, 62, 115])
    assert frames.from_frame(axes, body) == pytest.approx(gained, abs=1e-14)


def test_events_of_turning_are_found_where_the_rows_pass_them(tumbled):
    names = [event.name for event in tumbled.events]
    assert names.count("tumbling") == 1  # the first time alone
    for name, stem, level in (
        ("tumbling", "pitch", np.pi / 2),
        ("Sun angle", "pitch", np.pi / 4),
        ("fast", "body_rate", np.radians(0.06)),
        ("leans", "nutation", np.radians(40)),
    ):
        event = next(event for event in tumbled.events if event.name == name)
        near = {**TUMBLING, "propagation": {"duration_s": event.time, "outputs": 2, "tolerance": 1e-12}}
        there = simulate(near)
        assert VALUES[stem](there)[-1] == pytest.approx(level, abs=1e-7), name


def test_an_aem_has_the_attitude_that_was_flown(tumbled, tmp_path):
    recording = tmp_path / "tumbled.rrd"
    sailviz.record(tumbled, recording)
    sailviz.export(recording, tmp_path / "tumbled.aem", frame="ECLIPJ2000")
    found = read_aem(tmp_path / "tumbled.aem").quaternion
    assert np.abs(np.sum(found * tumbled.attitude.quaternion, axis=1)) == pytest.approx(np.ones(len(found)), abs=1e-13)
    back = sailviz.read(recording)["/attitude"]
    assert back["rate_rad_s"] == pytest.approx(tumbled.attitude.motion["rate_rad_s"], abs=0)
    assert back["angular_momentum_N_m_s"].shape == (37, 3)


def test_holding_a_sail_at_a_pitch_in_low_orbit_takes_what_gravity_gives_back():
    """Fixed in the orbital frame it turns evenly about a principal axis: what is left is gravity's torque."""
    pitch, inertia = np.radians(30), (20.0, 24.0, 40.0)
    run = simulate(
        {
            "title": "held",
            "body": "earth",
            "start": {"kind": "circular", "altitude_km": 1000},
            "device": {"kind": "none"},
            "attitude": {"kind": "prescribed", "inertia_kg_m2": list(inertia)},
            "steering": {"kind": "orbital", "pitch_deg": 30, "clock_deg": 90},
            "propagation": {"duration_min": 20, "outputs": 5},
        }
    )
    n2 = MU_EARTH / (RADIUS_EARTH + 1e6) ** 3
    size = 3 * n2 * (inertia[2] - inertia[0]) * np.sin(pitch) * np.cos(pitch)
    torque = np.stack([run.environment[f"control_torque_needed_{axis}_N_m"] for axis in "xyz"], -1)
    assert np.abs(torque[:, 1]) == pytest.approx(np.full(5, size), rel=1e-6)
    assert np.abs(torque[:, [0, 2]]).max() < 1e-6 * size
    rate = run.environment["prescribed_rate_rad_s"]
    assert np.linalg.norm(rate, axis=1) == pytest.approx(np.full(5, np.sqrt(n2)), rel=1e-6)


def test_holding_a_sail_off_its_centre_of_mass_takes_the_light_s_torque():
    scene = {**TUMBLING, "steering": {"kind": "orbital", "pitch_deg": 35, "clock_deg": 90}, "event": []}
    scene["attitude"] = {"kind": "prescribed", "inertia_kg_m2": [60, 62, 115], "centre_of_mass_m": [0, 0, -0.3]}
    run = simulate(scene)
    film, a = FILMS["jpl-2015"], np.radians(35)
    torque = 2 * RADIATION_PRESSURE * 81 * film.b1 * 0.3 * np.cos(a) * np.sin(a)
    needed = np.stack([run.environment[f"control_torque_needed_{axis}_N_m"] for axis in "xyz"], -1)
    distance = np.linalg.norm(run.position, axis=1) / AU
    assert np.linalg.norm(needed, axis=1) == pytest.approx(torque / distance**2, rel=1e-5)


def test_a_film_and_a_box_weigh_and_turn_as_their_parts_do():
    black = Coefficients(0.5, 0, 0)
    film, box = membranes.square(10.0, Surface(black, black)), structures.bus((1, 2, 3), (0, 0, -2), black)
    found = of_shape(Shape((film, box)), 4.0, 16.0)
    assert found.centre == pytest.approx((0, 0, -1.6), abs=1e-12)
    arm, own = 4 * 1.6**2 + 16 * 0.4**2, np.array([(4 + 9), (1 + 9), (1 + 4)]) * 16 / 12
    plate = 4.0 * np.array([100, 100, 200]) / 12
    assert found.inertia == pytest.approx(np.diag(plate + own + [arm, arm, 0]), abs=1e-9)
    with pytest.raises(ValueError, match="no closed body"):
        of_shape(Shape((film,)), 4.0, 16.0)


def test_a_slow_spin_is_not_averaged_and_no_law_of_one_s_own_turns_what_is_free():
    scene = {**TUMBLING, "event": []}
    scene["attitude"] = {"kind": "spin-averaged", "inertia_kg_m2": [60, 60, 115], "spin_deg_d": 1}
    with pytest.raises(SceneError, match="no fast one"):
        simulate(scene)

    def law(t, x, y, z, vx, vy, vz, m):
        return x, y, z

    with pytest.raises(SceneError, match="followed by a controlled craft"):
        simulate(TUMBLING, steering=law)
