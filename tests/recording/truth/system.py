"""/world: places, orbits and planets against /state, /elements and the ephemeris."""

from __future__ import annotations

import numpy as np

from . import phases
from .facts import path_word, planet_ellipse, unit
from .measure import hue, on_ring, same_angle, same_direction, same_place
from .seen import poses, shown, some, spots, strips

TARGET = 1.004  # a target is drawn so much large: on the trail it would tear
STRAYS = 2e-3  # of the distance: what a curve between rows may stray from the orbit of its last row
PLANET_HUES = {
    "Mercury": "grey",
    "Moon": "grey",
    "Venus": "yellow",
    "Earth": "blue",
    "Mars": "orange",
    "Jupiter": "orange",
    "Saturn": "yellow",
    "Uranus": "cyan",
    "Neptune": "blue",
    "PlanetX": "grey",
    "Apophis": "grey",
}


def right_handed(f, entity):
    """x, y, z are right-handed, z up."""
    assert f.picture.fixed(entity, "ViewCoordinates:xyz")[0].tolist() == [3, 5, 1]  # right, forward, up


def backdrop(f, entity):
    """Stars: far outside of everything, all round."""
    points = f.picture.place(entity, "Points3D:positions", 0)
    far = np.linalg.norm(points, axis=1)
    assert far.min() > (0.0 if entity.startswith("/sail") else 20 * f.truth.reach)
    assert np.linalg.norm(unit(points).mean(0)) < 0.1


def sun_ball(f, entity):
    """A ball about the centre."""
    points = f.picture.place(entity, "Mesh3D:vertex_positions", 0)
    radius = np.linalg.norm(points, axis=1)
    assert radius.max() == np.float64(radius.max())
    same_place(radius, np.full(len(radius), radius[0]), size=10 * radius[0])
    assert 0.005 * f.truth.reach < radius[0] < 0.1 * f.truth.reach


def in_centre(f, entity, component="Points3D:positions"):
    """In the centre."""
    assert not f.picture.place(entity, component, 0).any()


def sun_name(f, entity):
    """Says Sun, below the Sun."""
    for _, (x, y, z) in shown(f, entity):
        assert (x, y) == (0, 0)
        assert -0.2 * f.truth.reach < z < 0
    assert f.picture.fixed(entity, "Points3D:labels") == ["Sun"]


def ecliptic(f, entity):
    """A disc in the plane of x and y as far as the craft goes, and a little more."""
    points = f.picture.place(entity, "Mesh3D:vertex_positions", 0)
    assert not points[:, 2].any()
    assert np.linalg.norm(points, axis=1).max() >= f.truth.reach


def sun_line(f, entity):
    """From beside the Sun to the craft."""
    line = strips(f, entity)
    off = np.linalg.norm(line[:, 0], axis=1)
    assert np.ptp(off) < 1e-6 * off.max() < 0.1 * f.truth.reach
    same_direction(line[:, 0], f.truth.place, 1e-3)
    same_place(line[:, 1], f.truth.place, f.truth.length)


def height_line(f, entity):
    """From the point below the craft in the plane of x and y up to it."""
    line = strips(f, entity)
    same_place(line[:, 0], f.truth.place * [1.0, 1.0, 0.0], f.truth.length, f.truth.reach)
    same_place(line[:, 1], f.truth.place, f.truth.length)


def trail(f, entity):
    """Pieces that join on: each ends where the craft is in its row, passes every drawn row, follows the orbit in
    between, and ends where there is no data."""
    steps, _ = f.picture.rows(entity, "LineStrips3D:strips")
    done, length, place = 0, f.truth.length, f.truth.place / f.truth.length
    for step in steps:
        lines = f.picture.line(entity, step)
        whole = np.concatenate(lines)
        same_place(lines[0][0], f.truth.place[done + (done in f.truth.breaks and done > 0)], length)
        same_place(whole[-1], f.truth.place[step], length)
        for row in range(done, step + 1):
            near = np.linalg.norm(whole - place[row], axis=1).min()
            drawn_before = row == done and row in f.truth.breaks
            assert drawn_before or near < 1e-6 * f.truth.reach, f"row {row} is not on the trail"
        for line in lines:
            first, last = (
                done + int(np.argmin(np.linalg.norm(place[done : step + 1] - end, axis=1))) for end in line[[0, -1]]
            )
            assert not any(first <= row < last for row in f.truth.breaks), "the trail leads over a gap"
            if last > first:
                between_rows(f, np.concatenate([line, 0.5 * (line[1:] + line[:-1])]), first, last)
        done = step
    assert done == f.truth.steps[-1], "the trail ends before the run"
    assert f.picture.moves(entity, "LineStrips3D:colors") == bool(phases.names(f)), "phases are not told apart"
    if phases.names(f):
        phases.stretch_colors(f, entity)
    else:
        assert hue(f.picture.color(entity, "LineStrips3D:colors")[0]) in ("cyan", "blue")


def unknown(f, entity):
    """Dashes from the last row before each stretch without data, or without a known way, to the first one after it,
    each shorter than the stretch; none where there are rows close to one another."""
    dashes = [np.asarray(dash) for dash in f.picture.line(entity, 0)]
    place = f.truth.place / f.truth.length
    rows, begins = [], True
    for dash in dashes:
        if begins:
            rows.append(int(np.argmin(np.linalg.norm(place - dash[0], axis=1))))
            same_place(dash[0], f.truth.place[rows[-1]], f.truth.length)
        begins = bool(np.linalg.norm(place[rows[-1] + 1] - dash[-1]) < 1e-6 * f.truth.reach)
        assert begins or len(dash) == 4
    assert begins, "the last dash ends nowhere"
    assert set(f.truth.breaks) <= set(rows), "a gap is not dashed"
    assert len(dashes) >= 4 * len(rows), "a line, and no dashes"
    filled = f.truth.recording["/filled"]["row"] if "/filled" in f.truth.recording else []
    assert not set(rows) & set(np.asarray(filled, int)), "dashes where the way is filled"


def between_rows(f, points, first, last):
    """Points between two rows lie near the orbit of one of them."""
    points = points * f.truth.length
    size = np.abs(points).max()
    off = []
    for row in range(first, last + 1):
        normal, eccentricity, rectum = f.truth.ring(row)
        across = np.linalg.norm(points, axis=-1) + points @ eccentricity - rectum
        off.append(np.hypot(across, points @ normal))
    rise = 0.2 * np.ptp(np.linalg.norm(f.truth.position[first : last + 1], axis=1))
    allowed = max(STRAYS * size, rise) + (0.02 * size if pushed(f, first, last) else 0)
    assert np.min(off, axis=0).max() < allowed, f"{np.min(off, axis=0).max():.3g} m off the orbit, of {size:.3g} m"


def pushed(f, first, last) -> bool:
    """Whether the thrust is strong enough to bend the way between two rows off their orbits."""
    thrust = np.linalg.norm(f.truth.thrust[first : last + 1], axis=1).max()
    gravity = f.truth.mu / np.sum(f.truth.position[first] ** 2)
    return thrust > 0.02 * gravity


def osculating(f, entity):
    """At each row the orbit of its state, closed."""
    steps = f.truth.steps
    for step in steps:
        for line in f.picture.line(entity, step):
            on_ring(line, f.truth.ring(step), f.truth.length, 2e-6)


def ladder(f, entity):
    """The orbits of a few rows, from the first row to the last."""
    steps, _ = f.picture.rows(entity, "LineStrips3D:strips")
    for step in steps:
        (line,) = f.picture.line(entity, step)
        on_ring(line, f.truth.ring(step), f.truth.length, 2e-6)
    assert steps[0] == 0
    assert len(steps) > 8


def craft_name(f, entity):
    """The craft's kind in words, beside it."""
    words = {
        "solar-sail": "Solar sail",
        "electric-sail": "E-sail",
        "plasma-brake": "Plasma brake",
        "thruster": "Thruster",
        "none": "Spacecraft",
    }
    assert f.picture.fixed(entity, "Points3D:labels") == [words[f.truth.kind]]
    for row in some(f, 3):
        off = f.picture.place(entity, "Points3D:positions", row)[0] - f.truth.place[row] / f.truth.length
        assert np.linalg.norm(off) < 0.25 * max(f.truth.reach, 1e-9)


def conic(name, seconds):
    """Normal, eccentricity vector, semilatus rectum of a planet's orbit."""
    return ring_of(*(value[0] for value in planet_ellipse(name, seconds)[:5]))


def ring_of(a, e, i, raan, argument):
    normal = np.array([np.sin(raan) * np.sin(i), -np.cos(raan) * np.sin(i), np.cos(i)])
    node = np.array([np.cos(raan), np.sin(raan), 0.0])
    along = np.cos(argument) * node + np.sin(argument) * np.cross(normal, node)
    return normal, e * along, a * (1 - e**2)


def start_seconds(f) -> float:
    """s after J2000 of the first row; 0 without an epoch, when planets' orbits are those of J2000."""
    return 0.0 if f.truth.seconds is None else float(f.truth.seconds[0] - f.truth.time[0])


def planet_orbit(f, entity, name):
    """The planet's ellipse at the start, all round, in the planet's colour."""
    (line,) = f.picture.line(entity, 0)
    on_ring(line, conic(name, start_seconds(f)), f.truth.length)
    all_round(line)
    assert hue(f.picture.color(entity, "LineStrips3D:colors")[0]) == PLANET_HUES[name]


def all_round(line):
    same_place(line[0], line[-1], size=10 * np.abs(line).max())
    angle = np.unwrap(np.arctan2(line[:, 1], line[:, 0]))
    assert abs(abs(angle[-1] - angle[0]) - 2 * np.pi) < 1e-3


def column_place(f, entity, name):
    """Where another answer says that the craft is."""
    table = f.truth.recording["/approximation"]
    true = table[f"{name}_position_m"]
    if entity.endswith("/name"):
        rows, places = zip(*shown(f, entity), strict=True)
        same_place(np.array(places), true[list(rows)], f.truth.length)
        assert f.picture.fixed(entity, "Points3D:labels") == [name]
    else:
        same_place(np.array([spot[0] for spot in spots(f, entity)]), true, f.truth.length)
    assert hue(f.picture.color(entity, "Points3D:colors")[0]) == "orange"


def reference(f, entity, name):
    """A curve of the design: the circle or track to be held, the orbits departed from, aimed at and reached, and what
    other answers say. A target is pink and drawn 0.4 % large."""
    (line,) = f.picture.line(entity, 0)
    start, word = f.truth.resolved.get("start", {}), hue(f.picture.color(entity, "LineStrips3D:colors")[0])
    if name == "designed_orbit":
        assert word == "pink"
        designed(f, line / TARGET, start)
    elif name == "initial_orbit":
        assert word == "blue"
        on_ring(line, f.truth.ring(0), f.truth.length)
    elif name.startswith("orbit_of_"):
        assert word == "pink"
        target = f.truth.resolved["target"]
        names = ("semi_major_axis", "eccentricity", "inclination", "raan", "argument")
        if target["planet"]:
            ring = conic(target["planet"].capitalize(), start_seconds(f))
        else:
            shape = {key: target[key] or 0.0 for key in names}
            ring = ring_of(*(shape | {"semi_major_axis": target["radius"] or target["semi_major_axis"]}).values())
        on_ring(line / TARGET, ring, f.truth.length)
    elif name == "reached":
        assert word == "cyan"
        on_ring(line, f.truth.ring(-1), f.truth.length, 2e-6)
    elif name == "a_ring":
        assert word == "pink"
        same_place(np.linalg.norm(line[:, :2], axis=1), np.full(len(line), TARGET))
        same_place(line[:, 2], 0.1 * line[:, 1], size=1)
    else:
        passes(line, f.truth.recording["/approximation"][f"{name}_position_m"] / f.truth.length, 1e-4)


def designed(f, line, start):
    """A circle above the ecliptic, or the track that the craft itself keeps to."""
    if start["kind"] != "displaced":
        passes(line, f.truth.position / f.truth.length, 1e-3)
        return
    radius, elevation = start["radius"] / f.truth.length, start["elevation"]
    same_place(line[:, 2], np.full(len(line), radius * np.sin(elevation)), size=radius)
    same_place(np.linalg.norm(line[:, :2], axis=1), np.full(len(line), radius * np.cos(elevation)), size=radius)
    all_round(line)


def passes(line, places, tolerance):
    """A line of short pieces passes all places."""
    pieces, starts = np.diff(line, axis=0), line[:-1]
    for place in places:
        off = place - starts
        share = np.clip(np.sum(off * pieces, 1) / np.maximum(np.sum(pieces**2, 1), 1e-30), 0, 1)
        near = np.linalg.norm(off - share[:, None] * pieces, axis=1).min()
        assert near < tolerance * np.linalg.norm(place), f"passes at {near:.3g}"


def season(f, entity):
    """A frame that turns about z with the Sun's right ascension."""
    pose = poses(f, entity)
    sun = f.truth.sun
    same_angle(np.arctan2(pose[:, 1, 0], pose[:, 0, 0]), np.arctan2(sun[:, 1], sun[:, 0]), 0.01)
    same_direction(pose[:, :3, 2], np.broadcast_to([0.0, 0, 1], (len(pose), 3)))


def spots_of_body(f, entity):
    """(n, 3) where the planet is drawn beside which an entity stands."""
    names = [e.split("/")[3] for e in f.picture.entities if e.startswith("/world/planets/") and e.endswith("/body")]
    (name,) = (name for name in names if path_word(name) == entity.split("/")[3])
    return np.array([spot[0] for spot in spots(f, f"/world/planets/{name}/body")])


def near_frame(f, entity, word):
    """A frame that goes round with the planet: x away from the Sun, z the normal of its orbit; length 1 is the flight's
    largest distance from it."""
    places = spots_of_body(f, entity)
    pose = poses(f, entity)
    same_place(pose[:, :3, 3], places)
    size = np.linalg.norm(pose[:, :3, :3], axis=1)
    away = np.linalg.norm(f.truth.place / f.truth.length - places, axis=1)
    assert np.abs(size - away.max()).max() < 1e-5 * away.max()
    same_direction(pose[:, :3, 0], places, 0.01)
    turning = np.cross(places[:-1], places[1:])
    same_direction(pose[1:-1, :3, 2], turning[1:], 0.05)


def near_craft(f, entity, word):
    """The craft where it is, in the frame of the planet beside it, called by its kind."""
    for row in range(len(f.truth)):
        place = f.picture.place(entity, "Points3D:positions", row)[0]
        assert np.linalg.norm(place - f.truth.place[row] / f.truth.length) < 3e-7
    assert f.picture.fixed(entity, "Points3D:labels") == ["Solar sail"]


def near_way(f, entity, word):
    """The whole way past the planet: in each row its point of that row is where the craft is."""
    for row in some(f, 9):
        (line,) = f.picture.line(entity, row)
        assert len(line) == len(f.truth)
        assert np.linalg.norm(line[row] - f.truth.place[row] / f.truth.length) < 3e-7


def near_line(f, entity, word):
    """From the planet to the craft."""
    bodies = spots_of_body(f, entity)
    for row in some(f, 9):
        (line,) = f.picture.line(entity, row)
        ends = [bodies[row], f.truth.place[row] / f.truth.length]
        assert np.abs(line - ends).max() < 3e-7


def near_body(f, entity, word):
    """The planet where it is, named, in its colour."""
    bodies = spots_of_body(f, entity)
    for row in some(f, 9):
        assert np.linalg.norm(f.picture.place(entity, "Points3D:positions", row)[0] - bodies[row]) < 3e-7
    (name,) = f.picture.fixed(entity, "Points3D:labels")
    assert path_word(name) == word
    assert hue(f.picture.color(entity, "Points3D:colors")[0]) == PLANET_HUES[name]


def near_sunlight(f, entity, word):
    """The way of the light at the planet, yellow."""
    bodies = spots_of_body(f, entity)
    for row in some(f, 5):
        _, (vector,) = f.picture.arrow(entity, row)
        same_direction(vector, bodies[row], 0.01)
    assert f.picture.fixed(entity, "Arrows3D:labels") == ["sunlight"]
    assert hue(f.picture.color(entity, "Arrows3D:colors")[0]) == "yellow"


def near_push(f, entity, word):
    """From the craft along the thrust, half as long as the longest where it hardly pushes."""
    push = np.linalg.norm(f.truth.thrust, axis=1)
    sizes = []
    for row in range(len(f.truth)):
        (origin,), (vector,) = f.picture.arrow(entity, row)
        assert np.linalg.norm(origin - f.truth.place[row] / f.truth.length) < 3e-7
        same_direction(vector, f.truth.thrust[row], 0.01)
        sizes.append(np.linalg.norm(vector))
    expected = 0.5 + 0.5 * push / push.max()
    assert np.abs(sizes / np.max(sizes) - expected).max() < 1e-3
