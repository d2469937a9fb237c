"""Fastest flights between heliocentric orbits, found without a guess, by the indirect method.

The costates are scaled so that H = +1; then they are minus the change of the flight time with the initial state.
Source: thesis, chapter 6, and its paper J.7, of which the text was not readable: the conditions are re-derived from
Pontryagin's principle, checked against Taylor-series integration and direct transcription.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial

import numpy as np

from sailviz.constants import AU, DAY, GRAVITY_AT_1_AU, RADIUS_SUN
from sailviz.design.minimum_time.boundary_conditions import (
    SPAN,
    BetweenEllipses,
    Ellipse,
    PlanarProblem,
    PolarState,
    ToCircle,
    hamiltonians,
)
from sailviz.design.minimum_time.planar_transfer import (
    Transfer,
    exponent,
    fastest_transfer,
    no_transfer,
    sail_from,
    strength,
    time_unit,
)
from sailviz.design.minimum_time.search import Extremal, Search, follow, search, spiral_time
from sailviz.design.minimum_time.state_costate import OWN, Sail, canonical_sail
from sailviz.propulsion.devices import ELECTRIC_SAILS
from sailviz.propulsion.solar_sail import FILMS, Film
from sailviz.steering.optimal import STRENGTH

DIRECTIONS = (512, 2048)  # screened at first, and where those lead nowhere
SPANS = (2.0, 3.0)  # flight times looked at, in estimates of the flight time

Progress = Callable[[float, str], None]


def circle_to_circle(
    initial_radius: float,
    final_radius: float,
    device: Film | str,
    characteristic_acceleration: float,
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
        return no_transfer(device, characteristic_acceleration, initial_radius, "the two circles are the same")
    if final_radius < RADIUS_SUN:
        return no_transfer(device, characteristic_acceleration, initial_radius, "the target lies inside the Sun")

    flight = ToCircle(sail, PolarState(1.0, 0.0, 1.0), ratio)

    def accept(unknowns: np.ndarray) -> bool:
        return _is_fastest(flight, unknowns)

    def result(found: Search, method: str) -> Transfer:
        return fastest_transfer(flight, found, device, characteristic_acceleration, initial_radius, method)

    guess = _flight_time(device, sail, ratio)
    for n, spans in zip(DIRECTIONS, SPANS, strict=True):
        found = search(flight, spans * guess, n, ratio > 1, accept, progress=partial(_share, report, f"{n} directions"))
        if found.extremals:
            return result(found, "screening")

    reached, nearest = 1.0, None  # the circle that continuation came to, and its flight
    for name, problem_at, radius_at, base_device in _detours(flight, device, ratio):
        base = problem_at(0.0)
        base_guess = _flight_time(base_device, base.sail, base.radius)
        easy = search(base, SPANS[0] * base_guess, DIRECTIONS[0], ratio > 1, accept)
        if not easy.extremals:
            continue
        path = follow(problem_at, easy.extremals[0].unknowns, progress=partial(_share, report, name))
        if path.complete and accept(path.unknowns):
            miss = float(np.linalg.norm(flight.misses(path.unknowns[None], 1e-13)))
            extremal = Extremal(path.unknowns, miss)
            return result(Search((extremal,), easy.starts, easy.converged, miss, path.unknowns), name)
        if abs(np.log(radius_at(path.parameter))) > abs(np.log(reached)):
            reached, nearest = radius_at(path.parameter), path.unknowns
    reason = f"no transfer was found within {SPANS[-1] * guess * time_unit(initial_radius) / DAY:.0f} d; "
    if nearest is not None:
        days = nearest[SPAN] * time_unit(initial_radius) / DAY
        reason += f"the nearest circle reached has {reached * initial_radius / AU:.6g} au, after {days:.4f} d"
    else:
        days = found.nearest[SPAN] * time_unit(initial_radius) / DAY
        reason += (
            f"the nearest flight misses the target orbit by {found.nearest_miss:.2g} of its size after {days:.4f} d"
        )
    return no_transfer(device, characteristic_acceleration, initial_radius, reason)


def planar_orbit_to_orbit(
    initial_orbit: tuple[float, float, float],
    final_orbit: tuple[float, float, float],
    device: Film | str,
    characteristic_acceleration: float,
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
    flight = BetweenEllipses(sail, Ellipse(1 - e * e, e, argument), Ellipse(ratio * (1 - e_f * e_f), e_f, argument_f))

    def accept(unknowns: np.ndarray) -> bool:
        return _is_fastest(flight, unknowns)

    span = SPANS[0] * _flight_time(device, sail, ratio)
    found = search(
        flight, span, directions, ratio > 1, accept, progress=partial(_share, report, f"{directions} directions")
    )
    if found.extremals:
        return fastest_transfer(flight, found, device, characteristic_acceleration, a, "screening")
    days = found.nearest[SPAN] * time_unit(a) / DAY
    reason = (
        f"no transfer was found within {span * time_unit(a) / DAY:.0f} d; the nearest flight misses the target orbit "
        f"by {found.nearest_miss:.2g} of its size after {days:.4f} d"
    )
    return no_transfer(device, characteristic_acceleration, a, reason)


def _check(device: Film | str, characteristic_acceleration: float, **positive: float) -> None:
    for name, value in {"characteristic_acceleration": characteristic_acceleration, **positive}.items():
        if np.ndim(value) or not (np.isfinite(value) and value > 0):
            raise ValueError(f"{name} must be a positive number, got {value!r}")
    canonical_sail(device, characteristic_acceleration)  # ValueError for what is no sail


def _share(report: Progress, words: str, share: float) -> None:
    report(share, words)


def _is_fastest(flight: PlanarProblem, unknowns: np.ndarray) -> bool:
    """Whether an extremal of unknowns (k,) is a fastest flight rather than a slowest one: H > 0."""
    return bool(hamiltonians(flight.starts(unknowns[None]), flight.sail)[0] > 0)


def _flight_time(device: Film | str, sail: Sail, ratio: float) -> float:
    """A rough flight time between circles: a slow spiral or, with much thrust, half an ellipse."""
    spiral = spiral_time(device, strength(sail, device), exponent(device), 1.0, ratio)
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
        ac = strength(flight.sail, device) * GRAVITY_AT_1_AU
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
        parameters[OWN + STRENGTH] *= 2.0 ** (1.0 - s)
        return parameters

    yield "continuation in the characteristic acceleration", parameters_at(stronger), lambda s: 1.0, device
