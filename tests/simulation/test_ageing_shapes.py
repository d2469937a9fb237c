"""Shapes whose film ages: the flat sail that ages, the shape of the aged film, and SciPy facet by facet."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from sailviz import load_scene, simulate
from sailviz.constants import AU, DAY, MU_SUN, RADIATION_PRESSURE, YEAR
from sailviz.errors import SceneError
from sailviz.frames import rotation

OPTICS = {"cr": 0.91, "cs": 0.94, "Bf": 0.79, "Bb": 0.67, "ef": 0.025, "eb": 0.27}  # of table 3.1, 2015
FACTOR, HALF = 0.2, 0.001 * YEAR
AGEING = {"factor": FACTOR, "half_dose_yr": 0.001}
PYRAMID = {"kind": "pyramid", "boom_m": 6, "cone_deg": 15, "opening_deg": 70, "cells": 4, "shadow": False}
SQUARE = {"kind": "square", "side_m": 9.27, "cells": 4, "shadow": False}
MASS, INERTIA, CENTRE = 14.0, np.array([60.0, 60.0, 110.0]), np.array([0.01, -0.004, 0.2])


@pytest.fixture(autouse=True)
def own_cache(tmp_path_factory, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path_factory.getbasetemp() / "tables"))


def scene(device: dict, days: float = 3.0, outputs: int = 4, **more: object) -> dict:
    found = {
        "title": "a shape that ages",
        "start": {"kind": "circular", "radius_au": 1},
        "device": {"kind": "solar-sail", "film": "jpl-2015", "mass_kg": MASS, **device},
        "steering": {"kind": "orbital", "pitch_deg": 35, "clock_deg": 60},
        "propagation": {"duration_d": days, "outputs": outputs, "tolerance": 1e-12},
        **more,
    }
    if more.get("attitude", {}).get("kind") in ("free", "spin-averaged"):
        del found["steering"]
    return found


def turning(kind: str, **more: object) -> dict:
    inertia = {"inertia_kg_m2": INERTIA.tolist(), "centre_of_mass_m": CENTRE.tolist(), "gravity_gradient": False}
    return {"attitude": {"kind": kind, **inertia, "pitch_deg": 20, "clock_deg": 40, **more}}


def test_a_flat_shape_ages_as_the_flat_sail():
    """Of the same area and mass, out of the plane: forces and doses within 1e-12, places within a metre."""
    age = {"ageing": AGEING | {"dose_d": 1}}
    flat = simulate(load_scene(scene({"area_m2": 9.27**2, **age}, 100)))
    shaped = simulate(load_scene(scene({"shape": SQUARE, "back": "black", **age}, 100)))
    size = flat.thrust.magnitude.max()
    np.testing.assert_allclose(shaped.thrust.acceleration, flat.thrust.acceleration, rtol=0, atol=1e-12 * size)
    np.testing.assert_allclose(shaped.film["dose_yr"], flat.film["dose_yr"], rtol=1e-12)
    np.testing.assert_allclose(shaped.position, flat.position, rtol=0, atol=1)
    assert np.array_equal(shaped.mass, np.full(4, MASS))


def aged(dose: float) -> dict:
    """Optics at a dose, s: the formulas of the source."""
    left = np.exp(-np.log(2) * dose / HALF)
    kept, gained = (1 + FACTOR * left) / (1 + FACTOR), 1 + FACTOR * (1 - left)
    return OPTICS | {"cr": OPTICS["cr"] * kept, "cs": OPTICS["cs"] * kept, "ef": OPTICS["ef"] * gained}


@pytest.mark.parametrize("attitude", [{}, turning("free", rates_deg_s=[0.01, 0.02, 0.03])])
def test_a_shape_at_the_end_of_its_ageing_is_that_of_the_aged_film(attitude):
    """With a bus that shades it, its back to the light for a while if it is free."""
    shape = SQUARE | {
        "cone_deg": 3,
        "sag": 0.02,
        "shadow": True,
        "bus": {"size_m": [1, 1, 2], "centre_m": [0, 0, -1.5]},
    }
    old = aged(1e9 * HALF)
    both = (
        {"shape": shape, "back": "black", "ageing": AGEING | {"dose_yr": 1000}},
        {"shape": shape, "back": "black", "film": old},
    )
    one, other = (simulate(load_scene(scene(device, 0.5, 9, **attitude))) for device in both)
    np.testing.assert_allclose(one.position, other.position, rtol=0, atol=1e-3)
    np.testing.assert_allclose(one.attitude.quaternion, other.attitude.quaternion, rtol=0, atol=1e-9)
    np.testing.assert_allclose(
        one.thrust.acceleration, other.thrust.acceleration, rtol=0, atol=1e-9 * other.thrust.magnitude.max()
    )
    for axis in "xyz":
        name = f"light_torque_{axis}_N_m"
        size = max(np.abs(other.environment[f"light_torque_{each}_N_m"]).max() for each in "xyz")
        np.testing.assert_allclose(one.environment[name], other.environment[name], rtol=0, atol=1e-8 * size)


def film(optics: dict) -> np.ndarray:
    """b1, b2, b3 of a front: (3.18)-(3.20)."""
    cr, cs, bf, bb, ef, eb = optics.values()
    return np.array([(1 - cr * cs) / 2, cr * cs, (bf * cr * (1 - cs) + (1 - cr) * (ef * bf - eb * bb) / (ef + eb)) / 2])


def facets() -> list[tuple[np.ndarray, np.ndarray, float]]:
    """(centre m, normal away from the Sun, area m2) of the pyramid's four."""
    half, c, s = np.radians(35), np.cos(np.radians(15)), np.sin(np.radians(15))
    bearings = [-half, half, np.pi - half, np.pi + half]
    tips = [6 * np.array([c * np.cos(a), c * np.sin(a), s]) for a in bearings]
    found = []
    for i, tip in enumerate(tips):
        after = tips[(i + 1) % 4]
        across = np.cross(tip, after) / 2
        across = across * np.sign(across[2])
        found.append(((tip + after) / 3, across / np.linalg.norm(across), float(np.linalg.norm(across))))
    return found


FACETS = facets()


def push(u: np.ndarray, dose: float) -> tuple[np.ndarray, np.ndarray, float]:
    """(force, torque about the centre of mass over 2 P, share of the film that the light falls on), fronts lit."""
    b1, b2, b3 = film(aged(dose))
    force, torque, shown = np.zeros(3), np.zeros(3), 0.0
    for centre, normal, area in FACETS:
        c = normal @ u
        assert c > 0
        one = area * c * (b1 * u + (b2 * c + b3) * normal)
        force, torque, shown = force + one, torque + np.cross(centre - CENTRE, one), shown + area * c
    return force, torque, shown / sum(area for _, _, area in FACETS)


def skew(w: np.ndarray) -> np.ndarray:
    return np.array([[0, -w[2], w[1]], [w[2], 0, -w[0]], [-w[1], w[0], 0]])


def flown(rhs, start, duration: float, scale) -> np.ndarray:
    return solve_ivp(rhs, (0, duration), start, "DOP853", rtol=1e-11, atol=1e-12 * np.array(scale)).y[:, -1]


ORBIT = [AU] * 3 + [3e4] * 3


def test_a_free_pyramid_that_ages_turns_and_flies_as_scipy_has_it():
    """A half dose in ten hours: place within a metre, axes within 1e-7, dose within 1e-9."""
    device = {"shape": PYRAMID, "back": "same", "ageing": AGEING}
    run = simulate(load_scene(scene(device, 0.4, **turning("free", rates_deg_s=[0, 0, 0.02]))))

    def rate(t, y):
        r, v, axes, w, dose = y[:3], y[3:6], y[6:15].reshape(3, 3), y[15:18], y[18] * DAY
        size = np.linalg.norm(r)
        force, torque, shown = push(axes.T @ r / size, dose)
        strength = 2 * RADIATION_PRESSURE * (AU / size) ** 2
        a = -MU_SUN * r / size**3 + strength * axes @ force / MASS
        turn = (strength * torque - np.cross(w, INERTIA * w)) / INERTIA
        return np.concatenate([v, a, (axes @ skew(w)).ravel(), turn, [(AU / size) ** 2 * shown / DAY]])

    first = rotation(run.attitude.quaternion[:1])[0]
    start = np.concatenate([run.position[0], run.velocity[0], first.ravel(), [0, 0, np.radians(0.02)], [0]])
    end = flown(rate, start, 0.4 * DAY, [*ORBIT, *[1] * 9, *[1e-3] * 3, 1])
    assert run.film["dose_yr"][-1] * YEAR / DAY == pytest.approx(end[18], rel=1e-9)
    assert end[18] * DAY > 0.9 * HALF
    np.testing.assert_allclose(rotation(run.attitude.quaternion[-1:])[0], end[6:15].reshape(3, 3), rtol=0, atol=1e-7)
    np.testing.assert_allclose(run.position[-1], end[:3], rtol=0, atol=1)


def test_a_spinning_pyramid_that_ages_leans_on_average_as_scipy_has_it():
    """Its axis, over 8 angles of a turn, exact for what has no harmonics beyond the seventh."""
    device = {"shape": PYRAMID, "back": "same", "ageing": AGEING}
    run = simulate(load_scene(scene(device, 1, **turning("spin-averaged", spin_rpm=0.05))))
    spin, angles = 0.05 * 2 * np.pi / 60, 2 * np.pi * np.arange(8) / 8

    def rate(t, y):
        r, v, z, s, dose = y[:3], y[3:6], y[6:9], y[9], y[10] * DAY
        size = np.linalg.norm(r)
        u = r / size
        x = np.cross([0, 0, 1.0], z)
        x = x / np.linalg.norm(x)
        force, torque, shown = np.zeros(3), np.zeros(3), 0.0
        for a in angles:
            e = np.cos(a) * x + np.sin(a) * np.cross(z, x)
            axes = np.stack([e, np.cross(z, e), z], axis=-1)
            f, n, c = push(axes.T @ u, dose)
            force, torque, shown = force + axes @ f / 8, torque + axes @ n / 8, shown + c / 8
        strength = 2 * RADIATION_PRESSURE * (AU / size) ** 2
        a, torque = -MU_SUN * r / size**3 + strength * force / MASS, strength * torque
        along = torque @ z
        tilt = (torque - along * z) / (INERTIA[2] * s)
        return np.concatenate([v, a, tilt, [along / INERTIA[2], (AU / size) ** 2 * shown / DAY]])

    start = np.concatenate([run.position[0], run.velocity[0], run.attitude.normal[0], [spin, 0]])
    end = solve_ivp(rate, (0, DAY), start, "DOP853", rtol=1e-10, atol=1e-11 * np.array([*ORBIT, 1, 1, 1, 1e-3, 1]))
    end = end.y[:, -1]
    assert run.film["dose_yr"][-1] * YEAR / DAY == pytest.approx(end[10], rel=1e-8)
    np.testing.assert_allclose(run.attitude.normal[-1], end[6:9], rtol=0, atol=1e-8)
    np.testing.assert_allclose(run.position[-1], end[:3], rtol=0, atol=10)


def test_a_controlled_pyramid_that_ages_turns_as_scipy_has_it():
    """Wheels hold it 20 deg off a normal fixed in space against the light, from 48 deg off, by
    I (-2 k q - d w), w > 0, and take off nothing of the light's. Place within a metre, axes within 1e-7, the
    momentum of wheels within 1e-6, the dose within 1e-9."""
    frequency, damping, aim = 2e-3, 0.7, np.array([np.cos(0.5), np.sin(0.5) * 0.6, np.sin(0.5) * 0.8])
    wheels = {"kind": "wheels", "torque_N_m": 1, "storage_N_m_s": 100}
    control = {"kind": "pd", "frequency_rad_s": frequency, "damping": damping}
    attitude = turning("controlled", control=control, actuators=[wheels], clock_deg=220)
    device = {"shape": PYRAMID, "back": "same", "ageing": AGEING}
    steering = {"kind": "inertial", "direction": aim.tolist()}
    run = simulate(load_scene(scene(device, 0.2, **attitude, steering=steering)))

    def wanted(r, v):
        x = np.cross(np.cross(r, v), r)
        x = x - (x @ aim) * aim
        x = x / np.linalg.norm(x)
        return np.stack([x, np.cross(aim, x), aim], axis=-1)

    def rate(t, y):
        r, v, axes, w, h, dose = y[:3], y[3:6], y[6:15].reshape(3, 3), y[15:18], y[18:21], y[21] * DAY
        size = np.linalg.norm(r)
        force, torque, shown = push(axes.T @ r / size, dose)
        strength = 2 * RADIATION_PRESSURE * (AU / size) ** 2
        a = -MU_SUN * r / size**3 + strength * axes @ force / MASS
        law, step = wanted(r, v), 1.0
        spin = law.T @ (wanted(r + step * v, v + step * a) - law) / step  # of the law's axes, along themselves
        turn = law.T @ axes
        twice = np.array([turn[2, 1] - turn[1, 2], turn[0, 2] - turn[2, 0], turn[1, 0] - turn[0, 1]])
        q = twice / (2 * np.sqrt(1 + np.trace(turn)))
        off = w - turn.T @ np.array([spin[2, 1], spin[0, 2], spin[1, 0]])
        given = INERTIA * (-2 * frequency**2 * q - 2 * damping * frequency * off)
        change = (strength * torque + given - np.cross(w, INERTIA * w + h)) / INERTIA
        sun = (AU / size) ** 2 * shown / DAY
        return np.concatenate([v, a, (axes @ skew(w)).ravel(), change, -given, [sun]])

    first = rotation(run.attitude.quaternion[:1])[0]
    start = np.concatenate([run.position[0], run.velocity[0], first.ravel(), np.zeros(7)])
    end = flown(rate, start, 0.2 * DAY, [*ORBIT, *[1] * 9, *[1e-3] * 3, *[0.1] * 3, 1])
    assert (
        run.attitude.normal[0] @ aim < np.cos(np.radians(40)) < np.cos(np.radians(25)) < run.attitude.normal[-1] @ aim
    )
    assert run.film["dose_yr"][-1] * YEAR / DAY == pytest.approx(end[21], rel=1e-9)
    np.testing.assert_allclose(rotation(run.attitude.quaternion[-1:])[0], end[6:15].reshape(3, 3), rtol=0, atol=1e-7)
    np.testing.assert_allclose(run.attitude.motion["wheels_N_m_s"][-1], end[18:21], rtol=1e-6)
    np.testing.assert_allclose(run.position[-1], end[:3], rtol=0, atol=1)


ACTUATORS = {
    "vanes": {
        "control": {"kind": "pd", "frequency_rad_s": 1e-3},
        "actuators": [
            {"kind": "vane", "position_m": [6 * np.cos(a), 6 * np.sin(a), 0], "area_m2": 2, "limit_deg": 60}
            for a in (0, 2, 4)
        ],
    },
    "devices": {
        "control": {"kind": "spin-axis"},
        "rates_deg_s": [0, 0, 6],
        "actuators": [
            {"kind": "reflectivity", "position_m": [4, 0, 0], "area_m2": 2, "off": {"b1": 0.4, "b2": 0.2, "b3": 0.2}}
        ],
    },
}


@pytest.mark.parametrize("by", ACTUATORS)
def test_actuators_at_the_end_of_their_ageing_are_those_of_the_aged_film(by):
    """What vanes are set to, and where switched reflectivity turns the axis, is another thing with a fresh film."""
    attitude = turning("controlled", **ACTUATORS[by])
    cases = (
        {"back": "black", "ageing": AGEING | {"dose_yr": 1000}},
        {"back": "black", "film": aged(1e9 * HALF)},
        {"back": "black", "film": OPTICS},
    )
    runs = [simulate(load_scene(scene({"shape": SQUARE, **device}, 0.05, 3, **attitude))) for device in cases]
    names = [f"control_torque_{axis}_N_m" for axis in "xyz"]
    names += [name for name in runs[0].environment if name.endswith(("_angle_rad", "_on"))]
    for name in names:
        old, same, fresh = (run.environment[name] for run in runs)
        np.testing.assert_allclose(old, same, rtol=0, atol=1e-4 * np.abs(fresh - same).max())
    old, same = (run.attitude.quaternion for run in runs[:2])
    np.testing.assert_allclose(old, same, rtol=0, atol=1e-5)


def test_a_held_pyramid_that_ages_flies_as_scipy_has_it():
    """Pitch 35 deg towards the motion, 100 days: the dose by what its four facets show."""
    half_yr = 0.1
    device = {"shape": PYRAMID, "back": "same", "ageing": {"factor": FACTOR, "half_dose_yr": half_yr}}
    planned = scene(device, 100)
    planned["steering"]["clock_deg"] = 90
    run, pitch = simulate(load_scene(planned)), np.radians(35)

    def rate(t, y):
        r, v, dose = y[:3], y[3:6], y[6] * DAY
        size = np.linalg.norm(r)
        up, h = r / size, np.cross(r, v)
        h = h / np.linalg.norm(h)
        ahead = np.cross(h, up)
        z = np.cos(pitch) * up + np.sin(pitch) * ahead
        x = np.cos(pitch) * ahead - np.sin(pitch) * up
        axes = np.stack([x, np.cross(z, x), z], axis=-1)
        force, _, shown = push(axes.T @ up, dose * HALF / (half_yr * YEAR))
        a = -MU_SUN * up / size**2 + 2 * RADIATION_PRESSURE * (AU / size) ** 2 * axes @ force / MASS
        return np.concatenate([v, a, [(AU / size) ** 2 * shown / DAY]])

    end = flown(rate, [*run.position[0], *run.velocity[0], 0], 100 * DAY, [*ORBIT, 1])
    assert run.film["dose_yr"][-1] * YEAR / DAY == pytest.approx(end[6], rel=1e-11)
    np.testing.assert_allclose(run.position[-1], end[:3], rtol=0, atol=3)


@pytest.mark.parametrize(
    ("device", "more", "words"),
    [
        ({"back": "black", "ageing": AGEING, "film": "eta-perfect"}, {}, "needs the optics"),
    ],
)
def test_what_does_not_age_with_a_shape_is_told(device, more, words):
    with pytest.raises(SceneError, match=words):
        load_scene(scene({"shape": SQUARE, **device}, **more))
