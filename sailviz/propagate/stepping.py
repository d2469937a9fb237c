"""What the integrators share: the memory between calls, breaks of the thrust, rows from the polynomial of a step.

Each integrator makes steps in its own way and leaves every step as a polynomial in x = (t - t0) / h of degree up to
seven; from there on a row of output, what happens within the step (`step_events`) and the end of a run are the same for
all.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from sailviz.compiled import inlined
from sailviz.propagate.callbacks import call
from sailviz.propagate.dynamics import SIZE
from sailviz.propagate.events import (
    sign_at,
)
from sailviz.propagate.patience import GOES_ON, Patience
from sailviz.propagate.patience import NO_PROGRESS as NO_PROGRESS
from sailviz.propagate.patience import TIME_IS_UP as TIME_IS_UP
from sailviz.propagate.patience import TOO_MANY as TOO_MANY

EVENT_SAMPLES = 4  # at most per step, so that two crossings inside one step are seen
TWICE = 2  # crossings between two samples, at most, of a quantity that comes to its level and turns back
MOST_EVENTS = 4096  # recorded between two calls, and then those of one more step

# status of `advance`
DONE, STOPPED, EVENTS_FULL, UNDERFLOW, NOT_FINITE, SURFACE = range(6)
PAUSED = 6  # of compiled code alone: it has to be called again; what else there is says patience.py

# rows of Integration.work after the sixteen stages; one array, so that the optimiser knows that they do not overlap
Y, W, NEW = 16, 17, 18  # state at the start of the step, a state to evaluate, state at its end
DENSE, CLOCK = 19, 27  # eight rows of monomial coefficients over the last step; a row of times

# places in the CLOCK row and in Integration.counter
TIME, STEP, DENSE_START, DENSE_STEP = 0, 1, 2, 3
ROW, INTERVAL, IN_USE, STARTED, STEPS, REJECTED, EVENTS, STATUS, STOPPED_BY = 0, 1, 2, 3, 4, 5, 6, 7, 8


class Integration(NamedTuple):
    """Everything that an integration remembers between calls."""

    work: np.ndarray  # (28, SIZE) sixteen stages, the first the derivative at the state; then the rows named above
    counter: np.ndarray  # (9,) int64, see the places above
    sign: np.ndarray  # (events,) event functions at the state
    event: np.ndarray  # (MOST_EVENTS and those of one step, 9) index in the watch, time s, state


def time(s) -> float:
    """Time that the integration has reached, s."""
    return float(s.work[CLOCK, TIME])


def state(s) -> np.ndarray:
    """State (7,) that it has reached: position m, velocity m/s, mass kg."""
    return s.work[Y].copy()


def drain_events(s) -> list[tuple[int, float, np.ndarray]]:
    """(index in the watch, time s, state (7,)) of every event since the last call; makes room for more. Index -1 is
    contact with the surface."""
    n = int(s.counter[EVENTS])
    s.counter[EVENTS] = 0
    return [(int(row[0]), float(row[1]), row[2:].copy()) for row in s.event[:n]]


def in_use(s) -> bool:
    """False once an END_OF_USE event has switched the device off for good."""
    return bool(s.counter[IN_USE])


def stopped_by(s) -> int:
    """Index in the watch of the event that stopped the run, after STOPPED."""
    return int(s.counter[STOPPED_BY])


def rows_done(s) -> int:
    """Rows of the current block that are filled."""
    return int(s.counter[ROW])


def statistics(s) -> tuple[int, int]:
    """Accepted and rejected steps so far."""
    return int(s.counter[STEPS]), int(s.counter[REJECTED])


def in_pieces(compiled_advance, s, model, arguments, t_out, out, numbers, patience: Patience | None) -> int:
    """Let compiled code integrate, piece after piece, until it is done or patience ends. Returns a status.

    compiled_advance : takes s, the parameters, the arguments, the rows, the numbers (end of the run, tolerance, largest
    step) and the number of steps to try before it pauses, a float, as floats are handed over faster. out : may be part
    of a larger array.
    """
    rows = out if out.flags.c_contiguous else np.ascontiguousarray(out)
    piece = 0.0 if patience is None else patience.begin_piece()
    status = compiled_advance(*s, model.parameters, *arguments, t_out, rows, *numbers, piece)
    if status == PAUSED:
        given = (*s, model.parameters, *arguments, t_out, rows, *numbers)
        status = _further_pieces(compiled_advance, s, given, numbers[0], Patience() if patience is None else patience)
    if rows is not out:
        out[:] = rows
    return status


def _further_pieces(compiled_advance, s, given, t_end, patience: Patience) -> int:
    count = s.counter
    while True:
        status = patience.end_piece(int(count[STEPS] + count[REJECTED]), time(s), t_end)
        if status != GOES_ON:
            return status
        status = compiled_advance(*given, patience.begin_piece())
        if status != PAUSED:
            return status


@inlined
def factor_from(t, y, factors, interval, p):
    """Thrust factor from the break of this number on; a voltage controller, if there is one, sets it now, seeing the
    state y."""
    if p.callbacks.control != 0:
        x, yy, z, vx, vy, vz, m = y[0], y[1], y[2], y[3], y[4], y[5], y[6]
        factors[interval] = call(
            p.callbacks.control, p.places.control, t, x, yy, z, vx, vy, vz, m, 0.0, 0.0, 0.0,
            p, float(interval),
        )[0]  # fmt: skip
    return factors[interval]


@inlined
def fill(m, t0, h, t_out, out, first, last):
    """Rows first..last of out (components, n) at the times t_out (n,) from the polynomial of the step [t0, t0 + h]."""
    inverse = 1.0 / h
    times = t_out[first:last]
    for j in range(out.shape[0]):
        m0, m1, m2, m3 = m[0, j], m[1, j], m[2, j], m[3, j]
        m4, m5, m6, m7 = m[4, j], m[5, j], m[6, j], m[7, j]
        row = out[j][first:last]  # a slice of one row: its stride is known, the loop becomes vector code
        for i in range(len(times)):
            x = (times[i] - t0) * inverse
            row[i] = m0 + x * (m1 + x * (m2 + x * (m3 + x * (m4 + x * (m5 + x * (m6 + x * m7))))))


@inlined
def begin(s, watch, breaks, factors, p):
    """Find the interval of the thrust in which the start lies, set its factor, and keep the signs of the event
    functions there. The derivative is left to the caller, as in `settle`: called from here the right-hand side would be
    compiled into each integrator once more, which costs half as much again, and other last digits."""
    count, y, t = s.counter, s.work[Y], s.work[CLOCK, TIME]
    count[STARTED] = 1
    while count[INTERVAL] + 1 < len(breaks) and breaks[count[INTERVAL] + 1] <= t:
        count[INTERVAL] += 1
    factor = factor_from(t, y, factors, count[INTERVAL], p) * count[IN_USE]
    for e in range(len(watch.kind)):
        s.sign[e] = sign_at(watch.kind[e], watch.level[e], t, y, factor, p)


@inlined
def open_block(count):
    """(row at which this block goes on, whether the run has ended in a step of which rows are still to be filled)."""
    row = 0
    if count[STATUS] == EVENTS_FULL or count[STATUS] == PAUSED:
        row = count[ROW]
    ended = count[STATUS] == STOPPED or count[STATUS] == SURFACE
    if not ended:
        count[STATUS] = DONE
    return row, ended


@inlined
def rows_until(t, s, t_out, out, row, vector):
    """Fill the rows inside the last step, or exactly at its end t, by whole vectors; returns the first beyond."""
    n, clock, y = t_out.shape[0], s.work[CLOCK], s.work[Y]
    while row < n and t_out[row] <= t:
        if t_out[row] == t:
            for j in range(out.shape[0]):
                out[j, row] = y[j]
            row += 1
            continue
        last = row + 1
        while last < n and t_out[last] < t:
            last += 1
        # what is filled beyond the step is overwritten by the next
        whole = min(n, row + (last - row + vector - 1) // vector * vector)
        fill(s.work[DENSE:CLOCK], clock[DENSE_START], clock[DENSE_STEP], t_out, out, row, whole)
        row = last
    return row


@inlined
def next_limit(breaks, interval, t_end):
    """The next time at which the thrust has a kink, or the end."""
    limit = t_end
    if interval + 1 < len(breaks) and breaks[interval + 1] < limit:
        limit = breaks[interval + 1]
    return limit


@inlined
def next_edge(t, limit, span, y, derivative, p):
    """(time to which a step of at most span s from t should go so that it crosses no kink of the forces, whether they
    have jumped at t), by the callback that knows; the step keeps to what that holds in p."""
    x, yy, z, vx, vy, vz, m = y[0], y[1], y[2], y[3], y[4], y[5], y[6]
    ahead, jumps, _, _ = call(
        p.callbacks.edges, 0, t, x, yy, z, vx, vy, vz, m, derivative[3], derivative[4], derivative[5], p, span
    )
    return min(limit, t + ahead), jumps != 0.0


@inlined
def settle(s, breaks, factors, p, t, limit, t_end, cut, interval, factor):
    """Make the end of a step, in the row NEW, the state to go on from. cut : whether an event has cut it short. Returns
    the interval of the thrust, its factor, and whether the force jumps here, so that its derivative is to be made
    anew."""
    k, count = s.work, s.counter
    new = k[NEW]
    new_factor = factor
    if t == limit and limit < t_end and interval + 1 < len(breaks):
        interval += 1
        new_factor = factor_from(t, new, factors, interval, p)
    new_factor = new_factor * count[IN_USE]
    jumps = cut or new_factor != factor or (t == limit and limit < t_end)
    if not jumps:
        for j in range(SIZE):
            k[0, j] = k[12, j]
    for j in range(SIZE):
        k[Y, j] = new[j]
    k[CLOCK, TIME], count[INTERVAL] = t, interval
    return interval, new_factor, jumps


@inlined
def close_block(s, t_out, row, ended):
    """Remember how far the block is filled; returns the status."""
    n = t_out.shape[0]
    s.counter[ROW] = row
    if ended and row == n and n > 0 and t_out[n - 1] < s.work[CLOCK, TIME]:
        return DONE  # the next block may have rows before the end
    return s.counter[STATUS]
