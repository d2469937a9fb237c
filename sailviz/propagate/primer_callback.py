"""Steering towards a primer: the thrust that does the most along a wanted vector, at the craft's present place.

A callback: compiled when the first scene needs it. The primer comes from a table (a solved minimum-time flight), from
the orbital element that is to change fastest, or from the distance to a target orbit.
"""

from __future__ import annotations

import numpy as np
from numba import carray

from sailviz.compiled import STATE, called, compiled
from sailviz.propagate.callbacks import Callback, callback
from sailviz.propagate.parameters import array_at
from sailviz.steering import attitude
from sailviz.steering.optimal import steer, towards_primer
from sailviz.steering.primers import locally_optimal_primer, lyapunov_primer


@called
def primer(t, x, y, z, vx, vy, vz, p, tables):
    """The vector along which the law wants the most thrust, of any length; inertial."""
    kind = p.primer.kind
    if kind == attitude.LOCAL:
        lx, ly, lz = locally_optimal_primer(p.local.goal, x, y, z, vx, vy, vz, p.primer.mu)
        sense = p.local.sense
        return sense * lx, sense * ly, sense * lz
    if kind == attitude.LYAPUNOV:
        return lyapunov_primer(x, y, z, vx, vy, vz, p.primer.mu, tables, p.places.steering)
    return attitude.table_row(t, tables, p.places.steering, p.table.rows, p.table.interpolation)


@called
def normal(t, x, y, z, vx, vy, vz, p, tables):
    """(unit sail normal, 1.0 or 0.0 for thrust on or off) of the law."""
    lx, ly, lz = primer(t, x, y, z, vx, vy, vz, p, tables)
    inverse = 1.0 / np.sqrt(x * x + y * y + z * z)
    ux, uy, uz = x * inverse, y * inverse, z * inverse
    return towards_primer(p.primer.sail, tables, p.places.sail, ux, uy, uz, lx, ly, lz)


def _normal(time, state, parameters, own, number, out):
    """The normal and whether to thrust."""
    p = carray(parameters, (1,))[0]
    y, tables, n = carray(state, (STATE,)), array_at(p.places.address, p.places.end), carray(out, (4,))
    n[0], n[1], n[2], n[3] = normal(time, y[0], y[1], y[2], y[3], y[4], y[5], p, tables)


def primer_steering() -> Callback:
    """The primer laws, for `dynamics.model`."""
    return callback(_normal)


@compiled
def observe_primer(time, states, parameters):
    """Unit primer vectors (n, 3), inertial, and h (n,), the thrust along them as a share of the full one (0 where the
    law wants none), at times (n,) s and states (7, n)."""
    p = parameters[0]
    tables = array_at(p.places.address, p.places.end)
    out, support = np.empty((len(time), 3)), np.empty(len(time))
    for i in range(len(time)):
        s = states[:, i]
        lx, ly, lz = primer(time[i], s[0], s[1], s[2], s[3], s[4], s[5], p, tables)
        size = np.sqrt(lx * lx + ly * ly + lz * lz)
        if size == 0.0:
            out[i, :], support[i] = 0.0, 0.0
            continue
        out[i, 0], out[i, 1], out[i, 2] = lx / size, ly / size, lz / size
        r = np.sqrt(s[0] * s[0] + s[1] * s[1] + s[2] * s[2])
        c = min(max((out[i, 0] * s[0] + out[i, 1] * s[1] + out[i, 2] * s[2]) / r, -1.0), 1.0)
        support[i] = steer(p.primer.sail, tables, p.places.sail, c, np.sqrt(1.0 - c * c), 0.0)[2]
    return out, support
