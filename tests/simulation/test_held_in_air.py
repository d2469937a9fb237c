"""Air that turns a craft whose attitude is held, or whose spin is averaged: against SciPy, facet by facet."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from sailviz import frames
from sailviz.constants import MU_EARTH, RADIUS_EARTH, ROTATION_EARTH
from sailviz.simulation import simulate

RADIUS = RADIUS_EARTH + 300e3
RATE = np.sqrt(MU_EARTH / RADIUS**3)
DENSITY, MASS = 2e-11, 1e9  # kg/m3; kg, so that nothing but gravity moves it
B3 = np.sqrt(0.3 * np.pi) / (4 * 7.5)  # of the air below, beside b1 = 1/2, b2 = 0
INERTIA, CENTRE = np.array([60.0, 61.0, 110.0]), np.array([0.05, -0.02, 0.6])
FREQUENCY, DAMPING = 0.02, 0.8  # of the controller, rad/s
STEP = 1.0  # s, over which it is told how its law turns


def scene(attitude: dict, minutes: float, steering: dict | None) -> dict:
    """Along the equator; light so weak that it does nothing."""
    found = {
        "title": "held in the air",
        "body": "earth",
        "start": {"kind": "circular", "radius_km": RADIUS / 1e3},
        "light": {"kind": "fixed", "direction": [0.6, 0, 0.8], "distance_au": 1e4},
        "environment": {
            "shadow_of": [],
            "corotation": True,
            "atmosphere": {
                "kind": "exponential",
                "density_kg_m3": DENSITY,
                "scale_height_km": 1e7,
                "reference_altitude_km": 300,
            },
        },
        "device": {
            "kind": "solar-sail",
            "mass_kg": MASS,
            "film": "jpl-2015",
            "back": "same",
            "shape": {
                "kind": "pyramid",
                "boom_m": 3,
                "cone_deg": 15,
                "cells": 4,
                "shadow": False,
                "air": {"law": "hyperthermal", "speed_ratio": 7.5, "wall_temperature_ratio": 0.3},
            },
        },
        "attitude": {
            "inertia_kg_m2": INERTIA.tolist(),
            "centre_of_mass_m": CENTRE.tolist(),
            "gravity_gradient": False,
            **attitude,
        },
        "propagation": {"duration_min": minutes, "outputs": 21, "tolerance": 1e-12},
    }
    return found if steering is None else found | {"steering": steering}


def panels() -> list[tuple[np.ndarray, np.ndarray, float]]:
    """(centre m, normal downwind, area m2) of the four panels."""
    found, cone = [], np.radians(15.0)
    for k in range(4):
        bearings = np.radians([90 * k - 45, 90 * k + 45])
        tips = [3 * np.array([np.cos(cone) * np.cos(a), np.cos(cone) * np.sin(a), np.sin(cone)]) for a in bearings]
        across = np.cross(*tips) / 2
        across = across * np.sign(across[2])
        found.append((sum(tips) / 3, across / np.linalg.norm(across), np.linalg.norm(across)))
    return found


PANELS = panels()


def blown(axes: np.ndarray, r: np.ndarray, v: np.ndarray, centre: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """(force N, torque N m about the centre of mass), body axes, of diffuse air on the fronts of the panels."""
    relative = v - np.cross([0, 0, ROTATION_EARTH], r)
    speed = np.linalg.norm(relative)
    u, force, torque = axes.T @ (-relative / speed), np.zeros(3), np.zeros(3)
    assert u[2] > 0.4
    for place, normal, area in PANELS:
        c = normal @ u
        one = 2 * DENSITY * speed**2 * area * c * (0.5 * u + B3 * normal)
        force, torque = force + one, torque + np.cross(place - centre, one)
    return force, torque


def place(t: float) -> tuple[np.ndarray, np.ndarray]:
    """Position and velocity on the circle."""
    c, s = np.cos(RATE * t), np.sin(RATE * t)
    return RADIUS * np.array([c, s, 0]), RADIUS * RATE * np.array([-s, c, 0])


DIRECTION = np.array([np.sin(0.35) * np.cos(0.3), -np.cos(0.35) * np.cos(0.3), np.sin(0.3)])
WANTED = {"kind": "inertial", "direction": DIRECTION.tolist()}  # the flow comes past it within 17 deg


def wanted(t: float) -> np.ndarray:
    """Axes, as columns, that the steering asks for: z fixed in space, x towards the flight, which turns it about z."""
    ahead = place(t)[1]
    x = ahead - (ahead @ DIRECTION) * DIRECTION
    x = x / np.linalg.norm(x)
    return np.stack([x, np.cross(DIRECTION, x), DIRECTION], axis=-1)


def skew(w: np.ndarray) -> np.ndarray:
    return np.array([[0, -w[2], w[1]], [w[2], 0, -w[0]], [-w[1], w[0], 0]])


def half_sine(turn: np.ndarray) -> np.ndarray:
    """Axis times the sine of half the angle of a rotation of less than half a turn."""
    twice = np.array([turn[2, 1] - turn[1, 2], turn[0, 2] - turn[2, 0], turn[1, 0] - turn[0, 1]])
    return twice / (2 * np.sqrt(1 + np.trace(turn)))


def asked(t: float, axes: np.ndarray, w: np.ndarray) -> np.ndarray:
    """Torque, N m, of the spring and its damper."""
    law = wanted(t)
    spin = 2 * half_sine(law.T @ wanted(t + STEP)) / STEP
    error = law.T @ axes
    return INERTIA * (-2 * FREQUENCY**2 * half_sine(error) - 2 * DAMPING * FREQUENCY * (w - error.T @ spin))


def started(run) -> np.ndarray:
    return np.concatenate([frames.rotation(run.attitude.quaternion[0]).ravel(), run.attitude.motion["rate_rad_s"][0]])


def solved(rhs, start, run, size):
    return solve_ivp(rhs, (0, run.time[-1]), start, "DOP853", run.time, rtol=1e-10, atol=1e-12 * np.array(size)).y.T


HELD = {"kind": "controlled", "control": {"kind": "pd", "frequency_rad_s": FREQUENCY, "damping": DAMPING}}


def off_what_is_wanted() -> dict:
    """Attitude at the start, turned about all axes by a few degrees."""
    turned = wanted(0.0) @ frames.rotation(np.array([0.08, -0.05, 0.06, np.sqrt(1 - 0.0125)]))
    return {"quaternion": frames.quaternion(turned[None])[0].tolist(), "rates_rad_s": [1e-3, 5e-4, -2e-4]}


def test_wheels_hold_a_craft_in_air_and_take_up_its_torque_as_scipy_has_it():
    """Axes and momenta over ten minutes, from some degrees off what is wanted."""
    attitude = HELD | off_what_is_wanted()
    attitude["actuators"] = [{"kind": "wheels", "torque_mN_m": 3, "storage_N_m_s": 20}]
    run = simulate(scene(attitude, 10, WANTED))

    def rhs(t, y):
        axes, w, h = y[:9].reshape(3, 3), y[9:12], y[12:]
        torque = blown(axes, *place(t), CENTRE)[1]
        given = np.clip(asked(t, axes, w), -3e-3, 3e-3)
        turn = (torque + given - np.cross(w, INERTIA * w + h)) / INERTIA
        return np.concatenate([(axes @ skew(w)).ravel(), turn, -given])

    found = solved(rhs, np.append(started(run), np.zeros(3)), run, [1] * 9 + [1e-3] * 3 + [1] * 3)
    assert frames.rotation(run.attitude.quaternion) == pytest.approx(found[:, :9].reshape(-1, 3, 3), abs=2e-6)
    wheels = run.attitude.motion["wheels_N_m_s"]
    assert np.abs(wheels).max() > 0.1
    assert wheels == pytest.approx(found[:, 12:], abs=2e-5 * np.abs(wheels).max())
    torque = np.array(
        [blown(row[:9].reshape(3, 3), *place(t), CENTRE)[1] for t, row in zip(run.time, found, strict=True)]
    )
    recorded = np.stack([run.environment[f"air_torque_{axis}_N_m"] for axis in "xyz"], -1)
    assert recorded == pytest.approx(torque, abs=1e-5 * np.abs(torque).max())
    gained = run.attitude.motion["angular_momentum_N_m_s"]
    own = frames.from_frame(frames.rotation(run.attitude.quaternion), found[:, 9:12] * INERTIA + found[:, 12:])
    assert gained == pytest.approx(own, abs=1e-4 * np.abs(own).max())


def test_a_sliding_mass_trims_a_craft_in_air_as_scipy_has_it():
    """A fifth of it slides, slowly; the force that it is led by is that of the air."""
    share, travel, speed = 0.2, 0.6, 0.005
    attitude = HELD | off_what_is_wanted()
    attitude["actuators"] = [{"kind": "sliding-mass", "mass_kg": share * MASS, "travel_m": travel, "speed_m_s": speed}]
    run = simulate(scene(attitude, 8, WANTED))

    def rhs(t, y):
        axes, w, slid = y[:9].reshape(3, 3), y[9:12], y[12:]
        force, torque = blown(axes, *place(t), CENTRE + np.append(share * slid, 0.0))
        more = (asked(t, axes, w) - torque) / (share * force[2])
        aim = np.clip(slid + np.array([more[1], -more[0]]), -travel, travel)
        rate = np.clip(10 * FREQUENCY * (aim - slid), -speed, speed)
        turn = (torque - np.cross(w, INERTIA * w)) / INERTIA
        return np.concatenate([(axes @ skew(w)).ravel(), turn, rate])

    found = solved(rhs, np.append(started(run), np.zeros(2)), run, [1] * 9 + [1e-3] * 3 + [1] * 2)
    slid = np.stack([run.environment["slide_x_m"], run.environment["slide_y_m"]], -1)
    assert np.abs(slid).max() > 0.1
    assert slid == pytest.approx(found[:, 12:], abs=1e-4)
    assert frames.rotation(run.attitude.quaternion) == pytest.approx(found[:, :9].reshape(-1, 3, 3), abs=2e-5)


def test_an_averaged_spin_leans_in_air_as_scipy_has_it():
    """Over 8 angles of a turn: axis, spin and the torque that is recorded, about the axis and across it."""
    spin = 0.3
    attitude = {"kind": "spin-averaged", "spin_rad_s": spin, "quaternion": off_what_is_wanted()["quaternion"]}
    run = simulate(scene(attitude, 8, None))

    def mean_torque(z, t):
        x = np.cross([0.3, 0.9, 0.1], z)
        x, total = x / np.linalg.norm(x), np.zeros(3)
        for a in 2 * np.pi * np.arange(8) / 8:
            e = np.cos(a) * x + np.sin(a) * np.cross(z, x)
            axes = np.stack([e, np.cross(z, e), z], axis=-1)
            total += axes @ blown(axes, *place(t), CENTRE)[1] / 8
        return total

    def rhs(t, y):
        z, s = y[:3], y[3]
        torque = mean_torque(z, t)
        along = torque @ z
        return np.append((torque - along * z) / (INERTIA[2] * s), along / INERTIA[2])

    found = solved(rhs, [*run.attitude.normal[0], spin], run, [1] * 3 + [0.1])
    assert np.degrees(np.arccos(found[0, :3] @ found[-1, :3])) > 0.3
    assert run.attitude.normal == pytest.approx(found[:, :3], abs=1e-7)
    assert run.attitude.motion["rate_rad_s"][:, 2] == pytest.approx(found[:, 3], rel=1e-8)
    recorded = np.stack([run.environment[f"air_torque_{axis}_N_m"] for axis in "xyz"], -1)
    inertial = frames.from_frame(frames.rotation(run.attitude.quaternion), recorded)
    torque = np.array([mean_torque(row[:3], t) for t, row in zip(run.time, found, strict=True)])
    assert inertial == pytest.approx(torque, abs=1e-6 * np.abs(torque).max())


def test_a_craft_that_stands_as_its_law_says_tells_the_air_s_torque_along_its_own_axes():
    """About the origin of its shape, without an [attitude]: about y alone, since x points towards the flight."""
    given = scene({}, 4, WANTED)
    del given["attitude"]
    run = simulate(given)
    torque = np.array([blown(wanted(t), *place(t), np.zeros(3))[1] for t in run.time])
    recorded = np.stack([run.environment[f"air_torque_{axis}_N_m"] for axis in "xyz"], -1)
    assert torque[:, 1].max() < -4e-3
    assert recorded == pytest.approx(torque, abs=1e-6 * np.abs(torque).max())
