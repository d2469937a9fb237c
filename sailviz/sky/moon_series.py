"""The Moon by the main terms of a series, offline: the same on every machine.

Source: J. Meeus, Astronomical Algorithms, 2nd ed. (1998), chapter 47, after the theory ELP-2000/82 of M.
Chapront-Touzé and J. Chapront: 60 terms for longitude and distance, 60 for latitude. Against JPL's DE421, 2026-2044:
27 km at most, 6.7 km in the mean square.
"""

from __future__ import annotations

from functools import cache

import numpy as np
from numpy.typing import ArrayLike

from sailviz.shipped import shipped_folder

Array = np.ndarray
# (47.1)-(47.5): deg, and deg per Julian century to the powers 1, 2, 3, 4
MEAN_LONGITUDE = (218.3164477, 481267.88123421, -0.0015786, 1 / 538_841, -1 / 65_194_000)
ELONGATION = (297.8501921, 445267.1114034, -0.0018819, 1 / 545_868, -1 / 113_065_000)
SUN_ANOMALY = (357.5291092, 35999.0502909, -0.0001536, 1 / 24_490_000)
MOON_ANOMALY = (134.9633964, 477198.8675055, 0.0087414, 1 / 69_699, -1 / 14_712_000)
LATITUDE_ARGUMENT = (93.2720950, 483202.0175233, -0.0036539, -1 / 3_526_000, 1 / 863_310_000)
VENUS, JUPITER, FLATTENING = (119.75, 131.849), (53.09, 479264.290), (313.45, 481266.484)  # A1, A2, A3
ECCENTRICITY = (1.0, -0.002516, -0.0000074)  # of the Earth's orbit over that of J2000, (47.6)
MEAN_DISTANCE = 385_000_560.0  # m


@cache
def _terms() -> tuple[Array, Array]:
    """(60, 6) multiples of D, M, M', F, then longitude 1e-6 deg and distance m; (60, 5) the same and latitude."""
    lines = (shipped_folder("assets") / "moon_series.csv").read_text(encoding="utf-8").splitlines()
    rows = [line.split(",") for line in lines if line[0] in "LB"]
    far = np.array([row[1:] for row in rows if row[0] == "LR"], float)
    high = np.array([row[1:6] for row in rows if row[0] == "B"], float)
    return far, high


def _angle(coefficients: tuple[float, ...], centuries: Array) -> Array:
    found: Array = np.radians(np.remainder(np.polynomial.polynomial.polyval(centuries, coefficients), 360.0))
    return found


def moon_of_date(centuries: ArrayLike) -> tuple[Array, Array, Array]:
    """(longitude rad, latitude rad, distance m), each (n,), from the Earth: ecliptic and mean equinox of date, at
    Julian centuries (n,) of TT since J2000."""
    t = np.atleast_1d(np.asarray(centuries, float))
    longitude, d, m, mp, f = (
        _angle(row, t) for row in (MEAN_LONGITUDE, ELONGATION, SUN_ANOMALY, MOON_ANOMALY, LATITUDE_ARGUMENT)
    )
    a1, a2, a3 = (_angle(row, t) for row in (VENUS, JUPITER, FLATTENING))
    e = np.polynomial.polynomial.polyval(t, ECCENTRICITY)
    arguments = np.stack([d, m, mp, f])

    far, high = _terms()
    angle, weight = far[:, :4] @ arguments, e ** np.abs(far[:, 1:2])
    sum_l = far[:, 4] @ (weight * np.sin(angle))
    sum_r = far[:, 5] @ (weight * np.cos(angle))
    angle, weight = high[:, :4] @ arguments, e ** np.abs(high[:, 1:2])
    sum_b = high[:, 4] @ (weight * np.sin(angle))
    sum_l = sum_l + 3958 * np.sin(a1) + 1962 * np.sin(longitude - f) + 318 * np.sin(a2)
    sum_b = sum_b - 2235 * np.sin(longitude) + 382 * np.sin(a3) + 175 * (np.sin(a1 - f) + np.sin(a1 + f))
    sum_b = sum_b + 127 * np.sin(longitude - mp) - 115 * np.sin(longitude + mp)
    return longitude + np.radians(sum_l * 1e-6), np.radians(sum_b * 1e-6), MEAN_DISTANCE + sum_r
