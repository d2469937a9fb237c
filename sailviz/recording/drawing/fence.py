"""The push along the way: a wall on the trail whose height and brightness say how hard, and whose lean which way.

It is there from the first frame, faint where it is still to be flown. Past and future are two entities with the same
pieces, each stamped at its last time, of which the view shows the rows before and after the cursor.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import rerun as rr

from sailviz.frames import unit
from sailviz.recording.drawing import style
from sailviz.recording.drawing.layout import SO_FAR, TO_COME, Span
from sailviz.recording.drawing.log import Picture, f4
from sailviz.recording.drawing.samples import TURNS
from sailviz.recording.drawing.story import Story

PIECES = 60
PIECES_OF_TURNS = 360  # of a flight of which only the last turn has a wall
ROWS = 1010  # of the wall, at most
ALONG = 0.35  # of the thrust: what is across the trail by less than this leans along it
HIGH, RING_HIGH, LEAST_HIGH = 0.17, 0.11, 0.07  # of S, at the largest push
MANY_TIMES = 3.0  # largest push over the median from which heights are roots
STEADY = 0.02  # relative change of the push below which it has one brightness
STEADY_SHARE = 0.72
FOOT = 0.30  # brightness at the trail
ALPHA = {"past": 112, "future": 30, "ring": 80}


@dataclass(frozen=True)
class Fence:
    """base, top : (n, 3) view units; strength (n,) 0 to 1; row (n,) of the story's rows, -1 for points between two rows
    that lie far apart. parts : (start, end) of the stretches without a gap, points start to end - 1."""

    base: np.ndarray
    top: np.ndarray
    strength: np.ndarray
    row: np.ndarray
    parts: list[tuple[int, int]]


def fence_of(story: Story) -> Fence | None:
    """The wall of a flight; None where nothing pushes."""
    story = story.told
    if story.most <= 0 or not np.any(np.linalg.norm(story.thrust, axis=1) > 0):
        return None
    count = story.once_round
    row = np.unique(np.linspace(0, count - 1, min(count, ROWS)).astype(int))
    push = story.push[row]
    reached = push.max() or 1.0
    size = push / reached
    if reached > MANY_TIMES * np.median(push):
        size = np.sqrt(size)
    steady = np.ptp(push) <= STEADY * reached
    strength = np.full(len(row), STEADY_SHARE) if steady else push / reached
    lift = high(story) * story.reach * size[:, None] * leaning(story)[row]
    return standing(story, row, lift, strength)


def standing(story: Story, row: np.ndarray, lift: np.ndarray, strength: np.ndarray) -> Fence:
    """The wall over rows (n,), lift (n, 3). Between rows far apart it follows the trail, its height and brightness
    going evenly from one to the other; where there is no data there is none.
    """
    ends = np.union1d(story.breaks, story.unknown)
    edges = set(np.searchsorted(row, ends, side="right").tolist())
    base, top, bright, rows, parts, begun, count = [], [], [], [], [], 0, 0
    for k in range(len(row)):
        if k in edges and k > 0:
            parts.append((begun, count))
            begun = count
        elif k > 0 and row[k] == row[k - 1] + 1 and row[k - 1] in story.ways.lines:
            line, share = (part[1:-1][::2] for part in story.ways.lines[int(row[k - 1])])  # half of what the trail has
            between = lift[k - 1] + share[:, None] * (lift[k] - lift[k - 1])
            base.append(line)
            top.append(line + between)
            bright.append(strength[k - 1] + share * (strength[k] - strength[k - 1]))
            rows.append(np.full(len(line), -1))
            count += len(line)
        place = story.position[row[k]][None]
        base.append(place)
        top.append(place + lift[k])
        bright.append(strength[k : k + 1])
        rows.append(row[k : k + 1])
        count += 1
    parts.append((begun, count))
    foot, crest, shade, numbers = (np.concatenate(part) for part in (base, top, bright, rows))
    return Fence(foot, crest, shade, numbers, parts)


def high(story: Story) -> float:
    """Height at the largest push, of S: half of the gap between turns, so that turns do not hide each other."""
    if story.ring:
        return RING_HIGH
    if story.turns <= 1.5:
        return HIGH
    depth = (story.distance.max() - story.distance.min()) / max(story.turns - 0.5, 1.0) / story.reach
    return float(min(HIGH, max(0.5 * depth, LEAST_HIGH)))


def leaning(story: Story) -> np.ndarray:
    """(n, 3) unit vectors: where the thrust points or, where it lies along the trail, the orbit's normal."""
    ahead = unit(story.samples.velocity)
    thrust = unit(story.thrust)
    across = thrust - np.sum(thrust * ahead, 1, keepdims=True) * ahead
    pushing = story.push > 0
    if np.median(np.linalg.norm(across[pushing], axis=1)) >= ALONG:
        return np.asarray(thrust)
    return np.asarray(unit(np.cross(story.position, story.samples.velocity)))


def one_turn(story: Story) -> bool:
    """Whether only the last turn has a wall: those of very many turns would hide each other and the planet."""
    return story.frame.sparse and not story.ring


def fence_spans(story: Story) -> dict[str, Span]:
    """Which part of the run each part of the wall shows."""
    if story.ring:
        return {}
    spans: dict[str, Span] = {"past": SO_FAR, "future": TO_COME}
    if one_turn(story):
        spans = {"past": (-story.duration / min(TURNS, story.frame.turns), 0.0)}
    both = [(f"/world/fence/{part}", span) for part, span in spans.items()]
    return dict([*both, *((f"{path}/edge", span) for path, span in both)])


def log_fence(picture: Picture, story: Story, fence: Fence) -> None:
    """Write /world/fence."""
    story = story.told
    if story.ring:
        log_ring(picture, fence)
        return
    pairs = pieces_of(fence, PIECES_OF_TURNS if one_turn(story) else PIECES)
    if not pairs:
        return
    index = story.samples.index_of(fence.row[[b for _, b in pairs]])
    corners = [np.concatenate([fence.base[a : b + 1], fence.top[a : b + 1]]) for a, b in pairs]
    faces = [wall_faces(b - a + 1) for a, b in pairs]
    colors = [wall_colors(fence.strength[a : b + 1]) for a, b in pairs]
    edges = [f4(fence.top[a : b + 1]) for a, b in pairs]
    counts = [len(part) for part in corners]
    for part in ("past",) if one_turn(story) else ("past", "future"):
        path = f"/world/fence/{part}"
        columns = [
            *rr.Mesh3D.columns(
                vertex_positions=f4(np.concatenate(corners)), vertex_colors=np.concatenate(colors)
            ).partition(counts),
            *rr.Mesh3D.columns(triangle_indices=np.concatenate(faces)).partition([len(part) for part in faces]),
            *rr.Mesh3D.columns(albedo_factor=np.full(len(pairs), style.rgba((255, 255, 255), ALPHA[part]), np.uint32)),
        ]
        picture.log_columns(path, index, columns)
        picture.log_strip_style(f"{path}/edge", style.FENCE_EDGE[part], style.WIDTH[f"fence {part}"])
        picture.log_columns(f"{path}/edge", index, rr.LineStrips3D.columns(strips=edges))


def pieces_of(fence: Fence, count: int = PIECES) -> list[tuple[int, int]]:
    """The first and the last point of each piece, which are rows; a piece ends where there is a gap."""
    ends = np.flatnonzero(fence.row >= 0)
    cuts = np.unique(np.linspace(0, len(ends) - 1, count + 1).astype(int))
    marks = np.unique(np.concatenate([ends[cuts], *((start, end - 1) for start, end in fence.parts)])).astype(int)
    last = {end - 1 for _, end in fence.parts}
    return [(a, b) for a, b in pairwise(marks.tolist()) if a not in last]


def log_ring(picture: Picture, fence: Fence) -> None:
    """A ring is drawn once round, and stays."""
    corners = np.concatenate([fence.base, fence.top])
    faces = [ring_faces(a, b, len(fence.base)) for a, b in fence.parts]
    picture.log_static(
        "/world/fence/ring",
        rr.Mesh3D(
            vertex_positions=f4(corners),
            triangle_indices=np.concatenate(faces).astype(np.uint32),
            vertex_colors=wall_colors(fence.strength),
            albedo_factor=[255, 255, 255, ALPHA["ring"]],
        ),
    )
    edges = [fence.top[a:b] for a, b in fence.parts if b > a + 1]
    picture.log_lines("/world/fence/ring/edge", edges, style.FENCE_EDGE["ring"], style.WIDTH["fence ring"])


def ring_faces(start: int, end: int, count: int) -> np.ndarray:
    """Triangles (m, 3) of the stretch from point `start` to `end` - 1 of a wall of `count` points at its foot."""
    own = wall_faces(end - start).astype(int)
    return np.where(own >= end - start, own - (end - start) + count, own) + start


def wall_faces(count: int) -> np.ndarray:
    """Triangles (2 count - 2, 3) between `count` points at the foot and as many above them."""
    k = np.arange(count - 1)
    below, above = np.stack([k, k + 1, count + k], 1), np.stack([k + 1, count + k + 1, count + k], 1)
    return np.concatenate([below, above]).astype(np.uint32)


def wall_colors(strength: np.ndarray) -> np.ndarray:
    """Colours (2 n,) of the foot and of the top."""
    return np.concatenate([style.ramp(strength, style.PUSH_RAMP, FOOT), style.ramp(strength, style.PUSH_RAMP)])
