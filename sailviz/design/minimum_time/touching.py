"""Planar flights that may not come nearer to the Sun than a perihelion limit, and touch it once.

The limit r >= r_min is a state constraint of second order: a flight meets it in a point, with u = 0. There the costate
of the radius jumps, lam_r(t+) = lam_r(t-) + nu with nu < 0 (the limit only ever costs time); the other costates and H
are continuous. No arc along the limit is looked for, nor a second touch: a flight that would need one is not found.

Search: ways in to the limit and ways out from it are each a family, over the speed there; where a little more speed
costs the one as much time as it saves the other, flight time is least, and the two make one flight, up to a jump. It is
finished by shooting from the touching point to both sides. A weak sail's ways in are few and hard to meet: the flights
of a stronger one are followed to it as well. Units: mu = 1 and the distance of departure.
Re-derived; checked against direct transcription.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from sailviz.design.minimum_time import costates, shooting
from sailviz.design.minimum_time.boundary_conditions import SHORTEST, SPAN, direction
from sailviz.design.minimum_time.effort import Effort
from sailviz.design.minimum_time.finishing import GOAL, LOOSE, TIGHT, Extremal, distinct, polished
from sailviz.design.minimum_time.from_touch import AFTER, BEFORE, JUMP, FromTouch
from sailviz.design.minimum_time.planar_ends import Polar, ToEnd
from sailviz.design.minimum_time.search import Search
from sailviz.design.minimum_time.state_costate import OWN, Sail
from sailviz.design.minimum_time.touches import Touch, jumped
from sailviz.design.minimum_time.ways_in import WaysIn, curves
from sailviz.design.minimum_time.ways_out import WaysOut, families
from sailviz.steering.optimal import STRENGTH

JUMPS = -np.geomspace(0.02, 3.0, 12)  # tried, where the length of the costates of r, u and v at departure is 1
ROOM = 1e-7  # relative, by which a flight may pass below the limit: of rows beside the touching point
# strength and limit over those asked for, whose flights are sought; the last where the others led to nothing
EASIER = ((1.0, 1.0), (1.4, 1.0), (1.0, 1.5))
SLOWEST = 0.75  # of the parabolic speed at the limit: the circular one is 0.71
STRIDE, LONGER, SMALLEST_STRIDE = 0.1, 1.5, 1e-3  # of the way from one sail to the other
TOGETHER = 3  # of a stride, by which the unknowns may change in it, of 1

Array = np.ndarray[Any, Any]


@dataclass(frozen=True)
class Touching:
    """A ToEnd whose flight touches a perihelion limit once.

    Unknowns: those of the ToEnd, then the time of touching and the jump of lam_r there, to which the length of
    (lam_r, lam_u, lam_v) at departure is 1. Misses: those of the ToEnd, r / r_min - 1 and u at the touching point.
    """

    flight: ToEnd
    perihelion: float

    @property
    def size(self) -> int:
        return self.flight.size + 2

    def touch(self, unknowns: np.ndarray) -> Touch:
        """Of unknowns (k,)."""
        return Touch(float(unknowns[-2]), float(unknowns[-1]))

    def misses(self, unknowns: np.ndarray, tolerance: float) -> np.ndarray:
        """(n, k + 2 or more) from (n, k + 2); NaN where a flight fails."""
        flight, sail = self.flight, self.flight.sail
        first = np.maximum(unknowns[:, -2], SHORTEST)
        second = np.maximum(unknowns[:, SPAN] - first, SHORTEST)
        there = costates.fly_all(flight.starts(unknowns), first, sail, tolerance=tolerance)
        ends = costates.fly_all(jumped(there, unknowns[:, -1]), second, sail, tolerance=tolerance)
        near, at = Polar.of(there), Polar.of(ends)
        touching = near.r / self.perihelion - 1, near.u * np.sqrt(self.perihelion)
        missed = [*flight.end.misses(at), *flight.off_angle(at), direction(unknowns)[1] - 1, *touching]
        return np.stack(missed, axis=1)

    def finish(self, unknowns: np.ndarray, effort: Effort) -> Extremal | None:
        """The extremal that rough unknowns (k + 2,) lead to, or None."""
        span, size = max(unknowns[SPAN], 0.1), self.flight.size
        limit = np.array([0.2, 0.2, 0.2, 0.1 * span, *[0.3] * (size - 4), 0.1 * max(unknowns[-2], 0.1), 0.3])
        misses = effort.watched(lambda x: self.misses(x, LOOSE))
        rough = shooting.solve(misses, unknowns, step=1e-6, goal=1e-7, most=40, limit=limit)
        return self.polish(rough.unknowns, effort) if rough.residual < 1e-4 else None

    def polish(self, unknowns: np.ndarray, effort: Effort) -> Extremal | None:
        """The extremal that good unknowns (k + 2,) lead to, or None. Differences of a coarse integration are none where
        the way out is long: it magnifies them a thousandfold."""
        misses = effort.watched(lambda x: self.misses(x, TIGHT))
        found = shooting.solve(misses, unknowns, step=1e-7, goal=1e-13, most=15)
        x = found.unknowns
        return Extremal(x, found.residual) if found.residual < GOAL and 0 < x[-2] < x[SPAN] else None


def search(
    problem: Touching, longest: float, accept: Callable[[np.ndarray], bool], effort: Effort, words: str
) -> tuple[Search, list[Extremal]]:
    """Extremals that touch the limit, at a time up to longest; and those of its ToEnd, which turn beyond the limit by
    themselves, that were met where a jump would have the wrong sign. What there is, where the effort ends before.
    accept(unknowns) -> bool refuses those that are not wanted; words : for the progress."""
    found, free, starts = list[Extremal](), list[Extremal](), 0

    own = FromTouch(problem.flight, problem.perihelion)
    with effort.stoppable():
        for i, (stronger, wider) in enumerate(EASIER):
            if i == len(EASIER) - 1 and (found or free or wider * problem.perihelion >= 1.0):
                break
            effort.report(i / len(EASIER), words)
            easier = _easier(own, stronger, wider)
            for rough in joined(easier, longest, effort):
                starts += 1
                x = easier.solved(rough, effort)
                if x is not None and i:
                    x = followed(own, stronger, wider, x, effort)
                if x is None:
                    continue
                if x[JUMP] < 0:
                    exact = problem.polish(own.from_departure(x), effort)
                else:
                    alone = own.freed(x, effort)
                    exact = None if alone is None else polished(problem.flight, alone, effort)
                if exact is not None and accept(exact.unknowns):
                    (found if x[JUMP] < 0 else free).append(exact)
        effort.count("flights past the Sun finished", starts)
    return Search(distinct(found), starts, len(found) + len(free), np.inf, np.empty(0)), free


def _easier(problem: FromTouch, stronger: float, wider: float) -> FromTouch:
    """The same for a sail that is so many times as strong, and a limit that is so many times as wide."""
    sail = problem.flight.sail
    parameters = sail.parameters.copy()
    parameters[OWN + STRENGTH] *= stronger
    flight = replace(problem.flight, sail=Sail(sail.kind, parameters))
    return FromTouch(flight, wider * problem.perihelion)


def joined(problem: FromTouch, longest: float, effort: Effort) -> list[Array]:
    """Rough unknowns (7,) of flights made of a way in and a way out of which the flight time is stationary, a minimum
    over the speed at the limit; soonest at the limit first."""
    flight, limit = problem.flight, problem.perihelion
    inwards = curves(flight, limit, longest, effort)
    if not inwards:
        return []
    slowest = SLOWEST * np.sqrt(2 / limit)
    speeds = np.concatenate([np.minimum(way.speed[way.speed > slowest], 2 * slowest) for way in inwards])
    if not len(speeds):
        return []
    outwards = families(flight, limit, float(speeds.min()), float(speeds.max()), effort)
    pairs = [pair for way in inwards for out in outwards for pair in _met(limit, way, out)]
    return sorted(pairs, key=lambda x: float(x[BEFORE]))


def _met(limit: float, way: WaysIn, out: WaysOut) -> list[Array]:
    """Rough unknowns (7,) of the flights that one curve of ways in and one family of ways out make."""
    _, saved = out.at(way.speed)
    slope = way.worth - saved  # of the flight time, over the speed at the limit
    along = slope * np.gradient(way.speed)  # and along the curve
    with np.errstate(invalid="ignore"):
        least = np.nonzero((along[:-1] < 0) & (along[1:] >= 0))[0]
    found = []
    for i in least:
        k = i if abs(slope[i]) < abs(slope[i + 1]) else i + 1
        after = out.unknowns_at(way.speed[k])
        before = way.costates[k]
        scale = np.hypot(before[1], before[2]) / np.hypot(after[1], after[2])
        found.append(np.array([way.speed[k], *before, scale * after[0] - before[0], way.time[k], after[SPAN]]))
    return found


def followed(problem: FromTouch, stronger: float, wider: float, unknowns: Array, effort: Effort) -> Array | None:
    """Unknowns (7,) of a flight from those of the easier one: secants in the logarithms, in steps that adapt; None
    where they come to nothing."""
    at, stride, x, before = 0.0, STRIDE, unknowns, None
    while at < 1.0:
        following = min(1.0, at + stride)
        guess = x if before is None else x + (x - before[1]) * (following - at) / (at - before[0])
        new = _easier(problem, stronger ** (1 - following), wider ** (1 - following)).solved(guess, effort, 12)
        if new is None or np.abs(new - x)[:BEFORE].max() > TOGETHER * stride or new[AFTER] > 2 * x[AFTER]:
            stride *= 0.5
            if stride < SMALLEST_STRIDE:
                return None
            continue
        before, at, x = (at, x), following, new
        effort.count("steps of continuation")
        stride = min(LONGER * stride, 2 * STRIDE)
    return x
