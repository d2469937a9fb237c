"""When anything changes in an ensemble's flights, cut into segments, and how finely each of them must be integrated."""

from __future__ import annotations

import numpy as np

from sailviz.propagate.ensemble.draws import GIVEN
from sailviz.propagate.ensemble.flights import HEIGHT, LANES, RHO, THETA, Plan, U, W, Wind, record_flights
from sailviz.propulsion import voltage_control

SAME = 1e-10  # of the duration: times closer than this are one
STEP = 0.02  # first guess of a step, in units of sqrt(r^3 / mu): 1.2 days at 1 au
MOST_REFINEMENTS = 8
MOST_STEPS = 300_000  # of one flight: more are asked for only where flights dive towards the centre


def marks(interval, duration):
    """Times 0, interval, 2 interval, ... before the end; 0 alone for an infinite interval."""
    if not interval < duration:
        return np.zeros(1)
    times = interval * np.arange(int(np.ceil(duration / interval)) + 1)
    return times[times < duration * (1 - SAME)]


def _merged(times, duration):
    """Sorted times without those that all but repeat an earlier one."""
    times = np.sort(times)
    return times[np.diff(times, prepend=-np.inf) > SAME * duration]


def _places(edges, times, duration):
    """Index of the edge at each time."""
    return np.searchsorted(edges, np.asarray(times) - SAME * duration)


def segments(start, duration, *, mu, frame, steering_times, strength, outputs, redraw, update, new_level):
    """(Plan with single steps and no aim, output times (n,)).

    start (6,) as in Plan; steering_times (k,) from 0 on and strength (k, 6) that holds from each on; redraw, update,
    new_level : intervals between changes of wind, voltage and slow factor, infinite for never again; outputs : times
    (n,), or a number of outputs, which are then moved to where a segment begins anyway if there are enough.
    """
    changes = [marks(interval, duration) for interval in (redraw, update, new_level)]
    held = np.asarray(steering_times, float)
    edges = _merged(np.concatenate([*changes, held[held < duration * (1 - SAME)], [0.0, duration]]), duration)
    if np.ndim(outputs):
        times = np.asarray(outputs, dtype=float)
    elif len(edges) >= outputs:
        times = edges[np.unique(np.rint(np.linspace(0, len(edges) - 1, outputs)).astype(int))]
    else:
        times = np.linspace(0, duration, outputs)
    edges = _merged(np.concatenate([edges, times]), duration)
    count = len(edges) - 1
    flags = np.zeros((3, count), dtype=bool)
    for row, at in zip(flags, changes, strict=True):
        row[_places(edges, at, duration)] = True
    output = np.full(count + 1, -1)
    output[_places(edges, times, duration)] = np.arange(len(times))
    rows = np.searchsorted(held, edges[:-1] + SAME * duration, side="right") - 1
    plan = Plan(
        start=np.asarray(start, dtype=float),
        span=np.diff(edges),
        substeps=np.ones(count, dtype=np.int64),
        strength=np.ascontiguousarray(np.asarray(strength, dtype=float)[np.maximum(rows, 0)]),
        redraw=flags[0],
        new_level=flags[2],
        update=flags[1],
        output=output,
        aim=np.ones((count, 2)),
        frame=frame,
        mu=float(mu),
    )
    return plan, times


def calm(pressure):
    """A wind that stays at one pressure (or irradiance)."""
    none = np.zeros(2)
    return Wind(GIVEN, 0, 0.0, 0.0, 1.0, none, 0.0, np.full((1, 1), float(pressure)), 0)


def nominal(plan: Plan, control):
    """States (segments + 1, 6) of the flight with thrust factor 1 at the edges of all segments."""
    steady = control.copy()
    steady[voltage_control.KIND] = voltage_control.CONSTANT
    steady[voltage_control.POWER] = 0.0
    everywhere = plan._replace(output=np.arange(len(plan.span) + 1))
    return record_flights(everywhere, calm(control[voltage_control.P_REF]), steady, 1).record[0, :, :6]


def distance(states):
    """Distance from the central body and radial speed of cylindrical states (..., 6), each (...)."""
    rho, z = states[..., RHO], states[..., HEIGHT]
    r = np.hypot(rho, z)
    return r, (rho * states[..., U] + z * states[..., W]) / r


def _difference(a, b):
    """Largest distance between flights of equal times (flights, n, 6+), as a share of the distance from the body."""
    rho = b[..., RHO]
    r = np.hypot(rho, b[..., HEIGHT])
    along = rho * (a[..., THETA] - b[..., THETA])
    square = (a[..., RHO] - rho) ** 2 + along**2 + (a[..., HEIGHT] - b[..., HEIGHT]) ** 2
    return float(np.max(np.sqrt(square) / r))


def refined(plan: Plan, wind: Wind, control, tolerance, aim=None):
    """(the plan with aim and substeps, error): the first LANES flights, integrated with steps and half steps, differ by
    less than the tolerance, as a share of the distance from the central body; error is that of the plan, estimated from
    the difference. aim : (distance, radial speed) for the distance law to hold; without it, those of the nominal
    flight. ValueError if MOST_REFINEMENTS do not reach it."""
    rough = distance(nominal(plan, control))[0]
    shortest = STEP * np.sqrt(np.minimum(rough[:-1], rough[1:]) ** 3 / plan.mu)
    plan = plan._replace(substeps=np.maximum(1, np.ceil(plan.span / shortest * (1 - 1e-9))).astype(np.int64))
    for _ in range(MOST_REFINEMENTS):
        track = nominal(plan, control)
        lead = np.column_stack(distance(track))[:-1] if aim is None else np.tile(np.asarray(aim), (len(plan.span), 1))
        plan = plan._replace(aim=np.ascontiguousarray(lead))
        flown = record_flights(plan, wind, control, LANES).record
        fine = record_flights(plan._replace(substeps=2 * plan.substeps), wind, control, LANES).record
        error = 16 / 15 * _difference(flown, fine)  # of a method of fourth order
        if error <= 0.5 * tolerance:  # other flights may be worse than these
            return plan, error
        more = (error / (0.5 * tolerance)) ** 0.25 if np.isfinite(error) else 4.0
        plan = plan._replace(substeps=plan.substeps * int(min(max(2, np.ceil(more)), 8)))
        if plan.substeps.sum() > MOST_STEPS:
            break
    raise ValueError(
        f"no step brings the flights within {tolerance:g} of their distance; the last try erred by {error:.2g}: "
        "some flights dive towards the centre"
    )
