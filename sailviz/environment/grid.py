"""Quantities around the Earth on (latitude, local time, altitude, solar level), as one flat row for compiled code.

Layout from the row's place `at` on: HEADER numbers (sizes, altitudes, solar levels), then the nodes with the quantities
innermost, the solar levels next to them and the first local time repeated after the last, so that one cell lies in
eight short runs of memory and needs no modulo.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from sailviz.compiled import inlined

LATITUDES, TIMES, ALTITUDES, LEVELS = 0, 1, 2, 3  # how many
LOWEST, PER_METRE = 4, 5  # altitude m, its nodes per m
BEND, PER_METRE_ABOVE = 6, 7  # altitude m from which on there are other nodes per m
FIRST_LEVEL = 8  # where the solar levels begin
NO_BEND = 1e15  # m, above everything
MOST_LEVELS = 10
HEADER = FIRST_LEVEL + MOST_LEVELS
FARTHEST = 0.5  # of its width, beyond a held cell, to which its values are continued


class Held(NamedTuple):
    """What a step of an integrator keeps to, so that no kink lies inside it: its cell of either table, whether the Sun
    shines, and whether a tether gets less than its voltage. The cells' numbers are those of `cell_at`."""

    active: int = 0  # 0: every place is looked up where it is
    air_latitude: int = 0
    air_time: int = 0
    air_altitude: int = 0
    plasma_latitude: int = 0
    plasma_time: int = 0
    plasma_altitude: int = 0
    lit: int = 0  # 1 in sunlight
    limited: int = 0  # 1 where the power does not suffice


def flat(values, altitudes, levels):
    """The row of a table. values (levels, latitudes, local times, altitudes, quantities): latitudes evenly from -90 to
    90 deg, local times evenly from midnight on, altitudes (k,) m evenly, levels (l,) F10.7 upwards -> (n,)."""
    levels = np.atleast_1d(np.asarray(levels, dtype=float))
    if len(levels) > MOST_LEVELS or np.any(np.diff(levels) <= 0):
        raise ValueError(f"solar levels must increase and be at most {MOST_LEVELS}, not {levels.tolist()}")
    header = np.zeros(HEADER)
    header[LATITUDES], header[TIMES], header[ALTITUDES] = values.shape[1:4]
    header[LEVELS] = len(levels)
    header[LOWEST] = altitudes[0]
    even = int(np.sum(np.isclose(np.diff(altitudes), altitudes[1] - altitudes[0])))
    header[PER_METRE] = even / (altitudes[even] - altitudes[0])
    header[BEND] = NO_BEND
    if even < len(altitudes) - 1:
        header[BEND], header[PER_METRE_ABOVE] = altitudes[even], (len(altitudes) - 1 - even) / np.ptp(altitudes[even:])
    header[FIRST_LEVEL : FIRST_LEVEL + len(levels)] = levels
    nodes = np.concatenate([values, values[:, :, :1]], axis=2)
    return np.concatenate([header, np.moveaxis(nodes, 0, 3).astype(float).ravel()])


def places(*arguments):
    """Arguments that broadcast, as the rows of one array (k, n), and the shape they have together."""
    together = np.broadcast_arrays(*(np.asarray(argument, dtype=float) for argument in arguments))
    return np.array(together).reshape(len(together), -1), together[0].shape


@inlined
def fraction(value, count):
    """Interval and weight of a place counted in nodes, held at the first and the last of count nodes; NaN goes to the
    first, which keeps it inside the table."""
    last = count - 1.0
    place = value if value > 0.0 else 0.0
    place = place if place < last else last
    whole = int(place)
    whole = whole if whole < int(count) - 2 else int(count) - 2
    return whole, place - whole


@inlined
def in_nodes(p, at, latitude, local_time, altitude):
    """A place counted in nodes of the table; the local time within a day."""
    turns = local_time * (0.5 / np.pi)
    u = (latitude * (1.0 / np.pi) + 0.5) * (p[at + LATITUDES] - 1.0)
    v, bend = (turns - np.floor(turns)) * p[at + TIMES], p[at + BEND]
    if altitude <= bend:
        return u, v, (altitude - p[at + LOWEST]) * p[at + PER_METRE]
    return u, v, (bend - p[at + LOWEST]) * p[at + PER_METRE] + (altitude - bend) * p[at + PER_METRE_ABOVE]


@inlined
def node(value, first, last):
    """The whole number below a value, held between two; NaN goes to the first."""
    place = value if value > first else first
    return int(np.floor(place if place < last else last))


@inlined
def cell_at(p, at, latitude, local_time, altitude):
    """The cell in which a place lies, as the numbers of its first nodes: (latitude, local time, altitude), the last
    -1 below the table and that of the last node above it."""
    u, v, w = in_nodes(p, at, latitude, local_time, altitude)
    i = node(u, 0.0, p[at + LATITUDES] - 2.0)
    return i, node(v, 0.0, p[at + TIMES] - 1.0), node(w, -1.0, p[at + ALTITUDES] - 1.0)


@inlined
def beyond(p, at, latitude, local_time, altitude, i, j, k):
    """How far a place lies outside a cell of `cell_at`, in widths of it; negative inside."""
    u, v, w = in_nodes(p, at, latitude, local_time, altitude)
    v -= j + 0.5
    v -= p[at + TIMES] * np.round(v / p[at + TIMES])
    far = max(abs(u - i - 0.5), abs(v)) - 0.5
    if k >= 0:
        far = max(far, k - w)
    if k < p[at + ALTITUDES] - 1.0:
        far = max(far, w - k - 1.0)
    return far


@inlined
def level_in(p, at, f107):
    """Interval of the solar level and its weight, held at the first and the last."""
    levels = int(p[at + LEVELS])
    level, weight = 0, 0.0
    if levels > 1:
        first = at + FIRST_LEVEL
        while level < levels - 2 and f107 >= p[first + level + 1]:
            level += 1
        low, high = p[first + level], p[first + level + 1]
        weight = (f107 - low) / (high - low)
        weight = weight if weight > 0.0 else 0.0
        weight = weight if weight < 1.0 else 1.0
    return level, weight


@inlined
def strides(p, at, i, j, k, level, width):
    """Index of a cell's first node, and what to add for the next latitude, local time and altitude."""
    step = int(p[at + LEVELS]) * width
    column = int(p[at + ALTITUDES]) * step
    row = (int(p[at + TIMES]) + 1) * column
    n = at + HEADER + i * row + j * column + k * step + level * width
    # unsigned, which spares a test for a negative index at each of the 32 nodes read: a third of the time
    return np.uint64(n), np.uint64(row), np.uint64(column), np.uint64(step)


@inlined
def cell(p, at, latitude, local_time, altitude, f107, width):
    """Where a place lies: index of the cell's first node, what to add for the next latitude, local time and altitude,
    the three weights, and the weight of the next solar level. Angles rad, local time 0 at midnight and of any number of
    turns, altitude m; width : quantities per node."""
    u, v, w = in_nodes(p, at, latitude, local_time, altitude)
    i, wi = fraction(u, p[at + LATITUDES])
    j, wj = fraction(v, p[at + TIMES] + 1.0)
    k, wk = fraction(w, p[at + ALTITUDES])
    level, weight = level_in(p, at, f107)
    n, row, column, step = strides(p, at, i, j, k, level, width)
    return n, row, column, step, wi, wj, wk, weight


@inlined
def continued(value):
    """A weight in a held cell."""
    return max(-FARTHEST, min(value, 1.0 + FARTHEST))


@inlined
def held_cell(p, at, latitude, local_time, altitude, f107, width, i, j, k):
    """As `cell`, for the cell of these numbers, of `cell_at`, wherever the place: values are continued FARTHEST beyond
    its faces, so that a step of an integrator meets no kink."""
    u, v, w = in_nodes(p, at, latitude, local_time, altitude)
    v -= j + 0.5
    v -= p[at + TIMES] * np.round(v / p[at + TIMES])
    last = int(p[at + ALTITUDES]) - 2
    wk = continued(w - k)
    if k < 0:
        k, wk = 0, 0.0
    elif k > last:
        k, wk = last, 1.0
    level, weight = level_in(p, at, f107)
    n, row, column, step = strides(p, at, i, j, k, level, width)
    return n, row, column, step, continued(u - i), continued(v + 0.5), wk, weight


@inlined
def trilinear(p, n, row, column, step, wi, wj, wk):
    """The quantity at a place of the cell whose first node is p[n]."""
    a = p[n] + wk * (p[n + step] - p[n])
    n += column
    b = p[n] + wk * (p[n + step] - p[n])
    n += row
    d = p[n] + wk * (p[n + step] - p[n])
    n -= column
    c = p[n] + wk * (p[n + step] - p[n])
    a += wj * (b - a)
    c += wj * (d - c)
    return a + wi * (c - a)


@inlined
def quantity(p, place, which, width):
    """Quantity number `which` of `width` at a place that `cell` found, linear between solar levels too; where the
    lower level is met exactly the next is not read, as there may be none."""
    n, row, column, step, wi, wj, wk, weight = place
    n += np.uint64(which)
    value = trilinear(p, n, row, column, step, wi, wj, wk)
    if weight > 0.0:
        value += weight * (trilinear(p, n + np.uint64(width), row, column, step, wi, wj, wk) - value)
    return value
