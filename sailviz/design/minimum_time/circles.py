"""Fastest flights between heliocentric orbits, found without a guess, by the indirect method.

The costates are scaled so that H = +1; then they are minus the change of the flight time with the initial state.
Source: thesis, chapter 6, and its paper J.7, of which the text was not readable: the conditions are re-derived from
Pontryagin's principle, checked against Taylor-series integration and direct transcription.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import partial
from typing import NamedTuple

import numpy as np

from sailviz.constants import AU, DAY, GRAVITY_AT_1_AU, RADIUS_SUN
from sailviz.design.minimum_time.arc_transfer import FarSearch, search_by_arcs, transfer_by_arcs
from sailviz.design.minimum_time.boundary_conditions import (
    SPAN,
    BetweenEllipses,
    Ellipse,
    PlanarProblem,
    PolarState,
    ToCircle,
    hamiltonians,
)
from sailviz.design.minimum_time.continuation import farthest, follow
from sailviz.design.minimum_time.effort import Effort, Ending, Progress
from sailviz.design.minimum_time.finishing import Extremal
from sailviz.design.minimum_time.planar_transfer import (
    Transfer,
    exponent,
    fastest_transfer,
    no_transfer,
    sail_from,
    strength,
    time_unit,
)
from sailviz.design.minimum_time.search import Search, search, spiral_time
from sailviz.design.minimum_time.state_costate import OWN, Sail, canonical_sail
from sailviz.propulsion.devices import ELECTRIC_SAILS
from sailviz.propulsion.solar_sail import FILMS, Film
from sailviz.steering.optimal import STRENGTH


class Tier(NamedTuple):
    """Costates screened, flight times looked at in estimates of the flight time, rounds of zooming."""

    costates: int
    spans: float
    zooms: int


FIRST, SECOND, LAST = Tier(128, 1.5, 0), Tier(512, 2.0, 3), Tier(2048, 3.0, 3)
SPANS = 2.0  # the same between ellipses
MORE_THRUST = "take a higher characteristic acceleration"
WIDE = (0.03, 0.1, 0.3, 0.0)  # roundings of an electric sail's switching where the first tier leads nowhere


def circle_to_circle(
    initial_radius: float,
    final_radius: float,
    device: Film | str,
    characteristic_acceleration: float,
    *,
    progress: Progress | None = None,
    time_limit: float | None = None,
    effort: Effort | None = None,
) -> Transfer:
    """Fastest transfer between coplanar circles about the Sun, the angle between departure and arrival free.

    Radii in m, characteristic_acceleration in m/s2 at 1 au, scalars; device : a sail's name or a Film. No guess is
    needed: costates from all around are flown roughly, the best finished to a residual under 1e-9 (as a rule 1e-13)
    until several that were far apart agree; where that leads nowhere, more of them, and continuation in the target
    radius, the film and the acceleration; of an electric sail first along rows of arcs, some of partial thrust
    (`arc_continuation`). The same input gives the same result, but where it was stopped by time_limit,
    s of wall time. progress(share, words) is called now and then. effort : an `Effort` instead of both.
    """
    _check(device, characteristic_acceleration, initial_radius=initial_radius, final_radius=final_radius)
    effort = Effort.of(effort, progress, time_limit)
    proof = _proof_of_none(initial_radius, final_radius, device)
    if proof:
        return no_transfer(device, characteristic_acceleration, initial_radius, proof, effort.impossible())
    sail = sail_from(device, characteristic_acceleration, initial_radius)
    ratio = final_radius / initial_radius
    flight = ToCircle(sail, PolarState(1.0, 0.0, 1.0), ratio)

    def accept(unknowns: np.ndarray) -> bool:
        return _is_fastest(flight, unknowns)

    def result(found: Search, method: str) -> Transfer:
        return fastest_transfer(flight, found, device, characteristic_acceleration, initial_radius, method, effort)

    guess = _flight_time(device, sail, ratio)

    def screened(tier: Tier) -> Search:
        return search(
            flight, tier.spans * guess, tier.costates, ratio > 1, accept,
            effort=effort, words=f"{tier.costates} costates", zooms=tier.zooms, roundings=WIDE if tier.zooms else None,
        )  # fmt: skip

    found, reached = screened(FIRST), Reached()
    if not (found.extremals or effort.stopped) and isinstance(device, str) and device in ELECTRIC_SAILS:
        by_arcs = _by_arcs(flight, partial(_flight_time, device, sail), accept, effort)
        if by_arcs is not None and by_arcs.arrived:
            transfer = transfer_by_arcs(flight, by_arcs, str(device), characteristic_acceleration, initial_radius)
            return replace(transfer, ending=effort.found() if transfer.feasible else effort.not_found())
        if by_arcs is not None and by_arcs.farthest is not None:
            reached.circle = by_arcs.farthest.radius, float(np.sum(by_arcs.farthest.structure.lengths))
    if not (found.extremals or effort.stopped):
        found = screened(SECOND)
    if not (found.extremals or effort.stopped or (ratio > 1 and reached.circle)):
        followed = _by_detours(flight, device, ratio, accept, effort, reached)
        if followed is not None:
            return result(*followed)
        if not effort.stopped:
            found = screened(LAST)
    if found.extremals:
        return result(found, "screening")
    days = LAST.spans * guess * time_unit(initial_radius) / DAY
    reason, ending = _unfound(found, reached, effort, initial_radius, characteristic_acceleration, days)
    return no_transfer(device, characteristic_acceleration, initial_radius, reason, ending)


def planar_orbit_to_orbit(
    initial_orbit: tuple[float, float, float],
    final_orbit: tuple[float, float, float],
    device: Film | str,
    characteristic_acceleration: float,
    *,
    directions: int = 2048,
    progress: Progress | None = None,
    time_limit: float | None = None,
    effort: Effort | None = None,
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
    effort = Effort.of(effort, progress, time_limit)
    sail = sail_from(device, characteristic_acceleration, a)
    ratio = a_f / a
    flight = BetweenEllipses(sail, Ellipse(1 - e * e, e, argument), Ellipse(ratio * (1 - e_f * e_f), e_f, argument_f))

    def accept(unknowns: np.ndarray) -> bool:
        return _is_fastest(flight, unknowns)

    span = SPANS * _flight_time(device, sail, ratio)
    found = search(
        flight, span, directions, ratio > 1, accept,
        effort=effort, words=f"{directions} directions", roundings=WIDE, all_of_them=True,
    )  # fmt: skip
    if found.extremals:
        return fastest_transfer(flight, found, device, characteristic_acceleration, a, "screening", effort)
    nearest = _nearest_screened(found, a)
    reason = f"no transfer was found within {span * time_unit(a) / DAY:.0f} d; {nearest}"
    advice = (MORE_THRUST, f"let it look in more than {directions:,} directions")
    return no_transfer(device, characteristic_acceleration, a, reason, effort.not_found(nearest, *advice))


def _proof_of_none(initial_radius: float, final_radius: float, device: Film | str) -> str:
    """Why there cannot be a transfer between two circles, "" where that is not known."""
    if final_radius < RADIUS_SUN:
        return "the target lies inside the Sun"
    if initial_radius < RADIUS_SUN:
        return "the departure lies inside the Sun"
    if abs(final_radius / initial_radius - 1) < 1e-9:
        return "the two circles are the same"
    if isinstance(device, Film) and device.b2 == 0.0 and device.b3 == 0.0:
        return "a film that reflects nothing pushes along the Sun line only, which leaves r x v as it is"
    return ""


def _check(device: Film | str, characteristic_acceleration: float, **positive: float) -> None:
    for name, value in {"characteristic_acceleration": characteristic_acceleration, **positive}.items():
        if np.ndim(value) or not (np.isfinite(value) and value > 0):
            raise ValueError(f"{name} must be a positive number, got {value!r}")
    canonical_sail(device, characteristic_acceleration)  # ValueError for what is no sail


def _is_fastest(flight: PlanarProblem, unknowns: np.ndarray) -> bool:
    """Whether an extremal of unknowns (k,) is a fastest flight rather than a slowest one: H > 0."""
    return bool(hamiltonians(flight.starts(unknowns[None]), flight.sail)[0] > 0)


def _flight_time(device: Film | str, sail: Sail, ratio: float) -> float:
    """A rough flight time between circles: a slow spiral or, with much thrust, half an ellipse."""
    spiral = spiral_time(device, strength(sail, device), exponent(device), 1.0, ratio)
    return float(np.hypot(spiral, np.pi * (0.5 + 0.5 * ratio) ** 1.5))


def _nearest_screened(found: Search, radius: float) -> str:
    """In words, the true flight of all those flown roughly that came nearest."""
    if not len(found.nearest):
        return "no flight of the true sail was flown"
    days = found.nearest[SPAN] * time_unit(radius) / DAY
    return f"the nearest flight misses the target orbit by {found.nearest_miss:.2g} of its size after {days:.4f} d"


@dataclass(frozen=True)
class Detour:
    """An easier problem that turns into the one asked for: problem_at(0) with its device, problem_at(1). radius_at and
    strength_at : its target, and its acceleration in shares of the one asked for, where true flights on the way say
    something."""

    name: str
    problem_at: Callable[[float], ToCircle]
    device: Film | str
    radius_at: Callable[[float], float] | None = None
    strength_at: Callable[[float], float] | None = None


@dataclass
class Reached:
    """How far true flights came on the way to a target out of reach: (radius, time) of the farthest circle and
    (acceleration, time) of the weakest sail that reached the target, each in units of the transfer, or None."""

    circle: tuple[float, float] | None = None
    sail: tuple[float, float] | None = None

    def add(self, detour: Detour, at: float, time: float) -> None:
        if detour.radius_at is not None:
            radius = detour.radius_at(at)
            if self.circle is None or abs(np.log(radius)) > abs(np.log(self.circle[0])):
                self.circle = radius, time
        elif detour.strength_at is not None:
            self.sail = detour.strength_at(at), time

    def words(self, radius: float, characteristic_acceleration: float) -> tuple[list[str], list[str]]:
        """The nearest true flights and what to change, in words."""
        nearest, advice, unit = [], [], time_unit(radius) / DAY
        if self.circle is not None:
            reached = f"{self.circle[0] * radius / AU:.6g} au"
            nearest.append(f"the nearest circle reached has {reached}, after {self.circle[1] * unit:.4f} d")
            advice.append(f"aim no farther than {reached}")
        if self.sail is not None:
            enough = f"{self.sail[0] * characteristic_acceleration * 1e3:.5g} mm/s²"
            nearest.append(f"{enough} reach the target, after {self.sail[1] * unit:.4f} d")
            advice.append(f"take {enough} or more")
        return nearest, advice or [MORE_THRUST]


def _unfound(
    found: Search,
    reached: Reached,
    effort: Effort,
    initial_radius: float,
    characteristic_acceleration: float,
    days: float,
) -> tuple[str, Ending]:
    """Why there is no answer, and how the search ended. days : within which flights were looked for."""
    told, advice = reached.words(initial_radius, characteristic_acceleration)
    if effort.stopped:
        advice.append(f"give the search more time than the {effort.seconds:.3g} s it had")
    nearest = "; ".join(told or [_nearest_screened(found, initial_radius)])
    where = "before the search was stopped" if effort.stopped else f"within {days:.0f} d"
    return f"no transfer was found {where}; {nearest}", effort.not_found(nearest, *advice)


def _by_arcs(
    flight: ToCircle, flight_time: Callable[[float], float], accept: Callable[[np.ndarray], bool], effort: Effort
) -> FarSearch | None:
    """What was followed along rows of arcs; None where the effort ended before."""
    with effort.stoppable():
        found = search_by_arcs(
            flight,
            flight_time,
            accept,
            lambda share: effort.report(share, "arcs of partial thrust"),
            effort.check,
            effort,
        )
        effort.count("circles solved on the way", found.circles)
        return found
    return None


def _by_detours(
    flight: ToCircle,
    device: Film | str,
    ratio: float,
    accept: Callable[[np.ndarray], bool],
    effort: Effort,
    reached: Reached,
) -> tuple[Search, str] | None:
    """What continuation from easier problems found, and its name; else how far it came is added to what was reached."""
    for detour in _detours(flight, device, ratio):
        base = detour.problem_at(0.0)
        estimate = _flight_time(detour.device, base.sail, base.radius)
        for n, spans, zooms in (FIRST, SECOND):
            easy = search(base, spans * estimate, n, ratio > 1, accept, effort=effort, words=detour.name, zooms=zooms)
            if easy.extremals:
                break
        else:
            continue
        path = follow(detour.problem_at, easy.extremals[0].unknowns, effort=effort, words=detour.name)
        if path.complete and accept(path.unknowns):
            miss = float(np.linalg.norm(flight.misses(path.unknowns[None], 1e-13)))
            extremal = Extremal(path.unknowns, miss)
            return Search((extremal,), easy.starts, easy.converged, miss, path.unknowns), detour.name
        if detour.radius_at is not None or detour.strength_at is not None:
            true = farthest(path, detour.problem_at, _is_fastest, effort)
            if true is not None:
                reached.add(detour, true[0], true[1].time)
        if effort.stopped:
            break
    return None


def _detours(flight: ToCircle, device: Film | str, ratio: float) -> Iterator[Detour]:
    def parameters_at(change: Callable[[float], np.ndarray]) -> Callable[[float], ToCircle]:
        return lambda s: replace(flight, sail=Sail(flight.sail.kind, change(s)))

    def film_at(s: float) -> np.ndarray:
        film = FILMS[device] if isinstance(device, str) else device
        ideal = FILMS["ideal"]
        mixed = Film(
            *(i + s * (f - i) for i, f in zip((ideal.b1, ideal.b2, ideal.b3), (film.b1, film.b2, film.b3), strict=True))
        )
        ac = strength(flight.sail, device) * GRAVITY_AT_1_AU
        return canonical_sail(mixed, ac).parameters

    if not (isinstance(device, str) and device in ELECTRIC_SAILS):
        yield Detour("continuation in the film", parameters_at(film_at), "ideal")

    for share in (0.5, 0.75, 0.25):

        def radius_at(s: float, share: float = share) -> float:
            return float(ratio ** (share + (1 - share) * s))

        def problem_at(s: float, radius_at: Callable[[float], float] = radius_at) -> ToCircle:
            return replace(flight, radius=radius_at(s))

        yield Detour("continuation in the target radius", problem_at, device, radius_at)

    def strength_at(s: float) -> float:
        return float(2.0 ** (1.0 - s))

    def stronger(s: float) -> np.ndarray:
        parameters = flight.sail.parameters.copy()
        parameters[OWN + STRENGTH] *= strength_at(s)
        return parameters

    name = "continuation in the characteristic acceleration"
    yield Detour(name, parameters_at(stronger), device, strength_at=strength_at)
