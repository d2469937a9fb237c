"""Fastest flights past the Sun for many sails and perihelion limits at once: one is sought, the others are followed.

A flight that touches its limit changes evenly with the sail's strength and the limit. From those found for one pair of
them, by `touching.search`, the flights of all others are followed, by secants. Where the jump comes to 0 on the way the
limit holds the flight no more, which then turns outside it by itself.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from sailviz.constants import GRAVITY_AT_1_AU
from sailviz.design.minimum_time import touching
from sailviz.design.minimum_time.boundary_conditions import hamiltonians
from sailviz.design.minimum_time.effort import Effort
from sailviz.design.minimum_time.finishing import Extremal, polished
from sailviz.design.minimum_time.from_touch import JUMP, FromTouch
from sailviz.design.minimum_time.planar_ends import AtRadius, ToEnd
from sailviz.design.minimum_time.planar_transfer import sail_from, time_unit
from sailviz.design.minimum_time.to_ends import Flown, Keeping, flown, keeps, longest_fall
from sailviz.design.minimum_time.touching import Touching
from sailviz.propulsion.solar_sail import Film

AT_LIMIT = 1e-6  # relative: a flight as near as that touches its limit


@dataclass(frozen=True)
class Assists:
    """time s, closest m, revolutions and jump (canonical, 0 of a flight that turns by itself) of the fastest flights
    found, each (n, k) over lightness (n,) and perihelion (k,) m; NaN where none was found."""

    time: np.ndarray
    closest: np.ndarray
    revolutions: np.ndarray
    jump: np.ndarray


def assists(
    initial_radius: float,
    final_radius: float,
    device: Film | str,
    lightness: npt.ArrayLike,
    perihelion: npt.ArrayLike,
    bases: npt.ArrayLike,
    effort: Effort | None = None,
) -> Assists:
    """Flights from a circle to a distance, both m, that pass the Sun no nearer than perihelion (k,) m, with sails of
    lightness (n,): characteristic acceleration over the Sun's pull at 1 au.

    bases : pairs (m, 2) of lightness and perihelion m for which flights are sought. Of a sail, a flight that turns by
    itself counts for all limits that it keeps to.
    """
    effort = effort or Effort()
    betas, limits = np.atleast_1d(lightness), np.atleast_1d(perihelion) / initial_radius
    branches = list[list[_Base]]()
    for pair in np.atleast_2d(bases):
        for base in _sought(pair, initial_radius, final_radius, device, effort):
            if not any(base.same(branch[0]) for branch in branches):
                branches.append([base])
    shape = len(betas), len(limits)
    result = Assists(*(np.full(shape, np.nan) for _ in range(4)))
    nearest_first = np.argsort(np.abs(np.log(betas / np.atleast_2d(bases)[0, 0])))
    for done, i in enumerate(nearest_first):
        flights, beta = list[Flown](), float(betas[i])
        flight = _flight(beta, initial_radius, final_radius, device)
        for limit in limits:
            for branch in branches:
                flights += _followed(flight, float(limit), beta, branch, effort)
        effort.report((done + 1) / len(betas), f"lightness {beta:g}")
        for k, limit in enumerate(limits):
            keeping = Keeping(perihelion=float(limit))
            own = [one for one in flights if not one.touches or one.closest < limit * (1 + AT_LIMIT)]
            allowed = [one for one in own if keeps(flight, one, keeping)]
            if allowed:
                best = min(allowed, key=lambda one: float(one.unknowns[3]))
                result.time[i, k] = best.unknowns[3] * time_unit(initial_radius)
                result.closest[i, k] = best.closest * initial_radius
                result.revolutions[i, k] = best.swept / (2 * np.pi)
                result.jump[i, k] = best.touches[0].jump if best.touches else 0.0
    return result


@dataclass(frozen=True)
class _Base:
    """A flight that was sought, or followed from one: lightness, limit, unknowns (7,) of its FromTouch."""

    lightness: float
    limit: float
    unknowns: np.ndarray

    def same(self, other: _Base) -> bool:
        """Whether it is the other one, found once more."""
        mine, theirs = np.array([self.lightness, self.limit, *self.unknowns]), [other.lightness, other.limit]
        return np.allclose(mine, [*theirs, *other.unknowns], rtol=1e-6, atol=1e-6)

    def far(self, lightness: float, limit: float) -> float:
        """How far it is from a sail and a limit, in logarithms."""
        return float(abs(np.log(self.lightness / lightness)) + abs(np.log(self.limit / limit)))


def _flight(lightness: float, first: float, last: float, device: Film | str) -> ToEnd:
    return ToEnd(sail_from(device, lightness * GRAVITY_AT_1_AU, first), AtRadius(last / first))


def _sought(pair: np.ndarray, first: float, last: float, device: Film | str, effort: Effort) -> Iterator[_Base]:
    lightness, limit = float(pair[0]), float(pair[1]) / first
    flight = _flight(lightness, first, last, device)
    problem = FromTouch(flight, limit)
    for rough in touching.joined(problem, longest_fall(flight, device), effort):
        x = problem.solved(rough, effort)
        if x is not None and x[JUMP] < 0:
            yield _Base(lightness, limit, x)


def _followed(flight: ToEnd, limit: float, lightness: float, branch: list[_Base], effort: Effort) -> Iterator[Flown]:
    """What the flight of a branch that is nearest becomes for another sail and limit; it is added to the branch."""
    own, base = FromTouch(flight, limit), min(branch, key=lambda one: one.far(lightness, limit))
    x = touching.followed(own, base.lightness / lightness, base.limit / limit, base.unknowns, effort)
    if x is None:
        return
    branch.append(_Base(lightness, limit, x))
    touches = x[JUMP] < 0
    problem, exact = Touching(flight, limit), None
    if touches:
        exact = problem.polish(own.from_departure(x), effort)
    else:
        alone = own.freed(x, effort)
        exact = None if alone is None else polished(flight, alone, effort)
    if exact is not None and hamiltonians(flight.starts(exact.unknowns[None]), flight.sail)[0] > 0:
        yield flown(flight, Extremal(exact.unknowns, exact.miss), problem if touches else None)
