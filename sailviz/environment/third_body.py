"""Pull of a planet on a circular orbit beside that of the central body."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from sailviz.compiled import inlined


class Parameters(NamedTuple):
    """A planet and its circular orbit in the x-y plane."""

    mu: float  # m3/s2; 0 for none
    radius: float  # m, of its orbit
    rate: float  # rad/s
    azimuth: float  # rad, at the start


@inlined
def third_body_gravity(t, x, y, z, p):
    """Acceleration, m/s2, at the position (m) and time (s), the central body held fixed: the fall of the central body
    towards the other, mu' / R'^2, is neglected (3e-6 of the Sun's pull for the Earth). p : Parameters."""
    angle = p.azimuth + p.rate * t
    dx, dy = p.radius * np.cos(angle) - x, p.radius * np.sin(angle) - y
    d2 = dx * dx + dy * dy + z * z
    k = p.mu / (d2 * np.sqrt(d2))
    return k * dx, k * dy, -k * z
