"""The column of curves: which are shown, which share a place, and in which ranges."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from sailviz.recording.drawing.curves import Curves
from sailviz.recording.drawing.plots import Plot, nice_range
from sailviz.recording.drawing.samples import Frame

EVERY_RUN = ("distance", "altitude", "inclination", "eccentricity", "angles", "clock", "thrust")
ALWAYS = tuple(f"/plots/{name}" for name in EVERY_RUN)
BRAKE = (  # what a tether's run shows below its altitude; what is in one place shares it as tabs
    ("plasma_density", "mean_ion_mass", "air_density", "solar_flux", "altitude_over"),
    ("plasma_force", "thrust", "air_drag"),
    ("tether_current", "tether_power", "tether_voltage", "tether_tilt"),
)
COLUMN, FURNITURE, NUMBER = 640.0, 48.0, 19.0  # pixels: the plots on a laptop, title and axis of one, a number


@dataclass(frozen=True)
class PlotView:
    """A view of curves, with the range of its axis."""

    title: str
    paths: tuple[str, ...]
    low: float
    high: float
    legend: str = ""  # corner, "" for none
    share: float = 2.4


@dataclass(frozen=True)
class Slot:
    """A place in the column of plots; several plots share it as tabs."""

    plots: tuple[PlotView, ...]
    share: float


def plot_views(
    curves: Curves, frame: Frame, steers: bool
) -> tuple[tuple[PlotView, ...], tuple[tuple[PlotView, ...], ...]]:
    """Which curves are shown: first those that every run has, then in groups what the environment did.

    steers : whether the craft has angles that mean something
    """
    known = {plot.path: plot for plot in curves.plots}

    def view(path: str, **more: Any) -> PlotView:
        plot = known[path]
        low, high = curves.reach(path)
        if high - low < plot.noise:
            low = high = round(0.5 * (low + high) / plot.noise) * plot.noise
        legend = "RightTop" if len(plot.names) > 1 else ""
        if plot.from_zero:
            low = min(low, 0.0)
        values: dict[str, Any] = {"title": plot.title, "paths": (path,), "low": low, "high": high, "legend": legend}
        return PlotView(**values | more)

    shown = [distance_view(curves, view) if "/plots/distance" in known else altitude_view(known, view)]
    tilt = curves.reach("/plots/inclination")
    tilted = tilt[1] > 0.05 and (frame.sun or tilt[1] - tilt[0] > 0.05)
    shown.append(view("/plots/inclination" if tilted else "/plots/eccentricity"))
    shown += angle_views(curves, view) if steers else []
    tether = "/plots/plasma_force_N_m" in known
    shown += [] if tether else [view("/plots/thrust")]
    return tuple(shown), tuple(tuple(view(path) for path in group) for group in environment_groups(known, tether))


def environment_groups(known: Iterable[str], tether: bool) -> list[list[str]]:
    """The curves that not every run has, those that share a place together."""
    others = [path for path in known if path not in ALWAYS or (tether and path == "/plots/thrust")]
    groups = []
    for stems in BRAKE if tether else ():
        group = [path for stem in stems for path in others if path.startswith(f"/plots/{stem}")]
        others = [path for path in others if path not in group]
        groups.append(group)
    return [group for group in (*groups, others) if group]


def distance_view(curves: Curves, view: Callable[..., PlotView]) -> PlotView:
    """Distance and semi-major axis. That of an orbit close to escape is beyond all measure: it may leave the range."""
    r_low, r_high = curves.ranges["/plots/distance:0"]
    a_low, a_high = curves.ranges.get("/plots/distance:1", (r_low, r_high))
    low, high = max(min(r_low, a_low), 0.5 * r_low), min(max(r_high, a_high), 1.5 * r_high)
    return view("/plots/distance", low=low, high=high, share=3.0)


def altitude_view(known: Mapping[str, Plot], view: Callable[..., PlotView]) -> PlotView:
    """Altitudes; those of a descent have more room, and their legend where no curve comes."""
    if len(known["/plots/altitude"].names) > 2:
        return view("/plots/altitude", share=4.2, legend="LeftBottom")
    return view("/plots/altitude", share=3.0, legend="RightTop")


def angle_views(curves: Curves, view: Callable[..., PlotView]) -> list[PlotView]:
    """Pitch, cone and clock in one plot where their sizes allow it; a constant clock angle goes into the title."""
    pitch, clock = curves.reach("/plots/angles"), curves.reach("/plots/clock")
    if clock[1] - clock[0] < 0.5:
        title = f"Pitch and cone angle [deg], clock {abs(round(0.5 * (clock[0] + clock[1]), 1)):.4g}"
        return [view("/plots/angles", title=title, share=3.0)]
    low, high = min(pitch[0], clock[0]), max(pitch[1], clock[1])
    if high - low < 3 * max(pitch[1] - pitch[0], 30):
        paths = ("/plots/angles", "/plots/clock")
        title = "Pitch, cone and clock angle [deg]"
        return [view("/plots/angles", title=title, paths=paths, low=low, high=high, share=3.0)]
    return [view("/plots/angles"), view("/plots/clock", share=2.0)]


def column(
    shown: Sequence[PlotView], environment: Sequence[tuple[PlotView, ...]], lanes: Sequence[str]
) -> tuple[tuple[Slot, ...], float]:
    """The right column: which plots stand alone and which share a place as tabs, and the share of the lanes.

    More than five rows are not readable on a laptop: then the plot of the orbit's shape goes behind the first.
    """
    slots = [Slot((plot,), plot.share) for plot in shown]
    slots += [Slot(group, 2.6) for group in environment]
    lane_share = 1.3 + 0.7 * len(lanes) if lanes else 0.0
    if len(slots) + bool(lanes) > 5:
        slots[:2] = [Slot(slots[0].plots + slots[1].plots, slots[0].share)]
    total = sum(slot.share for slot in slots) + lane_share
    fitted = []
    for slot in slots:
        numbers = (COLUMN * slot.share / total - FURNITURE) / NUMBER
        plots = []
        for plot in slot.plots:
            low, high = nice_range(plot.low, plot.high, numbers)
            plots.append(replace(plot, low=low, high=high))
        fitted.append(Slot(tuple(plots), slot.share))
    return tuple(fitted), lane_share
