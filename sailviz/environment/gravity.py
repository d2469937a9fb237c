"""Gravity of the central body: a point mass and its zonal harmonics; and the height above an oblate Earth."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from sailviz.compiled import inlined
from sailviz.constants import FLATTENING_EARTH, RADIUS_EARTH


class Parameters(NamedTuple):
    """What `gravity` knows of the central body; the strengths as in `strengths`."""

    mu: float  # m3/s2; gauss_jackson, which adds the central pull itself, puts a 0 here
    j2_strength: float = 0.0  # m5/s2
    j3_strength: float = 0.0  # m6/s2
    j4_strength: float = 0.0  # m7/s2


@inlined
def gravity(x, y, z, inverse, mu, j2_strength, j3_strength=0.0, j4_strength=0.0):
    """Acceleration, m/s2. inverse = 1 / |position| in 1/m, mu in m3/s2, z along the pole. The strengths are
    1.5 J2 mu R^2 in m5/s2, 0.5 J3 mu R^3 in m6/s2 and 0.125 J4 mu R^4 in m7/s2 (`strengths`); without the first the
    body is a sphere.

    Source of the J2 term: Vallado, Fundamentals of Astrodynamics and Applications, section 8.6. The others re-derived:
    the potential (mu/r) J_n (R/r)^n P_n(u), u = z/r, pulls with mu J_n R^n / r^(n+2) (P'_(n+1) r_hat - P'_n z_hat).
    """
    inverse2 = inverse * inverse
    k = -mu * inverse2 * inverse
    if j2_strength == 0.0:
        return k * x, k * y, k * z
    q = j2_strength * inverse2 * inverse2 * inverse
    u2 = z * z * inverse2
    s = 5.0 * u2
    if j3_strength == 0.0 and j4_strength == 0.0:
        return (k + q * (s - 1.0)) * x, (k + q * (s - 1.0)) * y, (k + q * (s - 3.0)) * z
    radial, polar = k + q * (s - 1.0), -2.0 * q * z
    if j3_strength != 0.0:
        c = j3_strength * inverse2 * inverse2 * inverse
        radial += c * z * inverse2 * (35.0 * u2 - 15.0)
        polar -= c * (15.0 * u2 - 3.0)
    if j4_strength != 0.0:
        c = j4_strength * inverse2 * inverse2 * inverse2 * inverse
        radial += c * ((315.0 * u2 - 210.0) * u2 + 15.0)
        polar -= c * z * (140.0 * u2 - 60.0)
    return radial * x, radial * y, radial * z + polar


def strengths(mu, radius, j2=0.0, j3=0.0, j4=0.0):
    """The three strengths that `gravity` asks for, from mu m3/s2, the equatorial radius m and unnormalised J_n."""
    return 1.5 * j2 * mu * radius**2, 0.5 * j3 * mu * radius**3, 0.125 * j4 * mu * radius**4


@inlined
def geodetic_altitude(z, r):
    """Height, m, above the ellipsoid WGS 84 at a distance r (m) from the Earth's centre, z (m) of it along the pole.

    The way d along the radius down to the ellipsoid, shortened since the normal leans by delta from the radius:
    d (1 - delta^2 (r - d) / (2 r)). Re-derived; at most 0.06 m off the exact height up to 1500 km, 0.21 m up to
    40,000 km. d alone would be up to 6.8 m too much at 1500 km, and the height above a sphere 21.4 km too little at
    the poles.
    """
    squash = (2.0 - FLATTENING_EARTH) * FLATTENING_EARTH  # e^2
    u2 = z * z / (r * r)
    cos2 = 1.0 - u2
    surface = RADIUS_EARTH * np.sqrt((1.0 - squash) / (1.0 - squash * cos2))
    lean2 = squash * squash * u2 * cos2
    d = r - surface
    return d * (1.0 - 0.5 * lean2 * surface / r)
