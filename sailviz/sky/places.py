"""Where one body stands as seen from another, at any date, in any frame, from any source.

Geometric places: the light takes 499 s from the Sun to the Earth, and aberration turns it by 20.5 arcsec, which is 1e-4
of its push sideways; both are left out.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from sailviz import calendar, frames
from sailviz.constants import DAY
from sailviz.ephemeris import CENTURY, PLANETS, planet_position, seconds_since_j2000
from sailviz.sky.bodies import BODIES, MOON_SHARE
from sailviz.sky.kernels import kernel
from sailviz.sky.moon_series import moon_of_date

SERIES = "mean-elements"  # the source that needs no file: mean elements of the planets, the Moon's series
TT_AHEAD_OF_TAI = 32.184  # s; TDB differs from TT by 2 ms at most, 60 m of the Earth's way
FIRST_LEAP_SECONDS = 10.0  # s before 1972, when UTC ran otherwise: up to 8 s off back to 1955
ECLIPTIC = frames.icrf_to("ecliptic-j2000")


def tdb_ahead(epoch: np.datetime64) -> float:
    """TDB less UTC, s, on the day of an epoch: 69.184 since 2017."""
    try:
        leap = float(calendar.leap_seconds(epoch.astype("datetime64[D]").item()))
    except calendar.DateError:
        leap = FIRST_LEAP_SECONDS
    return leap + TT_AHEAD_OF_TAI


@dataclass(frozen=True)
class Sky:
    """The sky of a run: it begins at the epoch (UTC), and its vectors are those of a frame of frames.FRAMES.

    source : "mean-elements", "de421" or the path of a kernel. Seconds of a run are seconds of TDB, a leap second on the
    way included.
    """

    epoch: np.datetime64
    frame: str = "ecliptic-j2000"
    source: str = SERIES

    @property
    def centuries(self) -> float:
        """Julian centuries of TT from J2000 to the epoch."""
        return (seconds_since_j2000(self.epoch) + tdb_ahead(self.epoch)) / CENTURY

    @property
    def axes(self) -> np.ndarray:
        """R_icrf_to_frame (3, 3)."""
        return frames.icrf_to(self.frame, self.centuries)

    def position(self, name: str, centre: str, time: ArrayLike) -> np.ndarray:
        """Of a body of BODIES as seen from another (n, 3) m, at times (n,) s after the epoch.

        ValueError for a body or a date that the source does not reach, ModuleNotFoundError without the extra.
        """
        t = np.atleast_1d(np.asarray(time, float))
        seen: np.ndarray = (self._icrf(name, t) - self._icrf(centre, t)) @ self.axes.T
        return seen

    def _icrf(self, name: str, time: np.ndarray) -> np.ndarray:
        """(n, 3) m, ICRF, from an origin that is the source's own."""
        if self.source == SERIES:
            return self._by_series(name, time)
        days = (seconds_since_j2000(self.epoch) + tdb_ahead(self.epoch)) / DAY + time / DAY
        return kernel(self.source).position(BODIES[name].number, days)

    def _by_series(self, name: str, time: np.ndarray) -> np.ndarray:
        """The same by mean elements and the Moon's series, from the Sun."""
        if name == "sun":
            return np.zeros((len(time), 3))
        planet = name.capitalize() if name.capitalize() in PLANETS else "Earth"
        found: np.ndarray = planet_position(planet, self.epoch, time) @ ECLIPTIC
        if name in ("earth", "moon"):  # the mean elements are those of the barycentre, up to 4700 km off
            share = -MOON_SHARE if name == "earth" else 1.0 - MOON_SHARE
            found = found + share * self._moon(time)
        return found

    def _moon(self, time: np.ndarray) -> np.ndarray:
        """From the Earth (n, 3) m, ICRF, by the series."""
        centuries = self.centuries + time / CENTURY
        longitude, latitude, distance = moon_of_date(centuries)
        flat = distance * np.cos(latitude)
        of_date = np.column_stack([flat * np.cos(longitude), flat * np.sin(longitude), distance * np.sin(latitude)])
        return frames.from_frame(frames.ecliptic_of_date_to_icrf(centuries), of_date)
