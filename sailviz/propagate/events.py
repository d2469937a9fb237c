"""What can happen along a trajectory: functions of the state whose sign changes are looked for, and what follows."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from sailviz.compiled import called, inlined
from sailviz.constants import J2_EARTH, RADIUS_EARTH
from sailviz.propagate.callbacks import call

RADIUS, APSIS, ENERGY, NODE, AXIS, MEAN_AXIS = range(6)
QUANTITY, ON_A_CIRCLE = 100, 200  # and from each on, a quantity by its number in quantity_callback, and an angle
NOISE = 1e-9  # of distance, energy or r v: 7 mm in a low orbit, 150 m at 1 au; what rounding and the first steps err by
OBLATENESS_EARTH = J2_EARTH * RADIUS_EARTH**2  # m2
RECORD, STOP, END_OF_USE = range(3)


class Watch(NamedTuple):
    """The events of one propagation, k of them; all arrays (k,)."""

    kind: np.ndarray  # int64: RADIUS, APSIS, ENERGY, NODE, AXIS, MEAN_AXIS, or a quantity's
    level: np.ndarray  # float64: distance from the centre in m for RADIUS, semi-major axis in m, a quantity's value
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
    """The function whose zero is an event of the kinds that are built in, for a state y (7,)."""
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


@called
def quantity(kind, t, y, factor, p):
    """(value, its size) of a watched quantity at time t s, thrust factor `factor`: by the callback."""
    number = float(kind - (ON_A_CIRCLE if kind >= ON_A_CIRCLE else QUANTITY))
    x, yy, z, vx, vy, vz, m = y[0], y[1], y[2], y[3], y[4], y[5], y[6]
    value, size, _, _ = call(p.callbacks.quantity, 0, t, x, yy, z, vx, vy, vz, m, factor, 0.0, 0.0, p, number)
    return value, size


@inlined
def arc_to(value, level):
    """The shortest arc from an angle to another, rad."""
    away = value - level
    return away - 2.0 * np.pi * np.round(away / (2.0 * np.pi))


@inlined
def off_level(kind, level, t, y, factor, p):
    """How far what is watched is from its level: the function whose zero is the event."""
    if kind < QUANTITY:
        return measure(kind, level, y, p.gravity.mu)
    value, _ = quantity(kind, t, y, factor, p)
    return arc_to(value, level) if kind >= ON_A_CIRCLE else value - level


@inlined
def passes(kind, before, now):
    """Whether the level lies between two values of `off_level`: a change of sign, but for that on the far side of a
    circle."""
    differs = (before < 0.0 and now >= 0.0) or (before > 0.0 and now <= 0.0)
    return differs and not (kind >= ON_A_CIRCLE and abs(now - before) > np.pi)


@inlined
def sign_at(kind, level, t, y, factor, p):
    """`off_level` where a run begins: 0 where what is left of it is rounding, so that an event that holds there already
    does not happen before it has ceased to hold."""
    if kind >= QUANTITY:
        value, size = quantity(kind, t, y, factor, p)
        away = arc_to(value, level) if kind >= ON_A_CIRCLE else value - level
        return 0.0 if abs(away) <= NOISE * size else away
    mu = p.gravity.mu
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
