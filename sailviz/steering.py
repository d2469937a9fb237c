"""Attitude laws: which way the sail normal (or a thruster) points, given time and state.

Clock angles run from h_hat towards t_hat in the orbital frame (h_hat the osculating angular momentum), from the meridian
upwards towards increasing longitude in the meridian frame. Source: thesis, section 3.1; definitions of both frames as used
for displaced orbits.
"""

from __future__ import annotations

import numpy as np

from sailviz.compiled import inlined

RADIAL, ORBITAL, MERIDIAN, TRANSVERSE, TANGENTIAL, INERTIAL, TABLE_ORBITAL, TABLE_MERIDIAN, USER = range(9)

# name in a scene -> id; "radial" and "sun-facing" are one law under the words of two trades
LAWS = {
    "radial": RADIAL,
    "sun-facing": RADIAL,
    "vertical": RADIAL,
    "orbital": ORBITAL,
    "meridian": MERIDIAN,
    "circumferential": TRANSVERSE,
    "tangential": TANGENTIAL,
    "inertial": INERTIAL,
}


def direction_parameters(pitch, clock):
    """(along r_hat, along t_hat, along h_hat) of a normal at fixed pitch and clock, rad: (3.6)-(3.8)."""
    return (np.cos(pitch), np.sin(pitch) * np.sin(clock), np.sin(pitch) * np.cos(clock))


@inlined
def orbital_direction(ux, uy, uz, x, y, z, vx, vy, vz, n_r, n_t, n_h):
    """n_r r_hat + n_t t_hat + n_h h_hat in inertial axes; u = r_hat. NaN where the craft has no angular momentum."""
    hx, hy, hz = y * vz - z * vy, z * vx - x * vz, x * vy - y * vx
    inverse = 1.0 / np.sqrt(hx * hx + hy * hy + hz * hz)
    hx, hy, hz = hx * inverse, hy * inverse, hz * inverse
    tx, ty, tz = hy * uz - hz * uy, hz * ux - hx * uz, hx * uy - hy * ux
    return n_r * ux + n_t * tx + n_h * hx, n_r * uy + n_t * ty + n_h * hy, n_r * uz + n_t * tz + n_h * hz


@inlined
def meridian_direction(ux, uy, uz, n_r, n_east, n_north):
    """n_r r_hat + n_east e + n_north p: e towards increasing longitude, p = towards the pole in the meridian plane."""
    inverse = 1.0 / np.sqrt(ux * ux + uy * uy)  # NaN on the pole, where there is no meridian
    ex, ey = -uy * inverse, ux * inverse
    px, py, pz = -uz * ey, uz * ex, ux * ey - uy * ex
    return n_r * ux + n_east * ex + n_north * px, n_r * uy + n_east * ey + n_north * py, n_r * uz + n_north * pz


@inlined
def table_angles(t, p, first, held):
    """Pitch and clock, rad, at time t from the rows (time, pitch, clock) that fill p from place `first` on: linear between
    rows, or held from row to row."""
    low, high = 0, (len(p) - first) // 3 - 1
    if t <= p[first]:
        return p[first + 1], p[first + 2]
    if t >= p[first + 3 * high]:
        return p[first + 3 * high + 1], p[first + 3 * high + 2]
    while high - low > 1:
        middle = (low + high) // 2
        if p[first + 3 * middle] <= t:
            low = middle
        else:
            high = middle
    a, b = first + 3 * low, first + 3 * high
    w = 0.0 if held else (t - p[a]) / (p[b] - p[a])
    return p[a + 1] + w * (p[b + 1] - p[a + 1]), p[a + 2] + w * (p[b + 2] - p[a + 2])
