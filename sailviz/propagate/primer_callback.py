"""Steering towards a primer: the thrust that does the most along a wanted vector, at the craft's present place.

A callback: compiled when the first scene needs it. The primer comes from a table (a solved minimum-time flight), from
the orbital element that is to change fastest, or from the distance to a target orbit.
"""

from __future__ import annotations

import numpy as np

from sailviz.compiled import STATE, called, entry, inlined
from sailviz.propagate.callbacks import Callback, callback
from sailviz.propagate.parameters import PARAMETERS, array_at, record_at
from sailviz.steering import attitude
from sailviz.steering.optimal import steer_cool, towards_primer
from sailviz.steering.primers import EDGE, locally_optimal_primer, locally_optimal_readiness, lyapunov_primer, readiness

THRUST, COAST, SINGULAR = range(3)  # arcs of a minimum-time flight, by their place among their words
ARC_KINDS = ("thrust", "coast", "singular")


@inlined
def arc_throttle(t, p, tables):
    """Throttle of the arc that is flown at t: 1, 0, or on a singular arc what its table says."""
    at = p.places.steering
    arcs = int(tables[at])
    kind = int(tables[at + attitude.COLUMNS * arcs + 1])
    for i in range(arcs, 0, -1):
        row = at + attitude.COLUMNS * i
        if t < tables[row]:
            kind = int(tables[row + 1])
    if kind != SINGULAR:
        return 1.0 if kind == THRUST else 0.0
    first = at + attitude.COLUMNS * (1 + arcs)
    share, _, _ = attitude.table_row(t, tables, first, int(tables[at + 1]), attitude.CUBIC)
    return share


@called
def primer(t, x, y, z, vx, vy, vz, p, tables):
    """The vector along which the law wants the most thrust, of any length, inertial; and the share of it that the law
    wants."""
    kind = p.primer.kind
    if kind == attitude.LOCAL:
        lx, ly, lz = locally_optimal_primer(p.local.goal, x, y, z, vx, vy, vz, p.primer.mu)
        sense = p.local.sense
        ready = locally_optimal_readiness(p.local.goal, sense, x, y, z, vx, vy, vz, p.primer.mu)
        return sense * lx, sense * ly, sense * lz, ready
    if kind == attitude.LYAPUNOV:
        return lyapunov_primer(x, y, z, vx, vy, vz, p.primer.mu, tables, p.places.steering)
    if kind == attitude.ARCS:
        skipped = 1 + int(tables[p.places.steering]) + int(tables[p.places.steering + 1])
        first, rows = p.places.steering + attitude.COLUMNS * skipped, p.table.rows - skipped
        lx, ly, lz = attitude.table_row(t, tables, first, rows, p.table.interpolation)
        return lx, ly, lz, arc_throttle(t, p, tables)
    lx, ly, lz = attitude.table_row(t, tables, p.places.steering, p.table.rows, p.table.interpolation)
    return lx, ly, lz, 1.0


@inlined
def throttle(h, ready, p):
    """Of a law that finds h along its primer: 1 or 0 from a table, and with soft edges where the state steers; what the
    arc asks for where the law flies arcs."""
    if p.primer.kind == attitude.ARCS:
        return ready
    if h <= 0.0:
        return 0.0
    return 1.0 if p.primer.kind == attitude.PRIMER else ready * readiness(h / EDGE)


@called
def normal(t, x, y, z, vx, vy, vz, p, tables):
    """(unit sail normal, throttle) of the law."""
    lx, ly, lz, ready = primer(t, x, y, z, vx, vy, vz, p, tables)
    r2 = x * x + y * y + z * z
    inverse = 1.0 / np.sqrt(r2)
    ux, uy, uz = x * inverse, y * inverse, z * inverse
    nx, ny, nz, h = towards_primer(p.primer.sail, tables, p.places.sail, r2, ux, uy, uz, lx, ly, lz)
    return nx, ny, nz, throttle(h, ready, p)


def _normal(time, state, parameters, own, number, out):
    """The normal and the throttle."""
    p = record_at(parameters, PARAMETERS)
    y, tables, n = array_at(state, STATE), array_at(p.places.address, p.places.end), array_at(out, 4)
    n[0], n[1], n[2], n[3] = normal(time, y[0], y[1], y[2], y[3], y[4], y[5], p, tables)


def primer_steering() -> Callback:
    """The primer laws, for `dynamics.model`."""
    return callback(_normal)


def observe_primer(time, states, parameters):
    """Unit primer vectors (n, 3), inertial, and h (n,), the thrust along them as a share of the full one (0 where the
    law wants none), at times (n,) s and states (7, n)."""
    out, support = np.empty((len(time), 3)), np.empty(len(time))
    _observe(time, states, parameters, out, support)
    return out, support


def observe_throttle(time, parameters):
    """Throttle (n,) at times (n,) s of a law that flies arcs."""
    out = np.empty(len(time))
    _observe_throttle(np.ascontiguousarray(time), parameters, out)
    return out


@entry("d1 r1 D1", PARAMETERS)
def _observe_throttle(time, parameters, out):
    """`observe_throttle` into out (n,)."""
    p = parameters[0]
    tables = array_at(p.places.address, p.places.end)
    for i in range(len(time)):
        out[i] = arc_throttle(time[i], p, tables)
    return 0


@entry("d1 d2 r1 D2 D1", PARAMETERS)
def _observe(time, states, parameters, out, support):
    """`observe_primer` without its arrays made."""
    p = parameters[0]
    tables = array_at(p.places.address, p.places.end)
    for i in range(len(time)):
        y = states[:, i]
        lx, ly, lz, ready = primer(time[i], y[0], y[1], y[2], y[3], y[4], y[5], p, tables)
        size = np.sqrt(lx * lx + ly * ly + lz * lz)
        if size == 0.0:
            out[i, :], support[i] = 0.0, 0.0
            continue
        out[i, 0], out[i, 1], out[i, 2] = lx / size, ly / size, lz / size
        r2 = y[0] * y[0] + y[1] * y[1] + y[2] * y[2]
        c = min(max((out[i, 0] * y[0] + out[i, 1] * y[1] + out[i, 2] * y[2]) / np.sqrt(r2), -1.0), 1.0)
        h = steer_cool(p.primer.sail, tables, p.places.sail, r2, c, np.sqrt(1.0 - c * c))[2]
        support[i] = h * throttle(h, ready, p)
    return 0
