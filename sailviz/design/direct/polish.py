"""A direct flight from a circle handed on to the indirect method, which gives it all its digits.

Where the sail switches, its arcs and the direction of its costates start a search by arcs; where it does not, shooting,
with a jump of the costates where the flight touches a perihelion limit. The costates are those of the finite problem,
minus the change of the flight time with the start's state, or those fitted to the path.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from sailviz import frames
from sailviz.constants import AU
from sailviz.design.direct.costate_fit import fit
from sailviz.design.direct.ends import End, FromState, ToCircle, ToEscape, ToRadius, ToState
from sailviz.design.direct.frames_of_state import Planar
from sailviz.design.direct.search import DirectFlight
from sailviz.design.minimum_time import boundary_conditions as conditions
from sailviz.design.minimum_time import shooting
from sailviz.design.minimum_time.arc_structures import Structure, right
from sailviz.design.minimum_time.arc_transfer import FarSearch, transfer_by_arcs
from sailviz.design.minimum_time.effort import Effort
from sailviz.design.minimum_time.planar_ends import AtEnergy, AtRadius, AtState
from sailviz.design.minimum_time.planar_transfer import Transfer, fastest_transfer, sail_from
from sailviz.design.minimum_time.search import Extremal, Search
from sailviz.design.minimum_time.state_costate import TIME_UNIT
from sailviz.design.minimum_time.to_ends import Counts, Keeping, flight_near
from sailviz.propulsion.film_ageing import coolness

SOLVED = 1e-9  # largest miss of a solution
TOUCHES = 1e-3  # relative, within which the smallest distance of a flight is that of its perihelion limit
SAME = 1e-3  # relative flight time by which another flight would have been found


def structure_of(flight: DirectFlight) -> tuple[str, np.ndarray, np.ndarray]:
    """What a search by arcs begins with: the kinds of arcs, T, C and S, their durations (k,), and the direction (3,) of
    the costates of radius, radial and transverse speed; in units of mu = 1 and the distance of departure. ValueError
    where the flight is not between circles, or has no arcs."""
    radius, _ = _circles(flight)
    if not flight.arcs:
        raise ValueError("the flight has no arcs")
    lengths = np.array([arc.duration for arc in flight.arcs]) / radius**1.5
    return "".join(arc.kind for arc in flight.arcs), lengths, next(_directions(flight, radius))


def polished(flight: DirectFlight, effort: Effort | None = None) -> Transfer | None:
    """The flight from a circle that the indirect method makes of a direct one, within the same limits of its perihelion
    and of its film's heat; None where it leads elsewhere, or nowhere. ValueError where the flight does not begin on a
    circle or is held to a cone or a turn rate, of which the indirect method knows nothing."""
    q = flight.question
    if flight.limits.cone is not None or flight.limits.turn_rate is not None:
        raise ValueError("costates of a flight that is held to a cone or a turn rate are not known")
    if q is None or not isinstance(q.axes, Planar) or not isinstance(q.start, FromState):
        raise ValueError("only a flight in a plane, from a given state, is handed on")
    if isinstance(q.end, ToCircle) and q.end.angle is None and not flight.limits.any:
        found = _between_circles(flight)
    else:
        found = _to_end(flight, effort)
    if found is None:
        return None
    return replace(
        found,
        solutions=len(flight.solutions),
        solution_times=np.array([found.time, *flight.solutions[1:]]),
        starts=flight.guesses,
        converged=flight.converged,
        ending=flight.ending,
    )


def _same(found: Transfer | None, flight: DirectFlight) -> bool:
    return found is not None and found.feasible and abs(found.time / flight.time - 1) < SAME


def _between_circles(flight: DirectFlight) -> Transfer | None:
    radius, target = _circles(flight)
    sail = sail_from(flight.device, flight.characteristic_acceleration, radius * AU)
    problem = conditions.ToCircle(sail, conditions.PolarState(1.0, 0.0, 1.0), target / radius)
    for direction in _directions(flight, radius):
        found = _by_arcs(flight, problem, direction, radius) if flight.arcs else None
        found = found or _by_shooting(flight, problem, direction, radius)
        if _same(found, flight):
            return found
    return None


def _to_end(flight: DirectFlight, effort: Effort | None) -> Transfer | None:
    """By shooting, to whatever end, within limits that the indirect method keeps to as well."""
    q = flight.question
    assert q is not None, "polished has seen that there is one"
    radius = _radius(flight)
    end, angle = _end_of(q.end, radius)
    limits, path = flight.limits, flight.flown
    cool = 0.0 if limits.hottest is None else coolness(limits.hottest, str(flight.device))
    keeping = Keeping(0.0 if limits.closest is None else limits.closest / radius, cool, angle)
    touching: float | None = None
    if limits.closest is not None and flight.closest < limits.closest * AU * (1 + TOUCHES):
        assert path is not None, "a flight was flown"
        nearest = int(np.argmin(np.linalg.norm(path.position, axis=1)))
        touching = float(path.time[nearest] / TIME_UNIT / radius**1.5)
    counts = Counts(1, 1, np.array([flight.time]), "direct method, then shooting")
    for direction in _directions(flight, radius):
        guess = np.append(direction, flight.time / TIME_UNIT / radius**1.5)
        if angle is not None:
            own = flight.costates[[0, 2, 3]] / np.array([radius**0.5, radius**2, radius**2])
            guess = np.append(guess, flight.costates[1] / radius**1.5 / np.linalg.norm(own))
        found = flight_near(
            radius * AU, end, flight.device, flight.characteristic_acceleration, keeping, guess, counts,
            touching_at=touching, effort=effort,
        )  # fmt: skip
        if _same(found, flight):
            return found
    return None


def _end_of(end: End, radius: float) -> tuple[AtState | AtRadius | AtEnergy, float | None]:
    """A direct problem's end in units of mu = 1 and a radius, au, and the angle swept, rad, where that is given.
    ValueError for an end that is not of the plane."""
    pace = radius**0.5
    if isinstance(end, ToCircle):
        return AtState.circle(end.radius / radius), end.angle
    if isinstance(end, ToState):
        return AtState(end.radius / radius, end.radial * pace, end.transverse * pace), end.angle
    if isinstance(end, ToRadius):
        return AtRadius(end.radius / radius), end.angle
    if isinstance(end, ToEscape):
        return AtEnergy(0.5 * (end.excess * pace) ** 2), end.angle
    raise ValueError("only a flight in a plane is handed on")


def _radius(flight: DirectFlight) -> float:
    """Of the start, au."""
    q = flight.question
    if q is None or not isinstance(q.start, FromState):
        raise ValueError("only a flight from a given state is handed on")
    return q.start.state_given[0]


def _circles(flight: DirectFlight) -> tuple[float, float]:
    """Radii of start and end, au."""
    q = flight.question
    if q is None or not isinstance(q.end, ToCircle) or q.end.angle is not None:
        raise ValueError("the flight is not from circle to circle")
    return _radius(flight), q.end.radius


def _directions(flight: DirectFlight, radius: float) -> Iterator[np.ndarray]:
    """Directions (3,) of the costates where a search begins."""
    yield _scaled(flight.costates[[0, 2, 3]], radius)
    table, path = flight.table, flight.flown
    assert table is not None, "a flight has a table"
    assert path is not None, "a flight was flown"
    odd = len(path.time) - 1 + len(path.time) % 2
    time, place, speed = path.time[:odd], path.position[:odd], path.velocity[:odd]
    pitch, clock, throttle = (np.interp(time, table.time, x) for x in (table.pitch, table.clock, table.throttle))
    local = np.column_stack([np.cos(pitch), np.sin(pitch) * np.sin(clock), np.sin(pitch) * np.cos(clock)])
    normal = frames.from_frame(frames.rtn(place, speed), local)
    lam = fit(time, place, normal, throttle, flight.device, flight.characteristic_acceleration).costates
    yield _scaled(lam[[0, 3, 4]], radius)


def _scaled(lam: np.ndarray, radius: float) -> np.ndarray:
    """Costates of radius and speeds in units of one au as a direction in those of a radius."""
    own = lam / np.array([radius**0.5, radius**2, radius**2])
    return np.asarray(own / np.linalg.norm(own))


def _by_arcs(
    flight: DirectFlight, problem: conditions.ToCircle, direction: np.ndarray, radius: float
) -> Transfer | None:
    lengths = np.array([arc.duration for arc in flight.arcs]) / radius**1.5
    kinds = "".join(arc.kind for arc in flight.arcs)
    found = right(problem, Structure(kinds, np.concatenate([direction, lengths])))
    if found is None:
        return None
    search = FarSearch((found,), None, 1, 1)
    device = str(flight.device)
    solved = transfer_by_arcs(problem, search, device, flight.characteristic_acceleration, radius * AU)
    return replace(solved, method="direct method, then arcs")


def _by_shooting(
    flight: DirectFlight, problem: conditions.ToCircle, direction: np.ndarray, radius: float
) -> Transfer | None:
    start = np.append(direction, flight.time / TIME_UNIT / radius**1.5)
    found = shooting.solve(lambda batch: problem.misses(batch, 1e-13), start)
    if not found.residual < SOLVED:
        return None
    if not conditions.hamiltonians(problem.starts(found.unknowns[None]), problem.sail)[0] > 0:
        return None
    search = Search((Extremal(found.unknowns, found.residual),), 1, 1, found.residual, found.unknowns)
    a_c = flight.characteristic_acceleration
    method = "direct method, then shooting"
    return fastest_transfer(problem, search, flight.device, a_c, radius * AU, method, Effort())
