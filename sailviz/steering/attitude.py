"""Attitude laws: which way the sail normal (or a thruster) points, given time and state.

Clock angles run from h_hat towards t_hat in the orbital frame (h_hat the osculating angular momentum), from the
meridian upwards towards increasing longitude in the meridian frame. Source: thesis, section 3.1; definitions of both
frames as used for displaced orbits.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from sailviz.compiled import inlined
from sailviz.steering.optimal import analytic_pitch, optimal_pitch  # noqa: F401  part of this module's face

RADIAL, ORBITAL, MERIDIAN, TRANSVERSE, TANGENTIAL, INERTIAL, TABLE_ORBITAL, TABLE_MERIDIAN, USER = range(9)
PRIMER, LOCAL, LYAPUNOV = range(9, 12)  # towards the most thrust along a primer: from a table, for an element, for all
ARCS = 13  # a primer from a table, whose thrust is told arc by arc (of `primer.kind`; the steering is PRIMER)
CALLED = 12  # a law of one's own, a C function called by its address, as are those three

# name in a scene -> id; "radial" and "sun-facing" are one law under the words of two trades
LAWS = {
    "radial": RADIAL,
    "sun-facing": RADIAL,
    "vertical": RADIAL,
    "gravity-gradient": RADIAL,  # and the brake leans from there
    "spinning": RADIAL,
    "orbital": ORBITAL,
    "meridian": MERIDIAN,
    "circumferential": TRANSVERSE,
    "tangential": TANGENTIAL,
    "inertial": INERTIAL,
}


class Components(NamedTuple):
    """A unit vector in the orbital frame, or in the meridian frame."""

    radial: float
    transverse: float  # along t_hat, or towards increasing longitude
    normal: float  # along h_hat, or towards the pole


class Inertial(NamedTuple):
    """A unit vector fixed in space."""

    x: float
    y: float
    z: float


class Local(NamedTuple):
    """Which element the locally optimal law changes, and to which side."""

    goal: int  # of primers.GOALS
    sense: float  # 1 to increase it, -1 to decrease it


class Table(NamedTuple):
    """A steering table."""

    rows: int = 0
    interpolation: int = 0


def direction_parameters(pitch: float, clock: float) -> Components:
    """A normal at fixed pitch and clock, rad: (3.6)-(3.8)."""
    return Components(np.cos(pitch), np.sin(pitch) * np.sin(clock), np.sin(pitch) * np.cos(clock))


@inlined
def unit_direction(nx, ny, nz, throttle):
    """A direction of any length, as a law of one's own gives it, made a unit vector; and the throttle, 0 where there is
    no direction (the zero vector: a stowed sail). What is a unit vector to rounding stays as it is, to the last bit."""
    if abs(nx * nx + ny * ny + nz * nz - 1.0) < 1e-12:
        return nx, ny, nz, throttle
    largest = max(abs(nx), abs(ny), abs(nz))
    if largest == 0.0:
        return 0.0, 0.0, 0.0, 0.0
    nx, ny, nz = nx / largest, ny / largest, nz / largest  # so that no square is too large or too small for a number
    inverse = 1.0 / np.sqrt(nx * nx + ny * ny + nz * nz)
    return nx * inverse, ny * inverse, nz * inverse, throttle


@inlined
def orbital_direction(ux, uy, uz, x, y, z, vx, vy, vz, n_r, n_t, n_h):
    """n_r r_hat + n_t t_hat + n_h h_hat in inertial axes; u = r_hat. NaN where the craft has no angular momentum."""
    hx, hy, hz = y * vz - z * vy, z * vx - x * vz, x * vy - y * vx
    tx, ty, tz = hy * uz - hz * uy, hz * ux - hx * uz, hx * uy - hy * ux
    inverse = 1.0 / np.sqrt(hx * hx + hy * hy + hz * hz)  # the slowest part, needed last
    k_t, k_h = n_t * inverse, n_h * inverse
    return n_r * ux + k_t * tx + k_h * hx, n_r * uy + k_t * ty + k_h * hy, n_r * uz + k_t * tz + k_h * hz


@inlined
def meridian_direction(ux, uy, uz, n_r, n_east, n_north):
    """n_r r_hat + n_east e + n_north p: e towards increasing longitude, p = towards the pole in the meridian plane."""
    inverse = 1.0 / np.sqrt(ux * ux + uy * uy)  # NaN on the pole, where there is no meridian
    ex, ey = -uy * inverse, ux * inverse
    px, py, pz = -uz * ey, uz * ex, ux * ey - uy * ex
    return n_r * ux + n_east * ex + n_north * px, n_r * uy + n_east * ey + n_north * py, n_r * uz + n_north * pz


LINEAR, HOLD, CUBIC = 0, 1, 2  # how a steering table is read between its rows
INTERPOLATIONS = {"linear": LINEAR, "hold": HOLD, "cubic": CUBIC}
COLUMNS = 7  # of a steering table: time s, pitch rad, clock rad, throttle, and the rates of the last three


@inlined
def _between(p, a, b, column, w, span, interpolation):
    """Value of a column between the rows that begin at p[a] and p[b], at the fraction w of their span in s."""
    low, high = p[a + column], p[b + column]
    if interpolation != CUBIC:
        return low + w * (high - low)
    m0, m1 = span * p[a + column + 3], span * p[b + column + 3]  # Hermite's cubic through values and rates
    return low + w * (m0 + w * (3.0 * (high - low) - 2.0 * m0 - m1 + w * (2.0 * (low - high) + m0 + m1)))


@inlined
def table_row(t, p, first, rows, interpolation):
    """Pitch rad, clock rad and throttle at time t s from rows of COLUMNS numbers that stand in p from place `first`
    on; the first and the last row hold before and after."""
    low, high = 0, rows - 1
    t = min(max(t, p[first]), p[first + COLUMNS * high])
    while high - low > 1:
        middle = (low + high) // 2
        if p[first + COLUMNS * middle] <= t:
            low = middle
        else:
            high = middle
    a, b = first + COLUMNS * low, first + COLUMNS * high
    span = p[b] - p[a]
    w = 0.0 if span == 0.0 else (t - p[a]) / span
    if interpolation == HOLD:
        w = 1.0 if w >= 1.0 else 0.0
    return (
        _between(p, a, b, 1, w, span, interpolation),
        _between(p, a, b, 2, w, span, interpolation),
        _between(p, a, b, 3, w, span, interpolation),
    )


def table(time, pitch, clock, throttle=None, interpolation="linear"):
    """Rows (n, COLUMNS) of a steering table from columns (n,): s, rad, rad, and the share of full thrust (1).

    interpolation : "linear", "hold", or "cubic", a spline through the rows with continuous rates; SciPy's not-a-knot
    spline.
    """
    time = np.asarray(time, dtype=float)
    columns = [np.asarray(pitch, float), np.asarray(clock, float), np.ones_like(time) if throttle is None else throttle]
    values = np.column_stack([time, *columns])
    rates = np.zeros((len(time), 3))
    if interpolation == "cubic":
        from scipy.interpolate import CubicSpline

        rates = CubicSpline(time, values[:, 1:]).derivative()(time)
    return np.hstack([values, rates])
