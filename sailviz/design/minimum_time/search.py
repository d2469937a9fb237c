"""Finding extremals without a guess: look at many flights roughly, finish the promising ones, follow where none is.

Screening. Of a flight with any costates, all its moments are candidates: one integration per direction tells when it
comes nearest to the target orbit. Directions come from a low-discrepancy sequence that is densest about the costates
of a slow spiral, (1, 0, 1) / sqrt 2; three rounds of it then zoom in on the best.
Finishing. Levenberg-Marquardt at a loose, then at a tight integration tolerance; E-sails first with their switching
rounded off, then less and less so.
Following. Where nothing converges: pseudo-arclength continuation in a parameter that makes the problem easy at 0.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import partial
from typing import TypeVar

import numpy as np

from sailviz.design.minimum_time import shooting
from sailviz.design.minimum_time.boundary_conditions import ANOMALY, DIRECTION, SPAN, PlanarProblem
from sailviz.design.minimum_time.costates import STEPS, fly_dense
from sailviz.design.minimum_time.state_costate import VX, VY, Sail, X, Y
from sailviz.propulsion.solar_sail import Film
from sailviz.steering.optimal import optimal_pitch

Item = TypeVar("Item")
Result = TypeVar("Result")

LOOSE, TIGHT = 1e-9, 1e-13  # integration tolerances
ROUGH = 1e-6  # of screening
GOAL = 1e-9  # largest miss of a solution
ROUNDINGS = (0.3, 0.1, 0.03, 0.01, 3e-3, 1e-3, 3e-4, 0.0)  # of the switching, on the way to the true law
FOLLOWED = 0.03  # the rounding that continuation keeps
KEPT, CHILDREN, ZOOMS = 24, 16, 3
PIECE, MOST_STEPS_OF_A_PIECE, DIVE = 2.0, 150, 0.02  # of screened flights: time, steps; radius
MOST_AT_ONCE = 64  # flights that are screened in one piece of compiled work, which hears no Ctrl-C: 0.1 s
WORKERS = min(8, os.cpu_count() or 1)


@dataclass(frozen=True)
class Extremal:
    """One solution of the necessary conditions: unknowns as the problem defines them, largest miss."""

    unknowns: np.ndarray
    miss: float

    @property
    def time(self) -> float:
        return float(self.unknowns[SPAN])


@dataclass(frozen=True)
class Search:
    """What a search found: distinct extremals, fastest first; how many starts were finished and how many of them
    converged; the best miss among all the screened flights and its unknowns."""

    extremals: tuple[Extremal, ...]
    starts: int
    converged: int
    nearest_miss: float
    nearest: np.ndarray


def screen(
    starts: np.ndarray,
    span: float,
    samples: int,
    sail: Sail,
    smoothing: float,
    tolerance: float,
    target: tuple[float, float, float],
) -> tuple[np.ndarray, np.ndarray]:
    """Nearest approach of flights from starts (n, 12) to a planar orbit: miss (n,) in semi-latus rectum and
    eccentricity vector, time (n,) of it, looked for at so many samples of the span.

    Flown in pieces, so that one that dives into the Sun is given up before it costs thousands of steps.
    """
    pieces = int(span / PIECE) + 1
    each = max(2, samples // pieces)
    stretch = span / pieces
    times = np.linspace(0.0, stretch, each + 1)
    p_wanted, ex_wanted, ey_wanted = target
    best, when = np.full(len(starts), np.inf), np.full(len(starts), span)
    flying, y = np.arange(len(starts)), starts
    for piece in range(pieces):
        flown = fly_dense(y, np.full(len(flying), stretch), sail, times, tolerance, smoothing)
        px, py, vx, vy = (flown.rows[:, 1:, place] for place in (X, Y, VX, VY))
        with np.errstate(all="ignore"):
            r = np.sqrt(px * px + py * py)
            h = px * vy - py * vx
            ex, ey = vy * h - px / r - ex_wanted, -vx * h - py / r - ey_wanted
            size = h * h / p_wanted - 1.0
            miss = size * size + ex * ex + ey * ey
            near = flown.ends[:, X] ** 2 + flown.ends[:, Y] ** 2
        miss[~(miss < np.inf)] = np.inf  # a row that was not reached
        nearest = np.argmin(miss, axis=1)
        least = miss[np.arange(len(flying)), nearest]
        better = least < best[flying]
        best[flying[better]] = least[better]
        when[flying[better]] = piece * stretch + times[1 + nearest[better]]
        on = (flown.counts[:, STEPS] <= MOST_STEPS_OF_A_PIECE) & (near > DIVE * DIVE)
        flying, y = flying[on], flown.ends[on]
        if not len(flying):
            break
    return np.sqrt(best), when


def sequence(n: int, dimensions: int) -> np.ndarray:
    """(n, dimensions) points of a low-discrepancy sequence in the unit cube: multiples of the powers of the root of
    x^(d + 1) = x + 1 (M. Roberts' generalised golden ratio)."""
    g = 1.5
    for _ in range(40):
        g = (1 + g) ** (1 / (dimensions + 1))
    return np.mod(0.5 + np.outer(np.arange(1, n + 1), g ** -np.arange(1.0, dimensions + 1)), 1.0)


def _turned(axes, angle, around):
    """Directions (n, 3) at an angle from axes (n, 3) or (3,), spread around them."""
    axes = np.broadcast_to(axes, (len(angle), 3))
    helper = np.where(np.abs(axes[:, 1:2]) < 0.9, [[0.0, 1.0, 0.0]], [[1.0, 0.0, 0.0]])
    first = np.cross(axes, helper)
    first /= np.linalg.norm(first, axis=1)[:, None]
    second = np.cross(axes, first)
    sideways = np.cos(around)[:, None] * first + np.sin(around)[:, None] * second
    return np.cos(angle)[:, None] * axes + np.sin(angle)[:, None] * sideways


def spread(problem: PlanarProblem, n: int, outwards: bool) -> np.ndarray:
    """n unknowns all over the sphere of costate directions, and all round the initial orbit where that is free."""
    q = sequence(n, problem.size - 2)
    axis = (1 if outwards else -1) * np.array([1.0, 0.0, 1.0]) / np.sqrt(2)
    unknowns = np.zeros((n, problem.size))
    unknowns[:, DIRECTION] = _turned(axis, np.pi * q[:, 0] ** 1.5, 2 * np.pi * q[:, 1])
    if problem.free_departure:
        unknowns[:, ANOMALY] = 2 * np.pi * q[:, 2]
    return unknowns


def in_threads(
    function: Callable[[Item], Result], items: Sequence[Item], progress: Callable[[float], None] | None = None
) -> list[Result]:
    """[function(item)] in the order of the items; compiled code lets go of the interpreter."""
    results = []
    with ThreadPoolExecutor(WORKERS) as pool:
        try:
            for result in pool.map(function, items):
                results.append(result)
                if progress is not None:
                    progress(len(results) / len(items))
        except BaseException:  # Ctrl-C: what waits is not begun
            pool.shutdown(wait=False, cancel_futures=True)
            raise
    return results


def _screened(problem, unknowns, span, smoothing, progress=None):
    """(miss (n,), unknowns with their times) of the flights that unknowns (n, k) begin."""
    starts = problem.starts(unknowns)
    semi_latus_rectum, *_ = problem.target
    pace = 0.2 * min(1.0, semi_latus_rectum) ** 0.75
    samples = int(span / pace) + 2
    sail, target = problem.sail, problem.target

    def part(places):
        return screen(starts[places], span, samples, sail, smoothing, ROUGH, target)

    parts = max(16, -(-len(unknowns) // MOST_AT_ONCE))
    found = in_threads(part, np.array_split(np.arange(len(unknowns)), parts), progress)
    miss, when = (np.concatenate(column) for column in zip(*found, strict=True))
    unknowns = unknowns.copy()
    unknowns[:, SPAN] = when
    return np.where(np.isfinite(miss), miss, np.inf), unknowns


def _candidates(problem, n, span, smoothing, outwards, progress):
    """(miss, unknowns) of the most promising flights, best first, no two alike."""
    miss, unknowns = _screened(problem, spread(problem, n, outwards), span, smoothing, progress)
    width, q = 3.0 / np.sqrt(n), sequence(CHILDREN, 2)
    for _ in range(ZOOMS):
        best = unknowns[np.argsort(miss, kind="stable")[:KEPT]]
        children = np.repeat(best, CHILDREN, axis=0)
        angle, around = np.tile(width * np.sqrt(q[:, 0]), len(best)), np.tile(2 * np.pi * q[:, 1], len(best))
        children[:, DIRECTION] = _turned(children[:, DIRECTION], angle, around)
        if problem.free_departure:
            children[:, ANOMALY] += np.tile(width * (2 * sequence(CHILDREN, 3)[:, 2] - 1), len(best))
        more, children = _screened(problem, children, span, smoothing)
        miss, unknowns = np.concatenate([miss, more]), np.concatenate([unknowns, children])
        width *= 0.5
    chosen = []
    for i in np.argsort(miss, kind="stable"):
        apart = [np.abs(unknowns[i] - unknowns[j]) for j in chosen]
        if all(np.linalg.norm(a[DIRECTION]) > 0.03 or a[SPAN] > 0.5 or np.any(a[ANOMALY:] > 0.1) for a in apart):
            chosen.append(i)
            if len(chosen) == KEPT or not np.isfinite(miss[i]):
                break
    return miss[chosen], unknowns[chosen]


def _solve(problem, unknowns, smoothing):
    limit = np.array([0.2, 0.2, 0.2, 0.1 * max(unknowns[SPAN], 0.1), 0.3])[: problem.size]
    return shooting.solve(
        lambda x: problem.misses(x, LOOSE, smoothing), unknowns, step=1e-6, goal=1e-7, most=30, limit=limit
    )


def finish(problem: PlanarProblem, unknowns: np.ndarray, smoothing: float = 0.0) -> Extremal | None:
    """The extremal that rough unknowns (k,) lead to, or None."""
    for eps in [eps for eps in ROUNDINGS if eps <= smoothing]:
        found = _solve(problem, unknowns, eps)
        if not found.residual < 1e-5:
            return None
        unknowns = found.unknowns
    found = shooting.solve(lambda x: problem.misses(x, TIGHT), unknowns, step=1e-7, goal=1e-13, most=15)
    if not (found.residual < GOAL and found.unknowns[SPAN] > 0):
        return None
    return Extremal(found.unknowns, found.residual)


def distinct(extremals: Iterable[Extremal]) -> tuple[Extremal, ...]:
    """Without repetitions, fastest first; two are one when times and costates agree to 1e-6."""
    kept: list[Extremal] = []
    for extremal in sorted(extremals, key=lambda e: e.time):
        apart = [np.abs(extremal.unknowns[:ANOMALY] - other.unknowns[:ANOMALY]) for other in kept]
        if all(np.max(a[DIRECTION]) > 1e-5 or a[SPAN] > 1e-6 * extremal.time for a in apart):
            kept.append(extremal)
    return tuple(kept)


def search(
    problem: PlanarProblem,
    span: float,
    n: int,
    outwards: bool,
    accept: Callable[[np.ndarray], bool],
    roundings: Sequence[float] | None = None,
    progress: Callable[[float], None] | None = None,
) -> Search:
    """Screen n directions over a span, finish the best. accept(unknowns (k,)) -> bool refuses extremals that are not
    wanted. roundings : with which the switching is rounded off at first, one pass each."""
    if roundings is None:
        roundings = (0.03, 0.1, 0.0) if problem.sail.rounds_off else (0.0,)
    found: list[Extremal | None] = []
    starts, best, nearest = 0, np.inf, np.empty(0)
    for i, eps in enumerate(roundings):

        def report(begin: float, share: float, i: int = i) -> None:
            if progress is not None:
                progress((i + begin + 0.5 * share) / len(roundings))

        miss, candidates = _candidates(problem, n, span, eps, outwards, partial(report, 0.0))
        if miss[0] < best:
            best, nearest = float(miss[0]), candidates[0]
        starts += len(candidates)
        found += in_threads(partial(finish, problem, smoothing=eps), candidates, partial(report, 0.5))
    converged = [extremal for extremal in found if extremal is not None and accept(extremal.unknowns)]
    return Search(distinct(converged), starts, len(converged), best, nearest)


@dataclass(frozen=True)
class Path:
    """End of a continuation: unknowns at the parameter reached, the largest on the way; complete at 1."""

    parameter: float
    unknowns: np.ndarray

    @property
    def complete(self) -> bool:
        return self.parameter == 1.0


def follow(
    problem_at: Callable[[float], PlanarProblem],
    unknowns: np.ndarray,
    steps: int = 500,
    progress: Callable[[float], None] | None = None,
) -> Path:
    """Pseudo-arclength continuation from a solution of problem_at(0) towards problem_at(1), through folds.

    problem_at(s) : a problem for every s; unknowns (k,) solve it at 0. An E-sail is followed with its switching
    rounded off: where a coasting arc appears, the true misses have no derivative. Source: H. B. Keller (1977).
    """
    eps = FOLLOWED if problem_at(0.0).sail.rounds_off else 0.0
    for rounding in [x for x in reversed(ROUNDINGS) if 0.0 < x <= eps]:
        unknowns = _solve(problem_at(0.0), unknowns, rounding).unknowns
    k = len(unknowns)
    scale = np.ones(k)
    scale[SPAN] = 1.0 / unknowns[SPAN]

    def misses(z):
        return problem_at(z[k]).misses((z[:k] / scale)[None], LOOSE, eps)[0]

    def slope(z):
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
    reach, best, ds = 0.0, np.array(unknowns), 0.02
    for _ in range(steps):
        jacobian = slope(z)
        if not np.all(np.isfinite(jacobian)):
            break
        null = np.linalg.svd(jacobian)[2][-1]
        tangent = null if null @ tangent >= 0 else -null
        found = corrected(z, ds * tangent, jacobian)
        while found is None and ds > 1e-6:
            ds *= 0.5
            found = corrected(z, ds * tangent, jacobian)
        if found is None:
            break
        new, turns = found
        if new[k] >= 1.0:
            share = (1.0 - z[k]) / (new[k] - z[k])
            there = finish(problem_at(1.0), (z + share * (new - z))[:k] / scale, eps)
            if there is not None:
                return Path(1.0, there.unknowns)
            break
        z = new
        if z[k] > reach:
            reach, best = z[k], z[:k] / scale
        if progress is not None:
            progress(reach)
        if turns <= 3:
            ds = min(1.5 * ds, 0.2)
    return Path(float(reach), best)


def spiral_time(device: Film | str, strength: float, exponent: float, start: float, end: float) -> float:
    """Flight time between circles by slow spiral at the best transverse thrust, units mu = 1: Edelbaum's
    dr/dt = 2 r^1.5 a_t with a_t = strength r^-exponent h(90 deg)."""
    power = exponent - 0.5
    return abs(end**power - start**power) / (2 * power * strength * optimal_pitch(0.5 * np.pi, device).support)
