"""Where a direct flight begins and what it must reach: casadi expressions in units of mu = 1 and one au.

What moves along a Kepler orbit is told by its eccentric anomaly as an unknown, with Kepler's equation as a condition:
nothing is iterated inside the problem. Components that an end leaves free have no condition; their costates vanish by
themselves.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from sailviz.design.direct.frames_of_state import Axes, Planar
from sailviz.design.minimum_time.kepler_orbit import KeplerOrbit

if TYPE_CHECKING:
    import casadi as ca


@dataclass(frozen=True)
class Unknown:
    """A number that is found along with the flight: its bounds and where the search begins."""

    low: float
    high: float
    guess: float


def _along(orbit: KeplerOrbit, anomaly: ca.SX) -> list[ca.SX]:
    """State (6) at an eccentric anomaly."""
    from sailviz.design.direct.extra import casadi

    ca = casadi()
    a, e = orbit.semi_major_axis, orbit.e
    c, s = ca.cos(anomaly), ca.sin(anomaly)
    b, speed = np.sqrt(1 - e * e), a**-0.5 / (1 - e * c)
    place = [a * ((c - e) * orbit.P[i] + b * s * orbit.Q[i]) for i in range(3)]
    return place + [speed * (b * c * orbit.Q[i] - s * orbit.P[i]) for i in range(3)]


def eccentric_anomaly(mean: float, e: float) -> float:
    """E of Kepler's equation M = E - e sin E, e < 1, to rounding: Newton within bounds that close in."""
    low, high = mean - e, mean + e
    found = mean + 0.85 * e * np.sign(np.sin(mean))
    for _ in range(100):
        miss = found - e * np.sin(found) - mean
        low, high = (found, high) if miss < 0 else (low, found)
        following = found - miss / (1 - e * np.cos(found))
        if not low <= following <= high:
            following = 0.5 * (low + high)
        if abs(following - found) <= 4e-16 * max(1.0, abs(mean)):
            return float(following)
        found = following
    return float(found)


@dataclass(frozen=True)
class Body:
    """A body on its Kepler orbit; mean_anomaly rad at the problem's epoch."""

    orbit: KeplerOrbit
    mean_anomaly: float

    def mean(self, time: float) -> float:
        """Mean anomaly at a time after the epoch."""
        return float(self.mean_anomaly + time * self.orbit.semi_major_axis**-1.5)

    def state(self, time: float) -> np.ndarray:
        """(6,) at a time after the epoch."""
        anomaly = eccentric_anomaly(self.mean(time), self.orbit.e)
        nu = 2 * np.arctan2(
            np.sqrt(1 + self.orbit.e) * np.sin(anomaly / 2), np.sqrt(1 - self.orbit.e) * np.cos(anomaly / 2)
        )
        return np.concatenate(self.orbit.state(nu))


# ---------------------------------------------------------------- starts


@dataclass(frozen=True)
class FromState:
    """From a given state, of the axes' kind, at the epoch."""

    state_given: tuple[float, ...]

    def unknowns(self) -> list[Unknown]:
        return []

    def moment(self, p: list[ca.SX]) -> float | ca.SX:
        """When, after the epoch."""
        return 0.0

    def state(self, p: list[ca.SX]) -> list[float | ca.SX]:
        return list(self.state_given)

    def conditions(self, p: list[ca.SX]) -> list[ca.SX]:
        return []


@dataclass(frozen=True)
class FromOrbit:
    """From anywhere on an orbit in space; guess : the eccentric anomaly where the search begins."""

    orbit: KeplerOrbit
    guess: float = 0.0

    def unknowns(self) -> list[Unknown]:
        return [Unknown(self.guess - 2 * np.pi, self.guess + 2 * np.pi, self.guess)]

    def moment(self, p: list[ca.SX]) -> float | ca.SX:
        return 0.0

    def state(self, p: list[ca.SX]) -> list[ca.SX]:
        return _along(self.orbit, p[0])

    def conditions(self, p: list[ca.SX]) -> list[ca.SX]:
        return []


@dataclass(frozen=True)
class FromBody:
    """With a body's velocity from its place, some time from first to last after the epoch; guess : when the search
    begins."""

    body: Body
    first: float
    last: float
    guess: float

    def unknowns(self) -> list[Unknown]:
        anomaly = eccentric_anomaly(self.body.mean(self.guess), self.body.orbit.e)
        return [Unknown(self.first, self.last, self.guess), Unknown(-np.inf, np.inf, anomaly)]

    def moment(self, p: list[ca.SX]) -> float | ca.SX:
        return p[0]

    def state(self, p: list[ca.SX]) -> list[ca.SX]:
        return _along(self.body.orbit, p[1])

    def conditions(self, p: list[ca.SX]) -> list[ca.SX]:
        return [_kepler(self.body, p[0], p[1])]


def _kepler(body: Body, time: ca.SX, anomaly: ca.SX) -> ca.SX:
    from sailviz.design.direct.extra import casadi

    rate = body.orbit.semi_major_axis**-1.5
    return anomaly - body.orbit.e * casadi().sin(anomaly) - body.mean_anomaly - rate * time


Start = FromState | FromOrbit | FromBody

# ---------------------------------------------------------------- ends


@dataclass(frozen=True)
class ToCircle:
    """Onto a circle in the plane; angle : swept on the way, rad, or None where that is free."""

    radius: float
    angle: float | None = None

    def unknowns(self) -> list[Unknown]:
        return []

    def conditions(self, axes: Axes, x: ca.SX, moment: ca.SX, p: list[ca.SX]) -> list[ca.SX]:
        if not isinstance(axes, Planar):
            raise ValueError("a circle in the plane is reached by a flight in the plane")
        found = [x[0] / self.radius - 1, x[2], x[3] - self.radius**-0.5]
        return found if self.angle is None else [*found, x[1] - self.angle]


@dataclass(frozen=True)
class ToState:
    """To a state of the plane: radius, radial and transverse speed, and the angle swept on the way, rad, or None."""

    radius: float
    radial: float
    transverse: float
    angle: float | None = None

    def unknowns(self) -> list[Unknown]:
        return []

    def conditions(self, axes: Axes, x: ca.SX, moment: ca.SX, p: list[ca.SX]) -> list[ca.SX]:
        found = [x[0] / self.radius - 1, x[2] - self.radial, x[3] - self.transverse]
        return found if self.angle is None else [*found, x[1] - self.angle]


@dataclass(frozen=True)
class ToRadius:
    """To a distance from the Sun, whatever the velocity there; angle : swept in the plane, rad, or None."""

    radius: float
    angle: float | None = None

    def unknowns(self) -> list[Unknown]:
        return []

    def conditions(self, axes: Axes, x: ca.SX, moment: ca.SX, p: list[ca.SX]) -> list[ca.SX]:
        found = [axes.radius(x) / self.radius - 1]
        return found if self.angle is None else [*found, x[1] - self.angle]


@dataclass(frozen=True)
class ToEscape:
    """To an energy: what is left of the speed far from the Sun, 0 just escapes; angle : swept in the plane, rad, or
    None."""

    excess: float
    angle: float | None = None

    def unknowns(self) -> list[Unknown]:
        return []

    def conditions(self, axes: Axes, x: ca.SX, moment: ca.SX, p: list[ca.SX]) -> list[ca.SX]:
        found = [axes.speed2(x) - 2 / axes.radius(x) - self.excess**2]
        return found if self.angle is None else [*found, x[1] - self.angle]


@dataclass(frozen=True)
class ToOrbit:
    """Onto an orbit in space, anywhere; guess : the eccentric anomaly where the search begins."""

    orbit: KeplerOrbit
    guess: float = 0.0

    def unknowns(self) -> list[Unknown]:
        return [Unknown(self.guess - 4 * np.pi, self.guess + 4 * np.pi, self.guess)]

    def conditions(self, axes: Axes, x: ca.SX, moment: ca.SX, p: list[ca.SX]) -> list[ca.SX]:
        return [x[i] - y for i, y in enumerate(_along(self.orbit, p[0]))]


@dataclass(frozen=True)
class ToBody:
    """To a body where it is then, with its velocity, or past it (flyby); guess : the time of arrival after the epoch
    at which the search begins."""

    body: Body
    guess: float
    flyby: bool = False

    def unknowns(self) -> list[Unknown]:
        return [Unknown(-np.inf, np.inf, eccentric_anomaly(self.body.mean(self.guess), self.body.orbit.e))]

    def conditions(self, axes: Axes, x: ca.SX, moment: ca.SX, p: list[ca.SX]) -> list[ca.SX]:
        there = _along(self.body.orbit, p[0])[: 3 if self.flyby else 6]
        return [x[i] - y for i, y in enumerate(there)] + [_kepler(self.body, moment, p[0])]


End = ToCircle | ToState | ToRadius | ToEscape | ToOrbit | ToBody
