"""Dealing flights out to workers, in chunks, until all of them are in the store, whatever becomes of a worker."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterable, Mapping, Sequence
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, CancelledError, Executor, Future, wait
from math import inf
from time import perf_counter
from typing import Any

import numpy as np

from sailviz.errors import TimeLimitError
from sailviz.sweeps.definition import Definition
from sailviz.sweeps.engines import abandon, processes, workers_of
from sailviz.sweeps.flight import DIED, blank, fly
from sailviz.sweeps.store import MemoryStore, SweepError

CHUNK_SECONDS = 0.5  # of work: handing out a chunk and writing its rows costs milliseconds
CHUNK_FLIGHTS = 2_000
AHEAD = 2  # chunks per worker that are handed out, so that none waits for this process

Chunk = tuple[int, int]  # first flight, and the one after the last
Progress = Callable[[int, int], None]


class Chunks:
    """Which flights to hand out next: those not done, in order, as many as keep a worker busy for a while."""

    def __init__(self, done: np.ndarray, workers: int):
        edges = np.flatnonzero(np.diff(np.concatenate([[True], done, [True]]).astype(np.int8)))
        self._gaps: deque[Chunk] = deque(zip(edges[::2].tolist(), edges[1::2].tolist(), strict=True))
        self._left = int((~done).sum())
        self._workers = workers
        self._seconds: float | None = None  # wall time of a flight, lately

    def measured(self, rows: Sequence[Mapping[str, Any]]) -> None:
        """Learn how long flights take."""
        # the first flight of a process loads its machine code: the shortest half says what the next ones take
        walls = sorted(row["wall_s"] for row in rows)
        latest = sum(walls[: (len(walls) + 1) // 2]) / ((len(walls) + 1) // 2)
        self._seconds = latest if self._seconds is None else min(0.5 * (self._seconds + latest), 2 * latest)

    def next(self) -> Chunk | None:
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


class Dealer:
    """Hands out chunks until all flights are in the store. executor : None for processes of our own, which are begun
    anew when a flight kills one."""

    def __init__(
        self,
        definition: Definition,
        store: MemoryStore,
        executor: Executor | None,
        progress: Progress | None,
        workers: int | None = None,
        time_limit: float | None = None,
    ):
        self._time_limit, self._begun = time_limit, perf_counter()
        self._definition, self._store, self._progress = definition, store, progress
        self._own, self._workers = executor is None, workers
        self._pool = processes(workers) if executor is None else executor
        self._count = workers_of(self._pool)
        self._chunks = Chunks(store.done, self._count)
        self._suspects: deque[Chunk] = deque()  # single flights, one of which killed a process
        self._pending: dict[Future[list[dict[str, Any]]], Chunk] = {}
        self._any_done = False

    def deal(self) -> None:
        """Fly everything. SweepError where the workers cannot be brought to it, TimeLimitError when the time is
        over."""
        try:
            while True:
                broken = self._hand_out()
                if not self._pending and not broken:
                    break
                finished, _ = wait(self._pending, timeout=min(1.0, self._time_left()), return_when=FIRST_COMPLETED)
                alone = len(self._pending) == 1
                broken = self._take(finished) or broken
                if self._time_left() <= 0.0 and not self._store.done.all():
                    raise self._over()
                if broken:
                    self._begin_anew(alone)
        except BaseException:
            for future in self._pending:
                future.cancel()
            if self._own:
                abandon(self._pool)
            raise
        if self._own:
            self._pool.shutdown()

    def _time_left(self) -> float:
        """Wall time that is left, s."""
        return inf if self._time_limit is None else self._time_limit - (perf_counter() - self._begun)

    def _over(self) -> TimeLimitError:
        done, asked = int(self._store.done.sum()), len(self._store.done)
        return TimeLimitError(
            f"the time limit of {self._time_limit:g} s is over: {done:,} of {asked:,} flights are done"
        )

    def _hand_out(self) -> bool:
        """As many chunks as there is room for, suspects one by one. Whether the pool turned out to be broken."""
        room = 1 if self._suspects else AHEAD * self._count
        while len(self._pending) < room:
            chunk = self._suspects.popleft() if self._suspects else self._chunks.next()
            if chunk is None:
                break
            try:
                limit = () if self._time_limit is None else (max(self._time_left(), 1e-9),)
                self._pending[self._pool.submit(fly, self._definition, *chunk, *limit)] = chunk
            except BrokenExecutor:
                self._suspects.append(chunk)
                return True
        return False

    def _take(self, finished: Iterable[Future[list[dict[str, Any]]]]) -> bool:
        """Rows of what is done into the store. Whether a worker broke down over one of them."""
        broken = False
        for future in finished:
            chunk = self._pending.pop(future)
            try:
                rows = future.result()
            except (BrokenExecutor, CancelledError):
                self._suspects.append(chunk)
                broken = True
                continue
            except TimeLimitError:
                raise self._over() from None
            self._store.add(rows)
            self._chunks.measured(rows)
            self._any_done = True
            if self._progress:
                self._progress(int(self._store.done.sum()), len(self._store.done))
        return broken

    def _begin_anew(self, alone: bool) -> None:
        """New processes, and what was under way again, flight by flight. alone : only one chunk was under way, so that
        a single flight in it is the one that killed its process, and is not tried again."""
        self._suspects.extend(self._pending.values())
        self._pending.clear()
        if not self._own:
            raise SweepError(
                "the executor broke down; finished flights are kept, and a sweep with a path goes on from them"
            )
        if not self._any_done:
            raise SweepError(
                'the processes die before a flight is done: a script that sweeps needs `if __name__ == "__main__":` '
                "round it; or a flight takes more memory than there is"
            )
        abandon(self._pool)
        self._pool = processes(self._workers)
        single = [flight for first, stop in self._suspects for flight in range(first, stop)]
        self._suspects.clear()
        if alone and len(single) == 1:
            died = {"reason": DIED, "duration_s": 0.0, "wall_s": 0.0}
            self._store.add([{**blank(self._definition, single[0]), **died}])
        else:
            self._suspects.extend((flight, flight + 1) for flight in sorted(single))
