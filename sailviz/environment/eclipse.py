"""The Earth's shadow: as a cylinder, or with umbra and penumbra, and the share of a circular orbit that lies in it.

The Earth is a sphere of its equatorial radius and has no air. At the poles the true limb lies 21 km lower, which a
craft in low orbit crosses in up to 7 s; light bent by the air is left out.
"""

from __future__ import annotations

import numpy as np

from sailviz.compiled import inlined
from sailviz.constants import AU, RADIUS_SUN

NO_SHADOW, CYLINDER, CONE = 0, 1, 2
SHADOWS = {"none": NO_SHADOW, "cylindrical": CYLINDER, "conical": CONE}


@inlined
def cylindrical(x, y, z, sx, sy, sz, radius):
    """1 in sunlight, 0 in a shadow of the body's radius (m) that does not narrow. Position m, s the unit vector to the
    Sun."""
    depth = -(x * sx + y * sy + z * sz)
    if depth <= 0.0:
        return 1.0
    return 0.0 if x * x + y * y + z * z - depth * depth < radius * radius else 1.0


@inlined
def lit_of_discs(a, b, c):
    """Share of a disc of radius a that one of radius b leaves free, their middles c apart; all rad."""
    if c >= a + b:
        return 1.0
    if c <= b - a:
        return 0.0
    if c <= a - b:
        return 1.0 - b * b / (a * a)
    q = (c * c + a * a - b * b) / (2.0 * c)
    h = np.sqrt(max(a * a - q * q, 0.0))
    covered = (
        a * a * np.arccos(max(-1.0, min(q / a, 1.0))) + b * b * np.arccos(max(-1.0, min((c - q) / b, 1.0))) - c * h
    )
    return 1.0 - covered / (np.pi * a * a)


@inlined
def conical(x, y, z, sx, sy, sz, radius):
    """Illuminated share of the Sun's disc, 0 (umbra) to 1, behind a sphere of a radius (m); the Sun is 1 au away.

    Both discs are taken as flat, with the angular radii that the craft sees.
    Source: O. Montenbruck and E. Gill, Satellite Orbits, section 3.4.2; the annular case is added.
    """
    depth = -(x * sx + y * sy + z * sz)
    if depth <= 0.0:
        return 1.0
    r2 = x * x + y * y + z * z
    off = np.sqrt(max(r2 - depth * depth, 0.0))
    # The cones that touch both spheres, from inside and from outside, decide nearly always, and cheaply
    outer, inner = (RADIUS_SUN + radius) / AU, (RADIUS_SUN - radius) / AU
    if off >= (radius + depth * outer) / np.sqrt(1.0 - outer * outer):
        return 1.0
    if off <= (radius - depth * inner) / np.sqrt(1.0 - inner * inner):
        return 0.0
    dx, dy, dz = AU * sx - x, AU * sy - y, AU * sz - z
    d2 = dx * dx + dy * dy + dz * dz
    a = np.arcsin(RADIUS_SUN / np.sqrt(d2))
    b = np.arcsin(min(radius / np.sqrt(r2), 1.0))
    c = np.arccos(max(-1.0, min(-(x * dx + y * dy + z * dz) / np.sqrt(r2 * d2), 1.0)))
    return lit_of_discs(a, b, c)


@inlined
def sunlit(kind, x, y, z, sx, sy, sz, radius):
    """Illuminated share of the Sun's disc, 0 to 1, by a kind of SHADOWS; arguments as in `conical`."""
    if kind == CYLINDER:
        return cylindrical(x, y, z, sx, sy, sz, radius)
    if kind == CONE:
        return conical(x, y, z, sx, sy, sz, radius)
    return 1.0


def circular_fraction(orbit_radius, body_radius, beta=0.0):
    """Share of a circular orbit's period inside the cylindrical shadow, 0 to below 0.5.

    Radii m; beta rad, the Sun's elevation above the orbit's plane; scalars or arrays. Re-derived: the shadow covers the
    arc on which cos(beta) cos(angle from the midnight point) > sqrt(1 - (R / r)^2).
    """
    ratio = np.sqrt(1 - (np.asarray(body_radius) / orbit_radius) ** 2)
    return np.arccos(np.minimum(ratio / np.maximum(np.cos(beta), 1e-300), 1.0)) / np.pi
