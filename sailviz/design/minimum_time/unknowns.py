"""The unknowns of a fastest flight in space, and the search for those that leave no residual.

Costates are found up to a factor, with |lam| = 1, and the flight time with them; where or when the flight departs is
held by each search.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass

import numpy as np

from sailviz.design.minimum_time.shooting import solve

LOOSE, TIGHT = 1e-9, 1e-13  # tolerances of the propagation: on the way, and of the result
NEAR, EXACT = 1e-5, 1e-9  # boundary miss that is worth polishing, and that counts as solved
SMOOTHING = 0.03  # eps of an E-sail's switch while departures are searched
SHARPER = (0.01, 3e-3, 1e-3, 3e-4, 0.0)  # on the way back to the true sail
SAME = 1e-6  # relative flight time below which two solutions are one
SHORTEST = 1e-6  # flight time of a flight whatever its unknowns say

_COSTATES, _SPAN = slice(0, 6), 6  # places of the packed unknowns


@dataclass(frozen=True, eq=False)
class Unknowns:
    """costates (6,) at departure, span: the flight time, both in units of mu = 1 and one au; departure: true anomaly
    rad on an orbit, or s after the epoch from a planet."""

    costates: np.ndarray
    span: float
    departure: float

    @property
    def packed(self) -> np.ndarray:
        """(7,) costates and span, as the search varies them."""
        return np.append(self.costates, self.span)

    @classmethod
    def unpacked(cls, packed: np.ndarray, departure: float) -> Unknowns:
        """From (7,) costates and span."""
        return cls(packed[_COSTATES], float(packed[_SPAN]), departure)

    def ahead(self, before: Unknowns, step: float, last: float) -> Unknowns:
        """On a step further along the line on which a last step led here from the unknowns before."""
        packed = self.packed
        return Unknowns.unpacked(packed + (packed - before.packed) * step / last, self.departure)


def columns(batch: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Costates (m, 6) and flight times (m,), kept above zero, of packed unknowns (m, 7)."""
    return batch[:, _COSTATES], np.maximum(batch[:, _SPAN], SHORTEST)


def with_unit_length(misses: np.ndarray, costates: np.ndarray) -> np.ndarray:
    """(m, k + 1): misses (m, k) and |lam|^2 - 1 of costates (m, 6)."""
    both = np.empty((len(misses), misses.shape[1] + 1))
    both[:, :-1], both[:, -1] = misses, (costates * costates).sum(axis=1) - 1.0
    return both


def solved(
    residuals: Callable[[np.ndarray], np.ndarray], guess: Unknowns, tolerance: float, most: int | None = None
) -> tuple[Unknowns, float]:
    """The unknowns near a guess, its departure kept, that bring residuals(batch (m, 7)) -> (m, k) to zero, and the
    largest residual left. tolerance : of the propagation behind the residuals; TIGHT polishes. most : steps."""
    tight = tolerance < LOOSE
    found = solve(
        residuals,
        guess.packed,
        step=1e-7 if tight else 1e-6,
        goal=1e-13 if tight else 1e-7,
        most=most or (10 if tight else 60),
        limit=np.array([0.3] * 6 + [0.25 * guess.span]),
    )
    return Unknowns.unpacked(found.unknowns, guess.departure), found.residual


def span_of(unknowns: Unknowns) -> float:
    """The flight time, by which flights are compared."""
    return unknowns.span


def fastest(flights: Iterable[Unknowns | None]) -> Unknowns | None:
    """The fastest of the flights that there are."""
    return min((x for x in flights if x is not None), key=span_of, default=None)


def distinct(flights: Iterable[Unknowns | None]) -> list[Unknowns]:
    """The flights that there are, fastest first, each flight time once."""
    found = sorted((x for x in flights if x is not None), key=span_of)
    return [x for i, x in enumerate(found) if i == 0 or x.span > found[i - 1].span * (1 + SAME)]
