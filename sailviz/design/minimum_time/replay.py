"""A solved minimum-time flight as data to fly it again: the primer in time, or a table of attitudes.

With the primer the sail is steered optimally at the craft's present place, and the flight repeats itself to the
accuracy of the integration. A table of pitch and clock angles is what a mission would load; read linearly, it is good
to the error asked for.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Protocol

import numpy as np
import numpy.typing as npt

from sailviz import frames
from sailviz.constants import AU
from sailviz.design.minimum_time.costates import Flight
from sailviz.design.minimum_time.singular_arcs import Arc, fly, switching, throttle_of_arcs
from sailviz.design.minimum_time.state_costate import (
    LAM_R,
    LAM_V,
    POSITION,
    SPEED_UNIT,
    TIME_UNIT,
    VELOCITY,
    canonical_sail,
)
from sailviz.design.minimum_time.touches import Touch, jumped, propagate
from sailviz.propulsion.solar_sail import Film
from sailviz.steering.optimal import optimal_pitch

FEWEST, MOST = 200, 200_000  # rows of a grid that is halved until it is fine enough
ARC_ERROR = 1e-11  # rad, of the primer of a flight in arcs, and so about of its throttle: its rows are few
BESIDE = 1e-9  # of the flight, from a switch to where its two sides are read
VANISHED = (
    1e-9  # the size of a primer, in that of the position's costate, below which it is rounding: 5 ms before an end
)


@dataclass(frozen=True)
class Solved:
    """What a flight starts from: position m and velocity m/s (3,), costates (6,) in units of mu = 1 and one au, time s,
    device, characteristic_acceleration m/s2. `OrbitTransfer` and `Rendezvous` have the same fields, but no arcs, those
    of an electric sail that uses partial voltage, no touches, where the costates jump (in the same units), and no
    coolness, what the film's heat allows: see `canonical_sail`."""

    position: np.ndarray
    velocity: np.ndarray
    costates: np.ndarray
    time: float
    device: Film | str
    characteristic_acceleration: float
    arcs: tuple[Arc, ...] = ()
    touches: tuple[Touch, ...] = ()
    coolness: float = 0.0


class Replayable(Protocol):
    """What `Solved`, `OrbitTransfer` and `Rendezvous` have in common."""

    @property
    def position(self) -> np.ndarray: ...
    @property
    def velocity(self) -> np.ndarray: ...
    @property
    def costates(self) -> np.ndarray: ...
    @property
    def time(self) -> float: ...
    @property
    def device(self) -> Film | str: ...
    @property
    def characteristic_acceleration(self) -> float: ...


def from_planar(
    start: npt.ArrayLike,
    radius: float,
    time: float,
    device: Film | str,
    characteristic_acceleration: float,
    arcs: tuple[Arc, ...] = (),
    touches: Sequence[Touch] = (),
    coolness: float = 0.0,
) -> Solved:
    """A Solved from state and costates (12,) in units of mu = 1 and a radius in m, as of circle-to-circle flights;
    touches in the same units."""
    a, start = radius / AU, np.asarray(start, dtype=float)
    position, velocity = start[POSITION] * radius, start[VELOCITY] * SPEED_UNIT / np.sqrt(a)
    lam = np.concatenate([start[LAM_R] * np.sqrt(a), start[LAM_V] * a**2])  # -d time / d (position, velocity)
    there = tuple(Touch(one.time * a**1.5, one.jump * float(np.sqrt(a))) for one in touches)
    a_c = float(characteristic_acceleration)
    return Solved(position, velocity, lam, float(time), device, a_c, arcs, there, coolness)


@dataclass(frozen=True)
class PrimerHistory:
    """The primer in time, for Hermite's cubic: time (n,) s; primer (n, 3) in s per m/s, what a push of the velocity
    saves of the flight time, inertial; rate (n, 3) per s; error, largest angle in rad between cubic and primer,
    measured between the rows. position m and velocity m/s (3,) at the start; switches (k,) s. throttle, of every
    singular arc: time (m,) s and the throttle (m,) on it."""

    time: np.ndarray
    primer: np.ndarray
    rate: np.ndarray
    error: float
    position: np.ndarray
    velocity: np.ndarray
    switches: np.ndarray
    throttle: tuple[tuple[np.ndarray, np.ndarray], ...] = ()


@dataclass(frozen=True)
class SteeringTable:
    """Attitudes in time, to be read linearly: time (n,) s, pitch and clock (n,) rad in the orbital frame, throttle
    (n,) 1 or 0, between them on singular arcs. Two rows at each of the switches (k,) s: before and after. error,
    largest angle in rad between the normal read and the optimal one, and largest error of the throttle read, midway
    between rows. position m and velocity m/s (3,) at the start."""

    time: np.ndarray
    pitch: np.ndarray
    clock: np.ndarray
    throttle: np.ndarray
    error: float
    position: np.ndarray
    velocity: np.ndarray
    switches: np.ndarray


def _arcs_of(solved: Replayable) -> tuple[Arc, ...]:
    return solved.arcs if isinstance(solved, Solved) else ()


def _keeping(solved: Replayable) -> tuple[tuple[Touch, ...], float]:
    """Where a flight's costates jump, and the coolness of its film; none and 0 of flights that know no limits."""
    return (solved.touches, solved.coolness) if isinstance(solved, Solved) else ((), 0.0)


def _fly(solved: Replayable, times: npt.ArrayLike = ()) -> Flight:
    """The flight, with rows at times in s; one where the costates jump is that before."""
    touches, coolness = _keeping(solved)
    y = np.concatenate([np.divide(solved.position, AU), np.divide(solved.velocity, SPEED_UNIT), solved.costates])
    sail = canonical_sail(solved.device, solved.characteristic_acceleration, coolness)
    span = solved.time / TIME_UNIT
    arcs = [(arc.kind, (arc.end - arc.start) / TIME_UNIT) for arc in _arcs_of(solved)]
    moments = np.minimum(np.divide(times, TIME_UNIT), span)
    flight = propagate(y, span, sail, touches, moments) if touches else fly(y, span, sail, arcs, moments)
    if flight.reason:
        raise ValueError(f"these costates cannot be flown: {flight.reason} after {flight.time * TIME_UNIT:.6g} s")
    return replace(flight, rows=_directed(flight.rows)) if len(flight.rows) else flight


def _directed(rows: np.ndarray) -> np.ndarray:
    """Rows (n, 12) of a flight, at whose end the primer points somewhere. Where nothing is asked of the speed at the
    end it vanishes there, and rounding would point the sail: its direction has a limit, that of the position's costate
    q, since p' = -q."""
    primer, pull = rows[-1, LAM_V], rows[-1, LAM_R]
    if np.linalg.norm(primer) > VANISHED * np.linalg.norm(pull):
        return rows
    found = rows.copy()
    found[-1, LAM_V] = VANISHED * pull
    return found


def primer_history(solved: Replayable, *, error: float = 1e-10) -> PrimerHistory:
    """The primer of a solved flight on an even grid, dense enough for Hermite's cubic to keep an error in rad; of a
    flight in arcs a grid for each of them, between which the primer has kinks of higher order.

    solved : an OrbitTransfer, a Rendezvous or a Solved.
    """
    arcs = _arcs_of(solved)
    touched = {touch.time * TIME_UNIT: touch.jump for touch in _keeping(solved)[0]}
    bounds = [0.0, *(touched or (arc.end for arc in arcs[:-1])), solved.time]
    pieces: list[list[np.ndarray]] = []
    throttle, worst = [], 0.0
    if arcs:
        error = min(error, ARC_ERROR)
    for piece, (first, last) in enumerate(pairwise(bounds)):
        intervals = max(2, int(FEWEST * (last - first) / solved.time))
        while True:
            time = np.linspace(first, last, 2 * intervals + 1)
            flight = _fly(solved, time)
            rows = flight.rows
            if first in touched:
                rows[0] = jumped(rows[:1], touched[first])[0]
            primer, rate = rows[:, LAM_V], -rows[:, LAM_R]
            left, right = slice(0, -1, 2), slice(2, None, 2)
            half = (time[2] - time[0]) / TIME_UNIT / 8
            middle = 0.5 * (primer[left] + primer[right]) + half * (rate[left] - rate[right])
            found = float(_angle(middle, primer[1::2]).max())
            if found <= error or intervals >= MOST:
                break
            intervals *= 2
        worst = max(worst, found)
        begin = 2 if pieces and not touched else 0  # where two pieces meet is one row, and two where the rate jumps
        pieces.append([time[begin::2], primer[begin::2], rate[begin::2]])
        if arcs and arcs[piece].kind == "singular":
            sail = canonical_sail(solved.device, solved.characteristic_acceleration)
            throttle.append((time[::2], switching(flight.rows[::2], sail).throttle))
    times, primers, rates = (np.concatenate(column) for column in zip(*pieces, strict=True))
    scale = TIME_UNIT / SPEED_UNIT
    return PrimerHistory(
        times,
        primers * scale,
        rates * scale / TIME_UNIT,
        worst,
        np.array(solved.position, dtype=float),
        np.array(solved.velocity, dtype=float),
        flight.switches * TIME_UNIT,
        tuple(throttle),
    )


def steering_table(solved: Replayable, *, error: float = 1e-6) -> SteeringTable:
    """Attitudes of a solved flight, dense enough for linear reading to keep an error in rad, split at the switches.

    solved : an OrbitTransfer, a Rendezvous or a Solved. Where the thrust is off a film stands edge-on and an E-sail
    keeps turning with the primer, throttle 0. The pitch changes its sign rather than the clock angle jump by half a
    turn, where there is thrust.
    """
    switches = _fly(solved).switches * TIME_UNIT
    touched = [touch.time * TIME_UNIT for touch in _keeping(solved)[0]]
    bounds = np.unique(np.concatenate([[0.0], switches, touched, [solved.time]]))
    beside = BESIDE * solved.time
    columns, worst, before = [], 0.0, None
    for first, last in pairwise(bounds):
        if last - first <= 4 * beside:
            continue
        intervals = max(2, int(FEWEST * (last - first) / solved.time))
        while True:
            time = np.linspace(first, last, 2 * intervals + 1)
            inside = np.clip(time, first + beside * (first > 0), last - beside * (last < solved.time))
            pitch, clock, on = _attitude(solved, inside, before)
            read = _normal(0.5 * (pitch[:-1:2] + pitch[2::2]), 0.5 * (clock[:-1:2] + clock[2::2]))
            wrong = _angle(read, _normal(pitch[1::2], clock[1::2]))
            found = float(np.max(wrong, where=on[1::2] > 0, initial=0.0))  # without thrust no attitude is wrong
            found = max(found, float(np.max(np.abs(0.5 * (on[:-1:2] + on[2::2]) - on[1::2]))))
            if found <= error or intervals >= MOST:
                break
            intervals *= 2
        worst, before = max(worst, found), (pitch[-1], clock[-1])
        columns.append(np.column_stack([time, pitch, clock, on])[::2])
    time, pitch, clock, throttle = np.vstack(columns).T
    position, velocity = (np.array(x, dtype=float) for x in (solved.position, solved.velocity))
    return SteeringTable(time, pitch, clock, throttle, worst, position, velocity, switches)


def _attitude(solved, time, before):
    """Pitch and clock rad, and the throttle, each (n,), continuous from a pair of pitch and clock before."""
    rows = _fly(solved, time).rows
    primer = frames.to_frame(frames.rtn(rows[:, POSITION], rows[:, VELOCITY]), rows[:, LAM_V])
    across = np.hypot(primer[:, 1], primer[:, 2])
    coolness, r2 = _keeping(solved)[1], np.sum(rows[:, POSITION] ** 2, axis=1)
    facing = np.minimum(coolness * r2, 1.0) if coolness else 1.0
    steered = optimal_pitch(np.arctan2(across, primer[:, 0]), solved.device, facing)
    side = primer[:, 1:] / np.maximum(across, np.finfo(float).tiny)[:, None]
    throttle = steered.on.astype(float)
    if _arcs_of(solved):
        sail = canonical_sail(solved.device, solved.characteristic_acceleration)
        throttle = throttle_of_arcs(rows, time, _arcs_of(solved), sail)
    sign = np.cumprod(np.where(np.sum(side[1:] * side[:-1], axis=1) < 0, -1.0, 1.0))
    sign = np.concatenate([[1.0], np.where(throttle[1:] > 0, sign, 1.0)])
    if before is not None and side[0] @ [np.sin(before[1]), np.cos(before[1])] < 0:
        sign = -sign
    clock = np.unwrap(np.arctan2(sign * side[:, 0], sign * side[:, 1]))
    if before is not None:
        clock += 2 * np.pi * np.round((before[1] - clock[0]) / (2 * np.pi))
    return sign * steered.pitch, clock, throttle


def _normal(pitch, clock):
    return np.column_stack([np.cos(pitch), np.sin(pitch) * np.sin(clock), np.sin(pitch) * np.cos(clock)])


def _angle(a, b):
    """Angles (n,) between vectors (n, 3)."""
    return np.arctan2(np.linalg.norm(np.cross(a, b), axis=1), np.sum(a * b, axis=1))
