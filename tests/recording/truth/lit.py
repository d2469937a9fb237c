"""A sail with a shape in the close-up: facets by the pressure on them, where the force acts, its torque."""

from __future__ import annotations

import re

import numpy as np

from .measure import same_direction, same_place
from .now import told
from .picture import turn
from .seen import arrows, body, seen, texts

SHADE = [18, 22, 40]
RAMP = np.array([SHADE, [74, 56, 140], [176, 60, 140], [255, 96, 72], [255, 176, 84]], float)
UNITS = {"N m": 1.0, "mN m": 1e-3, "µN m": 1e-6, "nN m": 1e-9}
FILM, BLACK = (0.0723, 0.8554, -0.0030), (0.5, 0.0, 0.0)  # b1, b2, b3 of jpl-2015, and of the bus
CLOSE = 9.5  # size of a sail in the close-up


def facets(f, entity):
    """Each facet in the colour of p = c ((b1 + b2) c + b3) over the strongest, dark where it is turned away and where
    the line to the light meets the box of the bus; at moments from the first row to the last."""
    told = f.truth.resolved["device"]["shape"]
    side = float(f.truth.scene["craft_side_m"])
    points = np.asarray(f.picture.fixed(entity, "Mesh3D:vertex_positions"), float).reshape(-1, 3, 3) * side
    steps, _ = f.picture.rows(entity, "Mesh3D:vertex_colors")
    assert steps[0] == 0
    assert steps[-1] == len(f.truth) - 1
    assert len(steps) >= 12
    across = np.cross(points[:, 1] - points[:, 0], points[:, 2] - points[:, 0])
    normal = across / np.linalg.norm(across, axis=1, keepdims=True)
    middle, half = np.array(told["bus"]["centre"]), np.array(told["bus"]["size"]) / 2
    on_bus = np.all(np.abs(points - middle) < half + 1e-4, axis=(1, 2))
    assert on_bus.sum() == 12
    pressure, edges = [], []
    for row in steps:
        out = f.truth.outward[row] / np.linalg.norm(f.truth.outward[row])
        u = turn(f.truth.quaternion[row]).T @ out
        c = -(normal @ u)
        b = np.where(on_bus[:, None], BLACK, FILM)
        p = np.where((c > 0) | ~on_bus, np.abs(c) * ((b[:, 0] + b[:, 1]) * np.abs(c) + b[:, 2]), 0.0)
        near = np.array([meets(points.mean(1), u, middle, half * k) for k in (0.9, 1.1)])
        shaded = meets(points.mean(1), u, middle, half) & ~on_bus & bool(told["shadow"])
        pressure.append(np.where(shaded, 0.0, p))
        edges.append(near[0] != near[1])
    pressure = np.array(pressure)
    for row, own, edge in zip(steps, pressure / pressure.max(), edges, strict=True):
        colors = f.picture.color(entity, "Mesh3D:vertex_colors", row)[:, :3].astype(float).reshape(-1, 3, 3)
        assert np.array_equal(colors[:, 0], colors[:, 1])
        assert np.array_equal(colors[:, 0], colors[:, 2])
        expected = np.stack([np.interp(4 * own, np.arange(5), RAMP[:, k]) for k in range(3)], -1)
        off = np.abs(colors[:, 0] - expected).max(axis=1)
        assert off[~edge].max() < 2.0, f"a facet is {off[~edge].max():.0f} levels off"
        dark = np.all(colors[:, 0] == SHADE, axis=1) & ~on_bus
        assert dark.any() == bool(told["shadow"]), "the bus throws a shadow"


def meets(points, u, middle, half):
    """(n,) whether lines from points against u meet a box."""
    with np.errstate(divide="ignore", invalid="ignore"):
        ends = np.array([(middle + sign * half - points) / -u for sign in (-1, 1)])
    first, last = ends.min(0).max(1), ends.max(0).min(1)
    return (first < last) & (last > 0)


def torque_of(f):
    """(n, 3) N m in body axes; None where there is none."""
    names = [f"light_torque_{axis}_N_m" for axis in "xyz"]
    if any(name not in f.truth.environment for name in names):
        return None
    return np.stack([f.truth.environment[name] for name in names], -1)


def mass_at(f):
    """(3,) m: about which the torques are. None where the scene does not say, or actuators act beside the film."""
    told = f.truth.resolved.get("attitude") or {"kind": "prescribed"}
    if told["kind"] == "prescribed":
        return np.zeros(3)
    return None if told.get("actuators") or told.get("film_mass") else np.array(told["centre_of_mass"] or [0, 0, 0])


def acts_at(f):
    """(n, 3) view units: where the line of the force on a shape meets its plane; None where there is no torque."""
    torque = torque_of(f)
    if torque is None:
        return None
    axes = np.array([turn(q) for q in f.truth.quaternion])
    mass = f.truth.resolved["device"]["mass"]
    force = mass * np.einsum("nij,ni->nj", axes, f.truth.thrust)
    about = mass_at(f)
    if about is None:
        return np.zeros_like(force)
    torque = torque + np.cross(about, force)  # about the shape's origin
    along = np.sum(torque * force, axis=1) / np.sum(force * force, axis=1)
    torque = torque - along[:, None] * force  # what is left turns about the force's line
    # x and y of the point r in the plane z = 0 for which r x F has the torque's parts across z
    place = np.stack([-torque[:, 1] / force[:, 2], torque[:, 0] / force[:, 2], 0 * force[:, 2]], -1)
    view = body(f, "/sail/push")
    return CLOSE / float(f.truth.scene["craft_side_m"]) * np.einsum("nij,nj->ni", view, place)


def torque_arrow(f, entity):
    """From what it turns about along the torque, 2.5 long and 4 times the root of its share of the largest more."""
    origin, vector = arrows(f, entity)
    about, size = mass_at(f), CLOSE / float(f.truth.scene["craft_side_m"])
    same_place(origin, size * (body(f, entity) @ (np.zeros(3) if about is None else about)), size=10)
    torque = torque_of(f)
    axes = np.array([turn(q) for q in f.truth.quaternion])
    same_direction(vector, seen(f, entity, np.einsum("nij,nj->ni", axes, torque)), 1e-3)
    size = np.linalg.norm(torque, axis=1)
    same_place(np.linalg.norm(vector, axis=1), 2.5 + 4.0 * np.sqrt(size / size.max()), size=20)


def torque_name(f, entity):
    """The torque in words beyond the arrow's tip."""
    size = np.linalg.norm(torque_of(f), axis=1)
    for row, words in enumerate(texts(f, entity)):
        number, unit = re.fullmatch(r"torque ([\d.]+) (\S+ m)", words).groups()
        told(number, size[row] / UNITS[unit])
