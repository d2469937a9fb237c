"""Where the planets and the Sun are, offline: mean elements by default, JPL's DE421 with the extra `ephemeris`.

Frames: heliocentric ecliptic of J2000 for planets, geocentric equatorial of date for the Sun.
"""

from __future__ import annotations

from functools import cache
from math import copysign, cos, radians, remainder, sin, sqrt, tau
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from sailviz.constants import AU, DAY, MU_SUN, YEAR
from sailviz.elements import Elements, state
from sailviz.frames import OBLIQUITY

if TYPE_CHECKING:
    from datetime import datetime

    from numpy.typing import ArrayLike

    Epoch = np.datetime64 | datetime | str  # UTC

J2000 = np.datetime64("2000-01-01T12:00:00", "ns")
CENTURY = 36_525 * DAY

# E. M. Standish, "Keplerian elements for approximate positions of the major planets", JPL, table 1 (1800-2050):
# a au, e, i deg, mean longitude deg, longitude of perihelion deg, node deg; below each its rate per Julian century.
# Errors there as Standish gives them: 15-40 arcsec in longitude for the inner planets, up to 600 for Saturn; as
# measured: see planet_position. Earth: Earth-Moon barycentre.
_MEAN = {
    "Mercury": (
        (0.38709927, 0.20563593, 7.00497902, 252.25032350, 77.45779628, 48.33076593),
        (0.00000037, 0.00001906, -0.00594749, 149472.67411175, 0.16047689, -0.12534081),
    ),
    "Venus": (
        (0.72333566, 0.00677672, 3.39467605, 181.97909950, 131.60246718, 76.67984255),
        (0.00000390, -0.00004107, -0.00078890, 58517.81538729, 0.00268329, -0.27769418),
    ),
    "Earth": (
        (1.00000261, 0.01671123, -0.00001531, 100.46457166, 102.93768193, 0.0),
        (0.00000562, -0.00004392, -0.01294668, 35999.37244981, 0.32327364, 0.0),
    ),
    "Mars": (
        (1.52371034, 0.09339410, 1.84969142, -4.55343205, -23.94362959, 49.55953891),
        (0.00001847, 0.00007882, -0.00813131, 19140.30268499, 0.44441088, -0.29257343),
    ),
    "Jupiter": (
        (5.20288700, 0.04838624, 1.30439695, 34.39644051, 14.72847983, 100.47390909),
        (-0.00011607, -0.00013253, -0.00183714, 3034.74612775, 0.21252668, 0.20469106),
    ),
    "Saturn": (
        (9.53667594, 0.05386179, 2.48599187, 49.95424423, 92.59887831, 113.66242448),
        (-0.00125060, -0.00050991, 0.00193609, 1222.49362201, -0.41897216, -0.28867794),
    ),
    "Uranus": (
        (19.18916464, 0.04725744, 0.77263783, 313.23810451, 170.95427630, 74.01692503),
        (-0.00196176, -0.00004397, -0.00242939, 428.48202785, 0.40805281, 0.04240589),
    ),
    "Neptune": (
        (30.06992276, 0.00859048, 1.77004347, -55.12002969, 44.96476227, 131.78422574),
        (0.00026291, 0.00005105, 0.00035372, 218.45945325, -0.32241464, -0.00508664),
    ),
}
PLANETS = tuple(_MEAN)


def seconds_since_j2000(epoch: Epoch) -> float:
    """Seconds from J2000 to an epoch (UTC), days of 86,400 s."""
    moment = np.asarray(epoch, "datetime64[ns]")
    return float((moment - J2000) / np.timedelta64(1, "ns")) * 1e-9


def days_since_j2000(epoch: Epoch) -> float:
    """Days of 86,400 s from J2000 to an epoch (np.datetime64, UTC)."""
    return seconds_since_j2000(epoch) / DAY


def decimal_year(epoch: Epoch) -> float:
    """The epoch as a Julian year, e.g. 2019.96."""
    return 2000.0 + seconds_since_j2000(epoch) / YEAR


def planet_elements(name: str, seconds: ArrayLike) -> tuple[np.ndarray, ...]:
    """(a m, e, i, raan, argument, mean anomaly rad) of a planet, each (n,), at seconds (n,) after J2000."""
    values, rates = (np.array(row) for row in _MEAN[name])
    a, e, i, longitude, perihelion, node = values[:, None] + rates[:, None] * np.atleast_1d(seconds) / CENTURY
    angles = np.radians([i, node, perihelion - node, longitude - perihelion])
    return a * AU, e, *angles


def planet_motion(name: str, seconds: float) -> tuple[tuple[float, float, float], tuple[float, float, float]]:
    """Position m and velocity m/s of a planet as its mean elements move it, at seconds after J2000, its velocity the
    derivative of its position. Of one moment, for searches that ask thousands of times: in 15 us."""
    values, rates = _MEAN[name]
    past = seconds / CENTURY
    a, e, i, longitude, perihelion, node = (value + rate * past for value, rate in zip(values, rates, strict=True))
    da, de, di, dlongitude, dperihelion, dnode = rates
    return ellipse_motion(
        (a * AU, e, *map(radians, (i, node, perihelion - node, longitude - perihelion))),
        (da * AU, de, *map(radians, (di, dnode, dperihelion - dnode, dlongitude - dperihelion))),
        CENTURY,
    )


def ellipse_motion(
    elements: tuple[float, ...], changes: tuple[float, ...], unit: float
) -> tuple[tuple[float, float, float], tuple[float, float, float]]:
    """Position m and velocity m/s where elements - a m, e, i, node, argument, mean anomaly rad - change so much in a
    unit of time, s."""
    a, e, i, node, w, mean = elements
    da, de, di, dnode, dw, dmean = changes
    mean = remainder(mean, tau)
    anomaly = mean + 0.85 * copysign(e, mean)  # as in `eccentric_anomaly`
    for _ in range(60):
        s, c = sin(anomaly), cos(anomaly)
        step = (anomaly - e * s - mean) / (1 - e * c)
        anomaly -= step
        if abs(step) < 1e-14:
            break
    s, c = sin(anomaly), cos(anomaly)
    turning = (dmean + de * s) / (1 - e * c)
    root = sqrt(1 - e * e)
    x, dx = a * (c - e), da * (c - e) - a * (s * turning + de)
    y, dy = a * root * s, (da * root - a * e * de / root) * s + a * root * c * turning
    # x along the node, y ahead of it; each change with what the turn of the axes adds
    sw, cw, si, ci, sn, cn = sin(w), cos(w), sin(i), cos(i), sin(node), cos(node)
    x, y, dx, dy = x * cw - y * sw, x * sw + y * cw, dx * cw - dy * sw, dx * sw + dy * cw
    dx, dy = dx - dw * y, dy + dw * x
    level, upright = y * ci, y * si
    dlevel, dupright = dy * ci - di * upright, dy * si + di * level
    place = x * cn - level * sn, x * sn + level * cn, upright
    dx, dlevel = dx - dnode * level, dlevel + dnode * x
    return place, ((dx * cn - dlevel * sn) / unit, (dx * sn + dlevel * cn) / unit, dupright / unit)


def eccentric_anomaly(mean: np.ndarray, e: np.ndarray | float) -> np.ndarray:
    """Eccentric anomaly (n,) rad, within half a turn of 0, of a mean anomaly (n,) rad on an ellipse.

    Kepler's equation by Newton from Danby's start, M + 0.85 e sign(sin M), beyond which its left side bends one way
    only; planets need three or four iterations, Halley's comet eight.
    """
    mean = np.remainder(mean + np.pi, 2 * np.pi) - np.pi
    anomaly = mean + 0.85 * np.sign(np.sin(mean)) * e
    for _ in range(60):
        step = (anomaly - e * np.sin(anomaly) - mean) / (1 - e * np.cos(anomaly))
        anomaly = anomaly - step
        if np.abs(step).max() < 1e-14:
            break
    return anomaly


def true_anomaly(mean: np.ndarray, e: np.ndarray | float) -> np.ndarray:
    """True anomaly (n,) rad, within half a turn of 0, of a mean anomaly (n,) rad on an ellipse."""
    half = eccentric_anomaly(mean, e) / 2
    found: np.ndarray = 2 * np.arctan2(np.sqrt(1 + e) * np.sin(half), np.sqrt(1 - e) * np.cos(half))
    return found


def planet_position(name: str, epoch: Epoch, time: ArrayLike, source: str = "mean-elements") -> np.ndarray:
    """Heliocentric position (n, 3) m, ecliptic of J2000, of a planet in PLANETS at times (n,) s after the epoch (UTC).

    source : "mean-elements", off by up to 52, 32, 26, 100, 520, 740, 114 and 60 arcsec from Mercury to Neptune
    (measured against DE421 over 1900-2050; Mars: 100,000 km, in 2026-2036 71,000 km); or "de421", good to kilometres,
    which needs the extra `ephemeris` and times from 1899 to 2053. ModuleNotFoundError without the extra, ValueError
    outside those years. Barycentres of planets with moons.
    """
    if source == "de421":
        return _de421(name, seconds_since_j2000(epoch) + np.asarray(time, dtype=float))
    a, e, i, node, argument, mean = planet_elements(name, seconds_since_j2000(epoch) + np.asarray(time, dtype=float))
    return state(a, e, i, node, argument, true_anomaly(mean, e), MU_SUN)[0]


_DE421_NUMBERS = {"Mercury": 1, "Venus": 2, "Earth": 3, "Mars": 4, "Jupiter": 5, "Saturn": 6, "Uranus": 7, "Neptune": 8}
TT_MINUS_UTC = 69.184  # s, since 2017 and until the next leap second: IERS Bulletin C


@cache
def _kernel() -> Any:
    """JPL's DE421 (W. M. Folkner et al., IPN Progress Report 42-178, 2009), the copy that the package skyfield-data
    carries."""
    from importlib.util import find_spec

    home = find_spec("skyfield_data")
    if home is None or home.origin is None or find_spec("jplephem") is None:
        raise ModuleNotFoundError('the ephemeris DE421 needs the extra "ephemeris": pip install "sailviz[ephemeris]"')
    from jplephem.spk import SPK

    return SPK.open(str(Path(home.origin).parent / "data" / "de421.bsp"))


def _de421(name: str, seconds: np.ndarray) -> np.ndarray:
    """Heliocentric position (n, 3) m, ecliptic of J2000, at seconds (n,) of UTC after J2000."""
    kernel = _kernel()
    days = 2_451_545.0 + (np.atleast_1d(seconds) + TT_MINUS_UTC) / DAY
    planet, sun = kernel[0, _DE421_NUMBERS[name]], kernel[0, 10]
    if days.min() < planet.start_jd or days.max() > planet.end_jd:
        raise ValueError("DE421 reaches from 1899-07-29 to 2053-10-09, and this run goes beyond")
    x, y, z = 1e3 * (planet.compute(days) - sun.compute(days))[:3]
    c, s = np.cos(OBLIQUITY), np.sin(OBLIQUITY)
    return np.column_stack([x, c * y + s * z, c * z - s * y])


def planet_ellipse(name: str, epoch: Epoch | None = None) -> Elements[float]:
    """The planet's orbit as mean elements at the epoch (J2000 without one), scalars; the true anomaly is left 0."""
    seconds = 0.0 if epoch is None else seconds_since_j2000(epoch)
    a, e, i, raan, argument, _ = planet_elements(name, seconds)
    scalars: list[Any] = [*(float(value[0]) for value in (a, e, i, raan, argument)), 0.0]
    return Elements(*scalars)


def planet_orbit(name: str, epoch: Epoch | None = None, points: int = 361) -> np.ndarray:
    """The planet's orbit as a closed curve (points, 3) m, with its elements at the epoch (J2000 without one)."""
    e = planet_ellipse(name, epoch)
    turn = np.linspace(0, 2 * np.pi, points)
    return state(e.semi_major_axis, e.eccentricity, e.inclination, e.raan, e.argument, turn, MU_SUN)[0]


# The Sun of the Astronomical Almanac's low-precision formulae (section C): deg at J2000 and deg per day
SUN_MEAN_LONGITUDE = (280.460, 0.9856474)
SUN_MEAN_ANOMALY = (357.528, 0.9856003)
SUN_OBLIQUITY = (23.439, -0.0000004)
SUN_CENTRE = (1.915, 0.020)  # deg, on sin g and sin 2g


def sun_position(epoch: Epoch, time: ArrayLike) -> np.ndarray:
    """Geocentric position (n, 3) m of the Sun, equator of date, at times (n,) s after the epoch.

    Source: low-precision formulae of the Astronomical Almanac, section C: 0.01 deg between 1950 and 2050.
    """
    n = (seconds_since_j2000(epoch) + np.asarray(time, dtype=float)) / DAY
    g, mean_longitude, obliquity = (
        np.radians(start + rate * n) for start, rate in (SUN_MEAN_ANOMALY, SUN_MEAN_LONGITUDE, SUN_OBLIQUITY)
    )
    first, second = np.radians(SUN_CENTRE)
    longitude = mean_longitude + first * np.sin(g) + second * np.sin(2 * g)
    distance = AU * (1.00014 - 0.01671 * np.cos(g) - 0.00014 * np.cos(2 * g))
    direction = [np.cos(longitude), np.cos(obliquity) * np.sin(longitude), np.sin(obliquity) * np.sin(longitude)]
    found: np.ndarray = (distance * np.array(direction)).T
    return found


def earth_rotation_angle(epoch: Epoch, time: ArrayLike = 0.0) -> np.ndarray:
    """Earth rotation angle, rad in [0, 2 pi), at times (n,) s after the epoch, with UT1 = UTC (below 0.004 deg).

    Source: IAU 2000 resolution B1.8. Counted from the celestial intermediate origin; maps and frames of the equinox
    want `greenwich_sidereal_time`.
    """
    days = seconds_since_j2000(epoch) / DAY + np.asarray(time, dtype=float) / DAY
    return np.remainder(2 * np.pi * (np.remainder(days, 1.0) + 0.7790572732640 + 0.00273781191135448 * days), 2 * np.pi)


def greenwich_sidereal_time(epoch: Epoch, time: ArrayLike = 0.0) -> np.ndarray:
    """Right ascension, rad in [0, 2 pi), of the Greenwich meridian, mean equinox of date, in which `sun_position`
    speaks too, at times (n,) s after the epoch.

    Source: the precession that N. Capitaine et al., Astron. Astrophys. 412, 567 (2003) add to the Earth rotation angle,
    without its terms below 0.1 arcsec in this century.
    """
    centuries = (seconds_since_j2000(epoch) + np.asarray(time, dtype=float)) / CENTURY
    arcseconds = 0.014506 + (4612.156534 + 1.3915817 * centuries) * centuries
    found: np.ndarray = np.remainder(earth_rotation_angle(epoch, time) + np.radians(arcseconds / 3600), 2 * np.pi)
    return found
