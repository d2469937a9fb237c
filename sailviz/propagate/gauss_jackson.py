"""Fixed-step integration of many revolutions around one body: the summed Gauss-Jackson method with compensated sums.

Each step predicts position and velocity from LAGS accelerations, evaluates the force once, corrects, and adds to the
acceleration what the correction changes in the central attraction (to first order; the change of everything else is a
thousandth of that), which makes it as stable as a method with two evaluations. The method is the one of Berry and
Healy, Implementation of Gauss-Jackson Integration for Orbit Propagation, J. Astronaut. Sci. 52 (2004), a paper that was
not read: the formulae are re-derived in gauss_jackson_coefficients. What is new here is against rounding, which rules
the error of a year: the central attraction is kept with the part that a double loses, and so is the position at which
it is taken.

Everything that is no run of equal steps is done by error-controlled steps of DOP853: the LAGS points that the method
starts from, the way to a kink of the thrust factor, to the end of the run. A start is made anew after each kink, after
an event that changes the force, when the orbit has shrunk so that the step is too long, and when the acceleration
jumps by more than DISTRUST of itself. In between, rows and events are taken from the quintic polynomial through
position, velocity and acceleration at both ends of a step; its position is good to 4e-12 of the radius.

The step is ANGLE over the angular rate at periapsis. On low orbits with oblateness and drag a year then costs 1e-11 to
7e-10 of the radius, the most where a fall by several scale heights amplifies rounding. Mass stays constant.
"""

from __future__ import annotations

import numpy as np

from sailviz.compiled import entry
from sailviz.propagate import gauss_jackson_coefficients as c
from sailviz.propagate.dop853 import attempt, interpolant, next_step, stages
from sailviz.propagate.dynamics import SIZE, derivative, loses_mass
from sailviz.propagate.events import Watch
from sailviz.propagate.events import watch as no_events
from sailviz.propagate.gauss_jackson_coefficients import LAGS
from sailviz.propagate.gauss_jackson_steps import (
    ANCHOR,
    CHECK,
    GRID_STEP,
    HISTORY,
    LONGEST,
    MIDDLE_STATE,
    NEWEST,
    POINTS,
    REFINEMENT,
    SEAM_TOLERANCE,
    SHORTEST,
    SINCE,
    SUBSTEPS,
    Multistep,
    begin_sums,
    coast,
    keep_acceleration,
    quantum_of,
    quintic,
    step_rule,
)
from sailviz.propagate.parameters import PARAMETERS
from sailviz.propagate.patience import first_piece
from sailviz.propagate.step_events import happenings, surface_met
from sailviz.propagate.stepping import (
    CLOCK,
    DENSE,
    DENSE_START,
    DENSE_STEP,
    DONE,
    EVENT_SAMPLES,
    EVENTS,
    EVENTS_FULL,
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
    rows_until,
    settle,
)
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


def start(t, position, velocity, mass, events=0, refinement=1.0) -> Multistep:
    """A fresh Multistep at time s, position m, velocity m/s, mass kg, with room for a number of events. refinement
    divides the step."""
    work = np.zeros((28, SIZE))
    work[Y] = (*position, *velocity, mass)
    work[CLOCK, TIME] = work[CLOCK, DENSE_START] = t
    count = np.zeros(12, dtype=np.int64)
    count[IN_USE] = 1
    grid = np.zeros(21)
    grid[REFINEMENT] = refinement
    event = np.zeros((MOST_EVENTS * (events > 0) + TWICE * EVENT_SAMPLES * events + 1, 9))
    return Multistep(work, count, np.zeros(events), event, np.zeros((HISTORY, 4)), grid)


def advance(s, model, breaks, factors, watch, t_out, out, t_end, tolerance, largest_step, patience=None) -> int:
    """Integrate until every row of the block is filled, or until something ends the run: as dop853.advance, in every
    argument and status. tolerance : of the DOP853 steps, which take 1e-14 at most. ValueError for a thruster that
    loses mass."""
    if loses_mass(model):
        raise ValueError(
            "the Gauss-Jackson integrator keeps the mass constant; a thruster with a specific impulse does not."
        )
    others = model.parameters.copy()
    others["gravity"]["mu"] = 0.0
    numbers = t_end, tolerance, largest_step
    return in_pieces(advance_compiled, s, model, (others, breaks, factors, *watch), t_out, out, numbers, patience)


@entry("D2 I1 D1 D2 D2 D1 R1 R1 d1 D1 i1 d1 i1 i1 d1 D2 d d d d", PARAMETERS)
def advance_compiled(
    work, count, sign, event, history, grid, parameters, others, breaks, factors,
    kinds, levels, senses, actions, t_out, out, t_end, tolerance, largest_step, piece,
):  # fmt: skip
    """`advance` with its tuples taken apart."""
    s = Integration(work, count, sign, event)
    p = parameters[0]
    perturbations = others[0]  # all but the central attraction
    watch = Watch(kinds, levels, senses, actions)
    n = t_out.shape[0]
    mu, surface = p.gravity.mu, p.surface.radius
    k, m, clock = work, work[DENSE:CLOCK], work[CLOCK]
    y, w, new = k[Y], k[W], k[NEW]
    watched = len(watch.kind)
    tolerance = min(tolerance, SEAM_TOLERANCE)
    if count[STARTED] == 0:
        begin(s, watch, breaks, factors, p)
        derivative(clock[TIME], y, factors[count[INTERVAL]], p, k[0])
        clock[STEP] = step_rule(y, k[0], mu, grid[REFINEMENT], largest_step)[1]
    row, ended = open_block(count)
    pause = count[STEPS] + count[REJECTED] + (int(piece) if piece > 0.0 else first_piece(p))
    t, interval = clock[TIME], count[INTERVAL]
    factor = factors[interval] * count[IN_USE]
    while True:
        row = rows_until(t, s, t_out, out, row, 1)
        if row >= n or ended:
            break
        if count[EVENTS] > MOST_EVENTS:
            count[STATUS] = EVENTS_FULL
            break
        if count[STEPS] + count[REJECTED] >= pause:
            count[STATUS] = PAUSED
            break
        limit = next_limit(breaks, interval, t_end)

        made = 0
        if count[POINTS] >= LAGS:
            h = grid[GRID_STEP]
            # a periapsis between two steps is deeper than both by less than g h^2 / 8
            deep = surface + 0.2 * mu / (surface * surface) * h * h if surface > 0.0 else 0.0
            made = coast(
                s, history, grid, watch, t_out[row], limit - 0.01 * h, factor, perturbations, deep * deep, p
            )  # fmt: skip
            if made == 0:
                count[POINTS] = 0
        if made > 0:
            count[STEPS] += made
            t = grid[ANCHOR] + count[SINCE] * h
            t0 = grid[ANCHOR] + (count[SINCE] - 1) * h
            samples = 1
        else:
            target, aim = limit, largest_step
            if count[POINTS] == 0:
                suits, h = step_rule(y, k[0], mu, grid[REFINEMENT], largest_step)
                # not worth its start before a kink that is near
                if suits and limit - t > 2 * LAGS * h:
                    quantum = quantum_of(h)
                    target = np.ceil(t / quantum) * quantum
                    if target == t:
                        grid[ANCHOR], grid[GRID_STEP], count[SINCE] = t, np.floor(h / quantum) * quantum, 0
                        keep_acceleration(history, count, k[0])
            if count[POINTS] > 0:
                target = grid[ANCHOR] + (count[SINCE] + 1) * grid[GRID_STEP]
                aim = grid[GRID_STEP] / SUBSTEPS  # an error of the energy in the start counts for the whole run
            h, landing, rejected, wish, error = attempt(
                t, target, clock[STEP], aim, t_end, tolerance, factor, p, k, count, mu
            )
            if count[STATUS] != DONE:
                break
            clock[STEP] = next_step(h, landing, rejected, wish, error)
            count[STEPS] += 1
            t0 = t
            t = target if landing else t + h
            samples = EVENT_SAMPLES
            if count[POINTS] > 0 and rejected:
                count[POINTS] = 0  # something was in the way: begin after it
            elif count[POINTS] > 0 and landing:
                count[SINCE] += 1
                keep_acceleration(history, count, k[12])
                if count[POINTS] == LAGS - c.MIDDLE:
                    for j in range(6):
                        grid[MIDDLE_STATE + j] = new[j]
                if count[POINTS] == LAGS:
                    begin_sums(history, count[NEWEST], grid)

        touched, passed = surface_met(y, new, mu, surface)
        clock[DENSE_START], clock[DENSE_STEP] = t0, t - t0
        if watched > 0 or touched or passed or t_out[row] < t:
            if made > 0:
                quintic(y, k[0], new, k[12], h, m)
            else:
                interpolant(t0, h, factor, p, k, m)
        stop_x = 2.0
        if watched > 0 or touched or passed:
            stop_x = happenings(s, watch, t0, h, touched, passed, samples, factor, p, new, w)
        if stop_x < 2.0:
            t = t0 + stop_x * h
            if made > 0 and count[STATUS] == DONE:  # the run goes on from here: better than the quintic's velocity
                stages(t0, stop_x * h, t, factor, p, k)
        interval, factor, jumps = settle(s, breaks, factors, p, t, limit, t_end, stop_x < 2.0, interval, factor)
        if jumps:
            derivative(t, y, factor, p, k[0])
            count[POINTS] = 0
        if made > 0 and count[SINCE] % CHECK == 0 and count[POINTS] > 0:
            suits, wanted = step_rule(y, k[0], mu, grid[REFINEMENT], largest_step)
            if not suits or grid[GRID_STEP] > LONGEST * wanted or grid[GRID_STEP] < SHORTEST * wanted:
                count[POINTS] = 0
                clock[STEP] = wanted
        ended = count[STATUS] != DONE
    return close_block(s, t_out, row, ended)


def step(s: Multistep) -> float:
    """Length of the multistep method's present step, s; 0 before the first."""
    return float(s.grid[GRID_STEP])


def estimated_error(
    model,
    position,
    velocity,
    mass,
    times,
    breaks=(0.0,),
    factors=(1.0,),
    watch=None,
    largest_step=np.inf,
    refinement=1.0,
) -> np.ndarray:
    """Estimated error of the position, m, at times (n,) s of a run from time 0: its distance from a run with half the
    step. NaN after the end of either. Costs three times the run; resolves nothing below what rounding does to both,
    about 5e-10 of the radius in a year."""
    times = np.asarray(times, dtype=float)
    watch = no_events(()) if watch is None else watch
    runs = []
    for halves in (1.0, 2.0):
        s = start(0.0, position, velocity, mass, events=len(watch.kind), refinement=halves * refinement)
        out = np.full((6, len(times)), np.nan)
        arguments = (np.asarray(breaks, float), np.asarray(factors, float), watch, times, out, times[-1])
        while advance(s, model, *arguments, SEAM_TOLERANCE, np.inf) == EVENTS_FULL:
            drain_events(s)
        out[:, rows_done(s) :] = np.nan
        runs.append(out[:3])
    return np.linalg.norm(runs[0] - runs[1], axis=0)
