"""Voltage control inside a run: at every break of the schedule a controller sees the craft and sets the thrust.

A plug: compiled when the first scene needs it. What it knows stands in a table of the parameter row, one line per
break; it writes the voltage that it sets into the same line.
"""

from __future__ import annotations

import numba
import numpy as np

from sailviz.propagate import parameters as at
from sailviz.propagate.callbacks import plug_address
from sailviz.propulsion import voltage_control as control

# Columns of a line: what blows, where the reference flight is, whether the controller acts, whether thrust is wanted
PRESSURE, DENSITY, POTENTIAL, R_REF, U_REF, UPDATE, WANTED, VOLTAGE = range(8)
COLUMNS = 8


def _factor(t, state, row, size, index, out):
    """Plug: the thrust factor from the break of this index on."""
    y, p, f = numba.carray(state, (7,)), numba.carray(row, (size,)), numba.carray(out, (4,))
    line = int(p[at.CONTROL_TABLE]) + COLUMNS * int(index)
    law = p[int(p[at.CONTROL_LAW]) : int(p[at.CONTROL_LAW]) + control.SIZE]
    held = np.nan if index == 0.0 else p[line - COLUMNS + VOLTAGE]
    if p[line + UPDATE] != 0.0:
        r = np.sqrt(y[0] * y[0] + y[1] * y[1] + y[2] * y[2])
        u = (y[0] * y[3] + y[1] * y[4] + y[2] * y[5]) / r
        held = control.voltage(held, p[line + PRESSURE], p[line + DENSITY], r, u, p[line + R_REF], p[line + U_REF], law)
    p[line + VOLTAGE] = held
    f[0] = p[line + WANTED] * control.thrust_factor(held, p[line + PRESSURE], p[line + POTENTIAL], law)
    f[1], f[2], f[3] = 0.0, 0.0, 0.0


def factor_plug() -> int:
    """Address of the voltage control, for `dynamics.model`."""
    return plug_address(_factor)
