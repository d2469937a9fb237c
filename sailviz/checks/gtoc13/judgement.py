"""Judge a GTOC13 solution: fly every arc again, look at every rule, count the score.

from sailviz.checks.gtoc13 import judge
judge("solution.txt", "catalogue").legal
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from sailviz import two_body
from sailviz.checks.gtoc13 import rules
from sailviz.checks.gtoc13.controls import edge_on_at_most, step_errors
from sailviz.checks.gtoc13.flybys import judge_flybys
from sailviz.checks.gtoc13.passages import on_conic
from sailviz.checks.gtoc13.rows import Findings, States, states_of
from sailviz.checks.gtoc13.rules import Finding
from sailviz.checks.gtoc13.sail import Steps, unit
from sailviz.checks.gtoc13.score import Flyby, scored, wheels
from sailviz.checks.gtoc13.wrong_units import wrong_units
from sailviz.errors import RecordingError
from sailviz.exchange.gtoc13 import CONIC, FLYBY, SAIL, Arc, Solution, read_catalogue, read_solution

Floats = NDArray[np.float64]


class Approach(NamedTuple):
    """A closest approach to the star: at time s, at a distance m, in the arc that ends at a row (index). passed :
    whether the craft goes away again, which it does not where the file ends."""

    time: float
    distance: float
    row: int
    passed: bool = True


@dataclass(frozen=True)
class Judgement:
    """What is found of a solution. violations, notes : in the order of the rows; flybys with what they score; bonus b;
    approaches : to the star, in the order of time; middles : row at which a sail step ends (index) -> normal (3,) in
    the middle with which it was flown."""

    solution: Solution
    violations: tuple[Finding, ...]
    notes: tuple[Finding, ...]
    flybys: tuple[Flyby, ...]
    bonus: float
    approaches: tuple[Approach, ...]
    middles: dict[int, Floats]

    @property
    def legal(self) -> bool:
        """Whether no rule is broken."""
        return not self.violations

    @property
    def score(self) -> float:
        """J / c: without the factor of the day on which it was handed in."""
        return self.bonus * sum(flyby.points for flyby in self.flybys)

    def as_json(self) -> dict[str, Any]:
        """For a script."""
        count = {kind: sum(arc.kind == kind for arc in self.solution.arcs) for kind in (CONIC, SAIL, FLYBY)}
        return {
            "file": self.solution.name,
            "legal": self.legal,
            "score_over_c": self.score,
            "bonus": self.bonus,
            "rows": len(self.solution.time),
            "arcs": count,
            "start_s": float(self.solution.time[0]),
            "end_s": float(self.solution.time[-1]),
            "violations": [finding.as_json() for finding in self.violations],
            "notes": [finding.as_json() for finding in self.notes],
            "flybys": [_flyby_json(flyby) for flyby in self.flybys],
            "wheel": [
                {"body": each.body.number, "flybys": each.flybys, "points": each.points, "sectors": list(each.sectors)}
                for each in wheels(self.flybys)
            ],
            "perihelia": [
                {"time_s": each.time, "distance_au": each.distance / rules.AU, "row": each.row + 1}
                for each in self.approaches
            ],
        }


def _flyby_json(flyby: Flyby) -> dict[str, Any]:
    bent = np.isfinite(flyby.altitude)
    return {
        "row": flyby.row + 1,
        "time_s": flyby.time,
        "body": flyby.body.number,
        "v_inf_km_s": flyby.v_inf / 1e3,
        "altitude_km": flyby.altitude / 1e3 if bent else None,
        "altitude_radii": flyby.altitude / flyby.body.radius if bent else None,
        "science": flyby.science,
        "counts": flyby.counts,
        "weight": flyby.body.weight,
        "F": flyby.quality,
        "S": flyby.season,
        "points": flyby.points,
    }


def judge(solution: Solution | str | Path, catalogue: str | Path | None = None) -> Judgement:
    """Judge a solution.

    catalogue : the folder with the competition's own files, needed where the solution has flybys. RecordingError, in
    one sentence, for files that cannot be read, bodies that the catalogue lacks, and numbers in other units.
    """
    given = solution if isinstance(solution, Solution) else read_solution(solution)
    bodies = {} if catalogue is None else read_catalogue(catalogue)
    needed = sorted({arc.body for arc in given.arcs if arc.kind == FLYBY})
    lacking = [str(number) for number in needed if number not in bodies]
    if lacking:
        whose = f"body {lacking[0]}" if len(lacking) == 1 else f"bodies {', '.join(lacking[:6])}"
        if catalogue is None:
            raise RecordingError(
                f"{given.name} flies by {whose}: name the folder of the competition's catalogue with --catalogue"
            )
        raise RecordingError(f"{given.name} flies by {whose}, which the catalogue {catalogue} does not have")
    states = states_of(given)
    words = wrong_units(given, states)
    if words:
        raise RecordingError(f"{given.name}: {words}")
    found = Findings(given)
    _start(given, states, found)
    _joints(given, found)
    approaches = _conics(given, states, found)
    middles = _sail_steps(given, states, found, approaches)
    approaches += _at_joints(given, states)
    ordered = _apart(approaches)
    _perihelia(ordered, found)
    flybys = judge_flybys(given, states, bodies, found)
    first = next((each.time for each in ordered if each.passed), np.inf)
    counted, bonus = scored(flybys, first)
    return Judgement(given, found.ordered(), found.ordered(notes=True), counted, bonus, tuple(ordered), middles)


def _start(given: Solution, states: States, found: Findings) -> None:
    if given.arcs[0].kind == FLYBY:
        found.violation(0, "start", 0.0, None, "", "the first arc is a flyby, and one round the star is due")
    off = abs(states.position[0, 0] - rules.START_X)
    if not off <= rules.PLACE:
        found.violation(0, "start", off / 1e3, rules.PLACE / 1e3, "km", "x is not -200 au")
    sideways = np.abs(states.velocity[0, 1:]).max()
    if not sideways <= rules.SPEED:
        found.violation(0, "start", sideways / 1e3, rules.SPEED / 1e3, "km/s", "the velocity is not along x")
    if states.time[0] < 0.0:
        found.violation(0, "start", states.time[0], 0.0, "s", "it begins before t = 0")
    latest = int(np.argmax(states.time))
    if states.time[latest] > rules.LATEST:
        found.violation(latest, "end", states.time[latest], rules.LATEST, "s", "it ends after 200 years")


def _joints(given: Solution, found: Findings) -> None:
    """Where one arc ends and the next begins, the rows say the same."""
    for before, after in pairwise(given.arcs):
        found.same_state(before.last, after.first, "joint")


def _conics(given: Solution, states: States, found: Findings) -> list[Approach]:
    arcs = [arc for arc in given.arcs if arc.kind == CONIC]
    if not arcs:
        return []
    first, last = np.array([arc.first for arc in arcs]), np.array([arc.last for arc in arcs])
    span = states.time[last] - states.time[first]
    place, speed = two_body.advance(states.position[first], states.velocity[first], np.maximum(span, 0.0), rules.MU)
    off = np.linalg.norm(place - states.position[last], axis=1)
    slip = np.linalg.norm(speed - states.velocity[last], axis=1)
    approaches = []
    for i, arc in enumerate(arcs):
        if not span[i] > 0.0:
            found.violation(arc.last, "conic", span[i], 0.0, "s", "the conic takes no time")
            continue
        if not off[i] <= rules.PLACE:
            found.violation(arc.last, "conic", off[i] / 1e3, rules.PLACE / 1e3, "km", "the conic ends elsewhere")
        if not slip[i] <= rules.SPEED:
            words = "the conic ends with another velocity"
            found.violation(arc.last, "conic", slip[i] / 1e3, rules.SPEED / 1e3, "km/s", words)
        turns = bool(states.outward[arc.first] < 0 <= states.outward[arc.last])
        start = states.position[arc.first], states.velocity[arc.first]
        for time, distance in on_conic(*start, float(span[i]), turns):
            approaches.append(Approach(float(states.time[arc.first]) + time, distance, arc.last))
        for row in (arc.first, arc.last):
            if given.control[row].any():
                size = float(np.linalg.norm(given.control[row]))
                found.note(row, "control", size, 0.0, "", "a conic has a control that is not zero")
    return approaches


def _sail_steps(given: Solution, states: States, found: Findings, approaches: list[Approach]) -> dict[int, Floats]:
    """Fly all sail steps -> the normals in their middles, by the row at which a step ends."""
    sails = [arc for arc in given.arcs if arc.kind == SAIL]
    rows = np.array([row for arc in sails for row in range(arc.first, arc.last)], int)
    sunward = np.ones(len(given.time), bool)
    for arc in sails:
        sunward[arc.first : arc.last + 1] = _normals(given, states, arc, found)
    span = states.time[rows + 1] - states.time[rows]
    for row in rows[np.abs(span) <= rules.JOINT_TIME]:
        found.same_state(int(row), int(row) + 1, "sail step")
    for row, seconds in zip(rows[span < -rules.JOINT_TIME], span[span < -rules.JOINT_TIME], strict=True):
        found.violation(int(row) + 1, "sail step", seconds, rules.SHORTEST_STEP, "s", "time runs backwards")
    short = (span > rules.JOINT_TIME) & (span < rules.SHORTEST_STEP - rules.JOINT_TIME)
    for row, seconds in zip(rows[short], span[short], strict=True):
        found.violation(int(row) + 1, "sail step", seconds, rules.SHORTEST_STEP, "s", "the step is too short")
    rows, span = rows[span > rules.JOINT_TIME], span[span > rules.JOINT_TIME]
    if not len(rows):
        return {}
    before, after = given.control[rows], given.control[rows + 1]
    steps = edge_on_at_most(Steps(states.both[rows], span, before, _mean(before, after), after))
    errors = step_errors(steps, states.both[rows + 1], free=sunward[rows] & sunward[rows + 1])
    for i, row in enumerate(rows):
        worst = max(errors.by_one_step[i], errors.truly[i])
        if not worst < rules.STEP_ERROR:
            words = f"the sail does not get there (one step {_small(errors.by_one_step[i])}, {_truth(errors.truly[i])})"
            found.violation(int(row) + 1, "sail error", worst, rules.STEP_ERROR, "", words)
    for i, time, distance in errors.nearest:
        approaches.append(Approach(float(states.time[rows[i]]) + time, distance, int(rows[i]) + 1))
    return {int(row) + 1: errors.middle[i] for i, row in enumerate(rows)}


def _mean(before: Floats, after: Floats) -> Floats:
    """The mean normal of both ends; of opposite ones, that of the start."""
    total = before + after
    opposite = np.linalg.norm(total, axis=1) < 1e-9
    return unit(np.where(opposite[:, None], before, total))


def _small(value: float) -> str:
    return f"{value:.2g}" if np.isfinite(value) else "none"


def _truth(value: float) -> str:
    return f"flown truly {value:.2g}" if np.isfinite(value) else "not to be flown truly"


def _normals(given: Solution, states: States, arc: Arc, found: Findings) -> NDArray[np.bool_]:
    """Look at the normals of a sail arc -> whether each points to the star's side."""
    rows = np.arange(arc.first, arc.last + 1)
    normal = given.control[rows]
    size = np.linalg.norm(normal, axis=1)
    towards = -unit(states.position[rows])
    cosine = np.sum(normal * towards, axis=1) / np.where(size > 0, size, 1.0)
    for row, length, facing in zip(rows, size, cosine, strict=True):
        if length == 0.0:
            found.violation(int(row), "normal", 0.0, 1.0, "", "a sail arc has no normal here: it is shown as coast")
        elif not abs(length - 1.0) <= rules.NORMAL_LENGTH:
            found.violation(int(row), "normal", length, 1.0, "", "the normal is not of length 1")
        if facing < -rules.EDGE_ON:
            cone = float(np.degrees(np.arccos(np.clip(facing, -1.0, 1.0))))
            found.violation(int(row), "cone", cone, 90.0, "deg", "the normal points away from the star")
    return cosine >= -rules.EDGE_ON


def _at_joints(given: Solution, states: States) -> list[Approach]:
    """Closest approaches where arcs meet, above all at flybys; and where the file ends while it comes closer."""
    found = []
    n = len(given.time)
    for row in np.flatnonzero((states.outward[:-1] < 0) & (states.outward[1:] >= 0)):
        if abs(given.time[row + 1] - given.time[row]) <= rules.JOINT_TIME:
            found.append(Approach(float(given.time[row]), float(np.linalg.norm(states.position[row])), int(row) + 1))
    if states.outward[n - 1] < 0 and np.linalg.norm(states.position[n - 1]) < rules.NEAREST:
        last = float(given.time[n - 1]), float(np.linalg.norm(states.position[n - 1])), n - 1
        found.append(Approach(*last, passed=False))
    return found


def _apart(approaches: list[Approach]) -> list[Approach]:
    """In the order of time, and those that one joint made two of as one."""
    found: list[Approach] = []
    for each in sorted(approaches):
        if found and each.time - found[-1].time < rules.SHORTEST_STEP:
            if each.distance < found[-1].distance:
                found[-1] = each
        else:
            found.append(each)
    return found


def _perihelia(approaches: list[Approach], found: Findings) -> None:
    deep = 0
    for each in approaches:
        size = each.distance / rules.AU
        if each.distance < rules.NEAREST_ONCE - rules.PERIHELION_SLACK:
            found.violation(each.row, "perihelion", size, 0.01, "au", "the craft burns")
        elif each.distance < rules.NEAREST - rules.PERIHELION_SLACK:
            deep += 1
            if deep == 1:
                found.note(each.row, "perihelion", size, 0.05, "au", "the one passage below 0.05 au that is allowed")
            else:
                found.violation(each.row, "perihelion", size, 0.05, "au", "a second passage below 0.05 au")
