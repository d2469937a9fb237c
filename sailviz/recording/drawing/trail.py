"""The way flown and to be flown, as pieces that join on; where rows lie far apart, the orbit of the moment instead."""

from __future__ import annotations

import numpy as np

from sailviz.recording.drawing import style
from sailviz.recording.drawing.layout import SO_FAR, TO_COME, Span
from sailviz.recording.drawing.log import Picture
from sailviz.recording.drawing.samples import SPARSE, arc, orbits, smooth_lines
from sailviz.recording.drawing.story import Story

STRIP = 4  # drawn rows in one piece
GAP = 2 * SPARSE  # revolutions between rows over which a curve through both would miss the orbit
RING_PAST = 0.9  # revolutions of a ring's trail


def log_trail(picture: Picture, story: Story) -> dict[str, Span]:
    """Write /world/trail or /world/orbit -> which part of the run each part shows. They do not overlap: lines on one
    another tear."""
    if story.frame.sparse:
        picture.log_strip_style("/world/orbit", style.TRAIL_RECENT, 0.8 * style.WIDTH["recent"])
        picture.log_strips("/world/orbit", story.index, orbits(story.samples.run, story.frame))
        return {}
    colors = {"recent": style.TRAIL_RECENT, "past": style.TRAIL_PAST, "future": style.TRAIL_FUTURE}
    parts = [part for part in colors if not (part == "future" and story.ring)]
    ends, pieces = pieces_of(story)
    index = story.samples.index_of(ends)
    for part in parts:
        path = f"/world/trail/{part}"
        picture.log_strip_style(path, colors[part], style.WIDTH[part])
        picture.log_broken_strips(path, index, pieces)
    back = -RING_PAST * story.duration / story.turns if story.ring else None
    spans: dict[str, Span] = {
        "/world/trail/past": (back, -story.tail),
        "/world/trail/recent": (-story.tail, SO_FAR[1]),
        "/world/trail/future": TO_COME,
    }
    return {path: span for path, span in spans.items() if path.rsplit("/", 1)[-1] in parts}


def pieces_of(story: Story) -> tuple[np.ndarray, list[list[np.ndarray]]]:
    """Rows (p,) at which pieces end, and the lines (k, 3) of each: a curve through its rows, broken where rows lie so
    far apart that it would miss the orbit between them."""
    samples, smooth = story.samples, story.frame.smooth
    line = smooth_lines(samples.run.time, samples.position, samples.velocity, smooth)
    gaps = np.diff(samples.run.time)
    arcs = {
        k + 1: arc(samples.run, k + 1, samples.position[k], float(gaps[k]), story.frame)
        for k in np.flatnonzero(wide(story, gaps)).tolist()
    }
    last = len(samples) - 1
    starts = np.arange(0, max(last, 1), STRIP)
    ends = np.minimum(starts + STRIP, last)
    return ends, [drawn(line, arcs, a, b, smooth) for a, b in zip(starts.tolist(), ends.tolist(), strict=True)]


def wide(story: Story, gaps: np.ndarray) -> np.ndarray:
    """Whether the time (n - 1,) between rows is so long that a curve through both would miss the orbit."""
    e = story.samples.run.elements
    with np.errstate(invalid="ignore"):
        turn = 2 * np.pi * np.sqrt(e.semi_major_axis[1:] ** 3 / story.frame.mu)
        found: np.ndarray = (e.eccentricity[1:] < 1) & (gaps > GAP * turn)
    return found


def drawn(line: np.ndarray, arcs: dict[int, np.ndarray], start: int, end: int, pieces: int) -> list[np.ndarray]:
    """The lines from row `start` to row `end`: the curve through all of them, broken where there are arcs."""
    if end == start:
        return [line[start * pieces : start * pieces + 1].repeat(2, axis=0)]
    lines, begun = [], start
    for k in range(start + 1, end + 1):
        if k in arcs:
            lines += [line[begun * pieces : (k - 1) * pieces + 1]] if k - 1 > begun else []
            lines.append(arcs[k])
            begun = k
    return lines + ([line[begun * pieces : end * pieces + 1]] if end > begun else [])
