"""How accurate a run is: the beginning of it is flown again in steps half as long, and the difference told.

The error of one step, which the tolerance bounds, says little of a flight: errors add up, and close to a body they grow
with the square of time. So does what is measured here, with whatever comes after; it is said how far it was measured.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from sailviz.propagate import stepping
from sailviz.propagate.choice import ASKED, COLLOCATION, GAUSS_JACKSON
from sailviz.propagate.patience import Patience
from sailviz.simulation.integration import INTEGRATORS, begun
from sailviz.simulation.plan import Plan
from sailviz.words import duration

TURNS = 20  # revolutions over which the error is measured, at most
ROWS = 128  # places along it that are compared
MOST_STEPS = (
    200  # after which no other piece is begun: a millisecond of work round the Sun, six in the plasma of the Earth
)
ORDER = 8  # of Dormand-Prince: with steps half as long a step's error falls to 1/256
FINEST = 1e-15  # tolerance, below which rounding makes the steps


class Measured(NamedTuple):
    """The largest distance between a flight and one of finer steps."""

    error: float  # over the distance from the centre
    until: float  # s


def measured(p: Plan) -> Measured | None:
    """The error of a plan's flight over its beginning; None where steps half as long would only round,
    or where few of them lead nowhere."""
    run = p.scene.propagation
    finer = max(run.tolerance / 2**ORDER, FINEST)
    if p.choice.integrator != GAUSS_JACKSON and finer > 0.1 * run.tolerance:
        return None
    mu, r = p.body.mu, float(np.linalg.norm(p.position))
    axis = 1 / (2 / r - float(p.velocity @ p.velocity) / mu)
    longest_span = p.limit - p.begin
    span = longest_span if axis <= 0 else min(longest_span, TURNS * 2 * np.pi * np.sqrt(axis**3 / mu))
    kept = p.model.tables.copy() if p.schedule.law is not None else None
    longest = run.largest_step or np.inf
    times = np.linspace(p.begin, p.begin + span, ROWS + 1)
    coarse, accepted, rejected, reached = _flown(p, times, run.tolerance, longest, 1.0, MOST_STEPS)
    if coarse.shape[1] < ROWS / 4 and reached > p.begin:  # over what so many steps do reach
        times = np.linspace(p.begin, reached, ROWS + 1)
        coarse, accepted, rejected, _ = _flown(p, times, run.tolerance, longest, 1.0, MOST_STEPS)
    if accepted:  # where cells of tables decide on the steps, and no tolerance
        longest = 0.5 * min(longest, float(times[coarse.shape[1] - 1] - p.begin) / accepted)
    fine, _, _, _ = _flown(p, times[: coarse.shape[1]], finer, longest, 2.0, 6 * (accepted + rejected))
    if kept is not None:
        p.model.tables[:] = kept  # where a voltage controller notes what it does
    rows = fine.shape[1]
    if rows < 2:
        return None
    away = np.linalg.norm(coarse[:, :rows] - fine[:, :rows], axis=0) / np.linalg.norm(fine[:, :rows], axis=0)
    return Measured(float(away.max()), float(times[rows - 1]))


def _flown(
    p: Plan, times: np.ndarray, tolerance: float, longest: float, finer: float, most_steps: int
) -> tuple[np.ndarray, int, int, float]:
    """Positions (3, n) m at the first of the times (m,) s, the steps accepted and rejected, the time reached, s: until
    the flight ends, or so many steps have been tried."""
    method, state = INTEGRATORS[p.choice.integrator], begun(p, finer)
    model = p.model._replace(parameters=p.model.parameters.copy())
    out, end = np.empty((6, len(times))), p.limit
    given = (p.schedule.breaks, p.schedule.factors.copy(), p.watch, times, out, end, tolerance, longest)
    patience, status = Patience(most_steps), stepping.EVENTS_FULL
    while status == stepping.EVENTS_FULL:
        patience.next_piece(max(1, most_steps - sum(stepping.statistics(state))))  # whatever the time that they take
        status = method.advance(state, model, *given, patience)
        stepping.drain_events(state)
    return out[:3, : stepping.rows_done(state)], *stepping.statistics(state), stepping.time(state)


def how_in_words(p: Plan) -> str:
    """How the numbers of a plan's flight are made."""
    tolerance = p.scene.propagation.tolerance
    if p.choice.integrator == GAUSS_JACKSON:
        how = (
            f"Summed Gauss-Jackson, fixed step for a tolerance of {tolerance:g} of the distance, compensated sums, "
            "quintic output between the steps, float64; started and restarted by Dormand-Prince 8(5,3)."
        )
    elif p.choice.integrator == COLLOCATION:
        how = (
            f"Gauss-Legendre collocation of order 16, in steps that keep positions and velocities to {tolerance:g}, "
            "float64."
        )
    else:
        how = (
            f"Dormand-Prince 8(5,3) with dense output, relative tolerance {tolerance:g} per step (position against "
            "distance, velocity against the larger of speed and circular speed), float64."
        )
    if p.choice.reason != ASKED:
        how = f"{how} Chosen because {p.choice.reason}."
    return how


def accuracy_in_words(p: Plan, measure: bool) -> str:
    """How the numbers of a run are made, and how far off they are. measure : whether to find that out."""
    how = how_in_words(p)
    if not measure:
        return how
    found = measured(p)
    if found is None:
        return f"{how} Its error was not measured."
    whole = found.until >= p.scene.propagation.duration * (1 - 1e-12)
    span = "all of the flight" if whole else f"the first {duration(found.until)}"
    return f"{how} Within {rounded_up(found.error)} of the distance of a flight in steps half as long, over {span}."


def accuracy_of_phases(legs: list[tuple[str, Plan]], measure: bool) -> str:
    """The same of a flight in phases: (name, plan) of each, its limit where it ended. Measured in the first."""
    ways: dict[str, list[str]] = {}
    for name, p in legs:
        ways.setdefault(how_in_words(p), []).append(name)
    first = accuracy_in_words(legs[0][1], measure)
    if len(ways) == 1:
        return first
    others = [f"In {' and '.join(names)}: {how}" for how, names in list(ways.items())[1:]]
    return " ".join([f"In {' and '.join(next(iter(ways.values())))}: {first}", *others])


def rounded_up(error: float) -> str:
    """One digit, "3e-10", that is not below the error; rounding makes 1e-13."""
    error = max(error, 1e-13)
    power = np.floor(np.log10(error))
    digit = int(np.ceil(error / 10.0**power * (1 - 1e-9)))
    return f"{digit * 10.0**power:.0e}".replace("e-0", "e-")
