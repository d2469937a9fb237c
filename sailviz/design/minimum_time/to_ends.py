"""Fastest flights from a circle to an end that is no orbit, past a radius or away from the Sun; within limits of the
distance and of the film's heat; or in a given number of revolutions.

Search as between circles; where a perihelion limit is given also over flights that touch it (`touching`), the fastest
of all that keep to it is the answer; where the angle is given, the flights of a free one are followed to it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, replace
from functools import partial
from typing import NamedTuple

import numpy as np

from sailviz.constants import AU, DAY
from sailviz.design.minimum_time import shooting, touches, touching
from sailviz.design.minimum_time.boundary_conditions import SPAN, hamiltonians, polar
from sailviz.design.minimum_time.circles import LAST, MORE_THRUST, SECOND
from sailviz.design.minimum_time.continuation import follow
from sailviz.design.minimum_time.costates import Flight
from sailviz.design.minimum_time.effort import Effort, Ending
from sailviz.design.minimum_time.finishing import GOAL, TIGHT, Extremal, distinct
from sailviz.design.minimum_time.planar_ends import TURN, AtRadius, End, Polar, ToEnd
from sailviz.design.minimum_time.planar_transfer import (
    Transfer,
    exponent,
    no_transfer,
    sail_from,
    strength,
    time_unit,
)
from sailviz.design.minimum_time.search import Search, search, spiral_time
from sailviz.design.minimum_time.state_costate import COSTATES, LRX, LVX, LVY, POSITION
from sailviz.design.minimum_time.touches import Touch
from sailviz.design.minimum_time.touching import ROOM, Touching
from sailviz.propulsion.solar_sail import Film

Progress = Callable[[float, str], None]

FALL, FALL_OF_WEAK, LONGEST_FALL = 12.0, 4.8, 30.0  # time to a limit: two revolutions; over the strength; at most
FAR = 4.0  # radius beyond which a flight is no spiral any more
BESIDE = 101  # moments about the one nearest to the Sun, at which a flight is looked at once more
EARLY = 1e-6  # relative, by which a flight may pass the radius aimed at before its end


@dataclass(frozen=True)
class Keeping:
    """What a flight keeps to: perihelion in units of the distance of departure, 0 for any; coolness of its film, see
    `canonical_sail`; angle swept rad, None for any."""

    perihelion: float = 0.0
    coolness: float = 0.0
    angle: float | None = None


class Flown(NamedTuple):
    """An extremal flown once more: unknowns of its ToEnd, start (12,) with H = +1, where it touches, path, angle swept
    rad, smallest radius, residual."""

    unknowns: np.ndarray
    start: np.ndarray
    touches: tuple[Touch, ...]
    path: Flight
    swept: float
    closest: float
    residual: float


def circle_to_end(
    initial_radius: float,
    end: End,
    device: Film | str,
    characteristic_acceleration: float,
    keeping: Keeping = Keeping(),
    *,
    progress: Progress | None = None,
    time_limit: float | None = None,
    effort: Effort | None = None,
) -> Transfer:
    """The fastest flight found from a circle about the Sun, of a radius in m, to an end in units of that radius.

    device : a sail's name or a Film. characteristic_acceleration : m/s2 at 1 au. progress, time_limit, effort : as of
    `circle_to_circle`. The result is as that of
    `circle_to_circle`, with `touches` where it touches the perihelion limit and `angle_costate` where the angle is
    given.
    """
    effort = Effort.of(effort, progress, time_limit)
    sail = sail_from(device, characteristic_acceleration, initial_radius, keeping.coolness)
    flight = ToEnd(sail, end)
    guess = _flight_time(flight, device)
    found, candidates = list[Search](), list[Flown]()
    for tier in (SECOND, LAST):
        tried = search(
            flight, tier.spans * guess, tier.costates, end.scale >= 1, partial(_kept, flight, Keeping()),
            effort=effort, words=f"{tier.costates} costates", zooms=tier.zooms, all_of_them=True,
        )  # fmt: skip
        found.append(tried)
        if tried.extremals or keeping.perihelion or effort.stopped:
            break
    free = flight
    candidates = without_limits = [flown(flight, extremal) for extremal in found[-1].extremals]
    if keeping.angle is not None:
        flight = replace(flight, angle=keeping.angle)
        candidates = list(_turned(flight, candidates, effort))
    if keeping.perihelion and not effort.stopped:
        touched, tried = _touching(flight, keeping.perihelion, longest_fall(flight, device), effort)
        candidates += touched
        found.append(tried)
    kept = sorted((one for one in candidates if keeps(flight, one, keeping)), key=lambda one: one.unknowns[SPAN])
    starts, converged = sum(one.starts for one in found), sum(one.converged for one in found)
    if not kept:
        days = LAST.spans * guess * time_unit(initial_radius) / DAY
        reason = f"no flight was found within {days:.0f} d, from {starts} starts, of which {converged} converged"
        nearest = _not_within(keeping, without_limits, initial_radius) or _nearest_screened(free, found, initial_radius)
        advice = ["ask for less: a limit nearer to the Sun, or any angle"] if without_limits else []
        reason += f"; {nearest}" if nearest else ""
        ending = effort.not_found(nearest, MORE_THRUST, *advice)
        return no_transfer(device, characteristic_acceleration, initial_radius, reason, ending)
    times = np.array([one.unknowns[SPAN] for one in kept]) * time_unit(initial_radius)
    method = "touching the limit" if kept[0].touches else "screening"
    counts = Counts(starts, converged, times, method)
    return _transfer(kept[0], device, characteristic_acceleration, initial_radius, keeping, counts, effort.found())


def _not_within(keeping: Keeping, reached: list[Flown], initial_radius: float) -> str:
    """In words, of true flights to the end that do not keep to what was asked the one that comes nearest to it."""
    if not reached:
        return ""
    if keeping.angle is not None:
        asked = keeping.angle
        one = min(reached, key=lambda each: abs(each.swept - asked))
        broken = f"goes round {one.swept / TURN:.4f} times"
    else:
        one = max(reached, key=lambda each: each.closest)
        broken = f"passes the Sun at {one.closest * initial_radius / AU:.4f} au"
    days = one.unknowns[SPAN] * time_unit(initial_radius) / DAY
    return f"a flight to that end {broken}, and takes {days:.4f} d"


def _nearest_screened(flight: ToEnd, found: list[Search], initial_radius: float) -> str:
    """In words, where the true flight that came nearest of all those flown roughly is then, flown accurately."""
    best = min((one for one in found if len(one.nearest)), key=lambda one: one.nearest_miss, default=None)
    if best is None:
        return ""
    span = float(best.nearest[SPAN])
    start = flight.starts(best.nearest[None, : flight.size])[0]
    end = touches.propagate(start, span, flight.sail, (), np.array([0.0, span])).end
    r, _, u, v = (float(one[0]) for one in polar(end[None]))
    unit = time_unit(initial_radius)
    away, across = (speed * initial_radius / unit / 1e3 for speed in (u, v))
    return (
        f"the nearest flight is {r * initial_radius / AU:.4f} au from the Sun after {span * unit / DAY:.4f} d, at "
        f"{away:.4f} km/s away from it and {across:.4f} km/s across"
    )


class Counts(NamedTuple):
    """Of a search: starts finished, of them converged, flight times (n,) s of distinct extremals, by which method."""

    starts: int
    converged: int
    times: np.ndarray
    method: str


def _transfer(
    best: Flown,
    device: Film | str,
    characteristic_acceleration: float,
    initial_radius: float,
    keeping: Keeping,
    counts: Counts,
    ending: Ending,
) -> Transfer:
    lam_r, lam_across, lam_u, lam_v = best.start[[LRX, LRX + 1, LVX, LVY]]
    unit = time_unit(initial_radius)
    return Transfer(
        device=device,
        characteristic_acceleration=float(characteristic_acceleration),
        initial_radius=float(initial_radius),
        time=float(best.unknowns[SPAN] * unit),
        revolutions=best.swept / TURN,
        costates=np.array([lam_r, lam_u, lam_v]),
        residual=best.residual,
        hamiltonian_drift=best.path.drift,
        solutions=len(counts.times),
        solution_times=counts.times,
        switches=best.path.switches * unit,
        closest=float(best.closest * initial_radius),
        starts=counts.starts,
        converged=counts.converged,
        method=counts.method,
        feasible=True,
        start=best.start,
        angle_costate=float(lam_across - lam_u) if keeping.angle is not None else 0.0,
        touches=best.touches,
        coolness=keeping.coolness,
        ending=ending,
    )


def flight_near(
    initial_radius: float,
    end: End,
    device: Film | str,
    characteristic_acceleration: float,
    keeping: Keeping,
    guess: np.ndarray,
    counts: Counts,
    *,
    touching_at: float | None = None,
    effort: Effort | None = None,
) -> Transfer | None:
    """The extremal that a guess leads to, as `circle_to_end` tells it; None where that is none, or is no flight within
    limits. guess : unknowns of `ToEnd`, of 4 or, with an angle, 5. touching_at : time, in the same units, at which it
    touches a perihelion limit."""
    effort = effort or Effort()
    sail = sail_from(device, characteristic_acceleration, initial_radius, keeping.coolness)
    flight = ToEnd(sail, end, keeping.angle)
    if touching_at is None:
        root = shooting.solve(effort.watched(lambda batch: flight.misses(batch, TIGHT)), guess)
        solved = Extremal(root.unknowns, root.residual)
        tried: Iterable[tuple[Extremal, Touching | None]] = [(solved, None)] if solved.miss < GOAL else []
    else:
        tried = _touching_near(Touching(flight, keeping.perihelion), guess, touching_at, effort)
    for extremal, problem in tried:
        if hamiltonians(flight.starts(extremal.unknowns[None, : flight.size]), sail)[0] > 0:
            one = flown(flight, extremal, problem)
            if keeps(flight, one, keeping):
                return _transfer(
                    one, device, characteristic_acceleration, initial_radius, keeping, counts, effort.found()
                )
    return None


def _touching_near(
    problem: Touching, guess: np.ndarray, time: float, effort: Effort
) -> Iterator[tuple[Extremal, Touching | None]]:
    """What a guess that touches its limit at a time leads to, the jump of the costate there unknown."""
    for jump in touching.JUMPS:
        found = problem.finish(np.concatenate([guess, [time, jump]]), effort)
        if found is not None:
            yield found, problem


def _flight_time(flight: ToEnd, device: Film | str) -> float:
    """A rough flight time: a slow spiral as far as there is one, and on at about the speed of departure."""
    to = min(flight.end.scale, FAR) if flight.end.scale != 1.0 else 0.5 * FAR
    spiral = spiral_time(device, strength(flight.sail, device), exponent(device), 1.0, to)
    return float(np.hypot(spiral, np.pi + max(1.0, flight.end.scale)))


def longest_fall(flight: ToEnd, device: Film | str) -> float:
    """The longest time after which a flight that is looked for touches its limit: weak sails go round more often."""
    return float(np.clip(FALL_OF_WEAK / strength(flight.sail, device), FALL, LONGEST_FALL))


def _kept(flight: ToEnd, keeping: Keeping, unknowns: np.ndarray) -> bool:
    """Whether an extremal of a search is a fastest flight rather than a slowest, and one to the end meant."""
    if not hamiltonians(flight.starts(unknowns[None]), flight.sail)[0] > 0:
        return False
    return keeps(flight, flown(flight, Extremal(unknowns, 0.0)), keeping)


def flown(flight: ToEnd, extremal: Extremal, touched: Touching | None = None) -> Flown:
    unknowns, sail = extremal.unknowns[: flight.size], flight.sail
    start = flight.starts(unknowns[None])
    h = float(hamiltonians(start, sail)[0])
    start[:, COSTATES] /= h
    jumps: tuple[Touch, ...] = ()
    if touched is not None:
        there = touched.touch(extremal.unknowns)
        jumps = (Touch(there.time, there.jump / h),)
    span = extremal.time
    times = np.linspace(0.0, span, int(40 * span) + 200)
    path = touches.propagate(start[0], span, sail, jumps, times)
    r, azimuth, _, _ = polar(path.rows)
    angle, least = np.unwrap(azimuth), int(np.argmin(r))
    beside = np.linspace(times[max(least - 1, 0)], times[min(least + 1, len(times) - 1)], BESIDE)
    at_touches = [one.time for one in jumps]
    near = touches.propagate(start[0], span, sail, jumps, np.union1d(beside, at_touches))
    closest = float(np.linalg.norm(near.rows[:, POSITION], axis=1).min())
    return Flown(unknowns, start[0], jumps, path, float(angle[-1] - angle[0]), closest, extremal.miss)


def keeps(flight: ToEnd, one: Flown, keeping: Keeping) -> bool:
    """Whether a flight comes to its end for the first time there, out of the Sun, within its limits."""
    r, _, _, _ = polar(one.path.rows)
    end = flight.end
    if isinstance(end, AtRadius):
        before = r[:-1] / end.radius
        if (end.radius > 1 and before.max() > 1 + EARLY) or (end.radius < 1 and before.min() < 1 - EARLY):
            return False
    if not end.holds(Polar.of(one.path.end[None])) or any(touch.jump >= 0 for touch in one.touches):
        return False
    if keeping.angle is not None and abs(one.swept - keeping.angle) > 1e-6:
        return False
    return one.closest >= keeping.perihelion * (1 - ROOM)


def _turned(flight: ToEnd, free: list[Flown], effort: Effort) -> Iterator[Flown]:
    """Flights of the angle asked for, each followed from one of a free angle."""
    assert flight.angle is not None, "there is an angle to follow to"
    for one in free:

        def problem_at(share: float, begin: float = one.swept, angle: float = flight.angle) -> ToEnd:
            return replace(flight, angle=begin + share * (angle - begin))

        path = follow(problem_at, np.append(one.unknowns, 0.0), effort=effort, words="following the angle")
        if path.complete:
            miss = float(np.abs(flight.misses(path.unknowns[None], 1e-13)).max())
            if hamiltonians(flight.starts(path.unknowns[None]), flight.sail)[0] > 0:
                yield flown(flight, Extremal(path.unknowns, miss))


def _touching(flight: ToEnd, perihelion: float, fall: float, effort: Effort) -> tuple[list[Flown], Search]:
    """Flights that touch the limit, and what was tried."""
    problem = Touching(flight, perihelion)

    def fastest(unknowns: np.ndarray) -> bool:
        return bool(hamiltonians(flight.starts(unknowns[None]), flight.sail)[0] > 0)

    tried, free = touching.search(problem, fall, fastest, effort, "flights past the Sun")
    touched = [flown(flight, one, problem) for one in tried.extremals]
    return touched + [flown(flight, one) for one in distinct(free)], tried
