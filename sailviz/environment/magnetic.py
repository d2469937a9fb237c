"""The Earth's magnetic field as a tilted dipole that turns with the planet: enough for the direction a tether meets."""

from __future__ import annotations

import numpy as np

from sailviz.compiled import inlined
from sailviz.constants import DIPOLE_EARTH, RADIUS_GEOMAGNETIC

_G11, _H11, _G10 = DIPOLE_EARTH


@inlined
def field(x, y, z, inverse, greenwich):
    """Magnetic field, T, inertial with z along the pole. Position m, inverse = 1 / |position| in 1/m, greenwich the
    right ascension of the Greenwich meridian, rad.

    B = (R/r)^3 (3 (g.r_hat) r_hat - g). Against the whole IGRF-14 of 2025 at 700 km: direction 8 deg off on average,
    34 deg at most (Gulf of Guinea), strength 0.7 to 1.7 times the true one. Source: IGRF-14, degree 1.
    """
    c, s = np.cos(greenwich), np.sin(greenwich)
    gx, gy, gz = c * _G11 - s * _H11, s * _G11 + c * _H11, _G10
    ux, uy, uz = x * inverse, y * inverse, z * inverse
    along = 3.0 * (gx * ux + gy * uy + gz * uz)
    k = (RADIUS_GEOMAGNETIC * inverse) ** 3
    return k * (along * ux - gx), k * (along * uy - gy), k * (along * uz - gz)


@inlined
def alignment(x, y, z, inverse, greenwich, tx, ty, tz):
    """cos^2 of the angle between the field and a tether along the unit vector t, as the magnetic knob
    1 - q cos^2 asks; the other arguments as in `field`."""
    bx, by, bz = field(x, y, z, inverse, greenwich)
    along = bx * tx + by * ty + bz * tz
    return along * along / (bx * bx + by * by + bz * bz)
