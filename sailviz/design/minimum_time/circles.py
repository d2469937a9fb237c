"""Fastest flights between heliocentric orbits, found without a guess, by the indirect method.

The costates are scaled so that H = +1; then they are minus the change of the flight time with the initial state.
Source: thesis, chapter 6, and its paper J.7, of which the text was not readable: the conditions are re-derived from
Pontryagin's principle, checked against Taylor-series integration and direct transcription.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from sailviz.constants import AU, DAY, GRAVITY_AT_1_AU, MU_SUN, RADIUS_SUN
from sailviz.design.minimum_time import costates as state_costate
from sailviz.design.minimum_time.boundary_conditions import BetweenEllipses, ToCircle, hamiltonians, polar
from sailviz.design.minimum_time.costates import Sail, canonical_sail
from sailviz.design.minimum_time.orbits import orbit_to_orbit  # noqa: F401
from sailviz.design.minimum_time.planet_rendezvous import rendezvous  # noqa: F401  part of this module's face
from sailviz.design.minimum_time.search import Extremal, Search, follow, search, spiral_time
from sailviz.propulsion.devices import ELECTRIC_SAILS
from sailviz.propulsion.solar_sail import FILMS, Film
from sailviz.steering.optimal import optimal_pitch

DIRECTIONS = (512, 2048)  # screened at first, and where those lead nowhere
SPANS = (2.0, 3.0)  # flight times looked at, in estimates of the flight time

Progress = Callable[[float, str], None]


@dataclass(frozen=True)
class Trajectory:
    """A transfer in time: time (n,) s; position (n, 3) m and velocity (n, 3) m/s, planar, departure on the x axis of a
    circle; primer (n, 3) unit vectors; pitch (n,) rad in the direction of the primer's side; on (n,)."""

    time: np.ndarray
    position: np.ndarray
    velocity: np.ndarray
    primer: np.ndarray
    pitch: np.ndarray
    on: np.ndarray


@dataclass(frozen=True)
class Transfer:
    """The fastest flight found. NaN, feasible False and a reason where none was.

    time s; revolutions about the Sun; costates (3,) of radius, radial and transverse speed at departure, with
    mu = r0 = 1 and H = +1; residual: norm of the boundary miss, canonical; hamiltonian_drift: largest |H - 1| on the
    way; solutions: number of distinct extremals found, solution_times (solutions,) s of each; switches (k,) s where
    the thrust goes on or off; closest: distance from the Sun m, the smallest on the way; departure_anomaly and
    arrival_anomaly rad on ellipses; starts: rough flights that were finished, and of them converged.
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

    @property
    def claim(self) -> str:
        """What is known of the flight time, in one sentence."""
        if not self.feasible:
            return self.reason
        others = "the only extremal" if self.solutions == 1 else f"the fastest of {self.solutions} extremals"
        return (
            f"Best found: {self.time / DAY:.4f} d, {others} that {self.starts} starts led to "
            f"({self.converged} converged); that none is faster is likely, not proven."
        )

    def trajectory(self, samples: int = 1000) -> Trajectory:
        """The flight at equal steps of time."""
        if not self.feasible:
            raise ValueError(f"there is no flight to show: {self.reason}")
        unit = _time_unit(self.initial_radius)
        sail = sail_from(self.device, self.characteristic_acceleration, self.initial_radius)
        span = self.time / unit
        rows = state_costate.propagate(self.start, span, sail, times=np.linspace(0.0, span, samples)).rows
        r_hat = rows[:, :3] / np.linalg.norm(rows[:, :3], axis=1)[:, None]
        primer = rows[:, 9:] / np.linalg.norm(rows[:, 9:], axis=1)[:, None]
        across = r_hat[:, 0] * primer[:, 1] - r_hat[:, 1] * primer[:, 0]
        steered = optimal_pitch(np.arctan2(across, np.sum(r_hat * primer, axis=1)), self.device)
        return Trajectory(
            np.linspace(0.0, self.time, samples),
            rows[:, :3] * self.initial_radius,
            rows[:, 3:6] * self.initial_radius / unit,
            primer,
            steered.pitch,
            steered.on,
        )


def _exponent(device) -> float:
    """k of the thrust's r^-k."""
    if not (isinstance(device, str) and device in ELECTRIC_SAILS):
        return 2.0
    return 7 / 6 if device == "electric-sail-original" else 1.0  # (3.33)


def sail_from(device, characteristic_acceleration, radius) -> Sail:
    """The Sail in units of mu = 1 and a radius in m; m/s2 at 1 au."""
    sail = canonical_sail(device, characteristic_acceleration)
    parameters = sail.parameters.copy()
    parameters[1] *= (radius / AU) ** (2.0 - _exponent(device))
    return Sail(sail.kind, parameters)


def _strength(sail, device) -> float:
    """Characteristic acceleration in the sail's own units."""
    total = 1.0 if _exponent(device) != 2.0 else sum(sail.parameters[2:5])
    return float(sail.parameters[1] * total)


def _check(device, characteristic_acceleration, **positive):
    for name, value in {"characteristic_acceleration": characteristic_acceleration, **positive}.items():
        if not (np.isscalar(value) and np.isfinite(value) and value > 0):
            raise ValueError(f"{name} must be a positive number, got {value!r}")
    canonical_sail(device, characteristic_acceleration)  # ValueError for what is no sail


def circle_to_circle(
    initial_radius,
    final_radius,
    device: Film | str,
    characteristic_acceleration,
    *,
    progress: Progress | None = None,
) -> Transfer:
    """Fastest transfer between coplanar circles about the Sun, the angle between departure and arrival free.

    Radii in m, characteristic_acceleration in m/s2 at 1 au, scalars; device : a sail's name or a Film. No guess is
    needed: hundreds of costates are flown roughly, the best finished to a residual under 1e-9 (as a rule 1e-13);
    where that leads nowhere, continuation in the target radius, the film and the acceleration. The same input gives
    the same result. progress(share, words) is called now and then.
    """
    _check(device, characteristic_acceleration, initial_radius=initial_radius, final_radius=final_radius)
    report = progress or (lambda share, words: None)
    sail = sail_from(device, characteristic_acceleration, initial_radius)
    ratio = final_radius / initial_radius
    if abs(ratio - 1) < 1e-9:
        return _infeasible(device, characteristic_acceleration, initial_radius, "the two circles are the same")
    if final_radius < RADIUS_SUN:
        return _infeasible(device, characteristic_acceleration, initial_radius, "the target lies inside the Sun")

    flight = ToCircle(sail, (1.0, 0.0, 1.0), ratio)

    def accept(unknowns):
        return hamiltonians(flight.starts(unknowns[None]), sail.kind, sail.parameters)[0] > 0

    def result(found, method):
        return _transfer(flight, found, device, characteristic_acceleration, initial_radius, method)

    guess = _flight_time(device, sail, ratio)
    for n, spans in zip(DIRECTIONS, SPANS, strict=True):
        found = search(
            flight, spans * guess, n, ratio > 1, accept, progress=lambda x, n=n: report(x, f"{n} directions")
        )
        if found.extremals:
            return result(found, "screening")

    reached, nearest = 1.0, None  # the circle that continuation came to, and its flight
    for name, problem_at, radius_at, base_device in _detours(flight, device, ratio):
        base = problem_at(0.0)
        base_guess = _flight_time(base_device, base.sail, base.radius)
        easy = search(base, SPANS[0] * base_guess, DIRECTIONS[0], ratio > 1, accept)
        if not easy.extremals:
            continue
        path = follow(problem_at, easy.extremals[0].unknowns, progress=lambda x, name=name: report(x, name))
        if path.complete and accept(path.unknowns):
            miss = float(np.linalg.norm(flight.misses(path.unknowns[None], 1e-13)))
            extremal = Extremal(path.unknowns, miss)
            return result(Search((extremal,), easy.starts, easy.converged, miss, path.unknowns), name)
        if abs(np.log(radius_at(path.parameter))) > abs(np.log(reached)):
            reached, nearest = radius_at(path.parameter), path.unknowns
    reason = f"no transfer was found within {SPANS[-1] * guess * _time_unit(initial_radius) / DAY:.0f} d; "
    if nearest is not None:
        days = nearest[3] * _time_unit(initial_radius) / DAY
        reason += f"the nearest circle reached has {reached * initial_radius / AU:.6g} au, after {days:.4f} d"
    else:
        days = found.nearest[3] * _time_unit(initial_radius) / DAY
        reason += (
            f"the nearest flight misses the target orbit by {found.nearest_miss:.2g} of its size after {days:.4f} d"
        )
    return _infeasible(device, characteristic_acceleration, initial_radius, reason)


def planar_orbit_to_orbit(
    initial_orbit,
    final_orbit,
    device: Film | str,
    characteristic_acceleration,
    *,
    directions: int = 2048,
    progress: Progress | None = None,
) -> Transfer:
    """Fastest transfer between coplanar ellipses about the Sun, both anomalies free.

    initial_orbit, final_orbit : (semi-major axis m, eccentricity, argument of periapsis rad). Otherwise as
    `circle_to_circle`, without continuation; r0 of the canonical costates is the initial semi-major axis. Where one
    orbit is a circle its anomaly means nothing: take `circle_to_circle` for two of them.
    """
    (a, e, argument), (a_f, e_f, argument_f) = initial_orbit, final_orbit
    _check(device, characteristic_acceleration, initial_semi_major_axis=a, final_semi_major_axis=a_f)
    if not (0 <= e < 1 and 0 <= e_f < 1):
        raise ValueError(f"eccentricities must lie in [0, 1), got {e!r} and {e_f!r}")
    report = progress or (lambda share, words: None)
    sail = sail_from(device, characteristic_acceleration, a)
    ratio = a_f / a
    flight = BetweenEllipses(sail, (1 - e * e, e, argument), (ratio * (1 - e_f * e_f), e_f, argument_f))

    def accept(unknowns):
        return hamiltonians(flight.starts(unknowns[None]), sail.kind, sail.parameters)[0] > 0

    span = SPANS[0] * _flight_time(device, sail, ratio)
    found = search(
        flight, span, directions, ratio > 1, accept, progress=lambda x: report(x, f"{directions} directions")
    )
    if found.extremals:
        return _transfer(flight, found, device, characteristic_acceleration, a, "screening")
    days = found.nearest[3] * _time_unit(a) / DAY
    reason = (
        f"no transfer was found within {span * _time_unit(a) / DAY:.0f} d; the nearest flight misses the target orbit "
        f"by {found.nearest_miss:.2g} of its size after {days:.4f} d"
    )
    return _infeasible(device, characteristic_acceleration, a, reason)


def _time_unit(radius) -> float:
    """s, where mu = 1 and the radius in m is 1."""
    return float(np.sqrt(radius**3 / MU_SUN))


def _flight_time(device, sail, ratio) -> float:
    """A rough flight time between circles: a slow spiral or, with much thrust, half an ellipse."""
    spiral = spiral_time(device, _strength(sail, device), _exponent(device), 1.0, ratio)
    return float(np.hypot(spiral, np.pi * (0.5 + 0.5 * ratio) ** 1.5))


def _detours(flight, device, ratio):
    """(name, problem at s, target radius at s, device at 0) of problems that are easier at s = 0 and the given one at
    1."""

    def parameters_at(change):
        return lambda s: replace(flight, sail=Sail(flight.sail.kind, change(s)))

    def film_at(s):
        film = FILMS[device] if isinstance(device, str) else device
        ideal = FILMS["ideal"]
        mixed = Film(
            *(i + s * (f - i) for i, f in zip((ideal.b1, ideal.b2, ideal.b3), (film.b1, film.b2, film.b3), strict=True))
        )
        ac = _strength(flight.sail, device) * GRAVITY_AT_1_AU
        return canonical_sail(mixed, ac).parameters

    if not (isinstance(device, str) and device in ELECTRIC_SAILS):
        yield "continuation in the film", parameters_at(film_at), lambda s: 1.0, "ideal"

    for share in (0.5, 0.75, 0.25):

        def radius_at(s, share=share):
            return float(ratio ** (share + (1 - share) * s))

        yield (
            "continuation in the target radius",
            lambda s, radius_at=radius_at: replace(flight, radius=radius_at(s)),
            radius_at,
            device,
        )

    def stronger(s):
        parameters = flight.sail.parameters.copy()
        parameters[1] *= 2.0 ** (1.0 - s)
        return parameters

    yield "continuation in the characteristic acceleration", parameters_at(stronger), lambda s: 1.0, device


def _infeasible(device, characteristic_acceleration, radius, reason) -> Transfer:
    nothing = np.array([])
    return Transfer(
        device, characteristic_acceleration, radius, np.nan, np.nan, np.full(3, np.nan), np.nan, np.nan, 0, nothing,
        nothing, np.nan, 0, 0, "", False, reason,
    )  # fmt: skip


def _transfer(flight, found, device, characteristic_acceleration, radius, method) -> Transfer:
    """The result in SI of the fastest extremal that keeps out of the Sun."""
    unit, sail = _time_unit(radius), flight.sail
    flown = []
    for extremal in found.extremals:
        start = flight.starts(extremal.unknowns[None])
        start[:, 6:] /= hamiltonians(start, sail.kind, sail.parameters)[0]
        span = extremal.time
        times = np.linspace(0.0, span, int(40 * span) + 200)
        path = state_costate.propagate(start[0], span, sail, times=times)
        r, angle, _, _ = polar(path.rows)
        if r.min() * radius > RADIUS_SUN:
            flown.append((extremal, start, path, np.unwrap(angle), r.min()))
    if not flown:
        reason = "every extremal found passes through the Sun"
        return _infeasible(device, characteristic_acceleration, radius, reason)
    extremal, start, path, angle, closest = flown[0]
    misses = flight.misses(extremal.unknowns[None], 1e-13)[0, :-1]
    planar = start[0, [6, 9, 10]]
    anomalies = ()
    if isinstance(flight, BetweenEllipses):
        # radial and transverse components at departure; the angle is that of the x axis
        r_hat = start[0, :2] / np.hypot(*start[0, :2])
        turn = np.array([[r_hat[0], r_hat[1]], [-r_hat[1], r_hat[0]]])
        planar = np.array([(turn @ start[0, 6:8])[0], *(turn @ start[0, 9:11])])
        departure = extremal.unknowns[4]
        arrival = departure + angle[-1] - angle[0] + flight.initial[2] - flight.final[2]
        anomalies = (float(departure % (2 * np.pi)), float(arrival % (2 * np.pi)))
    return Transfer(
        device,
        float(characteristic_acceleration),
        float(radius),
        extremal.time * unit,
        float(angle[-1] - angle[0]) / (2 * np.pi),
        planar,
        float(np.linalg.norm(misses)),
        path.drift,
        len(flown),
        np.array([f[0].time * unit for f in flown]),
        path.switches * unit,
        float(closest * radius),
        found.starts,
        found.converged,
        method,
        True,
        "",
        *(anomalies or (np.nan, np.nan)),
        start[0],
    )
