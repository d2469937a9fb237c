"""From a rough flight to an extremal: misses brought to zero, an E-sail's switching sharpened, the end polished.

A Levenberg-Marquardt search at a coarse, then at a loose integration tolerance. An E-sail begins with its switching
rounded off, for which a rough guess leads farther, and is followed to the true law in steps that adapt. One more search
at a tight tolerance ends it.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from sailviz.design.minimum_time import shooting
from sailviz.design.minimum_time.boundary_conditions import ANOMALY, DIRECTION, SPAN, PlanarProblem
from sailviz.design.minimum_time.effort import Effort

COARSE, LOOSE, TIGHT = 1e-6, 1e-9, 1e-13  # integration tolerances
NEAR = 1e-5  # miss of a flight at a loose tolerance that is worth going on with
GOAL = 1e-9  # largest miss of a solution
SHARPER = 0.3  # the next rounding of the switching over the last; its root where that step was too far
GIVEN_UP = 0.9  # such a ratio is no step any more
LONGER = 1.5  # power of the ratio after a step that was not too far
ALMOST_SHARP = 0.01  # a rounding from which the true law is tried


@dataclass(frozen=True)
class Extremal:
    """One solution of the necessary conditions: unknowns as the problem defines them, largest miss."""

    unknowns: np.ndarray
    miss: float

    @property
    def time(self) -> float:
        return float(self.unknowns[SPAN])


def solve(
    problem: PlanarProblem, unknowns: np.ndarray, smoothing: float, effort: Effort, quickly: bool = True
) -> np.ndarray | None:
    """The unknowns (k,) near rough ones that solve the problem at a loose tolerance, its switching rounded off, or
    None. quickly : at a coarse tolerance first, which half the time is enough to see that nothing comes of it."""
    limit = np.array([0.2, 0.2, 0.2, 0.1 * max(unknowns[SPAN], 0.1), 0.3])[: problem.size]

    def misses(tolerance):
        return effort.watched(lambda x: problem.misses(x, tolerance, smoothing))

    if quickly:
        near = shooting.solve(misses(COARSE), unknowns, step=1e-4, goal=1e-3, most=30, limit=limit)
        if not near.residual < 1e-2:
            return None
        unknowns = near.unknowns
    found = shooting.solve(misses(LOOSE), unknowns, step=1e-6, goal=1e-7, most=30, limit=limit)
    return found.unknowns if found.residual < NEAR and found.unknowns[SPAN] > 0 else None


def sharpened(problem: PlanarProblem, unknowns: np.ndarray, smoothing: float, effort: Effort) -> np.ndarray | None:
    """The solution (k,) for the true law, at a loose tolerance, from one whose switching is rounded off; None where the
    steps towards it become too small."""
    step, before, last = SHARPER, unknowns, 0.0
    while smoothing > 0.0:
        tries = [0.0, step * smoothing] if smoothing <= ALMOST_SHARP else [step * smoothing]
        for wanted in tries:
            ahead = (wanted - smoothing) / (smoothing - last) if last else 0.0
            found = solve(problem, unknowns + ahead * (unknowns - before), wanted, effort)
            if found is not None:
                before, last, unknowns, smoothing = unknowns, smoothing, found, wanted
                step = max(step**LONGER, SHARPER)
                break
        else:
            step = np.sqrt(step)
            if step > GIVEN_UP:
                return None
    return unknowns


def polished(problem: PlanarProblem, unknowns: np.ndarray, effort: Effort) -> Extremal | None:
    """The extremal at a solution (k,) for the true law at a loose tolerance, or None."""
    misses = effort.watched(lambda x: problem.misses(x, TIGHT))
    found = shooting.solve(misses, unknowns, step=1e-7, goal=1e-13, most=15)
    if not (found.residual < GOAL and found.unknowns[SPAN] > 0):
        return None
    return Extremal(found.unknowns, found.residual)


def finish(
    problem: PlanarProblem, unknowns: np.ndarray, smoothing: float = 0.0, effort: Effort | None = None
) -> Extremal | None:
    """The extremal that unknowns (k,) near it lead to, or None."""
    effort = effort or Effort()
    rounded = solve(problem, unknowns, smoothing, effort, quickly=False)
    return None if rounded is None else exact(problem, rounded, smoothing, effort)


def exact(problem: PlanarProblem, unknowns: np.ndarray, smoothing: float, effort: Effort) -> Extremal | None:
    """The extremal that a solution (k,) with its switching rounded off leads to, or None."""
    sharp = sharpened(problem, unknowns, smoothing, effort)
    return None if sharp is None else polished(problem, sharp, effort)


def alike(one: np.ndarray, other: np.ndarray, within: float = 1e-6) -> bool:
    """Whether two solutions (k,) are one: times within so much of each other, directions of the costates ten times
    that."""
    apart = np.abs(one[:ANOMALY] - other[:ANOMALY])
    return bool(np.max(apart[DIRECTION]) <= 10 * within and apart[SPAN] <= within * other[SPAN])


def distinct(extremals: Iterable[Extremal]) -> tuple[Extremal, ...]:
    """Without repetitions, fastest first; two are one when times and costates agree to 1e-6."""
    kept: list[Extremal] = []
    for extremal in sorted(extremals, key=lambda e: e.time):
        if not any(alike(other.unknowns, extremal.unknowns) for other in kept):
            kept.append(extremal)
    return tuple(kept)
