"""Many flights of one scene: over a grid of its keys, over distributions of them, or both.

    found = sailviz.sweep("spirals/optical-sail", {"steering.pitch_deg": "30:40:11"}, report=["time_d@end"])
    found.table["steering.pitch_deg"], found.table["time_d@end"]

The flights are dealt out in chunks of about half a second to any concurrent.futures.Executor; a flight depends on the
definition and its own number alone, so workers, chunks and order change nothing.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from concurrent.futures import Executor
from pathlib import Path
from typing import Any

from sailviz.errors import OutputError
from sailviz.files import writing
from sailviz.scene.loading import SceneSource
from sailviz.sweeps import engines
from sailviz.sweeps.dealing import Dealer
from sailviz.sweeps.definition import Definition, define
from sailviz.sweeps.picks import check_picks, record_picked
from sailviz.sweeps.result import Sweep
from sailviz.sweeps.store import FileStore, MemoryStore, SweepError, counts


def sweep(
    scene: SceneSource,
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
    time_limit: float | None = None,
) -> Sweep:
    """Fly a scene many times and return a row per flight.

    scene : Scene, scene file, sweep file, shipped name or dict. vary : {key of the scene: list of values, or text such
    as "0.5:1.5:11" or "normal(1, 0.05)"}; several lists make a grid, with together they step in pace. draws : flights
    per point of the grid, where a key has a distribution. seed : of the draws, 0 by default. report : quantities
    beside the scene's own [[expect]], "radius_au@end". values : put over the scene's. executor : any
    concurrent.futures.Executor; without it engine ("processes", "threads", "serial", "dask", "dask://host:port") and
    workers. path : table to write, parquet by its ending, or CSV beside such a one; an unfinished sweep of the same
    definition goes on from there. record : flights to record beside the table, by number or "min:COLUMN", "max:COLUMN",
    "median:COLUMN", "failed". progress : called with flights done and asked for.
    time_limit : s of wall time for all flights together.

    A script that sweeps over processes needs `if __name__ == "__main__":` round it. Raises SceneError with every fault
    of the definition, SweepError if path holds something else or cannot be written, or the executor breaks down,
    TimeLimitError when the time is over: finished flights are kept as after Ctrl-C.
    """
    definition, wanted = define(scene, vary, draws, seed, tuple(report), together, values)
    return fly_all(definition, [*wanted, *record], executor, engine, workers, path, progress, time_limit)


def fly_all(
    definition: Definition,
    record: Iterable[str | int] = (),
    executor: Executor | None = None,
    engine: str = "processes",
    workers: int | None = None,
    path: str | Path | None = None,
    progress: Callable[[int, int], None] | None = None,
    time_limit: float | None = None,
) -> Sweep:
    """Like `sweep`, of a definition that was made and checked before."""
    engines.check_engine(engine)
    picks = check_picks(definition, record)
    if picks and path is None:
        raise SweepError("recordings are written beside the table: give it a path")
    store = MemoryStore(definition) if path is None else FileStore(definition, parquet_of(path))
    resumed = int(store.done.sum())
    if progress:
        progress(resumed, definition.flights)
    if not store.done.all():
        try:
            if executor is not None:
                Dealer(definition, store, executor, progress, time_limit=time_limit).deal()
            else:
                with engines.engine(engine, workers) as made:
                    Dealer(definition, store, made, progress, workers, time_limit).deal()
        except BaseException:
            _finish(store, path)  # what is done stays, as a table
            raise
    _finish(store, path)
    recordings = record_picked(definition, picks, store) if isinstance(store, FileStore) and picks else {}
    written = None if path is None else Path(path)
    return Sweep(definition.flights, *counts(store), resumed, written, recordings, store)


def parquet_of(path: str | Path) -> Path:
    """Where the rows of a table lie: in itself, beside it if it is a CSV, which can hold no definition."""
    found = Path(path)
    return found.with_suffix(".parquet") if found.suffix.lower() == ".csv" else found


def _finish(store: MemoryStore, path: str | Path | None) -> None:
    """Put the table into order, and write it as a CSV too if that was asked for."""
    store.close()
    if path is None or store.path is None or Path(path) == store.path or not store.path.exists():
        return
    import pyarrow.csv

    try:
        with writing(path, "table") as part:
            pyarrow.csv.write_csv(store.columns(), part)
    except OutputError as error:
        raise SweepError(str(error)) from None
