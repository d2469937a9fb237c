"""Bodies that a flight leaves or meets where they are at a date: planets, and small bodies by elements of one epoch.

Heliocentric, ecliptic of J2000. A small body moves as Kepler has it from the epoch of its elements on; what the planets
pull in between is left out, 1e-4 to 1e-3 au in some years, much more after a close passage.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from functools import lru_cache
from typing import Protocol

import numpy as np
import numpy.typing as npt

from sailviz import ephemeris
from sailviz.constants import DAY, MU_SUN
from sailviz.elements import Elements
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
        passed = _begin(epoch) + tdb_ahead(epoch) - (self.date - J2000_JD) * DAY
        e = self.elements
        shape = e.semi_major_axis, e.eccentricity, e.inclination, e.raan, e.argument
        rate = float(np.sqrt(MU_SUN / e.semi_major_axis**3))
        changes = (0.0, 0.0, 0.0, 0.0, 0.0, rate)
        return _states(
            ephemeris.ellipse_motion((*shape, self.mean_anomaly + rate * (passed + t)), changes, 1.0)
            for t in np.ravel(time).tolist()
        )


@lru_cache(maxsize=16)
def _begin(epoch: np.datetime64) -> float:
    return ephemeris.seconds_since_j2000(epoch)


def _states(motions: Iterable[tuple[tuple[float, ...], tuple[float, ...]]]) -> States:
    found = np.array(list(motions)).reshape(-1, 2, 3)
    return found[:, 0], found[:, 1]


def planet_state(name: str, epoch: np.datetime64, time: npt.ArrayLike, source: str = "mean-elements") -> States:
    """Heliocentric position m and velocity m/s, each (n, 3), ecliptic of J2000, at times (n,) s after the epoch.

    The velocity is the derivative of `ephemeris.planet_position`, of DE421 its difference quotient of fourth order, so
    that both belong together.
    """
    time = np.atleast_1d(np.asarray(time, dtype=float))
    if source == "mean-elements":
        begin = _begin(epoch)
        return _states(ephemeris.planet_motion(name, begin + t) for t in time.tolist())
    around = (time + SPREAD * np.arange(-2.0, 3.0)[:, None]).ravel()
    places = ephemeris.planet_position(name, epoch, around, source).reshape(5, len(time), 3)
    far_before, before, here, after, far_after = places
    return here, (far_before - 8 * before + 8 * after - far_after) / (12 * SPREAD)
