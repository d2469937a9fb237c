"""A direct flight between circles handed on to the indirect method, which gives it all its digits.

Where the sail switches, its arcs and the direction of its costates start a search by arcs; where it does not, shooting.
The costates are those of the finite problem, minus the change of the flight time with the start's state, or those
fitted to the path.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from sailviz import frames
from sailviz.constants import AU
from sailviz.design.direct.costate_fit import fit
from sailviz.design.direct.ends import FromState, ToCircle
from sailviz.design.direct.search import DirectFlight
from sailviz.design.minimum_time import boundary_conditions as conditions
from sailviz.design.minimum_time import shooting
from sailviz.design.minimum_time.arc_structures import Structure, right
from sailviz.design.minimum_time.arc_transfer import FarSearch, transfer_by_arcs
from sailviz.design.minimum_time.effort import Effort
from sailviz.design.minimum_time.planar_transfer import Transfer, fastest_transfer, sail_from
from sailviz.design.minimum_time.search import Extremal, Search
from sailviz.design.minimum_time.state_costate import TIME_UNIT

SOLVED = 1e-9  # largest miss of a solution
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


def polished(flight: DirectFlight) -> Transfer | None:
    """The flight between circles that the indirect method makes of a direct one; None where it leads elsewhere, or
    nowhere. ValueError where the flight is not between circles, or keeps to limits."""
    radius, target = _circles(flight)
    if flight.limits.any:
        raise ValueError("costates of a flight that keeps to limits are not known")
    sail = sail_from(flight.device, flight.characteristic_acceleration, radius * AU)
    problem = conditions.ToCircle(sail, conditions.PolarState(1.0, 0.0, 1.0), target / radius)
    for direction in _directions(flight, radius):
        found = _by_arcs(flight, problem, direction, radius) if flight.arcs else None
        found = found or _by_shooting(flight, problem, direction, radius)
        if found is not None and found.feasible and abs(found.time / flight.time - 1) < SAME:
            return replace(
                found,
                solutions=len(flight.solutions),
                solution_times=np.array([found.time, *flight.solutions[1:]]),
                starts=flight.guesses,
                converged=flight.converged,
                ending=flight.ending,
            )
    return None


def _circles(flight: DirectFlight) -> tuple[float, float]:
    """Radii of start and end, au."""
    q = flight.question
    if q is None or not isinstance(q.start, FromState) or not isinstance(q.end, ToCircle) or q.end.angle is not None:
        raise ValueError("only a flight from circle to circle is handed on")
    return q.start.state_given[0], q.end.radius


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
