"""Thrust of the electric solar wind sail in its four published models.

Source: thesis, section 3.3, (3.33)-(3.48), read in excerpt; polynomial coefficients from its table 3.2.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from sailviz.compiled import entry, inlined
from sailviz.constants import AU, VACUUM_PERMITTIVITY, WIND_POTENTIAL, WIND_PRESSURE
from sailviz.propulsion.rows import as_rows

FINAL, ORIGINAL, UPDATED, POLYNOMIAL = 0, 1, 2, 3
MODELS = {"final": FINAL, "original": ORIGINAL, "updated": UPDATED, "polynomial": POLYNOMIAL}

CONE_MAX = np.arcsin(1 / 3)  # 19.4712 deg, the final model's largest cone angle, from (3.44)
PITCH_AT_CONE_MAX = np.arccos(1 / np.sqrt(3))  # 54.7356 deg
PITCH_LIMIT = np.radians(60.0)  # of the original and updated models: the thesis trusts them to 60-70 deg


class Parameters(NamedTuple):
    """An electric sail in compiled code."""

    characteristic_acceleration: float  # m/s2
    model: float  # of MODELS
    pitch_limit: float  # rad


@inlined
def esail_force(ux, uy, uz, inverse, nx, ny, nz, c, ac, model, pitch_limit):
    """Acceleration of an E-sail. u = r_hat, inverse = 1/r in 1/m, c = u . n, ac in m/s2 at 1 au. A sail plane has no
    front: n and -n are the same.

    NaN beyond the pitch limit of the original and updated models, which do not describe the sail there.
    """
    along_wind, along_normal = esail_parts(c, ac, model, pitch_limit)
    near = AU * inverse
    fall = near if model != ORIGINAL else near ** (7.0 / 6.0)  # (3.33), (3.35), (3.39)
    along_wind, along_normal = fall * along_wind, fall * along_normal
    return (
        along_wind * ux + along_normal * nx,
        along_wind * uy + along_normal * ny,
        along_wind * uz + along_normal * nz,
    )


@inlined
def esail_parts(c, ac, model, pitch_limit):
    """What `esail_force` has along the wind and along the normal at 1 au, m/s2."""
    if model == FINAL:
        return 0.5 * ac, 0.5 * ac * c  # (3.39)
    side = 1.0
    if c < 0.0:
        side, c = -1.0, -c
    s = np.sqrt(max(0.0, (1.0 - c) * (1.0 + c)))
    alpha = np.arctan2(s, c)
    size, slope = ac, 0.5  # of phi at small angles
    if model == POLYNOMIAL:
        d, slope = np.degrees(alpha), 4.853e-1
        # (3.36)-(3.38), table 3.2, angles in degrees; clamped where the fit leaves the physical range
        phi = d * (4.853e-1 + d * (3.652e-3 + d * (-2.661e-4 + d * (6.322e-6 + d * (-8.295e-8 + d * 3.681e-10)))))
        phi = np.radians(max(phi, 0.0))
        gamma = 1.0 + d * (
            6.904e-5 + d * (-1.271e-4 + d * (7.027e-7 + d * (-1.261e-8 + d * (1.943e-10 + d * -5.896e-13))))
        )
        size = ac * min(gamma, 1.0)
    else:
        phi = 0.5 * alpha  # (3.34)
        if alpha > pitch_limit * (1.0 + 1e-12):
            size = np.nan
    across = size * (np.sin(phi) / s if s > 0.0 else slope)  # of the part of the normal across the wind
    return size * np.cos(phi) - across * c, side * across


@entry("d2 d2 d i d D2")
def _accelerations(position, normal, ac, model, pitch_limit, out):
    for i in range(len(position)):
        x, y, z = position[i, 0], position[i, 1], position[i, 2]
        nx, ny, nz = normal[i, 0], normal[i, 1], normal[i, 2]
        r = np.sqrt(x * x + y * y + z * z)
        out[i, 0], out[i, 1], out[i, 2] = esail_force(
            x / r, y / r, z / r, 1 / r, nx, ny, nz, (x * nx + y * ny + z * nz) / r, ac, model, pitch_limit
        )
    return 0


def acceleration(
    position: npt.ArrayLike,
    normal: npt.ArrayLike,
    characteristic_acceleration: float,
    model: str = "final",
    on: bool = True,
    pitch_limit: float = PITCH_LIMIT,
) -> np.ndarray:
    """Acceleration of an E-sail, m/s2, (3,) or (n, 3) as the input.

    position : (..., 3) m from the Sun. normal : (..., 3) unit vector of the sail plane, either side.
    characteristic_acceleration : m/s2 at 1 au facing the Sun. model : "final", "original", "updated", "polynomial".
    on : bool, the switch tau. pitch_limit : rad; the original and updated models give NaN beyond it.
    Source: (3.39) final, (3.33)-(3.34) original, (3.35) updated, (3.36)-(3.38) polynomial.
    """
    (position, normal), shape = as_rows(position, normal)
    if not on:
        return np.zeros(shape)
    out = np.empty_like(position)
    _accelerations(position, normal, characteristic_acceleration, MODELS[model], pitch_limit, out)
    return out.reshape(shape)


def dimensionless_acceleration(pitch: npt.ArrayLike) -> np.ndarray:
    """gamma = |a| / (a_c r_E / r) of the final model at a pitch in rad, same shape: (3.43)."""
    return np.sqrt(1 + 3 * np.cos(pitch) ** 2) / 2


def cone_angle(pitch: npt.ArrayLike) -> np.ndarray:
    """Cone angle phi in rad of the final model at a pitch in rad, same sign and shape: (3.44).

    Evaluated as atan2(sin alpha cos alpha, 1 + cos^2 alpha), the same angle without acos' loss of digits near zero.
    """
    c, s = np.cos(pitch), np.sin(pitch)
    return np.arctan2(s * c, 1 + c * c)


def pitch_angle(cone: npt.ArrayLike) -> np.ndarray:
    """The smaller pitch (larger thrust) of the final model that gives a cone angle, rad, same sign and shape: (3.46).

    NaN beyond CONE_MAX = asin(1/3). The thesis' acos form loses half the digits near zero; this is the smaller root
    of the same quadratic in T = tan(alpha): tan(phi) T^2 - T + 2 tan(phi) = 0.
    """
    t = np.tan(np.asarray(cone, dtype=float))
    room = 1 - 8 * t * t
    room = np.where((room < 0) & (room > -1e-12), 0.0, room)
    with np.errstate(invalid="ignore"):
        return np.arctan(4 * t / (1 + np.sqrt(room)))


def characteristic_acceleration(
    tethers: npt.ArrayLike,
    length: npt.ArrayLike,
    voltage: npt.ArrayLike,
    mass: npt.ArrayLike,
    pressure: npt.ArrayLike = WIND_PRESSURE,
    wind_potential: npt.ArrayLike = WIND_POTENTIAL,
) -> np.ndarray:
    """a_c in m/s2 from hardware: number of tethers, length m of each, voltage V, total mass kg, dynamic pressure Pa
    at 1 au, wind_potential V. Source: (3.40) a_c = N L sigma / m, (3.41) sigma = 0.18 max(0, V - V_w) sqrt(eps0 p).
    Scalars or arrays, broadcast; NaN where the mass is not positive."""
    sigma = (
        0.18
        * np.maximum(0.0, np.subtract(voltage, wind_potential))
        * np.sqrt(np.multiply(VACUUM_PERMITTIVITY, pressure))
    )
    mass = np.asarray(mass, dtype=float)
    return np.multiply(tethers, length) * sigma / np.where(mass > 0, mass, np.nan)
