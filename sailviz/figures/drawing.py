"""Figures a reader wants to see on paper: the thesis' own, redrawn from our functions, and maps of ours.

Needs matplotlib, which comes with the extra `plot`: pip install "sailviz[plot]".
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from sailviz import files
from sailviz.errors import OutputError
from sailviz.figures.catalogue import CATALOGUE, Entry

if TYPE_CHECKING:
    from matplotlib.figure import Figure

FORMATS = ("png", "svg", "pdf")


class FigureError(Exception):
    """A figure that cannot be drawn, in one sentence."""


def names() -> list[str]:
    """Names of all figures, the thesis' first."""
    return list(CATALOGUE)


def title(name: str) -> str:
    """What a figure shows, in one line."""
    return _entry(name).title


def figure(name: str, style: str = "dark", **options: object) -> Figure:
    """A figure as a matplotlib Figure. style : "dark" or "light". options : what the figure takes; series="FILE", a
    measured solar wind, for wind-fit."""
    entry = _entry(name)
    for key in options:
        if key not in entry.takes:
            users = [other for other, candidate in CATALOGUE.items() if key in candidate.takes]
            raise FigureError(f"{name} takes no {key}" + (f", only {', '.join(users)} does" if users else ""))
    try:
        return _composed(entry, style, options)
    except OSError as error:
        raise FigureError(f"cannot read {error.filename}: {(error.strerror or str(error)).lower()}") from None
    except ValueError as error:
        if not options:
            raise
        raise FigureError(str(error)) from None


def draw(name: str, path: str | Path, style: str = "dark", dpi: int = 160, **options: object) -> Path:
    """Draw a figure into a file, PNG, SVG or PDF by its ending. options as of `figure`. Returns the path."""
    kind = file_of(path)
    drawn = figure(name, style, **options)
    return _saved(drawn, Path(path), kind, dpi)


def file_of(path: str | Path) -> str:
    """The kind of a figure's file. FigureError where it has none, or cannot be written."""
    path = Path(path)
    kind = path.suffix.lower().lstrip(".")
    if kind not in FORMATS:
        raise FigureError(f"a figure is written as {', '.join(FORMATS)}; {path.name} ends in none of them")
    try:
        files.check(path, "figure")
    except OutputError as error:
        raise FigureError(str(error)) from None
    return kind


def written(path: str | Path, kind: str, entry: Entry, style: str, dpi: int, options: Mapping[str, object]) -> Path:
    """Draw a figure that is not in the catalogue into a file of that kind -> the path."""
    return _saved(_composed(entry, style, options), Path(path), kind, dpi)


def _composed(entry: Entry, style: str, options: Mapping[str, object]) -> Figure:
    try:
        from sailviz.figures import page
    except ImportError:
        raise FigureError('figures need matplotlib: pip install "sailviz[plot]"') from None
    if style not in page.STYLES:
        raise FigureError(f"there is no style {style!r}, only {' and '.join(page.STYLES)}")
    return page.compose(entry, style, options)


def _saved(drawn: Figure, path: Path, kind: str, dpi: int) -> Path:
    from sailviz.figures import page

    try:
        with files.writing(path, "figure") as part:
            page.save(drawn, part, kind, dpi)
    except OutputError as error:
        raise FigureError(str(error)) from None
    return path


def _entry(name: str) -> Entry:
    try:
        return CATALOGUE[name]
    except KeyError:
        raise FigureError(f"there is no figure {name!r}; there are {', '.join(CATALOGUE)}") from None
