"""The curves of a run under /plots; on and off as coloured lanes under /phase.

About PLOT_ROWS rows are drawn at most, spread over rows and time; the numbers of every row are in the truth.
"""

from __future__ import annotations

import numpy as np
import rerun as rr

from sailviz.recording import timelines
from sailviz.recording.drawing import style
from sailviz.recording.drawing.craft import CraftDrawing
from sailviz.recording.drawing.log import Color, Picture
from sailviz.recording.drawing.plots import plots_of
from sailviz.recording.drawing.samples import Frame
from sailviz.run.arrays import Run

PLOT_ROWS = 20_000
FAR_ROWS = 1200  # where rows are far apart on their orbit: there are many curves of years, and no swing to be seen
UNKNOWN = 0.25  # revolutions between rows over which light and shadow come and go unseen


class Curves:
    """Writes the plots of a run and remembers how far they reach."""

    def __init__(self, picture: Picture, first: Run, frame: Frame, craft: CraftDrawing):
        self._picture = picture
        most = FAR_ROWS if frame.sparse else PLOT_ROWS
        self._picker = timelines.Picker(first.setting.rows, most, first.setting.duration)
        self.plots = plots_of(first, frame, craft)
        self.ranges: dict[str, tuple[float, float]] = {}
        self._lanes = ["thrust", *(name for name, values in first.environment.items() if values.dtype == bool)]
        self._state: dict[str, str] = {}
        self._time = frame.start  # s, of the last row so far
        self._far = np.inf if frame.sun else UNKNOWN * frame.period
        self.changes = dict.fromkeys(self._lanes, 0)
        dense = frame.turns > 60
        width = style.WIDTH["dense plot" if dense else "plot"]
        for plot in self.plots:
            # the later curve lies on top: thinner, so that an equal one below it still shows
            widths = [width * (1.6 if k < len(plot.names) - 1 else 1.0) for k in range(len(plot.names))]
            lines = rr.SeriesLines(
                names=list(plot.names),
                colors=[list(color) for color in plot.colors],
                widths=widths,
                aggregation_policy=rr.components.AggregationPolicy.MinMax,  # the mean would hide an oscillation
            )
            picture.log_static(plot.path, lines)
        for lane in self._lanes:
            on, off = lane_style(craft.lane if lane == "thrust" else lane)
            picture.log_static(
                f"/phase/{lane}",
                rr.StateConfiguration(
                    values=["on", "off", "unknown"],
                    labels=[on[0], off[0], "between far rows"],
                    colors=[on[1], off[1], style.UNKNOWN],
                ),
            )

    def add(self, run: Run) -> None:
        """A block of a run, all rows."""
        drawn = self._picker.pick(run)
        picked = timelines.take(run, drawn)
        index = timelines.time_columns(run.setting, run.first + drawn, picked.time)
        for plot in self.plots:
            self._stretch(plot.path, plot.values(run))
            if len(picked):
                values = plot.values(picked)
                self._picture.log_columns(
                    plot.path, index, rr.Scalars.columns(scalars=np.where(np.isfinite(values), values, np.nan))
                )
        far = np.diff(run.time, prepend=self._time) > self._far
        for lane in self._lanes:
            on = run.thrust.on if lane == "thrust" else run.environment[lane]
            states = np.where(np.asarray(on, bool), "on", "off")
            self._add_lane(lane, run, np.where(far, "unknown", states) if lane == "sunlit" else states)
        self._time = float(run.time[-1])

    def _stretch(self, path: str, values: np.ndarray) -> None:
        for k in range(values.shape[1]):
            finite = values[np.isfinite(values[:, k]), k]
            if len(finite):
                low, high = self.ranges.get(f"{path}:{k}", (np.inf, -np.inf))
                self.ranges[f"{path}:{k}"] = (min(low, float(finite.min())), max(high, float(finite.max())))

    def _add_lane(self, lane: str, run: Run, states: np.ndarray) -> None:
        """Only the changes are written."""
        before = self._state.get(lane)
        changed = np.flatnonzero(np.concatenate([[before or ""], states[:-1]]) != states)
        self._state[lane] = str(states[-1])
        if len(changed):
            self.changes[lane] += int(np.sum(states[changed] != "unknown")) - (before is None)
            index = timelines.time_columns(run.setting, run.first + changed, run.time[changed])
            self._picture.log_columns(f"/phase/{lane}", index, rr.StateChange.columns(state=states[changed].tolist()))

    def reach(self, path: str) -> tuple[float, float]:
        """Smallest and largest value that a plot has shown."""
        pairs = [pair for key, pair in self.ranges.items() if key.rsplit(":", 1)[0] == path]
        return (min(low for low, _ in pairs), max(high for _, high in pairs)) if pairs else (0.0, 1.0)


def lane_style(lane: str) -> tuple[tuple[str, Color], tuple[str, Color]]:
    """Word and colour of a lane's two states."""
    words = lane.replace("_", " ")
    other = {"on": (words, style.SERIES[0]), "off": (f"no {words}", style.REFERENCE)}
    states = style.LANES.get("light" if "sunlit" in lane else lane, other)
    return states["on"], states["off"]
