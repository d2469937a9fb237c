"""Curves of several flights: the quantities that vary most, each with a curve per flight, how far the flights are apart
from the first one, and by how much they differ from it in what varies most.

Apart means at one time of the first flight's clock. A companion is read off between its rows by Hermite's cubic, and
not at all where these lie too far apart on the orbit for that.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from sailviz.constants import AU
from sailviz.recording import timelines
from sailviz.recording.contract import word
from sailviz.recording.drawing.curves import Curves, Rows, hidden, log_curves, wanted_place, worth_of
from sailviz.recording.drawing.flights import Flight
from sailviz.recording.drawing.log import Picture
from sailviz.recording.drawing.phrases import push_unit
from sailviz.recording.drawing.plot_column import SHOWN_FROM, PlotView, corner, nice_range
from sailviz.recording.drawing.plots import Plot
from sailviz.recording.drawing.samples import SPARSE
from sailviz.run.arrays import Run
from sailviz.run.filling import revolutions
from sailviz.run.moments import run_at

QUANTITIES = 2  # that vary most
NEAR = 0.01  # au, a largest distance apart that is told in km
ALTITUDE = "altitude"  # it changes slowly: it is known between rows that lie revolutions apart
MOMENT = {True: "at the same date", False: "at the same time since the start"}


@dataclass(frozen=True)
class FlightCurves:
    """A flight with the curves that were gathered of it."""

    flight: Flight
    curves: Curves
    rows: Rows

    def own(self, plot: Plot) -> Plot:
        """This flight's plot of a quantity: how its numbers are made may be its own."""
        return next(own for own in self.curves.plots if own.key == plot.key)


def curves_beside(picture: Picture, flight: Flight) -> FlightCurves:
    """Gather the curves of a companion."""
    run, story = flight.run, flight.story
    curves = Curves(picture, run, story.frame, story.craft)
    curves.add(run)
    last = replace(timelines.take(run, slice(-1, None)), first=len(run) - 1)
    return FlightCurves(flight, curves, curves.close(last))


def log_flight_curves(
    picture: Picture, gathered: Sequence[FlightCurves], asked: tuple[str, ...], about: tuple[str, ...], by_date: bool
) -> list[PlotView]:
    """Write /plots -> views: what varies most, the distance apart, what varies second most, the difference in the
    first. asked, about : as in `Curves.finish`."""
    chosen = chosen_plots(gathered, asked, about)
    views = [log_quantity(picture, gathered, plot) for plot in chosen]
    flights = [each.flight for each in gathered]
    apart = [log_apart(picture, flights, by_date)] if not flights[0].story.frame.low else []
    others = [log_difference(picture, gathered, plot) for plot in chosen[:1]]
    order = [*views[:1], *(view for view in apart if view), *others, *views[1:]]
    return [view for view in order if view is not None]


def chosen_plots(gathered: Sequence[FlightCurves], asked: Sequence[str], about: Sequence[str]) -> list[Plot]:
    """Of the quantities that all flights have those that vary most in any of them."""
    common = set.intersection(*({plot.key for plot in each.curves.plots} for each in gathered))
    found: list[tuple[float, Plot]] = []
    for plot in gathered[0].curves.plots:
        if plot.key not in common or not any(np.isfinite(e.curves.values_of(plot)[:, 0]).any() for e in gathered):
            continue
        place = wanted_place(plot, asked)
        worth = max(worth_of(plot, each.curves.values_of(plot)[:, :1]) for each in gathered)
        if place is not None or (worth >= SHOWN_FROM and not hidden(plot, about)):
            found.append((worth if place is None else 1e3 - place, plot))
    return [plot for _, plot in sorted(found, key=lambda pair: -pair[0])[:QUANTITIES]]


def unit_of(plot: Plot, most: float) -> tuple[float, str]:
    """The size of a plot's unit in that of its values, and its title with the unit."""
    if not plot.handy:
        return 1.0, plot.title
    size, name = push_unit(most or 1e-3)
    return size, f"{plot.title} [{name}]"


def log_quantity(picture: Picture, gathered: Sequence[FlightCurves], plot: Plot) -> PlotView:
    """Write the first curve of a plot for every flight, in its colour."""
    most = max(float(np.nanmax(each.curves.values_of(plot)[:, 0], initial=0.0)) for each in gathered)
    size, title = unit_of(plot, most)
    shown = []
    for each in gathered:
        rows, values = each.curves.line_of(each.own(plot), each.rows, size)
        path, flight = f"{plot.path}/{word(each.flight.name)}", each.flight
        log_curves(picture, path, rows, values[:, None], [flight.name], [flight.color])
        shown.append(values)
    return view_of(title, plot.path, shown, from_zero=plot.from_zero)


def view_of(title: str, path: str, curves: Sequence[np.ndarray], from_zero: bool = False) -> PlotView:
    """The view of curves (n,) of several flights."""
    known = np.concatenate([values[np.isfinite(values)] for values in curves])
    low, high = float(known.min()), float(known.max())
    low, high = nice_range(min(low, 0.0) if from_zero else low, high)
    return PlotView(title, (f"{path}/**",), low, high, corner(curves, low, high))


def apart(first: Flight, other: Flight) -> np.ndarray:
    """(n,) m from the first flight to another in the drawn rows of the first; NaN where that is not known."""
    run = first.story.samples.run
    there = run_at(other.run, run.time)
    distance = np.linalg.norm(there.position - run.position, axis=1)
    return np.where(between_far_rows(other.run, run.time, first.story.frame.mu), np.nan, distance)


def between_far_rows(run: Run, times: np.ndarray, mu: float) -> np.ndarray:
    """(m,) whether times lie between rows too far apart on the orbit to be read off."""
    if len(run) < 2:
        return ~np.isin(times, run.time)
    row = np.clip(np.searchsorted(run.time, times, side="right") - 1, 0, len(run) - 2)
    far = revolutions(run, mu)[row] > SPARSE
    return np.asarray(far & (times != run.time[row]) & (times != run.time[row + 1]))


def apart_unit(first: Flight, most: float) -> tuple[float, str]:
    """m, and the name of it."""
    frame = first.story.frame
    if frame.unit_name.startswith("10^"):
        return frame.unit, frame.unit_name
    return (AU, "au") if frame.sun and most > NEAR * AU else (1e3, "km")


def log_apart(picture: Picture, flights: Sequence[Flight], by_date: bool) -> PlotView | None:
    """Write /plots/apart: how far each companion is from the first flight; None where that is never known."""
    first, *others = flights
    found = [(flight, apart(first, flight)) for flight in others]
    found = [(flight, far) for flight, far in found if np.isfinite(far).any()]
    if not found:
        return None
    size, name = apart_unit(first, max(float(np.nanmax(far)) for _, far in found))
    title = f"Distance from {first.name} {MOMENT[by_date]} [{name}]"
    return log_beside(picture, first, "/plots/apart", title, [(flight, far / size) for flight, far in found], True)


def log_difference(picture: Picture, gathered: Sequence[FlightCurves], plot: Plot) -> PlotView | None:
    """Write /plots/difference: each companion's value of a quantity less the first flight's; None where it is never
    known."""
    first = gathered[0].flight
    run = first.story.samples.run
    own = gathered[0].own(plot).values(run)[:, 0]
    found = []
    for each in gathered[1:]:
        flight = each.flight
        theirs = each.own(plot).values(run_at(flight.run, run.time))[:, 0]
        far = between_far_rows(flight.run, run.time, first.story.frame.mu) & (plot.key != ALTITUDE)
        found.append((flight, np.where(far, np.nan, theirs - own)))
    found = [(flight, off) for flight, off in found if np.isfinite(off).any()]
    if not found:
        return None
    most = max(float(np.nanmax(np.abs(off))) for _, off in found)
    size, title = unit_of(plot, most)
    words, bracket, unit = title.partition(" [")
    return log_beside(
        picture,
        first,
        "/plots/difference",
        f"{words}: difference from {first.name}{bracket}{unit}",
        [(flight, off / size) for flight, off in found],
        False,
    )


def log_beside(
    picture: Picture,
    first: Flight,
    path: str,
    title: str,
    found: Sequence[tuple[Flight, np.ndarray]],
    from_zero: bool,
) -> PlotView:
    """Write curves that stand in the drawn rows of the first flight, one a companion."""
    samples = first.story.samples
    rows = Rows.of(samples.run.setting, samples.number, samples.run.time)
    for flight, values in found:
        log_curves(picture, f"{path}/{word(flight.name)}", rows, values[:, None], [flight.name], [flight.color])
    return view_of(title, path, [values for _, values in found], from_zero)
