"""Ends of a planar flight other than an orbit, and flights whose angle about the Sun is given.

What is free at the end has no costate; where the end is a surface in the state, the costates stand at right angles to
it (transversality; H is maximised, the flight time free). Of polar coordinates r, theta, u, v: past a radius u and v
are free, so that the primer vanishes at the end; at an energy the three costates are parallel to its gradient
(1 / r^2, u, v). An angle that is given has a costate, constant on the way. Units: mu = 1 and the distance of departure.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from sailviz.design.minimum_time.boundary_conditions import ANOMALY, PolarState, cartesian, direction, fly, polar
from sailviz.design.minimum_time.state_costate import LRX, LRY, LVX, LVY, Sail, X, Y

TURN = 2 * np.pi
UNIT_CIRCLE = PolarState(1.0, 0.0, 1.0)


@dataclass(frozen=True)
class Polar:
    """Planar states and costates by their components, each of one shape: radius r, azimuth, radial and transverse speed
    u and v, the costates of r, u and v, and the length of these three."""

    r: np.ndarray
    azimuth: np.ndarray
    u: np.ndarray
    v: np.ndarray
    lam_r: np.ndarray
    lam_u: np.ndarray
    lam_v: np.ndarray

    @classmethod
    def of(cls, rows: np.ndarray) -> Polar:
        """Of rows (..., 12)."""
        flat = rows.reshape(-1, rows.shape[-1])
        r, azimuth, u, v = polar(flat)
        c, s = flat[:, X] / r, flat[:, Y] / r
        lam_r = c * flat[:, LRX] + s * flat[:, LRY]
        lam_u, lam_v = c * flat[:, LVX] + s * flat[:, LVY], c * flat[:, LVY] - s * flat[:, LVX]
        return cls(*(x.reshape(rows.shape[:-1]) for x in (r, azimuth, u, v, lam_r, lam_u, lam_v)))

    @property
    def size(self) -> np.ndarray:
        return np.sqrt(self.lam_r**2 + self.lam_u**2 + self.lam_v**2)


class Absolute(Polar):
    """The same, the costates not measured by their length: what a flight that is a little off misses then depends on
    its unknowns in proportion."""

    @property
    def size(self) -> np.ndarray:
        return np.ones_like(self.r)


class End(Protocol):
    """An end of a planar flight: scale, a distance of it from the Sun; misses of all that must vanish; nearness,
    squares (n, m) of how far dense rows (n, m, 12) are from it; holds, whether what the misses leave open is right."""

    @property
    def scale(self) -> float: ...
    def misses(self, at: Polar) -> tuple[np.ndarray, ...]: ...
    def nearness(self, rows: np.ndarray) -> np.ndarray: ...
    def holds(self, at: Polar) -> bool: ...


@dataclass(frozen=True)
class AtState:
    """At a distance from the Sun with a radial and a transverse speed."""

    radius: float
    radial: float
    transverse: float

    @classmethod
    def circle(cls, radius: float) -> AtState:
        """On the circle of a radius, at its speed."""
        return cls(radius, 0.0, radius**-0.5)

    @property
    def scale(self) -> float:
        return self.radius

    def misses(self, at: Polar) -> tuple[np.ndarray, ...]:
        """r relative, u and v as shares of the speed on the circle there."""
        slow = np.sqrt(self.radius)
        return at.r / self.radius - 1, (at.u - self.radial) * slow, (at.v - self.transverse) * slow

    def nearness(self, rows: np.ndarray) -> np.ndarray:
        """Squares of how far rows are from it."""
        return np.asarray(sum(x**2 for x in self.misses(Polar.of(rows))))

    def holds(self, at: Polar) -> bool:
        """Whether what the misses leave open is as it must be."""
        return True


@dataclass(frozen=True)
class AtRadius:
    """At a distance from the Sun, at whatever speed: past a circle, or out to a distance."""

    radius: float

    @property
    def scale(self) -> float:
        return self.radius

    def misses(self, at: Polar) -> tuple[np.ndarray, ...]:
        """r, and the primer's two components as shares of the costates' length."""
        return at.r / self.radius - 1, at.lam_u / at.size, at.lam_v / at.size

    def nearness(self, rows: np.ndarray) -> np.ndarray:
        """Squares of how far rows are from it."""
        at = Polar.of(rows)
        off = at.r / self.radius - 1
        found = 1.0 + off**2  # flights that only come near the radius, their primer vanishing, lead nowhere
        before, after = off[:, :-1], off[:, 1:]
        w = before / (before - after)
        u, v, size = (x[:, :-1] + w * (x[:, 1:] - x[:, :-1]) for x in (at.lam_u, at.lam_v, at.size))
        found[:, 1:] = np.where(before * after <= 0, (u * u + v * v) / size**2, found[:, 1:])
        return np.asarray(found)

    def holds(self, at: Polar) -> bool:
        """Whether what the misses leave open is as it must be: a moment later the flight is past the radius on the side
        that its costate asks for."""
        return bool(at.lam_r * at.u > 0)


@dataclass(frozen=True)
class AtEnergy:
    """At an orbital energy, anywhere: an excess speed squared over 2."""

    energy: float

    @property
    def scale(self) -> float:
        return 1.0

    def _gradient(self, at: Polar) -> tuple[tuple[np.ndarray, ...], np.ndarray]:
        """(1 / r^2, u, v) and its length."""
        g = at.r**-2, at.u, at.v
        return g, np.sqrt(g[0] ** 2 + g[1] ** 2 + g[2] ** 2)

    def misses(self, at: Polar) -> tuple[np.ndarray, ...]:
        """The energy, and the sine between costates and gradient, three components."""
        g, length = self._gradient(at)
        lam, both = (at.lam_r, at.lam_u, at.lam_v), length * at.size
        across = [(g[i] * lam[j] - g[j] * lam[i]) / both for i, j in ((0, 1), (1, 2), (2, 0))]
        return 0.5 * (at.u**2 + at.v**2) - 1 / at.r - self.energy, *across

    def nearness(self, rows: np.ndarray) -> np.ndarray:
        """Squares of how far rows are from it."""
        off, *across = self.misses(Polar.of(rows))
        return np.asarray(off**2 + sum(x**2 for x in across))

    def holds(self, at: Polar) -> bool:
        """Whether what the misses leave open is as it must be: more energy is what the costates ask for."""
        g, _ = self._gradient(at)
        return bool(g[0] * at.lam_r + g[1] * at.lam_u + g[2] * at.lam_v > 0)


@dataclass(frozen=True)
class ToEnd:
    """From the circle of radius 1, or another state, to an end, the angle about the Sun free or given.

    Unknowns (4): direction of (lam_r, lam_u, lam_v), flight time; with an angle (5): its costate, to which the length
    of these three is 1. Misses: those of the end, of the angle, and of the direction's length.
    """

    sail: Sail
    end: End
    angle: float | None = None  # rad, swept
    begin: PolarState = UNIT_CIRCLE

    free_departure = False

    @property
    def size(self) -> int:
        return 4 if self.angle is None else 5

    @property
    def scale(self) -> float:
        return self.end.scale

    def nearness(self, rows: np.ndarray) -> np.ndarray:
        """Squares of how far rows are from the end."""
        return self.end.nearness(rows)

    def starts(self, unknowns: np.ndarray) -> np.ndarray:
        """(n, 12) from (n, 4 or 5)."""
        r, u, v = self.begin
        lam_r, lam_u, lam_v = direction(unknowns)[0].T
        lam_angle = 0.0 if self.angle is None else unknowns[:, ANOMALY]
        return cartesian(r, 0.0, u, v, lam_r, (lam_angle + lam_u * v - lam_v * u) / r, lam_u, lam_v)

    def misses(self, unknowns: np.ndarray, tolerance: float, smoothing: float = 0.0) -> np.ndarray:
        """(n, 4 or more) from (n, 4 or 5); NaN where a flight fails."""
        at = Polar.of(fly(self, unknowns, tolerance, smoothing))
        return np.stack([*self.end.misses(at), *self.off_angle(at), direction(unknowns)[1] - 1], axis=1)

    def off_angle(self, at: Polar) -> tuple[np.ndarray, ...]:
        """How far from the angle, to whole turns, where one is given."""
        return () if self.angle is None else (np.mod(at.azimuth - self.angle + np.pi, TURN) - np.pi,)
