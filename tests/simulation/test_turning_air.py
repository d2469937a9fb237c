"""Air that turns a craft in a low orbit: pendulums and darts in closed form, and a tumble by SciPy, facet by facet."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.special import ellipj, ellipk

from sailviz import frames
from sailviz.constants import MU_EARTH, RADIUS_EARTH, ROTATION_EARTH
from sailviz.simulation import simulate

RADIUS = RADIUS_EARTH + 300e3
SPEED = np.sqrt(MU_EARTH / RADIUS)
RATE = SPEED / RADIUS
DENSITY = 2e-11  # kg/m3
RELATIVE = SPEED - ROTATION_EARTH * RADIUS  # to air that turns with the ground, along the equator
DIFFUSE = {"law": "hyperthermal", "speed_ratio": 7.5, "wall_temperature_ratio": 0.3}  # accommodations of 1
B3 = np.sqrt(0.3 * np.pi) / (4 * 7.5)  # of it, beside b1 = 1/2, b2 = 0


def scene(shape, attitude, *, mass=1e9, weak=1e-6, hours=0.5, outputs=61, **more):
    """Along the equator in air of one density; weak : light over that at 1 au."""
    return {
        "title": "air turns it",
        "body": "earth",
        "start": {"kind": "circular", "radius_km": RADIUS / 1e3},
        "light": {"kind": "fixed", "direction": [0.6, 0, 0.8], "distance_au": weak**-0.5},
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
            "mass_kg": mass,
            "film": "jpl-2015",
            "back": "same",
            "shape": {"air": DIFFUSE, "cells": 2, "shadow": False} | shape,
        },
        "attitude": {"kind": "free", "gravity_gradient": False} | attitude,
        "propagation": {"duration_h": hours, "outputs": outputs, "tolerance": 1e-12},
    } | more


def into_the_flow(angle):
    """Quaternion of a craft over the x axis whose z is turned by an angle, rad, out of the flow, -y, its y along the
    orbit's normal."""
    z = np.array([np.sin(angle), -np.cos(angle), 0.0])
    y = np.array([0.0, 0.0, 1.0])
    return frames.quaternion(np.stack([np.cross(y, z), y, z], axis=-1)[None])[0].tolist()


def off_the_flow(run):
    """Signed angle (n,), rad, of the body's z from the flow about the orbit's normal."""
    flow = -(run.velocity - np.cross([0, 0, ROTATION_EARTH], run.position))
    z = frames.rotation(run.attitude.quaternion)[..., 2]
    return np.arctan2(np.cross(flow, z)[:, 2], np.sum(flow * z, axis=1))


def test_a_plate_behind_its_centre_of_mass_swings_about_the_flow_like_a_pendulum():
    """tau = 2 rho V^2 A b1 d sin cos: twice the angle is a mathematical pendulum, which the orbit only carries on."""
    start, side, lever, moment = np.radians(40.0), 3.0, 0.4, 8.0
    attitude = {
        "inertia_kg_m2": [7.9, moment, 14],
        "centre_of_mass_m": [0, 0, -lever],
        "quaternion": into_the_flow(start),
        "rates_rad_s": [0, RATE, 0],
    }
    run = simulate(scene({"kind": "square", "side_m": side}, attitude))
    w0 = np.sqrt(2 * DENSITY * RELATIVE**2 * side**2 * 0.5 * lever / moment)
    m = np.sin(start) ** 2
    _, cn, dn, _ = ellipj(w0 * run.time, m)
    angle = off_the_flow(run)
    assert run.time[-1] > 4 * (4 * ellipk(m) / w0)
    assert np.sin(angle) == pytest.approx(np.sin(start) * cn / dn, abs=3e-7)
    torque = run.environment["air_torque_y_N_m"]
    law = 2 * DENSITY * RELATIVE**2 * side**2 * 0.5 * lever * np.sin(angle) * np.cos(angle)
    assert torque == pytest.approx(-law, abs=1e-6 * np.abs(law).max())
    drag = 2 * DENSITY * RELATIVE**2 * side**2 * np.cos(angle) * (0.5 + B3 * np.cos(angle))
    assert run.environment["air_drag_N"] == pytest.approx(drag, rel=1e-6)
    assert run.environment["air_density_kg_m3"] == pytest.approx(DENSITY, rel=1e-9)


def panels(boom, cone):
    """(centre m, normal downwind, area m2) of the four panels of a square pyramid."""
    found = []
    for k in range(4):
        bearings = np.radians([90 * k - 45, 90 * k + 45])
        tips = [boom * np.array([np.cos(cone) * np.cos(a), np.cos(cone) * np.sin(a), np.sin(cone)]) for a in bearings]
        across = np.cross(*tips) / 2
        across = across * np.sign(across[2])
        found.append((sum(tips) / 3, across / np.linalg.norm(across), np.linalg.norm(across)))
    return found


def blown(facets, u, strength, centre):
    """(force N, torque N m about a centre) of diffuse hyperthermal air along u on two-sided facets."""
    force, torque = np.zeros(3), np.zeros(3)
    for place, normal, area in facets:
        c = normal @ u
        one = strength * area * abs(c) * (0.5 * u + B3 * np.sign(c) * normal)
        force, torque = force + one, torque + np.cross(place - centre, one)
    return force, torque


def test_a_dart_with_its_mass_ahead_weathervanes_at_the_frequency_of_its_panels():
    """Small swings of a steep pyramid: w0^2 = (slope of the torque) / I."""
    boom, cone, moment, centre = 2.0, np.radians(65.0), 5.0, np.array([0.0, 0.0, 0.3])
    attitude = {
        "inertia_kg_m2": [moment, moment, 3],
        "centre_of_mass_m": centre.tolist(),
        "quaternion": into_the_flow(np.radians(0.2)),
        "rates_rad_s": [0, RATE, 0],
    }
    shape = {"kind": "pyramid", "boom_m": boom, "cone_deg": 65, "cells": 64}  # whose tensors hold to 25 deg
    run = simulate(scene(shape, attitude, hours=0.5, outputs=181))
    h, facets = 1e-4, panels(boom, cone)
    turned = [blown(facets, np.array([np.sin(a), 0, np.cos(a)]), 2 * DENSITY * RELATIVE**2, centre)[1] for a in (h, -h)]
    slope = (turned[0] - turned[1])[1] / (2 * h)
    assert slope > 0  # flow from ahead of x turns z towards it
    expected = np.radians(0.2) * np.cos(np.sqrt(slope / moment) * run.time)
    assert run.time[-1] * np.sqrt(slope / moment) > 12 * np.pi
    assert off_the_flow(run) == pytest.approx(expected, abs=2e-6)


def tumbled(run, given, facets, times):
    """(z of the body, rates, position) at times by SciPy: orbit, direction cosines, air, light and gravity gradient."""
    said = given["attitude"]
    inertia, centre, mass = (
        np.array(said["inertia_kg_m2"]),
        np.array(said["centre_of_mass_m"]),
        given["device"]["mass_kg"],
    )
    towards = np.array([0.6, 0, 0.8])
    b1, b2, b3 = 0.0723, 0.8554, -0.0030

    def rhs(_, y):
        r, v, axes, w = y[:3], y[3:6], y[6:15].reshape(3, 3), y[15:]
        relative = v - np.cross([0, 0, ROTATION_EARTH], r)
        speed = np.linalg.norm(relative)
        force, torque = blown(facets, axes.T @ (-relative / speed), 2 * DENSITY * speed**2, centre)
        away = r - towards * 149597870700.0
        u = axes.T @ (away / np.linalg.norm(away))
        for place, normal, area in facets:
            c = normal @ u
            k = 2 * 4.563e-6 * (149597870700.0 / np.linalg.norm(away)) ** 2 * area * abs(c)
            one = k * (b1 * u + (b2 * abs(c) + b3) * np.sign(c) * normal)
            force, torque = force + one, torque + np.cross(place - centre, one)
        up = axes.T @ r / np.linalg.norm(r)
        torque = torque + 3 * MU_EARTH / np.linalg.norm(r) ** 3 * np.cross(up, inertia * up)
        skew = np.array([[0, -w[2], w[1]], [w[2], 0, -w[0]], [-w[1], w[0], 0]])
        a = -MU_EARTH * r / np.linalg.norm(r) ** 3 + axes @ force / mass
        return np.concatenate([v, a, (axes @ skew).ravel(), (torque - np.cross(w, inertia * w)) / inertia])

    axes = frames.rotation(run.attitude.quaternion[0])
    start = np.concatenate([run.position[0], run.velocity[0], axes.ravel(), np.radians(said["rates_deg_s"])])
    found = solve_ivp(rhs, (0, times[-1]), start, "DOP853", times, rtol=1e-8, atol=1e-11, max_step=30.0).y.T
    return found[:, 6:15].reshape(-1, 3, 3), found[:, 15:], found[:, :3]


@pytest.fixture(scope="module")
def tumbling():
    """A pyramid that air, light and gravity turn, and what was asked for."""
    attitude = {
        "inertia_kg_m2": [60, 64, 110],
        "centre_of_mass_m": [0.05, -0.02, 0.6],
        "gravity_gradient": True,
        "pitch_deg": 50,
        "clock_deg": 20,
        "rates_deg_s": [0.02, 0.05, 0.03],
    }
    shape = {"kind": "pyramid", "boom_m": 3, "cone_deg": 15, "cells": 64}
    given = scene(shape, attitude, mass=40, weak=1.0, hours=0.75, outputs=91)
    return simulate(given), given


def test_a_tumble_in_air_and_light_is_that_of_scipy_facet_by_facet(tumbling):
    run, given = tumbling
    axes, rates, position = tumbled(run, given, panels(3.0, np.radians(15.0)), run.time)
    assert np.abs(rates).max() > 0.003  # air has made it thrice as fast
    drawn = frames.rotation(run.attitude.quaternion)
    assert np.abs(drawn - axes).max() < 2e-5
    assert np.abs(run.attitude.motion["rate_rad_s"] - rates).max() < 2e-5 * np.abs(rates).max()
    assert np.abs(run.position - position).max() < 0.01


def test_recorded_torques_of_air_light_and_gravity_make_the_recorded_momentum(tumbling):
    run, _ = tumbling
    axes = frames.rotation(run.attitude.quaternion)
    names = ("light", "gravity", "air")
    body = sum(np.stack([run.environment[f"{kind}_torque_{axis}_N_m"] for axis in "xyz"], -1) for kind in names)
    inertial = frames.from_frame(axes, body)
    h = run.time[1]
    whole = h / 3 * (inertial[0] + 4 * inertial[1:-1:2].sum(0) + 2 * inertial[2:-1:2].sum(0) + inertial[-1])
    gained = run.attitude.motion["angular_momentum_N_m_s"]
    assert gained[-1] - gained[0] == pytest.approx(whole, abs=2e-4 * np.linalg.norm(whole))
