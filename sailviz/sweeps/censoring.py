"""Flights that had not come where they were awaited when their time was over: censored, not missing.

Such a flight is "running", and of a time that was asked for it is known that it is at least as long as what was flown.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from sailviz.scene.sections import Expectation
from sailviz.units import UNITS

OF_ALL = ("start", "end", "min", "max", "mean", "drift")  # moments that every flight has
AT_LEAST = " at least"  # ending of the column that holds the bound of another
_TIMES = {f"time_{unit}": factor for unit, factor in UNITS["time"].items()}
PERCENTILES = {"p5": 0.05, "median": 0.5, "p95": 0.95}


def waits(item: Expectation) -> bool:
    """Whether a quantity is asked for at an event, which may never happen."""
    return item.at is not None and item.at not in OF_ALL


def bounded(items: Mapping[str, Expectation]) -> dict[str, float]:
    """Column -> seconds of its unit, of the columns of times at which something happens."""
    return {name: _TIMES[item.quantity] for name, item in items.items() if waits(item) and item.quantity in _TIMES}


def still_running(items: Iterable[tuple[Expectation, float]], stops: bool, ended: str) -> bool:
    """Whether a flight's time was over before what was awaited. items : what was asked for, each with what was
    measured, NaN for what never happened; stops : whether the scene has an event that stops a flight."""
    awaited = [measured for item, measured in items if waits(item)]
    return not ended and (any(math.isnan(measured) for measured in awaited) if awaited else stops)


class Number(NamedTuple):
    """A number of many flights. at_least : whether only so much is known of it."""

    value: float
    at_least: bool = False


def statistics(values: ArrayLike, bounds: ArrayLike) -> dict[str, Number]:
    """Mean, standard deviation, least, percentiles and largest of a column.

    values (n,) : where it was measured, NaN elsewhere; bounds (n,) : of a censored flight what it is at least, NaN
    elsewhere. With censored flights a number is told where they cannot change it, whatever they will be, and as a bound
    elsewhere; there is then no deviation.
    """
    known, least = (np.asarray(column, float) for column in (values, bounds))
    known, least = known[np.isfinite(known)], least[np.isfinite(least)]
    low = np.sort(np.concatenate([known, least]))
    if not len(low):
        return {}
    high = np.sort(np.concatenate([known, np.full(len(least), np.inf)]))

    def number(of_low: float, of_high: float) -> Number:
        return Number(of_low, of_high != of_low)

    found = {"mean": Number(float(low.mean()), len(least) > 0)}
    if not len(least):
        found["deviation"] = Number(float(low.std(ddof=1)) if len(low) > 1 else 0.0)
    found["min"] = number(float(low[0]), float(high[0]))
    for name, share in PERCENTILES.items():
        found[name] = number(_quantile(low, share), _quantile(high, share))
    return found | {"max": number(float(low[-1]), float(high[-1]))}


def _quantile(ordered: np.ndarray, share: float) -> float:
    """Linear between the two values about a share of the way through sorted ones, which may end in infinities."""
    place = share * (len(ordered) - 1)
    before, after = float(ordered[math.floor(place)]), float(ordered[math.ceil(place)])
    return before if before == after else before + (place - math.floor(place)) * (after - before)
