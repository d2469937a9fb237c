"""A judged GTOC13 solution as a Run: its rows, and between them the motion as it was flown again.

Rows that are filled in are marked by the column `filled`: the solution does not have them.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from sailviz import elements, two_body
from sailviz.checks.gtoc13 import rules
from sailviz.checks.gtoc13.judgement import Judgement
from sailviz.checks.gtoc13.passages import body_state
from sailviz.checks.gtoc13.rows import states_of
from sailviz.checks.gtoc13.rules import Finding
from sailviz.checks.gtoc13.sail import PUSH, Steps, fly, unit
from sailviz.checks.gtoc13.score import Flyby, wheels
from sailviz.errors import RecordingError
from sailviz.exchange.gtoc13 import CONIC, SAIL, CompetitionBody, read_catalogue
from sailviz.run.array_checks import TrajectoryError
from sailviz.run.arrays import Body, Event, Phase, Reference, Run
from sailviz.run.from_arrays import trajectory

Floats = NDArray[np.float64]

STAR = "Altaira"
PHASE_OF = {CONIC: "coast", SAIL: "sail"}
EVEN, NEAR = 1200, 40  # filled rows over the whole flight; on either side of a perihelion
STEEPEST = 0.03  # rad about the star between two rows of a sail arc
MOST_MARKS = 200  # violations that are marked in space
MOST_WHEELS = 4  # bodies of which it is told where they were flown by
RING = 361


class _Rows:
    """Gathers rows: time, state (6,), normal towards the star (3,), whether filled in, kind of arc."""

    def __init__(self) -> None:
        self.parts: list[tuple[Floats, Floats, Floats, NDArray[np.bool_], str]] = []

    def add(self, time: Floats, state: Floats, normal: Floats, filled: NDArray[np.bool_], kind: str) -> None:
        self.parts.append((time, state, normal, filled, kind))


def replay(found: Judgement, catalogue: str | Path | None = None, rows: int = EVEN) -> Run:
    """The Run that shows a judged solution. catalogue : as in `judge`, for the planets; rows : about so
    many are filled in on conics. RecordingError, in one sentence, for a solution that cannot be drawn."""
    bodies = {} if catalogue is None else read_catalogue(catalogue)
    time, state, normal, filled, phases = _flown(found, rows)
    if len(time) < 2:
        raise RecordingError(f"{found.solution.name} has no rows that follow each other in time: nothing is drawn")
    star = Body(STAR, rules.MU, 0.0)
    push = _push(state, normal)
    planets = {_word(body): body for body in bodies.values() if body.number <= rules.YANDI}
    score = found.bonus * np.sum(
        [flyby.points * (time >= flyby.time) for flyby in found.flybys] or [np.zeros(len(time))], axis=0
    )
    try:
        run = trajectory(
            time,
            state[:, :3],
            state[:, 3:],
            normal=-normal,
            thrust=push,
            mu=star.mu,
            body=star.name,
            radius=0.0,
            mass=rules.MASS,
            device="solar-sail",
            side=float(np.sqrt(rules.AREA)),
            title=f"GTOC13: {Path(found.solution.name).name}",
            about=_about(found),
            look_for=_look_for(found, planets),
            family="gtoc13",
            events=_events(found),
            references=_rings(planets),
            environment={"score": score, "filled": filled},
            planets=False,
            accuracy="Rows as the file has them; between them conics by Kepler's motion, sail steps flown again.",
        )
    except TrajectoryError as error:
        raise RecordingError(f"{found.solution.name} cannot be drawn: {str(error).splitlines()[-1].strip()}") from None
    places = {name: body_state(body, time)[0] for name, body in planets.items()}
    setting = replace(
        run.setting,
        phases=phases,
        plots=("score", "distance") if found.score > 0 else ("distance",),
        parameters=(("rows", f"{len(found.solution.time):,}"), ("filled in", f"{int(filled.sum()):,}")),
    )
    events = tuple(event for event in run.events if event.name != "velocity jumps")
    return replace(run, setting=setting, bodies=places, events=events)


def _flown(found: Judgement, even: int) -> tuple[Floats, Floats, Floats, NDArray[np.bool_], tuple[Phase, ...]]:
    """time (n,), state (n, 6), normal (n, 3), filled (n,) of all rows, and the stretches of coast and sail."""
    given, states, rows = found.solution, states_of(found.solution), _Rows()
    both = states.both
    total = max(float(states.time[-1] - states.time[0]), 1.0)
    for arc in given.arcs:
        first, last = arc.first, arc.last
        span = float(states.time[last] - states.time[first])
        if arc.kind == CONIC and span > 0.0:
            inside = _times_on_conic(found, float(states.time[first]), span, even / total)
            place, speed = two_body.advance(
                np.tile(states.position[first], (len(inside), 1)), np.tile(states.velocity[first], (len(inside), 1)),
                inside, rules.MU,
            )  # fmt: skip
            time = np.concatenate([[0.0], inside, [span]]) + states.time[first]
            state = np.concatenate([both[first : first + 1], np.hstack([place, speed]), both[last : last + 1]])
            rows.add(time, state, np.zeros((len(time), 3)), _inner(len(time)), CONIC)
        elif arc.kind == SAIL:
            _add_sail(rows, found, both, arc.first, arc.last)
    time, state, normal, filled, kinds = (
        np.concatenate([part[i] for part in rows.parts] or [np.zeros(0)])
        if i < 4
        else np.concatenate([[part[4]] * len(part[0]) for part in rows.parts] or [[]])
        for i in range(5)
    )
    kept = _in_order(time, state)
    time, state, normal, filled, kinds = (values[kept] for values in (time, state, normal, filled, kinds))
    return time, state, normal, filled, _phases(time, kinds)


def _inner(count: int) -> NDArray[np.bool_]:
    """True but for the ends."""
    found = np.ones(count, bool)
    found[[0, -1]] = False
    return found


def _times_on_conic(found: Judgement, start: float, span: float, density: float) -> Floats:
    """Times (k,) s after the start of a conic at which rows are filled in: even ones, and close ones where the craft
    passes the star."""
    times = [np.linspace(0.0, span, max(int(density * span), 4) + 1)[1:-1]]
    for approach in found.approaches[:200]:
        away = np.geomspace(min(3600.0, span / 1e3), span, NEAR)
        passed = approach.time - start
        times.append(np.concatenate([passed - away, [passed], passed + away]))
    every = np.unique(np.concatenate(times))
    return every[(every > 1.0) & (every < span - 1.0)]


def _add_sail(rows: _Rows, found: Judgement, both: Floats, first: int, last: int) -> None:
    """The rows of a sail arc; where they lie far apart about the star, the motion between them."""
    given = found.solution
    for row in range(first, last + 1):
        middle = found.middles.get(row)
        if row > first and middle is not None:
            span = float(given.time[row] - given.time[row - 1])
            r, v = np.linalg.norm(both[row - 1, :3]), np.linalg.norm(both[row - 1, 3:])
            count = int(np.clip(np.ceil(span * v / r / STEEPEST), 1, 100)) - 1
            if count:
                at = span * np.arange(1, count + 1) / (count + 1)
                step = Steps(both[row - 1 : row], np.array([span]), given.control[row - 1 : row], middle[None],
                             given.control[row : row + 1])  # fmt: skip
                flown = fly(step.at(np.zeros(count, np.int64)), watch=False, until=at).state
                share = (at / span)[:, None]
                normal = unit(given.control[row - 1] * (1 - share) + given.control[row] * share)
                good = np.isfinite(flown).all(axis=1)
                rows.add(
                    given.time[row - 1] + at[good], flown[good], normal[good], np.ones(int(good.sum()), bool), SAIL
                )
        own = slice(row, row + 1)
        rows.add(given.time[own], both[own], unit(given.control[own]), np.zeros(1, bool), SAIL)


def _in_order(time: Floats, state: Floats) -> NDArray[np.int64]:
    """Rows that follow each other in time; of several at one time and place the last, and both where the velocity
    jumps."""
    kept: list[int] = []
    for row in range(len(time)):
        if kept and time[row] < time[kept[-1]] + rules.JOINT_TIME:
            if time[row] < time[kept[-1]] - rules.JOINT_TIME:
                continue
            jump = float(np.linalg.norm(state[row, 3:] - state[kept[-1], 3:]))
            away = float(np.linalg.norm(state[row, :3] - state[kept[-1], :3]))
            twice = len(kept) > 1 and time[kept[-2]] == time[kept[-1]]
            if jump <= rules.SPEED or away > rules.PLACE or twice:
                kept[-1] = row
                continue
            time[row], state[row, :3] = time[kept[-1]], state[kept[-1], :3]
        kept.append(row)
    return np.array(kept, np.int64)


def _phases(time: Floats, kinds: NDArray[np.str_]) -> tuple[Phase, ...]:
    """Stretches of coast and sail; none where there is but one."""
    starts = np.flatnonzero(np.concatenate([[True], kinds[1:] != kinds[:-1]]))
    if len(starts) < 2:
        return ()
    ends = [*time[starts[1:]], float(time[-1])]
    return tuple(
        Phase(PHASE_OF[str(kinds[row])], float(time[row]), float(end)) for row, end in zip(starts, ends, strict=True)
    )


def _push(state: Floats, normal: Floats) -> Floats:
    """Acceleration (n, 3) m/s2 by the sail."""
    r = np.linalg.norm(state[:, :3], axis=1)
    facing = -np.sum(normal * state[:, :3], axis=1) / r
    push: Floats = -(PUSH / r**2 * facing**2)[:, None] * normal
    return push


def _word(body: CompetitionBody) -> str:
    """A name for a path: letters and figures of its own name, or its number."""
    return "".join(letter for letter in body.name if letter.isalnum()) or f"body {body.number}"


def _rings(planets: Mapping[str, CompetitionBody]) -> Iterable[Reference]:
    anomaly = np.linspace(0.0, 2 * np.pi, RING)
    for name, body in planets.items():
        place, _ = elements.state(
            body.semi_major_axis, body.eccentricity, body.inclination, body.node, body.argument, anomaly, rules.MU
        )
        yield Reference(name, "planet", place)


def _events(found: Judgement) -> list[Event]:
    """Flybys, the closest approaches that matter, and violations, in the order of time."""
    states = states_of(found.solution)

    def event(name: str, row: int) -> Event:
        return Event(name, float(states.time[row]), np.append(states.both[row], rules.MASS))

    events = [event(_flyby_words(flyby), flyby.row) for flyby in found.flybys]
    events += [event(_violation_words(each), each.row - 1) for each in found.violations[:MOST_MARKS]]
    return sorted(events, key=lambda each: each.time)


def _flyby_words(flyby: Flyby) -> str:
    name = flyby.body.name or f"body {flyby.body.number}"
    height = f"{flyby.altitude / flyby.body.radius:.3g} radii up, " if np.isfinite(flyby.altitude) else ""
    return f"flyby of {name}: {height}{flyby.v_inf / 1e3:.4g} km/s" + ("" if flyby.counts else ", no score")


def _violation_words(each: Finding) -> str:
    size = f", {each.size:.3g} {each.unit}".rstrip() if np.isfinite(each.size) else ""
    return f"violation, row {each.row}: {each.words}{size}"


def _about(found: Judgement) -> str:
    count = len(found.violations)
    verdict = "breaks no rule" if not count else f"breaks rules at {count:,} place{'' if count == 1 else 's'}"
    counted = sum(flyby.counts for flyby in found.flybys)
    return (
        f"A solution of the GTOC13 competition, flown again: it {verdict}. Score **{found.score:.6f}** without the "
        f"factor of the day, by {counted} of {len(found.flybys)} flybys."
    )


def _look_for(found: Judgement, planets: Mapping[str, CompetitionBody]) -> list[str]:
    lines = ["**yellow dots** are flybys, with altitude and speed"] if found.flybys else []
    if found.violations:
        more = len(found.violations) - MOST_MARKS
        lines.append(
            "**red dots** are broken rules, with their row" + (f"; {more:,} more are not marked" if more > 0 else "")
        )
    met = {flyby.body.number for flyby in found.flybys if flyby.counts}
    if met:
        small = sum(number > rules.YANDI for number in met)
        big = len([body for body in planets.values() if body.number in met])
        lines.append(f"bodies that score: planets **{big}**, small ones **{small}**")
    best = sorted(wheels(found.flybys), key=lambda wheel: -wheel.points)
    for wheel in best[:MOST_WHEELS]:
        name = wheel.body.name or f"body {wheel.body.number}"
        lines.append(f"{name}: **{wheel.points:.3g}** points, by 30° of longitude `{wheel.words}`")
    return lines
