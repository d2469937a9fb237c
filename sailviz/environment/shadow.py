"""How much of the light a body hides, from any distance: the lit share of the light's disc, and where that begins.

A body is a sphere without air. Sources: O. Montenbruck and E. Gill, Satellite Orbits (2000), section 3.4.2; the cones
re-derived.
"""

from __future__ import annotations

import numpy as np

from sailviz.compiled import called, inlined
from sailviz.environment.eclipse import lit_of_discs

PENUMBRA, UMBRA, SHARP = range(3)  # edges of a shadow: of the penumbra, of umbra and antumbra, of a cylinder


@called
def lit_share(x, y, z, lx, ly, lz, radius, light_radius):
    """Lit share of the light's disc, 0 to 1, at a place (m) relative to the body, which hides it. l : the light from
    there, m; radii m."""
    r2 = x * x + y * y + z * z
    dx, dy, dz = lx - x, ly - y, lz - z
    d2 = dx * dx + dy * dy + dz * dz
    along = -(x * dx + y * dy + z * dz)  # towards the body, towards the light
    if along <= 0.0 or r2 >= d2:
        return 1.0
    a = np.arcsin(min(light_radius / np.sqrt(d2), 1.0))
    b = np.arcsin(min(radius / np.sqrt(r2), 1.0))
    cx, cy, cz = y * dz - z * dy, z * dx - x * dz, x * dy - y * dx
    g = np.arctan2(np.sqrt(cx * cx + cy * cy + cz * cz), along)  # the arc cosine would lose digits where they meet
    return lit_of_discs(a, b, g)


@inlined
def edge_distance(edge, x, y, z, lx, ly, lz, radius, light_radius):
    """Distance, m, from a place to an edge of the shadow, positive outside; arguments as in `lit_share`. On the day
    side no more than the distance to the body's night side."""
    distance = np.sqrt(lx * lx + ly * ly + lz * lz)
    depth = -(x * lx + y * ly + z * lz) / distance
    across = np.sqrt(max(x * x + y * y + z * z - depth * depth, 0.0))
    if depth <= 0.0:
        beside = max(across - radius, 0.0)
        return np.sqrt(beside * beside + depth * depth)
    if edge == SHARP:
        return across - radius
    lean = (light_radius + radius if edge == PENUMBRA else light_radius - radius) / distance
    upright = np.sqrt(1.0 - lean * lean)
    if edge == PENUMBRA:
        return across * upright - depth * lean - radius
    return across * upright - abs(radius - depth * lean)
