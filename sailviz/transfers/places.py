"""Where a transfer begins and ends: orbits of planets and of small bodies, circles, and the bodies that move on them.

Small bodies are known by name (assets/small_bodies.csv, each with its epoch and source) or read from files of JPL's
Small-Body Database and the Minor Planet Center. They move on the ellipse of their elements. How long that is true is
checked here: against the planets that they would pass.
"""

from __future__ import annotations

import csv
import re
from dataclasses import dataclass
from datetime import datetime, timedelta
from functools import cache
from pathlib import Path

import numpy as np

from sailviz import ephemeris
from sailviz.constants import AU, DAY, MU_SUN, YEAR
from sailviz.design.minimum_time.moving_bodies import J2000_JD, MovingBody, Planet, SmallBodyOrbit
from sailviz.elements import Elements
from sailviz.exchange.small_bodies import SmallBody, read_small_body
from sailviz.shipped import shipped_folder
from sailviz.sky.bodies import BODIES
from sailviz.words import length, nearest

OTHER_NAMES = {"ho3": "kamooalewa", "2016 ho3": "kamooalewa", "kamo'oalewa": "kamooalewa", "kamoʻoalewa": "kamooalewa"}
OLD = 10.0  # yr from the epoch of elements after which they are told to be old
PASSES_NEAR = 0.05 * AU  # m from a planet: told
CHANGES_ORBIT = 0.01 * AU  # m from the Earth, and in proportion to its share in the Sun's mass from others: refused
STEP = 0.5 * DAY  # s, in which a passage is looked for: at 20 km/s from the nearest point 0.003 au at most
LONGEST_WAY = 200 * YEAR  # s, over which passages are looked for


@dataclass(frozen=True)
class Place:
    """Where a transfer begins or ends: words, an orbit about the Sun, whether it is a circle by wish, and the body
    that is on it where its place is known. source : of the elements, in words."""

    name: str
    orbit: Elements[float]
    circle: bool = False
    body: MovingBody | None = None
    source: str = ""

    @property
    def radius(self) -> float:
        """Mean distance from the Sun, m."""
        return float(self.orbit.semi_major_axis)

    @property
    def inclined(self) -> bool:
        """Whether it is a circle out of the ecliptic."""
        return self.circle and bool(self.orbit.inclination)

    @property
    def table(self) -> dict[str, str | float]:
        """The orbit as a scene's [target]."""
        e = self.orbit
        found: dict[str, str | float] = {
            "name": f"orbit of {self.name}" if self.name[0].isalpha() else f"circle of {self.name}"
        }
        if e.eccentricity == 0:
            found["radius_au"] = self.radius / AU
        else:
            found |= {"semi_major_axis_au": self.radius / AU, "eccentricity": float(e.eccentricity)}
        if e.inclination:
            found |= {"inclination_deg": float(np.degrees(e.inclination)), "raan_deg": float(np.degrees(e.raan))}
        if e.eccentricity != 0:
            found["argument_deg"] = float(np.degrees(e.argument))
        return found

    @property
    def moving_table(self) -> dict[str, str | float]:
        """The body on its orbit as a scene's [target]."""
        if not isinstance(self.body, SmallBodyOrbit):
            return {"name": f"orbit of {self.name}", "planet": self.name.lower()}
        date = datetime(2000, 1, 1, 12) + timedelta(days=self.body.date - J2000_JD)
        return self.table | {
            "mean_anomaly_deg": float(np.degrees(self.body.mean_anomaly)),
            "elements_date": date.isoformat(),
        }


@cache
def _small_bodies() -> dict[str, dict[str, str]]:
    with open(shipped_folder("assets") / "small_bodies.csv", newline="", encoding="utf-8") as file:
        next(file)  # what it is
        return {row["name"]: row for row in csv.DictReader(file)}


def names() -> tuple[str, ...]:
    """Words of all places: planets, from the Sun outwards, then small bodies."""
    return (*(name.lower() for name in ephemeris.PLANETS), *_small_bodies())


def place(name: str) -> Place:
    """A planet, by mean elements of J2000, or a small body by its osculating elements. ValueError with the nearest
    name."""
    key = str(name).strip().lower()
    key = OTHER_NAMES.get(key, key)
    if key in _small_bodies():
        return _by_row(key.capitalize(), _small_bodies()[key])
    if key not in names():
        raise ValueError(f'there is no place called "{name}". {nearest(key, names())}')
    word = key.capitalize()
    return Place(word, ephemeris.planet_ellipse(word), body=Planet(word))


def _by_row(name: str, row: dict[str, str]) -> Place:
    i, node, argument = (float(np.radians(float(row[key]))) for key in ("i", "node", "argument"))
    orbit = Elements(float(row["a_au"]) * AU, float(row["e"]), i, node, argument, 0.0)
    body = SmallBodyOrbit(name, orbit, float(np.radians(float(row["mean_anomaly"]))), float(row["epoch"]))
    return Place(name, orbit, body=body, source=row["source"])


def place_of_file(path: str | Path, name: str | None = None) -> Place:
    """A small body in a file that `read_small_body` reads. name : of one of several. ValueError, in one sentence, also
    for an orbit that is open."""
    try:
        found = read_small_body(path, name)
    except OSError as error:
        raise ValueError(f"{path} cannot be read: {error.strerror or error}") from None
    if not found.eccentricity < 1.0:
        raise ValueError(
            f"{found.name or path} does not come back: its eccentricity is {found.eccentricity:g}, and flights are "
            "searched for to bodies on ellipses"
        )
    return _by_perihelion(found, Path(path).name)


def _by_perihelion(found: SmallBody, source: str) -> Place:
    """The mean anomaly is that of the epoch, or of the passage of the perihelion, which is 0."""
    a = found.perihelion / (1.0 - found.eccentricity)
    word = short_name(found.name)
    orbit = Elements(a, found.eccentricity, found.inclination, found.node, found.argument, 0.0)
    date = found.passage if found.epoch is None else found.epoch
    mean = np.remainder(np.sqrt(MU_SUN / a**3) * (date - found.passage) * DAY, 2 * np.pi)
    return Place(word, orbit, body=SmallBodyOrbit(word, orbit, float(mean), date), source=source)


def short_name(name: str) -> str:
    """A name out of that of a catalogue, fit for a picture: "Apophis" of "99942 Apophis (2004 MN4)"."""
    named = re.match(r"\s*(?:\(\d+\)\s+|\d+\s+|\d+[PDI]/)([^\W\d_][^\W\d_A-Z][^()]*)", name)  # not "2016 HO3"
    word = named[1].strip() if named else name.strip(" ()")
    return re.sub(r"[^\w.-]+", "-", word).strip("-") or "body"


def circle(radius: float, inclination: float = 0.0, name: str = "") -> Place:
    """A circle about the Sun: radius m, inclination rad to the ecliptic."""
    if not (np.isfinite(radius) and radius > 0):
        raise ValueError(f"a radius must be a positive number, got {radius!r}")
    if not 0 <= inclination <= np.pi:
        raise ValueError(f"an inclination lies between 0 and 180 deg, got {np.degrees(inclination):g} deg")
    return Place(name or length(radius), Elements(float(radius), 0.0, float(inclination), 0.0, 0.0, 0.0), True)


@dataclass(frozen=True)
class Passage:
    """Of a planet by a small body: when it is nearest (UTC), and how near, m."""

    planet: str
    date: np.datetime64
    distance: float

    @property
    def words(self) -> str:
        """For a sentence."""
        return f"{self.planet} on {np.datetime_as_string(self.date, 'D')}, {self.distance / AU:.4f} au"


def passages(body: SmallBodyOrbit, until: np.datetime64) -> list[Passage]:
    """Planets that a body passes nearer than PASSES_NEAR between the epoch of its elements and a date, in their order;
    nothing over more than LONGEST_WAY."""
    epoch = np.datetime64("2000-01-01T12:00:00", "ns") + np.timedelta64(round((body.date - J2000_JD) * DAY), "s")
    span = float((until - epoch) / np.timedelta64(1, "s"))
    if abs(span) > LONGEST_WAY:
        return []
    time = np.linspace(0.0, span, int(abs(span) / STEP) + 3)
    place = body.state(epoch, time)[0]
    found = []
    for name in ephemeris.PLANETS:
        gap = np.linalg.norm(place - ephemeris.planet_position(name, epoch, time), axis=1)
        lowest = np.flatnonzero((gap[1:-1] < gap[:-2]) & (gap[1:-1] <= gap[2:]) & (gap[1:-1] < PASSES_NEAR)) + 1
        for i in lowest:
            around = np.linspace(time[i - 1], time[i + 1], 400)
            apart = body.state(epoch, around)[0] - ephemeris.planet_position(name, epoch, around)
            finer = np.linalg.norm(apart, axis=1)
            best = int(np.argmin(finer))
            date = epoch + np.timedelta64(round(float(around[best])), "s")
            found.append(Passage(name, date, float(finer[best])))
    return sorted(found, key=lambda passage: abs(passage.date - epoch))


def trusted(place: Place, until: np.datetime64) -> list[str]:
    """What is to be told of a small body's elements for a flight that ends at a date (UTC), a sentence each.

    ValueError where they no longer hold then: a passage in between makes another orbit of it.
    """
    body = place.body
    if not isinstance(body, SmallBodyOrbit):
        return []
    epoch = np.datetime64("2000-01-01T12:00:00", "ns") + np.timedelta64(round((body.date - J2000_JD) * DAY), "s")
    seen, day = passages(body, until), np.datetime_as_string(until, "D")
    for passage in seen:
        if passage.distance < CHANGES_ORBIT * _weight(passage.planet):
            raise ValueError(
                f"{place.name} passes {passage.words}, which changes its orbit: elements of "
                f"{np.datetime_as_string(epoch, 'D')} end there, take newer ones for {day}"
            )
    told = [f"{place.name} passes {passage.words}: it will stand elsewhere than its elements say" for passage in seen]
    years = float((until - epoch) / np.timedelta64(1, "s")) / YEAR
    if abs(years) > OLD:
        told.append(f"the elements of {place.name} are {abs(years):.0f} years from the flight")
    return told


def _weight(planet: str) -> float:
    """Square root of a planet's mass in the Earth's: what turns the way of a passing body by the same angle is twice as
    far for a planet four times as heavy at the same pace."""
    return float(np.sqrt(BODIES[planet.lower()].mu / BODIES["earth"].mu))
