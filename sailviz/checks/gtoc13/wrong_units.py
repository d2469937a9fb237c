"""Whether a GTOC13 solution is in other units than s, km and km/s: what flies about the star says so itself."""

from __future__ import annotations

from itertools import product

import numpy as np

from sailviz import two_body
from sailviz.checks.gtoc13.rows import States
from sailviz.checks.gtoc13.rules import AU, MU
from sailviz.constants import DAY, YEAR
from sailviz.exchange.gtoc13 import FLYBY, Solution

PAIRS = 9  # of rows that are looked at
RIGHT, CLEARER = 0.05, 3.0  # a miss of the right units, as a share of the way; how much smaller than any other's
TIMES = (("s", 1.0), ("hours", 3600.0), ("days", DAY), ("years", YEAR))
PLACES = (("km", 1.0), ("m", 1e-3), ("au", AU / 1e3))
SPEEDS = (("km/s", 1.0), ("m/s", 1e-3), ("au/day", AU / 1e3 / DAY), ("au/year", AU / 1e3 / YEAR))


def wrong_units(given: Solution, states: States) -> str:
    """A sentence naming the units in which the rows follow gravity, where they do not in those of the format."""
    rows = np.array(
        [row for arc in given.arcs if arc.kind != FLYBY for row in range(arc.first, arc.last)
         if states.time[row + 1] > states.time[row]], int,
    )  # fmt: skip
    if not len(rows):
        return ""
    rows = rows[np.unique(np.linspace(0, len(rows) - 1, PAIRS).round().astype(int))]
    r0, r1, v0 = states.position[rows], states.position[rows + 1], states.velocity[rows]
    span = states.time[rows + 1] - states.time[rows]

    def miss(time: float, place: float, speed: float) -> float:
        reached, _ = two_body.advance(r0 * place, v0 * speed, span * time, MU)
        with np.errstate(all="ignore"):
            share = np.linalg.norm(reached - r1 * place, axis=1) / np.linalg.norm((r1 - r0) * place, axis=1)
        return float(np.median(np.where(np.isfinite(share), share, np.inf)))

    as_said = miss(1.0, 1.0, 1.0)
    if as_said < RIGHT:
        return ""
    readings = sorted(
        (miss(time[1], place[1], speed[1]), f"{time[0]}, {place[0]} and {speed[0]}")
        for time, place, speed in product(TIMES, PLACES, SPEEDS)
    )
    best, second = readings[0], readings[1]
    if best[0] < RIGHT and CLEARER * best[0] < min(second[0], as_said):
        return f"time, place and velocity look like {best[1]}, and s, km and km/s are due"
    return ""
