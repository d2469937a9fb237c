"""Flights from all around an orbit: handed on from point to point, until each minimum of the flight time is found."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from concurrent.futures import Executor
from typing import NamedTuple

import numpy as np

from sailviz.design.minimum_time.orbit_conditions import Bent, OrbitProblem, PlanarGuess
from sailviz.design.minimum_time.unknowns import EXACT, LOOSE, NEAR, SAME, TIGHT, Unknowns, fastest

MOST_CLOSER = 20  # steps towards a minimum
CLOSE_SLOPE, EXACT_SLOPE = 1e-4, 1e-12  # of lam . (v, -r / r^3)

Ring = list[Unknowns | None]  # a flight, or none, from each departure point


class Around(NamedTuple):
    """The flights from all around an orbit, and, where there are none, how far the best could be bent."""

    ring: Ring
    nearest: Bent | None


def fly_around(
    pool: Executor,
    problem: OrbitProblem,
    planar: PlanarGuess,
    radius: float,
    anomalies: np.ndarray,
    smoothing: float,
    flown: Callable[[Unknowns | None], None],
) -> Around:
    """Flights from departure points (n,) rad grown out of a planar one: at once, from their neighbours, or, where both
    fail, by bending the orbits from coplanar circles, the target's of the radius given. flown(flight or None) is
    called once per point."""

    def embedded(anomaly: float) -> Unknowns | None:
        x, residual = problem.search(problem.embedded(planar, anomaly), smoothing)
        found = x if residual <= NEAR and problem.hamiltonian(x) > 0 else None
        flown(found)
        return found

    def bent(anomaly: float) -> Bent:
        found = problem.bend(problem.embedded(planar, anomaly), radius, smoothing)
        return found if problem.hamiltonian(found.unknowns) > 0 else found._replace(residual=np.inf)

    ring = _hand_on(pool, problem, list(pool.map(embedded, anomalies)), anomalies, smoothing)
    missing = [i for i, x in enumerate(ring) if x is None]
    grown = dict(zip(missing, pool.map(bent, anomalies[missing]), strict=True))
    if grown:
        for i, found in grown.items():
            ring[i] = found.unknowns if found.residual <= NEAR else None
        ring = _hand_on(pool, problem, ring, anomalies, smoothing)
    if any(x is not None for x in ring):
        return Around(ring, None)
    return Around(ring, max(grown.values(), key=lambda found: (found.share, -found.unknowns.span)))


def _hand_on(pool: Executor, problem: OrbitProblem, ring: Ring, anomalies: np.ndarray, smoothing: float) -> Ring:
    """Flights handed from each departure point of the ring to the next, both ways round, wherever they are faster."""
    ways = list(pool.map(lambda way: _hand_on_one_way(problem, ring, anomalies, smoothing, way), (1, -1)))
    return [fastest(point) for point in zip(*ways, strict=True)]


def _hand_on_one_way(problem: OrbitProblem, ring: Ring, anomalies: np.ndarray, smoothing: float, way: int) -> Ring:
    found, n, before = list(ring), len(ring), None
    for step in range(2 * n):
        i = way * step % n
        here = found[i]
        if before is not None and (here is None or here.span > before.span * (1 + SAME)):
            x, residual = problem.search(problem.carried(before, anomalies[i]), smoothing)
            faster = here is None or x.span < here.span * (1 - SAME)
            if residual <= NEAR and faster and problem.hamiltonian(x) > 0:
                found[i] = x
        before = found[i]
        if step >= n and found[i] is ring[i]:  # nothing new comes round a second time
            break
    return found


def valleys(ring: Sequence[Unknowns | None]) -> list[Unknowns]:
    """The flights of the ring that no neighbour beats."""
    n, found = len(ring), []
    for i, x in enumerate(ring):
        sides = (ring[i - 1], ring[(i + 1) % n])
        if x is not None and all(y is None or x.span <= y.span for y in sides):
            found.append(x)
    return found


def minimum(problem: OrbitProblem, unknowns: Unknowns, step: float, smoothing: float) -> Unknowns | None:
    """The minimum over the departure point near a flight of the ring, for the true sail; None if it escapes.

    step : rad between departure points. smoothing : with which the flight was found.
    """
    rough = unknowns
    if smoothing > 0:
        rounded = _descend(problem, unknowns, step, smoothing, LOOSE, CLOSE_SLOPE)
        if rounded is None:
            return None
        rough, residual = problem.sharpen(rounded)
        if residual > NEAR:
            return None
    near = _descend(problem, rough, step, 0.0, LOOSE, CLOSE_SLOPE)
    if near is None:
        return None
    polished, residual = problem.search(near, 0.0, TIGHT)
    if residual > EXACT:
        return None
    found = _descend(problem, polished, 0.1 * step, 0.0, TIGHT, EXACT_SLOPE)
    return found if found is not None and problem.hamiltonian(found) > 0 else None


def _descend(
    problem: OrbitProblem, unknowns: Unknowns, step: float, smoothing: float, tolerance: float, close: float
) -> Unknowns | None:
    """The flight whose slope over the departure point vanishes, downhill from a flight: steps that grow until the
    slope changes sign, then false position (Illinois). None where the flights cannot be followed that far.

    One unknown apart from the others: all eight at once converge from too near only, since the flight time hardly
    depends on the departure point.
    """
    near = NEAR if tolerance == LOOSE else EXACT
    low, g_low = unknowns, problem.slope(unknowns)
    high, g_high = None, 0.0
    for _ in range(MOST_CLOSER):
        if abs(g_low) <= close:
            return low
        if high is None:
            anomaly = low.departure + np.copysign(step, g_low)
        else:
            anomaly = low.departure + (high.departure - low.departure) * g_low / (g_low - g_high)
            if not min(low.departure, high.departure) < anomaly < max(low.departure, high.departure):
                break
        y, residual = problem.search(problem.carried(low, anomaly), smoothing, tolerance)
        if residual > near:
            if high is not None:
                return None
            step *= 0.3
            continue
        g = problem.slope(y)
        if g * g_low > 0:
            low, g_low, step = y, g, 2 * step
            if high is not None:
                g_high = 0.5 * g_high
        else:
            low, g_low, high, g_high = y, g, low, g_low
    return low if abs(g_low) <= 1e3 * close else None
