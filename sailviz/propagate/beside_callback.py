"""A device that pushes beside the first one of a craft: a force with numbers, an attitude and times of its own.

Accelerations add and so do mass flows; all push the one mass. Each is a callback among the forces of `dynamics.model`.
Its numbers: the places named below, then the times s from which each thrust factor holds, then the factors.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from sailviz.compiled import STATE, called, entry, inlined
from sailviz.environment import sky
from sailviz.propagate.callbacks import Callback, callback
from sailviz.propagate.force_callback import growth
from sailviz.propagate.parameters import PARAMETERS, array_at, record_at
from sailviz.propagate.sky_callback import in_wind, sunlit_share
from sailviz.propulsion.devices import ELECTRIC_SAIL, SOLAR_SAIL
from sailviz.propulsion.electric_sail import esail_force
from sailviz.propulsion.solar_sail import sail_force
from sailviz.propulsion.thruster import thruster_force
from sailviz.steering import attitude, by_light

# places of the numbers: a kind of propulsion.devices, whether there is a sky, a kind of steering.attitude (CALLED: in
# the frame of the light), its direction's three components, whether that frame counts from the orbit's axis, up to four
# parameters of the device, the mass kg at which a sail has its strength (0: it stays), how many factors there are
KIND, UNDER_SKY, STEERING, DIRECTION, BY_ORBIT, DEVICE, MASS, ROWS, TIMES = 0, 1, 2, 3, 6, 7, 11, 12, 13


def numbers(
    kind: int,
    parameters: Sequence[float],
    steering: int,
    direction: Sequence[float],
    by_orbit: bool,
    under_sky: bool,
    mass: float,
    times: np.ndarray,
    factors: np.ndarray,
) -> np.ndarray:
    """The numbers (n,) of one device. mass : kg, at which a sail that pushes with a force has its strength, else 0;
    times (k,) s, increasing, the first not after the start, factors (k,)."""
    found = np.zeros(TIMES)
    found[KIND], found[UNDER_SKY], found[STEERING], found[BY_ORBIT], found[MASS], found[ROWS] = (
        kind, under_sky, steering, by_orbit, mass, len(times),
    )  # fmt: skip
    found[DIRECTION : DIRECTION + len(direction)] = direction
    found[DEVICE : DEVICE + len(parameters)] = parameters
    whole: np.ndarray = np.concatenate([found, times, factors])
    return whole


@inlined
def factor_at(t, own):
    """The thrust factor at t s: that of the last time not after it."""
    rows = int(own[ROWS])
    low, high = 0, rows
    while high - low > 1:
        middle = (low + high) // 2
        if own[TIMES + middle] <= t:
            low = middle
        else:
            high = middle
    return own[TIMES + rows + low]


@inlined
def normal_of(x, y, z, vx, vy, vz, inverse, ux, uy, uz, p, own):
    """The unit vector that a device's steering asks for. u : from the light, inverse : 1 / |position|."""
    kind = int(own[STEERING])
    a, b, c = own[DIRECTION], own[DIRECTION + 1], own[DIRECTION + 2]
    rx, ry, rz = x * inverse, y * inverse, z * inverse
    if kind == attitude.INERTIAL:
        return a, b, c
    if kind == attitude.TANGENTIAL:
        k = 1.0 / np.sqrt(vx * vx + vy * vy + vz * vz)
        return vx * k, vy * k, vz * k
    if kind == attitude.ORBITAL:
        return attitude.orbital_direction(rx, ry, rz, x, y, z, vx, vy, vz, a, b, c)
    if kind == attitude.TRANSVERSE:
        return attitude.orbital_direction(rx, ry, rz, x, y, z, vx, vy, vz, 0.0, 1.0, 0.0)
    if kind == attitude.MERIDIAN:
        return attitude.meridian_direction(rx, ry, rz, a, b, c)
    if kind == attitude.CALLED:
        q = p.by_light
        law = by_light.Parameters(
            by_light.FRAME, a, b, c, q.pole_x, q.pole_y, q.pole_z, int(own[BY_ORBIT]), 0, 0.0, 0.0
        )
        return by_light.frame_direction(ux, uy, uz, x, y, z, vx, vy, vz, law)
    if own[KIND] == SOLAR_SAIL or own[KIND] == ELECTRIC_SAIL:
        return ux, uy, uz
    return rx, ry, rz


@called
def push(t, x, y, z, vx, vy, vz, m, p, tables, own):
    """(acceleration m/s2, mass flow kg/s, unit vector that it is steered by, thrust factor) of one device."""
    inverse = 1.0 / np.sqrt(x * x + y * y + z * z)
    ux, uy, uz, near = x * inverse, y * inverse, z * inverse, inverse
    if own[UNDER_SKY] != 0.0:
        sky.set_to(t, p.places.sky, p.sky, tables)
        ux, uy, uz, near = sky.from_light(x, y, z, p.places.sky, tables)
    nx, ny, nz = normal_of(x, y, z, vx, vy, vz, inverse, ux, uy, uz, p, own)
    factor, kind = factor_at(t, own), int(own[KIND])
    ax, ay, az, flow = 0.0, 0.0, 0.0, 0.0
    if factor != 0.0:
        d0, d1, d2, d3 = own[DEVICE], own[DEVICE + 1], own[DEVICE + 2], own[DEVICE + 3]
        c = ux * nx + uy * ny + uz * nz
        if kind == SOLAR_SAIL:
            share = factor * growth(own[MASS], m)
            if own[UNDER_SKY] != 0.0:
                share = share * sunlit_share(x, y, z, p, tables)
            if share > 0.0:
                ax, ay, az = sail_force(ux, uy, uz, near, nx, ny, nz, c, share * d0, d1, d2, d3)
        elif kind == ELECTRIC_SAIL:
            share = factor * growth(own[MASS], m)
            if own[UNDER_SKY] != 0.0:
                share = share * in_wind(x, y, z, p, tables)
            if share > 0.0:
                ax, ay, az = esail_force(ux, uy, uz, near, nx, ny, nz, c, share * d0, int(d1), d2)
        else:
            ax, ay, az, flow = thruster_force(nx, ny, nz, m, factor * d0, d1, d2)
    return ax, ay, az, flow, nx, ny, nz, factor


def _beside(time, state, parameters, own, number, out):
    """Acceleration and mass flow of one device."""
    p = record_at(parameters, PARAMETERS)
    y, tables, a = array_at(state, STATE), array_at(p.places.address, p.places.end), array_at(out, 4)
    mine = array_at(own, p.places.end)
    ax, ay, az, flow, _, _, _, _ = push(time, y[0], y[1], y[2], y[3], y[4], y[5], y[6], p, tables, mine)
    a[0], a[1], a[2], a[3] = ax, ay, az, flow


def beside(own: np.ndarray) -> Callback:
    """A device beside the first one, for `dynamics.model`. own : its `numbers`."""
    return callback(_beside, own.tolist())


def observe_beside(
    time: np.ndarray, states: np.ndarray, parameters: np.ndarray, own: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """What one device did at given states: its normal (n, 3), acceleration (n, 3) m/s2 and thrust factor (n,). time
    (n,), states (7, n)."""
    n = len(time)
    normal, acceleration, factor = np.zeros((n, 3)), np.zeros((n, 3)), np.zeros(n)
    _observe(time, states, parameters, own, normal, acceleration, factor)
    return normal, acceleration, factor


@entry("d1 d2 r1 d1 D2 D2 D1", PARAMETERS)
def _observe(time, states, parameters, own, normal, acceleration, factor):
    """`observe_beside` into zeros."""
    p = parameters[0]
    tables = array_at(p.places.address, p.places.end)
    for i in range(len(time)):
        x, y, z, vx, vy, vz = states[0, i], states[1, i], states[2, i], states[3, i], states[4, i], states[5, i]
        ax, ay, az, _, nx, ny, nz, factor[i] = push(time[i], x, y, z, vx, vy, vz, states[6, i], p, tables, own)
        normal[i, 0], normal[i, 1], normal[i, 2] = nx, ny, nz
        acceleration[i, 0], acceleration[i, 1], acceleration[i, 2] = ax, ay, az
    return 0
