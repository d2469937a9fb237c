"""Runs into recordings: block by block, with flat memory, to files and viewers at once."""

from __future__ import annotations

import signal
import sys
import threading
import time as clock
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from pathlib import Path
from types import TracebackType
from typing import Any, Self

import rerun as rr
from numpy.typing import ArrayLike
from rerun.error_utils import catch_and_log_exceptions

from sailviz.errors import RecordingError
from sailviz.recording import timelines
from sailviz.recording.companions import Overlay
from sailviz.recording.drain import Drain
from sailviz.recording.growing import GrowingRecording, why
from sailviz.recording.sinks import Sink, discard, resolve
from sailviz.run.arrays import Run

BLOCK = 16_384  # rows sent at once: large enough for speed, small enough for memory


@dataclass(frozen=True)
class Recorded:
    """What was recorded. `complete` is False where the run was interrupted; `url` is where a browser finds it;
    `remarks` are sentences about gaps and sparse rows."""

    rows: int
    complete: bool
    identity: str
    paths: tuple[Path, ...]
    seconds: float  # of wall time inside the recorder
    url: str = ""
    remarks: tuple[str, ...] = ()
    stream: rr.RecordingStream | None = field(default=None, repr=False, compare=False)  # which serves the browser
    drains: tuple[Drain, ...] = field(default=(), repr=False, compare=False)  # what then still goes to files

    def serve(self) -> None:
        """Keep a recording for the browser alive until Ctrl-C; returns at once for every other sink."""
        if not self.url:
            return
        try:
            while True:
                clock.sleep(3600)
        except KeyboardInterrupt:
            if self.stream is not None:
                self.stream.disconnect()
            for drain in self.drains:
                drain.close()


def record(run: Run | Iterable[Run], sink: Sink, *more_sinks: Sink) -> Recorded:
    """Record a run, or the consecutive blocks of one, to a path, VIEWER, WEB, Connect(url), Memory() or "-".

    Several sinks may be given (a file and a viewer, say). With WEB this returns when interrupted.
    Raises RecordingError where a sink cannot be written, before the first block is asked for.
    """
    with Recorder(sink, *more_sinks) as recorder:
        for block in [run] if isinstance(run, Run) else run:
            recorder.add(block)
        recorded = recorder.finish()
    return served(recorded)


def served(recorded: Recorded) -> Recorded:
    """A recording for the browser is served until Ctrl-C; every other one is there at once."""
    if recorded.url:
        print(f"{recorded.url} shows the recording until Ctrl-C", file=sys.stderr)
        recorded.serve()
    return recorded


class Recorder:
    """A recording while it grows: `with Recorder("orbit.rrd") as recorder: recorder.add(block)`.

    A file has a temporary name until it is finished, so that a recording appears whole. When the body of the `with`
    raises after a block was added, the recording is finished with what there is, an event says why, /scene says
    complete = False, and the exception goes on. When it raises earlier, nothing is left behind.
    """

    def __init__(self, *sinks: Sink, overlay: Overlay | None = None):
        """sinks : as in `record`; overlay : the flights that are drawn beside this one. Raises RecordingError where a
        sink cannot be written."""
        self._sinks = resolve(sinks)
        self._overlay = overlay
        self._growing: GrowingRecording | None = None
        self._seconds = 0.0
        self.recorded: Recorded | None = None

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, traceback: TracebackType | None
    ) -> None:
        if self.recorded is not None:
            return
        if kind is None:
            self.finish()
        elif self._last is None:
            self._abandon()
        else:
            try:
                self.finish(note=why(error, self._last), complete=False)
            except Exception:
                self._abandon()  # the first error is the one to tell

    @property
    def _last(self) -> Run | None:
        """The last row that was written."""
        return None if self._growing is None else self._growing.last

    @property
    def time(self) -> float:
        """Time of the last row that was written, s."""
        return 0.0 if self._last is None else float(self._last.time[0])

    def add(self, run: Run) -> None:
        """Append the next block. Raises RecordingError where it does not follow the one before, or lasts over 292
        years.
        """
        if self.recorded is not None:
            raise RecordingError("this recording is finished; a block came after its end")
        rows = 0 if self._growing is None else self._growing.rows
        if run.first != rows:
            raise RecordingError(
                f"the blocks of a run must follow each other: row {rows} was due, row {run.first} came"
            )
        timelines.check_duration(run)
        started = clock.perf_counter()
        with not_interrupted(), catch_and_log_exceptions("recording", strict=True):
            for start in range(0, len(run), BLOCK):
                piece = timelines.take(run, slice(start, start + BLOCK))
                piece = replace(piece, first=run.first + start, events=run.events if start == 0 else ())
                if self._growing is None:
                    self._growing = GrowingRecording(piece, self._sinks, self._overlay)
                self._growing.add(piece)
        self._seconds += clock.perf_counter() - started

    def finish(self, note: str = "", complete: bool = True) -> Recorded:
        """Close the recording and give files their names. `note` becomes an event at the last row."""
        if self.recorded is not None:
            return self.recorded
        growing, last = self._growing, self._last
        if growing is None or last is None:
            self._abandon()
            raise RecordingError("there is nothing to record: the run has no rows")
        started = clock.perf_counter()
        with not_interrupted(), catch_and_log_exceptions("recording", strict=True):
            paths = growing.finish(last, note, complete)
        self._seconds += clock.perf_counter() - started
        self.recorded = Recorded(
            rows=growing.rows,
            complete=complete,
            identity=growing.identity,
            paths=paths,
            seconds=self._seconds,
            url=growing.url,
            remarks=growing.remarks,
            stream=growing.stream,
            drains=growing.drains,
        )
        return self.recorded

    def _abandon(self) -> None:
        if self._growing is not None:
            self._growing.abandon()
        discard(self._sinks)


@contextmanager
def not_interrupted() -> Iterator[None]:
    """Hold back Ctrl-C while a block is written, so that every entity has the same rows; then let it through."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    pressed: list[int] = []
    try:
        before = signal.signal(signal.SIGINT, lambda number, _: pressed.append(number))
    except ValueError:  # inside a sub-interpreter
        yield
        return
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)
    if any(number != signal.SIGINT or before is not signal.SIG_IGN for number in pressed):
        raise KeyboardInterrupt


def record_trajectory(
    time: ArrayLike, position: ArrayLike, velocity: ArrayLike, sink: Sink, *more_sinks: Sink, **options: Any
) -> Recorded:
    """Record a trajectory from elsewhere with the same views as a simulated one.

    time (n,) s, increasing; position (n, 3) m and velocity (n, 3) m/s, inertial, from the central body; sink as in
    `record`. The options are those of `trajectory`. Raises TrajectoryError (a ValueError) with every fault at once,
    and RecordingError where the sink cannot be written.
    """
    from sailviz.run.from_arrays import trajectory

    return record(trajectory(time, position, velocity, **options), sink, *more_sinks)
