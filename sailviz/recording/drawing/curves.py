"""The curves of a run under /plots.

About PLOT_ROWS rows are kept at most, spread over rows and time, and of flights of many turns the least, the mean and
the largest value of every revolution or so: what would be a solid block is a band with its mean. The numbers of every
row are in the truth.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import rerun as rr

from sailviz.recording import timelines
from sailviz.recording.drawing import style
from sailviz.recording.drawing.craft import CraftDrawing
from sailviz.recording.drawing.film_plots import film_plots
from sailviz.recording.drawing.lanes import Lanes
from sailviz.recording.drawing.log import Color, Index, Picture
from sailviz.recording.drawing.phrases import amount, push_unit
from sailviz.recording.drawing.plot_column import FLAT, SHOWN_FROM, PlotView, corner, merged, nice_range, score
from sailviz.recording.drawing.plots import RARE, Plot, plots_of
from sailviz.recording.drawing.samples import Frame
from sailviz.run import gaps
from sailviz.run.arrays import Run, Setting

PLOT_ROWS = 1600  # a plot is some 560 pixels wide
FAR_ROWS = 1010  # where rows are far apart on their orbit: there are many curves of years
MOST_BINS, ROWS_IN_BIN = 400, 8
BAND_TURNS = 40.0  # revolutions from which a swing within one is a solid block
SWING = 0.04  # of the whole range, within a bin, from which a curve is a band
BAND_SHADE = 0.6
ROUNDING = 1e-9  # of the largest component of a vector, below which another is not shown though it is asked for


@dataclass
class Swing:
    """Least, sum, largest and number of the values in even stretches of the time, (bins, k)."""

    low: np.ndarray
    high: np.ndarray
    total: np.ndarray
    count: np.ndarray

    @staticmethod
    def of(bins: int, width: int) -> Swing:
        shape = (bins, width)
        return Swing(np.full(shape, np.inf), np.full(shape, -np.inf), np.zeros(shape), np.zeros(shape))

    def add(self, bin_of: np.ndarray, values: np.ndarray) -> None:
        """Values (n, k) in bins (n,), which do not fall."""
        starts = np.flatnonzero(np.diff(bin_of, prepend=-1))
        place = bin_of[starts]
        known = np.isfinite(values)
        self.low[place] = np.minimum(self.low[place], np.minimum.reduceat(np.where(known, values, np.inf), starts))
        self.high[place] = np.maximum(self.high[place], np.maximum.reduceat(np.where(known, values, -np.inf), starts))
        for k in range(values.shape[1]):  # one by one: sums of parts would depend on the blocks
            np.add.at(self.total[:, k], bin_of[known[:, k]], values[known[:, k], k])
            np.add.at(self.count[:, k], bin_of[known[:, k]], 1.0)

    def scaled(self, factor: float) -> Swing:
        """The same in another unit."""
        return Swing(factor * self.low, factor * self.high, factor * self.total, self.count)


@dataclass
class Rows:
    """Where values stand on the timelines, with one row more just within each gap, where there is none."""

    index: Index
    holes: np.ndarray  # (m,) numbers of values before which there is a gap

    @staticmethod
    def of(setting: Setting, number: np.ndarray, time: np.ndarray) -> Rows:
        found = [gap for gap in setting.gaps if len(gaps.last_rows(time, [gap]))]
        before = np.array([gaps.last_rows(time, [gap])[0] for gap in found], int)
        numbers, times = np.insert(number, before + 1, number[before]), np.insert(time, before + 1, gaps.moments(found))
        return Rows(timelines.time_columns(setting, numbers, times), before + 1)

    def broken(self, values: np.ndarray) -> np.ndarray:
        """Values (n, ...) with NaN within each gap."""
        return np.insert(values, self.holes, np.nan, axis=0)


def log_curves(
    picture: Picture, path: str, rows: Rows, values: np.ndarray, names: Sequence[str], colors: Sequence[Color]
) -> None:
    """Write curves, values (n, k), by their names and in their colours, broken where there is no data."""
    widths = [style.WIDTH["plot"]] * len(names)
    picture.log_static(path, rr.SeriesLines(names=names, colors=[list(color) for color in colors], widths=widths))
    scalars = rows.broken(np.where(np.isfinite(values), values, np.nan))
    picture.log_columns(path, rows.index, rr.Scalars.columns(scalars=scalars))


def wanted_place(plot: Plot, asked: Sequence[str]) -> int | None:
    """The place of a plot among the words of those that a scene asks for."""
    return next((k for k, word in enumerate(asked) if plot.is_called(word)), None)


def hidden(plot: Plot, about: Sequence[str]) -> bool:
    """Whether a plot is only shown where it is asked for, or where a scene speaks of it."""
    return plot.rare or (plot.key in RARE and plot.key.split("_")[0] not in about)


def largest(values: np.ndarray) -> float:
    """The largest size of values that are known."""
    return float(np.nanmax(np.abs(values), initial=0.0))


def worth_of(plot: Plot, values: np.ndarray) -> float:
    """What the change of the curves of a plot, values (n, k), is worth."""
    return max((score(values[:, k], plot.natural, plot.bonus) for k in range(values.shape[1])), default=0.0)


class Curves:
    """Gathers the curves of a run, and writes those that say something once it is over."""

    def __init__(self, picture: Picture, first: Run, frame: Frame, craft: CraftDrawing):
        self._picture, self._frame, self._setting = picture, frame, first.setting
        self._picker = timelines.Picker(
            first.setting.rows, FAR_ROWS if frame.sparse else PLOT_ROWS, first.setting.duration
        )
        self.plots = [*plots_of(first, frame, craft), *film_plots(first)]
        self._number: list[np.ndarray] = []
        self._time: list[np.ndarray] = []
        self._values: dict[str, list[np.ndarray]] = {plot.path: [] for plot in self.plots}
        bins = int(min(MOST_BINS, max(first.setting.rows // ROWS_IN_BIN, 1), max(frame.turns, 1)))
        self._bins = bins if np.isfinite(frame.turns) and frame.turns > BAND_TURNS else 0
        self._swings = {plot.path: Swing.of(self._bins, len(plot.names)) for plot in self.plots if self._bins}
        self._reach: dict[str, tuple[float, float]] = {}
        self._lanes = Lanes(first, frame, craft)

    def add(self, run: Run) -> None:
        """A block of a run, all rows."""
        drawn = self._picker.pick(run)
        picked = timelines.take(run, drawn)
        self._number.append(run.first + drawn)
        self._time.append(picked.time)
        share = (run.time - self._frame.start) / self._setting.duration
        bin_of = np.clip(share * self._bins, 0, max(self._bins - 1, 0)).astype(int)
        for plot in self.plots:
            if self._bins:
                self._swings[plot.path].add(bin_of, plot.values(run))
            self._values[plot.path].append(plot.values(picked))
        self._lanes.add(run)

    def finish(self, last: Run, asked: tuple[str, ...], about: tuple[str, ...]) -> list[PlotView]:
        """Write the curves -> views of those that vary, most telling first; last : the last row of the run.

        asked : words of the plots that the scene wants in front, of those that one word calls the largest first;
        about : words of what it speaks of.
        """
        rows = self.close(last)
        found: list[tuple[float, PlotView]] = []
        most = [0.0] * len(asked)  # of the plots that one word calls
        for plot in self.plots:
            place = wanted_place(plot, asked)
            if place is not None:
                most[place] = max(most[place], largest(self.values_of(plot)))
        for plot in self.plots:
            values = self.values_of(plot)
            place = wanted_place(plot, asked)
            share = largest(values) / most[place] if place is not None and most[place] else 1.0
            if share < ROUNDING:
                continue
            if plot.handy:
                plot, values = self._in_handy_unit(plot, values)
            worth = worth_of(plot, values)
            if place is None and (worth < SHOWN_FROM or hidden(plot, about)):
                continue
            view = self._write(plot, rows, values)
            found.append((worth if place is None else 1e3 - place + 0.5 * share, view))
        return [view for _, view in sorted(found, key=lambda pair: -pair[0])]

    def close(self, last: Run) -> Rows:
        """Take the last row of the run as well -> where the values stand."""
        number, time = np.concatenate(self._number), np.concatenate(self._time)
        if len(number) == 0 or number[-1] != last.first:
            number, time = np.append(number, last.first), np.append(time, last.time)
            for plot in self.plots:
                self._values[plot.path].append(plot.values(last))
        return Rows.of(self._setting, number, time)

    def values_of(self, plot: Plot) -> np.ndarray:
        """(n, k) the values of a plot that were gathered."""
        return np.concatenate(self._values[plot.path])

    def line_of(self, plot: Plot, rows: Rows, size: float) -> tuple[Rows, np.ndarray]:
        """The first curve of a plot, in units of `size`: where its values stand, and they (n,); where it would be a
        solid block, its means. rows : those of `close`."""
        values = self.values_of(plot)[:, 0]
        reach = values[np.isfinite(values)]
        if self._banded(plot, [(plot.names[0], 0)], float(np.ptp(reach)) if len(reach) else 0.0):
            filled, means = self._bands(plot, [(plot.names[0], 0)])
            return self._bins_at(filled), means[0] / size
        return rows, values / size

    def _in_handy_unit(self, plot: Plot, values: np.ndarray) -> tuple[Plot, np.ndarray]:
        """A plot of pushes, and its values, in the unit in which the largest of the whole run is a handy number."""
        size, name = push_unit(float(np.nanmax(values, initial=0.0)) or 1e-3)
        if self._bins:
            self._swings[plot.path] = self._swings[plot.path].scaled(1 / size)
        return replace(plot, title=f"{plot.title} [{name}]"), values / size

    def steady(self) -> list[str]:
        """What is constant all along, in words."""
        words = []
        for plot in self.plots:
            values = np.concatenate(self._values[plot.path])[:, 0]
            known = values[np.isfinite(values)]
            if not plot.steady or len(known) < len(values) or np.ptp(known) > FLAT * np.abs(known).max():
                continue
            mean = float(known.mean())
            if plot.handy:
                words += [f"{plot.steady} {amount(mean, *push_unit(mean), most=mean)}"] if mean > 0 else []
            else:
                words.append(plot.steady.format(mean))
        return words

    def write_lanes(self) -> list[str]:
        """Write what goes on and off -> paths of the lanes."""
        return self._lanes.write(self._picture, self._setting)

    def _write(self, plot: Plot, rows: Rows, values: np.ndarray) -> PlotView:
        kept = merged(plot.names, values)
        shown = np.stack([values[:, k] for _, k in kept], 1)
        colors = [plot.colors[k] for _, k in kept]
        names = [name for name, _ in kept]
        low, high = float(np.nanmin(shown)), float(np.nanmax(shown))
        if plot.key == "distance":  # the axis of an orbit close to escape is beyond all measure: it may leave the range
            low, high = max(low, 0.0), min(high, 1.25 * float(np.nanmax(values[:, 0])))
        if high - low < plot.noise:
            low = high = round(0.5 * (low + high) / plot.noise) * plot.noise
        if self._banded(plot, kept, high - low):
            self._write_bands(plot, kept)
            curves = self._bands(plot, kept)[1]
        else:
            log_curves(self._picture, plot.path, rows, shown, names, colors)
            curves = [shown[:, k] for k in range(len(kept))]
        if plot.from_zero:
            low = min(low, 0.0)
        low, high = nice_range(low, high)
        legend = corner(curves, low, high) if len(kept) > 1 else ""
        return PlotView(plot.title, (f"{plot.path}/**",), low, high, legend)

    def _banded(self, plot: Plot, kept: list[tuple[str, int]], whole: float) -> bool:
        """Whether some curve swings so much within a bin that a line would be a block."""
        if not self._bins or whole <= 0 or not plot.swings:
            return False
        swing = self._swings[plot.path]
        inside = [swing.high[:, k] - swing.low[:, k] for _, k in kept]
        known = [part[np.isfinite(part)] for part in inside]
        return any(len(part) and float(np.median(part)) > SWING * whole for part in known)

    def _bands(self, plot: Plot, kept: list[tuple[str, int]]) -> tuple[np.ndarray, list[np.ndarray]]:
        """The bins that hold anything, and the means (m,) of each curve in them."""
        swing = self._swings[plot.path]
        filled = np.flatnonzero(swing.count.max(1) > 0)
        with np.errstate(invalid="ignore", divide="ignore"):
            means = [swing.total[filled, k] / swing.count[filled, k] for _, k in kept]
        return filled, means

    def _bins_at(self, filled: np.ndarray) -> Rows:
        """Where the middles of some bins (m,) stand."""
        time = self._frame.start + (filled + 0.5) / self._bins * self._setting.duration
        number = np.round((filled + 0.5) / self._bins * (self._setting.rows - 1)).astype(int)
        return Rows.of(self._setting, number, time)

    def _write_bands(self, plot: Plot, kept: list[tuple[str, int]]) -> None:
        """Each curve as its mean in a band from the least to the largest value of each stretch."""
        swing, picture = self._swings[plot.path], self._picture
        filled, means = self._bands(plot, kept)
        rows = self._bins_at(filled)
        for place, (name, k) in enumerate(kept):
            low, high = swing.low[filled, k], swing.high[filled, k]
            color, path = list(plot.colors[k]), f"{plot.path}/{place}"
            if plot.swings == "mean":
                log_curves(self._picture, f"{path}/mean", rows, means[place][:, None], [name], [color])
                continue
            band = rr.Measurements.from_fields(
                colors=[style.dim(color, BAND_SHADE)], widths=[0.0], names=[f"{name}, least to largest"]
            )
            picture.log_static(f"{path}/band", band)
            low, high = rows.broken(low), rows.broken(high)
            columns = rr.Measurements.columns(values=0.5 * (low + high), variances=(0.5 * (high - low)) ** 2)
            picture.log_columns(f"{path}/band", rows.index, columns)
            log_curves(self._picture, f"{path}/mean", rows, means[place][:, None], [f"{name}, mean"], [color])


def words_of(setting: Setting) -> tuple[str, ...]:
    """The words that a scene's own texts are made of."""
    texts = " ".join((setting.title, setting.about, *setting.look_for)).lower()
    return tuple("".join(letter if letter.isalpha() else " " for letter in texts).split())
