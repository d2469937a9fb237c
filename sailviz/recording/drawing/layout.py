"""What a blueprint is made of: the views with their cameras and contents, the curves in sight, how time runs."""

from __future__ import annotations

from dataclasses import dataclass, field

from sailviz.recording.drawing.arrival_plane import Arrival
from sailviz.recording.drawing.cameras import Camera
from sailviz.recording.drawing.plot_column import PlotView

Span = tuple[float | None, float | None]  # s after the cursor that a view shows of an entity; None is without limit
ALL: Span = (None, None)
SO_FAR: Span = (None, 0.0)
TO_COME: Span = (0.0, None)


@dataclass(frozen=True)
class Space:
    """A view of space. contents : rules "+ path" and "- path", as the viewer reads them."""

    camera: Camera
    contents: tuple[str, ...]

    @property
    def name(self) -> str:
        """What stands on its tab."""
        return self.camera.name


@dataclass
class Layout:
    """Everything from which a blueprint is made."""

    title: str
    spaces: list[Space]  # tabs of the main view
    close: Space  # what is never behind a tab
    axis: Space | None = None  # where the axis of a craft that turns points, in front of all curves but the first
    plots: list[PlotView] = field(default_factory=list)  # most telling first
    lanes: list[str] = field(default_factory=list)
    arrivals: tuple[Arrival, ...] = ()  # planes in which ensembles are seen
    heat: tuple[str, str] | None = None  # name and path of the plane of temperature over distance
    bars: bool = False  # whether histograms stand below the curves
    words: float = 0.0  # lines that the words below the main view take
    spans: dict[str, Span] = field(default_factory=dict)
    timelines: tuple[str, ...] = ("sim_time", "step")
    speed: float = 1.0  # seconds of the run in one second of replay
    rows_per_second: float = 1.0
    turn: tuple[float, float] | None = None  # s, one revolution to be looped by itself
