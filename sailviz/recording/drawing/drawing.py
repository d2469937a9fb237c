"""The picture of a run: gathered block by block, drawn once it is known how the flight ends.

Of all rows the few that are drawn are kept, and the curves' values; so memory is flat, and nothing that is drawn
depends on the blocks in which the run arrived.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import rerun as rr

from sailviz.recording import timelines
from sailviz.recording.companions import Overlay
from sailviz.recording.drawing import style
from sailviz.recording.drawing.arrival_plane import arrivals_of
from sailviz.recording.drawing.attitude_ensembles import log_attitude_ensembles, log_axes
from sailviz.recording.drawing.axis_trace import TRACE, has_axis, in_front, log_axis
from sailviz.recording.drawing.blueprint import blueprint
from sailviz.recording.drawing.curves import Curves, words_of
from sailviz.recording.drawing.description import WALL, about, event_line, gap_words, lines_of
from sailviz.recording.drawing.devices import drawing_of
from sailviz.recording.drawing.ensemble_plots import plots_of_ensembles
from sailviz.recording.drawing.ensembles import log_ensembles
from sailviz.recording.drawing.filled import filled_story
from sailviz.recording.drawing.flight_curves import FlightCurves, curves_beside, log_flight_curves
from sailviz.recording.drawing.flight_words import about_together, log_now_together, span_of
from sailviz.recording.drawing.flights import Flight, story_beside
from sailviz.recording.drawing.heat_plane import NAME as HEAT
from sailviz.recording.drawing.heat_plane import PATH as HEAT_PATH
from sailviz.recording.drawing.heat_plane import heat_of, log_heat
from sailviz.recording.drawing.landmarks import VIOLATION
from sailviz.recording.drawing.layout import Layout, Space, Span
from sailviz.recording.drawing.lit_shape import lit_words
from sailviz.recording.drawing.log import Index, Picture
from sailviz.recording.drawing.low_orbit import log_low_orbit, orbit_words
from sailviz.recording.drawing.now_line import log_now
from sailviz.recording.drawing.one_turn import OneTurn
from sailviz.recording.drawing.orbit_plane import shell_words
from sailviz.recording.drawing.phases import never_words, phase_notes, rows_at_switches
from sailviz.recording.drawing.plot_column import PlotView
from sailviz.recording.drawing.row_words import plain_words, sparse_words, stowed_words
from sailviz.recording.drawing.sail_close_up import log_close_up
from sailviz.recording.drawing.samples import Frame, Samples, as_flown
from sailviz.recording.drawing.story import Arrows, Story, reach_of
from sailviz.recording.drawing.system_view import log_system, system_words
from sailviz.run.arrays import Event, Run
from sailviz.run.filling import Points

PLAY = {False: 30.0, True: 40.0}  # s that a replay takes, by whether it is a low orbit


class Drawing:
    """Writes everything that is for the eye."""

    def __init__(self, stream: rr.RecordingStream, first: Run, overlay: Overlay | None = None):
        """overlay : the flights that are drawn beside this one."""
        self._overlay = overlay
        first = self._shown(first)
        setting, picture = first.setting, Picture(stream)
        self._stream, self._setting, self._picture = stream, setting, picture
        self._frame = Frame.of(first)
        self._picker = timelines.Picker(self._frame.rows, self._frame.most, self._frame.duration)
        self._turn = OneTurn(self._frame if overlay is None else replace(self._frame, turns=1.0))
        self._rows: list[Run] = []
        self._numbers: list[np.ndarray] = []
        self._events: list[Event] = []
        self.points: Points | None = None  # between rows far apart, once the run is drawn
        self.remarks: list[str] = []  # what the rows do not tell, once the run is drawn
        self._craft = drawing_of(setting.craft)
        if overlay is not None:  # the close-up is called by the flight's name
            self._craft = replace(self._craft, close_name="")
        self._curves = Curves(picture, first, self._frame, self._craft)
        start = timelines.time_columns(setting, [first.first], first.time[:1])
        picture.log_columns("/log", start, rr.TextLog.columns(text=["start"], level=[rr.TextLogLevel.INFO]))

    def _shown(self, run: Run) -> Run:
        """What of a block is drawn: among other flights no other answers to its own question."""
        return run if self._overlay is None else replace(run, approximations={})

    def add(self, block: Run) -> None:
        """The next rows."""
        block = self._shown(block)
        self._curves.add(block)
        self._turn.add(block)
        picked = np.union1d(self._picker.pick(block), rows_at_switches(self._setting, block.time)).astype(int)
        if len(picked):
            self._rows.append(timelines.take(block, picked))
            self._numbers.append(block.first + picked)

    def add_events(self, events: list[Event], index: Index, beside: bool = False) -> None:
        """Lines for what has happened, to this flight or to one beside it."""
        self._events += [] if beside else events
        texts = [event_line(event) for event in events]
        levels = [
            rr.TextLogLevel.ERROR
            if event.name.startswith(VIOLATION)
            else rr.TextLogLevel.WARN
            if "interrupted" in text or " at t = " in text
            else rr.TextLogLevel.INFO
            for event, text in zip(events, texts, strict=True)
        ]
        self._picture.log_columns("/log", index, rr.TextLog.columns(text=texts, level=levels))

    def finish(self, last: Run) -> None:
        """Draw the run; last : its last row, which is always drawn."""
        last = self._shown(last)
        if not self._numbers or self._numbers[-1][-1] != last.first:
            self._rows.append(last)
            self._numbers.append(np.array([last.first]))
        run, numbers = self._turn.among(self._rows, self._numbers)
        self._frame = as_flown(self._frame, run)
        samples = Samples.of(run, numbers, self._frame, home=self._turn.span)
        reach = reach_of(self._setting, run) / self._frame.unit
        story = Story(samples, self._frame, self._craft, tuple(self._events), reach)
        if self._overlay is not None:
            self._finish_together(self._overlay, story, last)
            return
        story, self.points = filled_story(story)
        layout, notes, aside = self._draw(story, last)
        steady = self._curves.steady()
        told = (*never_words(self._setting), *gap_words(self._setting), *sparse_words(story.told))
        self.remarks = [plain_words(line) for line in told]
        sparse = (
            [] if story.frame.low and story.frame.sparse else sparse_words(story.told)
        )  # there the orbit's line says it
        notes = [
            *phase_notes(self._setting, story.frame.low),
            *notes,
            *self._turn.words,
            *gap_words(self._setting),
            *sparse,
            *stowed_words(story.told),
            *lit_words(story.told),
        ]
        text = about(self._setting, notes, steady, aside)
        self._picture.log_static("/about", rr.TextDocument(text, media_type=rr.MediaType.MARKDOWN))
        layout.words = lines_of(text)
        log_now(self._picture, story.told)
        self._stream.send_blueprint(blueprint(layout), make_active=True, make_default=True)

    def _finish_together(self, overlay: Overlay, story: Story, last: Run) -> None:
        """Draw this flight and those beside it."""
        picture, setting = self._picture, self._setting
        flights = flights_together(overlay, story)
        story = flights[0].story
        rows = self._curves.close(last)
        gathered = [FlightCurves(flights[0], self._curves, rows)]
        gathered += [curves_beside(picture, flight) for flight in flights[1:]]
        plots = log_flight_curves(picture, gathered, setting.plots, words_of(setting), overlay.by_date)
        spaces, close, spans, aside = self._spaces(story, min(len(plots), 2), flights)
        notes = shell_words(story.samples.run) if story.frame.low else system_words(story)
        notes += gap_words(setting)
        self.remarks = [plain_words(line) for line in gap_words(setting)]
        text = about_together(overlay, flights, notes, aside)
        picture.log_static("/about", rr.TextDocument(text, media_type=rr.MediaType.MARKDOWN))
        log_now_together(picture, flights)
        begin, end = span_of(flights)
        layout = self._layout(spaces, close, plots, spans, story, last, end - begin)
        layout.words = lines_of(text)
        self._stream.send_blueprint(blueprint(layout), make_active=True, make_default=True)

    def _spaces(
        self, story: Story, below: int, flights: Sequence[Flight] = ()
    ) -> tuple[list[Space], Space, dict[str, Span], str]:
        """Write space -> tabs of the main view, what is never behind a tab, the spans that they show, and what of the
        drawing is made up."""
        if story.frame.low:
            spaces, close, spans = log_low_orbit(self._picture, story, flights)
            return spaces, close, spans, ""
        spaces, spans, aside = log_system(self._picture, story, flights)
        return spaces, log_close_up(self._picture, story, below), spans, aside

    def _draw(self, story: Story, last: Run) -> tuple[Layout, list[str], str]:
        """Write space and curves -> the layout, what is said about the drawing, and what of it is made up."""
        setting, picture = self._setting, self._picture
        plots = self._curves.finish(last, setting.plots, words_of(setting))
        bars = any(ensemble.method == "monte-carlo" for ensemble in setting.ensembles)
        if setting.ensembles:
            plots = [*plots_of_ensembles(setting), *plots]
        if setting.attitude_ensembles:
            plots = [*log_attitude_ensembles(picture, setting), *plots]
        spaces, close, spans, aside = self._spaces(story, 3 if bars else min(len(plots), 2))
        if story.frame.low:
            notes = orbit_words(story)
        else:
            notes = [TRACE if has_axis(story) and in_front(story) else WALL] if story.most > 0 else []
            notes += system_words(story)
        if setting.ensembles:
            spans |= log_ensembles(picture, setting, self._frame)
        layout = self._layout(spaces, close, plots, spans, story, last, story.duration)
        if has_axis(story):
            axis, more = log_axis(picture, story)
            log_axes(picture, setting)
            layout.spans |= more
            if in_front(story):
                layout.spaces.insert(0, axis)
            else:
                layout.axis = axis
        heat = heat_of(story)
        if heat is not None:
            log_heat(picture, story, heat)
            layout.heat = (HEAT, HEAT_PATH)
        return layout, notes, aside

    def _layout(
        self,
        spaces: list[Space],
        close: Space,
        plots: list[PlotView],
        spans: dict[str, Span],
        story: Story,
        last: Run,
        seconds: float,
    ) -> Layout:
        """The views; seconds : that the picture lasts."""
        setting = self._setting
        bars = any(ensemble.method == "monte-carlo" for ensemble in setting.ensembles)
        duration = max(seconds, 1e-9)
        return Layout(
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
            rows_per_second=max(last.first, 1) / max(story.duration, 1e-9),
            turn=self._turn.span,
        )


def flights_together(overlay: Overlay, story: Story) -> list[Flight]:
    """The flights of a picture, with one reach and one measure of arrows for all."""
    beside = [story_beside(companion, story.frame) for companion in overlay.companions]
    stories = [story, *beside]
    reach = max(reach_of(each.setting, each.samples.run) for each in stories) / story.frame.unit
    arrows = Arrows(story.arrows.least, max(each.most for each in stories))
    runs = [story.samples.run, *(companion.shown for companion in overlay.companions)]
    return [
        Flight(name, color, run, replace(each, reach=reach, beside=arrows))
        for name, color, run, each in zip(overlay.names, style.FLIGHTS, runs, stories, strict=False)
    ]
