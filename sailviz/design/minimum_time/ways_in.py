"""Ways in: fastest flights from the circle of departure to where they turn at a limit of their distance from the Sun.

Of the directions of the costates at departure, two numbers, those whose flight turns at the limit, r = r_min and u = 0
there, make up curves on the sphere: one fastest flight for every speed at the limit, and several where a flight may go
round once more. Directions all over the sphere are flown roughly; where the distance of their turns passes through the
limit from one to the next there is a curve, which is followed to both sides by pseudo-arclength. Units: mu = 1 and the
distance of departure.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from sailviz.design.minimum_time import costates, shooting
from sailviz.design.minimum_time.boundary_conditions import DIRECTION, SPAN, direction, hamiltonians, polar
from sailviz.design.minimum_time.costates import AT_ONCE, fly_dense
from sailviz.design.minimum_time.effort import Effort
from sailviz.design.minimum_time.planar_ends import Polar, ToEnd
from sailviz.design.minimum_time.search import in_threads

AROUND, UP = 80, 40  # directions tried: round the axis of lam_r, and along it
SAMPLE = 0.05  # of time, of the rough flights
HALVINGS, CLOSE = 10, 0.1  # between neighbours; of the logarithm of the distance, where that led to a turn
TURNS = 4  # of a flight, that are looked at
ROUGH, FINE = 1e-6, 1e-10  # integration tolerances
ON_CURVE = 1e-7  # largest miss of a point of a curve
FIRST_STEP, LONGEST_STEP, SHORTEST_STEP = 0.02, 0.2, 1e-4  # along a curve, in its unknowns
WIDER, LOWER = (1.0, 1.5), 0.1  # limits over that asked for from which ways in are lowered; in steps of the logarithm
MOST_POINTS = 400  # of a curve, to either side


@dataclass(frozen=True)
class WaysIn:
    """Flights along a curve, n of them: unknowns (n, 4) as those of a ToEnd, speed (n,) at the limit, the costates
    (n, 3) of r, u and v there, of length 1, worth (n,) what more speed there costs in time, d time / d speed, NaN where
    the flight is no fastest one (H < 0)."""

    unknowns: np.ndarray
    speed: np.ndarray
    costates: np.ndarray
    worth: np.ndarray

    @property
    def time(self) -> np.ndarray:
        return np.asarray(self.unknowns[:, SPAN])


@dataclass(frozen=True)
class _Curve:
    """What is zero on a curve, of a flight and a limit."""

    flight: ToEnd
    limit: float

    def misses(self, unknowns: np.ndarray) -> np.ndarray:
        """(n, 3) of unknowns (n, 4): distance and radial speed at the limit, length of the costates."""
        at = Polar.of(self._ends(unknowns))
        return np.stack([np.log(at.r / self.limit), at.u * np.sqrt(self.limit), direction(unknowns)[1] - 1], axis=1)

    def misses_of_orbit(self, unknowns: np.ndarray) -> np.ndarray:
        """The same of the orbit's perihelion instead of the distance, and of r u: they depend on the moment hardly and
        in proportion. Right where the flight is faster than on the circle of the limit."""
        at = Polar.of(self._ends(unknowns))
        p = (at.r * at.v) ** 2
        perihelion = p / (1 + np.hypot(p / at.r - 1, at.r * at.v * at.u))
        off = np.log(perihelion / self.limit), at.r * at.u / np.sqrt(self.limit)
        return np.stack([*off, direction(unknowns)[1] - 1], axis=1)

    def slope(self, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Misses (3,) at x (4,), their Jacobian (3, 4)."""
        h = 1e-6
        values = self.misses(np.vstack([x, x + h * np.eye(4)]))
        return values[0], (values[1:] - values[0]).T / h

    def ways(self, unknowns: np.ndarray) -> WaysIn:
        """Flights of points (n, 4) on it."""
        at = Polar.of(self._ends(unknowns))
        h = hamiltonians(self.flight.starts(unknowns), self.flight.sail)
        with np.errstate(invalid="ignore", divide="ignore"):
            worth = np.where(h > 0, at.lam_v / h, np.nan)
        lam = np.stack([at.lam_r, at.lam_u, at.lam_v], axis=1) / at.size[:, None]
        return WaysIn(unknowns, at.v, lam, worth)

    def _ends(self, unknowns: np.ndarray) -> np.ndarray:
        spans = np.maximum(unknowns[:, SPAN], SAMPLE)
        return costates.fly_all(self.flight.starts(unknowns), spans, self.flight.sail, tolerance=FINE)

    def nearby(self, x: np.ndarray, most: float, effort: Effort) -> np.ndarray | None:
        """The point (4,) of the curve near x, whose unknowns change by so much at most in a step, or None."""
        for misses in (self.misses_of_orbit, self.misses):
            root = shooting.solve(effort.watched(misses), x, step=1e-6, goal=ON_CURVE, most=8, limit=[most] * 4)
            if root.residual <= ON_CURVE and np.abs(self.misses(root.unknowns[None])).max() < 10 * ON_CURVE:
                return root.unknowns
        return None

    def corrected(self, x: np.ndarray, ahead: np.ndarray, jacobian: np.ndarray) -> tuple[np.ndarray, int] | None:
        """The point of the curve near x + ahead in the plane normal to ahead, and the iterations it took; None."""
        new = x + ahead
        for turn in range(5):
            f, here = self.slope(new)
            if not (np.all(np.isfinite(f)) and np.all(np.isfinite(here))):
                return None
            if np.abs(f).max() < ON_CURVE:
                return new, turn
            matrix, off = np.vstack([here, ahead]), np.append(f, ahead @ (new - x - ahead))
            new = new - np.linalg.lstsq(matrix, off)[0]
            if np.linalg.norm(new - x) > 3 * np.linalg.norm(ahead):
                return None
        return None

    def traced(self, x: np.ndarray, sense: int, longest: float, effort: Effort) -> list[np.ndarray]:
        """Points (4,) along it from x on, to one side, as far as flights no longer than that go."""
        points, ds = list[np.ndarray](), FIRST_STEP
        _, jacobian = self.slope(x)
        tangent = sense * np.linalg.svd(jacobian)[2][-1]
        begin = x
        while len(points) < MOST_POINTS and ds > SHORTEST_STEP:
            effort.check()
            found = self.corrected(x, ds * tangent, jacobian)
            if found is None:
                ds *= 0.4
                continue
            new, turns = found
            _, jacobian = self.slope(new)
            along = np.linalg.svd(jacobian)[2][-1]
            tangent, x = along * np.copysign(1.0, along @ (new - x)), new
            points.append(x)
            if not 2 * SAMPLE < x[SPAN] < longest or (len(points) > 5 and np.linalg.norm(x - begin) < ds):
                break
            if turns <= 3:
                ds = min(1.5 * ds, LONGEST_STEP)
        return points


def curves(
    flight: ToEnd, limit: float, longest: float, effort: Effort, progress: Callable[[float], None] | None = None
) -> list[WaysIn]:
    """All ways in to a limit that are found, of a time up to longest, one WaysIn for each curve."""
    curve, known, found = _Curve(flight, limit), list[np.ndarray](), list[WaysIn]()
    grid = _Turns.of(flight, longest, effort, progress)
    for wider in WIDER:
        for seed in grid.seeds(flight, wider * limit, longest, effort):
            x = _lowered(flight, seed, wider, limit, effort)
            if x is None or not 2 * SAMPLE < x[SPAN] < longest or any(_on(x, points) for points in known):
                continue
            there, back = (curve.traced(x, sense, longest, effort) for sense in (1, -1))
            points = np.array([*back[::-1], x, *there])
            known.append(points)
            found.append(curve.ways(points))
            effort.count("ways in to the limit", len(points))
    return found


def _lowered(flight: ToEnd, seed: np.ndarray, wider: float, limit: float, effort: Effort) -> np.ndarray | None:
    """The point (4,) of the curve of a limit that a seed near that of a wider one leads to; None."""
    x = _Curve(flight, wider * limit).nearby(seed, 0.1, effort)
    for share in np.linspace(1, 0, int(np.ceil(np.log(wider) / LOWER)) + 1)[1:]:
        if x is None:
            break
        x = _Curve(flight, limit * wider**share).nearby(x, 0.1, effort)
    return x


def _on(x: np.ndarray, points: np.ndarray) -> bool:
    """Whether unknowns (4,) are on a curve of points (n, 4) that are no farther apart than LONGEST_STEP."""
    return bool(np.min(np.linalg.norm(points - x, axis=1)) < 0.6 * LONGEST_STEP)


@dataclass(frozen=True)
class _Turns:
    """Where flights of directions (AROUND, UP, 3) all over the sphere turn: distances and times (AROUND, UP, TURNS)."""

    directions: np.ndarray
    radii: np.ndarray
    times: np.ndarray

    @classmethod
    def of(
        cls, flight: ToEnd, longest: float, effort: Effort, progress: Callable[[float], None] | None = None
    ) -> _Turns:
        """Flown roughly."""
        angle, height = np.meshgrid(2 * np.pi * np.arange(AROUND) / AROUND, np.linspace(-1, 1, UP), indexing="ij")
        across = np.sqrt(1 - height**2)
        directions = np.stack([height, across * np.cos(angle), across * np.sin(angle)], axis=-1)
        unknowns = np.zeros((AROUND * UP, 4))
        unknowns[:, DIRECTION] = directions.reshape(-1, 3)
        starts = flight.starts(unknowns)

        def part(places: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
            effort.check()
            return _turns(starts[places], longest, flight)

        parts = np.array_split(np.arange(len(starts)), -(-len(starts) // AT_ONCE))
        radii, times = (np.concatenate(x) for x in zip(*in_threads(part, parts, progress, effort), strict=True))
        effort.count("costates flown roughly", len(starts))
        return cls(directions, radii.reshape(AROUND, UP, TURNS), times.reshape(AROUND, UP, TURNS))

    def seeds(self, flight: ToEnd, limit: float, longest: float, effort: Effort) -> np.ndarray:
        """Unknowns (n, 4) of flights that turn near a limit, those that come there soonest first: between neighbours on
        the sphere of which one turns this side of it and one beyond, by bisection."""
        off = _off(self.radii, limit)
        ends, kinds = list[np.ndarray](), list[np.ndarray]()
        for axis in (0, 1):
            ahead = [np.roll(x, -1, axis) for x in (off, self.times, self.directions)]
            with np.errstate(invalid="ignore"):
                between = (off * ahead[0] <= 0) & (np.abs(self.times - ahead[1]) < 1.0)
            if axis == 1:
                between[:, -1] = False  # the poles are no neighbours
            i, j, k = np.nonzero(between)
            two = np.stack([self.directions[i, j], ahead[2][i, j]], axis=1)
            ends.append(np.where((off[i, j, k] > 0)[:, None, None], two, two[:, ::-1]))
            kinds.append(k)
        both, k = np.concatenate(ends), np.concatenate(kinds)
        places, unknowns = np.arange(len(k)), np.zeros((len(k), 4))
        for _ in range(HALVINGS):
            effort.check()
            middle = both.sum(axis=1)
            middle /= np.linalg.norm(middle, axis=1)[:, None]
            unknowns[:, DIRECTION] = middle
            radii, times = _turns(flight.starts(unknowns), longest, flight)
            there = _off(radii, limit)[places, k]
            both[places, np.where(there > 0, 0, 1)] = middle  # a turn that is none counts as one beyond
            unknowns[:, SPAN] = times[places, k]
        close = np.abs(there) < CLOSE if len(k) else np.zeros(0, dtype=bool)
        return np.asarray(unknowns[close][np.argsort(unknowns[close, SPAN], kind="stable")])


def _off(radii: np.ndarray, limit: float) -> np.ndarray:
    """log(r / limit) of turns (..., TURNS), NaN after one that was nearer than the limit."""
    with np.errstate(invalid="ignore"):
        off = np.log(radii / limit)
        nearer_before = np.cumsum(off < 0, axis=-1) - (off < 0) > 0
    return np.where(nearer_before, np.nan, off)


def _turns(starts: np.ndarray, longest: float, flight: ToEnd) -> tuple[np.ndarray, np.ndarray]:
    """Distances and times (n, TURNS) of the first turns of flights from starts (n, 12), NaN where there is none."""
    times = np.linspace(0.0, longest, int(longest / SAMPLE) + 2)
    rows = fly_dense(starts, np.full(len(starts), longest), flight.sail, times, ROUGH, 0.0).rows
    radii, when = np.full((len(starts), TURNS), np.nan), np.full((len(starts), TURNS), np.nan)
    for n, row in enumerate(rows):
        r, _, u, _ = polar(row)
        with np.errstate(invalid="ignore"):
            i = np.nonzero((u[:-1] < 0) & (u[1:] >= 0))[0][:TURNS]
        step = times[1]
        # the cubic through r and u at both ends is flat where c0 + c1 w + c2 w^2 = 0
        a, b, rise = u[i] * step, u[i + 1] * step, r[i + 1] - r[i]
        c0, c1, c2 = a, 6 * rise - 4 * a - 2 * b, 3 * (a + b) - 6 * rise
        w = 2 * c0 / (-c1 - np.sqrt(np.maximum(c1 * c1 - 4 * c0 * c2, 0.0)))
        w = np.where((w >= 0) & (w <= 1), w, a / (a - b))
        radii[n, : len(i)] = r[i] + w * (c0 + w * (c1 / 2 + w * c2 / 3))
        when[n, : len(i)] = times[i] + w * step
    with np.errstate(invalid="ignore"):
        radii[~(radii > 0)] = np.nan
    return radii, when
