"""Finding extremals without a guess: look at many flights roughly, finish the promising ones.

Screening. Of a flight with any costates, all its moments are candidates: one integration per direction tells when it
comes nearest to the target orbit. Directions come from a low-discrepancy sequence that is densest about the costates
of a slow spiral, (1, 0, 1) / sqrt 2; rounds of it may then zoom in on the best.
Finishing, a few at a time and the most promising first, see `finishing`. Once several starts that are far apart have
led to the same fastest flight and none to a faster one, the rest is left; of an electric sail, for each of the
roundings of its switching.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import partial
from typing import TypeVar

import numpy as np

from sailviz.design.minimum_time.boundary_conditions import ANOMALY, DIRECTION, SPAN, PlanarProblem, lengths
from sailviz.design.minimum_time.costates import STEPS, fly_dense
from sailviz.design.minimum_time.effort import Effort
from sailviz.design.minimum_time.finishing import Extremal, alike, distinct, exact, solve
from sailviz.design.minimum_time.state_costate import Sail, X, Y
from sailviz.propulsion.solar_sail import Film
from sailviz.steering.optimal import optimal_pitch

Item = TypeVar("Item")
Result = TypeVar("Result")

ROUGH = 1e-4  # integration tolerance of screening
ROUNDINGS = (0.3, 0.1)  # of an electric sail's switching: each finds flights that the other does not
KEPT, CHILDREN, ZOOMS = 24, 16, 3
APART, ZOOMED_APART = 0.15, 0.03  # no two candidates are nearer in the costates' direction and the share of time
SAME_ROOT = 1e-4  # relative: two rough solutions are one
AT_A_TIME = 4  # candidates that are finished together
AGREE, ENOUGH = 3, 12  # starts that led to the same flight; starts finished, of which one led to a flight
PIECE, MOST_STEPS_OF_A_PIECE, DIVE = 2.0, 150, 0.02  # of screened flights: time, steps; radius
MOST_AT_ONCE = 64  # flights that are screened in one piece of compiled work, which hears no Ctrl-C: 0.1 s
WORKERS = min(8, os.cpu_count() or 1)
PARTS = 2  # of the flights that are screened, for each of them: more take longer, fewer wait for each other


@dataclass(frozen=True)
class Search:
    """What a search found: distinct extremals, fastest first; how many starts were finished and how many of them
    converged; the best miss among the screened flights of the true sail and its unknowns, where any were flown."""

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
    nearness: Callable[[np.ndarray], np.ndarray],
) -> tuple[np.ndarray, np.ndarray]:
    """Nearest approach of flights from starts (n, 12) to what they aim at: miss (n,) and time (n,) of it, looked for at
    so many samples of the span. nearness(rows (n, m, 12)) -> squares (n, m) of how far dense rows are from it.

    Flown in pieces, so that one that dives into the Sun is given up before it costs thousands of steps.
    """
    pieces = int(span / PIECE) + 1
    each = max(2, samples // pieces)
    stretch = span / pieces
    times = np.linspace(0.0, stretch, each + 1)
    best, when = np.full(len(starts), np.inf), np.full(len(starts), span)
    flying, y = np.arange(len(starts)), starts
    for piece in range(pieces):
        flown = fly_dense(y, np.full(len(flying), stretch), sail, times, tolerance, smoothing)
        with np.errstate(all="ignore"):
            miss = nearness(flown.rows[:, 1:])
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


def turned(axes, angle, around):
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
    unknowns[:, DIRECTION] = turned(axis, np.pi * q[:, 0] ** 1.5, 2 * np.pi * q[:, 1])
    if problem.free_departure:
        unknowns[:, ANOMALY] = 2 * np.pi * q[:, 2]
    return unknowns


def in_threads(
    function: Callable[[Item], Result],
    items: Sequence[Item],
    progress: Callable[[float], None] | None = None,
    effort: Effort | None = None,
) -> list[Result]:
    """[function(item)] in the order of the items; compiled code lets go of the interpreter."""
    results = []
    with ThreadPoolExecutor(WORKERS) as pool:
        try:
            for result in pool.map(function, items):
                results.append(result)
                if progress is not None:
                    progress(len(results) / len(items))
        except BaseException:  # Ctrl-C: what waits is not begun, what goes on hears of it
            pool.shutdown(wait=False, cancel_futures=True)
            if effort is not None:
                effort.end()
            raise
    return results


def _screened(problem, unknowns, span, smoothing, effort, progress=None):
    """(miss (n,), unknowns with their times) of the flights that unknowns (n, k) begin."""
    starts = problem.starts(unknowns)
    pace = 0.2 * min(1.0, problem.scale) ** 0.75
    samples = int(span / pace) + 2

    def part(places):
        effort.check()
        return screen(starts[places], span, samples, problem.sail, smoothing, ROUGH, problem.nearness)

    parts = max(min(PARTS * WORKERS, len(unknowns) // 8), -(-len(unknowns) // MOST_AT_ONCE))
    found = in_threads(part, np.array_split(np.arange(len(unknowns)), parts), progress, effort)
    effort.count("costates flown roughly", len(unknowns))
    miss, when = (np.concatenate(column) for column in zip(*found, strict=True))
    unknowns = unknowns.copy()
    unknowns[:, SPAN] = when
    return np.where(np.isfinite(miss), miss, np.inf), unknowns


def _candidates(problem, n, zooms, span, smoothing, outwards, effort, progress):
    """(miss, unknowns) of the most promising flights, best first, no two alike."""
    miss, unknowns = _screened(problem, spread(problem, n, outwards), span, smoothing, effort, progress)
    width, q = 3.0 / np.sqrt(n), sequence(CHILDREN, 2)
    for _ in range(zooms):
        best = unknowns[np.argsort(miss, kind="stable")[:KEPT]]
        children = np.repeat(best, CHILDREN, axis=0)
        angle, around = np.tile(width * np.sqrt(q[:, 0]), len(best)), np.tile(2 * np.pi * q[:, 1], len(best))
        children[:, DIRECTION] = turned(children[:, DIRECTION], angle, around)
        if problem.free_departure:
            children[:, ANOMALY] += np.tile(width * (2 * sequence(CHILDREN, 3)[:, 2] - 1), len(best))
        more, children = _screened(problem, children, span, smoothing, effort)
        miss, unknowns = np.concatenate([miss, more]), np.concatenate([unknowns, children])
        width *= 0.5
    least = ZOOMED_APART if zooms else APART
    chosen: list[int] = []
    for i in np.argsort(miss, kind="stable").tolist():
        if len(chosen) == KEPT or not (np.isfinite(miss[i]) or not chosen):
            break
        others = unknowns[chosen]
        apart = np.abs(unknowns[i] - others)
        far = (lengths(apart) > least) | (apart[:, SPAN] > least * others[:, SPAN])
        if np.all(far | (apart[:, ANOMALY:] > 0.1).any(axis=1)):
            chosen.append(i)
    return miss[chosen], unknowns[chosen]


class _Finishing:
    """Candidates that are finished one group after the other, and what they led to."""

    def __init__(self, problem: PlanarProblem, accept: Callable[[np.ndarray], bool], effort: Effort):
        self.problem, self.accept, self.effort = problem, accept, effort
        self.starts = 0
        self.led: list[Extremal] = []  # what each start led to that converged to something wanted
        self._before = (0, 0)  # starts, and how many of them led somewhere, before this pass

    def extremals(self) -> tuple[Extremal, ...]:
        return distinct(self.led)

    def begin(self) -> None:
        """Another pass: what starts agree on is seen anew, since each rounding finds flights of its own."""
        self._before = self.starts, len(self.led)

    def settled(self) -> bool:
        """Whether the rest of a pass may be left: several of its starts led to the fastest flight that it found, or
        many were finished and there is a flight."""
        starts, led = self._before
        here = self.led[led:]
        first = min(here, key=lambda extremal: extremal.time, default=None)
        agreeing = sum(alike(extremal.unknowns, first.unknowns) for extremal in here) if first else 0
        return agreeing >= AGREE or (len(self.led) > 0 and self.starts - starts >= ENOUGH)

    def finish(
        self,
        candidates: np.ndarray,
        smoothing: float,
        quickly: bool,
        all_of_them: bool,
        progress: Callable[[float], None],
    ) -> None:
        """Finish candidates (n, k), all of them or until it is settled. quickly : as in `solve`."""
        known: list[tuple[np.ndarray, Extremal | None]] = []  # solutions with the switching rounded off; what they are

        def rounded(unknowns):
            return solve(self.problem, unknowns, smoothing, self.effort, quickly)

        def true(unknowns):
            found = exact(self.problem, unknowns, smoothing, self.effort)
            return found if found is not None and self.accept(found.unknowns) else None

        for first in range(0, len(candidates), AT_A_TIME):
            group = list(candidates[first : first + AT_A_TIME])
            roots = [x for x in in_threads(rounded, group, None, self.effort) if x is not None]
            new: list[np.ndarray] = []
            for x in roots:
                if not any(alike(x, other, SAME_ROOT) for other in [*new, *(y for y, _ in known)]):
                    new.append(x)
            known += zip(new, in_threads(true, new, None, self.effort), strict=True)
            for x in roots:
                found = next(found for y, found in known if alike(x, y, SAME_ROOT))
                if found is not None:
                    self.led.append(found)
            self.starts += len(group)
            self.effort.count("of them finished", len(group))
            progress((first + len(group)) / len(candidates))
            if self.settled() and not all_of_them:
                break


def search(
    problem: PlanarProblem,
    span: float,
    n: int,
    outwards: bool,
    accept: Callable[[np.ndarray], bool],
    *,
    effort: Effort | None = None,
    words: str = "",
    zooms: int = ZOOMS,
    roundings: Sequence[float] | None = None,
    all_of_them: bool = False,
) -> Search:
    """Screen n directions over a span, finish the best; what there is, where the effort ends before.

    accept(unknowns (k,)) -> bool refuses extremals that are not wanted. words : for the progress. zooms : rounds that
    look closer around the best. roundings : of the switching, one pass each, for an electric sail. all_of_them : no
    candidate is left.
    """
    if roundings is None or not problem.sail.rounds_off:
        roundings = ROUNDINGS if problem.sail.rounds_off else (0.0,)
    effort = effort or Effort()
    finishing = _Finishing(problem, accept, effort)
    best, nearest = np.inf, np.empty(0)

    def report(begin: float, share: float) -> None:
        effort.report((begin + 0.5 * share) / len(roundings), words)

    with effort.stoppable():
        for i, eps in enumerate(roundings):
            finishing.begin()
            miss, candidates = _candidates(problem, n, zooms, span, eps, outwards, effort, partial(report, i))
            if eps == 0.0:
                best, nearest = float(miss[0]), candidates[0]
            finishing.finish(candidates, eps, zooms == 0, all_of_them, partial(report, i + 0.5))
    return Search(finishing.extremals(), finishing.starts, len(finishing.led), best, nearest)


def spiral_time(device: Film | str, strength: float, exponent: float, start: float, end: float) -> float:
    """Flight time between circles by slow spiral at the best transverse thrust, units mu = 1: Edelbaum's
    dr/dt = 2 r^1.5 a_t with a_t = strength r^-exponent h(90 deg)."""
    power = exponent - 0.5
    return abs(end**power - start**power) / (2 * power * strength * optimal_pitch(0.5 * np.pi, device).support)
