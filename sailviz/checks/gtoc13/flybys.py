"""Flybys of a GTOC13 solution: at the body's place, with a turn that its gravity can give, not too often."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from sailviz.checks.gtoc13 import rules
from sailviz.checks.gtoc13.passages import body_state, period
from sailviz.checks.gtoc13.rows import Findings, States
from sailviz.checks.gtoc13.score import Flyby
from sailviz.exchange.gtoc13 import FLYBY, Arc, CompetitionBody, Solution

Floats = NDArray[np.float64]


def judge_flybys(
    given: Solution, states: States, bodies: Mapping[int, CompetitionBody], found: Findings
) -> list[Flyby]:
    """All flybys in the order of time, their violations told."""
    flybys = [_judged(given, states, arc, bodies[arc.body], found) for arc in given.arcs if arc.kind == FLYBY]
    for before, after in pairwise(flybys):
        pause, due = after.time - before.time, rules.FRACTION_OF_PERIOD * period(after.body)
        if before.body.number == after.body.number and pause < due:
            days = pause / 86_400.0, due / 86_400.0
            words = f"body {after.body.number} is flown by again within a third of its period"
            found.violation(after.row, "spacing", days[0], days[1], "d", words)
    return flybys


def _judged(given: Solution, states: States, arc: Arc, body: CompetitionBody, found: Findings) -> Flyby:
    time = float(states.time[arc.first])
    place, velocity = (vector[0] for vector in body_state(body, np.array([time])))
    off = float(np.linalg.norm(states.position[arc.first] - place))
    if not off <= rules.PLACE:
        found.violation(arc.first, "flyby", off / 1e3, rules.PLACE / 1e3, "km", f"body {body.number} is elsewhere")
    before = states.velocity[arc.first] - velocity
    for row in range(arc.first, arc.last + 1):
        apart = float(np.linalg.norm(states.velocity[row] - velocity - given.control[row] * 1e3))
        if apart > rules.SPEED:
            words = "the column of v_inf is not the velocity beside the body's"
            found.note(row, "v_inf", apart / 1e3, rules.SPEED / 1e3, "km/s", words)
    altitude = np.nan
    if arc.last > arc.first:
        found.same_place(arc.first, arc.last, "flyby")
        after = states.velocity[arc.last] - velocity
        altitude = _bent(arc, before, after, body, found) if body.number <= rules.MASSIVE else np.nan
        if body.number > rules.MASSIVE:
            jump = float(np.linalg.norm(after - before))
            if not jump <= rules.SPEED:
                words = f"the velocity jumps at body {body.number}, which has no gravity to speak of"
                found.violation(arc.last, "flyby", jump / 1e3, rules.SPEED / 1e3, "km/s", words)
    science = bool(given.flag[arc.first] == 1)
    return Flyby(arc.first, body, time, float(np.linalg.norm(before)), altitude, states.position[arc.first], science)


def _bent(arc: Arc, before: Floats, after: Floats, body: CompetitionBody, found: Findings) -> float:
    """Altitude m of a flyby that turns v_inf from before to after, inf where it turns nothing."""
    sizes = float(np.linalg.norm(before)), float(np.linalg.norm(after))
    slip = abs(sizes[1] - sizes[0])
    if not slip <= rules.SPEED:
        words = f"the size of v_inf changes at body {body.number}"
        found.violation(arc.last, "flyby", slip / 1e3, rules.SPEED / 1e3, "km/s", words)
    if min(sizes) == 0.0:
        found.violation(arc.last, "altitude", 0.0, None, "", f"the craft rests at body {body.number}")
        return np.inf
    sine = float(np.linalg.norm(after / sizes[1] - before / sizes[0])) / 2  # of half the turn, no arc cosine
    if sine == 0.0:
        words = f"nothing is turned at body {body.number}: the craft passes infinitely far away"
        found.violation(arc.last, "altitude", np.inf, rules.HIGHEST, "radii", words)
        return np.inf
    v2 = (0.5 * (sizes[0] + sizes[1])) ** 2
    altitude = body.gm / v2 * (1.0 / sine - 1.0) - body.radius
    low, high = rules.LOWEST * body.radius, rules.HIGHEST * body.radius
    radii = altitude / body.radius if body.radius else np.inf
    if altitude < low - rules.PLACE:
        words = f"the flyby of body {body.number} is too low"
        found.violation(arc.last, "altitude", radii, rules.LOWEST, "radii", words)
    elif altitude > high + rules.PLACE:
        words = f"the flyby of body {body.number} is too high"
        found.violation(arc.last, "altitude", radii, rules.HIGHEST, "radii", words)
    return altitude
