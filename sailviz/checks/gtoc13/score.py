"""The score of a GTOC13 solution, but for the factor of the day on which it was handed in.

    J = b c sum_k w_k sum_i S F,   F = 0.2 + exp(-v / 13) / (1 + exp(-5 (v - 1.5))),   v in km/s
    S_1 = 1,   S_i = 0.1 + 0.9 / (1 + 10 sum_{j<i} exp(-theta_ij^2 / 50)),   theta in degrees

Source: JPL, GTOC13 problem statement (2025).
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sailviz.checks.gtoc13.rules import MASSIVE, MOST_FLYBYS, YANDI
from sailviz.exchange.gtoc13 import CompetitionBody

Floats = NDArray[np.float64]

FULL_TOUR = 1.2  # all planets, Yandi and so many small bodies
SMALL_BODIES_OF_A_TOUR = 13


SECTORS = 12  # of the wheel of a body, 30 degrees of longitude each from the x axis on


class Wheel(NamedTuple):
    """Where about the star a body was flown by. points : what its flybys add, before the bonus; sectors (12,) : how
    many of those that count lie in each 30 degrees of longitude from the x axis on."""

    body: CompetitionBody
    points: float
    sectors: tuple[int, ...]

    @property
    def flybys(self) -> int:
        """How many count."""
        return sum(self.sectors)

    @property
    def words(self) -> str:
        """A sign for each sector: a dot, or how many flybys it has."""
        return "".join("." if not count else str(count) if count < 10 else "+" for count in self.sectors)


class Flyby(NamedTuple):
    """A flyby as it was judged. row : its first one in the file; time s; v_inf m/s; altitude m, inf without a turn, NaN
    where the body does not bend the way; place (3,) m. counts : whether it is science and scores; quality F and
    season S, points: 0 where it does not count."""

    row: int
    body: CompetitionBody
    time: float
    v_inf: float
    altitude: float
    place: Floats
    science: bool
    counts: bool = False
    quality: float = 0.0
    season: float = 0.0

    @property
    def points(self) -> float:
        """What it adds, before the bonus."""
        return self.body.weight * self.quality * self.season


def quality(v_inf: float) -> float:
    """F of a speed in m/s."""
    v = v_inf / 1e3
    return float(0.2 + np.exp(-v / 13.0) / (1.0 + np.exp(np.minimum(-5.0 * (v - 1.5), 700.0))))


def season(place: Floats, before: Iterable[Floats]) -> float:
    """S of a flyby at a place (3,), after others of the same body."""
    others = list(before)
    if not others:
        return 1.0
    here = place / np.linalg.norm(place)
    there = np.array([other / np.linalg.norm(other) for other in others])
    sine = np.linalg.norm(np.cross(there, here), axis=1)
    theta = np.degrees(np.arctan2(sine, there @ here))
    return float(0.1 + 0.9 / (1.0 + 10.0 * np.sum(np.exp(-(theta**2) / 50.0))))


def wheels(flybys: Iterable[Flyby]) -> tuple[Wheel, ...]:
    """The wheel of every body that scores, in the order of their numbers."""
    found: dict[int, list[Flyby]] = {}
    for flyby in flybys:
        if flyby.counts:
            found.setdefault(flyby.body.number, []).append(flyby)
    made = []
    for _, some in sorted(found.items()):
        longitude = [np.degrees(np.arctan2(flyby.place[1], flyby.place[0])) % 360.0 for flyby in some]
        sectors = [0] * SECTORS
        for angle in longitude:
            sectors[int(angle * SECTORS / 360.0) % SECTORS] += 1
        made.append(Wheel(some[0].body, sum(flyby.points for flyby in some), tuple(sectors)))
    return tuple(made)


def scored(flybys: Iterable[Flyby], first_perihelion: float) -> tuple[tuple[Flyby, ...], float]:
    """Flybys with what they score, in the order of time, and the bonus b.

    first_perihelion : s, inf for none; asteroids and comets count after it only. Of one body the first 13 science
    flybys count.
    """
    seen: dict[int, list[Floats]] = {}
    found = []
    for flyby in flybys:
        number, before = flyby.body.number, seen.setdefault(flyby.body.number, [])
        early = number > YANDI and not flyby.time >= first_perihelion
        if flyby.science and not early and len(before) < MOST_FLYBYS:
            flyby = flyby._replace(counts=True, quality=quality(flyby.v_inf), season=season(flyby.place, before))
            before.append(flyby.place)
        found.append(flyby)
    counted = {number for number, places in seen.items() if places}
    planets = counted >= {*range(1, MASSIVE + 1), YANDI}
    small = sum(number > YANDI for number in counted)
    return tuple(found), FULL_TOUR if planets and small >= SMALL_BODIES_OF_A_TOUR else 1.0
