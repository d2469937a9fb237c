"""What a planar minimum-time flight must satisfy at both ends: unknowns -> starts of flights, ends -> misses.

Unknowns of one flight: three numbers w that give the direction of the costates (only their direction matters, since
the thrust law and all conditions are homogeneous in them), the flight time, and for an ellipse the true anomaly of
departure. Units: mu = 1, one au or the caller's own unit of length.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sailviz.compiled import compiled
from sailviz.design.minimum_time import costates
from sailviz.design.minimum_time.costates import Sail
from sailviz.steering.optimal import full_thrust, steer

SHORTEST = 1e-3  # flight time of a flight whatever its unknowns say


def polar(states):
    """(r, angle, u, v): radius, azimuth, radial and transverse speed of planar states (n, >= 6)."""
    x, y, vx, vy = states[:, 0], states[:, 1], states[:, 3], states[:, 4]
    r = np.hypot(x, y)
    return r, np.arctan2(y, x), (x * vx + y * vy) / r, (x * vy - y * vx) / r


def _cartesian(r, angle, u, v, lam_r, lam_across, lam_u, lam_v):
    """(n, 12) states and costates from their radial and transverse components at an azimuth."""
    c, s = np.cos(angle), np.sin(angle)
    zero = np.zeros_like(lam_u)

    def turned(a, b):
        return (c * a - s * b, s * a + c * b, zero)

    rows = [c * r + zero, s * r + zero, zero, *turned(u + zero, v + zero)]
    rows += [*turned(lam_r, lam_across), *turned(lam_u, lam_v)]
    return np.stack(rows, axis=1)


def _direction(unknowns):
    size = np.linalg.norm(unknowns[:, :3], axis=1)
    return unknowns[:, :3] / size[:, None], size


@dataclass(frozen=True)
class ToCircle:
    """From a point of given radius, radial and transverse speed to a circle, the angle between them free.

    Unknowns (4): direction of (lam_r, lam_u, lam_v), flight time. Misses (4): (r - r_f) / r_f, radial and transverse
    speed at the circle's speed, and that of the direction's length.
    """

    sail: Sail
    start: tuple[float, float, float]  # radius, radial speed, transverse speed
    radius: float  # of the circle

    size = 4

    @property
    def target(self):
        """Semi-latus rectum, eccentricity vector (x, y)."""
        return np.array([self.radius, 0.0, 0.0])

    def starts(self, unknowns):
        """(n, 12) from (n, 4)."""
        r, u, v = self.start
        lam_r, lam_u, lam_v = _direction(unknowns)[0].T
        # no costate belongs to the angle: lam_angle = r lam_across - lam_u v + lam_v u = 0
        return _cartesian(r, 0.0, u, v, lam_r, (lam_u * v - lam_v * u) / r, lam_u, lam_v)

    def misses(self, unknowns, tolerance, smoothing=0.0):
        """(n, 4) from (n, 4); NaN where a flight fails."""
        ends = fly(self, unknowns, tolerance, smoothing)
        r, _, u, v = polar(ends)
        slow = np.sqrt(self.radius)
        return np.stack([r / self.radius - 1, u * slow, v * slow - 1, _direction(unknowns)[1] - 1], axis=1)


@dataclass(frozen=True)
class BetweenEllipses:
    """From one ellipse to another in the same plane, both anomalies free.

    Unknowns (5): direction of (lam_r, lam_u, lam_v), flight time, true anomaly of departure. Misses (5): semi-latus
    rectum and eccentricity vector, the motion along the target orbit as seen by the costates, and that of the
    direction's length.
    """

    sail: Sail
    initial: tuple[float, float, float]  # semi-latus rectum, eccentricity, argument of periapsis rad
    final: tuple[float, float, float]

    size = 5

    @property
    def target(self):
        p, e, argument = self.final
        return np.array([p, e * np.cos(argument), e * np.sin(argument)])

    def starts(self, unknowns):
        """(n, 12) from (n, 5)."""
        p, e, argument = self.initial
        nu = unknowns[:, 4]
        r, u, v = p / (1 + e * np.cos(nu)), e * np.sin(nu) / np.sqrt(p), (1 + e * np.cos(nu)) / np.sqrt(p)
        lam_r, lam_u, lam_v = _direction(unknowns)[0].T
        # a moment more on the initial orbit is worth nothing: lam_r . v - lam_u / r^2 = 0
        return _cartesian(r, nu + argument, u, v, lam_r, (lam_u / r**2 - lam_r * u) / v, lam_u, lam_v)

    def misses(self, unknowns, tolerance, smoothing=0.0):
        """(n, 5) from (n, 5); NaN where a flight fails."""
        ends = fly(self, unknowns, tolerance, smoothing)
        p, ex, ey = orbits(ends)
        target = self.target
        r = np.hypot(ends[:, 0], ends[:, 1])
        idle = ends[:, 6] * ends[:, 3] + ends[:, 7] * ends[:, 4]
        idle -= (ends[:, 9] * ends[:, 0] + ends[:, 10] * ends[:, 1]) / r**3
        size = np.linalg.norm(ends[:, 6:11], axis=1)
        miss = [p / target[0] - 1, ex - target[1], ey - target[2], idle / size, _direction(unknowns)[1] - 1]
        return np.stack(miss, axis=1)


def orbits(states):
    """Semi-latus rectum and eccentricity vector of planar states (n, >= 6), each (n,)."""
    x, y, vx, vy = states[:, 0], states[:, 1], states[:, 3], states[:, 4]
    h = x * vy - y * vx
    r = np.hypot(x, y)
    return h * h, vy * h - x / r, -vx * h - y / r


def fly(problem, unknowns, tolerance, smoothing=0.0):
    """Ends (n, 12) of the flights that unknowns (n, k) describe."""
    spans = np.maximum(unknowns[:, 3], SHORTEST)
    return costates.fly_all(problem.starts(unknowns), spans, problem.sail, tolerance=tolerance, smoothing=smoothing)


@compiled
def hamiltonians(states, kind, p):
    """H of states and costates (n, 12) with the sail steered optimally."""
    out = np.empty(len(states))
    for i in range(len(states)):
        y = states[i]
        r2 = y[0] * y[0] + y[1] * y[1] + y[2] * y[2]
        l2 = y[9] * y[9] + y[10] * y[10] + y[11] * y[11]
        r, size = np.sqrt(r2), np.sqrt(l2)
        along = (y[0] * y[9] + y[1] * y[10] + y[2] * y[11]) / r
        c = along / size
        s = np.sqrt(max(0.0, 1.0 - c * c))
        h = steer(kind, p, 1, c, s, 0.0)[2]
        thrust, _ = full_thrust(kind, p, 1, r, 1.0)
        out[i] = y[6] * y[3] + y[7] * y[4] + y[8] * y[5] - along / r2 + thrust * size * h
    return out
