"""Spans of time without data: (start, end) pairs in s, between rows. Nothing is drawn, read off or compared inside."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import pairwise

import numpy as np

WITHIN = 1e-3  # of a gap

Gaps = Sequence[tuple[float, float]]


def last_rows(time: np.ndarray, gaps: Gaps) -> np.ndarray:
    """Rows (m,) of times (n,) s after which data is missing until the next row; gaps before or after all rows are none.

    Of a run's rows some may be left out: a gap between two that are left out lies between their neighbours.
    """
    if not len(gaps):
        return np.zeros(0, int)
    starts = np.array([start for start, _ in gaps])
    rows = np.searchsorted(time, starts, side="right") - 1
    return np.unique(rows[(rows >= 0) & (rows < len(time) - 1)])


def inside(times: np.ndarray, gaps: Gaps) -> np.ndarray:
    """Whether times (n,) s lie within a gap, its ends not among them. (n,) bool"""
    found = np.zeros(len(times), bool)
    for start, end in gaps:
        found |= (times > start) & (times < end)
    return found


def pieces(time: np.ndarray, gaps: Gaps) -> list[slice]:
    """The rows between gaps, in order."""
    edges = [0, *(last_rows(time, gaps) + 1).tolist(), len(time)]
    return [slice(a, b) for a, b in pairwise(edges)]


def joined(gaps: Iterable[tuple[float, float]]) -> tuple[tuple[float, float], ...]:
    """Gaps in order of time, those that overlap as one."""
    found: list[tuple[float, float]] = []
    for start, end in sorted(gaps):
        if found and start < found[-1][1]:
            found[-1] = found[-1][0], max(end, found[-1][1])
        else:
            found.append((start, end))
    return tuple(found)


def moments(gaps: Gaps) -> np.ndarray:
    """(m,) s, a time just within each gap, clear of the rows at its ends: where what is shown says that data ends."""
    return np.array([start + WITHIN * (end - start) for start, end in gaps])


def total(gaps: Gaps) -> float:
    """s without data in all."""
    return float(sum(end - start for start, end in gaps))
