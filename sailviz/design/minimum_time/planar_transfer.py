"""The result of a planar search: the fastest extremal flown once more, from units of its own into SI."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from sailviz.constants import AU, DAY, MU_SUN, RADIUS_SUN
from sailviz.design.minimum_time import touches
from sailviz.design.minimum_time.boundary_conditions import (
    ANOMALY,
    BetweenEllipses,
    PlanarProblem,
    hamiltonians,
    polar,
)
from sailviz.design.minimum_time.costates import Flight, propagate
from sailviz.design.minimum_time.effort import ANSWERED, UNANSWERED, Effort, Ending
from sailviz.design.minimum_time.finishing import Extremal
from sailviz.design.minimum_time.search import Search
from sailviz.design.minimum_time.singular_arcs import Arc, fly, throttle_of_arcs
from sailviz.design.minimum_time.state_costate import (
    COSTATES,
    LAM_V,
    LRX,
    LRY,
    LVX,
    LVY,
    OWN,
    POSITION,
    VELOCITY,
    Sail,
    X,
    Y,
    canonical_sail,
)
from sailviz.design.minimum_time.touches import Touch
from sailviz.propulsion.devices import ELECTRIC_SAILS
from sailviz.propulsion.solar_sail import Film
from sailviz.steering.optimal import B1, B2, B3, STRENGTH, optimal_pitch


def exponent(device: Film | str) -> float:
    """k of the thrust's r^-k."""
    if not (isinstance(device, str) and device in ELECTRIC_SAILS):
        return 2.0
    return 7 / 6 if device == "electric-sail-original" else 1.0  # (3.33)


def sail_from(device: Film | str, characteristic_acceleration: float, radius: float, coolness: float = 0.0) -> Sail:
    """The Sail of a device (name or Film) in units of mu = 1 and a radius in m; characteristic acceleration in m/s2;
    coolness at 1 au, as of `canonical_sail`."""
    sail = canonical_sail(device, characteristic_acceleration, coolness * (radius / AU) ** 2)
    parameters = sail.parameters.copy()
    parameters[OWN + STRENGTH] *= (radius / AU) ** (2.0 - exponent(device))
    return Sail(sail.kind, parameters)


def strength(sail: Sail, device: Film | str) -> float:
    """Characteristic acceleration in the sail's own units."""
    own = sail.parameters[OWN:]
    total = 1.0 if exponent(device) != 2.0 else own[B1] + own[B2] + own[B3]
    return float(own[STRENGTH] * total)


def time_unit(radius: float) -> float:
    """s, where mu = 1 and the radius in m is 1."""
    return float(np.sqrt(radius**3 / MU_SUN))


@dataclass(frozen=True)
class Trajectory:
    """A transfer in time: time (n,) s; position (n, 3) m and velocity (n, 3) m/s, planar, departure on the x axis of a
    circle; primer (n, 3) unit vectors; pitch (n,) rad in the direction of the primer's side; on (n,); throttle (n,)."""

    time: np.ndarray
    position: np.ndarray
    velocity: np.ndarray
    primer: np.ndarray
    pitch: np.ndarray
    on: np.ndarray
    throttle: np.ndarray


@dataclass(frozen=True)
class Transfer:
    """The fastest flight found. NaN, feasible False and a reason where none was; ending says how the search ended.

    time s; revolutions about the Sun; costates (3,) of radius, radial and transverse speed at departure, with
    mu = r0 = 1 and H = +1; residual: norm of the boundary miss, canonical; hamiltonian_drift: largest |H - 1| on the
    way; solutions: number of distinct extremals found, solution_times (solutions,) s of each; switches (k,) s where
    the thrust goes on or off; closest: distance from the Sun m, the smallest on the way; departure_anomaly and
    arrival_anomaly rad on ellipses; starts: rough flights that were finished, and of them converged.

    Of an electric sail whose fastest flight uses partial voltage: its arcs, and the lowest and highest throttle on
    those that are singular. switches are then where one arc follows another.
    """

    device: Film | str
    characteristic_acceleration: float
    initial_radius: float
    time: float
    revolutions: float
    costates: np.ndarray
    residual: float
    hamiltonian_drift: float
    solutions: int
    solution_times: np.ndarray
    switches: np.ndarray
    closest: float
    starts: int
    converged: int
    method: str
    feasible: bool
    reason: str = ""
    departure_anomaly: float = np.nan
    arrival_anomaly: float = np.nan
    start: np.ndarray | None = None  # (12,) state and costates, canonical
    arcs: tuple[Arc, ...] = ()
    throttle: tuple[float, float] | None = None
    angle_costate: float = 0.0  # of the angle about the Sun, where that was given
    touches: tuple[Touch, ...] = ()  # of a perihelion limit, canonical
    coolness: float = 0.0  # of the film, where its heat is limited: see `canonical_sail`
    ending: Ending = ANSWERED

    @property
    def claim(self) -> str:
        """What is known of the flight time, in one sentence."""
        if not self.feasible:
            return self.reason
        if self.arcs:
            ways = "the only flight" if self.solutions == 1 else f"the fastest of {self.solutions} flights"
            return (
                f"Best found: {self.time / DAY:.4f} d, {ways} of those followed from near circles, {self.starts} in "
                f"all, that arrived; that none is faster is likely, not proven.{self.ending.mark}"
            )
        others = "the only extremal" if self.solutions == 1 else f"the fastest of {self.solutions} extremals"
        return (
            f"Best found: {self.time / DAY:.4f} d, {others} that {self.starts} starts led to "
            f"({self.converged} converged); that none is faster is likely, not proven.{self.ending.mark}"
        )

    def trajectory(self, samples: int = 1000) -> Trajectory:
        """The flight at equal steps of time. ValueError where there is none."""
        if self.start is None:
            raise ValueError(f"there is no flight to show: {self.reason}")
        unit = time_unit(self.initial_radius)
        sail = sail_from(self.device, self.characteristic_acceleration, self.initial_radius, self.coolness)
        span = self.time / unit
        times = np.linspace(0.0, span, samples)
        arcs = [(arc.kind, (arc.end - arc.start) / unit) for arc in self.arcs]
        flown = (
            fly(self.start, span, sail, arcs, times)
            if arcs
            else touches.propagate(self.start, span, sail, self.touches, times)
        )
        rows = flown.rows
        r_hat = rows[:, POSITION] / np.linalg.norm(rows[:, POSITION], axis=1)[:, None]
        primer = rows[:, LAM_V] / np.linalg.norm(rows[:, LAM_V], axis=1)[:, None]
        across = r_hat[:, X] * primer[:, Y] - r_hat[:, Y] * primer[:, X]
        au = np.linalg.norm(rows[:, POSITION], axis=1) * self.initial_radius / AU
        facing = np.minimum(self.coolness * au**2, 1.0) if self.coolness else 1.0
        steered = optimal_pitch(np.arctan2(across, np.sum(r_hat * primer, axis=1)), self.device, facing)
        throttle = steered.on.astype(float)
        if self.arcs:
            throttle = throttle_of_arcs(rows, times * unit, self.arcs, sail)
        return Trajectory(
            np.linspace(0.0, self.time, samples),
            rows[:, POSITION] * self.initial_radius,
            rows[:, VELOCITY] * self.initial_radius / unit,
            primer,
            steered.pitch,
            throttle > 0,
            throttle,
        )


def no_transfer(
    device: Film | str,
    characteristic_acceleration: float,
    radius: float,
    reason: str,
    ending: Ending = UNANSWERED,
) -> Transfer:
    """The result where no flight was found, and why."""
    nothing = np.array([])
    return Transfer(
        device, characteristic_acceleration, radius, np.nan, np.nan, np.full(3, np.nan), np.nan, np.nan, 0, nothing,
        nothing, np.nan, 0, 0, "", False, reason, ending=ending,
    )  # fmt: skip


def fastest_transfer(
    flight: PlanarProblem,
    found: Search,
    device: Film | str,
    characteristic_acceleration: float,
    radius: float,
    method: str,
    effort: Effort,
) -> Transfer:
    """The result in SI of the fastest extremal that keeps out of the Sun. radius : m, the unit of the flight."""
    flown = [_flown(flight, extremal) for extremal in found.extremals]
    flown = [one for one in flown if one.closest * radius > RADIUS_SUN]
    if not flown:
        reason = "every extremal found passes through the Sun"
        return no_transfer(device, characteristic_acceleration, radius, reason, effort.not_found())
    best, unit = flown[0], time_unit(radius)
    misses = flight.misses(best.extremal.unknowns[None], 1e-13)[0, :-1]  # without that of the costates' length
    planar, departure, arrival = best.start[[LRX, LVX, LVY]], np.nan, np.nan
    if isinstance(flight, BetweenEllipses):
        planar = _along_and_across(best.start)
        departure = best.extremal.unknowns[ANOMALY]
        arrival = departure + best.swept + flight.initial.argument - flight.final.argument
    return Transfer(
        device=device,
        characteristic_acceleration=float(characteristic_acceleration),
        initial_radius=float(radius),
        time=best.extremal.time * unit,
        revolutions=best.swept / (2 * np.pi),
        costates=planar,
        residual=float(np.linalg.norm(misses)),
        hamiltonian_drift=best.path.drift,
        solutions=len(flown),
        solution_times=np.array([one.extremal.time * unit for one in flown]),
        switches=best.path.switches * unit,
        closest=float(best.closest * radius),
        starts=found.starts,
        converged=found.converged,
        method=method,
        feasible=True,
        departure_anomaly=float(departure % (2 * np.pi)),
        arrival_anomaly=float(arrival % (2 * np.pi)),
        start=best.start,
        ending=effort.found(),
    )


class _Flown(NamedTuple):
    """An extremal flown once more: start (12,) with H = +1, the path, the angle swept rad and the smallest radius."""

    extremal: Extremal
    start: np.ndarray
    path: Flight
    swept: float
    closest: float


def _flown(flight: PlanarProblem, extremal: Extremal) -> _Flown:
    sail, span = flight.sail, extremal.time
    start = flight.starts(extremal.unknowns[None])
    start[:, COSTATES] /= hamiltonians(start, sail)[0]
    path = propagate(start[0], span, sail, times=np.linspace(0.0, span, int(40 * span) + 200))
    r, azimuth, _, _ = polar(path.rows)
    angle = np.unwrap(azimuth)
    return _Flown(extremal, start[0], path, float(angle[-1] - angle[0]), r.min())


def _along_and_across(start: np.ndarray) -> np.ndarray:
    """Costates (3,) of radius, radial and transverse speed; those of a start (12,) are along the x and y axes."""
    along = start[[X, Y]] / np.hypot(start[X], start[Y])
    turn = np.array([along, [-along[1], along[0]]])
    lam_r, lam_v = turn @ start[[LRX, LRY]], turn @ start[[LVX, LVY]]
    return np.array([lam_r[0], *lam_v])
