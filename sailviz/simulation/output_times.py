"""The times at which a run has rows."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from sailviz.scene.sections import Propagation

DEFAULT_OUTPUTS = 1000
CLOSEST = 1e-6  # s between rows that are spread over what was flown: the clock of a recording counts nanoseconds


class OutputTimes:
    """Times of all rows of a run, s: even, or closer in some windows. Even ones are computed as they are asked for.

    end : of what is flown, s, where that is known to be less than was planned. An output_interval that the scene gives
    is kept; a number of outputs is spread over what is flown. also : further times, s, that have a row.
    """

    def __init__(self, run: Propagation, end: float | None = None, also: Sequence[float] = ()) -> None:
        self.run, self.end = run, run.duration if end is None else end
        self.rows, self.spacing = self._grid()
        self.uneven: np.ndarray | None = None
        if run.dense:
            even = self.between(0, self.rows)
            windows = [np.arange(w.start, w.end + 0.5 * w.output_interval, w.output_interval) for w in run.dense]
            inside = [window[window <= self.end] for window in windows] if self.end < run.duration else windows
            self.uneven = np.unique(np.minimum(np.concatenate([even, *inside]), self.end))
            self.rows = len(self.uneven)
        wanted = [time for time in also if time < self.end]
        if wanted:
            even = self.between(0, self.rows)
            apart = np.min(np.abs(even[:, None] - np.array(wanted)), axis=1) > CLOSEST
            self.uneven = np.union1d(even[apart], wanted)
            self.rows = len(self.uneven)

    def _grid(self) -> tuple[int, float]:
        """(rows, spacing s) of even output; the last row is the end of the run, or one spacing before it."""
        run = self.run
        if run.output_interval is not None:
            return int(np.floor(run.duration / run.output_interval * (1 + 1e-12))) + 1, run.output_interval
        rows = run.outputs or DEFAULT_OUTPUTS
        if self.end < run.duration:
            rows = max(2, min(rows, int(self.end / CLOSEST) + 1))
        return rows, self.end / (rows - 1)

    def between(self, first: int, count: int) -> np.ndarray:
        """The times of count rows from a first one on."""
        if self.uneven is not None:
            return self.uneven[first : first + count]
        times = np.minimum(self.spacing * np.arange(first, first + count), self.end)
        if first + count == self.rows and self.run.output_interval is None:
            times[-1] = self.end
        return times
