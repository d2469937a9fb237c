"""What a craft that turns did at given states: its axes, what pushed it and what turned it."""

from __future__ import annotations

import numpy as np

from sailviz.compiled import entry
from sailviz.propagate.body_control import ANGLE, DEVICE, SHARE, VANE
from sailviz.propagate.body_motion import (
    AIR,
    AVERAGED,
    CONTROLLED,
    HEAD,
    WORK,
    air_loads,
    asked,
    body_of,
    passive_loads,
    point_normal,
    spin_average,
)
from sailviz.propagate.dynamics import environment_forces
from sailviz.propagate.parameters import PARAMETERS, array_at

FORCE, LIGHT_TORQUE, GRAVITY_TORQUE, CONTROL_TORQUE, AIR_FORCE, AIR_TORQUE = 0, 3, 6, 9, 12, 15
AIR_DRAG, AIR_DENSITY, SETTINGS = 18, 19, 20


@entry("d1 d2 d1 r1 D1 D1 D2", PARAMETERS)
def _observe(time, states, factor, parameters, y, rate, out):
    """`observe_body` into zeros; y, rate (SIZE,) : to work in."""
    p = parameters[0]
    b = body_of(p)
    tables = array_at(p.places.address, p.places.end)
    vanes, devices = int(b.vanes), int(b.devices)
    for i in range(len(time)):
        t = time[i]
        for j in range(len(y)):
            y[j] = states[j, i]
        point_normal(y, p, b)
        ax, ay, az, sx, sy, sz = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
        if b.air != 0.0:
            environment_forces(t, y[0], y[1], y[2], y[3], y[4], y[5], y[6], factor[i], p)
            ax, ay, az, sx, sy, sz = air_loads(p)
        r = np.sqrt(y[0] * y[0] + y[1] * y[1] + y[2] * y[2])
        for j in range(3):  # by which a controller knows how its law turns
            rate[3 + j] = -p.gravity.mu / (r * r * r) * y[j]
        if b.motion == AVERAGED:
            fx, fy, fz, tx, ty, tz, dx, dy, dz = spin_average(t, y, factor[i], p, b)
            qx, qy, qz, mx, my, mz = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
        else:
            fx, fy, fz, tx, ty, tz, dx, dy, dz, ux, uy, uz, strength = passive_loads(t, y, factor[i], p, b)
            qx, qy, qz, mx, my, mz = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
            if b.motion == CONTROLLED:
                qx, qy, qz, mx, my, mz = asked(
                    t, y, p, fx + ax, fy + ay, fz + az, tx + dx + sx, ty + dy + sy, tz + dz + sz,
                    ux, uy, uz, strength, rate,
                )  # fmt: skip
        row = out[i]
        row[FORCE], row[FORCE + 1], row[FORCE + 2] = fx + qx, fy + qy, fz + qz
        row[LIGHT_TORQUE], row[LIGHT_TORQUE + 1], row[LIGHT_TORQUE + 2] = tx, ty, tz
        row[GRAVITY_TORQUE], row[GRAVITY_TORQUE + 1], row[GRAVITY_TORQUE + 2] = dx, dy, dz
        row[CONTROL_TORQUE], row[CONTROL_TORQUE + 1], row[CONTROL_TORQUE + 2] = mx, my, mz
        row[AIR_FORCE], row[AIR_FORCE + 1], row[AIR_FORCE + 2] = ax, ay, az
        row[AIR_TORQUE], row[AIR_TORQUE + 1], row[AIR_TORQUE + 2] = sx, sy, sz
        if b.air != 0.0:
            done = p.places.body + WORK + AIR
            row[AIR_DRAG], row[AIR_DENSITY] = tables[done + 6], tables[done + 7]
        first = p.places.body + HEAD
        for k in range(vanes):
            row[SETTINGS + k] = tables[first + VANE * k + ANGLE]
        for k in range(devices):
            row[SETTINGS + vanes + k] = tables[first + VANE * vanes + DEVICE * k + SHARE]
    return 0


def observe_body(
    time: np.ndarray, states: np.ndarray, factor: np.ndarray, parameters: np.ndarray, settings: int
) -> np.ndarray:
    """(n, 20 + settings) at times (n,) s and states (SIZE, n), as named above: force N of light and actuators, torques
    N m, force and torque of the air, along body axes, of an averaged spin inertial; its drag N and density kg/m3;
    angles rad of the vanes and shares that are on of the devices. factor (n,) : of the light's push."""
    out = np.zeros((len(time), SETTINGS + settings))
    y, rate = np.zeros(len(states)), np.zeros(len(states))
    _observe(time, np.ascontiguousarray(states), factor, parameters, y, rate, out)
    return out
