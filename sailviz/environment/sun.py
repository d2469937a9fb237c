"""Where the Sun stands as seen from the Earth, in compiled code: its direction, and the local time below a craft."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from sailviz import ephemeris
from sailviz.compiled import inlined
from sailviz.constants import DAY, YEAR


class Parameters(NamedTuple):
    """Where the Sun is in time; rad and rad/s."""

    mean_longitude: float
    longitude_rate: float
    mean_anomaly: float
    anomaly_rate: float
    centre_1: float  # terms of the equation of the centre, of sin g and of sin 2g; 0 for a Sun that moves evenly
    centre_2: float
    cos_obliquity: float
    sin_obliquity: float
    obliquity_rate: float


def sun_parameters(epoch: np.datetime64 | None = None, right_ascension: float = 0.0) -> Parameters:
    """What `direction`, `mean_right_ascension` and `local_time` read.

    epoch : np.datetime64 of t = 0, for the formulae of `ephemeris.sun_position` (0.01 deg, 1950-2050). Without one the
    Sun moves evenly on the ecliptic, once in 365.25 d, from the given right ascension (rad) of the mean Sun on.
    """
    obliquity = np.radians(ephemeris.SUN_OBLIQUITY)
    if epoch is None:
        tilt = (np.cos(obliquity[0]), np.sin(obliquity[0]), 0.0)
        return Parameters(*(float(x) for x in (right_ascension, 2 * np.pi / YEAR, 0.0, 0.0, 0.0, 0.0, *tilt)))
    days = ephemeris.days_since_j2000(epoch)
    longitude, anomaly = np.radians(ephemeris.SUN_MEAN_LONGITUDE), np.radians(ephemeris.SUN_MEAN_ANOMALY)
    angles = (v for at_j2000, rate in (longitude, anomaly) for v in (_turn(at_j2000 + rate * days), rate / DAY))
    now = obliquity[0] + obliquity[1] * days
    tilt = (np.cos(now), np.sin(now), obliquity[1] / DAY)
    return Parameters(*(float(x) for x in (*angles, *np.radians(ephemeris.SUN_CENTRE), *tilt)))


def date_of(right_ascension: float) -> np.datetime64:
    """UTC of a moment of the year 2000 at which the mean Sun has a right ascension (rad): the season that it stands
    for."""
    at_j2000, rate = np.radians(ephemeris.SUN_MEAN_LONGITUDE)
    days = float(_turn(right_ascension - at_j2000)) / rate
    return np.datetime64("2000-01-01T12:00:00", "s") + np.timedelta64(round(days * DAY), "s")


def _turn(angle):
    return np.remainder(angle, 2 * np.pi)


@inlined
def direction(t, p):
    """Unit vector to the Sun, equator of date (without an epoch: the start's), at t s after the start. p : Parameters.
    The obliquity's drift, 1e-2 arcsec a week, enters in first order."""
    longitude = p.mean_longitude + p.longitude_rate * t
    if p.centre_1 != 0.0:
        g = p.mean_anomaly + p.anomaly_rate * t
        s = np.sin(g)
        longitude += s * (p.centre_1 + 2.0 * p.centre_2 * np.cos(g))  # sin 2g = 2 sin g cos g
    drift = p.obliquity_rate * t
    c, s = p.cos_obliquity, p.sin_obliquity
    y = np.sin(longitude)
    return np.cos(longitude), (c - s * drift) * y, (s + c * drift) * y


@inlined
def mean_right_ascension(t, p):
    """Right ascension, rad, of the mean Sun, which is the Sun's mean longitude; any number of turns."""
    return p.mean_longitude + p.longitude_rate * t


@inlined
def local_time(t, x, y, p):
    """Mean local solar time, rad, below the place (x, y): 0 at midnight, pi at noon; any number of turns."""
    return np.arctan2(y, x) - mean_right_ascension(t, p) + np.pi
