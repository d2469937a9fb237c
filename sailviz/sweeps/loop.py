"""Many flights of one scene: over a grid of its keys, over distributions of them, or both.

    found = sailviz.sweep("spirals/optical-sail", {"steering.pitch_deg": "30:40:11"}, report=["time_d@end"])
    found.table["steering.pitch_deg"], found.table["time_d@end"]

The flights are dealt out in chunks of about half a second to any concurrent.futures.Executor; a flight depends on the
definition and its own number alone, so workers, chunks and order change nothing.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterable, Mapping
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, CancelledError, Executor, wait
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from sailviz.scene.loading import Scene
from sailviz.sweeps.definition import Definition, define
from sailviz.sweeps.engines import abandon, check_engine, engine, processes, workers_of
from sailviz.sweeps.flight import DIED, blank, fly
from sailviz.sweeps.picks import check_picks, record_picked
from sailviz.sweeps.store import FileStore, MemoryStore, SweepError, counts

__all__ = ["Sweep", "SweepError", "sweep"]

CHUNK_SECONDS = 0.5  # of work: handing out a chunk and writing its rows costs milliseconds
CHUNK_FLIGHTS = 2_000
AHEAD = 2  # chunks per worker that are handed out, so that none waits for this process


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
    def complete(self) -> bool:
        """Whether all flights are there."""
        return bool(self._store.done.all())

    def to_arrow(self, columns: list[str] | None = None):
        """The table or some columns of it, read from its file if it has one. pyarrow.Table"""
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


def _array(column) -> np.ndarray:
    import pyarrow as pa

    if pa.types.is_floating(column.type) or pa.types.is_integer(column.type):
        return column.to_numpy()
    return np.array(column.to_pylist(), dtype=object)


def sweep(
    scene: Scene | str | Path | dict,
    vary: Mapping[str, Any] | None = None,
    *,
    draws: int | None = None,
    seed: int | None = None,
    together: bool | None = None,
    report: Iterable[str] = (),
    values: Mapping[str, Any] | None = None,
    executor: Executor | None = None,
    engine: str = "processes",
    workers: int | None = None,
    path: str | Path | None = None,
    record: Iterable[str | int] = (),
    progress: Callable[[int, int], None] | None = None,
) -> Sweep:
    """Fly a scene many times and return a row per flight.

    scene : Scene, scene file, sweep file, shipped name or dict. vary : {key of the scene: list of values, or text such
    as "0.5:1.5:11" or "normal(1, 0.05)"}; several lists make a grid, with together they step in pace. draws : flights
    per point of the grid, where a key has a distribution. seed : of the draws, 0 by default. report : quantities
    beside the scene's own [[expect]], "radius_au@end". values : put over the scene's. executor : any
    concurrent.futures.Executor; without it engine ("processes", "threads", "serial", "dask", "dask://host:port") and
    workers. path : table to write (parquet); an unfinished sweep of the same definition goes on from there. record :
    flights to record beside the table, by number or "min:COLUMN", "max:COLUMN", "median:COLUMN", "failed". progress :
    called with flights done and asked for.

    A script that sweeps over processes needs `if __name__ == "__main__":` round it. Raises SceneError with every fault
    of the definition, SweepError if path holds something else or cannot be written, or the executor breaks down.
    """
    definition, wanted = define(scene, vary, draws, seed, tuple(report), together, values)
    return fly_all(definition, [*wanted, *record], executor, engine, workers, path, progress)


def fly_all(definition, record=(), executor=None, engine_name="processes", workers=None, path=None, progress=None):
    """Like `sweep`, of a definition that was made and checked before. Sweep"""
    check_engine(engine_name)
    picks = check_picks(definition, record)
    if picks and path is None:
        raise SweepError("recordings are written beside the table: give it a path")
    store = MemoryStore(definition) if path is None else FileStore(definition, Path(path))
    resumed = int(store.done.sum())
    if progress:
        progress(resumed, definition.flights)
    if not store.done.all():
        try:
            if executor is not None:
                _fly(definition, store, executor, progress)
            else:
                with engine(engine_name, workers) as made:
                    _fly(definition, store, made, progress, workers)
        except BaseException:
            store.close()  # what is done stays, as a table
            raise
    store.close()
    recordings = record_picked(definition, picks, store) if picks else {}
    return Sweep(definition.flights, *counts(store), resumed, store.path, recordings, store)


class _Chunks:
    """Which flights to hand out next: those not done, in order, as many as keep a worker busy for a while."""

    def __init__(self, done: np.ndarray, workers: int):
        edges = np.flatnonzero(np.diff(np.concatenate([[True], done, [True]]).astype(np.int8)))
        self._gaps = deque(zip(edges[::2].tolist(), edges[1::2].tolist(), strict=True))
        self._left = int((~done).sum())
        self._workers = workers
        self._seconds: float | None = None  # wall time of a flight, lately

    def measured(self, rows) -> None:
        """Learn how long flights take."""
        # the first flight of a process loads its machine code: the shortest half says what the next ones take
        walls = sorted(row["wall_s"] for row in rows)
        latest = sum(walls[: (len(walls) + 1) // 2]) / ((len(walls) + 1) // 2)
        self._seconds = latest if self._seconds is None else min(0.5 * (self._seconds + latest), 2 * latest)

    def next(self) -> tuple[int, int] | None:
        """(first, stop), None if all are handed out."""
        if not self._gaps:
            return None
        size = 1
        if self._seconds is not None:
            fair = -(-self._left // (2 * self._workers))  # small chunks at the end, so that all finish together
            size = max(1, min(int(CHUNK_SECONDS / max(self._seconds, 1e-9)), CHUNK_FLIGHTS, fair))
        first, stop = self._gaps.popleft()
        if first + size < stop:
            self._gaps.appendleft((first + size, stop))
            stop = first + size
        self._left -= stop - first
        return first, stop


def _fly(definition: Definition, store: MemoryStore, executor, progress, workers=None) -> None:
    """Hand out chunks until all flights are in the store. executor : None for processes of our own."""
    own = executor is None
    pool = processes(workers) if own else executor
    count = workers_of(pool)
    chunks = _Chunks(store.done, count)
    suspects: deque[tuple[int, int]] = deque()  # single flights, one of which killed a process
    pending: dict = {}
    any_done = False
    try:
        while True:
            broken = False
            room = 1 if suspects else AHEAD * count
            while len(pending) < room and (chunk := suspects.popleft() if suspects else chunks.next()):
                try:
                    pending[pool.submit(fly, definition, *chunk)] = chunk
                except BrokenExecutor:
                    suspects.append(chunk)
                    broken = True
                    break
            if not pending and not broken:
                break
            finished, _ = wait(pending, timeout=1.0, return_when=FIRST_COMPLETED)
            alone = len(pending) == 1
            for future in finished:
                chunk = pending.pop(future)
                try:
                    rows = future.result()
                except (BrokenExecutor, CancelledError):
                    suspects.append(chunk)
                    broken = True
                    continue
                store.add(rows)
                chunks.measured(rows)
                any_done = True
                if progress:
                    progress(int(store.done.sum()), len(store.done))
            if broken:
                suspects.extend(pending.values())
                pending.clear()
                _give_up_if(not own, not any_done)
                abandon(pool)
                pool = processes(workers)
                single = [flight for first, stop in suspects for flight in range(first, stop)]
                suspects.clear()
                if alone and len(single) == 1:
                    store.add([{**blank(definition, single[0]), "reason": DIED, "duration_s": 0.0, "wall_s": 0.0}])
                else:
                    suspects.extend((flight, flight + 1) for flight in sorted(single))
    except BaseException:
        for future in pending:
            future.cancel()
        if own:
            abandon(pool)
        raise
    if own:
        pool.shutdown()


def _give_up_if(foreign: bool, none_done: bool) -> None:
    if foreign:
        raise SweepError(
            "the executor broke down; finished flights are kept, and a sweep with a path goes on from them"
        )
    if none_done:
        raise SweepError(
            'the processes die before a flight is done: a script that sweeps needs `if __name__ == "__main__":` '
            "round it; or a flight takes more memory than there is"
        )
