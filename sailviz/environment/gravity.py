"""Gravity of the central body: a point mass, and its oblateness."""

from __future__ import annotations

from sailviz.compiled import inlined


@inlined
def gravity(x, y, z, inverse, mu, j2_strength):
    """Acceleration, m/s2. inverse = 1 / |position| in 1/m, mu in m3/s2, j2_strength = 1.5 J2 mu R^2 in m5/s2 (0 for a
    sphere), z along the pole.

    Source of the J2 term: Vallado, Fundamentals of Astrodynamics and Applications, section 8.6.
    """
    inverse2 = inverse * inverse
    k = -mu * inverse2 * inverse
    if j2_strength == 0.0:
        return k * x, k * y, k * z
    q = j2_strength * inverse2 * inverse2 * inverse
    s = 5.0 * z * z * inverse2
    return (k + q * (s - 1.0)) * x, (k + q * (s - 1.0)) * y, (k + q * (s - 3.0)) * z
