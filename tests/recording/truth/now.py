"""The line of the moment against the rows: each number in it, to its last digit."""

from __future__ import annotations

import re

import numpy as np

from . import phases
from .facts import AU, DAY

PUSHES = {"mm/s²": 1e-3, "µm/s²": 1e-6, "nm/s²": 1e-9}
PARTS = {}


def part(pattern):
    """Register what one part of the line claims, by its pattern."""

    def add(check):
        PARTS[re.compile(pattern)] = check
        return check

    return add


def number(text: str) -> tuple[float, float]:
    """A number and half of its last digit."""
    digits = text.replace(",", "")
    return float(digits), 0.5001 * 10.0 ** -len(digits.partition(".")[2])


def told(text: str, true: float):
    value, half = number(text)
    assert abs(value - true) <= half + 1e-9 * abs(true), f"{text} for {true:.6g}"


def line(f, entity):
    """Every part of every line is what the row says: date, day, distance, speed, push, angle, altitude, drag, light,
    spread; and of every gap that there is no data, from its beginning until the next row, which has a line."""
    steps, lines = f.picture.rows(entity, "TextDocument:text")
    assert steps[0] == 0
    assert steps[-1] == f.truth.steps[-1]
    for step, (text,) in zip(steps, lines, strict=True):
        assert text.startswith("### ")
        assert not phases.names(f) or any(f"   {name}   " in text for name in phases.names(f)), "no phase is told"
        assert len(text) < 160
        for words in re.split(r"\s*·\s*", text.removeprefix("### ")):
            found = [(check, match) for pattern, check in PARTS.items() if (match := pattern.fullmatch(words))]
            assert len(found) == 1, f"nobody knows {words!r}"
            check, match = found[0]
            check(f, int(step), *match.groups())
    within = sorted(f.picture.between[entity]["TextDocument:text"])
    assert len(within) == len(f.truth.gaps), "a gap is not told"
    for (ns, (text,)), (start, end), row in zip(within, f.truth.gaps, f.truth.breaks, strict=True):
        assert start < ns * 1e-9 < start + 0.01 * (end - start)
        assert row + 1 in steps
        when, *said = re.split(r"\s*·\s*(?=Day|Hour|no data|seen)", text.removeprefix("### "))
        counted = re.fullmatch(r"(Day|Hour) ([\d.]+) of ([\d.]+)", said[0] if len(said) == 3 else when)
        size = {"Day": DAY, "Hour": 3600.0}[counted.group(1)]
        told(counted.group(2), (ns * 1e-9 - f.truth.time[0]) / size)
        until = re.fullmatch(rf"no data until {counted.group(1).lower()} ([\d.]+)", said[-2])
        told(until.group(1), (end - f.truth.time[0]) / size)
        assert said[-1] == "seen as it last was"


@part(r"(\d{4}-\d\d-\d\d)(?: (\d\d:\d\d))?")
def date(f, row, day, minute):
    stamp = np.datetime64("2000-01-01T12:00:00") + np.timedelta64(round(f.truth.seconds[row]), "s")
    assert str(stamp)[:10] == day
    assert minute is None or str(stamp)[11:16] == minute


@part(r"(Day|Hour|Year) ([\d.]+) of ([\d.]+)")
def count(f, row, word, now, total):
    size = {"Day": DAY, "Hour": 3600.0, "Year": 365.25 * DAY}[word]
    told(now, (f.truth.time[row] - f.truth.time[0]) / size)
    told(total, (f.truth.time[-1] - f.truth.time[0]) / size)


@part(r"(spiral in|crank|watch the poles|full thrust|coast|partial thrust)")  # of the flights that are looked at
def phase(f, row, name):
    assert name == phases.names(f)[phases.of_rows(f)[row]]


@part(r"([\d.]+) au from (the Sun|Altaira)")
def distance(f, row, value, star):
    assert star.endswith(f.truth.body)
    told(value, np.linalg.norm(f.truth.position[row]) / AU)


@part(r"([\d.]+) × 10\^(-?\d+) m from the centre")
def far(f, row, value, power):
    told(value, np.linalg.norm(f.truth.position[row]) / 10.0 ** int(power))


@part(r"([\d,]+) km from the centre of (the Earth|Mars)")
def from_centre(f, row, value, body):
    told(value, np.linalg.norm(f.truth.position[row]) * 1e-3)
    assert body.endswith(f.truth.body)


@part(r"([\d.]+) (k?m/s)")
def speed(f, row, value, unit):
    told(value, np.linalg.norm(f.truth.velocity[row]) * {"km/s": 1e-3, "m/s": 1.0}[unit])


@part(r"(push|drag|air drag) ([\d.]+) (\S+/s²)")
def push(f, row, word, value, unit):
    told(value, braking(f, word)[row] / PUSHES[unit])


@part(r"(?:push ([\d.]+)|no push)(?: (\S+/s²))? \((.*)\)")
def shares(f, row, value, unit, words):
    """The whole push, and each device in its order with what it adds, in the same unit; off where it adds nothing."""
    told(value or "0", braking(f, "push")[row] / PUSHES[unit or "mm/s²"])
    for (name, device), said in zip(f.truth.devices.items(), words.split(", "), strict=True):
        size = device["magnitude_m_s2"][row]
        cut, amount = said.rsplit(" ", 1)
        assert cut == name or name.startswith(cut.removesuffix("…"))
        if size == 0:
            assert amount == "off"
        else:
            told(amount, size / PUSHES[unit or "mm/s²"])


@part(r"no (push|drag|air drag)")
def nothing(f, row, word):
    assert braking(f, word)[row] == 0


def braking(f, word) -> np.ndarray:
    if word == "air drag":
        return f.truth.environment["air_drag_N"] / f.truth.recording["/state"]["mass_kg"]
    return np.linalg.norm(f.truth.thrust, axis=1)


@part(r"drag (\d+) nN per metre")
def force(f, row, value):
    told(value, 1e9 * f.truth.environment["plasma_force_N_m"][row])


@part(r"(sail|E-sail) (\d+)° off the (sunlight|wind)")
def angle(f, row, sail, value, flow):
    assert not f.truth.stowed[row]
    told(value, np.degrees(f.truth.pitch[row]))
    assert (sail, flow) == {"solar-sail": ("sail", "sunlight"), "electric-sail": ("E-sail", "wind")}[f.truth.kind]


@part(r"(sail|E-sail) stowed")
def stowed(f, row, sail):
    assert f.truth.stowed[row]
    assert sail == {"solar-sail": "sail", "electric-sail": "E-sail"}[f.truth.kind]


@part(r"(-?\d+) km up")
def altitude(f, row, value):
    told(value, heights(f)[row] / 1e3)


@part(r"(\d+) to (\d+) km up")
def ellipse(f, row, low, high):
    a, e = f.truth.elements["semi_major_axis_m"][row], f.truth.elements["eccentricity"][row]
    told(low, (a * (1 - e) - f.truth.radius) / 1e3)
    told(high, (a * (1 + e) - f.truth.radius) / 1e3)


def heights(f) -> np.ndarray:
    """m: the mean altitude, below 200 km the height over the ground."""
    mean = f.truth.environment.get("mean_altitude_m", f.truth.elements["semi_major_axis_m"] - f.truth.radius)
    own = np.linalg.norm(f.truth.position, axis=1) - f.truth.radius
    return np.where(mean > 200e3, mean, own)


@part(r"in (sunlight|shadow)")
def light(f, row, where):
    assert f.truth.lit[row] == (where == "sunlight")


@part(r"spread ±([\d.,]+) (au|km)(?: without control|, .*?)?(?:, ±([\d.,]+) (au|km)(?: with|, .*)?)?")
def spread(f, row, widest, unit, narrowest, other):
    sigmas = sorted((s[0] for s in f.spreads(f.truth.time[row])), reverse=True)
    order = sorted(f.spreads(f.truth.time[-1]), key=lambda s: -s[0])
    now = {name: s for s, name in f.spreads(f.truth.time[row])}
    assert sigmas
    told(widest, now[order[0][1]] * {"au": 1.0, "km": AU / 1e3}[unit])
    if narrowest is not None:
        told(narrowest, now[order[-1][1]] * {"au": 1.0, "km": AU / 1e3}[other])
