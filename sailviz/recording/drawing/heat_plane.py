"""How warm a film is over its distance from the Sun: a plane with its own axes, since curves run over time alone."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import rerun as rr
from numpy.typing import ArrayLike

from sailviz.recording.drawing import style
from sailviz.recording.drawing.arrival_plane import BOX, ROOM, ticks
from sailviz.recording.drawing.film_plots import hottest_of
from sailviz.recording.drawing.log import Picture, f4
from sailviz.recording.drawing.story import Story
from sailviz.recording.drawing.style import points

PATH, NAME = "/heat", "Heat over distance"
LEFT, BELOW = 0.16, 0.10  # of the box, left of the upright axis and below the level one
WORTH = 0.02  # of the distance and of the temperature, by which they have to change
TICK = 0.012


class Heat(NamedTuple):
    """Rows (m,) of a story whose temperature is known; distance, in the view's unit, and temperature, K, of each; the
    ranges of both that the plane shows; and what the film bears, K, where that is told."""

    rows: np.ndarray
    distance: np.ndarray
    kelvin: np.ndarray
    across: tuple[float, float]
    up: tuple[float, float]
    hottest: float | None

    def place(self, distance: ArrayLike, kelvin: ArrayLike) -> np.ndarray:
        """(..., 2) in the plane; y runs down on the screen."""
        x = (np.asarray(distance, float) - self.across[0]) / (self.across[1] - self.across[0])
        y = (np.asarray(kelvin, float) - self.up[0]) / (self.up[1] - self.up[0])
        wide, high = 2 * BOX[0] - LEFT, 2 * BOX[1] - BELOW
        return np.stack(np.broadcast_arrays(LEFT - BOX[0] + wide * x, BOX[1] - BELOW - high * y), -1)


def heat_of(story: Story) -> Heat | None:
    """Of a flight round the Sun whose distance and temperature change; None of any other."""
    story = story.told
    kelvin = story.samples.run.film.get("temperature_K")
    if kelvin is None or not story.frame.sun:
        return None
    rows = np.flatnonzero(np.isfinite(kelvin))
    if len(rows) < 2:
        return None
    warm, far = kelvin[rows], story.distance[rows]
    if np.ptp(far) < WORTH * far.max() or np.ptp(warm) < WORTH * warm.max():
        return None
    hottest = hottest_of(story.samples.run)
    shown = [warm.min(), warm.max(), *([] if hottest is None else [hottest])]
    return Heat(rows, far, warm, room(far.min(), far.max()), room(min(shown), max(shown)), hottest)


def room(low: float, high: float) -> tuple[float, float]:
    """A range with some room round what must be seen."""
    return float(low - ROOM * (high - low)), float(high + ROOM * (high - low))


def log_heat(picture: Picture, story: Story, heat: Heat) -> None:
    """Write /heat."""
    story, color = story.told, style.QUANTITY["heat"]
    log_axes(picture, heat, story.frame.unit_name)
    gaps = np.flatnonzero(np.diff(heat.rows) > 1) + 1  # where the film is in the dark, or stowed
    pieces = [part for part in np.split(heat.place(heat.distance, heat.kelvin), gaps) if len(part) > 1]
    lines = rr.LineStrips2D([f4(part) for part in pieces], colors=[style.dim(color, 0.8)], radii=points(1.4))
    picture.log_static(f"{PATH}/way", lines)
    if heat.hottest is not None:
        limit = heat.place(np.array(heat.across), heat.hottest)
        picture.log_static(f"{PATH}/limit", rr.LineStrips2D([f4(limit)], colors=[style.FAULT], radii=points(1.0)))
    dot = rr.Points2D.from_fields(radii=points(4.0), colors=[style.CRAFT], show_labels=True)
    picture.log_static(f"{PATH}/now", dot)
    places = rr.Points2D.columns(positions=f4(heat.place(heat.distance, heat.kelvin)), labels=words(story, heat))
    picture.log_columns(f"{PATH}/now", story.samples.index_of(heat.rows), places)


def log_axes(picture: Picture, heat: Heat, unit: str) -> None:
    """The level and the upright axis, with ticks, numbers and names."""
    corner = heat.place(heat.across[0], heat.up[0])
    lines = [heat.place(np.array(heat.across), heat.up[0]), heat.place(heat.across[0], np.array(heat.up))]
    spots: list[Any] = []
    texts: list[str] = []
    for number in ticks(np.array(heat.across)).tolist():
        at = np.array([heat.place(number, heat.up[0])[0], corner[1]])
        lines.append(np.array([[0.0, -TICK], [0.0, TICK]]) + at)
        spots.append(at + np.array([0.0, 0.012]))
        texts.append(f"{number:.4g}")
    for number in ticks(np.array(heat.up)).tolist():
        at = np.array([corner[0], heat.place(heat.across[0], number)[1]])
        lines.append(np.array([[-TICK, 0.0], [TICK, 0.0]]) + at)
        spots.append(at + np.array([-0.06, -0.03]))
        texts.append(f"{number:.4g}")
    path, reference = f"{PATH}/axes", [style.REFERENCE]
    picture.log_static(path, rr.LineStrips2D([f4(line) for line in lines], colors=[style.AXES], radii=points(0.7)))
    top, right = heat.place(heat.across[0], heat.up[1]), heat.place(heat.across[1], heat.up[0])
    named = [top + np.array([0.17, -0.03]), right + np.array([-0.24, 0.055])]
    called = ["film temperature [K]", f"distance from the Sun [{unit}]"]
    if heat.hottest is not None:
        named.append(heat.place(heat.across[1], heat.hottest) + np.array([-0.2, 0.0]))
        called.append(f"bears {heat.hottest:.0f} K")
    for name, places, labels in (
        ("numbers", spots, texts),
        ("names", named, called),
    ):
        found = rr.Points2D(f4(places), radii=points(style.ANCHOR), colors=reference, labels=labels, show_labels=True)
        picture.log_static(f"{path}/{name}", found)


def words(story: Story, heat: Heat) -> list[str]:
    """What stands beside the film's place in each of its rows."""
    dose, unit = story.samples.run.film.get("dose_yr"), story.frame.unit_name
    aged = [""] * len(heat.rows) if dose is None else [f", dose {value:.2f} yr" for value in dose[heat.rows].tolist()]
    pairs = zip(heat.kelvin.tolist(), heat.distance.tolist(), aged, strict=True)
    return [f"{kelvin:.0f} K at {far:.2f} {unit}{age}" for kelvin, far, age in pairs]
