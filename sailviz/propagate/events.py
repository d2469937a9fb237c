"""What can happen along a trajectory: functions of the state whose sign changes are looked for, and what follows."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from sailviz.compiled import inlined
from sailviz.constants import J2_EARTH, RADIUS_EARTH

RADIUS, APSIS, ENERGY, NODE, AXIS, MEAN_AXIS = range(6)
NOISE = 1e-9  # of distance, energy or r v: 7 mm in a low orbit, 150 m at 1 au; what rounding and the first steps err by
OBLATENESS_EARTH = J2_EARTH * RADIUS_EARTH**2  # m2
RECORD, STOP, END_OF_USE = range(3)


class Watch(NamedTuple):
    """The events of one propagation, k of them; all arrays (k,)."""

    kind: np.ndarray  # int64: RADIUS, APSIS, ENERGY, NODE, AXIS, MEAN_AXIS
    level: np.ndarray  # float64: distance from the centre in m for RADIUS, semi-major axis in m, else unused
    sense: np.ndarray  # int64: +1 rising only, -1 falling only, 0 both
    action: np.ndarray  # int64: RECORD, STOP the propagation, END_OF_USE of the device from here on


def watch(rows) -> Watch:
    """A Watch from (kind, level, sense, action) tuples."""
    rows = list(rows)
    kind, level, sense, action = zip(*rows, strict=True) if rows else ((), (), (), ())
    return Watch(
        np.array(kind, dtype=np.int64),
        np.array(level, dtype=float),
        np.array(sense, dtype=np.int64),
        np.array(action, dtype=np.int64),
    )


@inlined
def measure(kind, level, y, mu):
    """The function whose zero is the event, for a state y (8,)."""
    x, yy, z, vx, vy, vz = y[0], y[1], y[2], y[3], y[4], y[5]
    if kind == APSIS:
        return x * vx + yy * vy + z * vz  # rising at periapsis, falling at apoapsis
    if kind == NODE:
        return z
    r = np.sqrt(x * x + yy * yy + z * z)
    if kind == ENERGY:
        return 0.5 * (vx * vx + vy * vy + vz * vz) - mu / r
    if kind == RADIUS:
        return r - level
    v2 = vx * vx + vy * vy + vz * vz
    a = 1.0 / (2.0 / r - v2 / mu)
    if kind == AXIS:
        return a - level
    # less what the Earth's oblateness does to it within a revolution: elements.mean_semi_major_axis
    hz, radial = x * vy - yy * vx, x * vx + yy * vy + z * vz
    h2 = r * r * v2 - radial * radial
    near, s = a / r, z / r
    swing = near * near * near * (1.0 - 3.0 * s * s)
    swing -= (1.0 - 1.5 * (1.0 - hz * hz / h2)) * (mu * a / h2) ** 1.5
    return a - OBLATENESS_EARTH / a * swing - level


@inlined
def sign_at(kind, level, y, mu):
    """`measure` where a run begins: 0 where what is left of it is rounding, so that an event that holds there already
    does not happen before it has ceased to hold."""
    g = measure(kind, level, y, mu)
    x, yy, z, vx, vy, vz = y[0], y[1], y[2], y[3], y[4], y[5]
    r = np.sqrt(x * x + yy * yy + z * z)
    scale = r
    if kind == APSIS:
        scale = r * np.sqrt(vx * vx + vy * vy + vz * vz)
    elif kind == ENERGY:
        scale = mu / r
    elif kind in (AXIS, MEAN_AXIS):
        scale = abs(level)
    return 0.0 if abs(g) <= NOISE * scale else g
