"""The way flown and to be flown, as pieces that join on, broken where there is no data; of sparse rows of many turns
the orbit of the moment instead.
"""

from __future__ import annotations

import numpy as np

from sailviz.frames import unit
from sailviz.recording.drawing import style
from sailviz.recording.drawing.layout import SO_FAR, TO_COME, Span
from sailviz.recording.drawing.log import Color, Picture
from sailviz.recording.drawing.phases import rows_at_switches, words_and_colors
from sailviz.recording.drawing.samples import orbits, rings, smooth_lines
from sailviz.recording.drawing.story import Story
from sailviz.shapes.primitives import circle

STRIP = 4  # drawn rows in one piece
CIRCLE = 241  # points of an orbit
DASHES, LEAST_DASHES = 60, 3  # in a revolution, and between two rows
RING_PAST = 0.9  # revolutions of a ring's trail
OF_THE_FIRST: dict[str, Color] = {
    "recent": style.TRAIL_RECENT,
    "past": style.TRAIL_PAST,
    "future": style.TRAIL_FUTURE,
}
DIMMER = {"recent": 1.0, "past": 0.62, "future": 0.34}  # of a colour, like those of the first flight


def trail_colors(color: Color) -> dict[str, Color]:
    """Of the parts of a trail in a colour of its own."""
    return {part: style.dim(color, factor) for part, factor in DIMMER.items()}


def log_trail(
    picture: Picture, story: Story, top: str = "/world", colors: dict[str, Color] = OF_THE_FIRST, alone: bool = True
) -> dict[str, Span]:
    """Write trail or orbit under `top` -> which part of the run each part shows. They do not overlap: lines on one
    another tear. alone : no other flight is drawn, and phases have colours of their own."""
    strip, story = (STRIP if story.rows is None else 1), story.told
    if story.frame.sparse:
        log_orbit(picture, story, f"{top}/orbit", colors["recent"])
        return {}
    parts = [part for part in colors if not (part == "future" and story.ring)]
    ends, pieces = pieces_of(story, strip)
    index = story.samples.index_of(ends)
    phases = words_and_colors(story.setting) if alone else []
    log_unknown(picture, story, top, colors)
    for part in parts:
        path = f"{top}/trail/{part}"
        picture.log_strip_style(path, None if phases else colors[part], style.WIDTH[part])
        picture.log_broken_strips(path, index, pieces, colors_of_phases(story, ends, part) if phases else None)
    back = -RING_PAST * story.duration / story.turns if story.ring else None
    spans: dict[str, Span] = {
        f"{top}/trail/past": (back, -story.tail),
        f"{top}/trail/recent": (-story.tail, SO_FAR[1]),
        f"{top}/trail/future": TO_COME,
    }
    return {path: span for path, span in spans.items() if path.rsplit("/", 1)[-1] in parts}


def log_orbit(picture: Picture, story: Story, path: str, color: Color) -> None:
    """The orbit of each row: one circle, moved, turned and stretched to it, or lines where some orbit is open."""
    run, width = story.samples.run, 0.8 * style.WIDTH["recent"]
    if np.all(run.elements.eccentricity < 1):
        picture.log_lines(path, [circle(CIRCLE)], color, width)
        inertial = np.broadcast_to(np.eye(3), story.samples.axes.shape)
        picture.log_pose(path, story.index, **rings(run, inertial, story.frame))
        return
    picture.log_strip_style(path, color, width)
    picture.log_strips(path, story.index, orbits(run, story.frame))


def log_unknown(picture: Picture, story: Story, top: str, colors: dict[str, Color]) -> None:
    """Dashes from row to row where there is no data, or where none tells the way: it led from here to there."""
    rows = np.union1d(story.breaks, story.unknown).astype(int)
    if not len(rows) or story.setting.resolved.get("kind") != "trajectory":
        return
    run, length = story.samples.run, story.frame.unit
    strips = [dash for row in rows.tolist() for dash in dashes(run.position[row : row + 2], run.velocity[row])]
    picture.log_lines(f"{top}/trail/unknown", [dash / length for dash in strips], colors["past"], style.WIDTH["future"])


def dashes(ends: np.ndarray, velocity: np.ndarray) -> list[np.ndarray]:
    """Pieces (k, 3) m, every other one of a curve between two places (2, 3) m round the centre, the way that a velocity
    (3,) m/s goes round: angle, distance and height over the plane of motion go evenly from one to the other."""
    normal = unit(np.cross(ends[0], velocity))
    ahead = np.cross(normal, unit(ends[0]))
    out, high = ends @ np.stack([unit(ends[0]), ahead]).T, ends @ normal
    turn = float(np.mod(np.arctan2(out[1, 1], out[1, 0]), 2 * np.pi))
    far = np.linalg.norm(out, axis=1)
    pieces = 2 * max(int(np.ceil(DASHES * turn / (2 * np.pi))), LEAST_DASHES) + 1
    share = np.linspace(0, 1, 3 * pieces + 1)
    distance, angle = far[0] + share * (far[1] - far[0]), share * turn
    flat = np.cos(angle)[:, None] * unit(ends[0]) + np.sin(angle)[:, None] * ahead
    curve = distance[:, None] * flat + (high[0] + share * (high[1] - high[0]))[:, None] * normal
    curve[[0, -1]] = ends
    return [curve[3 * k : 3 * k + 4] for k in range(0, pieces, 2)]


def colors_of_phases(story: Story, ends: np.ndarray, part: str) -> np.ndarray:
    """(p,) 0xRRGGBBAA of pieces that end at rows (p,): of the phase in which each begins."""
    known = [trail_colors(color)[part] for _, color in words_and_colors(story.setting)]
    begins = np.concatenate([[0], ends[:-1]])
    return np.array([style.rgba(known[k]) for k in story.setting.phase_of(story.time[begins])], np.uint32)


def pieces_of(story: Story, strip: int = STRIP) -> tuple[np.ndarray, list[list[np.ndarray]]]:
    """Rows (p,) at which pieces end, and the lines (k, 3) of each: through all of its rows, broken where there is no
    data, and where nothing leads from row to row the next one's orbit of the moment. strip : drawn rows in one."""
    samples, smooth = story.samples, story.frame.smooth
    line = smooth_lines(samples.run.time, samples.position, samples.velocity, smooth)
    last = len(samples) - 1
    starts = np.arange(0, max(last, 1), strip)
    if story.setting.phases:
        switched = rows_at_switches(story.setting, story.time)
        starts = np.union1d(starts, switched[switched < max(last, 1)])
    ends = np.append(starts[1:], last)
    broken = {*story.breaks.tolist(), *story.unknown}
    return ends, [drawn(story, line, broken, a, b) for a, b in zip(starts.tolist(), ends.tolist(), strict=True)]


def drawn(story: Story, line: np.ndarray, broken: set[int], start: int, end: int) -> list[np.ndarray]:
    """The lines from row `start` to row `end`. line : the cubics through all rows."""
    pieces, ways = story.frame.smooth, story.ways
    lines, now = [], [line[start * pieces][None]]
    for k in range(start, end):
        after = line[(k + 1) * pieces][None]
        if k in broken or k in ways.open:
            lines += [now, [ways.open[k]]] if k in ways.open and k not in broken else [now]
            now = [after]
        elif k in ways.lines:
            now.append(ways.lines[k][0][1:])
        else:
            now.append(line[k * pieces + 1 : (k + 1) * pieces + 1])
    joined = [np.concatenate(part) for part in [*lines, now]]
    # a row on its own, with no way to it or from it, is drawn as a dot; at the start of a piece it has been drawn
    alone = [k for k, part in enumerate(joined) if len(part) == 1]
    kept = [part for k, part in enumerate(joined) if k not in alone or (k > 0 or start == 0 or len(joined) == 1)]
    return [part.repeat(2, axis=0) if len(part) == 1 else part for part in kept if len(part)]
