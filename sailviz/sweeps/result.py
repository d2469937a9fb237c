"""What comes of a sweep: a table with a row per flight, and the recordings that were asked for."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from sailviz.sweeps.flight import RUNNING
from sailviz.sweeps.store import MemoryStore

if TYPE_CHECKING:
    import pyarrow as pa


@dataclass(frozen=True)
class Sweep:
    """What came of a sweep: a row per flight, in their order."""

    flights: int  # asked for; fewer rows if interrupted
    failed: int  # flights that did not fly to their end; `reason` says why
    missed: int  # flights that missed an [[expect]] of the scene
    resumed: int  # flights that were done before
    path: Path | None  # of the table, None if it was kept in memory
    recordings: dict[int, Path]  # by the number of the flight
    _store: MemoryStore = field(repr=False)

    @property
    def running(self) -> int:
        """Flights that had not come where they were awaited when their time was over; no failures."""
        return self._store.columns(["status"])["status"].to_pylist().count(RUNNING)

    @property
    def complete(self) -> bool:
        """Whether all flights are there."""
        return bool(self._store.done.all())

    def to_arrow(self, columns: list[str] | None = None) -> pa.Table:
        """The table or some columns of it, read from its file if it has one."""
        return self._store.columns(columns)

    @property
    def table(self) -> dict[str, np.ndarray]:
        """Column -> (n,) array; numbers as float64 with NaN where nothing was measured, whole numbers as int64, words
        as objects."""
        table = self.to_arrow()
        return {name: _array(table[name]) for name in table.column_names}

    def to_numpy(self) -> np.ndarray:
        """The table as one structured array. (n,)"""
        columns = self.table
        rows = np.empty(
            len(next(iter(columns.values()))), dtype=[(name, values.dtype) for name, values in columns.items()]
        )
        for name, values in columns.items():
            rows[name] = values
        return rows

    def __len__(self) -> int:
        return int(self._store.done.sum())


def _array(column: pa.ChunkedArray) -> np.ndarray:
    import pyarrow as pa

    if pa.types.is_floating(column.type) or pa.types.is_integer(column.type):
        return column.to_numpy()
    return np.array(column.to_pylist(), dtype=object)
