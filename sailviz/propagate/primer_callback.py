"""Steering towards a primer: the thrust that does the most along a wanted vector, at the craft's present place.

A plug: compiled when the first scene needs it. The primer comes from a table (a solved minimum-time flight), from the
orbital element that is to change fastest, or from the distance to a target orbit.
"""

from __future__ import annotations

import numba
import numpy as np

from sailviz.compiled import called, compiled
from sailviz.propagate import parameters as at
from sailviz.propagate.callbacks import plug_address
from sailviz.steering import attitude as law
from sailviz.steering.optimal import steer, towards_primer
from sailviz.steering.primers import locally_optimal_primer, lyapunov_primer


@called
def primer(t, x, y, z, vx, vy, vz, p):
    """The vector along which the law wants the most thrust, of any length; inertial."""
    kind = p[at.PRIMER_KIND]
    if kind == law.LOCAL:
        lx, ly, lz = locally_optimal_primer(int(p[at.STEERING]), x, y, z, vx, vy, vz, p[at.PRIMER_MU])
        sense = p[at.STEERING + 1]
        return sense * lx, sense * ly, sense * lz
    if kind == law.LYAPUNOV:
        return lyapunov_primer(x, y, z, vx, vy, vz, p[at.PRIMER_MU], p, at.TABLE)
    return law.table_row(t, p, at.TABLE, int(p[at.ROWS]), p[at.INTERPOLATION])


@called
def normal(t, x, y, z, vx, vy, vz, p):
    """(unit sail normal, 1.0 or 0.0 for thrust on or off) of the law."""
    lx, ly, lz = primer(t, x, y, z, vx, vy, vz, p)
    inverse = 1.0 / np.sqrt(x * x + y * y + z * z)
    sail = int(p[at.STEER_AS])
    return towards_primer(sail, p, at.STEER_AS + 1, x * inverse, y * inverse, z * inverse, lx, ly, lz)


def _normal(t, state, row, size, factor, out):
    """Plug: the normal and whether to thrust."""
    y, p, n = numba.carray(state, (7,)), numba.carray(row, (size,)), numba.carray(out, (4,))
    n[0], n[1], n[2], n[3] = normal(t, y[0], y[1], y[2], y[3], y[4], y[5], p)


def normal_plug() -> int:
    """Address of the primer laws, for `dynamics.model`."""
    return plug_address(_normal)


@compiled
def observe_primer(time, states, p):
    """Unit primer vectors (n, 3), inertial, and h (n,), the thrust along them as a share of the full one (0 where the
    law wants none), at times (n,) s and states (7, n)."""
    out, support = np.empty((len(time), 3)), np.empty(len(time))
    for i in range(len(time)):
        s = states[:, i]
        lx, ly, lz = primer(time[i], s[0], s[1], s[2], s[3], s[4], s[5], p)
        size = np.sqrt(lx * lx + ly * ly + lz * lz)
        if size == 0.0:
            out[i, :], support[i] = 0.0, 0.0
            continue
        out[i, 0], out[i, 1], out[i, 2] = lx / size, ly / size, lz / size
        r = np.sqrt(s[0] * s[0] + s[1] * s[1] + s[2] * s[2])
        c = min(max((out[i, 0] * s[0] + out[i, 1] * s[1] + out[i, 2] * s[2]) / r, -1.0), 1.0)
        support[i] = steer(int(p[at.STEER_AS]), p, at.STEER_AS + 1, c, np.sqrt(1.0 - c * c), 0.0)[2]
    return out, support
