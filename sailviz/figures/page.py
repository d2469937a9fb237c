"""One look for all figures: colours of the recordings, quiet axes, words where the eye is."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.cm import ScalarMappable
from matplotlib.colorbar import Colorbar
from matplotlib.colors import LinearSegmentedColormap
from matplotlib.contour import ContourSet
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine
from matplotlib.text import Text

from sailviz.figures.catalogue import Entry


@dataclass(frozen=True)
class Style:
    """Colours by role."""

    page: str
    panel: str
    ink: str
    quiet: str
    grid: str
    forbidden: str
    series: tuple[str, ...]
    good: str
    bad: str
    ramp: tuple[str, ...]  # from little to much


STYLES = {
    "dark": Style(
        "#070a12",
        "#0c111d",
        "#e6edf7",
        "#8b9ab3",
        "#1b2436",
        "#232c3d",
        ("#64beff", "#ffb042", "#62d6a0", "#ec7cbe", "#bea0ff", "#ff7043"),
        "#2fae7a",
        "#ff5454",
        ("#0f1a33", "#1d4a7a", "#3f86b0", "#8fb5a0", "#ffb042", "#ff7043", "#ff5454"),
    ),
    "light": Style(
        "#ffffff",
        "#ffffff",
        "#172033",
        "#5c6b84",
        "#e4e9f1",
        "#dfe4ec",
        ("#1873c2", "#c96f00", "#16875a", "#b23a86", "#6a48c4", "#c8401a"),
        "#4fbf8f",
        "#c62828",
        ("#f4f7fc", "#c5dcf0", "#8fbbdc", "#cdbb6a", "#f5a94a", "#e8663c", "#b8302c"),
    ),
}


DEVICES = {  # what pushes or brakes has the same colour in every figure
    "electric sail": (186, 140, 255),
    "ideal film": (255, 206, 84),
    "real film": (255, 176, 84),
    "plasma brake": (255, 112, 67),
    "thruster": (120, 224, 232),
}
WHITE, CONTRAST = "#ffffff", 3.0  # the least ratio for lines of WCAG 2.1, 1.4.11


def luminance(share: np.ndarray) -> float:
    """Relative luminance of sRGB values (3,) of 0 to 1, as WCAG 2.1 defines it."""
    linear = np.where(share <= 0.04045, share / 12.92, ((share + 0.055) / 1.055) ** 2.4)
    return float(linear @ [0.2126, 0.7152, 0.0722])


class Pen:
    """What a drawing function may ask for: the style, and the words that all figures share."""

    def __init__(self, style: Style):
        self.style = style
        self.ramp = LinearSegmentedColormap.from_list("ramp", style.ramp).with_extremes(bad=style.forbidden)

    def device(self, name: str) -> str:
        """The colour of a device, by its name in DEVICES."""
        return self.readable(DEVICES[name])

    def readable(self, color: Sequence[int]) -> str:
        """A colour of the recordings (r, g, b), on white as much darker as it takes to be read there."""
        share = np.array(color[:3], float) / 255
        while self.style.panel == WHITE and 1.05 / (luminance(share) + 0.05) < CONTRAST:
            share = 0.97 * share
        return "#" + "".join(f"{round(255 * part):02x}" for part in share.tolist())

    def label(self, axes: Axes, x: float, y: float, text: str, color: str | None = None, **more: Any) -> Text:
        """Words inside a panel, on a patch of the panel's colour so that no line runs through them."""
        options: dict[str, Any] = {"ha": "center", "va": "center", "fontsize": 9.5} | more
        pad = {"facecolor": self.style.panel, "edgecolor": "none", "alpha": 0.85, "pad": 1.6}
        return axes.text(x, y, text, color=color or self.style.ink, bbox=pad, zorder=6, **options)

    def contour_labels(
        self, axes: Axes, lines: ContourSet, form: Callable[[float], str], spots: Iterable[tuple[float, float]] = ()
    ) -> None:
        """Numbers on contour lines, nearest to the spots (x, y) if there are any."""
        axes.clabel(lines, fmt=form, fontsize=8.5, inline=True, inline_spacing=4, manual=list(spots) or False)

    def bar(self, axes: Axes, mappable: ScalarMappable, words: str, **more: Any) -> Colorbar:
        """A slim colour bar."""
        bar = axes.figure.colorbar(mappable, ax=axes, pad=0.02, fraction=0.045, aspect=32, **more)
        bar.outline.set_visible(False)
        bar.ax.tick_params(length=0, labelsize=9)
        bar.set_label(words, color=self.style.quiet, fontsize=9.5)
        return bar


def compose(entry: Entry, style_name: str, options: Mapping[str, object]) -> Figure:
    """The page: panels, title above, origin below. options : keywords for the drawing function."""
    style = STYLES[style_name]
    rc: dict[Any, object] = {
        "font.family": "DejaVu Sans",
        "font.size": 10.5,
        "text.color": style.ink,
        "axes.facecolor": style.panel,
        "axes.edgecolor": style.grid,
        "axes.labelcolor": style.ink,
        "axes.titlecolor": style.ink,
        "axes.titlesize": 11,
        "axes.titleweight": "normal",
        "axes.titlepad": 9,
        "axes.grid": True,
        "axes.axisbelow": True,
        "grid.color": style.grid,
        "grid.linewidth": 0.8,
        "xtick.color": style.quiet,
        "ytick.color": style.quiet,
        "xtick.labelcolor": style.quiet,
        "ytick.labelcolor": style.quiet,
        "xtick.major.size": 0,
        "ytick.major.size": 0,
        "xtick.minor.size": 0,
        "ytick.minor.size": 0,
        "lines.linewidth": 1.9,
        "lines.solid_capstyle": "round",
        "legend.frameon": False,
        "legend.fontsize": 9.5,
        "legend.labelcolor": style.ink,
        "hatch.linewidth": 0.6,
        "mathtext.fontset": "dejavusans",
    }
    with matplotlib.rc_context(rc):
        layout = ConstrainedLayoutEngine(w_pad=0.12, h_pad=0.10, wspace=0.04)
        figure = Figure(
            figsize=entry.size,
            facecolor=style.page,
            layout=layout,
        )
        FigureCanvasAgg(figure)
        axes = figure.subplots(*entry.panels, squeeze=False).ravel()
        for panel in axes:
            for side in panel.spines.values():
                side.set_visible(False)
        figure.suptitle(entry.title, fontsize=13, color=style.ink, fontweight="bold")
        figure.supxlabel(entry.note, fontsize=8.5, color=style.quiet)
        drawer = getattr(import_module(f"sailviz.figures.{entry.module}"), entry.function)
        drawer(Pen(style), *axes, **options)
        figure.draw_without_rendering()
    return figure


def save(figure: Figure, path: Path, kind: str, dpi: int) -> None:
    """Write a figure, kind png, svg or pdf, so that drawing it again gives the same file: no dates, no random names,
    words that stay words."""
    dates = {"png": {"Software": None}, "svg": {"Date": None}, "pdf": {"CreationDate": None}}
    with matplotlib.rc_context({"svg.fonttype": "none", "svg.hashsalt": "sailviz"}):
        figure.savefig(path, format=kind, dpi=dpi, metadata=dates[kind])
