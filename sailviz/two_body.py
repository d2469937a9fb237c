"""Motion on a conic, from one state to another time: universal variables, any conic, any span.

Source: Battin, An Introduction to the Mathematics and Methods of Astrodynamics (1999), section 4.5; not read but
re-derived.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

Floats = NDArray[np.float64]


def advance(position: ArrayLike, velocity: ArrayLike, span: ArrayLike, mu: float) -> tuple[Floats, Floats]:
    """Position (n, 3) m and velocity (n, 3) m/s after spans (n,) s of flight without thrust.

    position (n, 3) m, velocity (n, 3) m/s from the attracting body, mu m3/s2. Ellipses are taken modulo their period,
    so that many turns cost no accuracy but that of the period. NaN where a state is not finite or at the centre.
    """
    r_vec, v_vec, dt = np.array(position, float), np.array(velocity, float), np.array(span, float)
    r, v2 = np.linalg.norm(r_vec, axis=1), np.sum(v_vec * v_vec, axis=1)
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        alpha = 2 / r - v2 / mu  # 1 / a
        period = np.where(alpha * r > 1e-6, 2 * np.pi / np.sqrt(mu * np.abs(alpha) ** 3), np.inf)
        dt = np.where(np.isfinite(period), dt - period * np.round(dt / period), dt)
        sigma = np.sum(r_vec * v_vec, axis=1) / np.sqrt(mu)
        x = _universal_anomaly(r, sigma, alpha, np.sqrt(mu) * dt)
        c2, c3 = stumpff(alpha * x * x)
        f, g = 1 - x * x * c2 / r, dt - x**3 * c3 / np.sqrt(mu)
        new = f[:, None] * r_vec + g[:, None] * v_vec
        far = np.linalg.norm(new, axis=1)
        f_rate, g_rate = np.sqrt(mu) / (far * r) * x * (alpha * x * x * c3 - 1), 1 - x * x * c2 / far
        return new, f_rate[:, None] * r_vec + g_rate[:, None] * v_vec


def _universal_anomaly(r: Floats, sigma: Floats, alpha: Floats, due: Floats) -> Floats:
    """x (n,) at which Kepler's equation in universal variables equals `due` = sqrt(mu) t. It rises with x, its slope
    being the distance: Newton's step where that stays within the bracket, else halving it."""
    forth = np.where(due < 0, -1.0, 1.0)  # backwards in time is forwards with the radial speed reversed
    sigma, due = forth * sigma, np.abs(due)

    def miss(x: Floats) -> tuple[Floats, Floats]:
        c2, c3 = stumpff(alpha * x * x)
        slope = sigma * x * (1 - alpha * x * x * c3) + (1 - alpha * r) * x * x * c2 + r
        return sigma * x * x * c2 + (1 - alpha * r) * x**3 * c3 + r * x - due, slope

    low, high = np.zeros_like(r), np.minimum(due / r, np.cbrt(6 * due))
    for _ in range(60):
        short = miss(high)[0] < 0
        if not np.any(short):
            break
        low, high = np.where(short, high, low), np.where(short, 2 * high, high)
    x = 0.5 * (low + high)
    for _ in range(100):
        off, slope = miss(x)
        low, high = np.where(off < 0, x, low), np.where(off < 0, high, x)
        step = x - off / slope
        new = np.where((step > low) & (step < high), step, 0.5 * (low + high))
        settled = (np.abs(new - x) <= 4e-15 * np.abs(x)) | (high - low <= 1e-15 * high) | ~np.isfinite(off)
        x = new
        if np.all(settled):
            break
    return forth * x


def stumpff(z: Floats) -> tuple[Floats, Floats]:
    """(1 - cos sqrt z) / z and (sqrt z - sin sqrt z) / sqrt z^3, and what they become for z <= 0. (n,) -> two (n,)"""
    q = np.sqrt(np.maximum(np.abs(z), 1e-300))
    with np.errstate(over="ignore", invalid="ignore"):
        far2 = np.where(z > 0, 2 * np.sin(q / 2) ** 2, 2 * np.sinh(q / 2) ** 2) / q**2
        far3 = np.where(z > 0, q - np.sin(q), np.sinh(q) - q) / q**3
    near2 = near3 = np.zeros_like(z)
    for k in range(11, -1, -1):  # Horner's scheme of sum (-z)^k / (2k + 2)! and / (2k + 3)!
        near2 = near2 * -z + 1 / math.factorial(2 * k + 2)
        near3 = near3 * -z + 1 / math.factorial(2 * k + 3)
    return np.where(np.abs(z) < 1, near2, far2), np.where(np.abs(z) < 1, near3, far3)
