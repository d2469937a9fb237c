"""Which rows of two recordings belong together."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sailviz.recording.comparison.tables import Table

NONE = np.empty(0, int)


@dataclass(frozen=True)
class Pairing:
    """How the rows of A and B belong together. rows_a, rows_b index rows that are compared as they are; otherwise
    `times` are those at which the finer side is interpolated."""

    rows_a: np.ndarray
    rows_b: np.ndarray
    times: np.ndarray | None = None
    finer: str = ""  # "A" | "B", the one that is interpolated

    @property
    def interpolated(self) -> bool:
        """Whether rows are not compared as they are."""
        return self.times is not None


def within(a: Table, b: Table, tolerance: float) -> tuple[np.ndarray, np.ndarray] | None:
    """(rows of A, rows of B) where every time of the shorter is one of the longer; None where it is not."""
    short, long = (a, b) if len(a) <= len(b) else (b, a)
    near = np.clip(np.searchsorted(long.time, short.time - tolerance), 0, len(long) - 1)
    if np.any(np.abs(long.time[near] - short.time) > tolerance) or len(np.unique(near)) < len(near):
        return None
    rows = np.arange(len(short))
    return (rows, near) if short is a else (near, rows)
