"""The one right-hand side: state -> its derivative, for every device, steering law and environment.

State y (7,): position m, velocity m/s, mass kg. A Model is integers that choose branches and one flat row of
parameters, tables and addresses of a user's compiled functions (row.py); it costs nothing against specialised code and
is compiled once for all.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from sailviz.compiled import called, compiled, inlined
from sailviz.environment.atmosphere import air_drag
from sailviz.environment.gravity import gravity
from sailviz.environment.ionosphere import exponential
from sailviz.propagate.callbacks import plugged, user_vector
from sailviz.propagate.parameters import (
    AIR,
    AIR_TABLE,
    BRAKE,
    CONTROL,
    CONTROL_LAW,
    CONTROL_TABLE,
    DEVICE,
    EXPONENTIAL_AIR,
    FLUX,
    HEIGHT,
    INTERPOLATION,
    J2_STRENGTH,
    LOW_ORBIT,
    MU,
    PLASMA,
    PLASMA_TABLE,
    PRIMER_KIND,
    PRIMER_LAW,
    PRIMER_MU,
    ROTATION,
    ROWS,
    SHADOW,
    STEER_AS,
    STEERING,
    SUN,
    SURFACE_RADIUS,
    TABLE,
    THIRD_BODY,
    USER_FORCE,
    USER_STEERING,
    ZONAL,
)
from sailviz.propulsion.devices import ELECTRIC_SAIL, NO_DEVICE, PLASMA_BRAKE, SOLAR_SAIL, THRUSTER  # noqa: F401
from sailviz.propulsion.electric_sail import esail_force
from sailviz.propulsion.solar_sail import sail_force
from sailviz.propulsion.thruster import thruster_force
from sailviz.steering import attitude as law

SIZE = 7  # of the state


class Model(NamedTuple):
    """What acts on the craft. Built by `model`."""

    device: int
    steering: int
    parameters: np.ndarray  # (TABLE + 7 k,), the k rows of the steering table from TABLE on


def model(
    mu,
    *,
    device=NO_DEVICE,
    device_parameters=(),
    steering=law.RADIAL,
    steering_parameters=(),
    steer_as=(),
    interpolation=law.LINEAR,
    table=None,
    j2_strength=0.0,
    zonal=(),
    surface_radius=0.0,
    rotation=0.0,
    third_body=(),
    sun=(),
    flux=(),
    shadow=0,
    height=0,
    air=(),
    air_table=None,
    plasma=(),
    plasma_table=None,
    brake=(),
    low_orbit=0,
    primer_law=0,
    primer_kind=0,
    control=0,
    control_table=None,
    control_law=None,
    user_steering=0,
    user_force=0,
) -> Model:
    """A Model from its parts. mu m3/s2, j2_strength m5/s2, surface_radius m, rotation rad/s about +z; table (k, 7) of
    `steering.table`; air_table, plasma_table of the environment's modules; the other tuples are the places of row.py
    in order."""
    row = np.zeros(TABLE)
    row[MU], row[J2_STRENGTH], row[SURFACE_RADIUS], row[ROTATION] = mu, j2_strength, surface_radius, rotation
    parts = ((STEERING, steering_parameters), (DEVICE, device_parameters), (PLASMA, plasma), (THIRD_BODY, third_body))
    parts += ((STEER_AS, steer_as), (ZONAL, zonal), (SUN, sun), (FLUX, flux), (AIR, air), (BRAKE, brake))
    for start, values in parts:
        row[start : start + len(values)] = values
    row[USER_STEERING], row[USER_FORCE], row[INTERPOLATION] = user_steering, user_force, interpolation
    row[SHADOW], row[HEIGHT], row[LOW_ORBIT] = shadow, height, low_orbit
    row[PRIMER_LAW], row[PRIMER_KIND], row[PRIMER_MU], row[CONTROL] = primer_law, primer_kind, mu, control
    if table is not None:
        row[ROWS] = len(table)
        row = np.concatenate([row, np.asarray(table, dtype=float).ravel()])
    tables = ((AIR_TABLE, air_table), (PLASMA_TABLE, plasma_table), (CONTROL_TABLE, control_table))
    for place, values in (*tables, (CONTROL_LAW, control_law)):
        if values is not None:
            row[place] = len(row)
            row = np.concatenate([row, np.ravel(values)])
    return Model(int(device), int(steering), row)


@inlined
def direction(t, x, y, z, vx, vy, vz, m, ux, uy, uz, model):
    """Unit vector n that the steering law asks for, inertial; its component along u = r_hat; the throttle.

    That component is known to the laws that count from the Sun line before n is, which shortens the longest chain of
    dependent operations in a step.
    """
    p = model.parameters
    kind = model.steering
    if kind == law.ORBITAL:
        n_r, n_t, n_h = p[STEERING], p[STEERING + 1], p[STEERING + 2]
        nx, ny, nz = law.orbital_direction(ux, uy, uz, x, y, z, vx, vy, vz, n_r, n_t, n_h)
        return nx, ny, nz, n_r, 1.0
    if kind == law.RADIAL:
        return ux, uy, uz, 1.0, 1.0
    if kind == law.MERIDIAN:
        nx, ny, nz = law.meridian_direction(ux, uy, uz, p[STEERING], p[STEERING + 1], p[STEERING + 2])
        return nx, ny, nz, p[STEERING], 1.0
    if kind == law.TRANSVERSE:
        nx, ny, nz = law.orbital_direction(ux, uy, uz, x, y, z, vx, vy, vz, 0.0, 1.0, 0.0)
        return nx, ny, nz, 0.0, 1.0
    if kind == law.TABLE_ORBITAL or kind == law.TABLE_MERIDIAN:
        alpha, delta, throttle = law.table_row(t, p, TABLE, int(p[ROWS]), p[INTERPOLATION])
        n_r, n_t, n_h = np.cos(alpha), np.sin(alpha) * np.sin(delta), np.sin(alpha) * np.cos(delta)
        if kind == law.TABLE_MERIDIAN:
            nx, ny, nz = law.meridian_direction(ux, uy, uz, n_r, n_t, n_h)
        else:
            nx, ny, nz = law.orbital_direction(ux, uy, uz, x, y, z, vx, vy, vz, n_r, n_t, n_h)
        return nx, ny, nz, n_r, throttle
    on = 1.0
    if kind == law.INERTIAL:
        nx, ny, nz = p[STEERING], p[STEERING + 1], p[STEERING + 2]
    elif kind == law.TANGENTIAL:
        inverse = 1.0 / np.sqrt(vx * vx + vy * vy + vz * vz)
        nx, ny, nz = vx * inverse, vy * inverse, vz * inverse
    elif kind == law.USER:
        nx, ny, nz = user_vector(int(p[USER_STEERING]), t, x, y, z, vx, vy, vz, m)
    else:
        nx, ny, nz, on = plugged(int(p[PRIMER_LAW]), t, x, y, z, vx, vy, vz, m, p, 1.0)
    return nx, ny, nz, ux * nx + uy * ny + uz * nz, on


@inlined
def device_acceleration(t, x, y, z, vx, vy, vz, m, inverse, factor, model):
    """Acceleration of the device, m/s2 inertial, and m_dot, kg/s. factor multiplies both, and so does the throttle of
    the steering law; inverse = 1 / |position|. Not of a plasma brake."""
    p = model.parameters
    ux, uy, uz = x * inverse, y * inverse, z * inverse
    nx, ny, nz, c, throttle = direction(t, x, y, z, vx, vy, vz, m, ux, uy, uz, model)
    factor = factor * throttle
    kind = model.device
    if kind == SOLAR_SAIL:
        ax, ay, az = sail_force(
            ux, uy, uz, inverse, nx, ny, nz, c, factor * p[DEVICE], p[DEVICE + 1], p[DEVICE + 2], p[DEVICE + 3]
        )
        return ax, ay, az, 0.0
    if kind == ELECTRIC_SAIL:
        ac, kind_of_sail, limit = factor * p[DEVICE], int(p[DEVICE + 1]), p[DEVICE + 2]
        ax, ay, az = esail_force(ux, uy, uz, inverse, nx, ny, nz, c, ac, kind_of_sail, limit)
        return ax, ay, az, 0.0
    return thruster_force(nx, ny, nz, m, factor * p[DEVICE], p[DEVICE + 1], p[DEVICE + 2])


@inlined
def third_body_gravity(t, x, y, z, p):
    """Pull of a body on a circular orbit in the x-y plane, m/s2, the central body held fixed: the fall of the
    central body towards the other, mu' / R'^2, is neglected (3e-6 of the Sun's pull for the Earth)."""
    angle = p[THIRD_BODY + 3] + p[THIRD_BODY + 2] * t
    dx, dy = p[THIRD_BODY + 1] * np.cos(angle) - x, p[THIRD_BODY + 1] * np.sin(angle) - y
    d2 = dx * dx + dy * dy + z * z
    k = p[THIRD_BODY] / (d2 * np.sqrt(d2))
    return k * dx, k * dy, -k * z


@inlined
def exponential_air_drag(x, y, z, vx, vy, vz, m, r, p):
    """Drag of an exponential atmosphere, m/s2."""
    density = exponential(r, p[AIR + 2], p[AIR + 3], p[AIR + 4])
    return air_drag(x, y, z, vx, vy, vz, p[ROTATION], density * p[AIR + 1] / m)


@called
def derivative(t, y, factor, model, out):
    """out (7,) = dy/dt: (2.1)-(2.3). factor multiplies the device's thrust; 0 is off."""
    p = model.parameters
    x, yy, z, vx, vy, vz, m = y[0], y[1], y[2], y[3], y[4], y[5], y[6]
    inverse = 1.0 / np.sqrt(x * x + yy * yy + z * z)
    ax, ay, az = gravity(x, yy, z, inverse, p[MU], p[J2_STRENGTH], p[ZONAL], p[ZONAL + 1])
    m_dot = 0.0
    if p[THIRD_BODY] != 0.0:
        bx, by, bz = third_body_gravity(t, x, yy, z, p)
        ax, ay, az = ax + bx, ay + by, az + bz
    if p[AIR] == EXPONENTIAL_AIR:
        bx, by, bz = exponential_air_drag(x, yy, z, vx, vy, vz, m, 1.0 / inverse, p)
        ax, ay, az = ax + bx, ay + by, az + bz
    if p[LOW_ORBIT] != 0.0:
        bx, by, bz, _ = plugged(int(p[LOW_ORBIT]), t, x, yy, z, vx, vy, vz, m, p, factor)
        ax, ay, az = ax + bx, ay + by, az + bz
    if factor != 0.0 and model.device != NO_DEVICE and model.device != PLASMA_BRAKE:
        bx, by, bz, m_dot = device_acceleration(t, x, yy, z, vx, vy, vz, m, inverse, factor, model)
        ax, ay, az = ax + bx, ay + by, az + bz
    if p[USER_FORCE] != 0.0:
        bx, by, bz = user_vector(int(p[USER_FORCE]), t, x, yy, z, vx, vy, vz, m)
        ax, ay, az = ax + bx, ay + by, az + bz
    out[0], out[1], out[2], out[3], out[4], out[5], out[6] = vx, vy, vz, ax, ay, az, m_dot


@compiled
def observe(time, states, factor, model):
    """What the craft did at given states. time (n,), states (7, n), factor (n,) -> normal (n, 3), acceleration of
    device (but not a plasma brake) and user force together (n, 3) m/s2, throttle of the steering law (n,)."""
    n = len(time)
    p = model.parameters
    normal, acceleration, on = np.zeros((n, 3)), np.zeros((n, 3)), np.ones(n)
    for i in range(n):
        t, x, y, z = time[i], states[0, i], states[1, i], states[2, i]
        vx, vy, vz, m = states[3, i], states[4, i], states[5, i], states[6, i]
        r = np.sqrt(x * x + y * y + z * z)
        nx, ny, nz, _, on[i] = direction(t, x, y, z, vx, vy, vz, m, x / r, y / r, z / r, model)
        ax, ay, az = 0.0, 0.0, 0.0
        if factor[i] != 0.0 and model.device != NO_DEVICE and model.device != PLASMA_BRAKE:
            ax, ay, az, _ = device_acceleration(t, x, y, z, vx, vy, vz, m, 1.0 / r, factor[i], model)
        if p[USER_FORCE] != 0.0:
            bx, by, bz = user_vector(int(p[USER_FORCE]), t, x, y, z, vx, vy, vz, m)
            ax, ay, az = ax + bx, ay + by, az + bz
        normal[i, 0], normal[i, 1], normal[i, 2] = nx, ny, nz
        acceleration[i, 0], acceleration[i, 1], acceleration[i, 2] = ax, ay, az
    return normal, acceleration, on
