"""The axis of a craft that turns, on the unit sphere of directions: where it has pointed, points and will point, with
the directions of its angular momentum and of the light.

/axis is inertial, as the rows are, however a low orbit may be slowed elsewhere. Where the light goes round, the eye
goes along with it.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import rerun as rr

from sailviz.frames import rotation, unit
from sailviz.recording.drawing import cameras, style
from sailviz.recording.drawing.cameras import Camera
from sailviz.recording.drawing.craft import Glow
from sailviz.recording.drawing.layout import SO_FAR, TO_COME, Space, Span
from sailviz.recording.drawing.log import Color, Picture, f4
from sailviz.recording.drawing.names import MAIN, Names
from sailviz.recording.drawing.near import LIGHTS
from sailviz.recording.drawing.planet import about_axis
from sailviz.recording.drawing.shares import own_on
from sailviz.recording.drawing.story import Story
from sailviz.recording.drawing.style import points
from sailviz.shapes.primitives import ball, circle

MOVES = np.radians(1.0)  # from where it began, less than which an axis says nothing
FAST = np.radians(40.0)  # between most drawn rows, from which a line between them would be made up
PIECE = np.radians(4.0)  # of a great circle between rows that is drawn straight
MOST_PIECES = 12  # between two rows
STRIP = 4  # drawn rows in one piece of the trace
GLOBE = 0.985  # radius of the sphere below the trace
GOES_ROUND = np.radians(30.0)  # from which on the eye follows the light
LEVEL = 0.5  # sine of the light's height over the plane x, y, up to which it goes round the z axis
AXIS, LIGHT, MOMENTUM = 1.0, 1.22, 1.36  # lengths of the arrows
NAME = 0.13  # beyond an arrow's tip
RESTING = 1e-6  # of the largest angular momentum, below which it has no direction
PARALLELS, MERIDIANS, ROUND = (-60.0, -30.0, 0.0, 30.0, 60.0), 12, 73
BODY = 0.06  # of its size in the close-up, the craft in the middle
ASIDE = (590.0, 250.0)  # pixels of the view below the close-up in a window of 1600 x 900
STILL = 0.1  # revolutions, up to which an orbit says less than the axis does
ELEVATIONS = (15.0, 25.0, 35.0)  # deg, of eyes that are tried
WORD = "Where the craft's axis points"
TRACE = "the **sphere** is of directions: the cyan line is where the sail's axis has pointed, the dim one where it will"


def has_axis(story: Story) -> bool:
    """Whether the craft turns by itself, and its axis, or that of flights beside it, moves so much that it is seen."""
    attitude = story.told.samples.run.attitude
    if not attitude.motion or len(story.told.time) < 3:
        return False
    if story.setting.attitude_ensembles:
        return True
    axis = axis_of(story)
    return bool(np.min(axis @ axis[0]) < np.cos(MOVES))


def axis_of(story: Story) -> np.ndarray:
    """(n, 3) z of the body in each row, inertial."""
    found: np.ndarray = rotation(story.told.samples.run.attitude.quaternion)[..., 2]
    return found


def light_of(story: Story) -> np.ndarray | None:
    """(n, 3) along the light in each row, inertial; None where nothing shines."""
    run = story.told.samples.run
    if story.frame.sun:
        return unit(run.position)
    light = next((run.bodies[name] for name in LIGHTS if name in run.bodies), None)
    return None if light is None else unit(run.position - light)


def in_front(story: Story) -> bool:
    """Whether the axis is what a flight shows first: round the Sun in hours."""
    return story.frame.sun and story.turns < STILL


def log_axis(picture: Picture, story: Story) -> tuple[Space, dict[str, Span]]:
    """Write /axis -> its view, and which part of the run each part of the trace shows."""
    view = MAIN if in_front(story) else ASIDE
    story = story.told
    axis, light = axis_of(story), light_of(story)
    momentum = story.samples.run.attitude.motion["angular_momentum_N_m_s"]
    size = np.linalg.norm(momentum, axis=1)
    spun = np.where((size > RESTING * size.max())[:, None], unit(momentum), 0.0)
    picture.log_static("/axis", rr.ViewCoordinates.RIGHT_HAND_Z_UP)
    log_globe(picture)
    log_middle(picture, story)
    spans = log_trace(picture, story, axis)
    turn = turn_with(light, len(axis))
    if np.any(turn):
        picture.log_pose("/axis/pan", story.index, quaternion=about_axis(turn))
    names = Names(story, view)
    log_direction(
        picture, story, names, "now", "sail's axis" if story.craft.facing else "axis", style.CRAFT, AXIS * axis
    )
    if light is not None:
        log_direction(picture, story, names, "light", "away from the Sun", style.SUN, LIGHT * light)
        if np.min(light @ light[0]) < np.cos(MOVES):
            picture.log_lines("/axis/light_way", [light], style.SUN_LINE, style.WIDTH["helper"])
    if size.max() > 0:
        color = style.QUANTITY["momentum"]
        log_direction(picture, story, names, "momentum", "angular momentum", color, MOMENTUM * spun)
    eye = eye_of(story, axis, light, spun, turn)
    tips = [MOMENTUM * spun, *([] if light is None else [LIGHT * light])]
    seen = [1.08 * sphere_points(), *(1.08 * seen_along(story, vectors, turn) for vectors in tips)]
    at, target = cameras.fit(np.concatenate(seen), eye, view[0] / view[1], 0.94)
    origin = "/axis/pan" if np.any(turn) else "/axis"
    camera = Camera(WORD, origin, tuple(at.tolist()), tuple(target.tolist()))
    names.write(picture, camera, turn)
    return Space(camera, ("+ /axis/**",)), spans


def log_globe(picture: Picture) -> None:
    """The far side of the sphere of directions, dark, and all of its parallels and meridians every 30 degrees."""
    picture.log_mesh("/axis/globe", ball(24, 48, GLOBE), style.DIRECTIONS, shaded=False, side="back")
    ring = circle(ROUND)
    lines = [np.cos(np.radians(high)) * ring + [0.0, 0.0, np.sin(np.radians(high))] for high in PARALLELS]
    for turn in np.arange(MERIDIANS // 2) * 2 * np.pi / MERIDIANS:
        lines.append(ring[:, :1] * [np.cos(turn), np.sin(turn), 0.0] + ring[:, 1:2] * [0.0, 0.0, 1.0])
    picture.log_lines("/axis/grid", lines, style.GRID, style.WIDTH["ladder"])


def log_middle(picture: Picture, story: Story) -> None:
    """The craft in its attitude, in the middle."""
    craft, attitude = story.craft, story.samples.run.attitude
    picture.log_pose("/axis/body", story.index, quaternion=attitude.quaternion)
    craft.log_shape(picture, "/axis/body/shape", False)
    picture.log_scale("/axis/body/shape", BODY * craft.close_size)
    Glow(picture, "/axis/body", craft).add(story.samples.index_of, own_on(story.samples.run))


def log_trace(picture: Picture, story: Story, axis: np.ndarray) -> dict[str, Span]:
    """Where the axis (n, 3) has been and will be: arcs of great circles, or dots where rows lie so far apart that none
    is known."""
    last = len(axis) - 1
    starts = np.arange(0, last, STRIP)
    ends = np.append(starts[1:], last)
    index = story.samples.index_of(ends)
    fast = is_fast(story)
    for part, color in (("past", style.TRAIL_RECENT), ("future", style.TRAIL_FUTURE)):
        path = f"/axis/trace/{part}"
        if fast:
            dots = [axis[a : b + (b == last)] for a, b in zip(starts.tolist(), ends.tolist(), strict=True)]
            picture.log_static(path, rr.Points3D.from_fields(radii=points(style.FLIGHT_DOT), colors=[color]))
            columns = rr.Points3D.columns(positions=f4(np.concatenate(dots)))
            picture.log_columns(path, index, columns.partition([len(dot) for dot in dots]))
            continue
        picture.log_strip_style(path, color, style.WIDTH["past" if part == "past" else "future"])
        lines = [[arcs(axis[a : b + 1])] for a, b in zip(starts.tolist(), ends.tolist(), strict=True)]
        picture.log_broken_strips(path, index, lines)
    return {"/axis/trace/past": SO_FAR, "/axis/trace/future": TO_COME}


def is_fast(story: Story) -> bool:
    """Whether the axis turns so far between most rows that nothing is known of its way: by the body's rate across it,
    since a row may find it where it was after many turns."""
    across = np.linalg.norm(story.samples.run.attitude.motion["rate_rad_s"][:, :2], axis=1)
    return bool(np.median(0.5 * (across[1:] + across[:-1]) * np.diff(story.time)) > FAST)


def arcs(directions: np.ndarray) -> np.ndarray:
    """(m, 3) points on the great circles from each of directions (k, 3) to the next."""
    found = [directions[:1]]
    for one, other in pairwise(directions):
        angle = float(np.arctan2(np.linalg.norm(np.cross(one, other)), one @ other))
        pieces = int(np.clip(np.ceil(angle / PIECE), 1, MOST_PIECES))
        share = (np.arange(1, pieces + 1) / pieces)[:, None]
        across = unit(other - (one @ other) * one)
        found.append(np.cos(share * angle) * one + np.sin(share * angle) * across)
    return np.concatenate(found)


def log_direction(
    picture: Picture, story: Story, names: Names, name: str, words: str, color: Color, vectors: np.ndarray
) -> None:
    """An arrow from the centre and its name, none where a vector (n, 3) is 0."""
    picture.log_arrow_style(f"/axis/{name}", color, style.WIDTH["close arrow"])
    picture.log_arrows(f"/axis/{name}", story.index, vectors)
    place = np.where(np.any(vectors, axis=1, keepdims=True), vectors + NAME * unit(vectors), np.nan)
    names.add(f"/axis/{name}_name", words, color, place, ("now", "light", "momentum").index(name))


def turn_with(light: np.ndarray | None, count: int) -> np.ndarray:
    """(n,) rad by which the eye has gone round the z axis with the light; zeros where it does not."""
    if light is None:
        return np.zeros(count)
    angle = np.unwrap(np.arctan2(light[:, 1], light[:, 0]))
    level = np.abs(light[:, 2]).max() < LEVEL
    return np.asarray((angle - angle[0]) * float(level and np.ptp(angle) > GOES_ROUND))


def eye_of(story: Story, axis: np.ndarray, light: np.ndarray | None, spun: np.ndarray, turn: np.ndarray) -> np.ndarray:
    """The direction (3,) from which the trace is in front, and the arrows are seen at a slant."""
    eyes = cameras.directions(ELEVATIONS)

    def followed(vectors: np.ndarray) -> np.ndarray:
        return seen_along(story, vectors, turn)

    front = eyes @ followed(axis).T
    score = np.interp(front, [-1.0, 0.0, 0.3, 0.5, 0.75, 1.0], [-1.0, -0.3, 0.8, 1.0, 1.0, 0.3]).mean(axis=1)
    score = score + 0.3 * cameras.across(eyes, followed(spun), 0.8).mean(axis=1)
    if light is not None:  # from left to right
        shines, right = followed(light), unit(np.cross([0.0, 0.0, 1.0], eyes))
        score = score + (0.5 * cameras.across(eyes, shines, 0.8) + 0.2 * (right @ shines.T)).mean(axis=1)
    best: np.ndarray = eyes[np.argmax(score)]
    return best


def seen_along(story: Story, vectors: np.ndarray, turn: np.ndarray) -> np.ndarray:
    """Vectors (n, 3) at the moments by which a camera is judged, for an eye that has gone round by `turn` (n,) rad."""
    c, s = np.cos(turn), np.sin(turn)
    x, y, z = vectors.T
    return np.asarray(np.stack([c * x + s * y, c * y - s * x, z], 1)[story.moments])


def sphere_points() -> np.ndarray:
    """Points on the unit sphere, (k, 3)."""
    return cameras.directions(np.arange(-90.0, 91.0, 15.0), 15.0)
