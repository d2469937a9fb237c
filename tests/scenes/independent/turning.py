"""Craft that turn, in plain numpy: position, velocity, direction cosines, body rate; light and air facet by facet."""

from __future__ import annotations

import numpy as np
from independent.constants import AU, ROTATION, body
from independent.film import film_of
from scipy.integrate import solve_ivp

PRESSURE = 4.563e-6  # N/m2 at 1 au


def facets(shape):
    """(centre m, normal away from the Sun, area m2) of every facet of a flat square or a pyramid."""
    if shape.kind == "square":
        assert shape.cone == 0
        assert shape.sag == 0
        return [(np.zeros(3), np.array([0, 0, 1.0]), shape.side**2)]
    assert shape.kind == "pyramid"
    found = []
    half, c, s = shape.opening / 2, np.cos(shape.cone), np.sin(shape.cone)
    bearings = [-half, half, np.pi - half, np.pi + half]
    tips = [shape.boom * np.array([c * np.cos(a), c * np.sin(a), s]) for a in bearings]
    for i, tip in enumerate(tips):
        across = np.cross(tip, tips[(i + 1) % 4]) / 2
        across = across if across[2] > 0 else -across
        found.append(((tip + tips[(i + 1) % 4]) / 3, across / np.linalg.norm(across), np.linalg.norm(across)))
    return found


def sides(device):
    """b1, b2, b3 of front and back."""
    front = np.array(film_of(device)[:3])
    if device.back == "same":
        return front, front
    assert device.film == "jpl-2015"
    assert device.back == "black"
    ef, eb, bf, bb = 0.025, 0.27, 0.79, 0.67  # table 3.1
    lost = (eb * bb - ef * bf) / (ef + eb)  # what a black back takes in, both sides radiate
    return front, np.array([0.5, 0.0, lost / 2])


def light(scene, r):
    """(unit vector along the light, its pressure N/m2, twice) at a place."""
    away = r
    if scene.light is not None:
        away = r - scene.light.distance * np.array(scene.light.direction) / np.linalg.norm(scene.light.direction)
    distance = np.linalg.norm(away)
    return away / distance, 2 * PRESSURE * (AU / distance) ** 2


def push(scene, u, strength):
    """(force N, torque N m about the shape's origin), body axes."""
    (front, back), force, torque = sides(scene.device), np.zeros(3), np.zeros(3)
    for centre, normal, area in facets(scene.device.shape):
        c = normal @ u
        b1, b2, b3 = front if c > 0 else back
        one = strength * area * abs(c) * (b1 * u + (b2 * abs(c) + b3) * np.sign(c) * normal)
        force, torque = force + one, torque + np.cross(centre, one)
    return force, torque


def blow(scene, axes, r, v):
    """(force N, torque N m about the shape's origin), body axes, of hyperthermal air on both sides of the facets."""
    said, air = scene.device.shape.air, scene.environment.atmosphere
    if said is None or air is None:
        return np.zeros(3), np.zeros(3)
    assert said.law == "hyperthermal"
    assert air.kind == "exponential"
    relative = v - np.cross([0, 0, ROTATION if scene.environment.corotation else 0.0], r)
    speed, height = np.linalg.norm(relative), np.linalg.norm(r) - body(scene)[1]
    density = air.density * np.exp((air.reference_altitude - height) / air.scale_height)
    b1, b2 = said.tangential_accommodation / 2, (2 - said.normal_accommodation - said.tangential_accommodation) / 2
    b3 = said.normal_accommodation * np.sqrt(np.pi * said.wall_temperature_ratio) / (4 * said.speed_ratio)
    u, force, torque = -axes.T @ relative / speed, np.zeros(3), np.zeros(3)
    for centre, normal, area in facets(scene.device.shape):
        c = normal @ u
        one = 2 * density * speed**2 * area * abs(c) * (b1 * u + (b2 * abs(c) + b3) * np.sign(c) * normal)
        force, torque = force + one, torque + np.cross(centre, one)
    return force, torque


def wanted(scene, t, r, v):
    """Axes (3, 3), columns, of a table of pitch and clock in the orbital frame."""
    law = scene.steering
    pitch, clock = np.interp(t, law.time, law.pitch), np.interp(t, law.time, law.clock)
    up, h = r / np.linalg.norm(r), np.cross(r, v)
    h = h / np.linalg.norm(h)
    ahead = np.cross(h, up)
    z = np.cos(pitch) * up + np.sin(pitch) * (np.sin(clock) * ahead + np.cos(clock) * h)
    x = ahead - (ahead @ z) * z
    x = x / np.linalg.norm(x)
    return np.stack([x, np.cross(z, x), z], axis=-1)


def skew(w):
    return np.array([[0, -w[2], w[1]], [w[2], 0, -w[0]], [-w[1], w[0], 0]])


def vector(turn):
    """Axis times the sine of half the angle of a rotation (3, 3), up to half a turn."""
    twice = np.array([turn[2, 1] - turn[1, 2], turn[0, 2] - turn[2, 0], turn[1, 0] - turn[0, 1]])
    return twice / (2 * np.sqrt(max(1 + np.trace(turn), 1e-12)))


def integrate_turning(scene, run, times):
    """Position (n, 3) m at times (n,) s, from the first row of a run: its place and, of its attitude, the axes."""
    said, mass, mu = scene.attitude, scene.device.mass, body(scene)[0]
    inertia = np.array(said.inertia)
    centre = np.array(said.centre_of_mass)
    x, y, z, w = run.attitude.quaternion[0]
    axes = np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )
    slide = next((one for one in getattr(said, "actuators", []) if one.kind == "sliding-mass"), None)

    def turning(t, y):
        r, v, axes, w, place = y[:3], y[3:6], y[6:15].reshape(3, 3), y[15:18], y[18:]
        u, strength = light(scene, r)
        force, torque = (a + b for a, b in zip(push(scene, axes.T @ u, strength), blow(scene, axes, r, v), strict=True))
        rate = np.zeros(2)
        c = centre.copy()
        if slide is not None:
            c[:2] += slide.mass / mass * place
        torque = torque - np.cross(c, force)
        if said.gravity_gradient:
            up = axes.T @ r / np.linalg.norm(r)
            torque = torque + 3 * mu / np.linalg.norm(r) ** 3 * np.cross(up, inertia * up)
        if slide is not None:
            f = said.control.frequency
            law = wanted(scene, t, r, v)
            later = wanted(scene, t + 1, r + v, v - mu * r / np.linalg.norm(r) ** 3)
            spin = 2 * vector(law.T @ later)
            error = law.T @ axes
            asked = inertia * (-2 * f * f * vector(error) - 2 * said.control.damping * f * (w - error.T @ spin))
            more = (asked - torque) / (slide.mass / mass * force[2])
            aim = np.clip(place + np.array([more[1], -more[0]]), -slide.travel, slide.travel)
            rate = np.clip(10 * f * (aim - place), -slide.speed, slide.speed)
        a = -mu * r / np.linalg.norm(r) ** 3 + axes @ force / mass
        return np.concatenate([v, a, (axes @ skew(w)).ravel(), (torque - np.cross(w, inertia * w)) / inertia, rate])

    def averaged(t, y):
        r, v, n = y[:3], y[3:6], y[6:9]
        u, strength = light(scene, r)
        z = np.array([0, 0, 1.0])
        c = n @ u
        across = u - c * n
        in_body = np.array([np.linalg.norm(across), 0, c])
        force, torque = push(scene, in_body, strength)  # a flat square: the same at every turn
        torque = torque - np.cross(centre * z, force)
        e = across / max(np.linalg.norm(across), 1e-300)
        frame = np.stack([e, np.cross(n, e), n], axis=-1)
        torque = frame @ torque
        up = r / np.linalg.norm(r)
        torque = torque + 3 * mu / np.linalg.norm(r) ** 3 * (inertia[2] - inertia[0]) * (up @ n) * np.cross(up, n)
        a = -mu * r / np.linalg.norm(r) ** 3 + frame @ force / mass
        return np.concatenate([v, a, torque / (inertia[2] * said.spin)])

    r, v = run.position[0], run.velocity[0]
    scale = np.linalg.norm(r)
    orbit = [1e-13 * scale] * 3 + [1e-13 * np.linalg.norm(v)] * 3
    if said.kind == "spin-averaged":
        start, rhs, atol = np.concatenate([r, v, axes[:, 2]]), averaged, [*orbit, *[1e-12] * 3]
    else:
        rates = np.array(said.rates) if said.rates is not None else np.zeros(3)
        start = np.concatenate([r, v, axes.ravel(), rates, [0, 0]])
        rhs, atol = turning, [*orbit, *[1e-10] * 9, *[1e-13] * 3, *[1e-9] * 2]
    return solve_ivp(rhs, (0, times[-1]), start, "DOP853", times, rtol=1e-9, atol=atol).y[:3].T
