"""The picture of a run, put together: world, close-up, curves, words, and the blueprint that shows them.

Whole groups of drawn rows are written as they come; what depends on how far the run reaches is written after the first
block and, where that has changed, once more at the end. So neither memory nor the digest depends on the blocks.
"""

from __future__ import annotations

import numpy as np
import rerun as rr

from sailviz.recording import timelines
from sailviz.recording.drawing.blueprint import blueprint
from sailviz.recording.drawing.curves import Curves
from sailviz.recording.drawing.description import about, event_line
from sailviz.recording.drawing.devices import CRAFT
from sailviz.recording.drawing.ensembles import log_ensembles
from sailviz.recording.drawing.layout import Extents, Layout, lay_out
from sailviz.recording.drawing.log import Index, Picture
from sailviz.recording.drawing.samples import Frame, Samples
from sailviz.recording.drawing.system_view import LADDER, STRIP, SystemView
from sailviz.run.arrays import Event, Run, join


class Drawing:
    """Writes everything that is for the eye."""

    def __init__(self, stream: rr.RecordingStream, first: Run):
        setting, picture = first.setting, Picture(stream)
        self._stream, self._setting, self._picture = stream, setting, picture
        self._waiting: Run | None = None  # drawn rows that do not fill a piece of trail yet
        self._numbers = np.empty(0, int)
        self._drawn = -1  # number of the last row drawn
        self._before = np.full(2, -np.inf)  # s, times of the last two rows drawn
        self._rung = 0  # number of the next orbit of the ladder
        self._layout: Layout | None = None
        self._extents = Extents(first)
        self._frame = Frame.of(first)
        self._picker = timelines.Picker(self._frame.rows, self._frame.most, self._frame.duration)
        self._craft = CRAFT[setting.craft.kind]
        self._system = SystemView(picture, first, self._frame, self._craft)
        self._close_up = self._craft.close_up(picture, first, self._craft)
        self._curves = Curves(picture, first, self._frame, self._craft)
        if setting.ensembles:
            log_ensembles(picture, setting, self._frame)
        text = about(setting, self._system.notes)
        picture.log_static("/about", rr.TextDocument(text, media_type=rr.MediaType.MARKDOWN))
        start = timelines.time_columns(setting, [first.first], first.time[:1])
        picture.log_columns("/log", start, rr.TextLog.columns(text=["start"], level=[rr.TextLogLevel.INFO]))

    def add(self, block: Run) -> None:
        """The next rows."""
        self._extents.add(block)
        self._curves.add(block)
        self._add_ladder(block)
        picked = self._picker.pick(block)
        self._wait(timelines.take(block, picked), block.first + picked)
        self._draw(len(self._numbers) // STRIP * STRIP)
        if self._layout is None:
            self._show()

    def finish(self, last: Run) -> None:
        """Draw what still waits and the last row of all, and size everything for good."""
        if last.first not in (self._drawn, *self._numbers[-1:]):
            self._wait(last, np.array([last.first]))
        self._draw(len(self._numbers))
        self._system.finish(Samples.of(last, np.array([last.first]), self._frame))
        self._extents.finished = True
        self._show()

    def add_events(self, events: list[Event], index: Index) -> None:
        """Lines for what has happened."""
        texts = [event_line(event) for event in events]
        levels = [
            rr.TextLogLevel.WARN if "interrupted" in text or " at t = " in text else rr.TextLogLevel.INFO
            for text in texts
        ]
        self._picture.log_columns("/log", index, rr.TextLog.columns(text=texts, level=levels))

    def _add_ladder(self, block: Run) -> None:
        """Rows at even times, or the first ones after."""
        rung = (block.time - self._frame.start) / self._setting.duration * LADDER + 1e-9
        steps = np.floor(rung).astype(int)
        wanted = np.flatnonzero(np.diff(steps, prepend=self._rung - 1) > 0)
        self._rung = int(steps[-1]) + 1
        self._system.add_ladder(Samples.of(timelines.take(block, wanted), block.first + wanted, self._frame))

    def _wait(self, run: Run, numbers: np.ndarray) -> None:
        if len(numbers):
            self._waiting = run if self._waiting is None else join([self._waiting, run])
            self._numbers = np.concatenate([self._numbers, numbers])

    def _draw(self, count: int) -> None:
        """Draw the first `count` of the rows that wait."""
        if count == 0 or self._waiting is None:
            return
        run, numbers = timelines.take(self._waiting, slice(0, count)), self._numbers[:count]
        samples = Samples.of(run, numbers, self._frame, self._before)
        self._before = np.concatenate([self._before, samples.run.time])[-2:]
        self._system.add(samples)
        self._close_up.add(samples)
        self._drawn = int(self._numbers[count - 1])
        self._numbers = self._numbers[count:]
        self._waiting = timelines.take(self._waiting, slice(count, None)) if len(self._numbers) else None

    def _show(self) -> None:
        """Size what depends on the run's reach, and lay out the views, unless both are as they were."""
        layout = lay_out(self._setting, self._frame, self._extents, self._curves, self._craft, self._close_up)
        if layout == self._layout:
            return
        self._layout = layout
        self._system.size(layout)
        self._close_up.size(layout)
        self._stream.send_blueprint(blueprint(layout), make_active=True, make_default=True)
