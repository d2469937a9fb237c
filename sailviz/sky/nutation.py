"""The true equator: how nutation tilts the mean one of date, and the frame TEME in which SGP4 speaks.

Source: IAU 1980 theory of nutation (P. K. Seidelmann, Celest. Mech. 27, 79, 1982), its terms of 1e-3 arcsec and more;
arguments from the same place. What is left out sums to 0.01 arcsec at most.
"""

from __future__ import annotations

import numpy as np

from sailviz import frames

Array = np.ndarray
_ARCSECOND = np.pi / 180 / 3600
# multiples of l, l', F, D, node; 1e-4 arcsec on the sine in longitude, with its change a century, and on the cosine in
# obliquity, likewise
_TERMS = np.array(
    [
        (0, 0, 0, 0, 1, -171996, -174.2, 92025, 8.9), (0, 0, 2, -2, 2, -13187, -1.6, 5736, -3.1),
        (0, 0, 2, 0, 2, -2274, -0.2, 977, -0.5), (0, 0, 0, 0, 2, 2062, 0.2, -895, 0.5),
        (0, 1, 0, 0, 0, 1426, -3.4, 54, -0.1), (1, 0, 0, 0, 0, 712, 0.1, -7, 0),
        (0, 1, 2, -2, 2, -517, 1.2, 224, -0.6), (0, 0, 2, 0, 1, -386, -0.4, 200, 0),
        (1, 0, 2, 0, 2, -301, 0, 129, -0.1), (0, -1, 2, -2, 2, 217, -0.5, -95, 0.3),
        (1, 0, 0, -2, 0, -158, 0, -1, 0), (0, 0, 2, -2, 1, 129, 0.1, -70, 0),
        (-1, 0, 2, 0, 2, 123, 0, -53, 0), (1, 0, 0, 0, 1, 63, 0.1, -33, 0),
        (0, 0, 0, 2, 0, 63, 0, -2, 0), (-1, 0, 2, 2, 2, -59, 0, 26, 0),
        (-1, 0, 0, 0, 1, -58, -0.1, 32, 0), (1, 0, 2, 0, 1, -51, 0, 27, 0),
        (2, 0, 0, -2, 0, 48, 0, 1, 0), (-2, 0, 2, 0, 1, 46, 0, -24, 0),
        (0, 0, 2, 2, 2, -38, 0, 16, 0), (2, 0, 2, 0, 2, -31, 0, 13, 0),
        (2, 0, 0, 0, 0, 29, 0, -1, 0), (1, 0, 2, -2, 2, 29, 0, -12, 0),
        (0, 0, 2, 0, 0, 26, 0, -1, 0), (0, 0, 2, -2, 0, -22, 0, 0, 0),
        (-1, 0, 2, 0, 1, 21, 0, -10, 0), (0, 2, 0, 0, 0, 17, -0.1, 0, 0),
        (0, 2, 2, -2, 2, -16, 0.1, 7, 0), (-1, 0, 0, 2, 1, 16, 0, -8, 0),
        (0, 1, 0, 0, 1, -15, 0, 9, 0), (1, 0, 0, -2, 1, -13, 0, 7, 0),
        (0, -1, 0, 0, 1, -12, 0, 6, 0), (2, 0, -2, 0, 0, 11, 0, 0, 0),
        (-1, 0, 2, 2, 1, -10, 0, 5, 0),
    ]
)  # fmt: skip
_DEGREES = (134.96298139, 357.52772333, 93.27191028, 297.85036306, 125.04452222)  # of the arguments at J2000
_PER_CENTURY = (477198.8673981, 35999.0503400, 483202.0175381, 445267.1114800, -1934.1362608)
_SQUARES = (0.0086972, -0.0001603, -0.0036825, -0.0019142, 0.0020708)


def angles(centuries: float) -> tuple[float, float]:
    """Nutation (in longitude, in obliquity), rad, at Julian centuries of TT after J2000."""
    t = centuries
    place = np.radians(np.array(_DEGREES) + t * (np.array(_PER_CENTURY) + t * np.array(_SQUARES)))
    argument = _TERMS[:, :5] @ place
    longitude = np.sum((_TERMS[:, 5] + t * _TERMS[:, 6]) * np.sin(argument))
    obliquity = np.sum((_TERMS[:, 7] + t * _TERMS[:, 8]) * np.cos(argument))
    return float(1e-4 * _ARCSECOND * longitude), float(1e-4 * _ARCSECOND * obliquity)


def mean_to_true(centuries: float) -> Array:
    """R (3, 3) that takes vectors of the mean equator and equinox of date to the true ones."""
    longitude, more = angles(centuries)
    mean = float(frames.obliquity_of_date(centuries))
    found: Array = frames.turn_x(-mean - more) @ frames.turn_z(-longitude) @ frames.turn_x(mean)
    return found


def teme_to_mean(centuries: float) -> Array:
    """R (3, 3) that takes vectors of TEME, the true equator with the mean equinox of date, to the mean equator and
    equinox of date."""
    longitude, _ = angles(centuries)
    along_equator = longitude * np.cos(float(frames.obliquity_of_date(centuries)))
    found: Array = mean_to_true(centuries).T @ frames.turn_z(-along_equator)
    return found
