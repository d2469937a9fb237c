"""Motions known in closed form, by the names that [[expect]] takes: what a run must be, given its first row.

Each needs the state in which the run starts and nothing else, so that it judges propagation, forces and steering at
once.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from sailviz import ephemeris, two_body
from sailviz.run.arrays import Run

Motion = Callable[[np.ndarray], np.ndarray]  # times (n,) s after the first row -> positions (n, 3) m


def kepler(start: Run) -> Motion:
    """A conic round the central body: flight without thrust.

    Ellipses by Lagrange's f and g in differences of the eccentric anomaly, which holds over many turns; parabolas,
    hyperbolas and what is close to them by universal variables, in two_body.py. Source: Battin, An Introduction to the
    Mathematics and Methods of Astrodynamics (1999), section 4.4, not read but re-derived.
    """
    r_vec, v_vec, mu = start.position[0], start.velocity[0], start.setting.body.mu
    r, sigma = np.linalg.norm(r_vec), r_vec @ v_vec / np.sqrt(mu)
    alpha = 2 / r - v_vec @ v_vec / mu  # 1 / a

    def ellipse(time: np.ndarray) -> np.ndarray:
        a = 1 / alpha
        e_cos, e_sin = 1 - r / a, sigma / np.sqrt(a)
        e, first = np.hypot(e_cos, e_sin), np.arctan2(e_sin, e_cos)
        anomaly = ephemeris.eccentric_anomaly(first - e_sin + np.sqrt(mu / a**3) * time, e)
        c, s = np.cos(anomaly - first), np.sin(anomaly - first)
        f = 1 - a / r * (1 - c)
        g = a * sigma / np.sqrt(mu) * (1 - c) + r * np.sqrt(a / mu) * s
        place: np.ndarray = f[:, None] * r_vec + g[:, None] * v_vec
        return place

    def any_conic(time: np.ndarray) -> np.ndarray:
        rows = len(time)
        return two_body.advance(np.tile(r_vec, (rows, 1)), np.tile(v_vec, (rows, 1)), time, mu)[0]

    return ellipse if alpha * r > 0.05 else any_conic


def reduced_kepler(start: Run) -> Motion:
    """A conic under the gravity that radial thrust falling as 1/r^2 leaves: an ideal sail that faces the Sun."""
    body = start.setting.body
    outward = start.thrust.acceleration[0] @ start.position[0] / np.linalg.norm(start.position[0])
    left = replace(body, mu=body.mu - outward * (start.position[0] @ start.position[0]))
    return kepler(replace(start, setting=replace(start.setting, body=left)))


def displaced_orbit(start: Run) -> Motion:
    """A circle about the z axis at constant rate, at any height over the plane. Source: thesis, section 4.2."""
    x, y, z = start.position[0]
    rho2 = x * x + y * y
    rate = (x * start.velocity[0, 1] - y * start.velocity[0, 0]) / rho2

    def motion(time: np.ndarray) -> np.ndarray:
        c, s = np.cos(rate * time), np.sin(rate * time)
        return np.stack([x * c - y * s, x * s + y * c, np.full_like(c, z)], axis=1)

    return motion


def logarithmic_spiral(start: Run) -> Motion:
    """r = r0 exp(theta tan(gamma)) in the plane of the first row, its speed falling as 1/sqrt(r).

    From r' = v_r0 sqrt(r0/r): r^1.5 = r0^1.5 + 1.5 v_r0 sqrt(r0) t, theta = ln(r/r0) / tan(gamma).
    """
    r_vec, v_vec = start.position[0], start.velocity[0]
    r0 = np.linalg.norm(r_vec)
    r_hat = r_vec / r0
    v_r = v_vec @ r_hat
    t_vec = v_vec - v_r * r_hat
    v_t = np.linalg.norm(t_vec)
    t_hat = t_vec / v_t

    def motion(time: np.ndarray) -> np.ndarray:
        u = 1.5 * v_r * time / r0
        with np.errstate(invalid="ignore"):
            r = r0 * (1 + u) ** (2 / 3)
            grown = np.log1p(u) * 2 / 3
        theta = v_t / r0 * time if v_r == 0 else grown * v_t / v_r
        return r[:, None] * (np.cos(theta)[:, None] * r_hat + np.sin(theta)[:, None] * t_hat)

    return motion


FORMS: dict[str, Callable[[Run], Motion]] = {
    "kepler": kepler,
    "reduced-kepler": reduced_kepler,
    "displaced-orbit": displaced_orbit,
    "logarithmic-spiral": logarithmic_spiral,
}


def error(motion: Motion, start: float, run: Run) -> np.ndarray:
    """Distance of each row from the closed form, over the closed form's distance from the body. start : s. (n,)"""
    position = motion(run.time - start)
    return np.linalg.norm(run.position - position, axis=1) / np.linalg.norm(position, axis=1)
