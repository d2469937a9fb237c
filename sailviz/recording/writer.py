"""Runs into recordings: block by block, with flat memory, to files and viewers at once."""

from __future__ import annotations

import signal
import sys
import threading
import time as clock
from collections.abc import Iterable
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Self

import numpy as np
import rerun as rr
from rerun.error_utils import catch_and_log_exceptions

from sailviz.errors import PropagationError, RecordingError
from sailviz.recording import contract, timelines
from sailviz.recording.drawing.drawing import Drawing
from sailviz.recording.sinks import File, Memory, Web, attach, discard, resolve, web_address
from sailviz.run.arrays import Event, Run

BLOCK = 16_384  # rows sent at once: large enough for speed, small enough for memory


@dataclass(frozen=True)
class Recorded:
    """What was recorded. `complete` is False where the run was interrupted; `url` is where a browser finds it."""

    rows: int
    complete: bool
    identity: str
    paths: tuple[Path, ...]
    seconds: float  # of wall time inside the recorder
    url: str = ""

    def serve(self) -> None:
        """Keep a recording for the browser alive until Ctrl-C; returns at once for every other sink."""
        if not self.url:
            return
        try:
            while True:
                clock.sleep(3600)
        except KeyboardInterrupt:
            self._stream.disconnect()


def record(run: Run | Iterable[Run], sink, *more_sinks) -> Recorded:
    """Record a run, or the consecutive blocks of one, to a path, VIEWER, WEB, Connect(url), Memory() or "-".

    Several sinks may be given (a file and a viewer, say). With WEB this returns when interrupted.
    Raises RecordingError where a sink cannot be written, before the first block is asked for.
    """
    with Recorder(sink, *more_sinks) as recorder:
        for block in [run] if isinstance(run, Run) else run:
            recorder.add(block)
        recorded = recorder.finish()
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

    def __init__(self, *sinks):
        self._sinks = resolve(sinks)
        self._stream = None
        self._setting = None
        self._rows = 0
        self._ended = ""
        self._events: list[Event] = []  # those that lie after the last row seen
        self._last: Run | None = None  # the last row seen
        self._seconds = 0.0
        self.recorded: Recorded | None = None

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind, error, traceback) -> bool:
        if self.recorded is not None:
            return False
        if kind is None:
            self.finish()
        elif self._last is None:
            self._abandon()
        else:
            try:
                self.finish(note=self._why(error), complete=False)
            except Exception:
                self._abandon()  # the first error is the one to tell
        return False

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
        if run.first != self._rows:
            raise RecordingError(
                f"the blocks of a run must follow each other: row {self._rows} was due, row {run.first} came"
            )
        timelines.check_duration(run)
        started = clock.perf_counter()
        with _not_interrupted(), catch_and_log_exceptions("recording", strict=True):
            for start in range(0, len(run), BLOCK):
                piece = timelines.take(run, slice(start, start + BLOCK))
                self._add(replace(piece, first=run.first + start, events=run.events if start == 0 else ()))
        self._seconds += clock.perf_counter() - started

    def finish(self, note: str = "", complete: bool = True) -> Recorded:
        """Close the recording and give files their names. `note` becomes an event at the last row."""
        if self.recorded is not None:
            return self.recorded
        if self._last is None:
            self._abandon()
            raise RecordingError("there is nothing to record: the run has no rows")
        started = clock.perf_counter()
        with _not_interrupted(), catch_and_log_exceptions("recording", strict=True):
            if note:
                self._events.append(self._event_now(note))
            self._write_events(self._events, np.full(len(self._events), self._rows - 1))
            self._drawing.finish(self._last)
            self._write_scene(complete)
            paths = self._close()
        self._seconds += clock.perf_counter() - started
        web = next((sink for sink in self._sinks if isinstance(sink, Web)), None)
        self.recorded = Recorded(
            rows=self._rows,
            complete=complete,
            identity=self._setting.identity,
            paths=paths,
            seconds=self._seconds,
            url=web_address(web, self._attached) if web else "",
        )
        object.__setattr__(self.recorded, "_stream", self._stream)
        return self.recorded

    def _add(self, block: Run) -> None:
        if self._stream is None:
            self._open(block)
        index = timelines.time_columns(self._setting, self._rows + np.arange(len(block)), block.time)
        for entity, table in contract.tables(block).items():
            if table:
                self._stream.send_columns(entity, index, contract.columns(entity, table))
        self._add_events(block)
        self._drawing.add(block)
        first = self._last is None
        self._rows += len(block)
        self._ended = block.ended
        self._last = replace(timelines.take(block, slice(-1, None)), first=self._rows - 1, events=())
        if first:
            self._write_scene(complete=False)  # so that a recording cut off by a crash still says what it was
        self._flush()

    def _flush(self) -> None:
        try:
            self._stream.flush(timeout_sec=60)
        except RuntimeError as error:
            raise RecordingError(f"the recording could not be written: {str(error).splitlines()[0]}") from None

    def _open(self, block: Run) -> None:
        self._setting = setting = block.setting
        # the viewer keeps one arrangement of views for each application: each scene needs its own
        application = f"sailviz_{setting.family}_{setting.identity[:8]}"
        stream = rr.RecordingStream(application, recording_id=setting.identity, send_properties=False)
        stream.set_log_time_enabled(False)
        stream.set_log_tick_enabled(False)
        self._attached = attach(stream, self._sinks)
        self._stream = stream
        stream.send_recording_name(setting.title)
        self._drawing = Drawing(stream, block)

    def _add_events(self, block: Run) -> None:
        """Write the events that have a row at or after them by now; keep the others."""
        due = sorted([*self._events, *block.events], key=lambda event: event.time)
        row = np.searchsorted(block.time, [event.time for event in due], side="left")
        count = int(np.sum(row < len(block)))
        self._write_events(due[:count], self._rows + row[:count])
        self._events = due[count:]

    def _write_events(self, events: list[Event], number) -> None:
        if not events:
            return
        index = timelines.time_columns(self._setting, number, [event.time for event in events])
        self._stream.send_columns("/events", index, contract.event_columns(events))
        self._drawing.add_events(events, index)

    def _event_now(self, name: str) -> Event:
        last = self._last
        return Event(name, float(last.time[0]), np.concatenate([last.position[0], last.velocity[0], last.mass]))

    def _write_scene(self, complete: bool) -> None:
        scene = contract.scene(self._setting, rows=self._rows, complete=complete, ended=self._ended)
        self._stream.log("/scene", scene, static=True)

    def _why(self, error: BaseException) -> str:
        if isinstance(error, KeyboardInterrupt):
            return f"interrupted at t = {self._last.time[0]:.6g} s ({self._last.time[0] / 86400:.4g} d)"
        if isinstance(error, PropagationError):
            return str(error)
        return f"stopped by {type(error).__name__}: {error}"

    def _close(self) -> tuple[Path, ...]:
        if self._sinks and isinstance(self._sinks[0], Memory):
            self._flush()
            self._sinks[0].bytes = self._attached.drain_as_bytes()
        if any(isinstance(sink, Web) for sink in self._sinks):
            self._flush()  # disconnecting would stop the server; Recorded.serve does it
        else:
            self._stream.disconnect()
        files = [sink for sink in self._sinks if isinstance(sink, File)]
        for file in files:
            file.publish()
        return tuple(file.path for file in files)

    def _abandon(self) -> None:
        if self._stream is not None:
            self._stream.disconnect()
        discard(self._sinks)


@contextmanager
def _not_interrupted():
    """Hold back Ctrl-C while a block is written, so that every entity has the same rows; then let it through."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    pressed = []
    try:
        before = signal.signal(signal.SIGINT, lambda *_: pressed.append(True))
    except ValueError:  # inside a sub-interpreter
        yield
        return
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)
    if pressed:
        raise KeyboardInterrupt


def record_trajectory(time, position, velocity, sink, *more_sinks, **options):
    """Record a trajectory from elsewhere with the same views as a simulated one -> Recorded.

    time (n,) s, increasing; position (n, 3) m and velocity (n, 3) m/s, inertial, from the central body; sink as in
    `record`. The options are those of `trajectory`. Raises TrajectoryError (a ValueError) with every fault at once,
    and RecordingError where the sink cannot be written.
    """
    from sailviz.run.from_arrays import trajectory

    return record(trajectory(time, position, velocity, **options), sink, *more_sinks)
