"""/sail: angles against their columns, words against numbers, what flows past."""

from __future__ import annotations

import re

import numpy as np

from .craft import still
from .measure import DEGREES, angle_between, hue, same_angle, same_direction, same_place
from .seen import outward, poses, seen, some, spots, strips, texts

SIZES = {"mm/s²": 1e-3, "µm/s²": 1e-6, "nm/s²": 1e-9, "m/s²": 1.0, "nN/m": 1e-9, "V": 1.0, "mA": 1e-3, "W": 1.0}


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


def pitch_arc(f, entity):
    """From the radial direction to the normal, through the pitch angle of /attitude."""
    arc(strips(f, entity), outward(f, entity), seen(f, entity, f.truth.normal), f.truth.pitch)


def pitch_fan(f, entity):
    """The same as a surface."""
    lines = []
    for step in f.truth.steps:
        points = f.picture.place(entity, "Mesh3D:vertex_positions", step)
        faces = f.picture.at(entity, "Mesh3D:triangle_indices", step)
        assert not points[0].any()
        assert faces.tolist() == [[0, k, k + 1] for k in range(1, len(points) - 1)]
        lines.append(points[1:])
    arc(np.array(lines), outward(f, entity), seen(f, entity, f.truth.normal), f.truth.pitch)
    assert hue(f.picture.color(entity, "Mesh3D:albedo_factor")[0]) == "yellow"


def cone_arc(f, entity):
    """From the radial direction to the thrust, through the cone angle of /attitude; without thrust, nothing."""
    out, thrust = outward(f, entity), seen(f, entity, f.truth.thrust)
    pushed = np.any(thrust, axis=1)
    arc(strips(f, entity), out, np.where(pushed[:, None], thrust, out), np.where(pushed, f.truth.cone, 0.0))


def clock_frame(f, entity):
    """Directions of clock angle 0 and 90 deg, and outward: normal to the orbit, transverse, radial."""
    return (seen(f, entity, f.truth.frame[:, k]) for k in (2, 1, 0))


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
    """Length of the normal's arrow, or of what would be it."""
    if "/sail/normal" in f.picture.entities:
        return float(np.linalg.norm(f.picture.at("/sail/normal", "Arrows3D:vectors", 0)[0]))
    return 10.0


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
    off = np.degrees(np.abs(swept[:, -1] - swept[:, 0] - f.truth.clock[leaning]))
    assert off.max(initial=0.0) < 0.02, f"sweeps {off.max():.3g} deg too far"


def angle_word(f, entity, name):
    """The angle in whole degrees, in words."""
    column = {"pitch": f.truth.pitch, "clock": f.truth.clock}[name]
    for angle, text in zip(np.degrees(column), texts(f, entity), strict=True):
        found = int(re.fullmatch(rf"{name} (\d+)°", text).group(1))
        assert 0 <= found < 360
        assert abs((found - angle + 180) % 360 - 180) <= 0.5 + 1e-9
    assert all(np.isfinite(spot).all() and len(spot) == 1 for spot in spots(f, entity))


def number(text: str) -> tuple[float, float]:
    """A number with its unit at the end of a text, SI, and half of its third digit, or of its last."""
    digits, unit = re.search(r"(-?[\d.]+(?:e[+-]?\d+)?) ?(\S+)$", text).groups()
    value, written = float(digits), len(digits.partition("e")[0].replace(".", "").lstrip("-0"))
    place = np.floor(np.log10(abs(value))) if value else 0.0
    half = 0.5001 * 10 ** (place - (min(written, 3) if "e" in digits else max(written, 3)) + 1)
    return value * SIZES[unit], half * SIZES[unit]


def says(text: str, value: float):
    told, half = number(text)
    assert abs(told - value) <= half + 1e-12 * abs(value), f"{text} for {value:.6g}"


def force_word(f, entity):
    """The thrust in words: acceleration, or force on a metre of tether."""
    size = np.linalg.norm(f.truth.thrust, axis=1)
    per_length = f.truth.environment.get("plasma_force_N_m")
    for row, text in enumerate(texts(f, entity)):
        if per_length is not None:
            assert text == "no force" if per_length[row] == 0 else text.endswith("nN/m")
            says(text, per_length[row]) if per_length[row] else None
        elif size[row] == 0:
            assert text in ("no thrust", "no drag")
        else:
            assert text.startswith("thrust ")
            says(text, size[row])
    if f.picture.moves(entity, "Points3D:positions"):  # of a tether: beside it, on the side to which it is pushed
        middle = -0.5 * 12 * seen(f, entity, f.truth.normal)
        for row, spot in enumerate(spots(f, entity)):
            if size[row]:
                same_direction(spot[0] - middle[row], seen(f, entity, f.truth.thrust)[row], 0.01)


def flow(f, entity):
    """Light or wind from the Sun: outward arrows on the side of the Sun, yellow light, violet wind."""
    origins, vectors = f.picture.arrow(entity, 0)
    out = outward(f, entity)
    for row in some(f, 3):
        same_direction(vectors, np.broadcast_to(out[row], vectors.shape))
        assert ((origins + vectors) @ out[row] < 0).all()
    wind = f.truth.kind == "electric-sail"
    assert hue(f.picture.color(entity, "Arrows3D:colors")[0]) == ("violet" if wind else "yellow")


def flow_name(f, entity):
    """Says what flows, beside it."""
    wind = f.truth.kind == "electric-sail"
    assert f.picture.fixed(entity, "Points3D:labels") == ["solar wind" if wind else "sunlight"]
    assert hue(f.picture.color(entity, "Points3D:colors")[0]) == ("violet" if wind else "yellow")
    assert f.picture.place(entity, "Points3D:positions", 0)[0] @ outward(f, entity)[0] < 0


def radial(f, entity):
    """A line from the craft away from the central body."""
    (line,) = f.picture.line(entity, 0)
    assert not line[0].any()
    same_direction(line[1], outward(f, entity)[0])


def motion_turn(f, entity):
    """A frame whose x is the direction of flight."""
    same_direction(poses(f, entity)[:, :3, 0], seen(f, entity, f.truth.velocity))
    assert not still(f).any()


def flight_arrow(f, entity):
    """From the craft in the direction of flight."""
    true = seen(f, entity, f.truth.velocity)
    for row in some(f):
        (origin,), (vector,) = f.picture.arrow(entity, row)
        assert not origin.any()
        same_direction(vector, true[row])


def ram_flow(f, entity):
    """Ions come from ahead, against the direction of flight, beside the tether."""
    true = seen(f, entity, f.truth.velocity)
    for row in some(f):
        origins, vectors = f.picture.arrow(entity, row)
        same_direction(vectors, np.broadcast_to(-true[row], vectors.shape))
        assert ((origins + vectors) @ true[row] > 0).all()


def ahead_name(f, entity, words):
    """A word on the side to which the craft flies."""
    true = seen(f, entity, f.truth.velocity)
    for row in some(f, 4):
        assert f.picture.place(entity, "Points3D:positions", row)[0] @ true[row] > 0
    assert f.picture.fixed(entity, "Points3D:labels") == [words]


def drag_arrows(f, entity):
    """Across the tether, in the direction in which /thrust pushes it, as long as the root of that, from places along
    it."""
    normal = seen(f, entity, f.truth.normal)
    thrust = seen(f, entity, f.truth.thrust)
    size = np.linalg.norm(thrust, axis=1, keepdims=True)
    root = np.where(size > 0, thrust / np.sqrt(np.where(size > 0, size, 1)), 0)
    across = root - np.sum(root * normal, 1, keepdims=True) * normal
    drawn = []
    for row in f.truth.steps:
        origins, vectors = f.picture.arrow(entity, row)
        hung = origins @ -normal[row]
        same_place(origins, -hung[:, None] * normal[row], size=100)
        assert 0 < hung.min() < hung.max() < 12.0001
        same_place(vectors, np.broadcast_to(vectors[0], vectors.shape), size=100)
        drawn.append(vectors[0])
    drawn = np.array(drawn)
    pushed = np.linalg.norm(across, axis=1) > 0.01 * np.linalg.norm(across, axis=1).max()
    same_direction(drawn[pushed], across[pushed], 0.01)
    length = np.linalg.norm(drawn, axis=1)
    factor = length.max() / np.linalg.norm(across, axis=1).max()
    same_place(length, factor * np.linalg.norm(across, axis=1), size=100 * length.max())
    assert 3 < factor * np.linalg.norm(root, axis=1).max() < 6


def tip_word(f, entity):
    """The length of the tether at its tip, and its tilt where it is over 0.05 deg."""
    normal = seen(f, entity, f.truth.normal)
    tilt = np.degrees(angle_between(normal, outward(f, entity)))
    length = f.truth.scene["craft_tether_length_m"]
    for row, text in enumerate(texts(f, entity)):
        words = re.fullmatch(r"tip, ([\d.]+) (k?m) down(?:, tilt ([\d.e+-]+)°)?", text)
        assert float(words.group(1)) * {"m": 1, "km": 1e3}[words.group(2)] == length
        assert (words.group(3) is not None) == (tilt[row] > 0.05)
        if words.group(3):
            assert abs(float(words.group(3)) - tilt[row]) <= 0.051 * tilt[row]
        place = f.picture.place(entity, "Points3D:positions", row)[0]
        same_direction(place, -normal[row], DEGREES)


def tether_word(f, entity):
    """Voltage, current and power of the tether."""
    if not f.picture.moves(entity, "Points3D:labels"):
        return
    columns = [f.truth.environment[f"tether_{name}"] for name in ("voltage_V", "current_A", "power_W")]
    for row, text in enumerate(texts(f, entity)):
        for part, unit, column in zip(text.split(", "), ("V", "mA", "W"), columns, strict=True):
            assert part.endswith(f" {unit}")
            says(part, column[row])


def word(f, entity, words):
    """A fixed word."""
    assert f.picture.fixed(entity, "Points3D:labels") == [words]
