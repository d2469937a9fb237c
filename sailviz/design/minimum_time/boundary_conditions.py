"""What a planar minimum-time flight must satisfy at both ends: unknowns -> starts of flights, ends -> misses.

Unknowns of one flight: three numbers w that give the direction of the costates (only their direction matters, since
the thrust law and all conditions are homogeneous in them), the flight time, and for an ellipse the true anomaly of
departure. Units: mu = 1, one au or the caller's own unit of length.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple, Protocol

import numpy as np

from sailviz.compiled import entry
from sailviz.design.minimum_time import costates
from sailviz.design.minimum_time.state_costate import (
    LRX,
    LRY,
    LRZ,
    LVX,
    LVY,
    LVZ,
    OWN,
    SIZE,
    VX,
    VY,
    VZ,
    Sail,
    X,
    Y,
    Z,
)
from sailviz.steering.optimal import full_thrust, steer_cool

DIRECTION, SPAN, ANOMALY = slice(0, 3), 3, 4  # places of the unknowns
SHORTEST = 1e-3  # flight time of a flight whatever its unknowns say


def polar(states: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """(r, angle, u, v): radius, azimuth, radial and transverse speed of planar states (n, >= 6)."""
    x, y, vx, vy = states[:, X], states[:, Y], states[:, VX], states[:, VY]
    r = np.hypot(x, y)
    return r, np.arctan2(y, x), (x * vx + y * vy) / r, (x * vy - y * vx) / r


def cartesian(r, angle, u, v, lam_r, lam_across, lam_u, lam_v):
    """(n, 12) states and costates from their radial and transverse components at an azimuth."""
    c, s = np.cos(angle), np.sin(angle)
    states = np.zeros((len(lam_u), SIZE))
    states[:, X], states[:, Y] = c * r, s * r
    for x, along, across in ((VX, u, v), (LRX, lam_r, lam_across), (LVX, lam_u, lam_v)):
        states[:, x], states[:, x + 1] = c * along - s * across, s * along + c * across
    return states


def direction(unknowns):
    """Unit vectors (n, 3) of the costates' direction, and the lengths (n,) that the unknowns give it."""
    size = lengths(unknowns)
    return unknowns[:, DIRECTION] / size[:, None], size


def lengths(unknowns):
    """Those (n,) that the unknowns (n, k) give the direction."""
    w = unknowns[:, DIRECTION]
    return np.sqrt((w * w).sum(axis=1))


def side_by_side(*columns):
    """(n, k) from k columns (n,), for a quarter of what np.stack takes."""
    out = np.empty((len(columns[0]), len(columns)))
    for i, column in enumerate(columns):
        out[:, i] = column
    return out


class PolarState(NamedTuple):
    """Where a flight departs in its plane: radius, radial and transverse speed."""

    radius: float
    radial: float
    transverse: float


class Ellipse(NamedTuple):
    """An orbit in the plane: semi-latus rectum, eccentricity, argument of periapsis rad."""

    semi_latus_rectum: float
    eccentricity: float
    argument: float


@dataclass(frozen=True)
class ToCircle:
    """From a point of given radius, radial and transverse speed to a circle, the angle between them free.

    Unknowns (4): direction of (lam_r, lam_u, lam_v), flight time. Misses (4): (r - r_f) / r_f, radial and transverse
    speed at the circle's speed, and that of the direction's length.
    """

    sail: Sail
    start: PolarState
    radius: float  # of the circle

    size = 4
    free_departure = False

    @property
    def scale(self) -> float:
        """The distance of the target from the Sun."""
        return self.radius

    def nearness(self, rows: np.ndarray) -> np.ndarray:
        """Squares (n, m) of how far dense rows (n, m, 12) are from the circle."""
        return off_orbit(rows, self.radius, 0.0, 0.0)

    def starts(self, unknowns: np.ndarray) -> np.ndarray:
        """(n, 12) from (n, 4)."""
        r, u, v = self.start
        lam_r, lam_u, lam_v = direction(unknowns)[0].T
        # no costate belongs to the angle: lam_angle = r lam_across - lam_u v + lam_v u = 0
        return cartesian(r, 0.0, u, v, lam_r, (lam_u * v - lam_v * u) / r, lam_u, lam_v)

    def misses(self, unknowns: np.ndarray, tolerance: float, smoothing: float = 0.0) -> np.ndarray:
        """(n, 4) from (n, 4); NaN where a flight fails."""
        ends = fly(self, unknowns, tolerance, smoothing)
        r, _, u, v = polar(ends)
        slow = np.sqrt(self.radius)
        return side_by_side(r / self.radius - 1, u * slow, v * slow - 1, lengths(unknowns) - 1)


@dataclass(frozen=True)
class BetweenEllipses:
    """From one ellipse to another in the same plane, both anomalies free.

    Unknowns (5): direction of (lam_r, lam_u, lam_v), flight time, true anomaly of departure. Misses (5): semi-latus
    rectum and eccentricity vector, the motion along the target orbit as seen by the costates, and that of the
    direction's length.
    """

    sail: Sail
    initial: Ellipse
    final: Ellipse

    size = 5
    free_departure = True

    @property
    def target(self) -> np.ndarray:
        """Semi-latus rectum, eccentricity vector (x, y)."""
        p, e, argument = self.final
        return np.array([p, e * np.cos(argument), e * np.sin(argument)])

    @property
    def scale(self) -> float:
        """A distance of the target from the Sun."""
        return self.final.semi_latus_rectum

    def nearness(self, rows: np.ndarray) -> np.ndarray:
        """Squares (n, m) of how far dense rows (n, m, 12) are from the orbit."""
        return off_orbit(rows, *self.target)

    def starts(self, unknowns: np.ndarray) -> np.ndarray:
        """(n, 12) from (n, 5)."""
        p, e, argument = self.initial
        nu = unknowns[:, ANOMALY]
        r, u, v = p / (1 + e * np.cos(nu)), e * np.sin(nu) / np.sqrt(p), (1 + e * np.cos(nu)) / np.sqrt(p)
        lam_r, lam_u, lam_v = direction(unknowns)[0].T
        # a moment more on the initial orbit is worth nothing: lam_r . v - lam_u / r^2 = 0
        return cartesian(r, nu + argument, u, v, lam_r, (lam_u / r**2 - lam_r * u) / v, lam_u, lam_v)

    def misses(self, unknowns: np.ndarray, tolerance: float, smoothing: float = 0.0) -> np.ndarray:
        """(n, 5) from (n, 5); NaN where a flight fails."""
        ends = fly(self, unknowns, tolerance, smoothing)
        p, ex, ey = orbits(ends)
        p_wanted, ex_wanted, ey_wanted = self.target
        r = np.hypot(ends[:, X], ends[:, Y])
        idle = ends[:, LRX] * ends[:, VX] + ends[:, LRY] * ends[:, VY]
        idle -= (ends[:, LVX] * ends[:, X] + ends[:, LVY] * ends[:, Y]) / r**3
        size = np.linalg.norm(ends[:, LRX:LVZ], axis=1)
        miss = p / p_wanted - 1, ex - ex_wanted, ey - ey_wanted, idle / size, lengths(unknowns) - 1
        return side_by_side(*miss)


def orbits(states: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Semi-latus rectum and eccentricity vector of planar states (n, >= 6), each (n,)."""
    x, y, vx, vy = states[:, X], states[:, Y], states[:, VX], states[:, VY]
    h = x * vy - y * vx
    r = np.hypot(x, y)
    return h * h, vy * h - x / r, -vx * h - y / r


def off_orbit(rows: np.ndarray, p_wanted: float, ex_wanted: float, ey_wanted: float) -> np.ndarray:
    """Squares (n, m) of how far the orbits of dense rows (n, m, >= 6) are from one of a semi-latus rectum and an
    eccentricity vector (x, y); NaN where a row was not reached."""
    px, py, vx, vy = (rows[..., place] for place in (X, Y, VX, VY))
    r = np.sqrt(px * px + py * py)
    h = px * vy - py * vx
    ex, ey = vy * h - px / r - ex_wanted, -vx * h - py / r - ey_wanted
    size = h * h / p_wanted - 1.0
    return np.asarray(size * size + ex * ex + ey * ey)


class PlanarProblem(Protocol):
    """What a search for a fastest flight in the plane has to know of it: `ToCircle`, `BetweenEllipses` and others."""

    @property
    def sail(self) -> Sail: ...
    @property
    def size(self) -> int: ...
    @property
    def free_departure(self) -> bool: ...
    @property
    def scale(self) -> float: ...
    def nearness(self, rows: np.ndarray) -> np.ndarray: ...
    def starts(self, unknowns: np.ndarray) -> np.ndarray: ...
    def misses(self, unknowns: np.ndarray, tolerance: float, smoothing: float = 0.0) -> np.ndarray: ...


def fly(problem: PlanarProblem, unknowns: np.ndarray, tolerance: float, smoothing: float = 0.0) -> np.ndarray:
    """Ends (n, 12) of the flights that unknowns (n, k) describe."""
    spans = np.maximum(unknowns[:, SPAN], SHORTEST)
    return costates.fly_all(problem.starts(unknowns), spans, problem.sail, tolerance=tolerance, smoothing=smoothing)


@entry("d2 i d1 D1")
def hamiltonians_compiled(states, kind, p, out):
    """`hamiltonians` into out (n,)."""
    for i in range(len(states)):
        y = states[i]
        r2 = y[X] * y[X] + y[Y] * y[Y] + y[Z] * y[Z]
        l2 = y[LVX] * y[LVX] + y[LVY] * y[LVY] + y[LVZ] * y[LVZ]
        r, size = np.sqrt(r2), np.sqrt(l2)
        along = (y[X] * y[LVX] + y[Y] * y[LVY] + y[Z] * y[LVZ]) / r
        c = along / size
        s = np.sqrt(max(0.0, 1.0 - c * c))
        h = steer_cool(kind, p, OWN, r2, c, s)[2]
        thrust, _ = full_thrust(kind, p, OWN, r, 1.0)
        out[i] = y[LRX] * y[VX] + y[LRY] * y[VY] + y[LRZ] * y[VZ] - along / r2 + thrust * size * h
    return 0


def hamiltonians(states: np.ndarray, sail: Sail) -> np.ndarray:
    """H (n,) of states and costates (n, 12) with the sail steered optimally."""
    out = np.empty(len(states))
    hamiltonians_compiled(np.ascontiguousarray(states, dtype=float), sail.kind, sail.parameters, out)
    return out
