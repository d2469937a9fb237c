"""Fastest flights between two orbits in space, with free anomalies at both ends, from nothing but the orbits.

Search: the circle-to-circle flight between the mean distances, embedded at departure points all around the orbit; where
that is too far, the orbits are bent from coplanar circles to their true shape. Neighbouring departure points hand
their flights on, so that the lowest branch is followed around; then the departure point is set free. There are many
local solutions in space: what is returned is the best found. Costates are found with |lam| = 1 and given with H = +1.
"""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

import numpy as np

from sailviz.constants import AU, DAY
from sailviz.design.minimum_time import costates
from sailviz.design.minimum_time.circles import circle_to_circle
from sailviz.design.minimum_time.departure_points import fly_around, minimum, valleys
from sailviz.design.minimum_time.kepler_orbit import KeplerOrbit
from sailviz.design.minimum_time.orbit_conditions import OrbitProblem, PlanarGuess
from sailviz.design.minimum_time.state_costate import (
    COSTATES,
    POSITION,
    SPEED_UNIT,
    TIME_UNIT,
    VELOCITY,
    canonical_sail,
    revolutions,
)
from sailviz.design.minimum_time.unknowns import SMOOTHING, TIGHT, Unknowns, distinct, span_of
from sailviz.elements import Elements
from sailviz.propulsion.solar_sail import Film

STARTS = 24  # departure points tried, evenly around the orbit
LEAST_CLIMB = 0.1  # of the logarithm of the distance, for a first flight between circles
ROWS = 400  # along a flight, to count its revolutions


@dataclass(frozen=True)
class OrbitTransfer:
    """A flight from orbit to orbit. time s; revolutions swept about the Sun; departure_anomaly, arrival_anomaly true
    anomalies rad; costates (6,) at departure, lam_r and lam_v in units of mu = 1 and one au with H = +1, so that they
    are -d time / d (position, velocity); residual, the boundary miss, largest entry in the same units;
    hamiltonian_drift |H - 1| along the flight; solutions distinct minima found. position m and velocity m/s (3,) at
    departure.

    feasible False and reason: none was found; the numbers are then those of the nearest flight.
    """

    time: float
    revolutions: float
    departure_anomaly: float
    arrival_anomaly: float
    costates: np.ndarray
    residual: float
    hamiltonian_drift: float
    solutions: int
    claim: str
    feasible: bool
    reason: str
    position: np.ndarray
    velocity: np.ndarray
    device: Film | str
    characteristic_acceleration: float


def orbit_to_orbit(
    initial_elements: Elements,
    final_elements: Elements,
    device: Film | str = "ideal",
    characteristic_acceleration: float = 1e-3,
    *,
    starts: int = STARTS,
    workers: int = 2,
    progress: Callable[[float, str], None] | None = None,
) -> OrbitTransfer:
    """The fastest flight found between two ellipses, departure and arrival anomaly free (those of the elements do not
    count).

    device : a sail's name or a Film. characteristic_acceleration : m/s2. starts : departure points tried. workers :
    threads; the result does not depend on them. progress(share, words) is called as the search goes on. ValueError for
    orbits that are no ellipses or a thrust that is none. Residuals below 1e-12; locally optimal, and best found: other
    families of flights are not excluded.
    """
    if not (np.isfinite(characteristic_acceleration) and characteristic_acceleration > 0):
        raise ValueError(f"a characteristic acceleration must be positive, not {characteristic_acceleration}")
    problem = OrbitProblem(
        KeplerOrbit.from_elements(initial_elements),
        KeplerOrbit.from_elements(final_elements),
        canonical_sail(device, characteristic_acceleration),
    )
    try:
        planar = planar_guess(problem, device, characteristic_acceleration)
    except NoGuess as reason:
        return _unknown(problem, str(reason), device, characteristic_acceleration)
    total, done = 2 * starts, 0

    def report(n: int = 1, words: str = "departure points") -> None:
        nonlocal done
        done = min(done + n, total)
        if progress is not None:
            progress(done / total, words)

    spacing = 2 * np.pi / starts
    smoothing = SMOOTHING if problem.sail.rounds_off else 0.0
    with ThreadPoolExecutor(workers) as pool:
        anomalies = 2 * np.pi * np.arange(starts) / starts
        ring, nearest = fly_around(pool, problem, planar, target_radius(problem), anomalies, smoothing, report)
        if nearest is not None:
            return _nothing(problem, nearest.unknowns, nearest.share, device, characteristic_acceleration)
        report(starts // 2, "minima")
        minima = distinct(pool.map(lambda x: minimum(problem, x, spacing, smoothing), valleys(ring)))
    report(total, "done")
    if not minima:
        return _nothing(problem, min(filter(None, ring), key=span_of), 1.0, device, characteristic_acceleration)
    claim = (
        f"best found of {len(minima)} local {'minimum' if len(minima) == 1 else 'minima'} "
        f"from {starts} departure points; a faster flight is not excluded"
    )
    return _transfer(problem, minima[0], device, characteristic_acceleration, len(minima), claim)


class NoGuess(Exception):
    """There is no flight between circles to begin with, and why."""


def target_radius(problem: OrbitProblem) -> float:
    """Radius of the circle aimed at first: the target's mean distance, or one tenth off where that is the origin's."""
    a0, a = problem.origin.semi_major_axis, problem.target.semi_major_axis
    return a if abs(np.log(a / a0)) > LEAST_CLIMB else a0 * np.exp(np.copysign(LEAST_CLIMB, a - a0))


def planar_guess(problem: OrbitProblem, device: Film | str, characteristic_acceleration: float) -> PlanarGuess:
    """The flight between circles of the mean distances; NoGuess where there is none."""
    a0, a = problem.origin.semi_major_axis * AU, target_radius(problem) * AU
    found = circle_to_circle(a0, a, device, characteristic_acceleration)
    if not found.feasible:
        raise NoGuess(f"no flight found between circles of the mean distances: {found.reason}")
    lr, lu, lv = found.costates  # in units of the first circle; up to a factor
    unit = problem.origin.semi_major_axis**1.5
    return PlanarGuess((lr, lu * unit, lv * unit), found.time / TIME_UNIT)


def _transfer(
    problem: OrbitProblem,
    unknowns: Unknowns,
    device: Film | str,
    characteristic_acceleration: float,
    local: int,
    claim: str,
    feasible: bool = True,
    reason: str = "",
) -> OrbitTransfer:
    start, span = problem.start(unknowns), unknowns.span
    start[COSTATES] /= problem.hamiltonian(unknowns)
    flight = costates.propagate(start, span, problem.sail, times=np.linspace(0, span, ROWS), tolerance=TIGHT)
    missed = problem.residuals(unknowns.packed[None], unknowns.departure, TIGHT, 0.0)
    return OrbitTransfer(
        time=float(span * TIME_UNIT),
        revolutions=revolutions(flight.rows),
        departure_anomaly=float(np.mod(unknowns.departure, 2 * np.pi)),
        arrival_anomaly=float(np.mod(problem.target.anomaly(flight.end[POSITION]), 2 * np.pi)),
        costates=start[COSTATES],
        residual=float(max(np.abs(missed).max(), abs(problem.slope(unknowns)))),
        hamiltonian_drift=flight.drift,
        solutions=local,
        claim=claim,
        feasible=feasible,
        reason=reason,
        position=start[POSITION] * AU,
        velocity=start[VELOCITY] * SPEED_UNIT,
        device=device,
        characteristic_acceleration=characteristic_acceleration,
    )


def _nothing(
    problem: OrbitProblem, unknowns: Unknowns, share: float, device: Film | str, characteristic_acceleration: float
) -> OrbitTransfer:
    """What came nearest: the flight to the orbit bent the furthest."""
    reason = (
        f"no flight found: an orbit {100 * share:.0f} % of the way from a coplanar circle to the one asked for is the "
        f"nearest that was reached, after {unknowns.span * TIME_UNIT / DAY:.1f} d"
    )
    return _transfer(problem, unknowns, device, characteristic_acceleration, 0, reason, False, reason)


def _unknown(
    problem: OrbitProblem, reason: str, device: Film | str, characteristic_acceleration: float
) -> OrbitTransfer:
    """The result of a search that could not begin."""
    position, velocity = problem.origin.state(0.0)
    nan = np.nan
    return OrbitTransfer(
        nan, nan, nan, nan, np.full(6, nan), nan, nan, 0, reason, False, reason,
        position * AU, velocity * SPEED_UNIT, device, characteristic_acceleration,
    )  # fmt: skip
