"""Planar flights that may not come nearer to the Sun than a perihelion limit, and touch it once.

The limit r >= r_min is a state constraint of second order: a flight meets it in a point, with u = 0. There the costate
of the radius jumps, lam_r(t+) = lam_r(t-) + nu with nu < 0 (the limit only ever costs time); the other costates and H
are continuous. No arc along the limit is looked for: a flight that would need one is not found.

Search: directions of the costates are flown roughly, each to where it turns near the limit; from there once more with
jumps of several sizes; the best of them are finished by shooting. Units: mu = 1 and the distance of departure.
Re-derived; checked against direct transcription.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np

from sailviz.design.minimum_time import costates, shooting
from sailviz.design.minimum_time.boundary_conditions import DIRECTION, SHORTEST, SPAN, direction, polar
from sailviz.design.minimum_time.costates import fly_dense
from sailviz.design.minimum_time.effort import Effort
from sailviz.design.minimum_time.finishing import GOAL, LOOSE, TIGHT, Extremal, distinct
from sailviz.design.minimum_time.planar_ends import AtRadius, Polar, ToEnd
from sailviz.design.minimum_time.search import (
    CHILDREN,
    KEPT,
    MOST_AT_ONCE,
    Search,
    in_threads,
    screen,
    sequence,
    spread,
    turned,
)
from sailviz.design.minimum_time.state_costate import Sail, X, Y
from sailviz.design.minimum_time.touches import Touch, jumped

JUMPS = -np.geomspace(0.02, 3.0, 12)  # tried, where the length of the costates of r, u and v at departure is 1
WIDE = 0.4  # of the logarithm of a perihelion over the limit, of flights worth a second look
FALL = 12.0  # time within which a flight comes to the limit: two revolutions
ROOM = 1e-7  # relative, by which a flight may pass below the limit: of rows beside the touching point
ZOOMS = 2
ROUGH = 1e-6  # integration tolerance of a first look
NEAR = 1e-6  # largest miss of a flight that is on the way out
STRIDE, SMALLEST_STRIDE = 0.25, 0.002  # of the logarithm of the radius, on the way out to a far one

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
    problem: Touching, span: float, n: int, accept: Callable[[np.ndarray], bool], effort: Effort, words: str
) -> Search:
    """Extremals that touch the limit: n directions are looked at, over a span from the touching point on; what there
    is, where the effort ends before. accept(unknowns (k + 2,)) -> bool refuses those that are not wanted; words : for
    the progress."""
    found, miss, candidates = list[Extremal | None](), np.empty(0), np.empty((0, problem.size))

    def report(begin: float, share: float) -> None:
        effort.report(begin + 0.5 * share, words)

    with effort.stoppable():
        miss, candidates = _candidates(problem, span, n, effort, partial(report, 0.0))
        finish = partial(problem.finish, effort=effort)
        found = in_threads(finish, list(candidates), partial(report, 0.5), effort)
        effort.count("of them finished", len(candidates))
    converged = [extremal for extremal in found if extremal is not None and accept(extremal.unknowns)]
    best = float(miss[0]) if len(miss) else np.inf
    nearest = candidates[0] if len(miss) else np.full(problem.size, np.nan)
    return Search(distinct(converged), len(candidates), len(converged), best, nearest)


def carried_out(problem: Touching, unknowns: Array, nearer: float, effort: Effort) -> Extremal | None:
    """The extremal of a problem that ends at a radius, from unknowns (k + 2,) that solve it for a nearer one: secants
    in the logarithm of the radius, in steps that adapt; None where they come to nothing."""
    end = problem.flight.end
    assert isinstance(end, AtRadius), "energies have no way out"
    from scipy.optimize import root

    x, at, before = unknowns, float(np.log(nearer)), None
    goal, stride = float(np.log(end.radius)), STRIDE
    while at < goal:
        effort.check()
        following = min(goal, at + stride)
        guess = x if before is None else x + (x - before[0]) * (following - at) / (at - before[1])
        nearby = replace(problem, flight=replace(problem.flight, end=AtRadius(float(np.exp(following)))))
        found = root(lambda y, nearby=nearby: nearby.misses(y[None], TIGHT)[0], guess, options={"maxfev": 150})
        if not (np.abs(found.fun).max() < NEAR and found.x[SPAN] > x[SPAN]):
            stride *= 0.4
            if stride < SMALLEST_STRIDE:
                return None
            continue
        before, x, at = (x, at), found.x, following
        stride = min(1.4 * stride, STRIDE)
    return problem.polish(x, effort)


def _candidates(
    problem: Touching, span: float, n: int, effort: Effort, progress: Callable[[float], None]
) -> tuple[Array, Array]:
    """(miss, unknowns) of the most promising flights, best first, no two alike."""
    miss, unknowns = _screened(problem, spread(problem.flight, n, outwards=False), span, effort, progress)
    width, q = 3.0 / np.sqrt(n), sequence(CHILDREN, 2)
    for _ in range(ZOOMS):
        if not len(miss):
            break
        best = unknowns[np.argsort(miss, kind="stable")[:KEPT]]
        children = np.repeat(best, CHILDREN, axis=0)
        angle, around = np.tile(width * np.sqrt(q[:, 0]), len(best)), np.tile(2 * np.pi * q[:, 1], len(best))
        children[:, DIRECTION] = turned(children[:, DIRECTION], angle, around)
        more, children = _screened(problem, children[:, : problem.flight.size], span, effort)
        miss, unknowns = np.concatenate([miss, more]), np.concatenate([unknowns, children])
        width *= 0.5
    chosen: list[int] = []
    for i in np.argsort(miss, kind="stable"):
        apart = [np.abs(unknowns[i] - unknowns[j]) for j in chosen]
        if all(np.linalg.norm(a[DIRECTION]) > 0.03 or a[-2] > 0.3 or a[-1] > 0.3 for a in apart):
            chosen.append(int(i))
            if len(chosen) == KEPT:
                break
    return miss[chosen], unknowns[chosen]


def _screened(
    problem: Touching, unknowns: Array, span: float, effort: Effort, progress: Callable[[float], None] | None = None
) -> tuple[Array, Array]:
    """Misses (m,), unknowns (m, k + 2) of flights that turn near the limit, each with the best of the jumps tried."""
    sail, starts = problem.flight.sail, problem.flight.starts(unknowns)
    parts = np.array_split(np.arange(len(unknowns)), max(1, -(-len(unknowns) // MOST_AT_ONCE)))

    def part(places: Array) -> tuple[Array, Array]:
        effort.check()
        found = [_turns(starts[i : i + 1], problem.perihelion, sail) for i in places]
        return _outwards(problem, unknowns[places], found, span)

    found = in_threads(part, list(parts), progress, effort)
    effort.count("costates flown roughly", len(unknowns))
    miss, unknowns = (np.concatenate(column) for column in zip(*found, strict=True))
    return miss, unknowns


def _turns(start: Array, perihelion: float, sail: Sail) -> tuple[float, Array] | None:
    """Time and state with costates (12,) at which a flight first comes as near to the Sun as the limit is, or turns
    there; None of one that does not."""
    times = np.linspace(0.0, FALL, 241)
    rows = fly_dense(start, np.array([FALL]), sail, times, ROUGH, 0.0).rows[0]
    r, _, u, _ = polar(rows)
    turning = np.nonzero((u[:-1] < 0) & (u[1:] >= 0))[0]
    for i in turning:
        w = u[i] / (u[i] - u[i + 1])
        off = np.log(r[i] / perihelion)
        if abs(off) < WIDE:
            time = times[i] + w * (times[1] - times[0])
            return float(time), costates.fly_all(start, np.array([time]), sail, tolerance=ROUGH)[0]
        if off < 0:
            return None  # too near
    return None


def _outwards(
    problem: Touching, unknowns: Array, turns: list[tuple[float, Array] | None], span: float
) -> tuple[Array, Array]:
    """Misses and unknowns of flights (k,) that turn, from there with each of the jumps."""
    kept = [i for i, turn in enumerate(turns) if turn is not None]
    size = problem.size
    if not kept:
        return np.empty(0), np.empty((0, size))
    times = np.array([turn[0] for turn in turns if turn is not None])
    states = np.stack([turn[1] for turn in turns if turn is not None])
    off = np.log(np.linalg.norm(states[:, [X, Y]], axis=1) / problem.perihelion)
    m = len(JUMPS)
    begun = jumped(np.repeat(states, m, axis=0), np.tile(JUMPS, len(kept)))
    sail = problem.flight.sail
    miss, when = screen(begun, span, int(span / 0.1) + 2, sail, 0.0, ROUGH, problem.flight.nearness)
    miss, when = miss.reshape(-1, m), when.reshape(-1, m)
    best = np.argmin(miss, axis=1)
    at = np.arange(len(kept))
    found = np.empty((len(kept), size))
    found[:, :-2] = unknowns[kept]
    found[:, SPAN] = times + when[at, best]
    found[:, -2], found[:, -1] = times, JUMPS[best]
    return np.hypot(miss[at, best], off), found
