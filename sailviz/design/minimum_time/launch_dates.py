"""The best dates to leave on: flights followed over their departure to where none nearby is faster.

One unknown apart from the others, by the sign of d time / d date (`planet_conditions`): steps that grow until it
changes, then false position; all eight unknowns at once converge from too near only. At an edge of the window beyond
which it would go on falling, the flight of the edge is the window's.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from sailviz.constants import DAY
from sailviz.design.minimum_time.planet_conditions import Meeting
from sailviz.design.minimum_time.unknowns import LOOSE, TIGHT, Unknowns, span_of

FIRST_STEP, LONGEST_STEP, SHORTEST_STEP = 10 * DAY, 40 * DAY, DAY  # of the departure
MOST_STEPS, MOST_POLISHING = 40, 8
CLOSE, EXACT = 1e-4, 1e-10  # slopes that are worth polishing, and that count as none
SAME_DATE = 0.05 * DAY  # s between departures below which two best dates are one
SAME_TIME = 1e-5  # of the flight time


@dataclass(frozen=True, eq=False)
class LocalBest:
    """The flight of a date that no date nearby beats. slope : d time / d date, zero but for rounding, or at an edge of
    the window what leaving beyond it would win."""

    flight: Unknowns
    slope: float

    @property
    def at_edge(self) -> bool:
        """Whether only the window keeps the flight from being faster."""
        return abs(self.slope) > CLOSE


def local_best(meeting: Meeting, unknowns: Unknowns, first: float, last: float) -> LocalBest | None:
    """The best date between two, in s after the epoch, that a flight leads to downhill; None where it is lost on the
    way: its family ends there."""
    low, g_low = unknowns, _slope(meeting, unknowns, LOOSE)
    high: Unknowns | None = None
    g_high, step = 0.0, FIRST_STEP
    for _ in range(MOST_STEPS):
        if abs(g_low) <= CLOSE:
            return _polished(meeting, low, first, last)
        if high is None:
            departure = float(np.clip(low.departure - np.copysign(step, g_low), first, last))
            if departure == low.departure:
                edge = meeting.sharpen(low)
                return None if edge is None else LocalBest(edge, _slope(meeting, edge, TIGHT))
        else:
            departure = low.departure + (high.departure - low.departure) * g_low / (g_low - g_high)
        y = meeting.nearby(low, departure)
        if y is None:
            if high is not None or step < SHORTEST_STEP:
                return None
            step *= 0.3
            continue
        g = _slope(meeting, y, LOOSE)
        if g * g_low > 0:
            low, g_low, step = y, g, min(2 * step, LONGEST_STEP)
            g_high *= 0.5
        else:
            low, g_low, high, g_high = y, g, low, g_low
    return None


def _slope(meeting: Meeting, unknowns: Unknowns, tolerance: float) -> float:
    return meeting.ends(unknowns, tolerance).slope


def _polished(meeting: Meeting, unknowns: Unknowns, first: float, last: float) -> LocalBest | None:
    """The date at which the slope vanishes to rounding, by the secant."""
    x = meeting.sharpen(unknowns)
    if x is None:
        return None
    g = _slope(meeting, x, TIGHT)
    y = meeting.nearby(x, float(np.clip(x.departure - np.copysign(0.5 * DAY, g), first, last)), TIGHT)
    for _ in range(MOST_POLISHING):
        if y is None or abs(g) <= EXACT:
            break
        g_y = _slope(meeting, y, TIGHT)
        if g_y == g:
            break
        departure = float(np.clip(y.departure - g_y * (y.departure - x.departure) / (g_y - g), first, last))
        x, g = (y, g_y) if abs(g_y) < abs(g) else (x, g)
        if departure in (x.departure, y.departure):
            break
        y = meeting.nearby(x, departure, TIGHT)
    return LocalBest(x, g)


def distinct(found: Sequence[LocalBest | None]) -> list[LocalBest]:
    """Those that there are, fastest first, each once."""
    kept: list[LocalBest] = []
    for best in sorted((x for x in found if x is not None), key=lambda x: span_of(x.flight)):
        x = best.flight
        if all(
            abs(x.departure - y.flight.departure) > SAME_DATE or x.span > y.flight.span * (1 + SAME_TIME) for y in kept
        ):
            kept.append(best)
    return kept
