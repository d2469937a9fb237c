"""Transfers to bodies at their dates by the direct method, handed on to the indirect one.

The bodies move as Kepler has it along the orbits that osculate their motion: small bodies exactly so, planets, by mean
elements, nearly. The problem is solved with the orbits of a rough date and once more with those of the dates found.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from sailviz.constants import DAY
from sailviz.design.direct import guesses
from sailviz.design.direct.arcs import guess_on
from sailviz.design.direct.ends import Body, FromBody, FromState, ToBody, eccentric_anomaly
from sailviz.design.direct.frames_of_state import Spatial
from sailviz.design.direct.limits import Limits, heat_factor
from sailviz.design.direct.search import DirectFlight, fastest, sail_of
from sailviz.design.direct.transcription import Guess, Question
from sailviz.design.minimum_time.body_flyby import Passing
from sailviz.design.minimum_time.effort import Effort
from sailviz.design.minimum_time.moving_bodies import MovingBody
from sailviz.design.minimum_time.planet_conditions import Meeting
from sailviz.design.minimum_time.planet_rendezvous import Rendezvous, rendezvous_near
from sailviz.design.minimum_time.state_costate import POSITION, TIME_UNIT, canonical_sail
from sailviz.design.minimum_time.unknowns import Unknowns
from sailviz.propulsion.solar_sail import Film

INTERVALS = 24
APART = 120 * DAY  # s between the departures of a window's guesses
STRETCHES = (0.8, 1.3, 2.0)  # flight times of the guesses over a rough one
SAME = 1e-3  # relative flight time by which another flight would have been found


def to_body(
    origin: MovingBody,
    target: MovingBody,
    window: tuple[np.datetime64, np.datetime64],
    device: Film | str,
    characteristic_acceleration: float,
    *,
    flyby: bool = False,
    limits: Limits,
    effort: Effort,
) -> Rendezvous | DirectFlight:
    """The fastest flight that leaves a body within a window, or on its only date, and meets another, or passes it.
    ValueError for what no sail of this kind can keep to."""
    if limits.hottest is not None:
        heat_factor(limits.hottest, device)  # ValueError for films without a temperature
    sail_of(device, characteristic_acceleration)  # ValueError for sails that the direct method does not know
    first, last = (date.astype("datetime64[ns]") for date in window)
    length = float((last - first) / np.timedelta64(1, "ns")) * 1e-9
    sail = canonical_sail(device, characteristic_acceleration)
    meeting = (Passing if flyby else Meeting)(origin, target, first, sail, effort)
    asked = _Asked(meeting, device, characteristic_acceleration, length, limits)
    rough = asked.question(0.5 * length, 0.5 * length + asked.span)
    found = fastest(rough, asked.guesses(rough), characteristic_acceleration, sharpen=False, effort=effort)
    if found.feasible and not effort.stopped:
        found = _finer(asked, found, effort)
    found = replace(found, epoch=first)
    if not found.feasible or limits.any:
        return found
    lam = found.costates / np.linalg.norm(found.costates)
    guess = Unknowns(lam, found.time / TIME_UNIT, found.departure)
    confirmed = rendezvous_near(meeting, guess, length, device, characteristic_acceleration)
    if confirmed is None or abs(confirmed.time / found.time - 1) > SAME:
        return found
    claim = (
        f"best found by the direct method from {found.guesses} guesses, {found.converged} of which converged; a faster "
        f"flight is not excluded.{effort.found().mark}"
    )
    return replace(confirmed, solutions=len(found.solutions), claim=claim, method="direct method, then shooting")


def _finer(asked: _Asked, coarse: DirectFlight, effort: Effort) -> DirectFlight:
    """The flight on a finer mesh, or on its switches, between the bodies as they move at its own dates."""
    assert coarse.nodes is not None, "a flight that was found has nodes"
    question = asked.question(coarse.departure, coarse.departure + coarse.time)
    own = asked.own(question, coarse.departure, coarse.time)
    guess = guess_on(question, coarse.nodes)._replace(own=own)
    again = fastest(question, [guess], asked.characteristic_acceleration, effort=effort)
    if not again.feasible:
        return coarse
    return replace(again, solutions=coarse.solutions, guesses=coarse.guesses, converged=coarse.converged)


class _Asked:
    """A question in the direct method's terms; times in s after the window's first date."""

    def __init__(
        self,
        meeting: Meeting,
        device: Film | str,
        characteristic_acceleration: float,
        length: float,
        limits: Limits,
    ):
        self.meeting, self.device, self.length, self.limits = meeting, device, length, limits
        self.characteristic_acceleration = characteristic_acceleration
        self.flyby = isinstance(meeting, Passing)
        radii = [meeting.orbit(body, 0.0).semi_major_axis for body in (meeting.origin, meeting.target)]
        sail = sail_of(device, characteristic_acceleration)
        self.span = guesses.spiral_time(sail, radii[0], radii[1]) * TIME_UNIT  # s, roughly

    def body(self, which: MovingBody, time: float) -> Body:
        """A body on the orbit that osculates its motion at a time."""
        orbit = self.meeting.orbit(which, time)
        (state,) = self.meeting.state(which, time)
        nu, e = orbit.anomaly(state[POSITION]), orbit.e
        anomaly = 2 * np.arctan2(np.sqrt(1 - e) * np.sin(nu / 2), np.sqrt(1 + e) * np.cos(nu / 2))
        mean = anomaly - e * np.sin(anomaly)
        return Body(orbit, float(mean - time / TIME_UNIT * orbit.semi_major_axis**-1.5))

    def question(self, departure: float, arrival: float) -> Question:
        """With the bodies as they move at two times."""
        meeting = self.meeting
        start: FromBody | FromState
        if self.length > 0:
            start = FromBody(self.body(meeting.origin, departure), 0.0, self.length / TIME_UNIT, departure / TIME_UNIT)
        else:
            start = FromState(tuple(float(x) for x in meeting.state(meeting.origin, 0.0)[0]))
        end = ToBody(self.body(meeting.target, arrival), arrival / TIME_UNIT, self.flyby)
        sail = sail_of(self.device, self.characteristic_acceleration)
        return Question(Spatial(), sail, start, end, self.limits, intervals=INTERVALS)

    def own(self, question: Question, departure: float, span: float) -> np.ndarray:
        """The start's and the end's unknowns of a flight."""
        assert isinstance(question.end, ToBody), "question makes no other"
        there = question.end.body
        arrival = [eccentric_anomaly(there.mean((departure + span) / TIME_UNIT), there.orbit.e)]
        if not isinstance(question.start, FromBody):
            return np.array(arrival)
        here, leaving = question.start.body, departure / TIME_UNIT
        return np.array([leaving, eccentric_anomaly(here.mean(leaving), here.orbit.e), *arrival])

    def guesses(self, question: Question) -> Iterator[Guess]:
        """From some departures, over some flight times, with the revolutions that go with them."""
        meeting = self.meeting
        count = int(self.length // APART) + 2 if self.length > 0 else 1
        for departure in np.linspace(0.0, self.length, count + 2)[1:-1] if self.length > 0 else (0.0,):
            (here,) = meeting.state(meeting.origin, departure)
            for stretch in STRETCHES:
                span = stretch * self.span
                (there,) = meeting.state(meeting.target, departure + span)
                mean = 0.5 * sum(np.linalg.norm(x[POSITION]) for x in (here, there))
                angle = np.arctan2(there[1], there[0]) - np.arctan2(here[1], here[0])
                whole = span / TIME_UNIT / (2 * np.pi * mean**1.5) - (angle % (2 * np.pi)) / (2 * np.pi)
                turns = max(0, round(whole))
                guess = guesses.spatial(question, here, there, span / TIME_UNIT, turns)
                yield guess._replace(own=self.own(question, float(departure), span))
