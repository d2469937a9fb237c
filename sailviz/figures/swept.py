"""What came of many flights of a sweep: how a quantity changes over what was varied, or how it is spread."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes

from sailviz.figures.catalogue import Entry
from sailviz.figures.drawing import file_of, written
from sailviz.figures.page import Pen

WIDE, HIGH, ROOM = 9.0, 2.7, 1.2  # inches: of the page, of a panel, for title and note
BARS = 40  # at most
FEW = 12  # flights up to which each is marked under the bars


@dataclass(frozen=True)
class Series:
    """Values (n,) of flights over what was varied, over (n,) in order; name : of the value of a second key, "" for
    none; least (n,) : what is known of flights that were still flying, NaN of all others."""

    name: str
    over: np.ndarray
    values: np.ndarray
    least: np.ndarray


@dataclass(frozen=True)
class OverPanel:
    """A quantity over what was varied."""

    quantity: str
    key: str
    series: tuple[Series, ...]


@dataclass(frozen=True)
class SpreadPanel:
    """How a quantity is spread. values (n,) of the flights that tell it; least (m,) of those still flying; marks :
    words and numbers, such as percentiles."""

    quantity: str
    values: np.ndarray
    least: np.ndarray
    marks: tuple[tuple[str, float], ...]


Panel = OverPanel | SpreadPanel


def draw_swept(panels: tuple[Panel, ...], title: str, note: str, path: str | Path, style: str = "light") -> Path:
    """Draw panels one above the other into a file -> its path. FigureError where that cannot be."""
    kind = file_of(path)
    entry = Entry(title, note, (WIDE, ROOM + HIGH * len(panels)), (len(panels), 1), "swept", "swept")
    return written(path, kind, entry, style, 130, {"shown": panels})


def swept(pen: Pen, *axes: Axes, shown: tuple[Panel, ...]) -> None:
    """Each panel by its kind."""
    for panel, one in zip(axes, shown, strict=True):
        if isinstance(one, OverPanel):
            over(pen, panel, one)
        else:
            spread(pen, panel, one)


def over(pen: Pen, panel: Axes, shown: OverPanel) -> None:
    """Lines through the flights of each series; what is only a bound is an arrowhead upwards, and on no line."""
    panel.set_title(shown.quantity, loc="left")
    for number, one in enumerate(shown.series):
        color = pen.style.series[number % len(pen.style.series)]
        panel.plot(one.over, one.values, "o-", color=color, ms=3.5, label=one.name or None)
        panel.plot(one.over, one.least, "^", color=color, ms=5, mfc="none")
    if any(np.isfinite(one.least).any() for one in shown.series):
        panel.text(0.995, 1.02, "triangles: at least so much", transform=panel.transAxes, ha="right", fontsize=8.5)
    panel.set_xlabel(shown.key)
    if any(one.name for one in shown.series):
        panel.legend(loc="best", ncols=min(len(shown.series), 4))


def spread(pen: Pen, panel: Axes, shown: SpreadPanel) -> None:
    """Bars of how many flights lie where; those still flying at what they are at least, on top and empty."""
    panel.set_title(shown.quantity, loc="left")
    panel.set_ylabel("flights", color=pen.style.quiet)
    every = np.concatenate([shown.values, shown.least])
    edges = np.histogram_bin_edges(every, bins=min(BARS, max(5, round(2 * len(every) ** 0.5))))
    known, _ = np.histogram(shown.values, edges)
    open_, _ = np.histogram(shown.least, edges)
    wide, color = np.diff(edges), pen.style.series[0]
    panel.bar(edges[:-1], known, wide, align="edge", color=color, alpha=0.75, lw=0)
    if open_.any():
        panel.bar(edges[:-1], open_, wide, align="edge", bottom=known, color="none", ec=color, hatch="///", lw=0.8)
        panel.text(0.995, 1.02, "hatched: still flying, at least so much", transform=panel.transAxes, ha="right",
                   fontsize=8.5)  # fmt: skip
    if len(every) <= FEW:
        panel.plot(every, np.zeros(len(every)), "|", color=pen.style.ink, ms=9, clip_on=False)
    top = 1.18 * max(float((known + open_).max()), 1.0)
    panel.set_ylim(0, top)
    for number, (word, value) in enumerate(shown.marks):
        panel.axvline(value, color=pen.style.ink, lw=1.1, ls=(0, (4, 3)))
        pen.label(panel, value, top * (0.95 - 0.11 * (number % 2)), f"{word} {value:.4g}", fontsize=8.5)
