"""Actuators and the controller: each against the torque or the motion that is written down for it here."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from sailviz import frames
from sailviz.constants import AU, RADIATION_PRESSURE
from sailviz.propagate import body_steps, dop853, dynamics
from sailviz.propagate.body_control import body_control
from sailviz.propagate.body_motion import CONTROLLED, RATE, SIZE, WHEELS, Body, Q, packed
from sailviz.propagate.events import watch
from sailviz.propulsion.rigid_body import flat_plate
from sailviz.propulsion.solar_sail import FILMS
from sailviz.propulsion.surfaces import side_of
from sailviz.simulation import simulate
from sailviz.steering import attitude

JPL = side_of(FILMS["jpl-2015"])
START = ((AU, 0.0, 0.0), (0.0, 1e-9, 0.0), 1e15)
P2 = 2 * RADIATION_PRESSURE


def test_wheels_turn_a_craft_like_the_damped_spring_they_are_asked_for():
    frequency, degrees, moment = 2e-3, 60.0, 62.0
    law = {"law": float(attitude.INERTIAL), "law_x": 1.0, "stiffness": frequency**2, "damping": 2 * frequency}
    craft = Body(CONTROLLED, 60.0, moment, 115.0, 0.0, 0.0, 0.0, 1 / 60, 1 / moment, 1 / 115)._replace(
        **law, fastest=frequency, wheel_torque=1e9, wheel_storage=1e9
    )
    acting = dynamics.model(1e-6, steering=attitude.INERTIAL, body=packed(craft), body_control=body_control())
    wanted = np.array([[0.0, 0, 1], [1, 0, 0], [0, 1, 0]])  # x across, z away from the centre
    turn = wanted @ frames.turn_y(np.radians(degrees)).T
    state = body_steps.start(0.0, *START, 0, (*frames.quaternion(turn), 0, 0, 0))
    times, out = np.array([500.0, 2000.0]), np.empty((SIZE, 2))
    none = np.array([0.0]), np.array([1.0])
    assert body_steps.advance(state, acting, *none, watch([]), times, out, 2000.0, 1e-12, np.inf) == dop853.DONE
    left = np.swapaxes(frames.rotation(frames.unit(out[Q : Q + 4].T)), 1, 2) @ wanted
    angle = np.abs(np.arctan2(left[:, 2, 0], left[:, 0, 0]))

    def spring(_, y):
        return [y[1], -2 * frequency**2 * np.sin(y[0] / 2) - 2 * frequency * y[1]]

    exact = solve_ivp(spring, (0, 2000), [np.radians(degrees), 0], "DOP853", times, rtol=1e-13, atol=1e-15).y
    assert np.degrees(exact[0]) == pytest.approx((44.730954296675, 5.838500884334), rel=1e-11)
    assert angle == pytest.approx(exact[0], rel=1e-9)
    assert np.abs(out[RATE + 1, 1]) == pytest.approx(1.611398795563e-4, rel=1e-8)
    # what the craft has lost the wheels hold
    assert out[WHEELS + 1] == pytest.approx(-moment * out[RATE + 1], rel=1e-9)


def plate(u, normal, front):
    return np.array(flat_plate.py_func(*u, *normal, *front, *front))


def test_a_tip_vane_gives_the_torque_of_a_plate_on_its_hinge():
    for degrees, torque in ((30, (0, -5.621271351970e-5, -2.915537628248e-5)), (0, (0, -8.4388122e-5, 0))):
        d = np.radians(degrees)
        normal = (0, -np.sin(d), np.cos(d))
        found = np.cross((10, 0, 0), P2 * plate((0, 0, 1), normal, JPL))
        assert found == pytest.approx(torque, rel=1e-8, abs=1e-18)


def test_a_switched_patch_changes_the_torque_by_what_its_films_differ():
    change = np.subtract(JPL, (0.4, 0.2, 0.7 / 3))
    for degrees, torque in ((0, -8.00459712e-6), (35, -2.303875551731e-6)):
        a = np.radians(degrees)
        force = P2 * plate((np.sin(a), 0, np.cos(a)), (0, 0, 1), change)
        assert np.cross((9.6, 0, 0), force)[1] == pytest.approx(torque, rel=1e-9)


# ---------------------------------------------------------------- whole scenes
SIDE = 86**0.5


def sail(actuators, control=None, offset=(0, 0, -0.3), **said):
    return {
        "title": "held",
        "start": {"kind": "circular", "radius_au": 1},
        "device": {
            "kind": "solar-sail",
            "mass_kg": 14,
            "film": "jpl-2015",
            "back": "same",
            "shape": {"kind": "square", "side_m": SIDE},
        },
        "steering": {"kind": "orbital", "pitch_deg": 35, "clock_deg": 90},
        "attitude": {
            "kind": "controlled",
            "inertia_kg_m2": [60, 62, 115],
            "centre_of_mass_m": list(offset),
            "control": control or {"kind": "pd", "frequency_rad_s": 2e-3},
            "actuators": actuators,
            **said,
        },
        "propagation": {"duration_h": 24, "outputs": 25},
    }


def test_a_sliding_mass_trims_a_sail_at_a_pitch_where_its_force_passes_through_the_centre_of_mass():
    run = simulate(sail([{"kind": "sliding-mass", "mass_kg": 6, "travel_m": 0.1, "speed_m_s": 1e-3}]))
    a = np.radians(35)
    force = np.cos(a) * (
        np.array(JPL[0]) * np.array([np.sin(a), 0, np.cos(a)]) + (JPL[1] * np.cos(a) + JPL[2]) * np.array([0, 0, 1])
    )
    wanted = 0.3 * force[0] / force[2]
    assert wanted == pytest.approx(0.016436019758, rel=1e-10)
    place = np.hypot(run.environment["slide_x_m"][-1], run.environment["slide_y_m"][-1]) * 6 / 14
    assert place == pytest.approx(wanted, rel=1e-3)  # and what little turns it with the Sun line
    assert run.attitude.pitch[-1] == pytest.approx(a, abs=1e-3)
    torque = [run.environment[f"light_torque_{axis}_N_m"][-1] for axis in "xyz"]
    assert np.linalg.norm(torque) < 1e-3 * 0.3 * P2 * 86 * np.cos(a) * np.sin(a) * JPL[0]


def test_wheels_fill_at_the_torque_that_they_hold_until_they_are_full():
    offset, storage = 0.01, 0.05
    wheels = {"kind": "wheels", "torque_mN_m": 1, "storage_N_m_s": storage}
    scene = sail([wheels], {"kind": "pd", "frequency_rad_s": 2e-2}, (offset, 0, 0))
    scene["steering"] = {"kind": "sun-facing"}
    run = simulate(scene)
    torque = offset * P2 * 86 * sum(JPL)
    full = [event for event in run.events if event.name == "wheels saturated"]
    assert len(full) >= 1  # of the wheel that holds the torque, and later of those that meet the tumbling
    assert full[0].time == pytest.approx(storage / torque, rel=2e-2)
    held = np.abs(run.attitude.motion["wheels_N_m_s"]).max(axis=1)
    before = run.time < full[0].time
    assert held[before][1:] == pytest.approx(torque * run.time[before][1:], rel=2e-2)
    assert held.max() < storage * (1 + 1e-4)
    assert "tumbling" in [event.name for event in run.events]  # nothing holds it then


def test_vanes_hold_an_offset_sail_that_falls_over_without_them():
    places = [(5.0, 0, 0), (0, 5.0, 0), (-5.0, 0, 0), (0, -5.0, 0)]
    vanes = [
        {"kind": "vane", "position_m": list(at), "area_m2": 1.0, "rest_deg": rest}
        for at, rest in zip(places, (35, -35, 35, -35), strict=True)
    ]
    run = simulate(sail(vanes, offset=(0.005, -0.01, 0.1)))
    assert np.degrees(run.attitude.pitch[1:]) == pytest.approx(np.full(24, 35.0), abs=0.05)
    angles = np.array([run.environment[f"vane_{i}_angle_rad"][-1] for i in (1, 2, 3, 4)])
    assert np.ptp(np.abs(angles)) > 0.01
    whole = [
        run.environment[f"light_torque_{x}_N_m"][-1] + run.environment[f"control_torque_{x}_N_m"][-1] for x in "xyz"
    ]
    assert np.linalg.norm(whole) < 1e-8
    free = sail([], offset=(0.005, -0.01, 0.1))
    free["attitude"] = {k: v for k, v in free["attitude"].items() if k not in ("control", "actuators")} | {
        "kind": "free"
    }
    free["attitude"] |= {"pitch_deg": 35, "clock_deg": 90}
    del free["steering"]
    assert simulate(free).attitude.pitch.max() > np.radians(60)


def test_devices_switched_in_step_tilt_the_spin_axis_by_their_torque_over_pi():
    arm, area, spin, axial, hours = 6.0, 0.5, 2 * np.pi / 60, 600.0, 3.0
    patches = [
        {"kind": "reflectivity", "position_m": [x, 0, 0], "area_m2": area, "off": {"b1": 0.5, "b2": 0.0, "b3": 0.0}}
        for x in (arm, -arm)
    ]
    scene = sail(patches, {"kind": "spin-axis"}, (0, 0, 0), pitch_deg=0, rates_rad_s=[0, 0, spin])
    scene["attitude"]["inertia_kg_m2"] = [350, 350, axial]
    scene["steering"] = {"kind": "orbital", "pitch_deg": 35, "clock_deg": 90}
    scene["propagation"] = {"duration_h": hours, "outputs": 4, "tolerance": 1e-8}
    run = simulate(scene)
    momentum = frames.unit(run.attitude.motion["angular_momentum_N_m_s"])
    tilted = np.arccos(momentum[-1] @ momentum[0])
    change = P2 * area * (sum(JPL) - 0.5) * arm
    assert tilted == pytest.approx(2 * change / np.pi * hours * 3600 / (axial * spin), rel=0.03)
    ahead = frames.unit(np.cross([0, 0, 1.0], run.position[0]))
    assert momentum[-1] @ ahead == pytest.approx(np.sin(tilted), rel=0.05)  # towards the steering's normal
