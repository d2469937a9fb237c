"""The push along the way: the wall on the trail, the still copies of the sail, the arrow and its name."""

from __future__ import annotations

import re

import numpy as np

from . import lit
from .craft import rim_of
from .facts import path_word, unit
from .measure import hue, same_direction, same_place, same_turn
from .now import PUSHES, told
from .outlines import outline, same_surface
from .picture import turn
from .seen import arrows, body, home, near, seen, shown, texts

RAMP = np.array([[74, 56, 140], [176, 60, 140], [255, 96, 72], [255, 176, 84]], float)  # weak to strong
FOOT = 0.30  # brightness of a wall at the trail
GHOSTS = 0.62  # of the craft's colours
SHORTEST_LONGEST = 0.17, 0.34  # of the reach: arrows; on a ring
ON_RING = 0.12, 0.24
OF_MANY_TURNS = 0.10, 0.20


def arrow_lengths(f) -> tuple[float, float]:
    """Of a weak push and of the strongest, of the reach."""
    if f.truth.slowed:
        return OF_MANY_TURNS
    return ON_RING if ring(f) else SHORTEST_LONGEST


def strength(f) -> np.ndarray:
    """(n,) m/s2."""
    return np.linalg.norm(f.truth.thrust, axis=1)


def walls(f, entity):
    """Foot and top (k, 3) of the wall's corners, and their colours (k, 3), piece by piece with the row at which each
    piece stands; of a ring one piece with row None."""
    pieces = []
    if f.picture.moves(entity, "Mesh3D:vertex_positions"):
        steps, _ = f.picture.rows(entity, "Mesh3D:vertex_positions")
        for step in steps:
            pieces.append((step, *wall(f, entity, step)))
    else:
        pieces.append((None, *wall(f, entity, 0)))
    return pieces


def wall(f, entity, step):
    points = f.picture.place(entity, "Mesh3D:vertex_positions", step)
    colors = f.picture.color(entity, "Mesh3D:vertex_colors", step)[:, :3].astype(float)
    half = len(points) // 2
    faces = np.asarray(f.picture.at(entity, "Mesh3D:triangle_indices", step))
    assert faces.max() == len(points) - 1
    assert len(faces) == 2 * (half - 1)
    return points[:half], points[half:], colors[:half], colors[half:]


def standing(f, entity, part):
    """The wall stands on the trail from row to row; its height goes with the push or its root, it leans as the thrust
    does or, where that lies along the trail, on the orbit's normal, and its colour is the strength of the push. Between
    rows far apart it follows the trail; over a gap there is none."""
    truth = f.truth
    done, feet, tops, colors = 0, [], [], []
    for step, foot, top, dark, bright in walls(f, entity):
        last = len(truth) - 1 if step is None else step
        at_row = (
            np.array([np.linalg.norm(truth.place / truth.length - p, axis=1).min() for p in foot]) < 1e-6 * truth.reach
        )
        if not at_row.all():
            between_feet(f, foot, top, at_row)
        foot, top, dark, bright = foot[at_row], top[at_row], dark[at_row], bright[at_row]
        rows = [int(np.argmin(np.linalg.norm(truth.place[done : last + 1] / truth.length - p, axis=1))) for p in foot]
        rows = np.array(rows) + done
        same_place(foot, truth.place[rows], truth.length)
        assert np.all(np.diff(rows) > 0)
        assert step is None or rows[0] == done or (done in truth.breaks and rows[0] == done + 1)
        assert not any(rows[0] <= row < rows[-1] for row in truth.breaks), "a wall over a gap"
        assert step is None or rows[-1] == step
        assert np.abs(dark - FOOT * bright).max() < 1.5
        feet.append(rows)
        tops.append(top - foot)
        colors.append(bright)
        done = last
    rows, height, color = np.concatenate(feet), np.concatenate(tops), np.concatenate(colors)
    push = strength(f)
    assert part == "ring" or rows[-1] == len(truth) - 1
    leaning(f, rows, height)
    tall = np.linalg.norm(height, axis=1)
    share = push[rows] / push[rows].max()
    expected = [share * tall.max(), np.sqrt(share) * tall.max()]
    assert min(np.abs(tall - e).max() for e in expected) < 1e-5 * truth.reach
    assert 0.05 * scene_reach(f) < tall.max() < 0.2 * scene_reach(f)
    steady = np.ptp(push[rows]) <= 0.02 * push[rows].max()
    told = np.full(len(rows), 0.72) if steady else share
    ramp = np.stack([np.interp(told, np.linspace(0, 1, 4), RAMP[:, k]) for k in range(3)], 1)
    assert np.abs(color - ramp).max() < 1.5


def between_feet(f, foot, top, at_row):
    """Points between rows: on the trail, as high as between the rows beside them."""
    trail = np.concatenate([line for step in f.truth.steps for line in own_lines(f, "/world/trail/past", step)])
    for k in np.flatnonzero(~at_row):
        assert np.linalg.norm(trail - foot[k], axis=1).min() < 1e-6 * f.truth.reach, "a wall beside the trail"
        a, b = np.flatnonzero(at_row[:k])[-1], k + np.flatnonzero(at_row[k:])[0]
        low, high = np.sort(np.linalg.norm((top - foot)[[a, b]], axis=1))
        bent = (
            np.linalg.norm(unit((top - foot)[a]) + unit((top - foot)[b])) / 2
        )  # of two that lean apart the mean is shorter
        assert (0.9 * bent - 0.05) * low <= np.linalg.norm(top[k] - foot[k]) <= 1.001 * high


def own_lines(f, entity, step):
    """The lines that are logged at a step itself."""
    return f.picture.line(entity, step) if step in f.picture.rows(entity, "LineStrips3D:strips")[0] else []


def leaning(f, rows, height):
    """Along the thrust all along, or along the normal of the orbit all along."""
    pushed = strength(f)[rows] > 1e-6 * strength(f).max()
    thrust = f.truth.carried(f.truth.thrust)[rows]
    normal = unit(np.cross(f.truth.position, f.truth.velocity))[rows]
    off = [np.linalg.norm(np.cross(unit(height[pushed]), unit(way[pushed])), axis=1).max() for way in (thrust, normal)]
    assert min(off) < 1e-3
    sense = (thrust, normal)[int(np.argmin(off))]
    assert (np.sum(height[pushed] * sense[pushed], 1) > 0).all()


def edge(f, entity, part):
    """The top of the wall, piece by piece."""
    for (step, _, top, _, _), line in zip(walls(f, entity.rsplit("/", 1)[0]), edges(f, entity), strict=True):
        same_place(line, top)
        assert step is None or step >= 0


def edges(f, entity):
    if not f.picture.moves(entity, "LineStrips3D:strips"):
        return f.picture.line(entity, 0)
    steps, _ = f.picture.rows(entity, "LineStrips3D:strips")
    return [f.picture.line(entity, step)[0] for step in steps]


def ghost(f, entity, name):
    """Copies of the sail on the trail, each in the attitude that it had there, spread over the way."""
    if name == "wheels":
        return wheels(f, entity)
    places = np.asarray(f.picture.fixed(entity, "InstancePoses3D:translations"), float)
    turns = np.array([turn(q) for q in f.picture.fixed(entity, "InstancePoses3D:quaternions")])
    scales = np.asarray(f.picture.fixed(entity, "InstancePoses3D:scales"), float)
    rows = rows_of(f, places)
    own = outline(f)
    true = body_or_normal(f, turns, rows) if own is None else body(f, "/world")[rows]
    same_turn(turns, true, 1e-3)
    assert np.ptp(scales) < 1e-6 * scales.max()
    assert 0.03 * f.truth.reach < scales.max() < 0.12 * f.truth.reach
    if own is not None:
        points = np.asarray(f.picture.fixed(entity, "Mesh3D:vertex_positions"), float)
        same_surface(own, points * own.length, film=name in ("lit", "dark"))
    word = hue(f.picture.color(entity, "Mesh3D:albedo_factor")[0])
    if name in ("lit", "dark"):
        assert word == {"lit": "yellow", "dark": "blue"}[name]
        visible = {2: 1.0, 3: -1.0}[int(f.picture.fixed(entity, "Mesh3D:face_rendering")[0])]
        assert (visible * area_along_z(f, entity) < 0) == (name == "lit"), "the film is seen from its other side"
    return None


def area_along_z(f, entity) -> float:
    """z of a mesh's area vector, by the order of its corners."""
    points = np.asarray(f.picture.fixed(entity, "Mesh3D:vertex_positions"), float)
    corners = points[f.picture.fixed(entity, "Mesh3D:triangle_indices")]
    return float(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])[:, 2].sum())


def body_or_normal(f, turns, rows):
    """The true axes where they are drawn; about its normal a wheel or a square may be turned as it likes."""
    assert not f.truth.stowed[rows].any(), "a still copy of a sail that was stowed"
    normal = f.truth.carried(f.truth.normal)[rows]
    x = turns[..., 0] - np.sum(turns[..., 0] * normal, 1, keepdims=True) * normal
    x = unit(x)
    return np.stack([x, np.cross(normal, x), normal], -1)


def rows_of(f, places) -> np.ndarray:
    """Rows whose places these are, in order, no two the same."""
    drawn = f.truth.place / f.truth.length
    rows = np.array([int(np.argmin(np.linalg.norm(drawn - place, axis=1))) for place in places])
    same_place(places, f.truth.place[rows], f.truth.length)
    assert np.all(np.diff(rows) > 0)
    assert len(rows) >= min(len(f.truth) - 2, 6)
    return rows


def wheels(f, entity):
    """Rims and spokes of wheels across the normal of their place, or bent as their scene tells."""
    lines = f.picture.line(entity, 0)
    groups = [lines[k : k + 5] for k in range(0, len(lines), 5)]
    centres = np.array([group[1][len(group[1]) // 2] for group in groups])  # a spoke goes from rim to rim
    rows = rows_of_near(f, centres)
    normals = f.truth.carried(f.truth.normal)[rows]
    reach, depth = rim_of(f)
    for group, centre, normal in zip(groups, centres, normals, strict=True):
        rim = group[0] - centre
        size = np.linalg.norm(rim, axis=1).max()  # a tether's length, of straight ones
        height = rim @ normal
        assert np.abs(height - depth / np.hypot(reach, depth) * size).max() < 1e-4 * size
        assert np.ptp(np.linalg.norm(rim, axis=1)) < 1e-4 * size
        for spoke in group[1:]:
            assert np.abs(np.linalg.norm(spoke[[0, -1]] - centre, axis=1) - size).max() < 1e-4 * size
            assert np.abs((spoke[[0, -1]] - centre) @ normal - height[0]).max() < 1e-4 * size


def rows_of_near(f, places) -> np.ndarray:
    drawn = f.truth.place / f.truth.length
    rows = np.array([int(np.argmin(np.linalg.norm(drawn - place, axis=1))) for place in places])
    assert np.abs(drawn[rows] - places).max() < 1e-5 * f.truth.reach
    return rows


def ring(f) -> bool:
    """Whether the flight goes round on one ring: then arrows and walls are lower."""
    return "/world/fence/ring" in f.picture.entities


def push_arrow(f, entity):
    """From the craft along /thrust; half as long as the longest of all flights where it hardly pushes, nothing where it
    does not."""
    origin, vector = arrows(f, entity)
    same_place(origin, home(f, entity))
    same_direction(vector, f.truth.carried(f.truth.thrust))
    push = strength(f)
    low, high = arrow_lengths(f)
    length = np.linalg.norm(vector, axis=1) / scene_reach(f)
    strongest = max(strength(g).max() for g in f.all)  # of all flights in the picture: their arrows are comparable
    expected = np.where(push > 0, low + (high - low) * push / strongest, 0.0)
    assert np.abs(length - expected).max() < 1e-5


def scene_reach(f) -> float:
    """The largest distance that must be in sight: of the flights, of their target, of its ensembles."""
    far = [g.truth.reach for g in f.all]
    for entity in f.picture.entities:
        if entity.startswith("/world/references/") and not entity.endswith("/reached"):
            lines = np.concatenate(f.picture.line(entity, 0))
            pink = hue(f.picture.color(entity, "LineStrips3D:colors")[0]) == "pink"
            far.append(np.linalg.norm(lines, axis=1).max() / (1.004 if pink else 1.0))
    for name, table in f.ensembles.items():
        assert name
        far.append(np.nanmax(table) / f.truth.length)
    return max(far)


def share(f, word):
    """The name of a device by its word, and its acceleration (n, 3) m/s2."""
    (name,) = (name for name in f.truth.devices if path_word(name) == word)
    return name, f.truth.devices[name]["acceleration_m_s2"]


def share_arrow(f, entity, word):
    """From the craft, a device's acceleration times one factor in each row, the same for all devices and at most that
    of the whole push; nothing where it is the whole push. Its colour is that of its kind."""
    name, own = share(f, word)
    origin, vector = arrows(f, entity)
    same_place(origin, home(f, entity))
    alone = np.linalg.norm(own - f.truth.thrust, axis=1) <= 1e-6 * strength(f)
    true = np.where(alone[:, None], 0.0, own)
    same_direction(vector, seen(f, entity, true))
    top = entity.rsplit("/", 2)[0]
    _, whole = arrows(f, f"{top}/push")
    parts = [arrows(f, f"{top}/shares/{path_word(other)}")[1] for other in f.truth.devices]
    sizes = [device["magnitude_m_s2"] for device in f.truth.devices.values()]
    longest = 12.0 if near(entity) else 2 * arrow_lengths(f)[0] * scene_reach(f)
    for row in np.flatnonzero(np.any(vector, axis=1)):
        factor = np.linalg.norm(whole[row]) / strength(f)[row]
        factor = min(factor, longest / max(size[row] for size in sizes))
        assert abs(np.linalg.norm(vector[row]) - factor * np.linalg.norm(own[row])) < 1e-5 * longest
        together = np.sum([arrow[row] for arrow in parts], axis=0)
        expected = factor * strength(f)[row] / np.linalg.norm(whole[row]) * whole[row]
        assert np.abs(together - expected).max() < 1e-5 * longest, "the devices do not add up to the push"
    hues = {"solar-sail": "yellow", "electric-sail": "violet", "thruster": "blue"}
    assert hue(f.picture.color(entity, "Arrows3D:colors")[0]) == hues[f.truth.kinds[name]]


def share_name(f, entity, word):
    """The device's name beyond the tip of its arrow; near by with what it adds in words."""
    name, own = share(f, word)
    ways, size = seen(f, entity, own), np.linalg.norm(own, axis=1)
    for row, place in shown(f, entity):
        assert size[row] > 0
        assert (place - home(f, entity)[row]) @ ways[row] > 0
    if not near(entity):
        assert f.picture.fixed(entity, "Points3D:labels") == [name]
        return
    for row, text in enumerate(texts(f, entity)):
        found = re.fullmatch(rf"{name} ([\d.]+) (\S+/s²)|no {name}", text)
        assert (found.group(1) is None) == (size[row] == 0)
        if size[row]:
            told(found.group(1), size[row] / PUSHES[found.group(2)])


def push_name(f, entity):
    """ "push" outside the arrow's tip, where it pushes."""
    assert f.picture.fixed(entity, "Points3D:labels") == ["push"]
    push, ways = strength(f), f.truth.carried(f.truth.thrust)
    for row, place in shown(f, entity):
        assert push[row] > 0
        assert (place - home(f, entity)[row]) @ ways[row] >= 0


def close_push(f, entity):
    """From the craft along /thrust, 7.5 long and 4.5 times the root of its share of the largest more."""
    origin, vector = arrows(f, entity)
    acts = lit.acts_at(f)
    same_place(origin, home(f, entity) if acts is None else acts, size=10)
    same_direction(vector, seen(f, entity, f.truth.thrust))
    push = strength(f)
    expected = np.where(push > 0, 7.5 + 4.5 * np.sqrt(push / push.max()), 0.0)
    assert np.abs(np.linalg.norm(vector, axis=1) - expected).max() < 1e-4
