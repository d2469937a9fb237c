"""Dormand and Prince's integration of a craft that turns: the steps of `dop853` at the size of its state.

The error of a step is the largest of those of position and velocity, as there, of the quaternion against 1, and of the
body rate against itself or what a step's torque makes of it; the momentum of wheels counts as the rate that it would
give the craft. The quaternion is rescaled where its length is off by more than 1e-9, of an averaged spin the axis.
"""

from __future__ import annotations

import numpy as np

from sailviz.compiled import called, entry, inlined
from sailviz.compiled.rebound import plain, rebound
from sailviz.propagate import dop853, events, step_events, stepping
from sailviz.propagate.body_motion import (
    AVERAGED,
    CONTROLLED,
    RATE,
    SIZE,
    SLIDE,
    WHEELS,
    Q,
    accelerated,
    air_loads,
    asked,
    averaged_derivative,
    body_of,
    dose_rate,
    passive_loads,
    point_normal,
    turned,
)
from sailviz.propagate.body_quantities import FIRST_OF_BODY, body_quantity
from sailviz.propagate.dop853 import E3, E3_LATER, E5, E5_LATER, EVENT_SAMPLES, MOST_EVENTS, TWICE
from sailviz.propagate.dynamics import derivative
from sailviz.propagate.parameters import PARAMETERS
from sailviz.propagate.quantity_callback import MAGNETOPAUSE
from sailviz.propagate.stepping import CLOCK, DENSE_START, IN_USE, NEW, TIME, Integration, Y, in_pieces

LENGTHENED = 1e-9  # of a quaternion, beyond which it is rescaled
TUMBLED = 9  # place in Integration.counter, after those of `stepping`: 1 once the craft has turned its back


@called
def body_derivative(t, y, factor, p, out):
    """out (SIZE,) = dy/dt. factor : of the light's push; p : a record of PARAMETERS."""
    b = body_of(p)
    point_normal(y, p, b)
    derivative(t, y, 0.0, p, out)
    for j in range(Q, SIZE):
        out[j] = 0.0
    if b.motion == AVERAGED:
        averaged_derivative(t, y, factor, p, b, out)
        return
    px, py, pz, tx, ty, tz, dx, dy, dz, ux, uy, uz, strength = passive_loads(t, y, factor, p, b)
    accelerated(y, px, py, pz, b, out)
    if b.mass != 0.0:
        out[6] = dose_rate(p)
    tx, ty, tz = tx + dx, ty + dy, tz + dz
    if b.air != 0.0:  # its force is among those of `derivative`
        qx, qy, qz, dx, dy, dz = air_loads(p)
        px, py, pz, tx, ty, tz = px + qx, py + qy, pz + qz, tx + dx, ty + dy, tz + dz
    if b.motion == CONTROLLED:
        qx, qy, qz, mx, my, mz = asked(t, y, p, px, py, pz, tx, ty, tz, ux, uy, uz, strength, out)
        accelerated(y, qx, qy, qz, b, out)
        tx, ty, tz = tx + mx, ty + my, tz + mz
    turned(y, tx, ty, tz, b, out)


@inlined
def squares(k, first, count, h):
    """(sums of the squares of the fifth- and of the third-order error, over h) of some components."""
    five, three = 0.0, 0.0
    for i in range(count):
        j = first + i
        a, c = E5(k, j) + E5_LATER(k, j), E3(k, j) + E3_LATER(k, j)
        five, three = five + a * a, three + c * c
    return five, three


@inlined
def length2(row, first):
    """Square of a vector."""
    return row[first] * row[first] + row[first + 1] * row[first + 1] + row[first + 2] * row[first + 2]


@inlined
def _error(k, h, mu):
    """Scaled error of a step before division by the tolerance."""
    if not np.isfinite(length2(k[NEW], RATE)):  # a step of many turns has run away
        return np.inf
    r2, v2 = max(length2(k[Y], 0), length2(k[NEW], 0)), max(length2(k[Y], 3), length2(k[NEW], 3))
    v2 = max(v2, mu / np.sqrt(r2))
    turning = max(length2(k[Y], RATE), length2(k[NEW], RATE))
    turning = max(turning, h * h * length2(k[0], RATE)) + v2 / r2
    a, b = squares(k, 0, 3, h)
    e5, e3 = a / r2, b / r2
    a, b = squares(k, 3, 3, h)
    e5, e3 = max(e5, a / v2), max(e3, b / v2)
    a, b = squares(k, Q, 4, h)
    e5, e3 = max(e5, a), max(e3, b)
    a, b = squares(k, RATE, 3, h)
    e5, e3 = max(e5, a / turning), max(e3, b / turning)
    held = max(length2(k[Y], WHEELS), length2(k[NEW], WHEELS)) + h * h * length2(k[0], WHEELS)
    if held > 0.0:
        a, b = squares(k, WHEELS, 3, h)
        e5, e3 = max(e5, a / held), max(e3, b / held)
    slid = k[Y, SLIDE] ** 2 + k[Y, SLIDE + 1] ** 2 + h * h * (k[0, SLIDE] ** 2 + k[0, SLIDE + 1] ** 2)
    if slid > 0.0:
        a, b = squares(k, SLIDE, 2, h)
        e5, e3 = max(e5, a / slid), max(e3, b / slid)
    if e5 == 0.0 and e3 == 0.0:
        return 0.0
    return h * e5 / np.sqrt(e5 + 0.01 * e3)


@called
def quantity(kind, t, y, factor, p):
    """(value, its size) of a watched quantity: what only a craft that turns has, or any other at its attitude."""
    number = kind - (events.ON_A_CIRCLE if kind >= events.ON_A_CIRCLE else events.QUANTITY)
    b = body_of(p)
    if FIRST_OF_BODY <= number < MAGNETOPAUSE:
        return body_quantity(number, y, b)
    point_normal(y, p, b)
    return events.quantity(kind, t, y, factor, p)


_settle = rebound([(inlined, stepping.settle)], __name__, {"SIZE": SIZE})["settle"]


@inlined
def settle(s, breaks, factors, p, t, limit, t_end, cut, interval, factor):
    """As `stepping.settle`; and the quaternion of the length that it should have."""
    interval, factor, jumps = _settle(s, breaks, factors, p, t, limit, t_end, cut, interval, factor)
    y = s.work[Y]
    size = y[Q] * y[Q] + y[Q + 1] * y[Q + 1] + y[Q + 2] * y[Q + 2] + y[Q + 3] * y[Q + 3]
    if abs(size - 1.0) > 2.0 * LENGTHENED:
        k = 1.0 / np.sqrt(size)
        for j in range(Q, Q + 4):
            y[j] = k * y[j]
        jumps = True
    return interval, factor, jumps


_CHANGES = {"SIZE": SIZE, "derivative": body_derivative, "quantity": quantity, "_error": _error, "settle": settle}
_INLINED = (
    dop853.stages, dop853.interpolant, dop853.attempt, step_events.evaluate, step_events.root, step_events.at,
    step_events.crossing, step_events.happenings, step_events.events_until, stepping.begin, events.off_level,
    events.sign_at,
)  # fmt: skip
_CALLED = (step_events.dip, step_events.find_events)
_functions = [
    *((inlined, one) for one in _INLINED),
    *((called, one) for one in _CALLED),
    (plain, dop853.advance_compiled),
]
_advance = rebound(_functions, __name__, _CHANGES)["advance_compiled"]
advance_compiled = entry(dop853.advance_compiled.declared, PARAMETERS)(_advance)


def start(t, position, velocity, mass, events=0, motion=()) -> Integration:
    """A fresh Integration at time s, position m, velocity m/s, mass kg, with room for a number of events. motion : the
    state from the quaternion on."""
    work = np.zeros((28, SIZE))
    work[Y, : Q + len(motion)] = (*position, *velocity, mass, *motion)
    work[CLOCK, TIME] = work[CLOCK, DENSE_START] = t
    count = np.zeros(TUMBLED + 1, dtype=np.int64)
    count[IN_USE] = 1
    rows = MOST_EVENTS * (events > 0) + TWICE * EVENT_SAMPLES * events + 1
    return Integration(work, count, np.zeros(events), np.zeros((rows, 9)))


def advance(s, model, breaks, factors, watch, t_out, out, t_end, tolerance, largest_step, patience=None) -> int:
    """As `dop853.advance`. out (k, n) : the first k numbers of the state."""
    numbers = t_end, tolerance, largest_step
    return in_pieces(advance_compiled, s, model, (breaks, factors, *watch), t_out, out, numbers, patience)
