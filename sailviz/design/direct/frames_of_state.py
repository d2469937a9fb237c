"""The states that a direct flight is written in: polar ones in a plane, or Cartesian ones in space.

Each says, of casadi expressions, how a state moves under a thrust and what radius, speed and angle it has. Controls are
vectors of the same axes: radial and transverse in the plane, inertial in space. No elements: those fail where a flight
turns round and where it passes through a straight line.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    import casadi as ca


@dataclass(frozen=True)
class Planar:
    """States (r, theta, u, v): radius, angle swept, radial and transverse speed."""

    size = 4
    axes = 2
    low = (1e-2, -np.inf, -20.0, -20.0)
    high = (1e3, np.inf, 20.0, 20.0)

    def radius(self, x: ca.SX) -> ca.SX:
        return x[0]

    def outward(self, x: ca.SX) -> list[float | ca.SX]:
        """r_hat."""
        return [1.0, 0.0]

    def radial_speed(self, x: ca.SX) -> ca.SX:
        return x[2]

    def speed2(self, x: ca.SX) -> ca.SX:
        return x[2] ** 2 + x[3] ** 2

    def rates(self, x: ca.SX, thrust: list[ca.SX]) -> list[ca.SX]:
        r, _, u, v = x[0], x[1], x[2], x[3]
        return [u, v / r, v * v / r - 1 / r**2 + thrust[0], thrust[1] - u * v / r]

    def turned(self, x: ca.SX, n: ca.SX, rate: ca.SX) -> list[ca.SX]:
        """dn/dt of a normal n (2,) that turns at an inertial rate (1,)."""
        own = rate[0] - x[3] / x[0]
        return [-own * n[1], own * n[0]]

    turn_axes = 1

    def cartesian(self, x: np.ndarray) -> np.ndarray:
        """(n, 6) positions and velocities of states (n, 4)."""
        r, angle, u, v = x.T
        c, s = np.cos(angle), np.sin(angle)
        zero = np.zeros_like(r)
        return np.stack([r * c, r * s, zero, u * c - v * s, u * s + v * c, zero], axis=1)

    def inertial(self, x: np.ndarray, vectors: np.ndarray) -> np.ndarray:
        """(n, 3) of vectors (n, 2) beside states (n, 4)."""
        c, s = np.cos(x[:, 1]), np.sin(x[:, 1])
        a, b = vectors.T
        return np.stack([a * c - b * s, a * s + b * c, np.zeros_like(a)], axis=1)


@dataclass(frozen=True)
class Spatial:
    """States (x, y, z, vx, vy, vz)."""

    size = 6
    axes = 3
    low = (-1e3,) * 3 + (-20.0,) * 3
    high = (1e3,) * 3 + (20.0,) * 3
    turn_axes = 3

    def radius(self, x: ca.SX) -> ca.SX:
        return (x[0] ** 2 + x[1] ** 2 + x[2] ** 2) ** 0.5

    def outward(self, x: ca.SX) -> list[float | ca.SX]:
        """r_hat."""
        r = self.radius(x)
        return [x[0] / r, x[1] / r, x[2] / r]

    def radial_speed(self, x: ca.SX) -> ca.SX:
        return (x[0] * x[3] + x[1] * x[4] + x[2] * x[5]) / self.radius(x)

    def speed2(self, x: ca.SX) -> ca.SX:
        return x[3] ** 2 + x[4] ** 2 + x[5] ** 2

    def rates(self, x: ca.SX, thrust: list[ca.SX]) -> list[ca.SX]:
        near = self.radius(x) ** -3
        return [x[3], x[4], x[5], *(thrust[i] - near * x[i] for i in range(3))]

    def turned(self, x: ca.SX, n: ca.SX, rate: ca.SX) -> list[ca.SX]:
        """dn/dt of a normal n (3,) that turns at an inertial rate (3,)."""
        return [
            rate[1] * n[2] - rate[2] * n[1],
            rate[2] * n[0] - rate[0] * n[2],
            rate[0] * n[1] - rate[1] * n[0],
        ]

    def cartesian(self, x: np.ndarray) -> np.ndarray:
        """(n, 6) of states (n, 6)."""
        return x

    def inertial(self, x: np.ndarray, vectors: np.ndarray) -> np.ndarray:
        """(n, 3) of vectors (n, 3)."""
        return vectors


Axes = Planar | Spatial
