"""The ideal sail of GTOC13, flown again over many steps at once: by one Runge-Kutta step, and to rounding.

    a = -mu r / r^3 - a0 (r0 / r)^2 (u.s)^2 u,   s = -r / r

u is the normal of the sail, towards the star. A file says what it is at the ends of a step alone: in between it is the
parabola through both ends and a normal in the middle, brought back to length 1.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sailviz.checks.gtoc13.rules import AU, CHARACTERISTIC_ACCELERATION, MU

Floats = NDArray[np.float64]

PUSH = CHARACTERISTIC_ACCELERATION * AU**2
STAGES = (2, 4, 6, 8, 10, 12)  # midpoint steps that are extrapolated: order 12
TOLERANCE = 1e-12  # of distance and speed, a piece of a step
LONGEST_PIECE = 0.3  # of r / v near the star, over which the orbit bends by as many radians
MOST_PIECES = 500  # of one step; beyond, it counts as not flown


class Steps(NamedTuple):
    """Steps between rows. state (n, 6) at the start, m and m/s; span (n,) s; before, middle, after (n, 3) normals."""

    state: Floats
    span: Floats
    before: Floats
    middle: Floats
    after: Floats

    def at(self, which: NDArray[np.int64] | NDArray[np.bool_]) -> Steps:
        """Some of them."""
        return Steps(*(values[which] for values in self))


def unit(vectors: Floats) -> Floats:
    """Vectors (n, 3) brought to length 1; zero stays zero."""
    size = np.linalg.norm(vectors, axis=-1, keepdims=True)
    return vectors / np.where(size > 0, size, 1.0)


def rate(state: Floats, normal: Floats) -> Floats:
    """Rates (n, 6) of states (n, 6) with the sail's normal (n, 3)."""
    place = state[:, :3]
    r2 = np.einsum("ij,ij->i", place, place)
    r = np.sqrt(r2)
    facing = -np.einsum("ij,ij->i", normal, place) / r  # u.s
    made = np.empty_like(state)
    made[:, :3] = state[:, 3:]
    made[:, 3:] = (-MU / (r2 * r))[:, None] * place - (PUSH / r2 * facing * facing)[:, None] * normal
    return made


def normal_at(steps: Steps, x: Floats) -> Floats:
    """Normals (n, 3) at the fractions x (n,) of steps."""
    x = x[:, None]
    curve = steps.before * ((1 - x) * (1 - 2 * x)) + steps.middle * (4 * x * (1 - x)) + steps.after * (x * (2 * x - 1))
    return unit(curve)


def one_step(steps: Steps) -> Floats:
    """States (n, 6) at the ends, by one step of the classical Runge-Kutta method of order 4."""
    y, h = steps.state, steps.span[:, None]
    k1 = rate(y, steps.before)
    k2 = rate(y + h / 2 * k1, steps.middle)
    k3 = rate(y + h / 2 * k2, steps.middle)
    k4 = rate(y + h * k3, steps.after)
    return y + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)


def _extrapolated(steps: Steps, start: Floats, y: Floats, h: Floats) -> tuple[Floats, Floats]:
    """States (n, 6) a piece h (n,) s after start (n,) s, and their error (n,) relative to distance and speed.

    Modified midpoint steps, extrapolated in the square of their length: W. B. Gragg (1965), R. Bulirsch and J. Stoer
    (1966); not read but re-derived.
    """
    table: list[Floats] = []
    first = rate(y, normal_at(steps, start / steps.span))
    for j, pieces in enumerate(STAGES):
        d = (h / pieces)[:, None]
        low, high = y, y + d * first
        for piece in range(1, pieces):
            x = (start + piece * h / pieces) / steps.span
            low, high = high, low + 2 * d * rate(high, normal_at(steps, x))
        end = rate(high, normal_at(steps, (start + h) / steps.span))
        row = [0.5 * (high + low + d * end)]
        for k in range(j):
            row.append(row[k] + (row[k] - table[k]) / ((STAGES[j] / STAGES[j - k - 1]) ** 2 - 1))
        last, table = row[-2] if j else row[0], row
    off, size = (table[-1] - last).reshape(-1, 2, 3), table[-1].reshape(-1, 2, 3)
    share = np.linalg.norm(off, axis=2) / np.linalg.norm(size, axis=2)
    return table[-1], np.max(share, axis=1)


class Flown(NamedTuple):
    """state (n, 6) at the ends, NaN where a step could not be flown; nearest : (step, time after its start s, distance
    m) of every closest approach to the star inside a step."""

    state: Floats
    nearest: list[tuple[int, float, float]]


def fly(steps: Steps, watch: bool = True, until: Floats | None = None) -> Flown:
    """Fly steps to rounding, each in pieces whose length follows from their error. watch : look for the closest
    approaches too; until (n,) s : fly only so far into each."""
    n, end = len(steps.span), steps.span if until is None else until
    time, y, pieces = np.zeros(n), steps.state.copy(), np.zeros(n, np.int64)
    nearest: list[tuple[int, float, float]] = []
    with np.errstate(all="ignore"):
        wish = np.minimum(end, _longest(y))
        active = np.flatnonzero(end > 0)
        while len(active):
            some = steps.at(active)
            h = np.minimum(wish[active], end[active] - time[active])
            new, error = _extrapolated(some, time[active], y[active], h)
            good = error <= TOLERANCE
            factor = np.clip(0.9 * (TOLERANCE / np.maximum(error, 1e-17)) ** (1 / 11), 0.1, 3.0)
            factor = np.where(np.isfinite(error), factor, 0.1)
            turning = good & (_outward(y[active]) < 0) & (_outward(new) >= 0)
            if watch and turning.any():
                nearest += _closest(some.at(turning), active[turning], time[active][turning], y[active][turning],
                                    h[turning])  # fmt: skip
            done = active[good]
            time[done] += h[good]
            y[done] = new[good]
            wish[active] = np.minimum(h * factor, _longest(y[active]))
            pieces[active] += 1
            lost = pieces[active] >= MOST_PIECES
            y[active[lost]] = np.nan
            active = active[~lost & (end[active] - time[active] > 1e-9)]
    return Flown(y, nearest)


def _longest(y: Floats) -> Floats:
    r, v = np.linalg.norm(y[:, :3], axis=1), np.linalg.norm(y[:, 3:], axis=1)
    return LONGEST_PIECE * r / np.maximum(v, np.sqrt(MU / r))


def _outward(y: Floats) -> Floats:
    return np.einsum("ij,ij->i", y[:, :3], y[:, 3:])


def _closest(
    steps: Steps, which: NDArray[np.int64], start: Floats, y: Floats, h: Floats
) -> list[tuple[int, float, float]]:
    """Where within pieces the craft stops coming closer: by halving."""
    low, high = np.zeros_like(h), h.copy()
    for _ in range(45):
        middle = 0.5 * (low + high)
        state, _ = _extrapolated(steps, start, y, middle)
        coming = _outward(state) < 0
        low, high = np.where(coming, middle, low), np.where(coming, high, middle)
    state, _ = _extrapolated(steps, start, y, high)
    distance = np.linalg.norm(state[:, :3], axis=1)
    return [(int(i), float(t), float(r)) for i, t, r in zip(which, start + high, distance, strict=True)]
