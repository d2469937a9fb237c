"""Adaptive integration of one trajectory: Dormand-Prince 8(5,3) with dense output on the asked grid, and events on it.

Source: Hairer, Norsett, Wanner, Solving Ordinary Differential Equations I (1993), section II.10. Departures, all for
orbits: the error is measured against |r| and against the larger of |v| and the circular speed instead of component by
component; the dense output is rewritten as monomials once a step, so that a row of outputs is one vectorised Horner
loop; steps land on every time at which the thrust factor or the steering table has a kink.

`Integration` keeps everything between calls of `advance`, so a run may be computed in blocks of any size and is the
same to the last bit.
"""

from __future__ import annotations

import numpy as np

from sailviz.compiled import Late, entry, inlined, late
from sailviz.propagate import dop853_coefficients as c
from sailviz.propagate.dynamics import SIZE, derivative
from sailviz.propagate.events import Watch
from sailviz.propagate.parameters import PARAMETERS
from sailviz.propagate.patience import first_piece
from sailviz.propagate.step_events import happenings, surface_met
from sailviz.propagate.stepping import (
    CLOCK,
    DENSE,
    DENSE_START,
    DENSE_STEP,
    EVENT_SAMPLES,
    EVENTS,
    IN_USE,
    INTERVAL,
    NEW,
    PAUSED,
    REJECTED,
    STARTED,
    STATUS,
    STEP,
    STEPS,
    TIME,
    TWICE,
    Integration,
    W,
    Y,
    begin,
    close_block,
    in_pieces,
    next_edge,
    next_limit,
    open_block,
    rows_until,
    settle,
)
from sailviz.propagate.stepping import DONE as DONE
from sailviz.propagate.stepping import EVENTS_FULL as EVENTS_FULL
from sailviz.propagate.stepping import MOST_EVENTS as MOST_EVENTS
from sailviz.propagate.stepping import NOT_FINITE as NOT_FINITE
from sailviz.propagate.stepping import STOPPED as STOPPED
from sailviz.propagate.stepping import SURFACE as SURFACE
from sailviz.propagate.stepping import UNDERFLOW as UNDERFLOW
from sailviz.propagate.stepping import drain_events as drain_events
from sailviz.propagate.stepping import in_use as in_use
from sailviz.propagate.stepping import rows_done as rows_done
from sailviz.propagate.stepping import state as state
from sailviz.propagate.stepping import statistics as statistics
from sailviz.propagate.stepping import stopped_by as stopped_by
from sailviz.propagate.stepping import time as time

SAFETY, SHRINK_MOST, GROW_MOST = 0.9, 0.333, 6.0  # of the step-size controller: Hairer's values
WORTH_A_STEP = 1e-9  # tolerance below which steps end at kinks of the forces; for a wider one that would only cost
VECTOR = 16  # rows that one turn of the compiled output loop fills


def _row(name: str, first: int = 1, last: int = 16) -> Late:
    """For compiled code, the sum that a row of the tableau makes of the stages: A5(k, j) is A5_1 k[0, j] + A5_3 k[2, j]
    + A5_4 k[3, j]; from the first to the last stage. Written out in Python, these sums would take a fifth of the time
    of the first compilation."""
    stages = (stage for stage in range(first, last + 1) if hasattr(c, f"{name}_{stage}"))
    terms = tuple((stage - 1, getattr(c, f"{name}_{stage}")) for stage in stages)
    return late("sailviz.propagate.intrinsics", "weighted_rows", terms)


A2, A3, A4, A5, A6, A7, A8, A9, A10, A11, A12, A13, A14, A15, A16 = (_row(f"A{i}") for i in range(2, 17))
D4, D5, D6, D7 = (_row(f"D{i}") for i in range(4, 8))
E3, E5, E3_LATER, E5_LATER = _row("E3", 1, 8), _row("E5", 1, 8), _row("E3", 9), _row("E5", 9)


def start(t, position, velocity, mass, events=0) -> Integration:
    """A fresh Integration at time s, position m, velocity m/s, mass kg, with room for a number of events."""
    work = np.zeros((28, SIZE))
    work[Y] = (*position, *velocity, mass)
    work[CLOCK, TIME] = work[CLOCK, DENSE_START] = t
    count = np.zeros(9, dtype=np.int64)
    count[IN_USE] = 1
    of_one_step = TWICE * EVENT_SAMPLES * events + 1  # and then there is the surface
    return Integration(work, count, np.zeros(events), np.zeros((MOST_EVENTS * (events > 0) + of_one_step, 9)))


@inlined
def _error(k, h, mu):
    """Scaled error of a step before division by the tolerance: Hairer's blend of the 5th- and 3rd-order estimates."""
    r2 = v2 = s2 = u2 = e5r = e5v = e3r = e3v = 0.0
    for j in range(3):
        i = j + 3
        p5, p3 = E5(k, j) + E5_LATER(k, j), E3(k, j) + E3_LATER(k, j)
        w5, w3 = E5(k, i) + E5_LATER(k, i), E3(k, i) + E3_LATER(k, i)
        e5r, e3r, e5v, e3v = e5r + p5 * p5, e3r + p3 * p3, e5v + w5 * w5, e3v + w3 * w3
        r2, v2 = r2 + k[Y, j] * k[Y, j], v2 + k[Y, i] * k[Y, i]
        s2, u2 = s2 + k[NEW, j] * k[NEW, j], u2 + k[NEW, i] * k[NEW, i]
    r2 = max(r2, s2)
    v2 = max(max(v2, u2), mu / np.sqrt(r2))
    e5 = 0.5 * (e5r / r2 + e5v / v2)
    e3 = 0.5 * (e3r / r2 + e3v / v2)
    if e5 == 0.0 and e3 == 0.0:
        return 0.0
    return h * e5 / np.sqrt(e5 + 0.01 * e3)


@inlined
def stages(t, h, end, factor, p, k):
    """The stages 2 to 12 of a step, the new state, and stage 13, the derivative there: k[i - 1] = f(t + C_i h, k[W]).
    end is the time of the last two, t + h or a moment before it.

    Written out: a loop over stages would compile no faster and run at half the speed.
    """
    for j in range(SIZE):
        k[W, j] = k[Y, j] + h * A2(k, j)
    derivative(t + c.C2 * h, k[W], factor, p, k[1])
    for j in range(SIZE):
        k[W, j] = k[Y, j] + h * A3(k, j)
    derivative(t + c.C3 * h, k[W], factor, p, k[2])
    for j in range(SIZE):
        k[W, j] = k[Y, j] + h * A4(k, j)
    derivative(t + c.C4 * h, k[W], factor, p, k[3])
    for j in range(SIZE):
        k[W, j] = k[Y, j] + h * A5(k, j)
    derivative(t + c.C5 * h, k[W], factor, p, k[4])
    for j in range(SIZE):
        k[W, j] = k[Y, j] + h * A6(k, j)
    derivative(t + c.C6 * h, k[W], factor, p, k[5])
    for j in range(SIZE):
        k[W, j] = k[Y, j] + h * A7(k, j)
    derivative(t + c.C7 * h, k[W], factor, p, k[6])
    for j in range(SIZE):
        k[W, j] = k[Y, j] + h * A8(k, j)
    derivative(t + c.C8 * h, k[W], factor, p, k[7])
    for j in range(SIZE):
        k[W, j] = k[Y, j] + h * A9(k, j)
    derivative(t + c.C9 * h, k[W], factor, p, k[8])
    for j in range(SIZE):
        k[W, j] = k[Y, j] + h * A10(k, j)
    derivative(t + c.C10 * h, k[W], factor, p, k[9])
    for j in range(SIZE):
        k[W, j] = k[Y, j] + h * A11(k, j)
    derivative(t + c.C11 * h, k[W], factor, p, k[10])
    for j in range(SIZE):
        k[W, j] = k[Y, j] + h * A12(k, j)
    derivative(end, k[W], factor, p, k[11])
    for j in range(SIZE):
        k[NEW, j] = k[Y, j] + h * A13(k, j)
    derivative(end, k[NEW], factor, p, k[12])


@inlined
def interpolant(t, h, factor, p, k, m):
    """Monomial coefficients m (8, SIZE) of the dense output over the step: y(t + x h) = sum m[i] x^i."""
    for j in range(SIZE):
        k[W, j] = k[Y, j] + h * A14(k, j)
    derivative(t + c.C14 * h, k[W], factor, p, k[13])
    for j in range(SIZE):
        k[W, j] = k[Y, j] + h * A15(k, j)
    derivative(t + c.C15 * h, k[W], factor, p, k[14])
    for j in range(SIZE):
        k[W, j] = k[Y, j] + h * A16(k, j)
    derivative(t + c.C16 * h, k[W], factor, p, k[15])
    for j in range(SIZE):
        f0 = k[NEW, j] - k[Y, j]
        f1 = h * k[0, j] - f0
        f2 = 2.0 * f0 - h * (k[12, j] + k[0, j])
        f3 = h * D4(k, j)
        f4 = h * D5(k, j)
        f5 = h * D6(k, j)
        f6 = h * D7(k, j)
        # Hairer's nested form y + x(f0 + (1-x)(f1 + x(f2 + (1-x)(f3 + x(f4 + (1-x)(f5 + x f6)))))) multiplied out
        m[0, j] = k[Y, j]
        m[1, j] = f0 + f1
        m[2, j] = f2 + f3 - f1
        m[3, j] = f4 + f5 - 2.0 * f3 - f2
        m[4, j] = f6 - 3.0 * f5 - 2.0 * f4 + f3
        m[5, j] = f4 + 3.0 * f5 - 3.0 * f6
        m[6, j] = 3.0 * f6 - f5
        m[7, j] = -f6


@inlined
def attempt(t, limit, wish, largest_step, t_end, tolerance, factor, p, k, count, mu):
    """One accepted step from t towards limit, or count[STATUS] saying why there is none. Returns (h, whether it lands
    on the limit, whether others were rejected before, the length last wished for, its error over the tolerance)."""
    rejected, error = False, 0.0
    while True:
        h = min(wish, largest_step)
        landing = t + 1.01 * h >= limit
        if landing:
            h = limit - t
        if h <= 4.0e-16 * max(abs(t), abs(t_end)) and not landing:
            count[STATUS] = UNDERFLOW
            break
        # a step that lands on a kink sees the steering table as it is before the kink
        stages(t, h, np.nextafter(limit, t) if landing else t + h, factor, p, k)
        error = _error(k, h, mu) / tolerance
        if error < 1.0:
            break
        if not np.isfinite(error):
            # leave a singular spot slowly; give up when even a tiny step is not finite
            wish = 0.1 * h
            if wish <= 4.0e-14 * max(abs(t), abs(t_end)):
                count[STATUS] = NOT_FINITE
                break
        else:
            wish = h * max(SHRINK_MOST, SAFETY * error**-0.125)
        rejected = True
        count[REJECTED] += 1
    return h, landing, rejected, wish, error


@inlined
def next_step(h, landing, rejected, wish, error):
    """Length to try after an accepted step."""
    grow = GROW_MOST if error == 0.0 else min(GROW_MOST, max(SHRINK_MOST, SAFETY * error**-0.125))
    if rejected:
        grow = min(grow, 1.0)
    # a step cut short by a landing must not shorten the next one
    return max(h * grow, wish) if landing and not rejected else h * grow


def advance(s, model, breaks, factors, watch, t_out, out, t_end, tolerance, largest_step, patience=None) -> int:
    """Integrate until every row of the block is filled, or until something ends the run. Returns a status.

    s : Integration, changed in place. model : Model. breaks (k,), factors (k,) : the thrust factor is factors[i]
    from breaks[i] on, breaks[0] <= start. watch : Watch. t_out (n,) : increasing times of this block's rows. out (6
    or 7, n) : position, velocity and, with seven rows, mass. t_end : end of the whole run. tolerance : relative, per
    step. largest_step : s. DONE: block full; EVENTS_FULL: drain them and call again with the same block; STOPPED by
    an event, or SURFACE, the craft touched the body: rows up to time(s) are filled, in this block and those before;
    UNDERFLOW or NOT_FINITE: the integration broke down at time(s). patience : Patience of this and other calls; where
    it ends, so does the integration, with its status: NO_PROGRESS, TOO_MANY steps or TIME_IS_UP. Ctrl-C is heard.
    """
    numbers = t_end, tolerance, largest_step
    return in_pieces(advance_compiled, s, model, (breaks, factors, *watch), t_out, out, numbers, patience)


@entry("D2 I1 D1 D2 R1 d1 D1 i1 d1 i1 i1 d1 D2 d d d d", PARAMETERS)
def advance_compiled(
    work, count, sign, event, parameters, breaks, factors,
    kinds, levels, senses, actions, t_out, out, t_end, tolerance, largest_step, piece,
):  # fmt: skip
    """`advance` with its tuples taken apart: at the border of compiled code whole tuples would cost 6 us more."""
    s = Integration(work, count, sign, event)
    p = parameters[0]
    watch = Watch(kinds, levels, senses, actions)
    n = t_out.shape[0]
    mu, surface = p.gravity.mu, p.surface.radius
    k, m, clock = work, work[DENSE:CLOCK], work[CLOCK]
    y, w, new = k[Y], k[W], k[NEW]
    watched = len(watch.kind)
    if count[STARTED] == 0:
        begin(s, watch, breaks, factors, p)
        derivative(clock[TIME], y, factors[count[INTERVAL]], p, k[0])
        r = np.sqrt(y[0] * y[0] + y[1] * y[1] + y[2] * y[2])
        speed = np.sqrt(y[3] * y[3] + y[4] * y[4] + y[5] * y[5])
        dynamical = r / max(speed, np.sqrt(mu / r))
        clock[STEP] = min(3.0 * tolerance**0.125 * dynamical, largest_step)
    edged = p.callbacks.edges != 0 and (tolerance < WORTH_A_STEP or p.sides.needed != 0)
    row, ended = open_block(count)
    pause = count[STEPS] + count[REJECTED] + (int(piece) if piece > 0.0 else first_piece(p))
    t, interval = clock[TIME], count[INTERVAL]
    factor = factors[interval] * count[IN_USE]
    while True:
        row = rows_until(t, s, t_out, out, row, VECTOR)
        if row >= n or ended:
            break
        if count[EVENTS] > MOST_EVENTS:
            count[STATUS] = EVENTS_FULL
            break
        if count[STEPS] + count[REJECTED] >= pause:
            count[STATUS] = PAUSED
            break
        # one accepted step, landing on the next kink of the thrust or of other forces, or on the end
        limit = target = next_limit(breaks, interval, t_end)
        if edged:
            target, jumps = next_edge(t, limit, min(1.01 * clock[STEP], largest_step), y, k[0], p)
            if jumps:
                derivative(t, y, factor, p, k[0])
        h, landing, rejected, wish, error = attempt(
            t, target, clock[STEP], largest_step, t_end, tolerance, factor, p, k, count, mu
        )
        if count[STATUS] != DONE:
            break
        clock[STEP] = next_step(h, landing, rejected, wish, error)
        count[STEPS] += 1
        t0 = t
        t = target if landing else t + h
        touched, passed = surface_met(y, new, mu, surface)
        clock[DENSE_START], clock[DENSE_STEP] = t0, h
        if watched > 0 or touched or passed or t_out[row] < t:
            interpolant(t0, h, factor, p, k, m)
        stop_x = 2.0
        if watched > 0 or touched or passed:
            stop_x = happenings(s, watch, t0, h, touched, passed, EVENT_SAMPLES, factor, p, new, w)
        if stop_x < 2.0:
            t = t0 + stop_x * h
        interval, factor, jumps = settle(s, breaks, factors, p, t, limit, t_end, stop_x < 2.0, interval, factor)
        if jumps:
            derivative(t, y, factor, p, k[0])
        ended = count[STATUS] != DONE
    p.held.active = 0  # who looks at the model from outside sees every place as it is
    return close_block(s, t_out, row, ended)
