"""Attitude laws that count from the light, wherever it stands, in compiled code.

u is the unit vector from the light to the craft. Source: as LightSail 2 flew (on and off by turns of 90 deg): The
Planetary Society (2019); the frame re-derived from the meridian frame of the thesis, section 3.1.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from sailviz.compiled import inlined

NO_LAW, FACING, FRAME, ON_OFF, PRIMER = range(5)  # a law of steering.attitude; these; along a primer
PLANELESS = 1e-9  # sine of the angle between the light and the orbit's axis below which that says no direction


class Parameters(NamedTuple):
    """A law that counts from the light."""

    law: int = NO_LAW
    along: float = 1.0  # components of the normal of FRAME: along u,
    east: float = 0.0  # along N x u, the clock angle's quarter turn,
    north: float = 0.0  # and along u x (N x u), towards N
    pole_x: float = 0.0  # N, the north pole of the ecliptic
    pole_y: float = 0.0
    pole_z: float = 1.0
    by_orbit: int = 0  # 1: N is the orbit's axis instead
    edge_on: int = 0  # 1: in full shadow the sail stands edge-on to light and flow
    lowest: float = 0.0  # m, distance below which the periapsis must not sink; 0: none
    margin: float = 0.0  # m above it, over which the law gives way


@inlined
def light_axes(ux, uy, uz, x, y, z, vx, vy, vz, p):
    """(e, w): the axes beside u of the light's frame: e = N x u, w = u x e. p : Parameters."""
    px, py, pz = p.pole_x, p.pole_y, p.pole_z
    if p.by_orbit != 0:
        hx, hy, hz = y * vz - z * vy, z * vx - x * vz, x * vy - y * vx
        cx, cy, cz = hy * uz - hz * uy, hz * ux - hx * uz, hx * uy - hy * ux
        if cx * cx + cy * cy + cz * cz > PLANELESS * PLANELESS * (hx * hx + hy * hy + hz * hz):
            px, py, pz = hx, hy, hz
    ex, ey, ez = py * uz - pz * uy, pz * ux - px * uz, px * uy - py * ux
    inverse = 1.0 / np.sqrt(ex * ex + ey * ey + ez * ez)
    ex, ey, ez = ex * inverse, ey * inverse, ez * inverse
    return ex, ey, ez, uy * ez - uz * ey, uz * ex - ux * ez, ux * ey - uy * ex


@inlined
def frame_direction(ux, uy, uz, x, y, z, vx, vy, vz, p):
    """The normal of FRAME. p : Parameters."""
    ex, ey, ez, wx, wy, wz = light_axes(ux, uy, uz, x, y, z, vx, vy, vz, p)
    return (
        p.along * ux + p.east * ex + p.north * wx,
        p.along * uy + p.east * ey + p.north * wy,
        p.along * uz + p.east * ez + p.north * wz,
    )


@inlined
def edge_on(ux, uy, uz, vx, vy, vz):
    """u x v / |u x v|: neither light nor flow falls on the sail. Where they are along one line, any normal to it."""
    nx, ny, nz = uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx
    n2 = nx * nx + ny * ny + nz * nz
    if n2 <= 1e-24 * (vx * vx + vy * vy + vz * vz):
        nx, ny, nz = (0.0, uz, -uy) if abs(ux) < 0.9 else (-uz, 0.0, ux)
        n2 = nx * nx + ny * ny + nz * nz
    inverse = 1.0 / np.sqrt(n2)
    return nx * inverse, ny * inverse, nz * inverse
