"""Flights of the direct method against those of the indirect one: numbers of two other codes, flown again."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

from sailviz.constants import AU, DAY, GRAVITY_AT_1_AU
from sailviz.design.direct import guesses
from sailviz.design.direct.ends import FromState, ToCircle, ToRadius, ToState
from sailviz.design.direct.frames_of_state import Planar
from sailviz.design.direct.limits import Limits
from sailviz.design.direct.search import DirectFlight, fastest, sail_of
from sailviz.design.direct.transcription import Question
from sailviz.design.minimum_time.effort import INTERRUPTED, TIME_LIMIT, Effort
from sailviz.design.minimum_time.state_costate import TIME_UNIT
from sailviz.propulsion.film_ageing import temperature

pytest.importorskip("casadi")
MARS = 1.52366231  # au


def asked(end, device="ideal", mm_s2=1.0, limits=None, intervals=20) -> Question:
    sail = sail_of(device, mm_s2 * 1e-3)
    return Question(Planar(), sail, FromState((1.0, 0.0, 0.0, 1.0)), end, limits or Limits(), intervals=intervals)


def flown(question: Question, last: float, mm_s2=1.0, sharpen=False, angle=None) -> DirectFlight:
    first = next(guesses.planar_guesses(question, 1.0, last, angle))
    return fastest(question, [first], mm_s2 * 1e-3, sharpen=sharpen)


@cache
def past_mars() -> DirectFlight:
    return flown(asked(ToRadius(MARS)), MARS)


def test_mars_circle_is_passed_after_the_time_that_shooting_finds():
    found = past_mars()
    assert found.time / DAY == pytest.approx(166.388947, abs=2e-6)
    assert found.revolutions == pytest.approx(0.360388, abs=2e-6)
    assert found.costates == pytest.approx([7.9260581, 0.0, 1.3416406, 13.4102426], abs=1e-5)  # r, angle, u, v


def test_table_flown_by_the_ordinary_propagator_comes_where_it_was_asked_to():
    found = past_mars()
    assert found.flown is not None
    r = np.linalg.norm(found.flown.position[-1]) / AU
    assert abs(r / MARS - 1) == pytest.approx(found.miss, rel=1e-6)
    assert found.miss < 1e-5
    assert found.error / DAY < 0.5 * 10**-found.digits * 2.001  # digits of the answer are no more than that allows
    assert abs(found.time / DAY - 166.388947) < found.error / DAY + 1e-6


def test_turn_of_given_angle_ends_in_the_state_that_a_published_problem_asks_for():
    # the solar sail P0 of pykep's trajectory optimisation problems; controls held constant give 7.7586540974
    mm_s2 = 0.052476454834170821 * GRAVITY_AT_1_AU * 1e3
    found = flown(asked(ToState(1.1, 0.0, 1.0, 2 * np.pi), mm_s2=mm_s2, intervals=30), 1.1, mm_s2, angle=2 * np.pi)
    assert found.time / TIME_UNIT == pytest.approx(7.758406383905, rel=2e-6)
    assert found.revolutions == pytest.approx(1.0, abs=1e-4)


def test_electric_sail_finds_its_arc_of_partial_voltage_by_itself():
    found = flown(asked(ToCircle(2.0), "electric-sail", intervals=40), 2.0, sharpen=True)
    assert [arc.kind for arc in found.arcs] == ["T", "C", "S", "T"]
    assert found.time / DAY == pytest.approx(843.583060, rel=2e-7)
    lengths = [arc.duration * TIME_UNIT / DAY for arc in found.arcs]
    assert lengths == pytest.approx([260.4727, 74.0583, 245.2622, 263.7898], abs=0.2)
    assert found.table is not None
    middle = (found.table.time > 345 * DAY) & (found.table.time < 570 * DAY)
    assert found.table.throttle[middle].min() > 0.09
    assert found.table.throttle[middle].max() == pytest.approx(0.368, abs=2e-3)
    assert found.miss < 1e-5


def test_film_stays_as_cool_as_it_is_told():
    free = flown(asked(ToRadius(1.3), "jpl-1978"), 1.3)
    found = flown(asked(ToRadius(1.3), "jpl-1978", limits=Limits(hottest=245.0)), 1.3)
    for flight, cool in ((free, False), (found, True)):
        table, path = flight.table, flight.flown
        assert table is not None
        assert path is not None
        r = np.interp(table.time, path.time, np.linalg.norm(path.position, axis=1))
        hottest = temperature(r, np.abs(table.pitch), "jpl-1978").max()
        assert (hottest < 245.01) == cool
    assert free.time * 1.001 < found.time < 1.2 * free.time
    assert found.miss < 1e-4


def test_sail_stays_within_the_cone_about_the_sunlight_that_it_is_told():
    free, cone = past_mars(), np.radians(25.0)
    found = flown(asked(ToRadius(MARS), limits=Limits(cone=cone)), MARS)
    assert free.table is not None
    assert found.table is not None
    assert np.abs(free.table.pitch).max() > 1.2 * cone
    assert np.abs(found.table.pitch).max() <= cone
    assert 1.001 * free.time < found.time < 1.2 * free.time
    assert found.miss < 1e-4


def test_sail_turns_in_space_no_faster_than_it_is_told():
    per_day = np.radians(0.5)
    question = asked(ToRadius(MARS), limits=Limits(turn_rate=per_day / DAY * TIME_UNIT))
    found = flown(question, MARS)
    table, path = found.table, found.flown
    assert table is not None
    assert path is not None
    angle = np.interp(table.time, path.time, np.unwrap(np.arctan2(path.position[:, 1], path.position[:, 0])))
    azimuth = angle + table.pitch * np.sin(table.clock)
    apart = np.diff(table.time) > 60.0
    rate = (np.diff(azimuth)[apart] / np.diff(table.time)[apart]) * DAY
    assert np.degrees(np.abs(rate).max()) < 0.51
    assert found.time > past_mars().time + 0.01 * DAY
    assert found.miss < 1e-5


def test_flight_past_the_sun_touches_the_distance_that_it_must_keep():
    mm_s2 = 0.4 * GRAVITY_AT_1_AU * 1e3
    sail, limits = sail_of("ideal", mm_s2 * 1e-3), Limits(closest=0.3)
    start = FromState((1.0, 0.0, 0.0, 1.0))
    question = Question(Planar(), sail, start, ToRadius(5.0), limits, pace=1.5, intervals=40)
    found = fastest(question, [list(guesses.falls(question, 0.3, 5.0))[1]], mm_s2 * 1e-3, sharpen=False)
    assert found.closest / AU == pytest.approx(0.3, abs=2e-4)
    assert found.time / DAY == pytest.approx(351.066735, rel=1e-4)  # 3e-6 on twice the intervals
    assert found.revolutions == pytest.approx(1.019397, abs=1e-3)


@pytest.mark.parametrize("why", [TIME_LIMIT, INTERRUPTED])
def test_search_that_is_stopped_says_so(why):
    effort = Effort(time_limit=1e-3 if why == TIME_LIMIT else None)
    if why == INTERRUPTED:
        effort.end()
    question = asked(ToRadius(MARS))
    found = fastest(question, guesses.planar_guesses(question, 1.0, MARS), 1e-3, effort=effort)
    assert not found.feasible
    assert found.ending.stopped == why
    assert ("time limit" if why == TIME_LIMIT else "interrupted") in found.reason


def test_time_limit_keeps_the_flight_that_was_found_before_it():
    effort = Effort()
    question = asked(ToRadius(MARS))
    first, second = list(guesses.planar_guesses(question, 1.0, MARS))[:2]

    def both():
        yield first
        yield second

    calls = []
    effort._progress = lambda share, words: (calls.append(words), share > 0.3 and effort.end(TIME_LIMIT))
    found = fastest(question, both(), 1e-3, effort=effort)
    assert found.feasible
    assert found.ending.stopped == TIME_LIMIT
    assert "stopped before all were tried" in found.claim
    assert found.time / DAY == pytest.approx(166.388947, abs=1e-4)


def test_sails_without_convex_controls_are_refused_by_name():
    with pytest.raises(ValueError, match="final model only"):
        sail_of("electric-sail-original", 1e-3)
    with pytest.raises(ValueError, match="mirrors all light"):
        flown(asked(ToCircle(0.9), "ideal", limits=Limits(hottest=300.0)), 0.9)
