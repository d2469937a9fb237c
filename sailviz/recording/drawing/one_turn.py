"""One revolution of a flight of many, to be watched by itself: the first one whose rows are close enough.

All of its rows are drawn, where they were, also where the rest of the flight is drawn slowed; the viewer's time panel
has it selected, so that it plays that alone when asked to loop its selection.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from sailviz.recording import timelines
from sailviz.recording.drawing.samples import Frame
from sailviz.run.arrays import Run, join

FROM_TURNS = 10.0  # revolutions from which one is hardly seen in a replay of all
LEAST = 12  # rows of a revolution that can be watched
MOST = 96  # of which are drawn
REPLAY = 30.0  # s that it should take


class OneTurn:
    """Finds it while a run comes block by block, and keeps its rows."""

    def __init__(self, frame: Frame):
        self._looks = frame.turns > FROM_TURNS and np.isfinite(frame.turns)
        self._mu = frame.mu
        self._waiting: Run | None = None
        self._numbers = np.zeros(0, int)
        self.rows: Run | None = None
        self.numbers = np.zeros(0, int)

    @property
    def span(self) -> tuple[float, float] | None:
        """s, from its first row to its last; None where there is none."""
        return None if self.rows is None else (float(self.rows.time[0]), float(self.rows.time[-1]))

    def add(self, run: Run) -> None:
        """A block of a run, all rows."""
        if not self._looks or self.rows is not None or not len(run):
            return
        number = run.first + np.arange(len(run))
        if self._waiting is not None:
            run, number = join([self._waiting, run]), np.concatenate([self._numbers, number])
        period = self._periods(run)
        step = np.diff(run.time)
        far = np.flatnonzero(~((step > 0) & (step < period[:-1] / LEAST)))
        starts, ends = np.append(0, far + 1), np.append(far, len(run) - 1)
        for start, end in zip(starts.tolist(), ends.tolist(), strict=True):
            if run.time[end] - run.time[start] >= period[start]:
                last = int(np.searchsorted(run.time, run.time[start] + period[start], side="right"))
                some = np.arange(start, min(last + 1, end + 1))
                some = some[:: timelines.stride(len(some), MOST)]
                self.rows, self.numbers, self._waiting = timelines.take(run, some), number[some], None
                return
        tail = slice(int(starts[-1]), None)
        self._waiting, self._numbers = timelines.take(run, tail), number[tail]

    def _periods(self, run: Run) -> np.ndarray:
        """(n,) s of a revolution; inf where it never comes round."""
        a = run.elements.semi_major_axis
        closed = (a > 0) & np.isfinite(a)
        return np.asarray(np.where(closed, 2 * np.pi * np.sqrt(np.where(closed, a, 1.0) ** 3 / self._mu), np.inf))

    def among(self, rows: list[Run], numbers: list[np.ndarray]) -> tuple[Run, np.ndarray]:
        """Rows that are drawn, and their numbers in the whole run, with those of the revolution among them."""
        if self.rows is None:
            return join(rows), np.concatenate(numbers)
        whole = [replace(self.rows, events=()), *rows]
        number = np.concatenate([self.numbers, *numbers])
        _, order = np.unique(number, return_index=True)
        return timelines.take(join(whole), order), number[order]

    @property
    def words(self) -> list[str]:
        """How to watch it."""
        if self.span is None:
            return []
        pace = (self.span[1] - self.span[0]) / REPLAY
        return [
            f"**one turn** is marked on the time line: loop that selection, at a speed of {float(f'{pace:.2g}'):g}×"
        ]
