"""The picture of a run: gathered block by block, drawn once it is known how the flight ends.

Of all rows the few that are drawn are kept, and the curves' values; so memory is flat, and nothing that is drawn
depends on the blocks in which the run arrived.
"""

from __future__ import annotations

import numpy as np
import rerun as rr

from sailviz.recording import timelines
from sailviz.recording.drawing.arrival_plane import arrivals_of
from sailviz.recording.drawing.blueprint import blueprint
from sailviz.recording.drawing.curves import Curves, words_of
from sailviz.recording.drawing.description import WALL, about, event_line, gap_words
from sailviz.recording.drawing.devices import CRAFT
from sailviz.recording.drawing.ensemble_plots import plots_of_ensembles
from sailviz.recording.drawing.ensembles import log_ensembles
from sailviz.recording.drawing.layout import Layout
from sailviz.recording.drawing.log import Index, Picture
from sailviz.recording.drawing.low_orbit import log_low_orbit, orbit_words
from sailviz.recording.drawing.now_line import log_now
from sailviz.recording.drawing.row_words import plain_words, sparse_words, stowed_words
from sailviz.recording.drawing.sail_close_up import log_close_up
from sailviz.recording.drawing.samples import Frame, Samples
from sailviz.recording.drawing.story import Story, reach_of
from sailviz.recording.drawing.system_view import log_system, system_words
from sailviz.run.arrays import Event, Run, join

PLAY = {False: 30.0, True: 40.0}  # s that a replay takes, by whether it is a low orbit


class Drawing:
    """Writes everything that is for the eye."""

    def __init__(self, stream: rr.RecordingStream, first: Run):
        setting, picture = first.setting, Picture(stream)
        self._stream, self._setting, self._picture = stream, setting, picture
        self._frame = Frame.of(first)
        self._picker = timelines.Picker(self._frame.rows, self._frame.most, self._frame.duration)
        self._rows: list[Run] = []
        self._numbers: list[np.ndarray] = []
        self._events: list[Event] = []
        self.remarks: list[str] = []  # what the rows do not tell, once the run is drawn
        self._craft = CRAFT[setting.craft.kind]
        self._curves = Curves(picture, first, self._frame, self._craft)
        start = timelines.time_columns(setting, [first.first], first.time[:1])
        picture.log_columns("/log", start, rr.TextLog.columns(text=["start"], level=[rr.TextLogLevel.INFO]))

    def add(self, block: Run) -> None:
        """The next rows."""
        self._curves.add(block)
        picked = self._picker.pick(block)
        if len(picked):
            self._rows.append(timelines.take(block, picked))
            self._numbers.append(block.first + picked)

    def add_events(self, events: list[Event], index: Index) -> None:
        """Lines for what has happened."""
        self._events += events
        texts = [event_line(event) for event in events]
        levels = [
            rr.TextLogLevel.WARN if "interrupted" in text or " at t = " in text else rr.TextLogLevel.INFO
            for text in texts
        ]
        self._picture.log_columns("/log", index, rr.TextLog.columns(text=texts, level=levels))

    def finish(self, last: Run) -> None:
        """Draw the run; last : its last row, which is always drawn."""
        if not self._numbers or self._numbers[-1][-1] != last.first:
            self._rows.append(last)
            self._numbers.append(np.array([last.first]))
        run = join(self._rows)
        samples = Samples.of(run, np.concatenate(self._numbers), self._frame)
        reach = reach_of(self._setting, run) / self._frame.unit
        story = Story(samples, self._frame, self._craft, tuple(self._events), reach)
        layout, notes, aside = self._draw(story, last)
        steady = self._curves.steady()
        self.remarks = [plain_words(line) for line in (*gap_words(self._setting), *sparse_words(story))]
        sparse = [] if story.frame.low and story.frame.sparse else sparse_words(story)  # there the orbit's line says it
        notes = [*notes, *gap_words(self._setting), *sparse, *stowed_words(story)]
        text = about(self._setting, notes, steady, aside)
        self._picture.log_static("/about", rr.TextDocument(text, media_type=rr.MediaType.MARKDOWN))
        log_now(self._picture, story)
        self._stream.send_blueprint(blueprint(layout), make_active=True, make_default=True)

    def _draw(self, story: Story, last: Run) -> tuple[Layout, list[str], str]:
        """Write space and curves -> the layout, what is said about the drawing, and what of it is made up."""
        setting, picture = self._setting, self._picture
        plots = self._curves.finish(last, setting.plots, words_of(setting))
        bars = any(ensemble.method == "monte-carlo" for ensemble in setting.ensembles)
        if setting.ensembles:
            plots = [*plots_of_ensembles(setting), *plots]
        if story.frame.low:
            spaces, close, spans = log_low_orbit(picture, story)
            notes, aside = orbit_words(story), ""
        else:
            spaces, spans, aside = log_system(picture, story)
            close = log_close_up(picture, story, 3 if bars else min(len(plots), 2))
            notes = [WALL] if story.most > 0 else []
            notes += system_words(story)
        if setting.ensembles:
            spans |= log_ensembles(picture, setting, self._frame)
        duration = max(story.duration, 1e-9)
        layout = Layout(
            title=setting.title,
            spaces=spaces,
            close=close,
            plots=plots,
            lanes=self._curves.write_lanes(),
            arrivals=arrivals_of(setting) if setting.ensembles else (),
            bars=bars,
            spans=spans,
            timelines=("sim_time", "step") if setting.epoch is None else ("sim_time", "utc", "step"),
            speed=duration / (setting.play_duration or PLAY[story.frame.low]),
            rows_per_second=max(last.first, 1) / duration,
        )
        return layout, notes, aside
