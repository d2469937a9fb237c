"""Flights of arcs followed from a near circle to a far one: pseudo-arclength continuation in the logarithm of the
radius, on which arcs come and go.

The radius turns back where the flight does: within one row of arcs, and where a new one is born, as a coast is within
thrust whose switching function has come down to 0: then the row with the new arc may lead back, to another turn. Such
a path arrives where steps in the radius alone end. Source: H. B. Keller (1977).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

import numpy as np

from sailviz.design.minimum_time import shooting
from sailviz.design.minimum_time.arc_structures import (
    DEPTH,
    LENGTHS,
    SOLVED,
    Check,
    Fault,
    Structure,
    amended,
    faults,
    misses,
    nothing,
    right,
)
from sailviz.design.minimum_time.boundary_conditions import DIRECTION, ToCircle

FIRST, LARGEST, SMALLEST = 0.03, 0.15, 3e-5  # steps: direction of the costates, shares of the time, logarithm of radius
NEAR = 0.02  # steps below which an arc that is born may lead back
LEAPS = (0.003, 0.01, 0.03)  # logarithm of the radius, past a place where an arc is almost without length
SIDEWAYS = 0.7  # of a step: farther off it the correction led elsewhere
BENT = 0.5  # cosine between two tangents that follow each other
MOST = 400  # circles
BEHIND = 0.3  # logarithm of the radius behind the first circle, where a path is given up
PAST = 0.1  # the same beyond the last one: a path that turns back there may bring a faster flight


@dataclass(frozen=True)
class ByArcs:
    """How far a flight was followed: radius of the circle reached, its structure, the fastest of those that the path
    has there; circles solved on the way."""

    radius: float
    structure: Structure
    circles: int


@dataclass(frozen=True)
class Point:
    """A flight of a path: logarithm of the radius, structure, unit tangent (k + 1,) in scaled unknowns and at."""

    at: float
    structure: Structure
    tangent: np.ndarray

    @property
    def scale(self) -> np.ndarray:
        """Of unknowns and logarithm: the lengths are measured in shares of the time."""
        scale = np.ones(len(self.structure.unknowns) + 1)
        scale[LENGTHS:-1] = float(np.sum(self.structure.lengths))
        return scale

    @property
    def row(self) -> np.ndarray:
        """Unknowns and logarithm (k + 1,)."""
        return np.append(self.structure.unknowns, self.at)


def _equations(flight: ToCircle, arcs: str, rows: np.ndarray) -> np.ndarray:
    """What is to vanish (n, k) of unknowns and logarithms (n, k + 1)."""
    return misses(flight, arcs, rows[:, :-1], np.exp(rows[:, -1]))


def _point(flight: ToCircle, structure: Structure, at: float, towards: np.ndarray | float) -> Point | None:
    """The flight with its tangent, which goes as `towards` does: a tangent, or a sense of the radius."""
    point = Point(at, structure, np.empty(0))
    row, scale, step = point.row, point.scale, 1e-7
    values = _equations(flight, structure.arcs, np.vstack([row, row + np.diag(step * scale)]))
    slope = (values[1:] - values[0]).T / step
    if not np.all(np.isfinite(slope)):
        return None
    tangent = np.linalg.svd(slope)[2][-1]
    ahead = tangent @ towards if isinstance(towards, np.ndarray) else tangent[-1] * towards
    return replace(point, tangent=tangent if ahead >= 0 else -tangent)


def _step(flight: ToCircle, now: Point, step: float, check: Check) -> Point | None:
    """The flight a step farther, of the same arcs; None where the correction does not find it."""
    scale, arcs = now.scale, now.structure.arcs
    guess = now.row + step * scale * now.tangent

    def batch(rows: np.ndarray) -> np.ndarray:
        check()
        off = ((rows - guess) / scale) @ now.tangent
        return np.column_stack([_equations(flight, arcs, rows), off])

    found = shooting.solve(batch, guess, step=1e-7, goal=1e-12, most=12, limit=0.3 * scale)
    if not found.residual < SOLVED or np.linalg.norm((found.unknowns - guess) / scale) > SIDEWAYS * step:
        return None
    new = _point(flight, Structure(arcs, found.unknowns[:-1]), float(found.unknowns[-1]), now.tangent)
    return new if new is not None and new.tangent @ now.tangent > BENT else None


def _changed(flight: ToCircle, now: Point, beyond: Point, step: float, check: Check) -> Point | None:
    """Where a path goes on in other arcs, since those have faults beyond a point: ahead, or else back."""
    wrong = faults(_to(flight, beyond.at), beyond.structure)
    ahead = float(np.sign(beyond.at - now.at))
    tried: set[tuple[str, int]] = set()
    for other in amended(beyond.structure, wrong):
        found = right(_to(flight, beyond.at), other, check, DEPTH - 1, tried)
        if found is not None and found.arcs != now.structure.arcs:
            return _point(flight, found, beyond.at, ahead)
    if step > NEAR:
        return None
    back = 2 * now.at - beyond.at
    for other in amended(beyond.structure, wrong):
        found = right(_to(flight, back), other, check, depth=0)
        if found is not None and found.arcs != now.structure.arcs and _near(found, now.structure):
            return _point(flight, found, back, -ahead)
    return None


def _leapt(flight: ToCircle, now: Point, check: Check) -> Point | None:
    """Where a path goes on without its shortest arc, past the place where that has so little length that neither row
    of arcs passes its tests."""
    short = int(np.argmin(now.structure.lengths))
    way = float(np.sign(now.tangent[-1]))
    for other in amended(now.structure, [Fault("length", short)]):
        for leap in LEAPS:
            found = right(_to(flight, now.at + way * leap), other, check, depth=1)
            if found is not None and found.arcs != now.structure.arcs and _near(found, now.structure):
                return _point(flight, found, now.at + way * leap, way)
    return None


def _near(one: Structure, other: Structure) -> bool:
    """Whether two flights that differ in their arcs may be of one path."""
    times = np.sum(one.lengths) / np.sum(other.lengths)
    apart = np.linalg.norm(one.unknowns[DIRECTION] - other.unknowns[DIRECTION])
    return bool(abs(times - 1) < 0.05 and apart < 0.05)


def _to(flight: ToCircle, at: float) -> ToCircle:
    return replace(flight, radius=float(np.exp(at)))


def _points(flight: ToCircle, first: Point, check: Check) -> Iterator[Point]:
    """The path from its first point on."""
    now, step = first, FIRST
    yield now
    for _ in range(MOST):
        new = None
        while new is None and step > SMALLEST:
            new = _step(flight, now, step, check)
            if new is not None and faults(_to(flight, new.at), new.structure):
                new = _changed(flight, now, new, step, check)
            step = step if new is not None else 0.5 * step
        new = new or _leapt(flight, now, check)
        if new is None:
            return
        now, step = new, min(max(1.5 * step, 0.1 * FIRST), LARGEST)
        yield now


def follow_arcs(
    flight: ToCircle,
    begin: Structure,
    radius: float,
    progress: Callable[[float], None] | None = None,
    check: Check = nothing,
) -> ByArcs | None:
    """An optimal flight to the circle of `radius` followed to the flight's own circle. begin : the flight to there,
    roughly; None where even that is not to be had."""
    start = right(replace(flight, radius=radius), begin, check)
    if start is None:
        return None
    origin, end = float(np.log(radius)), float(np.log(flight.radius))
    if origin == end:
        return ByArcs(flight.radius, start, 1)
    sense = float(np.sign(end - origin))
    first = _point(flight, start, origin, sense)
    if first is None:
        return ByArcs(radius, start, 1)
    best, before, circles = first, first, 0
    arrived: list[Structure] = []
    for point in _points(flight, first, check):
        circles += 1
        if (before.at - end) * (point.at - end) <= 0:
            there = next((x for x in (right(flight, g, check) for g in _between(before, point, end)) if x), None)
            arrived += [there] if there is not None else []
        if sense * (point.at - best.at) > 0:
            best = point
        if sense * (point.at - origin) < -BEHIND or sense * (point.at - end) > PAST:
            break
        before = point
        if progress is not None:
            progress(1 - max(0.0, sense * (end - best.at)) / abs(end - origin))
    if arrived:
        return ByArcs(flight.radius, min(arrived, key=lambda one: float(np.sum(one.lengths))), circles)
    return ByArcs(float(np.exp(best.at)), best.structure, circles)


def _between(before: Point, after: Point, end: float) -> Iterator[Structure]:
    """Guesses of the flight at the end from those before and behind it."""
    if before.structure.arcs == after.structure.arcs and before.at != after.at:
        share = (end - before.at) / (after.at - before.at)
        unknowns = before.structure.unknowns + share * (after.structure.unknowns - before.structure.unknowns)
        yield Structure(after.structure.arcs, unknowns)
    yield after.structure
    yield before.structure
