"""Fastest flights between two orbits in space, with free anomalies at both ends, from nothing but the orbits.

Search: the circle-to-circle flight between the mean distances, embedded at departure points all around the orbit; where
that is too far, the orbits are bent from coplanar circles to their true shape. Neighbouring departure points hand
their flights on, so that the lowest branch is followed around; then the departure point is set free. There are many
local solutions in space: what is returned is the best found. Costates are found with |lam| = 1 and given with H = +1.
"""

from __future__ import annotations

from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass, replace

import numpy as np

from sailviz.constants import AU, DAY, RADIUS_SUN
from sailviz.design.minimum_time import costates
from sailviz.design.minimum_time.circles import circle_to_circle
from sailviz.design.minimum_time.departure_points import fly_around, minimum, valleys
from sailviz.design.minimum_time.effort import ANSWERED, Effort, Ending, Progress
from sailviz.design.minimum_time.kepler_orbit import KeplerOrbit
from sailviz.design.minimum_time.orbit_conditions import Bent, OrbitProblem, PlanarGuess
from sailviz.design.minimum_time.state_costate import (
    COSTATES,
    POSITION,
    SPEED_UNIT,
    TIME_UNIT,
    VELOCITY,
    canonical_sail,
    revolutions,
)
from sailviz.design.minimum_time.unknowns import NEAR, SMOOTHING, TIGHT, Unknowns, distinct, fastest
from sailviz.elements import Elements
from sailviz.propulsion.solar_sail import Film

STARTS = 24  # departure points tried, evenly around the orbit
LEAST_CLIMB = 0.1  # of the logarithm of the distance, for a first flight between circles
SHARPENING = 0.5  # s that it may take to tell of the nearest flight
ROWS = 400  # along a flight, to count its revolutions


@dataclass(frozen=True)
class OrbitTransfer:
    """A flight from orbit to orbit. time s; revolutions swept about the Sun; departure_anomaly, arrival_anomaly true
    anomalies rad; costates (6,) at departure, lam_r and lam_v in units of mu = 1 and one au with H = +1, so that they
    are -d time / d (position, velocity); residual, the boundary miss, largest entry in the same units;
    hamiltonian_drift |H - 1| along the flight; solutions distinct minima found. position m and velocity m/s (3,) at
    departure.

    feasible False and reason: none was found; the numbers are then NaN, and ending tells of the nearest true flight.
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
    ending: Ending = ANSWERED


def orbit_to_orbit(
    initial_elements: Elements,
    final_elements: Elements,
    device: Film | str = "ideal",
    characteristic_acceleration: float = 1e-3,
    *,
    starts: int = STARTS,
    workers: int = 2,
    progress: Progress | None = None,
    time_limit: float | None = None,
    effort: Effort | None = None,
) -> OrbitTransfer:
    """The fastest flight found between two ellipses, departure and arrival anomaly free (those of the elements do not
    count).

    device : a sail's name or a Film. characteristic_acceleration : m/s2. starts : departure points tried. workers :
    threads; the result does not depend on them. progress(share, words) is called as the search goes on, which ends
    after time_limit s of wall time with the best minimum so far; effort : an `Effort` instead of both. ValueError for
    orbits that are no ellipses or a thrust that is none. Residuals below 1e-12; locally optimal, and best found: other
    families of flights are not excluded.
    """
    if not (np.isfinite(characteristic_acceleration) and characteristic_acceleration > 0):
        raise ValueError(f"a characteristic acceleration must be positive, not {characteristic_acceleration}")
    effort = Effort.of(effort, progress, time_limit)
    problem = OrbitProblem(
        KeplerOrbit.from_elements(initial_elements),
        KeplerOrbit.from_elements(final_elements),
        canonical_sail(device, characteristic_acceleration),
        effort,
    )
    proof = _proof_of_none(problem, device)
    if proof:
        return _none(problem, proof, device, characteristic_acceleration, effort.impossible())
    try:
        planar = planar_guess(problem, device, characteristic_acceleration)
    except NoGuess as none:
        return _none(problem, str(none), device, characteristic_acceleration, none.ending)
    total, done = 2 * starts, 0

    def report(n: int = 1, words: str = "departure points") -> None:
        nonlocal done
        done = min(done + n, total)
        effort.report(done / total, words)

    spacing = 2 * np.pi / starts
    smoothing = SMOOTHING if problem.sail.rounds_off else 0.0
    ring: list[Unknowns | None] = []
    nearest: Bent | None = None
    minima: list[Unknowns | None] = []

    def flown(x: Unknowns | None) -> None:
        ring.append(x)
        effort.count("departure points tried")
        report()

    def descended(x: Unknowns) -> None:
        found = minimum(problem, x, spacing, smoothing)
        if found is not None:
            minima.append(found)

    with ThreadPoolExecutor(workers) as pool, _ended_by(effort):
        anomalies = 2 * np.pi * np.arange(starts) / starts
        ring, nearest = fly_around(pool, problem, planar, target_radius(problem), anomalies, smoothing, flown)
        report(starts // 2, "minima")
        list(pool.map(descended, valleys(ring)))
    report(total, "done")
    found = distinct(minima)
    if not found:
        told = _told(problem, fastest(ring), nearest)
        reason = f"no flight found: {told or 'none of the true sail came near'}"
        advice = ["take a higher characteristic acceleration", f"begin at more than {starts} departure points"]
        if effort.stopped:
            advice.append(f"give the search more time than the {effort.seconds:.3g} s it had")
        return _none(problem, reason, device, characteristic_acceleration, effort.not_found(told, *advice))
    claim = (
        f"best found of {len(found)} local {'minimum' if len(found) == 1 else 'minima'} "
        f"from {starts} departure points; a faster flight is not excluded"
    )
    ending = effort.found()
    claim += f".{ending.mark}" if ending.mark else ""
    return _transfer(problem, found[0], device, characteristic_acceleration, len(found), claim, ending)


@contextmanager
def _ended_by(effort: Effort) -> Iterator[None]:
    """End what other threads do with the body, and go on behind it where the effort ended."""
    with effort.stoppable():
        try:
            yield
        except BaseException:  # Ctrl-C: what goes on hears of it
            effort.end()
            raise


def _proof_of_none(problem: OrbitProblem, device: Film | str) -> str:
    """Why there cannot be a flight from orbit to orbit, "" where that is not known."""
    origin, target = problem.origin, problem.target
    for which, orbit in (("target", target), ("departure", origin)):
        if orbit.semi_major_axis * (1 + orbit.e) * AU < RADIUS_SUN:
            return f"the {which} lies inside the Sun"
    apart = np.linalg.norm(origin.momentum - target.momentum) > 1e-9 * np.sqrt(origin.p)
    if isinstance(device, Film) and device.b2 == 0.0 and device.b3 == 0.0 and apart:
        return "a film that reflects nothing pushes along the Sun line only, which leaves r x v as it is"
    return ""


class NoGuess(Exception):
    """There is no flight between circles to begin with, and why; ending : of the search for one."""

    def __init__(self, reason: str, ending: Ending):
        super().__init__(reason)
        self.ending = ending


def target_radius(problem: OrbitProblem) -> float:
    """Radius of the circle aimed at first: the target's mean distance, or one tenth off where that is the origin's."""
    a0, a = problem.origin.semi_major_axis, problem.target.semi_major_axis
    return a if abs(np.log(a / a0)) > LEAST_CLIMB else a0 * np.exp(np.copysign(LEAST_CLIMB, a - a0))


def planar_guess(problem: OrbitProblem, device: Film | str, characteristic_acceleration: float) -> PlanarGuess:
    """The flight between circles of the mean distances; NoGuess where there is none."""
    a0, a = problem.origin.semi_major_axis * AU, target_radius(problem) * AU
    found = circle_to_circle(a0, a, device, characteristic_acceleration, effort=problem.effort.part(0.0, 0.0))
    if not found.feasible:
        raise NoGuess(f"no flight found between circles of the mean distances: {found.reason}", found.ending)
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
    ending: Ending,
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
        feasible=True,
        reason="",
        position=start[POSITION] * AU,
        velocity=start[VELOCITY] * SPEED_UNIT,
        device=device,
        characteristic_acceleration=characteristic_acceleration,
        ending=ending,
    )


def _told(problem: OrbitProblem, ringed: Unknowns | None, bent: Bent | None) -> str:
    """In words, the nearest flight of the true sail: from a departure point that is not the best one, or to an orbit
    that is bent part of the way; "" where none of these can be sharpened."""
    again = replace(problem, effort=Effort(SHARPENING))
    with again.effort.stoppable():
        for x, there in (
            (ringed, again),
            (bent and bent.unknowns, bent and again.bent(bent.share, target_radius(again))),
        ):
            if x is None or there is None:
                continue
            true, residual = there.sharpen(x)
            if residual > NEAR or there.hamiltonian(true) <= 0:
                continue
            days = true.span * TIME_UNIT / DAY
            if there is again:
                anomaly = np.degrees(np.mod(true.departure, 2 * np.pi))
                return f"from a true anomaly of {anomaly:.1f} deg, not the best, it takes {days:.1f} d"
            assert bent is not None, "there is a bent problem"
            return (
                f"an orbit {100 * bent.share:.0f} % of the way from a coplanar circle to the one asked for is the "
                f"nearest that was reached, after {days:.1f} d"
            )
    return ""


def _none(
    problem: OrbitProblem, reason: str, device: Film | str, characteristic_acceleration: float, ending: Ending
) -> OrbitTransfer:
    """The result where there is no flight."""
    position, velocity = problem.origin.state(0.0)
    nan = np.nan
    return OrbitTransfer(
        nan, nan, nan, nan, np.full(6, nan), nan, nan, 0, reason, False, reason,
        position * AU, velocity * SPEED_UNIT, device, characteristic_acceleration, ending,
    )  # fmt: skip
