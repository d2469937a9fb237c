"""/sail: angles against their columns, words against numbers, what flows past."""

from __future__ import annotations

import re

import numpy as np

from .measure import DEGREES, angle_between, hue, proportional, same_angle, same_direction, same_place
from .now import told
from .seen import arrows, outward, seen, shown, some, spots, strips, texts

SIZES = {"mm/s²": 1e-3, "µm/s²": 1e-6, "nm/s²": 1e-9}


def arc(line, start, end, angle):
    """Lines (n, k, 3) on circles from directions (n, 3) to others, through angles (n,) rad in the plane of both."""
    radius = np.linalg.norm(line, axis=-1)
    same_place(radius, np.full(radius.shape, radius[0, 0]), size=radius[0, 0])
    same_direction(line[:, 0], start, DEGREES)
    same_direction(line[:, -1], end, DEGREES)
    swept = angle_between(line[:, :-1], line[:, 1:])
    same_angle(swept.sum(1), angle)
    same_angle(angle_between(line[:, :1], line).max(1), angle)
    even = swept - swept.mean(1, keepdims=True)
    assert np.degrees(np.abs(even)).max() < 0.01


def angle_arc(f, entity):
    """On the sunward side, from the ray to the normal, through the pitch angle of /attitude."""
    sailing(-strips(f, entity), f, entity)


def sailing(line, f, entity):
    """Arcs (n, k, 3) of the pitch angle, and nothing in the rows of a stowed sail."""
    there = ~f.truth.stowed
    assert not line[~there].any(), "a stowed sail has an angle"
    arc(line[there], outward(f, entity)[there], seen(f, entity, f.truth.normal)[there], f.truth.pitch[there])


def angle_fan(f, entity):
    """The same as a surface."""
    lines = []
    for step in f.truth.steps:
        points = f.picture.place(entity, "Mesh3D:vertex_positions", step)
        faces = f.picture.at(entity, "Mesh3D:triangle_indices", step)
        assert not points[0].any()
        assert faces.tolist() == [[0, k, k + 1] for k in range(1, len(points) - 1)]
        lines.append(points[1:])
    sailing(-np.array(lines), f, entity)
    assert hue(f.picture.color(entity, "Mesh3D:albedo_factor")[0]) == "yellow"


def clock_frame(f, entity):
    """Directions of clock angle 0 and 90 deg, and outward: normal to the orbit, transverse, radial."""
    return (seen(f, entity, f.truth.clock_axes[:, k]) for k in range(3))


def clock_circle(f, entity):
    """The circle on which the tip of the normal's arrow goes round the radial line."""
    line = strips(f, entity)
    tip = normal_length(f) * seen(f, entity, f.truth.normal)
    _, _, out = clock_frame(f, entity)
    along = np.sum(tip * out, axis=1)
    size = normal_length(f)
    same_place(np.einsum("nkj,nj->nk", line, out), np.broadcast_to(along[:, None], line.shape[:2]), size=size)
    round_line = line - along[:, None, None] * out[:, None]
    radius = np.linalg.norm(tip - along[:, None] * out, axis=1)
    same_place(np.linalg.norm(round_line, axis=-1), np.broadcast_to(radius[:, None], line.shape[:2]), size=2 * size)


def normal_length(f) -> float:
    """Radius of the sphere on which the clock angle's circle lies."""
    return 7.0


def clock_spokes(f, entity):
    """From the circle's point of clock angle 0 by its centre to the tip of the normal."""
    line, length = strips(f, entity), normal_length(f)
    up, _, out = clock_frame(f, entity)
    tip = length * seen(f, entity, f.truth.normal)
    centre = np.sum(tip * out, axis=1, keepdims=True) * out
    radius = np.linalg.norm(tip - centre, axis=1, keepdims=True)
    for drawn, true in zip(np.moveaxis(line, 1, 0), (centre + radius * up, centre, tip), strict=True):
        same_place(drawn, true, size=10 * length)


def clock_arc(f, entity):
    """On that circle from the normal to the orbit, over the transverse direction, through the clock angle."""
    line, length = strips(f, entity), normal_length(f)
    up, ahead, out = clock_frame(f, entity)
    tip = length * seen(f, entity, f.truth.normal)
    same_place(line[:, -1], tip, size=10 * length)
    along = np.sum(tip * out, axis=1)
    leaning = np.linalg.norm(tip - along[:, None] * out, axis=1) > 1e-3 * length
    flat = line[leaning] - along[leaning, None, None] * out[leaning, None]
    angle = np.arctan2(np.einsum("nkj,nj->nk", flat, ahead[leaning]), np.einsum("nkj,nj->nk", flat, up[leaning]))
    same_angle(angle[:, 0], 0.0, 0.02)
    swept = np.unwrap(angle, axis=1)
    off = np.degrees(np.abs(swept[:, -1] - swept[:, 0] - f.truth.clock_angle[leaning]))
    assert off.max(initial=0.0) < 0.02, f"sweeps {off.max():.3g} deg too far"


def angle_word(f, entity):
    """The sail's angle in whole degrees, beside its arc."""
    for angle, text, stowed in zip(np.degrees(f.truth.pitch), texts(f, entity), f.truth.stowed, strict=True):
        assert stowed == (text == "")
        assert stowed or abs(int(re.fullmatch(r"(\d+)°", text).group(1)) - angle) <= 0.5 + 1e-9
    normal, out = seen(f, entity, f.truth.normal), outward(f, entity)
    for row, spot in enumerate(spots(f, entity)):
        assert len(spot) == (not f.truth.stowed[row])
        if f.truth.stowed[row]:
            continue
        same_angle(angle_between(-spot[0], out[row]), 0.5 * f.truth.pitch[row], 0.05)
        same_angle(angle_between(-spot[0], normal[row]), 0.5 * f.truth.pitch[row], 0.05)


def clock_word(f, entity):
    """The clock angle in whole degrees, in words."""
    for angle, text, stowed in zip(np.degrees(f.truth.clock_angle), texts(f, entity), f.truth.stowed, strict=True):
        if stowed:
            continue
        found = int(re.fullmatch(r"clock (\d+)°", text).group(1))
        assert 0 <= found < 360
        assert abs((found - angle + 180) % 360 - 180) <= 0.5 + 1e-9
    there = np.array([len(spot) for spot in spots(f, entity)])
    assert np.all(there <= ~f.truth.stowed)
    assert there.any()
    assert all(np.isfinite(spot).all() for spot in spots(f, entity))


def push_word(f, entity):
    """The push in words, on the side to which it points; "no push" is not written where there is no arrow."""
    size = np.linalg.norm(f.truth.thrust, axis=1)
    way = seen(f, entity, f.truth.thrust)
    for row, (text, step) in enumerate(zip(texts(f, entity), f.truth.steps, strict=True)):
        found = re.fullmatch(r"push ([\d.]+) (\S+/s²)|no push", text)
        assert (found.group(1) is None) == (size[row] == 0)
        spot = f.picture.place(entity, "Points3D:positions", step)
        assert len(spot) == (size[row] > 0)
        if size[row]:
            told(found.group(1), size[row] / SIZES[found.group(2)])
            assert spot[0] @ way[row] > 0


def flow(f, entity):
    """Light or wind from the Sun: outward arrows, yellow light that ends on the film, violet wind through the wheel."""
    out, normal = outward(f, entity), seen(f, entity, f.truth.normal)
    wind = f.truth.kind == "electric-sail"
    for row in some(f):
        origins, vectors = f.picture.arrow(entity, f.truth.steps[row])
        same_direction(vectors, np.broadcast_to(out[row], vectors.shape))
        ends = origins + vectors
        near = np.abs(ends @ out[row]) < 6.9  # farther ones are cut off
        off = ends[near] @ normal[row] + 0.25 * normal[row] @ out[row]
        assert np.abs(off).max(initial=0.0) < 1e-3 or abs(normal[row] @ out[row]) < 0.15, "a ray ends off the sail"
    assert hue(f.picture.color(entity, "Arrows3D:colors")[0]) == ("violet" if wind else "yellow")


def mirrored(f, entity):
    """From where the rays end, as a mirror across the normal throws them back."""
    out, normal = outward(f, entity), seen(f, entity, f.truth.normal)
    back = out - 2 * np.sum(out * normal, 1, keepdims=True) * normal
    for row in some(f):
        origins, vectors = f.picture.arrow(entity, f.truth.steps[row])
        same_direction(vectors, np.broadcast_to(0 if f.truth.stowed[row] else back[row], vectors.shape), 1e-3)
        rays, falling = f.picture.arrow("/sail/flow", f.truth.steps[row])
        same_place(origins, rays + falling, size=100)


def flow_name(f, entity):
    """Says what flows, beside it."""
    wind = f.truth.kind == "electric-sail"
    assert f.picture.fixed(entity, "Points3D:labels") == ["solar wind" if wind else "sunlight"]
    assert hue(f.picture.color(entity, "Points3D:colors")[0]) == ("violet" if wind else "yellow")
    assert f.picture.place(entity, "Points3D:positions", 0)[0] @ outward(f, entity)[0] < 0


def radial(f, entity):
    """A line through the craft, from the central body or from the light."""
    (line,) = f.picture.line(entity, 0)
    same_direction(line[1] - line[0], outward(f, entity)[0])
    assert not np.cross(line[0], line[1]).any()


def beside(f, entity, arrow):
    """A word beyond an arrow's tip, on its side, where no other word is in the way."""
    _, vectors = arrows(f, arrow)
    assert shown(f, entity)
    for row, step in enumerate(f.truth.steps):
        spot = f.picture.place(entity, "Points3D:positions", step)
        assert len(spot) <= np.any(vectors[row])
        if len(spot):
            assert spot[0] @ vectors[row] > 0
            assert np.linalg.norm(spot[0] - vectors[row]) < 3.0


def sunward_normal(f, entity):
    """Against /attitude/normal: towards the Sun, where the angle is measured."""
    origin, vector = arrows(f, entity)
    assert not origin.any()
    proportional(vector, -seen(f, entity, f.truth.normal))


def word(f, entity, words):
    """A fixed word."""
    assert f.picture.fixed(entity, "Points3D:labels") == [words]
