"""The wheel of an electric sail as a body in flight: its force, and the drift of its spin, whose logarithm the state
carries in its seventh place, where other crafts have their mass.

A device's callback: compiled when the first scene needs it. Its numbers: `p.wheel`. What a row shows of a wheel is
observed here too.
"""

from __future__ import annotations

import numpy as np

from sailviz.compiled import STATE, called, entry
from sailviz.propagate.callbacks import Callback, callback
from sailviz.propagate.dynamics import direction
from sailviz.propagate.parameters import PARAMETERS, array_at, record_at
from sailviz.propagate.quantity_callback import (
    MODULATION,
    PITCH,
    SPIN_RATE,
    THRUST_LOST,
    WHEEL_TORQUE,
    of_craft,
    of_state,
)
from sailviz.propulsion.esail_wheel import wheel_parts

SPIN, SHARE, TORQUE, LOST, COLUMNS = 0, 1, 2, 3, 4  # of `observe_wheel`


@called
def wheel_at(x, y, z, vx, vy, vz, drift, nx, ny, nz, factor, p):
    """(force over N sigma L at 1 au, three; spin rad/s; size of the voltage's share; torque of the bend N m; share of
    the thrust that the voltage costs; rate of the drift 1/s) at a place, a velocity and a normal."""
    wheel = p.wheel
    r2 = x * x + y * y + z * z
    inverse = 1.0 / np.sqrt(r2)
    ux, uy, uz = x * inverse, y * inverse, z * inverse
    c = ux * nx + uy * ny + uz * nz
    if c < 0.0:  # a wheel has no front: its axis is the one downwind
        c, nx, ny, nz = -c, -nx, -ny, -nz
    hx, hy, hz = (y * vz - z * vy) / r2, (z * vx - x * vz) / r2, (x * vy - y * vx) / r2
    turn_x, turn_y, turn_z = hy * nz - hz * ny, hz * nx - hx * nz, hx * ny - hy * nx
    spin = wheel.spin / max(c, 1e-12) * np.exp(drift)
    blows = factor * inverse
    fx, fy, fz, torque, share = wheel_parts(ux, uy, uz, nx, ny, nz, turn_x, turn_y, turn_z, blows, spin, wheel)
    a, b = 1.0 - 0.5 * wheel.cosine, (0.5 * wheel.cosine - wheel.sine) * c
    whole = np.sqrt(a * a + b * b + 2.0 * a * b * c)
    lost = 1.0 - np.sqrt(fx * fx + fy * fy + fz * fz) / whole
    along = vx * ux + vy * uy + vz * uz
    drifts = 0.0
    if wheel.spin != 0.0:
        drifts = ((vx - along * ux) * nx + (vy - along * uy) * ny + (vz - along * uz) * nz) * inverse / max(c, 1e-12)
    return fx, fy, fz, spin, share, torque * wheel.lever * blows, lost, drifts


def _thrust(time, state, parameters, own, number, out):
    """Acceleration, m/s2, and the rate at which the logarithm of the spin drifts, 1/s."""
    p = record_at(parameters, PARAMETERS)
    y, a = array_at(state, STATE), array_at(out, 4)
    fx, fy, fz, _, _, _, _, drifts = wheel_at(
        y[0], y[1], y[2], y[3], y[4], y[5], y[6], y[7], y[8], y[9], number, p
    )  # fmt: skip
    k = number * p.wheel.strength / np.sqrt(y[0] * y[0] + y[1] * y[1] + y[2] * y[2])
    a[0], a[1], a[2], a[3] = k * fx, k * fy, k * fz, drifts


def wheel_thrust() -> Callback:
    """A wheel that is bent or spins."""
    return callback(_thrust)


@called
def of_wheel(number, t, x, y, z, vx, vy, vz, m, factor, p):
    """(value, its size) of a quantity of OF_WHEEL."""
    inverse = 1.0 / np.sqrt(x * x + y * y + z * z)
    nx, ny, nz, _, throttle = direction(t, x, y, z, vx, vy, vz, m, x * inverse, y * inverse, z * inverse, p)
    factor = factor * throttle
    if factor <= 0.0 and number != SPIN_RATE:
        return 0.0, 1.0
    _, _, _, spin, share, torque, lost, _ = wheel_at(x, y, z, vx, vy, vz, m, nx, ny, nz, max(factor, 1e-12), p)
    if number == SPIN_RATE:
        return spin, spin
    if number == MODULATION:
        return share, 1.0
    if number == WHEEL_TORQUE:
        return torque, torque
    return lost, 1.0


def _alone(time, state, parameters, own, number, out):
    p, y, found = record_at(parameters, PARAMETERS), array_at(state, STATE), array_at(out, 4)
    value, size = of_wheel(number, time, y[0], y[1], y[2], y[3], y[4], y[5], y[6], y[7], p)
    found[0], found[1], found[2], found[3] = value, size, 0.0, 0.0


def _of_wheel(time, state, parameters, own, number, out):
    p, y, found = record_at(parameters, PARAMETERS), array_at(state, STATE), array_at(out, 4)
    if number in (SPIN_RATE, MODULATION, THRUST_LOST, WHEEL_TORQUE):
        value, size = of_wheel(number, time, y[0], y[1], y[2], y[3], y[4], y[5], y[6], y[7], p)
    elif number < PITCH:
        value, size = of_state(number, time, y[0], y[1], y[2], y[3], y[4], y[5], y[6], y[7], p)
    else:
        value, size = of_craft(number, time, y[0], y[1], y[2], y[3], y[4], y[5], y[6], y[7], p)
    found[0], found[1], found[2], found[3] = value, size, 0.0, 0.0


def wheel_quantities(alone: bool) -> Callback:
    """Whatever is watched where a quantity of a wheel is, for `dynamics.model`. alone : nothing else is watched, for
    which far less has to be compiled."""
    return callback(_alone if alone else _of_wheel)


def observe_wheel(time: np.ndarray, states: np.ndarray, factor: np.ndarray, parameters: np.ndarray) -> np.ndarray:
    """What rows show of a wheel: (COLUMNS, n) spin rad/s, share of the voltage, torque of its bend N m, share of the
    thrust that the voltage costs. time (n,) s, states (7, n), their last the drift, factor (n,) of the thrust."""
    out = np.zeros((COLUMNS, len(time)))
    _observe(time, states, factor, parameters, out)
    return out


@entry("d1 d2 d1 r1 D2", PARAMETERS)
def _observe(time, states, factor, parameters, out):
    """`observe_wheel` into zeros."""
    p = parameters[0]
    for i in range(len(time)):
        x, y, z, vx, vy, vz = states[0, i], states[1, i], states[2, i], states[3, i], states[4, i], states[5, i]
        m, f = states[6, i], factor[i]
        out[SPIN, i], _ = of_wheel(SPIN_RATE, time[i], x, y, z, vx, vy, vz, m, f, p)
        out[SHARE, i], _ = of_wheel(MODULATION, time[i], x, y, z, vx, vy, vz, m, f, p)
        out[TORQUE, i], _ = of_wheel(WHEEL_TORQUE, time[i], x, y, z, vx, vy, vz, m, f, p)
        out[LOST, i], _ = of_wheel(THRUST_LOST, time[i], x, y, z, vx, vy, vz, m, f, p)
    return 0
