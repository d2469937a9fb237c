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
from sailviz.design.direct.ends import End, FromState, ToCircle, ToRadius
from sailviz.design.direct.frames_of_state import Planar
from sailviz.design.direct.limits import Limits, heat_factor
from sailviz.design.direct.polish import polished
from sailviz.design.direct.search import DirectFlight, fastest, no_flight, sail_of
from sailviz.design.direct.transcription import NO_LIMITS, SUN_GRAZING, Guess, Question
from sailviz.design.minimum_time.effort import Effort
from sailviz.design.minimum_time.planar_transfer import Transfer
from sailviz.design.minimum_time.state_costate import TIME_UNIT
from sailviz.propulsion.solar_sail import Film

METHODS = ("auto", "indirect", "direct")
FLIP = np.radians(10.0) / DAY  # rad/s: within a cone the fastest flight flaps without end from side to side, if it may
INTERVALS, OF_THE_SUN_GRAZING = 40, 60
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


def between_circles(
    first: float,
    last: float,
    device: Film | str,
    characteristic_acceleration: float,
    *,
    limits: Limits = NO_LIMITS,
    flyby: bool = False,
    effort: Effort,
) -> Transfer | DirectFlight:
    """The fastest flight between circles of radii in m, or past the last one, within limits. ValueError for limits that
    no flight can keep to and for sails that the direct method does not know. Within a cone a sail turns at FLIP at
    most, where no rate is given."""
    begin, end = first / AU, last / AU
    if limits.cone is not None and limits.turn_rate is None:
        limits = replace(limits, turn_rate=float(FLIP * TIME_UNIT))
    _check(begin, end, limits, device)
    aim: End = ToRadius(end) if flyby else ToCircle(end)
    past_the_sun = flyby and end > begin and limits.closest is not None
    question = Question(
        Planar(),
        sail_of(device, characteristic_acceleration),
        FromState((begin, 0.0, 0.0, begin**-0.5)),
        aim,
        limits,
        pace=SUN_GRAZING if past_the_sun else 0.0,
        intervals=OF_THE_SUN_GRAZING if past_the_sun else INTERVALS,
    )
    if last < RADIUS_SUN:
        return no_flight(question, characteristic_acceleration, "the target lies inside the Sun", effort)
    found = fastest(question, _guesses(question, begin, end, past_the_sun), characteristic_acceleration, effort=effort)
    if not found.feasible or limits.any or flyby or effort.stopped:
        return found
    return polished(found) or found


def _guesses(question: Question, begin: float, end: float, past_the_sun: bool) -> Iterator[Guess]:
    yield from guesses.planar_guesses(question, begin, end)
    if past_the_sun:
        yield from guesses.falls(question, question.limits.closest or LEAST_DISTANCE, end)


def _check(begin: float, end: float, limits: Limits, device: Film | str) -> None:
    """ValueError for limits that no flight can keep to: proofs, not failures."""
    if limits.closest is not None and limits.closest >= min(begin, end):
        raise ValueError(
            f"a flight between {begin:.6g} and {end:.6g} au cannot stay farther from the Sun than {limits.closest:g} au"
        )
    if limits.hottest is not None:
        heat_factor(limits.hottest, device)  # ValueError for films without a temperature
