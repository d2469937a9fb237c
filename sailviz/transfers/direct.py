"""Transfers by the direct method: questions in words as its problems, and its answers handed on to the indirect one.

An answer that the indirect method has confirmed is a flight like any other, whose `method` says so; one that it has
not, or that keeps to limits, is a DirectFlight, with the miss of its own table and no more digits than that allows.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from sailviz.constants import AU, DAY, RADIUS_SUN
from sailviz.design.direct import guesses
from sailviz.design.direct.ends import (
    End,
    FromState,
    ToBody,
    ToCircle,
    ToEscape,
    ToOrbit,
    ToRadius,
    ToState,
)
from sailviz.design.direct.frames_of_state import Planar
from sailviz.design.direct.limits import Limits, heat_factor
from sailviz.design.direct.polish import polished
from sailviz.design.direct.search import DirectFlight, fastest, no_flight, sail_of
from sailviz.design.direct.transcription import NO_LIMITS, SUN_GRAZING, Guess, Question
from sailviz.design.minimum_time.effort import Effort
from sailviz.design.minimum_time.planar_transfer import Transfer
from sailviz.design.minimum_time.state_costate import SPEED_UNIT, TIME_UNIT
from sailviz.propulsion.solar_sail import Film
from sailviz.transfers import ends as transfer_ends
from sailviz.transfers.ends import Bounds

METHODS = ("auto", "indirect", "direct")
FLIP = np.radians(10.0) / DAY  # rad/s: within a cone the fastest flight flaps without end from side to side, if it may
INTERVALS, OF_THE_SUN_GRAZING = 40, 60
FAR = 3.0  # times the distance of departure: beyond it the mesh follows the pace of motion
ESCAPED = 2.0  # times the distance of departure where a guess has escaped
LEAST_DISTANCE = 0.05  # au: where nothing else keeps a flight past the Sun away from it


def limits(
    *,
    closest: float | None = None,
    hottest: float | None = None,
    cone: float | None = None,
    turn_rate: float | None = None,
) -> Limits:
    """Limits on the way in SI: distance from the Sun m, temperature of the film K, pitch angle rad, turn rate rad/s of
    the sail's normal in space."""
    return Limits(
        None if closest is None else closest / AU,
        hottest,
        cone,
        None if turn_rate is None else float(turn_rate * TIME_UNIT),
    )


def in_the_plane(
    first: float,
    target: float | None,
    end: transfer_ends.End | None,
    within: Bounds,
    device: Film | str,
    characteristic_acceleration: float,
    *,
    limits: Limits = NO_LIMITS,
    effort: Effort,
) -> Transfer | DirectFlight:
    """The fastest flight from a circle to the circle of a target, radii in m, or to an end, within within and limits.
    ValueError for limits that no flight can keep to and for sails that the direct method does not know. Within a cone a
    sail turns at FLIP at most, where no rate is given."""
    sail = sail_of(device, characteristic_acceleration)
    begin = first / AU
    limits = all_limits(limits, within)
    aim, last = _aim(end, None if target is None else target / AU, begin, within)
    _check(begin, last, aim, limits, device)
    out = last > begin and not isinstance(aim, (ToCircle, ToState))
    past_the_sun = out and limits.closest is not None
    quick_near_the_sun = past_the_sun or (out and last > FAR * begin)
    question = Question(
        Planar(),
        sail,
        FromState((begin, 0.0, 0.0, begin**-0.5)),
        aim,
        limits,
        pace=SUN_GRAZING if quick_near_the_sun else 0.0,
        intervals=OF_THE_SUN_GRAZING if quick_near_the_sun else INTERVALS,
    )
    if last * AU < RADIUS_SUN:
        return no_flight(question, characteristic_acceleration, "the target lies inside the Sun", effort)
    rough = _guesses(question, begin, last, past_the_sun)
    found = fastest(question, rough, characteristic_acceleration, effort=effort)
    if not found.feasible or limits.cone is not None or limits.turn_rate is not None or effort.stopped:
        return found
    return polished(found, effort) or found


def all_limits(limits: Limits, within: Bounds) -> Limits:
    """Those of the sail and those of the flight, in one."""
    if within.perihelion is not None:
        limits = replace(limits, closest=within.perihelion / AU)
    if within.hottest is not None:
        limits = replace(limits, hottest=within.hottest)
    if limits.cone is not None and limits.turn_rate is None:
        limits = replace(limits, turn_rate=float(FLIP * TIME_UNIT))
    return limits


def _aim(end: transfer_ends.End | None, target: float | None, begin: float, within: Bounds) -> tuple[End, float]:
    """What a direct flight has to come to, and about how far from the Sun that is, au."""
    angle = None if within.revolutions is None else 2 * np.pi * within.revolutions
    if isinstance(end, transfer_ends.Escape):
        return ToEscape(end.excess_speed / SPEED_UNIT, angle), ESCAPED * begin
    if isinstance(end, transfer_ends.Arrival):
        return ToState(end.radius / AU, 0.0, end.speed / SPEED_UNIT, angle), end.radius / AU
    if isinstance(end, transfer_ends.Distance):
        return ToRadius(end.radius / AU, angle), end.radius / AU
    assert target is not None, "all other ends are those of a target"
    return (ToCircle(target, angle) if end is None else ToRadius(target, angle)), target


def _guesses(question: Question, begin: float, last: float, past_the_sun: bool) -> Iterator[Guess]:
    angle = None if isinstance(question.end, ToOrbit | ToBody) else question.end.angle
    yield from guesses.planar_guesses(question, begin, last, angle)
    if past_the_sun:
        yield from guesses.falls(question, question.limits.closest or LEAST_DISTANCE, last)


def _check(begin: float, last: float, aim: End, limits: Limits, device: Film | str) -> None:
    """ValueError for limits that no flight can keep to: proofs, not failures."""
    nearest = begin if isinstance(aim, ToEscape) else min(begin, last)
    if limits.closest is not None and limits.closest >= nearest:
        raise ValueError(
            f"a flight between {begin:.6g} and {last:.6g} au cannot stay farther from the Sun than {limits.closest:g} "
            "au"
        )
    if limits.hottest is not None:
        heat_factor(limits.hottest, device)  # ValueError for films without a temperature
