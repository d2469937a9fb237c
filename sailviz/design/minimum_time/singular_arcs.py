"""An electric sail's flight as a row of arcs, each at full thrust, without thrust, or singular, with the throttle that
keeps its switching function at 0.

State and costates fly as in `costates`, but no arc ends by itself: it lasts as long as it is told, and what the
switching function does meanwhile tells whether it should have.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from sailviz.compiled import entry
from sailviz.design.minimum_time.boundary_conditions import hamiltonians
from sailviz.design.minimum_time.costates import REASONS, STATUS, STEPS, TIME, Flight, fly_all, fly_dense, propagate
from sailviz.design.minimum_time.state_costate import (
    COAST,
    LRX,
    LRY,
    LRZ,
    LVX,
    LVY,
    LVZ,
    OWN,
    SINGULAR,
    SIZE,
    SWITCH,
    THRUST,
    VX,
    VY,
    VZ,
    Sail,
    X,
    Y,
    Z,
)
from sailviz.steering.optimal import full_thrust, steer
from sailviz.steering.singular import switching_rates

KINDS = {"T": "thrust", "C": "coast", "S": "singular"}
SMOOTHING = {"thrust": THRUST, "coast": COAST, "singular": SINGULAR}
TOLERANCE = 1e-13


class Arc(NamedTuple):
    """One arc of a flight: kind, "thrust", "coast" or "singular"; start and end, s."""

    kind: str
    start: float
    end: float


class Switching(NamedTuple):
    """Of states and costates (n, 12), each (n,): S / |p|, its rate, and the throttle that a singular arc would have."""

    value: np.ndarray
    rate: np.ndarray
    throttle: np.ndarray


@entry("d2 i d1 D2")
def switching_compiled(rows, kind, p, out):
    """`switching` into out (3, n)."""
    for i in range(len(rows)):
        y = rows[i]
        px, py, pz = y[LVX], y[LVY], y[LVZ]
        r = np.sqrt(y[X] * y[X] + y[Y] * y[Y] + y[Z] * y[Z])
        size = np.sqrt(px * px + py * py + pz * pz)
        c = (px * y[X] + py * y[Y] + pz * y[Z]) / (r * size)
        s = np.sqrt(max(0.0, 1.0 - c * c))
        _, _, _, fr, ft = steer(kind, p, OWN, c, s, THRUST)
        strength, exponent = full_thrust(kind, p, OWN, r, 1.0)
        rate, drift, gain = switching_rates(
            y[X], y[Y], y[Z], y[VX], y[VY], y[VZ], px, py, pz, y[LRX], y[LRY], y[LRZ],
            r, size, 1.0, p[SWITCH], strength, exponent, c, s, fr, ft,
        )  # fmt: skip
        out[0, i], out[1, i], out[2, i] = c - p[SWITCH], rate / size, -drift / gain
    return 0


def switching(rows: np.ndarray, sail: Sail) -> Switching:
    """The switching function of an electric sail along rows (n, 12), positive where it thrusts."""
    out = np.empty((3, len(rows)))
    switching_compiled(np.ascontiguousarray(rows), sail.kind, sail.parameters, out)
    return Switching(*out)


def fly_arcs(starts: np.ndarray, arcs: str, durations: np.ndarray, sail: Sail) -> list[np.ndarray]:
    """States and costates (n, 12) at the start and at the end of every arc, for n flights from starts (n, 12) through
    arcs of the letters in KINDS that last durations (n, len(arcs)); NaN where one fails. A negative duration is flown
    into the past."""
    ends = [np.ascontiguousarray(starts, dtype=float)]
    for i, arc in enumerate(arcs):
        smoothing = SMOOTHING[KINDS[arc]]
        ends.append(fly_all(ends[-1], durations[:, i], sail, tolerance=TOLERANCE, smoothing=smoothing))
    return ends


def propagate_arcs(
    start: npt.ArrayLike, arcs: Sequence[tuple[str, float]], sail: Sail, *, times: npt.ArrayLike = ()
) -> Flight:
    """Fly state and costates start (12,) through arcs of (kind, duration >= 0), with rows at times (n,), which increase
    from 0 to the flight's end at most. Units mu = 1 and one au. The switches are where one arc follows another."""
    wanted = np.ascontiguousarray(times, dtype=float)
    y, begin, steps, edges, reason = np.array(start, dtype=float).reshape(1, SIZE), 0.0, 0, [], ""
    hamiltonian, drift, rows = float(hamiltonians(y, sail)[0]), 0.0, [np.empty((0, SIZE))]
    for i, (kind, duration) in enumerate(arcs):
        last = i == len(arcs) - 1
        mine = (wanted >= begin) & ((wanted <= begin + duration) if last else (wanted < begin + duration))
        inside = np.clip(wanted[mine] - begin, 0.0, duration)
        if last:  # what rounding puts behind the end is the end
            inside = np.append(inside, np.full(np.count_nonzero(wanted > begin + duration), duration))
        flown = fly_dense(y, np.array([duration]), sail, inside, TOLERANCE, SMOOTHING[kind])
        rows.append(flown.rows[0])
        y, steps = flown.ends, steps + int(flown.counts[0, STEPS])
        drift = max(drift, float(abs(hamiltonians(y, sail)[0] - hamiltonian)))
        reason = REASONS[flown.counts[0, STATUS]]
        begin += float(flown.numbers[0, TIME])
        if reason:
            break
        edges.append(begin)
    found = np.vstack(rows)
    missing = np.full((len(wanted) - len(found), SIZE), np.nan)
    return Flight(begin, y[0], np.vstack([found, missing]), np.array(edges[:-1]), hamiltonian, drift, steps, reason)


def fly(
    start: npt.ArrayLike, span: float, sail: Sail, arcs: Sequence[tuple[str, float]], times: npt.ArrayLike
) -> Flight:
    """`costates.propagate`, or `propagate_arcs` of a flight that has arcs."""
    if arcs:
        return propagate_arcs(start, arcs, sail, times=times)
    return propagate(start, span, sail, times=times)


def throttle_of_arcs(rows: np.ndarray, times: np.ndarray, arcs: Sequence[Arc], sail: Sail) -> np.ndarray:
    """The throttle (n,) of rows (n, 12) at times (n,) s of a flight's arcs."""
    place = np.searchsorted([arc.start for arc in arcs], times, side="right") - 1
    kinds = np.array([arc.kind for arc in arcs])[np.maximum(place, 0)]
    throttle = switching(rows, sail).throttle
    return np.where(kinds == "singular", throttle, (kinds == "thrust").astype(float))
