"""The sphere of directions of a craft that turns: the trace of its axis, its angular momentum and the light."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from .facts import unit
from .measure import same_direction, same_place
from .picture import turn
from .seen import arrows, poses, shown

BETWEEN = np.radians(4.1)  # of a great circle between points of a line


def axes(f) -> np.ndarray:
    """(n, 3) z of the body."""
    return np.array([turn(q)[:, 2] for q in f.truth.quaternion])


def shines(f) -> np.ndarray:
    """(n, 3) along the light."""
    return unit(f.truth.outward)


def first(f) -> bool:
    """Whether the sphere is what a recording opens with: of a craft that turns, a tenth of a turn round the Sun at
    most."""
    if "/axis" not in f.picture.entities or f.truth.body != "Sun":
        return False
    place = unit(f.truth.position)
    swept = np.arctan2(np.linalg.norm(np.cross(place[1:], place[:-1]), axis=1), np.sum(place[1:] * place[:-1], axis=1))
    return bool(swept.sum() < 0.1 * 2 * np.pi)


def globe(f, entity):
    """A sphere about the centre, seen from within."""
    points = f.picture.place(entity, "Mesh3D:vertex_positions", 0)
    same_place(np.linalg.norm(points, axis=1), np.full(len(points), 0.985))
    assert int(f.picture.fixed(entity, "Mesh3D:face_rendering")[0]) == 3  # the far side alone


def grid(f, entity):
    """Circles of equal height and of equal azimuth, each 30 degrees apart."""
    lines = f.picture.line(entity, 0)
    levels = [line for line in lines if np.ptp(line[:, 2]) < 1e-6]
    same_place(sorted(line[0, 2] for line in levels), np.sin(np.radians([-60, -30, 0, 30, 60])))
    across = [line for line in lines if np.ptp(line[:, 2]) > 1]
    assert len(across) == 6
    turns = sorted(float(np.degrees(np.arctan2(line[0, 1], line[0, 0])) % 180) for line in across)
    same_place(turns, 30.0 * np.arange(6), size=100)
    for line in lines:
        same_place(np.linalg.norm(line, axis=1), np.ones(len(line)))


def pan(f, entity):
    """A turn about z with the light."""
    light, pose = shines(f), poses(f, entity)
    azimuth = np.arctan2(light[:, 1], light[:, 0])
    same_direction(
        pose[:, :3, 0], np.stack([np.cos(azimuth - azimuth[0]), np.sin(azimuth - azimuth[0]), 0 * azimuth], 1)
    )
    same_place(pose[:, :3, 2], np.tile([0.0, 0.0, 1.0], (len(pose), 1)))


def trace(f, entity, part):
    """All the way through the axis of every row, on the sphere, each piece written at its last row; between rows on
    the great circle."""
    axis, steps = axes(f), f.truth.steps
    own, pieces = f.picture.rows(entity, "LineStrips3D:strips")
    assert own[-1] == steps[-1]
    begins = 0
    for step, piece in zip(own, pieces, strict=True):
        (line,) = piece
        end = int(np.searchsorted(steps, step))
        same_place(line[[0, -1]], axis[[begins, end]])
        same_place(np.linalg.norm(line, axis=1), np.ones(len(line)))
        gap = np.arccos(np.clip(np.sum(line[1:] * line[:-1], axis=1), -1, 1))
        assert gap.max() < BETWEEN
        places = [int(np.argmax(line @ axis[row])) for row in range(begins, end + 1)]
        same_place(line[places], axis[begins : end + 1])
        assert np.all(np.diff(places) > 0), "the way goes back"
        for row, (a, b) in enumerate(pairwise(places), begins):
            pole = np.cross(axis[row], axis[row + 1])
            size = np.linalg.norm(pole)
            if size > 1e-3:
                assert np.abs(line[a : b + 1] @ pole / size).max() < 1e-5, "not the shortest way"
        begins = end
    assert begins == len(axis) - 1
    spans = [view.trails[entity] for view in f.picture.views if entity in view.trails and view.shows(entity)]
    assert spans == [{"past": (None, 0.0), "future": (0.0, None)}[part]]


def pointing(f, entity, vectors, length):
    """An arrow from the middle."""
    origin, vector = arrows(f, entity)
    same_place(origin, 0 * origin)
    same_place(vector, length * vectors)


def now(f, entity):
    """The body's z of the row."""
    pointing(f, entity, axes(f), 1.0)


def light(f, entity):
    """Away from the Sun."""
    pointing(f, entity, shines(f), 1.22)


def light_way(f, entity):
    """Where the light has gone and will go, through every row."""
    (line,) = f.picture.line(entity, 0)
    same_place(line, shines(f))


def momentum(f, entity):
    """Along the angular momentum, none where it is nothing."""
    own = f.truth.recording["/attitude"]["angular_momentum_N_m_s"]
    size = np.linalg.norm(own, axis=1)
    pointing(f, entity, np.where((size > 1e-6 * size.max())[:, None], unit(own), 0.0), 1.36)


def name(f, entity, arrow):
    """Beyond the tip of its arrow, in the arrow's colour."""
    _, vectors = arrows(f, f"/axis/{arrow}")
    for row, spot in shown(f, entity):
        same_place(spot, (np.linalg.norm(vectors[row]) + 0.13) * unit(vectors[row]))
    words = {"now": "sail's axis", "light": "away from the Sun", "momentum": "angular momentum"}
    assert f.picture.at(entity, "Points3D:labels", f.truth.steps[-1]) == [words[arrow]]
    own = f.picture.color(entity, "Points3D:colors")[0]
    assert np.array_equal(own, f.picture.color(f"/axis/{arrow}", "Arrows3D:colors")[0])
