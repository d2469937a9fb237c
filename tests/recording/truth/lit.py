"""A sail with a shape in the close-up: facets by the pressure on them, where the force acts, its torque."""

from __future__ import annotations

import re

import numpy as np

from .measure import same_direction, same_place
from .now import told
from .outlines import BLACK, film_of, outline, same_surface
from .picture import turn
from .seen import arrows, body, seen, texts

SHADE = [18, 22, 40]
RAMP = np.array([SHADE, [74, 56, 140], [176, 60, 140], [255, 96, 72], [255, 176, 84]], float)
UNITS = {"N m": 1.0, "mN m": 1e-3, "µN m": 1e-6, "nN m": 1e-9}
STALE = 30.0  # deg, as far as the light may have moved over a craft whose colours are still those of before
CLOSE = 9.5  # size of a sail in the close-up


def facets(f, entity):
    """Each facet lies on the shape that the scene tells, in the colour of p = c ((b1 + b2) c + b3) over the strongest,
    by the side that is lit and as the film has aged, dark where a body is turned away and where the line to the light
    meets the box of the bus; at moments from the first row to the last, between which the light does not move far."""
    own, side = outline(f), float(f.truth.scene["craft_side_m"])
    assert abs(side - own.length) < 1e-9 * side
    points = np.asarray(f.picture.fixed(entity, "Mesh3D:vertex_positions"), float).reshape(-1, 3, 3) * side
    steps, _ = f.picture.rows(entity, "Mesh3D:vertex_colors")
    assert steps[0] == 0
    assert steps[-1] == len(f.truth) - 1
    assert len(steps) >= min(12, len(f.truth))
    out = f.truth.outward / np.linalg.norm(f.truth.outward, axis=1, keepdims=True)
    light = np.array([turn(q).T @ o for q, o in zip(f.truth.quaternion, out, strict=True)])
    shown = steps[np.searchsorted(steps, np.arange(len(light)), side="right") - 1]
    assert np.degrees(np.arccos(np.clip(np.sum(light * light[shown], axis=1), -1, 1)).max()) < STALE
    across = np.cross(points[:, 1] - points[:, 0], points[:, 2] - points[:, 0])
    normal = across / np.linalg.norm(across, axis=1, keepdims=True)
    on_bus = own.on_box(points.reshape(-1, 3)).reshape(-1, 3).all(axis=1)
    same_surface(own, points[~on_bus].reshape(-1, 3), film=True)
    assert on_bus.sum() == (12 if own.middle is not None else 0)
    if on_bus.any():
        same_surface(own, points[on_bus].reshape(-1, 3), film=False)
    acted, pressure, edges = f.truth.environment, [], []
    sunlit = np.asarray(acted.get("sunlit_fraction", acted.get("sunlit", np.ones(len(light)))), float)
    for row in steps:
        u = light[row]
        c = -(normal @ u)
        b = np.where(on_bus[:, None], BLACK, np.where(c[:, None] > 0, film_of(f, row), own.back))
        p = np.where((c > 0) | ~on_bus, np.abs(c) * ((b[:, 0] + b[:, 1]) * np.abs(c) + b[:, 2]), 0.0)
        shaded = edge = np.zeros(len(points), bool)
        if own.middle is not None and own.shadow:
            middle, half = own.middle, own.size / 2
            near = np.array([meets(points.mean(1), u, middle, half * k) for k in (0.9, 1.1)])
            shaded, edge = meets(points.mean(1), u, middle, half) & ~on_bus, near[0] != near[1]
            if u[2] * middle[2] > 0:
                edge = edge | on_bus  # the film shades it in turn
        pressure.append(np.where(shaded, 0.0, np.abs(p)) * sunlit[row])
        edges.append(edge)
    pressure = np.array(pressure)
    thrown = False
    for row, share, edge in zip(steps, pressure / pressure.max(), edges, strict=True):
        colors = f.picture.color(entity, "Mesh3D:vertex_colors", row)[:, :3].astype(float).reshape(-1, 3, 3)
        assert np.array_equal(colors[:, 0], colors[:, 1])
        assert np.array_equal(colors[:, 0], colors[:, 2])
        expected = np.stack([np.interp(4 * share, np.arange(5), RAMP[:, k]) for k in range(3)], -1)
        off = np.abs(colors[:, 0] - expected).max(axis=1)
        assert off[~edge].max() < 2.0, f"a facet is {off[~edge].max():.0f} levels off"
        dark = np.all(colors[:, 0] == SHADE, axis=1) & ~on_bus
        thrown |= dark.any() and not dark[~on_bus].all()
    assert own.middle is None or thrown == own.shadow, "the bus throws a shadow"


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
    """(n, 3) view units: where the line of the force on a shape meets its plane, three quarters of its size off at
    most; None where there is no torque."""
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
    far = np.linalg.norm(place, axis=1, keepdims=True)
    place = place * np.minimum(1.0, 0.75 * float(f.truth.scene["craft_side_m"]) / far)  # edge-on its line is lost
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
