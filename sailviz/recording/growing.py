"""A recording that is open: what is written of each block, and how it ends."""

from __future__ import annotations

import errno
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
import rerun as rr

from sailviz.errors import OutputError, PropagationError, RecordingError, TimeLimitError
from sailviz.files import Output, lacking, reason
from sailviz.recording import checksums, contract, timelines
from sailviz.recording.companions import Companion, Overlay
from sailviz.recording.drain import Drain
from sailviz.recording.drawing.drawing import Drawing
from sailviz.recording.framing import framing
from sailviz.recording.sinks import Memory, Opened, Web, attach, web_address
from sailviz.run.arrays import Event, Run


class GrowingRecording:
    """The stream of a recording, from its first block on. `last` is the last row that was written."""

    def __init__(self, first: Run, sinks: Sequence[Opened], overlay: Overlay | None = None):
        self.rows = 0
        self._overlay = overlay
        self.last: Run | None = None
        self._sinks = sinks
        self._setting = setting = first.setting
        self._ended = ""
        self._events: list[Event] = []  # those that lie after the last row seen
        # the viewer keeps one arrangement of views for each application: each scene needs its own
        application = f"sailviz_{setting.family}_{setting.identity[:8]}"
        self.stream = rr.RecordingStream(application, recording_id=setting.identity, send_properties=False)
        self.stream.set_log_time_enabled(False)
        self.stream.set_log_tick_enabled(False)
        self._attached = attach(self.stream, sinks)
        self.stream.send_recording_name(setting.title)
        try:
            self._drawing = Drawing(self.stream, first, overlay)
        except BaseException:
            self.abandon()
            raise

    @property
    def url(self) -> str:
        """Where a browser finds it, "" where none is served."""
        web = next((sink for sink in self._sinks if isinstance(sink, Web)), None)
        return web_address(web, self._attached.server) if web and self._attached.server else ""

    @property
    def drains(self) -> tuple[Drain, ...]:
        """The pipes that carry its bytes on."""
        return tuple(self._attached.drains)

    @property
    def remarks(self) -> tuple[str, ...]:
        """What its rows do not tell, in sentences, once it is finished."""
        return tuple(self._drawing.remarks)

    @property
    def identity(self) -> str:
        """Hash of the resolved scene."""
        return self._setting.identity

    def add(self, block: Run) -> None:
        """The next rows."""
        index = timelines.time_columns(self._setting, self.rows + np.arange(len(block)), block.time)
        for entity, table in contract.tables(block).items():
            if table:
                self.stream.send_columns(entity, index, contract.columns(entity, table))
        self._add_events(block)
        self._drawing.add(block)
        first = self.last is None
        self.rows += len(block)
        self._ended = block.ended
        self.last = replace(timelines.take(block, slice(-1, None)), first=self.rows - 1, events=())
        if first:
            self._write_scene(complete=False)  # so that a recording cut off by a crash still says what it was
        self._flush()

    def finish(self, last: Run, note: str, complete: bool) -> tuple[Path, ...]:
        """Write what waits for the end, and `note` as an event at the last row -> files under their names."""
        if note:
            self._events.append(event_at(last, note))
        self._write_events(self._events, np.full(len(self._events), self.rows - 1))
        for companion in self._overlay.companions if self._overlay else ():
            self._write_companion(companion)
        self._drawing.finish(last)
        self._write_filled()
        self._write_scene(complete)
        self._write_sums()
        memory = self._attached.memory
        if memory is not None and isinstance(self._sinks[0], Memory):
            self._flush()
            self._sinks[0].bytes = memory.drain_as_bytes()
        served = any(isinstance(sink, Web) for sink in self._sinks)
        if served:
            self._flush()  # disconnecting would stop the server; Recorded.serve does it
            for drain in self.drains:
                drain.release()
        else:
            self.stream.disconnect()
            for drain in self.drains:
                self._told(drain, drain.close)
        files = [sink for sink in self._sinks if isinstance(sink, Output)]
        for file in files:
            file.publish(partial(check_whole, file=file, served=served))
        return tuple(file.path for file in files)

    def _write_filled(self) -> None:
        """The points between rows that the picture shows."""
        points = self._drawing.points
        if points is not None:
            index = timelines.between_rows(self._setting, points.time)
            table = contract.filled_table(points)
            self.stream.send_columns(contract.FILLED, index, contract.columns(contract.FILLED, table))

    def abandon(self) -> None:
        """Let go of everything that is open, whatever becomes of it."""
        self.stream.disconnect()
        for drain in self.drains:
            with suppress(OSError):
                drain.close()

    def _flush(self) -> None:
        """Wait until everything is where it should be. RecordingError, at once, where it cannot be written."""
        try:
            self.stream.flush(timeout_sec=60)
        except RuntimeError as error:
            for file in self._attached.direct:
                why_not = lacking(file.part)
                if why_not:
                    raise OutputError(f"cannot write the recording {file.path}: {why_not}") from None
            raise RecordingError(f"the recording could not be written: {str(error).splitlines()[0]}") from None
        for drain in self.drains:
            self._told(drain, drain.settle)

    def _told(self, drain: Drain, wait: Callable[[], None]) -> None:
        try:
            wait()
        except OSError as error:
            words = f"cannot write the recording {drain.word}: {reason(error, drain.part)}"
            if error.errno in (errno.ENOSPC, errno.EDQUOT, errno.EFBIG):
                words += self._needed(drain)
            raise OutputError(words) from None

    def _needed(self, drain: Drain) -> str:
        """How much a run of this length takes, in words; "" where that cannot be told yet."""
        if not self.rows or not drain.offered:
            return ""
        whole = drain.offered * max(self._setting.rows / self.rows, 1.0)
        return f" (all {self._setting.rows:,} rows take about {whole / 1e6:,.3g} MB)"

    def _write_sums(self) -> None:
        """The last that is logged: the checksums of what was written so far."""
        self._flush()
        try:
            written = [drain.running for drain in self.drains]
            written += [checksums.of_file(file.part) for file in self._attached.direct]
        except OSError as error:
            raise OutputError(f"cannot write the recording: {reason(error)}") from None
        if len({running.sums.tobytes() for running in written}) == 1:  # none for a viewer, nor for files that differ
            facts = checksums.facts(written[0].sums, written[0].count)
            self.stream.log(checksums.ENTITY, facts, static=True)

    def _add_events(self, block: Run) -> None:
        """Write the events that have a row at or after them by now; keep the others."""
        due = sorted([*self._events, *block.events], key=lambda event: event.time)
        row = np.searchsorted(block.time, [event.time for event in due], side="left")
        count = int(np.sum(row < len(block)))
        self._write_events(due[:count], self.rows + row[:count])
        self._events = due[count:]

    def _write_events(self, events: list[Event], number: np.ndarray) -> None:
        if not events:
            return
        index = timelines.time_columns(self._setting, number, [event.time for event in events])
        self.stream.send_columns("/events", index, contract.event_columns(events))
        self._drawing.add_events(events, index)

    def _write_companion(self, companion: Companion) -> None:
        """The numbers of a flight beside the first: all of its rows, on the first one's clock."""
        run, shown, top = companion.run, companion.shown, contract.flight_path(companion.name)
        index = timelines.time_columns(shown.setting, np.arange(len(run)), shown.time)
        for entity, table in contract.tables(run).items():
            if table:
                self.stream.send_columns(top + entity, index, contract.columns(entity, table))
        if not run.events:
            return
        own = sorted(run.events, key=lambda event: event.time)
        times = np.array([event.time for event in own])
        rows = np.minimum(np.searchsorted(run.time, times, side="left"), len(run) - 1)
        index = timelines.time_columns(shown.setting, rows, times + companion.start)
        self.stream.send_columns(f"{top}/events", index, contract.event_columns(own))
        told = [
            replace(event, name=f"{companion.name}: {event.name}", time=event.time + companion.start) for event in own
        ]
        self._drawing.add_events(told, index, beside=True)

    def _write_scene(self, complete: bool) -> None:
        overlay, rows, ended = self._overlay, self.rows, self._ended
        names = overlay.names if overlay else ()
        whole = contract.scene(self._setting, rows=rows, complete=complete, ended=ended, flights=names)
        self.stream.log("/scene", whole, static=True)
        if overlay is None:
            return
        own = contract.scene(overlay.own, rows=rows, complete=complete, ended=ended, name=overlay.name)
        self.stream.log(f"{contract.flight_path(overlay.name)}/scene", own, static=True)
        for each in overlay.companions:
            run, start = each.run, each.start
            own = contract.scene(
                run.setting, rows=len(run), complete=True, ended=run.ended, name=each.name, start=start
            )
            self.stream.log(f"{contract.flight_path(each.name)}/scene", own, static=True)


def check_whole(part: Path, file: Output, served: bool) -> None:
    """Raise OutputError for a file that Rerun could not write to its end: it does not say so itself. served : the
    index follows when the browser is no longer served."""
    frames = framing(part, str(file.path))
    ended = frames.whole == frames.size if served else frames.indexed and not frames.cut
    if not ended or checksums.sums_of(part, frames) is None:
        why_not = lacking(part) or "it was not written to its end"
        raise OutputError(f"cannot write the recording {file.path}: {why_not}")


def event_at(row: Run, name: str) -> Event:
    """An event at the only row of a run."""
    return Event(name, float(row.time[0]), np.concatenate([row.position[0], row.velocity[0], row.mass]))


def why(error: BaseException | None, last: Run) -> str:
    """Why a recording ends at its last row, for the event that says so."""
    if isinstance(error, KeyboardInterrupt):
        return f"interrupted at t = {last.time[0]:.6g} s ({last.time[0] / 86400:.4g} d)"
    if isinstance(error, (PropagationError, TimeLimitError)):
        return str(error)
    return f"stopped by {type(error).__name__}: {error}"
