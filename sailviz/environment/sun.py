"""Where the Sun stands as seen from the Earth, in compiled code: its direction, and the local time below a craft."""

from __future__ import annotations

import numpy as np

from sailviz import ephemeris
from sailviz.compiled import inlined
from sailviz.constants import DAY, YEAR

PARAMETERS = 9  # mean longitude and its rate, mean anomaly and its rate, two terms of the centre, the obliquity


def sun_parameters(epoch=None, right_ascension=0.0):
    """What `direction`, `mean_right_ascension` and `local_time` read, a tuple of PARAMETERS numbers (rad, rad/s).

    epoch : np.datetime64 of t = 0, for the formulae of `ephemeris.sun_position` (0.01 deg, 1950-2050). Without one the
    Sun moves evenly on the ecliptic, once in 365.25 d, from the given right ascension (rad) of the mean Sun on.
    """
    obliquity = np.radians(ephemeris.SUN_OBLIQUITY)
    if epoch is None:
        tilt = (np.cos(obliquity[0]), np.sin(obliquity[0]), 0.0)
        return tuple(float(x) for x in (right_ascension, 2 * np.pi / YEAR, 0.0, 0.0, 0.0, 0.0, *tilt))
    days = ephemeris.days_since_j2000(epoch)
    longitude, anomaly = np.radians(ephemeris.SUN_MEAN_LONGITUDE), np.radians(ephemeris.SUN_MEAN_ANOMALY)
    angles = (v for at_j2000, rate in (longitude, anomaly) for v in (_turn(at_j2000 + rate * days), rate / DAY))
    now = obliquity[0] + obliquity[1] * days
    tilt = (np.cos(now), np.sin(now), obliquity[1] / DAY)
    return tuple(float(x) for x in (*angles, *np.radians(ephemeris.SUN_CENTRE), *tilt))


def _turn(angle):
    return np.remainder(angle, 2 * np.pi)


@inlined
def direction(t, p, at):
    """Unit vector to the Sun, equator of date (without an epoch: the start's), at t s after the start; the parameters
    begin at p[at]. The obliquity's drift, 1e-2 arcsec a week, enters in first order."""
    longitude = p[at] + p[at + 1] * t
    if p[at + 4] != 0.0:
        g = p[at + 2] + p[at + 3] * t
        s = np.sin(g)
        longitude += s * (p[at + 4] + 2.0 * p[at + 5] * np.cos(g))  # sin 2g = 2 sin g cos g
    drift = p[at + 8] * t
    y = np.sin(longitude)
    return np.cos(longitude), (p[at + 6] - p[at + 7] * drift) * y, (p[at + 7] + p[at + 6] * drift) * y


@inlined
def mean_right_ascension(t, p, at):
    """Right ascension, rad, of the mean Sun, which is the Sun's mean longitude; any number of turns."""
    return p[at] + p[at + 1] * t


@inlined
def local_time(t, x, y, p, at):
    """Mean local solar time, rad, below the place (x, y): 0 at midnight, pi at noon; any number of turns."""
    return np.arctan2(y, x) - (p[at] + p[at + 1] * t) + np.pi
