"""Bodies that a flight leaves or meets where they are at a date: planets, and small bodies by elements of one epoch.

Heliocentric, ecliptic of J2000. A small body moves as Kepler has it from the epoch of its elements on; what the planets
pull in between is left out, 1e-4 to 1e-3 au in some years, much more after a close passage.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
import numpy.typing as npt

from sailviz import ephemeris
from sailviz.constants import DAY, MU_SUN
from sailviz.elements import Elements, state
from sailviz.sky.places import tdb_ahead

SPREAD = 3000.0  # s between positions that are differenced: rounding 1e-12, neglected terms 1e-14 of the speed
J2000_JD = 2_451_545.0

States = tuple[np.ndarray, np.ndarray]


class MovingBody(Protocol):
    """What has a name and a state at every moment."""

    @property
    def name(self) -> str: ...
    def state(self, epoch: np.datetime64, time: npt.ArrayLike) -> States:
        """Position m and velocity m/s, each (n, 3), at times (n,) s after the epoch (UTC)."""


@dataclass(frozen=True)
class Planet:
    """One of `ephemeris.PLANETS`. source : as in `ephemeris.planet_position`."""

    name: str
    source: str = "mean-elements"

    def state(self, epoch: np.datetime64, time: npt.ArrayLike) -> States:
        return planet_state(self.name, epoch, time, self.source)


@dataclass(frozen=True)
class SmallBodyOrbit:
    """A body on a fixed ellipse. elements: their true anomaly does not count; mean_anomaly rad at `date`, JD TDB.

    ValueError for an orbit that is open: of a hyperbola no mean anomaly brings the body back, and a flight that meets
    it is not searched for.
    """

    name: str
    elements: Elements[float]
    mean_anomaly: float
    date: float

    def __post_init__(self) -> None:
        e = self.elements
        angles = [e.inclination, e.raan, e.argument, self.mean_anomaly, self.date]
        if not (0 <= e.eccentricity < 1 and 0 < e.semi_major_axis < np.inf and np.isfinite(angles).all()):
            raise ValueError(
                f"{self.name} moves on no ellipse, its eccentricity is {e.eccentricity:g}: flights are searched for to "
                "bodies that come back"
            )

    def state(self, epoch: np.datetime64, time: npt.ArrayLike) -> States:
        now = ephemeris.seconds_since_j2000(epoch) + tdb_ahead(epoch) + np.atleast_1d(np.asarray(time, dtype=float))
        e = self.elements
        rate = np.sqrt(MU_SUN / e.semi_major_axis**3)
        mean = self.mean_anomaly + rate * (now - (self.date - J2000_JD) * DAY)
        anomaly = ephemeris.true_anomaly(mean, e.eccentricity)
        return state(e.semi_major_axis, e.eccentricity, e.inclination, e.raan, e.argument, anomaly, MU_SUN)


def planet_state(name: str, epoch: np.datetime64, time: npt.ArrayLike, source: str = "mean-elements") -> States:
    """Heliocentric position m and velocity m/s, each (n, 3), ecliptic of J2000, at times (n,) s after the epoch.

    The velocity is the difference quotient of fourth order of `ephemeris.planet_position`, so that both belong
    together.
    """
    time = np.atleast_1d(np.asarray(time, dtype=float))
    around = (time + SPREAD * np.arange(-2.0, 3.0)[:, None]).ravel()
    places = ephemeris.planet_position(name, epoch, around, source).reshape(5, len(time), 3)
    far_before, before, here, after, far_after = places
    return here, (far_before - 8 * before + 8 * after - far_after) / (12 * SPREAD)
