"""The close-up: the craft in the line of the light, what falls on it, what it throws back, pushes it, where it flies.

/sail has x along the line of the light, which round the Sun is the orbital frame (near.py). The craft is about ten
across. The push is 7.5 long plus the root of its share of the largest, so that a weak one is still seen.
"""

from __future__ import annotations

import numpy as np
import rerun as rr

from sailviz.frames import quaternion, unit
from sailviz.recording.drawing import cameras, lit_shape, style
from sailviz.recording.drawing.cameras import Camera
from sailviz.recording.drawing.craft import Glow, log_stowing
from sailviz.recording.drawing.layout import Space
from sailviz.recording.drawing.log import Color, Picture, f4
from sailviz.recording.drawing.names import Names
from sailviz.recording.drawing.phrases import push_words
from sailviz.recording.drawing.shares import log_close_shares, own_on
from sailviz.recording.drawing.sky import log_stars
from sailviz.recording.drawing.story import Story

RAY = 8.0  # length of what falls in
MIRRORED = 6.0
ON_FILM = ((-2.6, -2.0), (-2.6, 2.2), (0.4, 0.0), (2.6, -2.3), (2.6, 2.2))  # where rays end, y and z
ON_WHEEL = ((-5.0, -4.0), (-5.0, 4.0), (0.0, 0.0), (5.0, -4.0), (5.0, 4.0), (0.0, 6.5), (0.0, -6.5))
EDGE_ON = 0.15  # cosine below which a ray's end is not carried on
FARTHEST = 7.0  # from the plane y, z that a ray may end
BEFORE = 0.25  # above the film, so that an arrow's head is seen
SHORT, LONGER = 7.5, 4.5  # length of the push
VELOCITY, PRIMER, NORMAL = 9.0, 9.0, 8.0
ANGLE, ANGLE_NAME = 6.2, 7.4  # radii of the fan and of its number
CLOCK = 7.0  # distance at which the clock angle's circle stands
ARC = 9  # points of an arc
ROUND, ARC_ROUND = 31, 21  # points of the clock angle's circle, and of its arc
PUSH, NUMBER, ARROW, FLOW = range(4)  # what matters more has the lower rank
HIGH = {0: 380.0, 1: 380.0, 2: 315.0, 3: 260.0}  # pixels of the view
ASPECT = {0: 590 / 380, 1: 590 / 380, 2: 590 / 315, 3: 590 / 260}  # of the view, by what stands below it; 3 is bars
FILL = 0.78


def log_close_up(picture: Picture, story: Story, below: int) -> Space:
    """Write /sail -> its view. below : how many plots stand under it, 3 for a plot and bars."""
    picture.log_static("/sail", rr.ViewCoordinates.RIGHT_HAND_Z_UP)
    log_stars(picture, "/sail/stars", 900.0, 500)
    log_body(picture, story)
    eye = eye_of(story)
    length, names = push_length(story), Names(story, (ASPECT[below] * HIGH[below], HIGH[below]))
    lever = lit_shape.lever_of(story)
    acts = np.zeros_like(length) if lever is None else lever.centre * np.any(length, axis=1, keepdims=True)
    log_arrow(picture, story, "push", style.PUSH, length, style.WIDTH["close push"], None if lever is None else acts)
    add_name(names, "push", style.PUSH, acts + beyond(length, eye, 2.6), push_words(story.push), PUSH)
    if lever is not None and lit_shape.turns(story, lever):
        log_torque(picture, story, eye, names, lever)
    log_close_shares(picture, story, names, length, SHORT + LONGER)
    velocity = VELOCITY * story.near.velocity
    log_arrow(picture, story, "velocity", style.SPEED, velocity, style.WIDTH["close arrow"])
    add_name(names, "velocity", style.SPEED, beyond(velocity, eye, 1.0), "flies this way", ARROW)
    if story.craft.flow_word and story.near.by_light:
        log_flow(picture, story, eye, names)
    if story.craft.has_angles and (story.craft.facing or story.craft.slanted):
        log_angle(picture, story, names)
        if story.about("clock"):
            log_clock(picture, story, names)
    primer = story.near.primer
    if primer is not None and story.about("primer"):
        log_arrow(picture, story, "primer", style.PRIMER, PRIMER * primer, style.WIDTH["close arrow"])
        add_name(names, "primer", style.PRIMER, beyond(PRIMER * primer, eye, 1.0), "primer", ARROW)
    at, target = cameras.fit(places_in_sight(story, acts + length, velocity), eye, ASPECT[below], FILL)
    name = f"{story.craft.close_name or story.setting.craft.label or 'Craft'} close up"
    name += ": what pushes it" if story.most > 0 else ""
    camera = Camera(name, "/sail", tuple(at.tolist()), tuple(target.tolist()))
    names.write(picture, camera)
    return Space(camera, ("+ /sail/**",))


def log_body(picture: Picture, story: Story) -> None:
    """The craft in its attitude."""
    samples, craft = story.samples, story.craft
    picture.log_pose("/sail/body", story.index, quaternion=quaternion(story.near.body))
    if lit_shape.is_lit(story):
        lit_shape.log_facets(picture, story, "/sail/body/shape/facets")
    else:
        craft.log_shape(picture, "/sail/body/shape", True)
    picture.log_scale("/sail/body/shape", craft.close_size)
    log_stowing(picture, "/sail/body/shape", craft, story.index, story.stowed, True)
    Glow(picture, "/sail/body", craft).add(samples.index_of, own_on(samples.run))


def push_length(story: Story) -> np.ndarray:
    """(n, 3) the arrow of the push; nothing where nothing pushes."""
    share = story.push / story.most if story.most > 0 else story.push
    length = np.where(share > 0, SHORT + LONGER * np.sqrt(share), 0.0)
    return np.asarray(length[:, None] * unit(story.near.thrust))


def log_arrow(
    picture: Picture,
    story: Story,
    name: str,
    color: Color,
    vectors: np.ndarray,
    width: float,
    origins: np.ndarray | None = None,
) -> None:
    """An arrow from the middle, or from origins (n, 3), unless it is never there."""
    if np.any(vectors):
        picture.log_arrow_style(f"/sail/{name}", color, width)
        picture.log_arrows(f"/sail/{name}", story.index, vectors, origins)


def log_torque(picture: Picture, story: Story, eye: np.ndarray, names: Names, lever: lit_shape.Lever) -> None:
    """The torque of the light on a shape, from the point about which it turns."""
    arrows, color = lit_shape.torque_arrows(lever.torque), style.QUANTITY["torque"]
    log_arrow(picture, story, "torque", color, arrows, style.WIDTH["close arrow"], lever.about)
    place = lever.about + beyond(arrows, eye, 1.2)
    add_name(names, "torque", color, place, lit_shape.torque_words(lever.torque), ARROW)


def add_name(names: Names, name: str, color: Color, place: np.ndarray, words: str | list[str], rank: int) -> None:
    """A name beyond an arrow's tip."""
    if np.any(np.isfinite(place)):
        names.add(f"/sail/{name}_name", words, color, place, rank)


def beyond(arrows: np.ndarray, eye: np.ndarray, gap: float) -> np.ndarray:
    """Places (n, 3) past the tips of arrows by `gap`, outwards as the eye (3,) sees it; NaN where there is no arrow."""
    flat = arrows - (arrows @ eye)[:, None] * eye
    there = np.any(arrows, axis=1, keepdims=True)
    return np.where(there, arrows + gap * unit(flat), np.nan)


def log_flow(picture: Picture, story: Story, eye: np.ndarray, names: Names) -> None:
    """Light that ends on the film and leaves it mirrored, or the wind through a wheel. No mirror is perfect: what is
    drawn is the direction, not how much."""
    film, normal = story.craft.facing, story.near.normal
    hits = np.array(ON_FILM if film else ON_WHEEL)
    steep = np.where(np.abs(normal[:, :1]) < EDGE_ON, EDGE_ON, normal[:, :1])
    depth = -(normal[:, 1:2] * hits[:, 0] + normal[:, 2:] * hits[:, 1]) / steep
    ends = np.empty((len(normal), len(hits), 3))
    ends[..., 0] = np.clip(depth, -FARTHEST, FARTHEST) - BEFORE
    ends[..., 1:] = hits
    word, color = story.craft.flow_word, story.craft.flow_color
    starts = ends - [RAY, 0.0, 0.0]
    counts = [len(hits)] * len(normal)

    def rays(path: str, origins: np.ndarray, vectors: np.ndarray, shade: Color, width: float) -> None:
        picture.log_arrow_style(path, shade, width)
        columns = rr.Arrows3D.columns(origins=f4(origins.reshape(-1, 3)), vectors=f4(vectors))
        picture.log_columns(path, story.index, columns.partition(counts))

    falling = np.tile([RAY, 0.0, 0.0], (len(normal) * len(hits), 1))
    rays("/sail/flow", starts, falling, style.dim(color, 0.8), style.WIDTH["flow"])
    if film:
        light = np.array([1.0, 0.0, 0.0])
        back = np.where(story.stowed[:, None], 0.0, light - 2 * normal[:, :1] * normal)
        rays("/sail/mirrored", ends, np.repeat(MIRRORED * back, len(hits), axis=0), style.MIRRORED, 1.0)
    middle = starts.mean(0)
    top = unit(np.cross(eye, unit(np.cross([0.0, 0.0, 1.0], eye))))
    spots = [place + 1.4 * top for place in middle[np.argsort(-(middle @ top))]]
    spots += [place - 0.5 * top for place in middle[np.argsort(middle @ top)]]
    names.add("/sail/flow_name", flow_words(word), color, spots[0], FLOW, spots[1:])


def flow_words(word: str) -> str:
    """What falls in, by its name."""
    return {"wind": "solar wind"}.get(word, word)


def log_angle(picture: Picture, story: Story, names: Names) -> None:
    """The sail's angle as a fan on the sunward side, between the ray and the normal, with its number."""
    normal, index, count = story.near.normal, story.index, len(story.time)
    picture.log_lines("/sail/radial", [[[-10, 0, 0], [11, 0, 0]]], style.RADIAL, style.WIDTH["helper"])
    picture.log_arrow_style("/sail/normal", style.NORMAL, 0.9)
    picture.log_arrows("/sail/normal", index, -NORMAL * normal)
    out = np.tile([1.0, 0.0, 0.0], (count, 1))
    directions = arcs(out, normal)
    out_there = ~story.stowed  # a stowed sail has no angle
    fan = -ANGLE * directions * out_there[:, None, None]
    picture.log_strip_style("/sail/angle/arc", style.SUN, style.WIDTH["arc"])
    picture.log_strips("/sail/angle/arc", index, fan)
    k = np.arange(1, ARC)
    picture.log_triangles("/sail/angle/fan", np.stack([0 * k, k, k + 1], 1).astype(np.uint32), [*style.SUN, 34])
    corners = np.concatenate([np.zeros((count, 1, 3)), fan], 1)
    columns = rr.Mesh3D.columns(vertex_positions=f4(corners.reshape(-1, 3))).partition([ARC + 1] * count)
    picture.log_columns("/sail/angle/fan", index, columns)
    angles = np.degrees(story.samples.run.attitude.pitch)
    texts = [f"{angle:.0f}°" if np.isfinite(angle) else "" for angle in angles.tolist()]
    place = np.where(out_there[:, None], -ANGLE_NAME * directions[:, ARC // 2], np.nan)
    names.add("/sail/angle/name", texts, style.SUN, place, NUMBER)


def log_clock(picture: Picture, story: Story, names: Names) -> None:
    """The clock angle: on a circle about the line of the light, from where it is zero to the sail's normal."""
    attitude, index, length = story.samples.run.attitude, story.index, CLOCK * ~story.stowed
    pitch, clock = np.nan_to_num(attitude.pitch), np.nan_to_num(attitude.clock)
    axial, radius = length * np.cos(pitch), length * np.sin(pitch)
    zero = np.arctan2(story.near.normal[:, 1], story.near.normal[:, 2]) - clock  # of the clock, from z towards y
    zero = np.where(np.abs(np.sin(0.5 * zero)) < 1e-9, 0.0, zero)[:, None]

    def on_circle(angle: np.ndarray) -> np.ndarray:
        """Clock angles (n, k) -> (n, k, 3)."""
        x, turn = np.broadcast_to(axial[:, None], angle.shape), angle + zero
        return np.stack([x, radius[:, None] * np.sin(turn), radius[:, None] * np.cos(turn)], -1)

    full = np.tile(np.linspace(0, 2 * np.pi, ROUND), (len(story.time), 1))
    center = np.stack([axial, 0 * axial, 0 * axial], -1)[:, None]
    ends = [on_circle(0 * clock[:, None]), center, on_circle(clock[:, None])]
    for name, lines, color, width in (
        ("circle", on_circle(full), style.CLOCK_CIRCLE, style.WIDTH["helper"]),
        ("spokes", np.concatenate(ends, 1), style.CLOCK_CIRCLE, style.WIDTH["helper"]),
        ("arc", on_circle(clock[:, None] * np.linspace(0, 1, ARC_ROUND)), style.QUANTITY["clock angle"], 1.8),
    ):
        picture.log_strip_style(f"/sail/clock/{name}", color, width)
        picture.log_strips(f"/sail/clock/{name}", index, lines)
    place = on_circle(0.5 * clock[:, None])[:, 0] * [1.0, 1.3, 1.3] + np.stack(
        [0 * axial, 0 * axial, 0 * axial + 0.6], -1
    )
    place = np.where(story.stowed[:, None], np.nan, place)
    texts = [f"clock {round(value) % 360}°" for value in np.degrees(clock).tolist()]
    names.add("/sail/clock/name", texts, style.QUANTITY["clock angle"], place, NUMBER)


def eye_of(story: Story) -> np.ndarray:
    """From where the lit side, the push and the velocity are seen best."""
    some, near = story.moments, story.near
    normal, thrust = near.normal[some], unit(near.thrust[some])
    pushed = np.where(np.any(thrust, axis=1, keepdims=True), thrust, normal)
    weights = np.gradient(story.share[some]) if len(some) > 1 else np.ones(1)
    return cameras.fixed_eye(
        normal,
        pushed,
        np.maximum(weights, 1e-12),
        story.craft.facing,
        (12.0, 20.0, 28.0, 36.0),
        push=1.8,
        others=near.velocity[some],
        open=lit_shape.is_lit(story) or bool(story.setting.craft.cone or story.setting.craft.rise),
    )


def places_in_sight(story: Story, push: np.ndarray, velocity: np.ndarray) -> np.ndarray:
    """What must be seen, (k, 3)."""
    some = story.moments
    size = (1.02 if story.craft.slanted else 0.65) * story.craft.close_size  # of a wheel that is the radius
    axes = story.near.body[some]
    corners = [side * size * axes[..., k] for side in (-1, 1) for k in (0, 1)]
    rays = np.array([[-RAY, 2.0, 2.0], [-RAY, -2.0, -2.0]])
    return np.concatenate([*corners, 1.15 * push[some], rays, 1.3 * velocity[some]])


def arcs(start: np.ndarray, end: np.ndarray) -> np.ndarray:
    """Great-circle arcs between unit vectors, (n, 3), (n, 3) -> (n, ARC, 3)."""
    across = end - np.sum(start * end, 1, keepdims=True) * start
    angle = np.arctan2(np.linalg.norm(across, axis=1), np.sum(start * end, 1))
    share = np.linspace(0, 1, ARC) * angle[:, None]
    points: np.ndarray = np.cos(share)[..., None] * start[:, None] + np.sin(share)[..., None] * unit(across)[:, None]
    return points
