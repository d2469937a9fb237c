"""Gravity of a planet on a circular orbit, as a craft feels it whose place is measured from the central body."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from sailviz.compiled import inlined


class Parameters(NamedTuple):
    """A planet and its circular orbit in the x-y plane."""

    mu: float  # m3/s2; 0 for none
    radius: float  # m, of its orbit
    rate: float  # rad/s, see `circular_rate`
    azimuth: float  # rad, at the start


def circular_rate(mu: float, planet_mu: float, radius: float) -> float:
    """Angular rate, rad/s, at which two bodies (m3/s2 each) circle at a distance of radius, m: both are pulled."""
    return float(np.sqrt((mu + planet_mu) / radius**3))


@inlined
def third_body_gravity(t, x, y, z, p):
    """Acceleration, m/s2, relative to the central body at the position (m) and time (s): the planet's pull on the craft
    less that on the central body, from which places are counted, mu' [(d - r) / |d - r|^3 - d / d^3]. p : Parameters.

    Written so that close to the central body, where both nearly cancel, no digits are lost: with s = |d - r| / d it is
    -mu' (r + f d) / |d - r|^3, f = s^3 - 1 = q (3 + 3 q + q^2) / (1 + s^3), q = s^2 - 1 = r (r - 2 d) / d^2.
    Source: R. H. Battin, An Introduction to the Mathematics and Methods of Astrodynamics, section 8.4; re-derived.
    """
    angle = p.azimuth + p.rate * t
    dx, dy = p.radius * np.cos(angle), p.radius * np.sin(angle)
    away_x, away_y = dx - x, dy - y
    d2 = away_x * away_x + away_y * away_y + z * z
    d = np.sqrt(d2)
    s = d / p.radius
    q = (x * (x - 2.0 * dx) + y * (y - 2.0 * dy) + z * z) / (p.radius * p.radius)
    f = q * (3.0 + q * (3.0 + q)) / (1.0 + s * s * s)
    k = -p.mu / (d2 * d)
    return k * (x + f * dx), k * (y + f * dy), k * z
