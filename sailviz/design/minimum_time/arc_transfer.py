"""The fastest flight of an electric sail to a far circle, by arcs: from near circles, where its thrust is on or off, to
the one asked for, where some of it may be partial."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from sailviz.constants import AU, DAY, RADIUS_SUN
from sailviz.design.minimum_time.arc_continuation import ByArcs, follow_arcs
from sailviz.design.minimum_time.arc_structures import (
    Check,
    Structure,
    from_extremal,
    misses,
    nothing,
    starts,
)
from sailviz.design.minimum_time.boundary_conditions import ToCircle, hamiltonians, polar
from sailviz.design.minimum_time.effort import Effort
from sailviz.design.minimum_time.planar_transfer import Transfer, no_transfer, time_unit
from sailviz.design.minimum_time.search import search
from sailviz.design.minimum_time.singular_arcs import KINDS, Arc, propagate_arcs, switching
from sailviz.design.minimum_time.state_costate import COSTATES, LRX, LVX, LVY, Sail

NEAR = (1.5, 1.25, 1.8)  # circles from which flights are followed outwards, in radii of the start; inwards, one over it
DIRECTIONS, SPAN = 256, 2.0  # screened there; flight times looked at, in estimates of the flight time
MOST = 3  # flights followed from each of them, the fastest


@dataclass(frozen=True)
class FarSearch:
    """What was followed: flights that arrived, fastest first; the one that came farthest; how many were begun, and the
    circles that were solved on the way."""

    arrived: tuple[Structure, ...]
    farthest: ByArcs | None
    followed: int
    circles: int

    @property
    def tried(self) -> str:
        """In words."""
        return f"{self.followed} flights to near circles were followed over {self.circles} circles"


def search_by_arcs(
    flight: ToCircle,
    flight_time: Callable[[float], float],
    accept: Callable[[np.ndarray], bool],
    progress: Callable[[float], None] = lambda share: None,
    check: Check = nothing,
    effort: Effort | None = None,
) -> FarSearch:
    """Follow the fastest flights to a near circle to the flight's own. flight_time(radius) : a rough one to any circle;
    accept, effort : as for `search`."""
    arrived: list[Structure] = []
    farthest: ByArcs | None = None
    followed, circles, outwards = 0, 0, flight.radius > 1
    for near in NEAR:
        radius = min(near, flight.radius**0.6) if outwards else max(1 / near, flight.radius**0.6)
        base = ToCircle(flight.sail, flight.start, radius)
        easy = search(base, SPAN * flight_time(radius), DIRECTIONS, outwards, accept, effort=effort)
        check()
        for extremal in easy.extremals[:MOST]:
            check()
            followed += 1
            found = follow_arcs(flight, from_extremal(base, extremal), radius, progress, check)
            if found is None:
                continue
            circles += found.circles
            if found.radius == flight.radius:
                arrived.append(found.structure)
            if farthest is None or found.radius > farthest.radius:
                farthest = found
        if arrived:
            break
    arrived.sort(key=lambda solved: float(np.sum(solved.lengths)))
    return FarSearch(tuple(arrived), farthest, followed, circles)


def transfer_by_arcs(
    flight: ToCircle, found: FarSearch, device: str, characteristic_acceleration: float, radius: float
) -> Transfer:
    """The result in SI of the fastest flight that arrived. radius : m, the unit of the flight."""
    unit = time_unit(radius)
    if not found.arrived:
        reason = f"{found.tried}, and none arrived"
        if found.farthest is not None:
            days = float(np.sum(found.farthest.structure.lengths)) * unit / DAY
            reason += f": the farthest came to {found.farthest.radius * radius / AU:.6g} au, after {days:.4f} d"
        return no_transfer(device, characteristic_acceleration, radius, reason)
    best = found.arrived[0]
    start = starts(flight, best.unknowns[None])
    start[:, COSTATES] /= hamiltonians(start, flight.sail)[0]
    lengths = best.lengths.tolist()
    span = float(np.sum(best.lengths))
    arcs = [(KINDS[arc], length) for arc, length in zip(best.arcs, lengths, strict=True)]
    path = propagate_arcs(start[0], arcs, flight.sail, times=np.linspace(0.0, span, int(40 * span) + 200))
    r, azimuth, _, _ = polar(path.rows)
    if not r.min() * radius > RADIUS_SUN:
        return no_transfer(device, characteristic_acceleration, radius, "the flight found passes through the Sun")
    angle = np.unwrap(azimuth)
    edges = np.concatenate([[0.0], np.cumsum(best.lengths)]) * unit
    times = np.array([float(np.sum(one.lengths)) for one in found.arrived]) * unit
    return Transfer(
        device=device,
        characteristic_acceleration=float(characteristic_acceleration),
        initial_radius=float(radius),
        time=span * unit,
        revolutions=float(angle[-1] - angle[0]) / (2 * np.pi),
        costates=start[0, [LRX, LVX, LVY]],
        residual=float(np.linalg.norm(misses(flight, best.arcs, best.unknowns[None])[0, :3])),
        hamiltonian_drift=path.drift,
        solutions=len(times),
        solution_times=times,
        switches=path.switches * unit,
        closest=float(r.min() * radius),
        starts=found.followed,
        converged=len(times),
        method="arcs",
        feasible=True,
        start=start[0],
        arcs=tuple(Arc(KINDS[arc], a, b) for arc, (a, b) in zip(best.arcs, pairwise(edges.tolist()), strict=True)),
        throttle=partial_throttle(start[0], arcs, flight.sail),
    )


def partial_throttle(start: np.ndarray, arcs: list[tuple[str, float]], sail: Sail) -> tuple[float, float] | None:
    """The lowest and the highest throttle on singular arcs; None where there are none."""
    seen, begin = [], 0.0
    edges = np.cumsum([length for _, length in arcs])
    for (kind, _), end in zip(arcs, edges.tolist(), strict=True):
        if kind == "singular":
            rows = propagate_arcs(start, arcs, sail, times=np.linspace(begin, end, 401)).rows
            seen.append(switching(rows, sail).throttle)
        begin = end
    if not seen:
        return None
    throttle = np.concatenate(seen)
    return float(throttle.min()), float(throttle.max())
