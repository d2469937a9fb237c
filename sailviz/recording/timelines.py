"""Rows of a Run: some of them, and the timelines they stand on.

Everything that is drawn is thinned by the row's number in the whole run, never by its place in a block, so that a
recording does not depend on the blocks in which the run arrived.
"""

from __future__ import annotations

from dataclasses import fields, replace
from typing import Any

import numpy as np
import rerun as rr
from numpy.typing import ArrayLike

from sailviz.constants import YEAR
from sailviz.errors import RecordingError
from sailviz.run.arrays import COLUMNS, Run, Setting

LONGEST = 2**63 / 1e9  # s that a timeline of 64-bit nanoseconds can count: 292 years


def take(run: Run, index: slice | np.ndarray) -> Run:
    """The rows `index` (a slice or ints into this block) of a run. `first` and `events` stay those of the block."""

    def pick(part: Any) -> Any:
        if isinstance(part, np.ndarray):
            return part[index]
        if isinstance(part, dict):
            return {key: pick(value) for key, value in part.items()}
        return type(part)(*(pick(getattr(part, f.name)) for f in fields(part)))

    return replace(run, **{name: pick(getattr(run, name)) for name in COLUMNS})


def stride(rows: int, most: int) -> int:
    """Every how many rows one is drawn, so that of `rows` at most `most` are."""
    return max(1, -(-rows // most))


def on_stride(run: Run, every: int) -> slice:
    """The rows of a block whose number in the whole run is a multiple of `every`."""
    return slice(-run.first % every, None, every)


class Picker:
    """Chooses the rows that are drawn: every so many, and where rows lie far apart in time more, so that neither a
    dense window nor the long stretches about it go short.

    Of evenly spaced rows these are those on the stride. Of others there are at most two thirds of `most` more.
    """

    def __init__(self, rows: int, most: int, duration: float):
        self._every = stride(rows, most)
        self._gap = 1.5 * self._every * duration / max(rows - 1, 1)
        self._last = -np.inf  # time of the row chosen last, s

    def pick(self, run: Run) -> np.ndarray:
        """Indices of the chosen rows of the next block."""
        chosen = np.arange(len(run))[on_stride(run, self._every)]
        time = run.time
        marks = np.concatenate([[self._last], time[chosen], time[-1:]])
        if self._every > 1 and np.any(np.diff(marks) > self._gap):
            chosen = self._walk(run.first, time.tolist())
        if len(chosen):
            self._last = float(time[chosen[-1]])
        return chosen

    def _walk(self, first: int, time: list[float]) -> np.ndarray:
        last, chosen = self._last, []
        for i, moment in enumerate(time):
            if (first + i) % self._every == 0 or moment - last >= self._gap:
                chosen.append(i)
                last = moment
        return np.array(chosen, int)


def check_duration(run: Run) -> None:
    """Raise RecordingError where a time of the run does not fit a timeline."""
    last = max(abs(run.setting.duration), abs(float(run.time[-1])) if len(run) else 0.0)
    if last >= LONGEST:
        raise RecordingError(
            "a recording counts nanoseconds in 64 bits and so can span 292 years, "
            f"but this run spans {last / YEAR:.4g} years"
        )
    epoch = run.setting.epoch
    if epoch is not None and int(epoch.astype("datetime64[ns]").astype(np.int64)) + last * 1e9 >= 2**63:
        raise RecordingError(
            f"the UTC timeline of a recording ends in the year 2262, but this run starts at {epoch} and goes beyond"
        )


class MixedIndex(list[rr.TimeColumn]):
    """The timelines of drawn rows and of points between them, `filled` (n,) bool, which have no step. rows, between :
    the timelines of either."""

    def __init__(self, setting: Setting, number: np.ndarray, time: np.ndarray, filled: np.ndarray):
        super().__init__(time_columns(setting, number, time))
        self.filled = filled
        self.rows = time_columns(setting, number[~filled], time[~filled])
        self.between = between_rows(setting, time[filled])


def between_rows(setting: Setting, time: ArrayLike) -> list[rr.TimeColumn]:
    """The columns sim_time and, where the scene has an epoch, utc, of times (n,) s between rows, which have no step."""
    return time_columns(setting, np.zeros(np.shape(time), np.int64), time)[1:]


def time_columns(setting: Setting, number: ArrayLike, time: ArrayLike) -> list[rr.TimeColumn]:
    """The columns step, sim_time and, where the scene has an epoch, utc. number (n,) int, time (n,) s."""
    ns = np.round(np.asarray(time, float) * 1e9).astype(np.int64).astype("timedelta64[ns]")
    columns = [rr.TimeColumn("step", sequence=np.asarray(number, np.int64)), rr.TimeColumn("sim_time", duration=ns)]
    if setting.epoch is not None:
        columns.append(rr.TimeColumn("utc", timestamp=setting.epoch.astype("datetime64[ns]") + ns))
    return columns
