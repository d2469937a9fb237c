"""Voltage control inside a run: at every break of the schedule a controller sees the craft and sets the thrust.

A callback: compiled when the first scene needs it. What it knows stands in a table, one line per
break; it writes the voltage that it sets into the same line.
"""

from __future__ import annotations

import numpy as np

from sailviz.compiled import STATE
from sailviz.propagate.callbacks import Callback, callback
from sailviz.propagate.parameters import PARAMETERS, array_at, record_at
from sailviz.propulsion import voltage_control

# Columns of a line: what blows, where the reference flight is, whether the controller acts, whether thrust is wanted
PRESSURE, DENSITY, POTENTIAL, R_REF, U_REF, UPDATE, WANTED, VOLTAGE = range(8)
COLUMNS = 8


def _factor(time, state, parameters, own, index, out):
    """The thrust factor from the break of this index on."""
    p = record_at(parameters, PARAMETERS)
    y, tables, f = array_at(state, STATE), array_at(p.places.address, p.places.end), array_at(out, 4)
    places = p.places
    line = places.control + COLUMNS * int(index)
    law = tables[places.control_law : places.control_law + voltage_control.SIZE]
    held = np.nan if index == 0.0 else tables[line - COLUMNS + VOLTAGE]
    if tables[line + UPDATE] != 0.0:
        r = np.sqrt(y[0] * y[0] + y[1] * y[1] + y[2] * y[2])
        u = (y[0] * y[3] + y[1] * y[4] + y[2] * y[5]) / r
        held = voltage_control.voltage(
            held, tables[line + PRESSURE], tables[line + DENSITY], r, u, tables[line + R_REF], tables[line + U_REF], law
        )
    tables[line + VOLTAGE] = held
    f[0] = tables[line + WANTED] * voltage_control.thrust_factor(
        held, tables[line + PRESSURE], tables[line + POTENTIAL], law
    )
    f[1], f[2], f[3] = 0.0, 0.0, 0.0


def voltage_callback() -> Callback:
    """The voltage control, for `dynamics.model`."""
    return callback(_factor)
