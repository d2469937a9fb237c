"""What goes on and off as coloured lanes: push, light, devices, and the phases of a flight."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import rerun as rr

from sailviz.recording import timelines
from sailviz.recording.contract import word
from sailviz.recording.drawing import style
from sailviz.recording.drawing.craft import CraftDrawing
from sailviz.recording.drawing.log import Color, Picture
from sailviz.recording.drawing.phases import reached, rows_at_switches, words_and_colors
from sailviz.recording.drawing.samples import Frame
from sailviz.run import gaps
from sailviz.run.arrays import Run, Setting

UNKNOWN = 0.25  # revolutions between rows over which light and shadow come and go unseen
MOST_CHANGES = 40  # of a lane that is still read
LANE_NAMES = {"thrust": "push", "sunlit": "light"}  # paths stand on the lanes: a word each
FILLED = "filled"  # rows that were not given: a fact about them, not about the flight
ON = "on/"  # above the lanes of several devices


@dataclass
class GapEdges:
    """A gap, s, with number and time of the first row after it."""

    start: float
    end: float
    begun: bool = False  # whether there is a row before it
    after: tuple[int, float] = (-1, np.inf)

    @property
    def between(self) -> bool:
        """Whether rows stand on both sides."""
        return self.begun and self.after[0] >= 0

    def add(self, run: Run) -> None:
        """A block of a run, all rows."""
        late = int(np.searchsorted(run.time, self.end, "left"))
        self.begun |= bool(len(run) and run.time[0] <= self.start)
        if late < len(run) and self.after[0] < 0:
            self.after = run.first + late, float(run.time[late])

    def cut(self, states: list[str], rows: list[tuple[int, float]]) -> tuple[list[str], list[tuple[int, float]]]:
        """The changes of a lane, one of them, changed or not, at the first row after the gap."""
        k = int(np.searchsorted([time for _, time in rows], self.start, "right"))
        if not self.between or k == 0 or (k < len(rows) and rows[k][0] == self.after[0]):
            return states, rows
        return [*states[:k], states[k - 1], *states[k:]], [*rows[:k], self.after, *rows[k:]]


class Lanes:
    """On and off: only the changes are kept, and written where they can be read."""

    def __init__(self, first: Run, frame: Frame, craft: CraftDrawing):
        self._names = [name for name, values in first.environment.items() if values.dtype == bool and name != FILLED]
        if craft.pushes:
            self._names.insert(0, "thrust")
        self._devices = {f"{ON}{word(name)}": name for name in first.devices} if len(first.devices) > 1 else {}
        self._names[:0] = self._devices
        self._craft = craft
        self._time = frame.start  # s, of the last row so far
        self._far = np.inf if frame.sun else UNKNOWN * frame.period
        self._edges = [GapEdges(start, end) for start, end in first.setting.gaps]
        self._states: dict[str, list[str]] = {name: [] for name in self._names}
        self._rows: dict[str, list[tuple[int, float]]] = {name: [] for name in self._names}  # number and time of each
        self._switches: list[tuple[int, float]] = []  # number and time of the rows with which phases begin

    def add(self, run: Run) -> None:
        """A block of a run, all rows."""
        far = np.diff(run.time, prepend=self._time) > self._far
        for lane in self._names:
            if lane in self._devices:
                on = run.devices[self._devices[lane]].on
            else:
                on = run.thrust.on if lane == "thrust" else run.environment[lane]
            states = np.where(np.asarray(on, bool), "on", "off")
            self._add(lane, run, np.where(far, "unknown", states) if lane == "sunlit" else states)
        for edges in self._edges:
            edges.add(run)
        begun = rows_at_switches(run.setting, run.time)
        self._switches += zip((run.first + begun).tolist(), run.time[begun].tolist(), strict=True)
        self._time = float(run.time[-1])

    def _add(self, lane: str, run: Run, states: np.ndarray) -> None:
        known = self._states[lane]
        changed = np.flatnonzero(np.concatenate([[known[-1] if known else ""], states[:-1]]) != states)
        if len(known) + len(changed) > 4 * MOST_CHANGES:
            changed = changed[: max(4 * MOST_CHANGES - len(known), 0)]  # it will not be shown
        known += states[changed].tolist()
        self._rows[lane] += zip((run.first + changed).tolist(), run.time[changed].tolist(), strict=True)

    def write(self, picture: Picture, setting: Setting) -> list[str]:
        """Write the lanes that change, but not so often that nothing is read -> their paths."""
        shown = self._write_phases(picture, setting)
        for lane, known in self._states.items():
            states, rows = known, self._rows[lane]
            changes = sum(state != "unknown" for state in states) - 1
            for edges in self._edges:
                states, rows = edges.cut(states, rows)
            if not changes > 0 or len(states) > MOST_CHANGES:
                continue
            on, off = lane_style(self._craft.lane if lane == "thrust" else lane)
            if lane in self._devices:
                name = self._devices[lane]
                on, off = (f"{name} on", on[1]), (f"{name} off", off[1])
            configuration = rr.StateConfiguration(
                values=["on", "off", "unknown", *(["no data"] if self._edges else [])],
                labels=[on[0], off[0], "between far rows", *(["no data"] if self._edges else [])],
                colors=[on[1], off[1], style.UNKNOWN, *([style.UNKNOWN] if self._edges else [])],
            )
            picture.log_static(lane_path(lane), configuration)
            number, time = zip(*rows, strict=True)
            index = timelines.time_columns(setting, list(number), list(time))
            picture.log_columns(lane_path(lane), index, rr.StateChange.columns(state=states))
            within = [(edges.start, edges.end) for edges in self._edges if edges.between]
            if within:
                index = timelines.between_rows(setting, gaps.moments(within))
                picture.log_columns(lane_path(lane), index, rr.StateChange.columns(state=["no data"] * len(within)))
            shown.append(lane_path(lane))
        return shown

    def _write_phases(self, picture: Picture, setting: Setting) -> list[str]:
        """The lane of a flight's phases, each in its colour."""
        if not 1 < len(self._switches) <= MOST_CHANGES:
            return []
        names = [phase.name for phase in reached(setting)]
        colors = [color for _, color in words_and_colors(setting)]
        kinds = dict(zip(names, colors, strict=True))
        labels = list(kinds)
        configuration = rr.StateConfiguration(values=labels, labels=labels, colors=list(kinds.values()))
        picture.log_static(lane_path("phase"), configuration)
        number, time = zip(*self._switches, strict=True)
        index = timelines.time_columns(setting, list(number), list(time))
        picture.log_columns(lane_path("phase"), index, rr.StateChange.columns(state=names[: len(self._switches)]))
        return [lane_path("phase")]


def lane_path(lane: str) -> str:
    """A word: the viewer writes the path on the lane."""
    return f"/{LANE_NAMES.get(lane, lane)}"


def lane_style(lane: str) -> tuple[tuple[str, Color], tuple[str, Color]]:
    """Word and colour of a lane's two states."""
    words = lane.replace("_", " ")
    other = {"on": (words, style.QUANTITY["switch"]), "off": (f"no {words}", style.REFERENCE)}
    states = style.LANES.get("light" if "sunlit" in lane else lane, other)
    return states["on"], states["off"]
