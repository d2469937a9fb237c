"""Whether some normal of the sail between two rows leads from one to the other: what a file leaves open is chosen in
its favour, as the competition does."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sailviz.checks.gtoc13.rules import STEP_ERROR
from sailviz.checks.gtoc13.sail import Steps, fly, one_step, unit

Floats = NDArray[np.float64]

ROUNDS = 20
NUDGE = 1e-5  # rad
FARTHEST_TURN = 0.5  # rad in one round


class StepErrors(NamedTuple):
    """Of steps (n,): error of the Runge-Kutta step and of the true motion, relative to the way and to the change of
    velocity, whichever is worse; middle (n, 3): the normal in the middle with which the craft truly flies best;
    nearest: as in `sail.Flown`."""

    by_one_step: Floats
    truly: Floats
    middle: Floats
    nearest: list[tuple[int, float, float]]


def step_errors(steps: Steps, wanted: Floats, free: NDArray[np.bool_]) -> StepErrors:
    """How far from the next rows, wanted (n, 6), steps end. The normal in the middle is as steps have it; where that
    leads astray and free (n,) is true, the one that leads closest."""
    simple, middle = _best(steps, wanted, one_step, free)
    steps = steps._replace(middle=middle)
    flown = fly(steps)
    truly = _size(_off(flown.state, steps, wanted))
    astray = np.flatnonzero(~(truly < STEP_ERROR) & np.isfinite(truly) & (simple < STEP_ERROR))
    if len(astray):
        some = steps.at(astray)
        _, better = _best(some, wanted[astray], lambda tried: fly(tried, watch=False).state, free[astray])
        middle = middle.copy()
        middle[astray] = better
        again = fly(some._replace(middle=better))
        truly[astray] = _size(_off(again.state, some, wanted[astray]))
        kept = [item for item in flown.nearest if item[0] not in set(astray.tolist())]
        flown = flown._replace(nearest=kept + [(int(astray[i]), t, r) for i, t, r in again.nearest])
    truly = np.where(np.isfinite(truly), truly, np.inf)
    return StepErrors(np.where(np.isfinite(simple), simple, np.inf), truly, middle, flown.nearest)


def edge_on_at_most(steps: Steps) -> Steps:
    """The steps, normals in the middle turned edge-on where they turned their back on the star: a file says nothing of
    them, and so they break no rule."""
    return steps._replace(middle=_facing(steps.middle, steps))


def _best(
    steps: Steps, wanted: Floats, flight: Callable[[Steps], Floats], free: NDArray[np.bool_]
) -> tuple[Floats, Floats]:
    """Errors (n,) and normals in the middle (n, 3) of steps flown in some way."""
    middle = steps.middle
    error = _size(_off(flight(steps), steps, wanted))
    sunward = unit(-steps.state[:, :3])
    mean = unit(steps.before + steps.after)
    for start in (steps.middle, steps.before, steps.after, unit(mean + 0.5 * sunward), sunward):
        # a normal without length pushes nothing, and has no neighbours to look for
        pushed = free & (np.linalg.norm(mean, axis=1) > 0)
        astray = np.flatnonzero(~(error < STEP_ERROR) & np.isfinite(error) & pushed)
        if not len(astray):
            break
        found, better = _least_squares(steps.at(astray)._replace(middle=start[astray]), wanted[astray], flight)
        gained = found < error[astray]
        error[astray[gained]] = found[gained]
        middle = middle.copy()
        middle[astray[gained]] = better[gained]
    return error, middle


def _off(state: Floats, steps: Steps, wanted: Floats) -> Floats:
    """Misses (n, 6): of the place over the way to the next row, of the velocity over its change."""
    change = np.linalg.norm((wanted - steps.state).reshape(-1, 2, 3), axis=2)
    with np.errstate(all="ignore"):
        share: Floats = (state - wanted) / np.repeat(np.maximum(change, 1e-30), 3, axis=1)
        return share


def _size(off: Floats) -> Floats:
    found: Floats = np.linalg.norm(off.reshape(-1, 2, 3), axis=2).max(axis=1)
    return found


def _least_squares(steps: Steps, wanted: Floats, flight: Callable[[Steps], Floats]) -> tuple[Floats, Floats]:
    """Smallest errors (n,) over the two angles of the normal in the middle, and that normal (n, 3), which never turns
    its back on the star: Levenberg's and Marquardt's method, every step by itself."""
    middle = _facing(steps.middle, steps)
    off = _off(flight(steps._replace(middle=middle)), steps, wanted)
    damping = np.full(len(middle), 1e-3)
    active = np.arange(len(middle))
    for _ in range(ROUNDS):
        active = active[~(_size(off[active]) < STEP_ERROR)]
        if not len(active):
            break
        some, here, target, now = steps.at(active), middle[active], wanted[active], off[active]
        across, along = _beside(here)
        slopes = [
            (_off(flight(some._replace(middle=unit(here + NUDGE * way))), some, target) - now) / NUDGE
            for way in (across, along)
        ]
        a, b, c = (np.sum(slopes[i] * slopes[j], axis=1) for i, j in ((0, 0), (0, 1), (1, 1)))
        p, q = (-np.sum(slope * now, axis=1) for slope in slopes)
        a, c = a * (1 + damping[active]) + 1e-14, c * (1 + damping[active]) + 1e-14
        turn = np.stack([p * c - q * b, q * a - p * b], axis=1) / (a * c - b * b)[:, None]
        turn *= np.minimum(1.0, FARTHEST_TURN / np.maximum(np.linalg.norm(turn, axis=1), 1e-300))[:, None]
        tried = _facing(unit(here + turn[:, :1] * across + turn[:, 1:] * along), some)
        reached = _off(flight(some._replace(middle=tried)), some, target)
        better = np.sum(reached**2, axis=1) < np.sum(now**2, axis=1)
        middle[active[better]], off[active[better]] = tried[better], reached[better]
        damping[active] = np.clip(np.where(better, damping[active] / 5, damping[active] * 8), 1e-9, 1e9)
    return _size(off), middle


def _facing(normal: Floats, steps: Steps) -> Floats:
    """Normals turned edge-on where they turned their back on the star; those straight away from it push nothing."""
    sunward = unit(-steps.state[:, :3])
    cosine = np.sum(normal * sunward, axis=1, keepdims=True)
    return unit(np.where(cosine < 0.0, normal - cosine * sunward, normal))


def _beside(normal: Floats) -> tuple[Floats, Floats]:
    """Two directions at right angles to normals and to each other."""
    axis = np.eye(3)[np.argmin(np.abs(normal), axis=1)]
    across = unit(np.cross(normal, axis))
    return across, np.cross(normal, across)
