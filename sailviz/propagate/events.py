"""What can happen along a trajectory: functions of the state whose sign changes are looked for, and what follows."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from sailviz.compiled import inlined

RADIUS, APSIS, ENERGY, NODE = range(4)
RECORD, STOP, END_OF_USE = range(3)


class Watch(NamedTuple):
    """The events of one propagation, k of them; all arrays (k,)."""

    kind: np.ndarray  # int64: RADIUS, APSIS, ENERGY, NODE
    level: np.ndarray  # float64: distance from the centre in m for RADIUS, else unused
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
    return r - level
