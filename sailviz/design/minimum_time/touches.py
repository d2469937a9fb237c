"""Flights whose costates jump on the way, where they touch a limit of their distance from the Sun: flown in pieces."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from sailviz.design.minimum_time import costates
from sailviz.design.minimum_time.costates import Flight
from sailviz.design.minimum_time.state_costate import LAM_R, POSITION, Sail


class Touch(NamedTuple):
    """Where a flight touches its limit: time, and by how much the costate of the radius jumps there."""

    time: float
    jump: float


def jumped(states: np.ndarray, jump: np.ndarray | float) -> np.ndarray:
    """States and costates (n, 12) after the costate along r has jumped by (n,)."""
    r = np.linalg.norm(states[:, POSITION], axis=1)
    after = states.copy()
    after[:, LAM_R] += (jump / r)[:, None] * states[:, POSITION]
    return after


class Piece(NamedTuple):
    """A flight between jumps: begin and length in time, state and costates (12,) at its begin, the flight."""

    begin: float
    length: float
    start: np.ndarray
    flight: Flight


def flown_in_pieces(
    start: npt.ArrayLike, span: float, sail: Sail, touches: Sequence[Touch] = (), times: npt.ArrayLike = ()
) -> list[Piece]:
    """A flight, `costates.propagate`, piece by piece between its jumps; a row at a jump is that before it."""
    moments = np.asarray(times, dtype=float)
    begin, y, flown = 0.0, np.asarray(start, dtype=float), list[Piece]()
    for i, until in enumerate([*(touch.time for touch in touches), span]):
        mine = moments[(moments <= until) & ((moments > begin) | (begin == 0.0))]
        length = until - begin
        flight = costates.propagate(y, length, sail, times=np.minimum(mine - begin, length))
        flown.append(Piece(begin, length, y, flight))
        if flight.reason or i == len(touches):
            break
        y, begin = jumped(flight.end[None], touches[i].jump)[0], until
    return flown


def propagate(
    start: npt.ArrayLike, span: float, sail: Sail, touches: Sequence[Touch] = (), times: npt.ArrayLike = ()
) -> Flight:
    """`costates.propagate` of a flight whose costates jump where it touches a limit."""
    flown = flown_in_pieces(start, span, sail, touches, times)
    first, last = flown[0].flight, flown[-1].flight
    return Flight(
        flown[-1].begin + last.time,
        last.end,
        np.concatenate([piece.flight.rows for piece in flown]),
        np.concatenate([piece.begin + piece.flight.switches for piece in flown]),
        first.hamiltonian,
        max(piece.flight.drift + abs(piece.flight.hamiltonian - first.hamiltonian) for piece in flown),
        sum(piece.flight.steps for piece in flown),
        last.reason,
    )
