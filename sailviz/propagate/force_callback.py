"""A sail that pushes with a force, on a craft whose propellant burns: its acceleration grows as the mass goes.

With the light at the centre; elsewhere `sky_callback` pushes it.
"""

from __future__ import annotations

import numpy as np

from sailviz.compiled import STATE, inlined
from sailviz.propagate.callbacks import Callback, callback
from sailviz.propagate.parameters import PARAMETERS, array_at, record_at
from sailviz.propulsion.devices import SOLAR_SAIL
from sailviz.propulsion.electric_sail import esail_force
from sailviz.propulsion.solar_sail import sail_force


@inlined
def growth(mass, m):
    """The acceleration at m kg over that at `mass` kg, at which a sail has its strength; 1 where `mass` is 0, since the
    strength is then an acceleration that stays."""
    return 1.0 if mass == 0.0 else mass / m


def _thrust(time, state, parameters, own, number, out):
    """Acceleration, m/s2, of a solar or an electric sail."""
    p = record_at(parameters, PARAMETERS)
    y, a = array_at(state, STATE), array_at(out, 4)
    inverse = 1.0 / np.sqrt(y[0] * y[0] + y[1] * y[1] + y[2] * y[2])
    ux, uy, uz, nx, ny, nz = y[0] * inverse, y[1] * inverse, y[2] * inverse, y[7], y[8], y[9]
    c, k = ux * nx + uy * ny + uz * nz, number * growth(p.pushed.mass, y[6])
    a[3] = 0.0
    if p.pushed.device == SOLAR_SAIL:
        sail = p.solar_sail
        a[0], a[1], a[2] = sail_force(ux, uy, uz, inverse, nx, ny, nz, c, k * sail.strength, sail.b1, sail.b2, sail.b3)
    else:
        esail = p.electric_sail
        k, model = k * esail.characteristic_acceleration, int(esail.model)
        a[0], a[1], a[2] = esail_force(ux, uy, uz, inverse, nx, ny, nz, c, k, model, esail.pitch_limit)


def sail_by_force() -> Callback:
    """The sail of `p.pushed`, for `dynamics.model`."""
    return callback(_thrust)
