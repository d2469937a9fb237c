"""What stands round: marks at the start, the end and events, names of rings, planets with and without a date."""

from __future__ import annotations

import re

import numpy as np

from . import phases
from .facts import AU, DAY, MADE_UP, PLANETS, TILT, planet_place
from .measure import ULP, hue, same_place
from .seen import poses, shown, some, spots
from .system import PLANET_HUES

MU_SUN = 1.327_124_400_18e20
NEAR = 0.12  # of a planet's distance, within which a flight without a date starts or ends at it


def marks(f, entity):
    """Dots where the flight starts and ends and where something happened."""
    places = f.picture.place(entity, "Points3D:positions", 0)
    true = f.truth.place / f.truth.length
    back = "/world/marks/0" in f.picture.entities and "began" in f.picture.fixed("/world/marks/0", "Points3D:labels")[0]
    if back:
        assert np.linalg.norm(true[0] - true[-1]) < 0.07 * np.abs(true).max()
        assert np.linalg.norm(true - true[0], axis=1).max() > 0.1 * np.abs(true).max(), "it has been nowhere else"
    else:
        same_place(places[0], true[0])
    if len(places) > 1 or back:
        same_place(places[-1], true[-1])
    for place in places[1:-1]:
        assert np.linalg.norm(true - place, axis=1).min() < widest_step(f)


def widest_step(f) -> float:
    return float(np.linalg.norm(np.diff(f.truth.place, axis=0), axis=1).max() / f.truth.length)


def mark_name(f, entity, number):
    """Its words above it: start, an event of the recording with its day, or what the flight ends with."""
    (text,) = f.picture.fixed(entity, "Points3D:labels")
    place = shown(f, entity)[0][1]
    dot = f.picture.place("/world/marks", "Points3D:positions", 0)[int(number)]
    same_place(place[:2], dot[:2], size=1 + np.abs(dot).max())
    assert 0 < place[2] - dot[2] < 0.4 * max(f.truth.reach, np.abs(dot).max())
    text = text.removesuffix(": where it began")
    flown = phases.names(f)
    assert text.startswith("start") == (text == (f"start: {flown[0]}" if flown else "start"))
    if text.startswith("start"):
        same_place(dot, f.truth.place[0], f.truth.length)
        return
    name, word, day = re.fullmatch(r"(.*), (day|hour|year) ([\d.]+)", text).groups()
    duration = f.truth.time[-1] - f.truth.time[0]
    size = {"day": DAY, "hour": 3600.0, "year": 36.525 * DAY}[word]  # the last digit of a year is its tenth
    when = float(day) * size * (10 if word == "year" else 1)
    known = {event.name: event.time - f.truth.time[0] for event in f.truth.recording.events}
    if name in flown[1:]:  # of which this is the beginning, of one of them if it comes again
        ends = {f"end of {flown[i - 1]}" for i in range(1, len(flown)) if flown[i] == name}
        begun = [e for e in f.truth.recording.events if e.name in ends]
        event = min(begun, key=lambda e: np.linalg.norm(e.state[:3] / f.truth.length - dot))
        same_place(dot, event.state[:3], f.truth.length)
        known = {name: event.time - f.truth.time[0]}
    if name in known:
        assert abs(when - known[name]) <= 0.51 * size or abs(when - duration) < 0.03 * duration
        return
    assert name == "end" or name.startswith("reaches ")
    assert abs(when - duration) <= 0.51 * size
    if name.startswith("reaches the orbit of "):
        reached(f, name.removeprefix("reaches the orbit of "))
    elif name.startswith("reaches "):
        planet = planet_place(name.removeprefix("reaches "), f.truth.seconds)[-1]
        assert np.linalg.norm(planet - f.truth.position[-1]) < 0.03 * f.truth.reach * f.truth.length


def reached(f, name):
    """The last row's orbit has the size and the shape of the planet's, or of the circle that stands for it."""
    a, e = (f.truth.elements[key][-1] for key in ("semi_major_axis_m", "eccentricity"))
    values = PLANETS[name][0]
    assert abs(a / AU - values[0]) < 0.03 * values[0]
    assert min(abs(e - values[1]), e) < 0.03


def passages(f, entity, word):
    """Dots where events are that begin with a word."""
    places = f.picture.place(entity, "Points3D:positions", 0)
    events = passed(f, word)
    assert len(places) == len(events) > 0
    same_place(places, np.array([event.state[:3] for event in events]), f.truth.length)
    assert hue(f.picture.color(entity, "Points3D:colors")[0]) == {"violation": "red", "flyby of ": "yellow"}[word]


def passage_name(f, entity, number, word):
    """Above its dot, the event in its own words."""
    (text,) = f.picture.fixed(entity, "Points3D:labels")
    event = passed(f, word)[int(number)]
    assert text == event.name.removeprefix("flyby of ")
    place, dot = shown(f, entity)[0][1], event.state[:3] / f.truth.length
    same_place(place[:2], dot[:2], size=1 + np.abs(dot).max())
    assert 0 < place[2] - dot[2] < 0.4 * f.truth.reach


def passed(f, word):
    return [event for event in f.truth.recording.events if event.name.startswith(word)]


def star_name(f, entity):
    """The star's own name, below it."""
    places = np.array([place for _, place in shown(f, entity)])
    places = places[np.isfinite(places[:, 0])]
    assert len(places)
    assert not places[:, :2].any()
    assert np.all((places[:, 2] < 0) & (places[:, 2] > -0.2 * f.truth.reach))
    assert f.picture.fixed(entity, "Points3D:labels") == [f.truth.body]


def ring_name(f, entity, name):
    """On the ring that it names."""
    (text,) = f.picture.fixed(entity, "Points3D:labels")
    place = shown(f, entity)[0][1]
    if name == "target":
        lines = [
            np.concatenate(f.picture.line(other, 0)) / 1.004
            for other in f.picture.entities
            if other.startswith("/world/references/")
            and hue(f.picture.color(other, "LineStrips3D:colors")[0]) == "pink"
        ]
        assert text.startswith("orbit of") or text in ("target orbit", "designed orbit")
        line = lines[0]
    else:
        assert text == f"orbit of {name}"
        line = np.concatenate(f.picture.line(f"/world/planets/{name}/orbit", 0))
    assert np.linalg.norm(line - place, axis=1).min() < 1e-4 * np.abs(line).max()


def planet_body(f, entity, name):
    """Where the planet is, from its mean elements; without a date on its circle at its own pace, where the craft starts
    or where it ends; in its colour."""
    drawn = np.array([spot[0] for spot in spots(f, entity)])
    if f.truth.round_planet:
        moon_body(f, drawn, name)
        return
    assert hue(f.picture.color(entity, "Points3D:colors")[0]) == PLANET_HUES[name]
    if name in MADE_UP:
        same_place(drawn, planet_place(name, f.truth.time), f.truth.length)
        return
    if f.truth.seconds is not None:
        same_place(drawn, planet_place(name, f.truth.seconds), f.truth.length)
        return
    a = np.linalg.norm(drawn, axis=1)
    mean = PLANETS[name][0][0]
    assert np.ptp(a) < 1e-5 * a.max()
    assert abs(a[0] - mean) < 0.03 * mean
    angle = np.unwrap(np.arctan2(drawn[:, 1], drawn[:, 0]))
    rate = np.sqrt(MU_SUN / (a[0] * AU) ** 3)
    assert np.abs(angle - angle[0] - rate * (f.truth.time - f.truth.time[0])).max() < 1e-3
    ends = [row for row in (0, -1) if abs(np.linalg.norm(f.truth.position[row]) / AU - a[0]) < NEAR * a[0]]
    assert ends
    off = [abs(np.angle(np.exp(1j * (angle[row] - np.arctan2(*f.truth.position[row][1::-1]))))) for row in ends]
    assert min(off) < 1e-4
    (about,) = f.picture.fixed("/about", "TextDocument:text")
    assert re.search(rf"\*No date is given: .*\b{name}\b", about)


def moon_body(f, drawn, name):
    """As far from the craft as recorded, at the Moon's distance, going round at its pace, 5 deg from the ecliptic."""
    assert name == "Moon"
    place = drawn * f.truth.length
    off = np.linalg.norm(place - f.truth.position, axis=1) - f.truth.environment["moon_distance_m"]
    assert np.abs(off).max() < 1e-6 * np.abs(place).max()
    distance = np.linalg.norm(place, axis=1)
    assert distance.min() > 356e6
    assert distance.max() < 407e6
    turned = np.degrees(np.arccos(place[0] @ place[-1] / distance[0] / distance[-1]))
    days = (f.truth.time[-1] - f.truth.time[0]) / DAY
    assert 11.0 * days < turned < 15.5 * days
    pole = np.array([0.0, -np.sin(TILT), np.cos(TILT)])
    assert (
        np.degrees(np.arccos(pole @ np.cross(place[0], place[-1]) / np.linalg.norm(np.cross(place[0], place[-1]))))
        < 5.5
    )


def moon_way(f, entity, name):
    """Through the places of its body."""
    (line,) = f.picture.line(entity, 0)
    same_place(line, np.array([spot[0] for spot in spots(f, f"/world/planets/{name}/body")]), size=100.0)


SPHERES = {"moon": ("Moon", 4_902.800e9 / 398_600.44e9), "earth": ("Earth", 398_600.44e9 / 132_712_440_018e9)}


def sphere(f, name):
    """Centres (n, 3) and radius, m, of a body's sphere of influence: a part (m/M)^(2/5) of the mean distance."""
    body, ratio = SPHERES[name]
    assert body == "Moon" or f.truth.seconds is not None
    if body == "Earth":
        return np.zeros((len(f.truth), 3)), ratio**0.4 * f.truth.environment["sun_distance_m"].mean()
    places = np.array([spot[0] for spot in spots(f, f"/world/planets/{body}/body")]) * f.truth.length
    return places, ratio**0.4 * np.linalg.norm(places, axis=1).mean()


def influence(f, entity, name):
    """Rings as far from their body, wherever it is, as its sphere of influence reaches; the flight crosses or nears
    it."""
    places, radius = sphere(f, name)
    for row in some(f, 5):
        points = np.concatenate(f.picture.line(entity, row)) * f.truth.length
        off = np.linalg.norm(points - places[row], axis=1)
        assert np.abs(off - radius).max() < 2e-3 * radius  # the mean distance is one of the drawn rows
    apart = np.linalg.norm(f.truth.position - places, axis=1)
    assert apart.min() < 2 * radius
    assert apart.max() > radius


def passed_globe(f, entity, name):
    """A ball of the Moon's radius where the Moon is."""
    places, _ = sphere(f, name)
    for row in some(f, 5):
        points = f.picture.place(entity, "Mesh3D:vertex_positions", row) * f.truth.length
        off = np.linalg.norm(points - places[row], axis=1)
        assert np.abs(off - 1_737.4e3).max() < 1e3 + ULP * np.abs(places).max()


def passed_way(f, entity, name):
    """The way as far from the Moon, in every row, as the flight then was: through each row within two radii of its
    sphere, in the frame in which the Moon stands still."""
    places, radius = sphere(f, name)
    own = f.truth.position - places
    near = np.linalg.norm(own, axis=1) < 2 * radius
    for row in some(f, 3):
        line = np.concatenate(f.picture.line(entity, row)) * f.truth.length - places[row]
        same_place(line, own[near], size=np.abs(places).max())


def influence_name(f, entity, name):
    """On top of its sphere, whose it is and how far it reaches, while the flight is near."""
    places, radius = sphere(f, name)
    for row, place in shown(f, entity):
        assert np.linalg.norm(f.truth.position[row] - places[row]) < 2.02 * radius
        off = place * f.truth.length - places[row]
        assert np.linalg.norm(off - [0.0, 0.0, 1.06 * radius]) < 5e-3 * radius
    (label,) = f.picture.fixed(entity, "Points3D:labels")
    said = re.fullmatch(r"sphere of influence of the (\w+), ([\d,.]+) km", label)
    assert said[1] == SPHERES[name][0]
    assert abs(float(said[2].replace(",", "")) * 1e3 - radius) < 0.05 * radius


def planet_name(f, entity, name):
    """Its name where its body is, in its colour, while no other name is there."""
    bodies = spots(f, f"/world/planets/{name}/body")
    for row, place in shown(f, entity):
        assert np.array_equal(place, bodies[row][0])
    assert f.picture.fixed(entity, "Points3D:labels") == [name]
    assert hue(f.picture.color(entity, "Points3D:colors")[0]) == PLANET_HUES[name]


def pan(f, entity):
    """A frame that turns about z at an even rate, at most 440 degrees."""
    pose = poses(f, entity)
    angle = np.unwrap(np.arctan2(pose[:, 1, 0], pose[:, 0, 0]))
    share = (f.truth.time - f.truth.time[0]) / (f.truth.time[-1] - f.truth.time[0])
    assert np.abs(angle - angle[0] - (angle[-1] - angle[0]) * share).max() < 1e-5
    assert abs(angle[0]) < 1e-6
    assert abs(np.degrees(angle[-1])) < 440.1
    assert not pose[:, :3, 3].any()
