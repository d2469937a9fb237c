"""A low orbit seen from the craft: the tail, what brakes, the plumb line, the drag sail, and from afar the globe."""

from __future__ import annotations

import re

import numpy as np

from .measure import hue, on_ring, same_direction, same_place
from .now import braking, told
from .seen import body, home, shown, some, spots, texts

TAIL = 0.9  # rad
FIRST = (150, 230, 255)  # of the first of several flights
START, MIDDLE, END = (100, 190, 255), (170, 140, 255), (244, 92, 150)  # of a descent by altitude


def ramp(f, rows, factor=1.0) -> np.ndarray:
    """The colour (n, 3) of rows, from the altitude of the start to the lowest of the run, or to the highest of one that
    climbs more than it sinks; among flights its own."""
    if len(f.all) > 1:
        return factor * np.tile(np.array(FIRST, float), (len(rows), 1))
    from .now import heights

    high = heights(f)
    sinks, climbs = high[0] - high.min(), high.max() - high[0]
    if climbs > max(sinks, 1e3):
        share = np.clip((high[rows] - high[0]) / climbs, 0, 1)
    else:
        share = np.clip((high[0] - high[rows]) / (1e3 if climbs > sinks else max(sinks, 1e3)), 0, 1)
    stops = np.array([START, MIDDLE, END], float)
    return factor * np.stack([np.interp(share, [0, 0.5, 1], stops[:, k]) for k in range(3)], 1)


def ramped(f, entity, factor=1.0):
    steps, colors = f.picture.rows(entity, "LineStrips3D:colors")
    packed = np.array([color[0] for color in colors], np.uint32)
    drawn = np.stack([(packed >> shift) & 255 for shift in (24, 16, 8)], -1).astype(float)
    assert np.abs(drawn - ramp(f, steps, factor)).max() < 2.0


def tail(f, entity):
    """The orbit of the moment over the last 0.9 rad up to the craft, in the colour of its altitude."""
    steps, _ = f.picture.rows(entity, "LineStrips3D:strips")
    for row in some(f):
        (line,) = f.picture.line(entity, steps[row])
        assert np.linalg.norm(line[-1] - home(f, entity)[row]) < 6e-4 * np.linalg.norm(line[-1])
        on_ring(line / 1.0004, f.truth.ring(row), f.truth.length, 2e-3)
        swept = np.arccos(np.clip(line[0] @ line[-1] / np.prod(np.linalg.norm(line[[0, -1]], axis=1)), -1, 1))
        assert abs(swept - TAIL) < 0.01
        ahead = f.truth.drawn_frame[row][1]
        assert line[0] @ ahead < 0, "the tail is ahead of the craft"
    ramped(f, entity)


def orbit(f, entity):
    """The whole orbit of the moment, dimmer."""
    for row in some(f):
        for line in f.picture.line(entity, row):
            on_ring(line, f.truth.ring(row), f.truth.length, 2e-6)
    ramped(f, entity, 0.8)


def drag_arrows(f, entity):
    """Against the flight or along the thrust, as long as 0.035 and 0.075 times the root of the share of the largest,
    along a tether three quarters of that; nothing where nothing brakes."""
    word = "drag" if f.truth.kind != "none" else "air drag"
    size = braking(f, word)
    tether = f.truth.kind == "plasma-brake"
    way = f.truth.carried(f.truth.thrust) if f.truth.kind != "none" else -f.truth.carried(f.truth.velocity)
    expected = np.where(size > 0, 0.035 + 0.075 * np.sqrt(size / size.max()), 0.0) * (0.75 if tether else 1.0)
    for row, step in enumerate(f.truth.steps):
        origins, vectors = f.picture.arrow(entity, step)
        same_place(np.linalg.norm(vectors, axis=1), np.full(len(vectors), expected[row]), size=1.0)
        if size[row] > 0:
            same_direction(vectors, np.broadcast_to(way[row], vectors.shape), 0.01)
        off = origins - home(f, entity)[row]
        if tether:
            up = body(f, "/world/rtn/body/tether")[row][:, 2]
            hung = off @ -up
            same_place(off, -hung[:, None] * up, size=10)
            assert 0 < hung.min() < hung.max() < 0.0751
            assert len(off) > 5
        else:
            same_place(off, 0 * off, size=10)


def drag_word(f, entity):
    """What brakes, in words."""
    per_length = f.truth.environment.get("plasma_force_N_m")
    for row, text in enumerate(texts(f, entity)):
        found = re.fullmatch(r"(?:(air drag|drag|push) ([\d.]+) (\S+/s²|nN per metre))|no (air drag|drag|push)", text)
        assert found, text
        word, value, unit, none = found.groups()
        if none:
            assert (braking(f, none)[row] if per_length is None else per_length[row]) == 0
        elif unit == "nN per metre":
            told(value, 1e9 * per_length[row])
        else:
            told(value, braking(f, word)[row] / {"mm/s²": 1e-3, "µm/s²": 1e-6, "nm/s²": 1e-9}[unit])


def flight(f, entity):
    """An arrow ahead of the craft, the way it flies."""
    true = f.truth.carried(f.truth.velocity)
    for row in some(f):
        (origin,), (vector,) = f.picture.arrow(entity, row)
        assert vector @ true[row] > 0
        same_direction(vector, f.truth.drawn_frame[row][1], 0.01)
        assert np.linalg.norm(origin - home(f, entity)[row]) < 0.05
    assert hue(f.picture.color(entity, "Arrows3D:colors")[0]) == "green"


def flight_name(f, entity):
    """Says so, ahead of the craft, while no other name is there."""
    assert f.picture.fixed(entity, "Points3D:labels") == ["flies this way"]
    rows = [row for row, _ in shown(f, entity)] if f.picture.moves(entity, "Points3D:positions") else some(f, 3)
    for row in rows:
        off = f.picture.place(entity, "Points3D:positions", row)[0] - home(f, entity)[row]
        assert off @ f.truth.drawn_frame[row][1] > 0


def plumb(f, entity):
    """Straight down to the ground."""
    steps, _ = f.picture.rows(entity, "LineStrips3D:strips")
    for row in some(f):
        (line,) = f.picture.line(entity, steps[row])
        up = f.truth.drawn_frame[row][0]
        same_place(line[-1], up, size=10)
        assert line[0] @ up <= np.linalg.norm(home(f, entity)[row]) + 1e-6


def ground(f, entity):
    """The height of the craft over the ground, at the ground."""
    for row, (spot, text) in enumerate(zip(spots(f, entity), texts(f, entity), strict=True)):
        same_place(spot[0], f.truth.drawn_frame[row][0], size=10)
        told(re.fullmatch(r"(-?\d+) km", text).group(1), (np.linalg.norm(f.truth.place[row]) - f.truth.radius) / 1e3)


def drag_sail(f, entity, side):
    """A film across the flight, seen from both sides."""
    for row in some(f, 4):
        points = f.picture.place(entity, "Mesh3D:vertex_positions", row) - home(f, entity)[row]
        flat = points - points.mean(0)
        ahead = f.truth.drawn_frame[row][1]
        assert np.abs(flat @ ahead).max() < 0.1 * np.abs(flat).max()
    assert hue(f.picture.color(entity, "Mesh3D:albedo_factor")[0]) in ("white", "grey")
    assert int(f.picture.fixed(entity, "Mesh3D:face_rendering")[0]) == {"front": 2, "back": 3}[side]


def craft_dot(f, entity):
    """Where the craft is drawn."""
    same_place(np.array([spot[0] for spot in spots(f, entity)]), f.truth.place, f.truth.length)


def craft_dot_name(f, entity):
    """Its kind in words, or its name among several flights, over it, while the planet does not hide it from the view
    that shows it."""
    (view,) = [view for view in f.picture.views if view.name == "Where it is"]
    shown = 0
    for row, step in enumerate(f.truth.steps):
        spot = f.picture.place(entity, "Points3D:positions", step)
        pose = f.picture.pose(view.origin, step) if view.origin != "/" else np.eye(4)
        eye = pose[:3, :3] @ view.eye + pose[:3, 3]
        here = home(f, entity)[row]
        ray = (here - eye) / np.linalg.norm(here - eye)
        along = -eye @ ray
        hidden = np.linalg.norm(eye + along * ray) < 1 - 1e-4 and np.linalg.norm(here - eye) > along
        if hidden:
            assert len(spot) == 0
        elif len(spot):
            same_direction(spot[0], here, 0.01)
            shown += 1
    assert shown
