"""Adaptive integration of one smooth trajectory: Gauss-Legendre collocation of order 16, eight forces at once.

Rows are read off the polynomial of a step, of degree 9 in the position; events are its roots; steps land on every time
at which the thrust factor or the steering table has a kink. A step that an event cuts short is made again, shorter, so
that what follows starts from the end of a step, which is far more accurate than its inside.

`Integration` keeps everything between calls of `advance`, so a run may be computed in blocks of any size and is the
same to the last bit. Source of the method: gauss_legendre.py; what a step does: collocation_steps.py.
"""

from __future__ import annotations

from struct import Struct
from typing import Any

import numpy as np

from sailviz.compiled import apart, entry, inlined
from sailviz.propagate.collocation_forces import fits_lanes, is_table, prepare
from sailviz.propagate.collocation_memory import (
    BEFORE,
    CLOSEST,
    HELD,
    JUMPED,
    LAST_ERROR,
    LAST_STEP,
    LENGTH,
    NODE,
    PEAK,
    POWERS,
    SCALE,
    SINCE,
    SPAN,
    aligned_stack,
    in_one_row,
    load,
    node,
    store,
    total,
)
from sailviz.propagate.collocation_steps import (
    by_powers,
    fill_rows,
    keep_end,
    keep_polynomial,
    missing,
    rows_before,
    sweep,
)
from sailviz.propagate.dynamics import SIZE
from sailviz.propagate.events import APSIS, RADIUS, Watch, measure
from sailviz.propagate.parameters import PARAMETERS
from sailviz.propagate.patience import first_piece
from sailviz.propagate.step_events import evaluate, events_until, root
from sailviz.propagate.stepping import (
    CLOCK,
    EVENTS,
    IN_USE,
    INTERVAL,
    MOST_EVENTS,
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
    next_limit,
    open_block,
    settle,
)
from sailviz.propagate.stepping import DONE as DONE
from sailviz.propagate.stepping import EVENTS_FULL as EVENTS_FULL
from sailviz.propagate.stepping import NOT_FINITE as NOT_FINITE
from sailviz.propagate.stepping import UNDERFLOW as UNDERFLOW
from sailviz.propagate.stepping import drain_events as drain_events
from sailviz.propagate.stepping import rows_done as rows_done
from sailviz.propagate.stepping import statistics as statistics
from sailviz.propulsion.devices import CALLED, NO_DEVICE, THRUSTER

MOST_SAMPLES = 16  # of a step, when events are looked for
SAMPLES_A_RADIAN = 10.0  # of a circular orbit at the distance of the start of the step
SAFETY, SHRINK_MOST, GROW_MOST, BEARABLE = 0.91, 0.4, 2.0, 1.5  # of the step-size controller
LONG = 200.0  # rad of the whole run, at the rate of its start, beyond which what rounding takes is kept
ROUND, MANY = 0.15, 1000.0  # eccentricity below, rad beyond which the steps of a run are of one length
COARSEST, STEADY = 5e-9, 0.03  # of their dense errors: see bounds
AIM, CALM = 0.7, 0.3  # error over what is bearable that a new length is to have; below which a length is too short
PIECES = 4  # of a step, in which its distance from the centre is looked at ahead
STEEP = 16  # the power of the length with which the error of such steps grows, as measured: at most
WORST = 1.5  # asked over what a step may err by: so calibrated, smooth flights err by 0.1 to 0.9 of what is asked
ORDER = 9  # of the velocity between the nodes; the position has one more
POLYNOMIAL = 28  # rows of Integration.work from here on: coefficients of the last step's polynomial in s
NODES = POLYNOMIAL + POWERS  # from here on: LENGTH numbers, whose places stand in collocation_memory
SWEEPS = 9  # place in Integration.counter, after those that all integrators have


# a flight of some tens of microseconds is not to wait for its memory: compiled code clears what has to be clear
_ROWS, _NO_SIGNS, _NO_EVENTS = (NODES + 1 + LENGTH // SIZE, SIZE), np.zeros(0), (1, 9)
_begun, _empty = np.eye(10, dtype=np.int64)[IN_USE].copy, np.empty  # a counter of 0 but IN_USE, which is 1
_write_state: Any = Struct(f"{SIZE}d{(CLOCK - Y - 1) * SIZE * 8}xd").pack_into  # into the row Y, and TIME
_STATE, _integration = Y * SIZE * 8, tuple.__new__


def start(t, position, velocity, mass, events=0) -> Integration:
    """A fresh Integration at time s, position m, velocity m/s, mass kg, with room for a number of events."""
    work = _empty(_ROWS)
    (x, y, z), (vx, vy, vz) = position, velocity
    _write_state(work, _STATE, x, y, z, vx, vy, vz, mass, t)
    if events == 0:
        return _integration(Integration, (work, _begun(), _NO_SIGNS, _empty(_NO_EVENTS)))
    event = np.empty((MOST_EVENTS + TWICE * MOST_SAMPLES * events + 1, 9))
    return Integration(work, _begun(), np.zeros(events), event)


def advance(s, model, breaks, factors, watch, t_out, out, t_end, tolerance, largest_step, patience=None) -> int:
    """Integrate until every row of the block is filled, or until something ends the run: as dop853.advance, in every
    argument and status. tolerance : of the position over the distance, and of the velocity over the larger of speed and
    circular speed, in every row."""
    if patience is None:  # without what takes a twentieth of a flight of twenty microseconds
        status = advance_compiled.at_once(
            s[0], s[1], s[2], s[3], model.parameters, breaks, factors,
            watch[0], watch[1], watch[2], watch[3], t_out, out, t_end, tolerance, largest_step, 0.0,
        )  # fmt: skip
        if status >= 0 and status != PAUSED:
            return status
    numbers = t_end, tolerance, largest_step
    return in_pieces(advance_compiled, s, model, (breaks, factors, *watch), t_out, out, numbers, patience)


@entry("D2 I1 D1 D2 R1 d1 D1 i1 d1 i1 i1 d1 D2 d d d d", PARAMETERS)
def advance_compiled(
    work, count, sign, event, parameters, breaks, factors,
    kinds, levels, senses, actions, t_out, out, t_end, tolerance, largest_step, piece,
):  # fmt: skip
    """`advance` with its tuples taken apart."""
    aligned_stack()
    s = Integration(work, count, sign, event)
    p = parameters[0]
    watch = Watch(kinds, levels, senses, actions)
    n = t_out.shape[0]
    mu, surface = p.gravity.mu, p.surface.radius
    clock, y, w, new = work[CLOCK], work[Y], work[W], work[NEW]
    polynomial = work[POLYNOMIAL:NODES]
    nodes = in_one_row(work, NODES * SIZE)
    watched = len(watch.kind)
    at_once = fits_lanes(p)
    burns = p.kinds.device == CALLED or (p.kinds.device == THRUSTER and p.thruster.inverse_exhaust != 0.0)
    burns = burns or p.callbacks.burns != 0
    varies = at_once and p.kinds.device != NO_DEVICE
    if count[STARTED] == 0:
        for i in range(LENGTH):
            nodes[i] = 0.0
        begin(s, watch, breaks, factors, p)
        store(nodes, NODE, node())
        nodes[SPAN] = t_end - clock[TIME]
        nodes[SCALE] = np.sqrt(y[0] * y[0] + y[1] * y[1] + y[2] * y[2])
        clock[STEP] = min(first_step(y, mu, tolerance), largest_step)
        nodes[SINCE] = clock[TIME]
    careful = nodes[SPAN] * np.sqrt(mu / nodes[SCALE] ** 3) > LONG
    row, ended = open_block(count)
    pause = count[STEPS] + count[REJECTED] + (int(piece) if piece > 0.0 else first_piece(p))
    t, interval = clock[TIME], count[INTERVAL]
    factor = factors[interval] * count[IN_USE]
    if varies:
        prepare(nodes, t, 0.0, factor, p)
    while True:
        while row < n and t_out[row] <= t:
            if t_out[row] == t:
                for j in range(out.shape[0]):
                    out[j, row] = y[j]
                row += 1
            else:
                last = rows_before(t_out, row, t)
                fill_rows(nodes, t_out, out, row, last)
                row = last
        if row >= n or ended:
            break
        if count[EVENTS] > MOST_EVENTS:
            count[STATUS] = EVENTS_FULL
            break
        if count[STEPS] + count[REJECTED] >= pause:
            count[STATUS] = PAUSED
            break
        limit = next_limit(breaks, interval, t_end)
        r, bearable, agreed, turn = bounds(y, mu, tolerance, nodes[SPAN], careful)
        needs = r, bearable, agreed, turn
        h, landing = attempt(s, nodes, t, limit, needs, largest_step, t_end, at_once, varies, burns, careful, factor, p)
        if count[STATUS] != DONE:
            break
        t0 = t
        t = limit if landing else t + h
        keep_polynomial(nodes, work, t0, h, burns)
        near = surface > 0.0 and nodes[CLOSEST] < surface + 0.1 * r
        stop_x = 2.0
        if watched > 0 or near:
            by_powers(nodes, polynomial)
            samples = min(MOST_SAMPLES, 2 + int(SAMPLES_A_RADIAN * h * np.sqrt(mu / (r * r * r))))
            contact = surface_met(polynomial, surface, mu, samples, w) if near else 2.0
            stop_x = events_until(
                s, watch, polynomial, t0 + 0.5 * h, 0.5 * h, -1.0, contact, samples, factor, p, new, w
            )
        fits = True
        if stop_x < 2.0:  # the step once more, as far as it goes
            t = t0 + 0.5 * h + 0.5 * h * stop_x
            h = t - t0
            if varies and is_table(p.kinds.steering):
                prepare(nodes, t0, h, factor, p)
            fits = h > 0.0 and sweep(nodes, work, t0, h, (agreed / (h * h)) ** 2, at_once, burns, careful, factor, p)[0]
            if fits:
                keep_polynomial(nodes, work, t0, h, burns)
        keep_end(nodes, work, h, burns, careful, fits)
        if stop_x < 2.0:
            note_end(s, t, new)
        interval, new_factor, _ = settle(s, breaks, factors, p, t, limit, t_end, stop_x < 2.0, interval, factor)
        if new_factor != factor and varies:
            prepare(nodes, t, 0.0, new_factor, p)
        if new_factor != factor:
            nodes[HELD] = min(nodes[HELD], JUMPED)
        factor = new_factor
        ended = count[STATUS] != DONE
    return close_block(s, t_out, row, ended)


@inlined
def attempt(s, nodes, t, limit, needs, largest_step, t_end, at_once, varies, burns, careful, factor, p):
    """One accepted step from t towards limit, or counter[STATUS] saying why there is none. Returns (h, whether it lands
    on the limit). needs : of `bounds`."""
    r, bearable, agreed, turn = needs
    count, clock = s.counter, s.work[CLOCK]
    wish, rejected = clock[STEP], False
    smallest = max(abs(t), abs(t_end))
    if turn == 0.0 and nodes[LAST_ERROR] > 0.0:
        most = max(wish, GROW_MOST * nodes[LAST_STEP])
        wish = min(most, wish * nearer(nodes, s.work[Y], wish))
    while True:
        h = min(wish, largest_step)
        landing = t + 1.01 * h >= limit
        h = limit - t if landing else (t + h) - t  # exactly what the time will have moved
        if h <= 4.0e-16 * smallest and not landing:
            count[STATUS] = UNDERFLOW
            return h, landing
        if varies and is_table(p.kinds.steering):
            prepare(nodes, t, h, factor, p)
        fits, sweeps = sweep(nodes, s.work, t, h, (agreed / (h * h)) ** 2, at_once, burns, careful, factor, p)
        count[SWEEPS] += sweeps
        # P_8 integrated once leaves 34 of the 1020 = 34 30
        error = missing(nodes, h, r, s.work[Y, 6], burns) / bearable * (30.0 / h) if fits else np.inf
        if error <= BEARABLE:
            break
        nodes[PEAK], nodes[SINCE] = 0.0, t
        if error < np.inf and turn > 0.0:
            wish = h * max(SHRINK_MOST, (AIM / error) ** (1.0 / STEEP))
        elif error < np.inf:
            wish = h * growth(error)
        else:
            wish = 0.3 * h  # leave a singular spot slowly; give up when even a tiny step is not finite
            if wish <= 4.0e-14 * smallest:
                count[STATUS] = NOT_FINITE
                return h, landing
        rejected = True
        count[REJECTED] += 1
    if turn > 0.0:
        clock[STEP] = wish * steadily(nodes, t, error, turn)
        nodes[LAST_ERROR] = 0.0
        count[STEPS] += 1
        return h, landing
    grown = h * growth(error)
    # a step cut short by a landing must not shorten the next one
    clock[STEP] = max(grown, wish) if landing and not rejected else grown
    nodes[LAST_STEP], nodes[LAST_ERROR] = h, error
    count[STEPS] += 1
    return h, landing


@inlined
def nearer(nodes, y, h):
    """By how much the next step can be longer than h, or must be shorter, as it comes less or more near the centre than
    the last one did: by as much as the time scale there, as r^1.5, is longer.

    It is taken to come where a Kepler orbit with the present acceleration along the radius would: with mu = r^2 times
    that, the second derivative of r^2 is 4 energy + 2 mu / r.
    """
    r2 = y[0] * y[0] + y[1] * y[1] + y[2] * y[2]
    v2 = y[3] * y[3] + y[4] * y[4] + y[5] * y[5]
    r, inward = np.sqrt(r2), 0.0  # the last step's polynomial at its end
    for c in range(3):
        inward -= y[c] * total(load(nodes, BEFORE + 8 * c))
    mu = r * inward
    square, slope = r2, 2.0 * (y[0] * y[3] + y[1] * y[4] + y[2] * y[5])
    energy, bend = 2.0 * v2 - 4.0 * inward, 2.0 * (v2 - inward)
    piece, low, reached, closest = h / PIECES, r2, 0.0, nodes[CLOSEST]
    scale = 1.0 / (closest * closest * closest * closest * closest * closest)
    for k in range(1, 2 * PIECES + 1):
        slope += 0.5 * piece * bend
        square = max(square + piece * slope, 0.01 * low)
        bend = energy + 2.0 * mu / np.sqrt(square)
        slope += 0.5 * piece * bend
        low = min(low, square)
        longer = k / PIECES
        allowed = low * low * low * scale  # to the fourth power, of the length
        if longer * longer * longer * longer > allowed:
            return max(SHRINK_MOST, max(reached, np.sqrt(np.sqrt(allowed))))
        reached = longer
    return reached


@inlined
def note_end(s, t, new):
    """The events at the end of a shortened step have its state."""
    for i in range(s.counter[EVENTS]):
        if s.event[i, 1] == t:
            for j in range(SIZE):
                s.event[i, 2 + j] = new[j]


@inlined
def steadily(nodes, t, error, turn):
    """By how much the next step may be longer where steps stay as long as they are, until a turn, s, has shown that
    all of them may be longer."""
    nodes[PEAK] = max(nodes[PEAK], error)
    if t - nodes[SINCE] < turn:
        return 1.0
    peak = nodes[PEAK]
    nodes[PEAK], nodes[SINCE] = 0.0, t
    return min(GROW_MOST, (AIM / peak) ** (1.0 / STEEP)) if 0.0 < peak < CALM else 1.0


@inlined
def bounds(y, mu, tolerance, span, careful):
    """(distance from the centre, m; error of the velocity between the nodes that a step may have, m/s; how well its
    path and its forces must agree, m; the time of a turn, s, if steps are to keep their length, else 0) for a run of
    `span` s.

    The error is the tolerance's, unless the run is so long that the errors at the ends of the steps add up to more:
    measured on Kepler orbits of every eccentricity they are about 60 dense^1.6, both over the distance, partly cancel
    within a revolution and grow with the square of time; so does what path and forces disagree by.

    Steps of one length keep the energy, and what they err by grows with time alone: after 33,000 rad by 8e-10 with a
    dense error of 5e-9. So fly long runs on orbits that are nearly circular.
    """
    r2 = y[0] * y[0] + y[1] * y[1] + y[2] * y[2]
    v2 = y[3] * y[3] + y[4] * y[4] + y[5] * y[5]
    r = np.sqrt(r2)
    inverse_axis = max(0.0, 2.0 / r - v2 / mu)
    near = max(1.0, 1.0 / (r * inverse_axis)) if inverse_axis > 0.0 else 1.0
    turned = span * np.sqrt(mu / (r2 * r * near * near * near))
    wanted = tolerance / WORST
    speed = np.sqrt(max(v2, mu / r))
    agreed = min(wanted, 1e-6) * 0.01 / ((1.0 + (turned / 50.0) ** 2) * near * near * near)
    if careful and inverse_axis > 0.0 and turned > MANY:
        rv = y[0] * y[3] + y[1] * y[4] + y[2] * y[5]
        e2 = (1.0 - r * inverse_axis) ** 2 + rv * rv * inverse_axis / mu
        if e2 < ROUND * ROUND:
            dense = min(min(wanted, COARSEST), STEADY * np.sqrt(wanted / turned))
            return r, dense * speed, max(agreed, 1e-17) * r, 2.0 * np.pi * span / turned
    small = np.sqrt(wanted / (turned * turned * near * near * near))
    dense = min(wanted, small * np.sqrt(np.sqrt(small)))  # the square of small to the power 1 / 1.6
    return r, dense * speed, max(agreed, 2e-17) * r, 0.0  # less would be hidden by rounding


@inlined
def growth(error):
    """By how much a step like this one, with its error over what is bearable, may be longer."""
    if not error > 0.0:
        return GROW_MOST
    grow = SAFETY * error ** (-1.0 / ORDER)
    return min(GROW_MOST, max(SHRINK_MOST, grow))


@inlined
def first_step(y, mu, tolerance):
    """A length to try first, s: what a circular orbit would get."""
    r2 = y[0] * y[0] + y[1] * y[1] + y[2] * y[2]
    return 6.5 * tolerance ** (1.0 / ORDER) * np.sqrt(r2 * np.sqrt(r2) / mu)


@apart
def surface_met(polynomial, surface, mu, samples, w):
    """s at which the polynomial first comes below the surface, else 2."""
    before, falling = -1.0, False
    for k in range(samples + 1):
        here = -1.0 + 2.0 * k / samples
        evaluate(polynomial, here, w)
        below, falls = measure(RADIUS, surface, w, mu) < 0.0, measure(APSIS, 0.0, w, mu) < 0.0
        deepest = here
        if k > 0 and falling and not falls and not below:  # a periapsis on the way
            deepest = root(polynomial, APSIS, 0.0, mu, before, here, -1.0, w)
            below = measure(RADIUS, surface, w, mu) < 0.0
        if below:
            return root(polynomial, RADIUS, surface, mu, before, deepest, 1.0, w)
        before, falling = here, falls
    return 2.0
