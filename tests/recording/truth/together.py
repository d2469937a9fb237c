"""Several flights in one picture: each one's place, name, colour and curves against its own rows."""

from __future__ import annotations

import re
from itertools import pairwise

import numpy as np

from . import push, system
from .facts import AU, DAY, planet_place
from .measure import hue, on_ring, same_number, same_place
from .now import PARTS, told
from .plots import convert, unit_of, view_of
from .seen import home, shown

COLORS = ("cyan", "yellow", "pink", "green", "violet", "orange")
LENGTHS = {"au": AU, "km": 1e3}


def word_of(f) -> str:
    """The word of a flight in paths."""
    return "".join(letter if letter.isalnum() else "_" for letter in f.called.lower())


def color_of(f) -> str:
    return COLORS[[g.called for g in f.all].index(f.called)]


def in_its_color(f, entity, component):
    assert {hue(color) for color in f.picture.color(entity, component)} == {color_of(f)}, "another flight's colour"


def beside(check):
    """The check of a flight by itself, of one beside the first: against that one's own rows."""

    def of(f, entity, word, *more):
        check(f.beside(word), entity, *more)

    of.__doc__ = check.__doc__
    return of


@beside
def trail(f, entity, *_):
    """The way of a flight beside the first through its own rows, in its colour."""
    drawn = f.picture.color(entity, "LineStrips3D:colors")[0]
    assert hue(drawn) == color_of(f)
    through_rows(f, entity)


def through_rows(f, entity):
    steps, _ = f.picture.rows(entity, "LineStrips3D:strips")
    done, place = 0, f.truth.place / f.truth.length
    for step in steps:
        lines = f.picture.line(entity, step)
        whole = np.concatenate(lines)
        same_place(whole[-1], f.truth.place[step], f.truth.length)
        for row in range(done + (done in f.truth.breaks), step + 1):
            assert np.linalg.norm(whole - place[row], axis=1).min() < 1e-6 * f.truth.reach, f"row {row} is off its way"
        for line in lines:
            ends = [
                done + int(np.argmin(np.linalg.norm(place[done : step + 1] - end, axis=1))) for end in line[[0, -1]]
            ]
            assert not any(ends[0] <= row < ends[1] for row in f.truth.breaks), "it leads over a gap"
            if ends[1] > ends[0]:
                system.between_rows(f, np.concatenate([line, 0.5 * (line[1:] + line[:-1])]), *ends)
        done = step
    assert done == f.truth.steps[-1]


def name(f, entity, word):
    """The flight's name over or under its craft in its own rows, in its colour, while no other name is there."""
    own = f if word == word_of(f) else f.beside(word)
    assert f.picture.fixed(entity, "Points3D:labels") == [own.called]
    in_its_color(own, entity, "Points3D:colors")
    for row, place in shown(own, entity):
        off = place - home(own, entity)[row]
        same_place(off[:2], np.zeros(2), size=1 + np.abs(place).max())
        assert 0.01 < abs(off[2]) / push.scene_reach(f) < 0.3


@beside
def low_orbit(f, entity):
    """The orbit of each row, all round, in the flight's colour."""
    (circle,) = f.picture.fixed(entity, "LineStrips3D:strips")
    for row, step in enumerate(f.truth.steps):
        line = circle @ f.picture.pose(entity, step)[:3, :3].T + f.picture.pose(entity, step)[:3, 3]
        on_ring(line, f.truth.ring(row), f.truth.length, 2e-6)
    in_its_color(f, entity, "LineStrips3D:colors")


@beside
def low_craft(f, entity):
    """Where it is."""
    places = [f.picture.place(entity, "Points3D:positions", step)[0] for step in f.truth.steps]
    same_place(np.array(places), f.truth.place, f.truth.length)
    in_its_color(f, entity, "Points3D:colors")


@beside
def low_name(f, entity):
    """Its name over it, in its colour."""
    assert f.picture.fixed(entity, "Points3D:labels") == [f.called]
    in_its_color(f, entity, "Points3D:colors")
    for row, place in shown(f, entity):
        same_place(place, 1.06 * f.truth.place[row], f.truth.length)


@beside
def plane_orbit(f, entity):
    """In the plane the ellipse of the row: its longest and shortest width, the centre as far off as the eccentricity
    says."""
    a, e = f.truth.elements["semi_major_axis_m"], f.truth.elements["eccentricity"]
    top = "/world/plane/flight"
    for row, step in enumerate(f.truth.steps):
        pose = f.picture.pose(entity, step, top)
        same_place(np.linalg.norm(pose[:3, 0]), a[row], f.truth.length)
        same_place(np.linalg.norm(pose[:3, 1]), a[row] * np.sqrt(1 - e[row] ** 2), f.truth.length)
        same_place(np.linalg.norm(pose[:3, 3]), a[row] * e[row], f.truth.length, size=1)
    in_its_color(f, entity, "LineStrips3D:colors")


@beside
def plane_altitude(f, entity):
    """As far from the centre as the semi-major axis, with name and altitude in words."""
    for row, step in enumerate(f.truth.steps):
        (spot,) = f.picture.at(entity, "Points3D:positions", step)
        a = f.truth.elements["semi_major_axis_m"][row]
        same_place(np.linalg.norm(spot), a, f.truth.length)
        (text,) = f.picture.at(entity, "Points3D:labels", step)
        words, value = re.fullmatch(r"(.*) (\d+) km", text).groups()
        assert words == f.called
        told(value, (a - f.truth.radius) / 1e3)
    in_its_color(f, entity, "Points3D:colors")


QUANTITIES = {
    "distance": lambda f: np.linalg.norm(f.truth.position, axis=1),
    "speed": lambda f: np.linalg.norm(f.truth.velocity, axis=1),
    "push": lambda f: np.linalg.norm(f.truth.thrust, axis=1),
    "angle": lambda f: f.truth.pitch,
    "inclination": lambda f: f.truth.elements["inclination_rad"],
    "eccentricity": lambda f: f.truth.elements["eccentricity"],
    "height": lambda f: f.truth.position[:, 2],
    "earth": lambda f: np.linalg.norm(f.truth.position - planet_place("Earth", f.truth.seconds), axis=1),
    "altitude": lambda f: f.truth.environment.get(
        "mean_altitude_m", f.truth.elements["semi_major_axis_m"] - f.truth.radius
    ),
}


def curve(f, entity, key, word):
    """A quantity of one flight in its own rows, in its colour and by its name; broken in its gaps."""
    if key in ("apart", "difference"):
        (apart if key == "apart" else difference)(f, entity, word)
        return
    own = f if word == word_of(f) else f.beside(word)
    steps, values = f.picture.rows(entity, "Scalars:scalars")
    values = np.array(values)[:, 0]
    again = np.flatnonzero(np.diff(steps) == 0) + 1
    assert steps[again].tolist() == own.truth.breaks, "a curve leads over a gap"
    assert not np.isfinite(values[again]).any()
    assert np.array_equal(np.delete(steps, again), own.truth.steps)
    same_number(np.delete(values, again), convert(f, entity, QUANTITIES[key](own)))
    dressed(own, entity)


def dressed(f, entity):
    assert f.picture.fixed(entity, "SeriesLines:names") == [f.called]
    in_its_color(f, entity, "SeriesLines:colors")
    low, high = view_of(f, entity).range
    values = np.array(f.picture.rows(entity, "Scalars:scalars")[1])
    assert low <= np.nanmin(values)
    assert np.nanmax(values) <= high


def hermite(f, times):
    """(m, 3) m at times (m,) s of the first flight's clock: SciPy's cubic through positions and velocities of each
    stretch between gaps; NaN where the flight has no rows about, or far ones."""
    from scipy.interpolate import CubicHermiteSpline

    clock, edges = f.truth.clock, [0, *(row + 1 for row in f.truth.breaks), len(f.truth)]
    found = np.full((len(times), 3), np.nan)
    for a, b in pairwise(edges):
        here = (times >= clock[a]) & (times <= clock[b - 1])
        if b - a > 1:
            spline = CubicHermiteSpline(clock[a:b], f.truth.position[a:b], f.truth.velocity[a:b])
            found[here] = spline(times[here])
    return found


def apart(f, entity, word):
    """The distance of a flight from the first one at the same time of the clock, in the rows of the first."""
    other = f.beside(word)
    off = np.linalg.norm(hermite(other, f.truth.clock) - f.truth.position, axis=1)
    compared(f, entity, off)
    dressed(other, entity)
    by_date = f.truth.seconds is not None
    assert ("at the same date" in view_of(f, entity).name) == by_date
    assert f"from {f.called} " in view_of(f, entity).name


def compared(f, entity, true):
    steps, values = f.picture.rows(entity, "Scalars:scalars")
    values = np.array(values)[:, 0]
    again = np.flatnonzero(np.diff(steps) == 0) + 1
    assert np.array_equal(np.delete(steps, again), f.truth.steps)
    shown_values = np.delete(values, again)
    size = 1 / LENGTHS[unit_of(f, entity)] if unit_of(f, entity) in LENGTHS else None
    expected = true * size if size else convert(f, entity, true)
    same_number(shown_values, expected, 1e-7)
    assert np.isfinite(shown_values).sum() > 5


def difference(f, entity, word):
    """What a flight has more of the quantity than the first one, at the same time of the clock."""
    other, title = f.beside(word), view_of(f, entity).name
    assert f": difference from {f.called} [" in title
    key = {"Distance from the Sun": "distance", "Altitude": "altitude", "Push": "push", "Speed": "speed"}[
        title.split(":")[0]
    ]
    times = f.truth.clock
    if key == "distance":
        theirs = np.linalg.norm(hermite(other, times), axis=1)
    else:
        theirs = np.interp(times, other.truth.clock, QUANTITIES[key](other), left=np.nan, right=np.nan)
        theirs[~np.isfinite(hermite(other, times)[:, 0])] = np.nan
    compared(f, entity, theirs - QUANTITIES[key](f))
    dressed(other, entity)


def begins_and_ends(f) -> tuple[float, float]:
    """s of the first flight's clock."""
    return min(g.truth.clock[0] for g in f.all), max(g.truth.clock[-1] for g in f.all)


def line(f, entity):
    """Every part of every line: of the first flight by its name, of the others how far from it; and while the first one
    does not fly one that does, by its name, with when the first starts or ended."""
    begin, end = begins_and_ends(f)
    steps, lines = f.picture.rows(entity, "TextDocument:text")
    assert steps[0] == 0
    assert steps[-1] == f.truth.steps[-1]
    for step, (text,) in zip(steps, lines, strict=True):
        assert len(text) < 170
        when, *words = parts_of(text)
        counted(f, when, f.truth.clock[step], begin, end)
        told_of(f, step, words[0])
        others = words[1:]
        for part in others:
            about_another(f, int(step), part, begin)
        assert sum(any(part.startswith(g.called) for g in f.all[1:]) or "others" in part for part in others) >= 1
    loose = sorted(f.picture.between[entity]["TextDocument:text"]) if entity in f.picture.between else []
    for ns, (text,) in loose:
        when, edge, *words = parts_of(text)
        time = ns * 1e-9
        counted(f, when, time, begin, end)
        early = time < f.truth.clock[0]
        assert early or time > f.truth.clock[-1]
        found = re.fullmatch(rf"{re.escape(f.called)} (starts|ended) on (day|hour) ([\d.]+)", edge)
        assert found.group(1) == ("starts" if early else "ended")
        told(found.group(3), (f.truth.clock[0 if early else -1] - begin) / unit_size(found.group(2)))
        own = next(g for g in f.all[1:] if words[0].startswith(f"{g.called} "))
        row = int(np.argmin(np.abs(own.truth.clock - time)))
        assert abs(own.truth.clock[row] - time) < 1e-6
        told_of(own, row, words[0])
        for part in words[1:]:
            plain_part(own, row, part)
    late = max(g.truth.clock[-1] for g in f.all) > f.truth.clock[-1]
    assert late == any(ns * 1e-9 > f.truth.clock[-1] for ns, _ in loose), "nothing is said after the first has ended"


def parts_of(text):
    """When, and the parts after it."""
    parts = re.split(r"\s*·\s*", text.removeprefix("### "))
    dated = re.match(r"\d{4}-", parts[0])
    return [parts[:2] if dated else parts[:1], *parts[2 if dated else 1 :]]


def unit_size(word) -> float:
    return {"day": DAY, "hour": 3600.0}[word.lower()]


def counted(f, when, time, begin, end):
    word, now, total = re.fullmatch(r"(Day|Hour) (-?[\d.]+) of ([\d.]+)", when[-1]).groups()
    told(now, (time - begin) / unit_size(word))
    told(total, (end - begin) / unit_size(word))
    assert (len(when) == 2) == (f.truth.seconds is not None)
    if len(when) == 2:
        start = f.truth.seconds[0] - f.truth.clock[0]
        stamp = np.datetime64("2000-01-01T12:00:00") + np.timedelta64(round(start + time), "s")
        assert str(stamp).startswith(when[0][:10])


def told_of(f, row, words):
    """A flight's name and where it is."""
    assert words.startswith(f"{f.called} "), f"{words!r} is not of {f.called}"
    plain_part(f, row, words.removeprefix(f"{f.called} "))


def plain_part(f, row, words):
    """A part of the line that a single flight's line has as well."""
    found = [(check, match) for pattern, check in PARTS.items() if (match := pattern.fullmatch(words))]
    assert len(found) == 1, f"nobody knows {words!r}"
    check, match = found[0]
    check(f, int(row), *match.groups())


def about_another(f, row, words, begin):
    """How far another flight is, when it starts or has ended; or a part of the first one's own."""
    other = next((g for g in f.all[1:] if words.startswith(f"{g.called} ")), None)
    time = f.truth.clock[row]
    many = re.fullmatch(r"others ([\d.,]+) to ([\d.,]+) (au|km) away", words)
    if many:
        far = [np.linalg.norm(hermite(g, np.array([time]))[0] - f.truth.position[row]) for g in f.all[1:]]
        told(many.group(1), np.nanmin(far) / LENGTHS[many.group(3)])
        told(many.group(2), np.nanmax(far) / LENGTHS[many.group(3)])
        return
    if other is None:
        plain_part(f, row, words)
        return
    words = words.removeprefix(f"{other.called} ")
    away = re.fullmatch(r"([\d.,]+) (au|km) away", words)
    gone = re.fullmatch(r"(starts|ended) on (day|hour) ([\d.]+)", words)
    high = re.fullmatch(r"(\d+) km (higher|lower)", words)
    if away:
        off = np.linalg.norm(hermite(other, np.array([time]))[0] - f.truth.position[row])
        told(away.group(1), off / LENGTHS[away.group(2)])
    elif gone:
        edge = other.truth.clock[0 if gone.group(1) == "starts" else -1]
        assert time < edge if gone.group(1) == "starts" else time > edge
        told(gone.group(3), (edge - begin) / unit_size(gone.group(2)))
    else:
        off = np.interp(time, other.truth.clock, QUANTITIES["altitude"](other)) - QUANTITIES["altitude"](f)[row]
        if high:
            assert (off > 0) == (high.group(2) == "higher")
            told(high.group(1), abs(off) / 1e3)
        else:
            assert words == "as high"
            assert abs(off) < 500.0


def about(f, entity):
    """Which colour is whose, how the flights stand together, and how far each gets from the first."""
    (text,) = f.picture.fixed(entity, "TextDocument:text")
    assert f"**at the same {'date' if f.truth.seconds is not None else 'time since the start'}**" in text
    lines = re.findall(r"^- \*\*(\w+)\*\* (.*?): (.*), ([\d.]+) (day|hour)s$", text, re.MULTILINE)
    assert [(color, called) for color, called, *_ in lines] == [(color_of(g), g.called) for g in f.all]
    for g, (_, _, title, length, word) in zip(f.all, lines, strict=True):
        facts = f.truth.recording[f"/flight/{word_of(g)}/scene"]
        assert title == str(facts["title"][0])
        told(length, (g.truth.clock[-1] - g.truth.clock[0]) / unit_size(word))
    for called, far, unit in re.findall(r"^- (.*?) at most \*\*([\d.]+) (\w+)\*\* away", text, re.MULTILINE):
        other = next(g for g in f.all if g.called == called)
        off = np.linalg.norm(hermite(other, f.truth.clock) - f.truth.position, axis=1)
        told(far, np.nanmax(off) / LENGTHS[unit])
    for called, far, way in re.findall(r"^- (.*?) at most \*\*([\d.]+) km\*\* (higher|lower)", text, re.MULTILINE):
        other, high = next(g for g in f.all if g.called == called), QUANTITIES["altitude"]
        off = np.interp(f.truth.clock, other.truth.clock, high(other), left=np.nan, right=np.nan) - high(f)
        told(far, np.nanmax(np.abs(off)) / 1e3)
        assert (off[np.nanargmax(np.abs(off))] > 0) == (way == "higher")
    assert len(re.findall(r"at most \*\*", text)) == (len(f.all) - 1 if len(f.all) <= 3 else 0)
