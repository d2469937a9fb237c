"""Following a solution: pseudo-arclength continuation in a parameter that makes the problem easy at 0.

An electric sail is followed with its switching rounded off: where a coasting arc appears, the true misses have no
derivative. How far the true sail gets is told by those points of the path that can still be sharpened.
Source: H. B. Keller (1977).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from sailviz.design.minimum_time.boundary_conditions import SPAN, PlanarProblem
from sailviz.design.minimum_time.effort import Effort
from sailviz.design.minimum_time.finishing import LOOSE, Extremal, exact, finish, solve

FOLLOWED = 0.03  # the rounding of an electric sail's switching on the way
BACK = (0.3, 0.1, 0.03, 0.01, 3e-3, 1e-3, 3e-4)  # from the true law to it


@dataclass(frozen=True)
class Path:
    """A continuation: the largest parameter reached and the unknowns there, of the true law at 1, where it is complete,
    else rounded off by smoothing; the (parameter, unknowns) passed on the way that were the farthest then."""

    parameter: float
    unknowns: np.ndarray
    smoothing: float
    passed: tuple[tuple[float, np.ndarray], ...]

    @property
    def complete(self) -> bool:
        return self.parameter == 1.0


def follow(
    problem_at: Callable[[float], PlanarProblem],
    unknowns: np.ndarray,
    steps: int = 500,
    effort: Effort | None = None,
    words: str = "",
) -> Path:
    """Pseudo-arclength continuation from a solution of problem_at(0) towards problem_at(1), through folds.

    problem_at(s) : a problem for every s; unknowns (k,) solve it at 0. Ends where the effort ends.
    """
    effort = effort or Effort()
    eps = FOLLOWED if problem_at(0.0).sail.rounds_off else 0.0
    passed = [(0.0, np.array(unknowns))]
    with effort.stoppable():
        there = _followed(problem_at, unknowns, eps, steps, passed, effort, words)
        if there is not None:
            return Path(1.0, there.unknowns, 0.0, tuple(passed))
    return Path(*passed[-1], eps, tuple(passed))


def _followed(problem_at, unknowns, eps, steps, passed, effort, words):
    """The extremal at 1, or None. passed : to which what is passed on the way is added."""
    for rounding in [x for x in reversed(BACK) if x <= eps]:
        rounded = solve(problem_at(0.0), unknowns, rounding, effort, quickly=False)
        if rounded is None:
            return None
        unknowns = rounded
    passed[0] = (0.0, unknowns)
    k = len(unknowns)
    scale = np.ones(k)
    scale[SPAN] = 1.0 / unknowns[SPAN]

    def misses(z):
        effort.check()
        return problem_at(z[k]).misses((z[:k] / scale)[None], LOOSE, eps)[0]

    def slope(z):
        effort.check()
        x, step = z[:k] / scale, 1e-6
        values = problem_at(z[k]).misses(np.vstack([x, x + np.diag(step / scale)]), LOOSE, eps)
        along = problem_at(z[k] + step).misses(x[None], LOOSE, eps)[0]
        return np.column_stack([(values[1:] - values[0]).T, along - values[0]]) / step

    def corrected(z, ahead, jacobian):
        """The solution near z + ahead in the plane normal to ahead, and the iterations it took; None."""
        new = z + ahead
        for turn in range(6):
            f = misses(new)
            if np.all(np.isfinite(f)) and np.abs(f).max() < 1e-8:
                return new, turn
            here = slope(new) if turn else jacobian
            if not (np.all(np.isfinite(f)) and np.all(np.isfinite(here))):
                return None
            matrix, off = np.vstack([here, ahead]), np.append(f, ahead @ (new - z - ahead))
            new = new - np.linalg.lstsq(matrix, off)[0]
            if np.linalg.norm(new - z) > 3 * np.linalg.norm(ahead):
                return None
        return None

    z, tangent = np.append(unknowns * scale, 0.0), np.append(np.zeros(k), 1.0)
    ds = 0.02
    for _ in range(steps):
        jacobian = slope(z)
        if not np.all(np.isfinite(jacobian)):
            return None
        null = np.linalg.svd(jacobian)[2][-1]
        tangent = null if null @ tangent >= 0 else -null
        found = corrected(z, ds * tangent, jacobian)
        while found is None and ds > 1e-6:
            ds *= 0.5
            found = corrected(z, ds * tangent, jacobian)
        if found is None:
            return None
        new, turns = found
        effort.count("steps of continuation")
        if new[k] >= 1.0:
            share = (1.0 - z[k]) / (new[k] - z[k])
            return finish(problem_at(1.0), (z + share * (new - z))[:k] / scale, eps, effort)
        z = new
        if z[k] > passed[-1][0]:
            passed.append((float(z[k]), z[:k] / scale))
        effort.report(passed[-1][0], words)
        if turns <= 3:
            ds = min(1.5 * ds, 0.2)
    return None


def farthest(
    path: Path,
    problem_at: Callable[[float], PlanarProblem],
    accept: Callable[[PlanarProblem, np.ndarray], bool],
    effort: Effort,
) -> tuple[float, Extremal] | None:
    """The parameter and the flight of the true sail that is the farthest on a path, by bisection over what it passed:
    sharpening is lost somewhere and not regained. None where it is lost all along."""
    low, high, found = 0, len(path.passed), None
    with effort.stoppable():
        while low < high:
            middle = (low + high) // 2 if found is not None else low
            at, unknowns = path.passed[middle]
            true = exact(problem_at(at), unknowns, path.smoothing, effort)
            if true is not None and accept(problem_at(at), true.unknowns):
                low, found = middle + 1, (at, true)
            elif found is None:
                break
            else:
                high = middle
    return found
