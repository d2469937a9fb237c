"""Flights past a radius, away from the Sun, within limits: rows of an independent indirect code, which direct
transcription confirmed, from nothing but the question; each flown again by SciPy in Cartesian form."""

from __future__ import annotations

import os
import re
from dataclasses import replace
from itertools import pairwise
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from sailviz.constants import AU, DAY, GRAVITY_AT_1_AU
from sailviz.design.minimum_time import Keeping, circle_to_end, to_ends
from sailviz.design.minimum_time.boundary_conditions import SPAN
from sailviz.design.minimum_time.planar_ends import AtEnergy, AtRadius, AtState
from sailviz.design.minimum_time.planar_transfer import time_unit
from sailviz.design.minimum_time.search import Search, search

EVERY_ROW = os.environ.get("SAILVIZ_EVERY_TRANSFER")
at_length = pytest.mark.skipif(not EVERY_ROW, reason="takes seconds each: set SAILVIZ_EVERY_TRANSFER=1")

MARS = 1.52366231
LIGHTNESS_04 = 0.4 * GRAVITY_AT_1_AU
# acceleration m/s2, end, limits; days, revolutions and costates at H = +1
FLY_BYS = {
    "mars-1": (1e-3, AtRadius(MARS), Keeping(), 166.388947, 0.360388, (7.9260581, 1.3416406, 13.4102426)),
    "mars-0.5": (0.5e-3, AtRadius(MARS), Keeping(), 286.987457, 0.594902, (33.7398824, -14.9281838, 48.4505277)),
}
# acceleration, perihelion au, radius au; days, day of the perihelion, revolutions, speed at the end km/s
PAST_THE_SUN = {
    "5 au, 0.2": (LIGHTNESS_04, 0.2, 5.0, 322.640648, 189.0388, 1.092997, 62.4175),
    "5 au, 0.3": (LIGHTNESS_04, 0.3, 5.0, 351.066735, 184.2430, 1.019397, 49.6126),
    "30 au, 0.3": (LIGHTNESS_04, 0.3, 30.0, 1232.037523, 201.7663, 1.014548, 49.4909),
    "saturn, 0.3": (LIGHTNESS_04, 0.3, 9.5371, 511.048041, 186.2389, 1.019904, 49.0467),
}


def flown_by_scipy(found):
    """Planar states and costates (8, n) of an ideal sail's flight, mu = r0 = 1, by DOP853 from the result's start; the
    normal is that which brute force over the pitch finds best, refined: no formula of the law is used."""
    a_c = found.characteristic_acceleration / GRAVITY_AT_1_AU

    def best(r_hat, primer):
        t_hat = np.array([-r_hat[1], r_hat[0]])
        side = np.copysign(1.0, primer @ t_hat)
        angle = np.arctan2(abs(primer @ t_hat), primer @ r_hat)
        pitch = np.linspace(0, np.pi / 2, 2001)
        a = pitch[np.argmax(np.cos(pitch) ** 2 * np.cos(angle - pitch))]
        for _ in range(60):  # Newton on the derivative of cos^2 a cos(l - a)
            slope = np.cos(a) * (np.cos(a) * np.sin(angle - a) - 2 * np.sin(a) * np.cos(angle - a))
            curve = -2 * np.sin(a) * np.cos(a) * np.sin(angle - a) * 2 - np.cos(a) ** 2 * np.cos(angle - a)
            curve -= 2 * (np.cos(a) ** 2 - np.sin(a) ** 2) * np.cos(angle - a)
            step = slope / curve
            a -= step
            if abs(step) < 1e-15:
                break
        return np.cos(a) * r_hat + side * np.sin(a) * t_hat

    def rates(_, y):
        r, v, q, p = y.reshape(4, 2)
        d = np.hypot(*r)
        u = r / d
        n = best(u, p)
        c = n @ u
        thrust = a_c / d**2 * c * c * n
        # d (p . a) / dr at a fixed normal: a_c (r . n)^2 / r^4 n, and gravity
        push = a_c * (p @ n) * (2 * (r @ n) * n / d**4 - 4 * (r @ n) ** 2 * r / d**6)
        pull = -p / d**3 + 3 * (p @ r) * r / d**5
        return np.concatenate([v, thrust - r / d**3, -push - pull, -q])

    y = found.start[[0, 1, 3, 4, 6, 7, 9, 10]]
    span = found.time / time_unit(found.initial_radius)
    moments = [0.0, *(touch.time for touch in found.touches), span]
    ends = []
    for i, (begin, end) in enumerate(pairwise(moments)):
        y = solve_ivp(rates, (begin, end), y, method="DOP853", rtol=1e-12, atol=1e-13).y[:, -1]
        ends.append(y)
        if i < len(found.touches):
            y = y.copy()
            y[4:6] += found.touches[i].jump * y[:2] / np.hypot(*y[:2])
    return ends


@pytest.mark.parametrize("name", ["mars-1", pytest.param("mars-0.5", marks=at_length)])
def test_a_fly_by_is_the_fastest_way_to_a_distance(name):
    a_c, end, keeping, days, turns, lam = FLY_BYS[name]
    found = circle_to_end(AU, end, "ideal", a_c, keeping)
    assert found.feasible, found.reason
    assert found.time / DAY == pytest.approx(days, rel=1e-8)
    assert found.revolutions == pytest.approx(turns, abs=1e-6)
    assert found.costates == pytest.approx(lam, rel=1e-7)
    x = flown_by_scipy(found)[-1]
    assert np.hypot(*x[:2]) == pytest.approx(end.radius, abs=1e-9)
    assert np.hypot(*x[6:]) < 1e-7 * np.hypot(*x[4:6])  # the speed is free there: the primer vanishes


@pytest.mark.parametrize("name", ["5 au, 0.2", *(pytest.param(name, marks=at_length) for name in [*PAST_THE_SUN][1:])])
def test_a_flight_past_the_sun_touches_its_limit_once(name):
    a_c, near, far, days, perihelion, turns, speed = PAST_THE_SUN[name]
    found = circle_to_end(AU, AtRadius(far), "ideal", a_c, Keeping(perihelion=near))
    assert found.feasible, found.reason
    assert found.time / DAY == pytest.approx(days, rel=1e-8)
    assert found.touches[0].time * time_unit(AU) / DAY == pytest.approx(perihelion, abs=1e-3)
    assert found.touches[0].jump < 0
    assert found.revolutions == pytest.approx(turns, abs=1e-6)
    assert found.closest >= near * AU * (1 - 1e-7)
    there, x = flown_by_scipy(found)
    assert np.hypot(*there[:2]) == pytest.approx(near, abs=1e-8)
    assert there[:2] @ there[2:4] == pytest.approx(0, abs=1e-8)
    assert np.hypot(*x[:2]) == pytest.approx(far, abs=1e-8)
    assert np.hypot(*x[2:4]) * AU / time_unit(AU) / 1e3 == pytest.approx(speed, abs=1e-3)


def numbers(text):
    return [float(word) for word in re.findall(r"-?\d+\.\d+", text)]


def test_where_none_is_found_a_flight_that_breaks_the_limit_is_told(monkeypatch):
    """To 0.8 au, and never nearer than 0.9."""
    free = circle_to_end(AU, AtRadius(0.8), "ideal", 1e-3)
    monkeypatch.setattr(to_ends, "_touching", lambda *_: ([], Search((), 0, 0, np.inf, np.empty(0))))
    found = circle_to_end(AU, AtRadius(0.8), "ideal", 1e-3, Keeping(perihelion=0.9))
    assert not found.feasible
    closest, days = numbers(found.ending.nearest)
    assert closest == 0.8
    assert np.abs(free.solution_times / DAY - days).min() < 1e-4
    assert any("limit" in advice for advice in found.ending.advice)


def test_where_none_is_found_the_nearest_flight_that_is_told_is_a_true_one(monkeypatch):
    kept = []

    def without_success(flight, spans, n, *words, **named):
        kept.append((flight, search(flight, spans, 64, *words, **named)))
        return replace(kept[-1][1], extremals=())

    monkeypatch.setattr(to_ends, "search", without_success)
    found = circle_to_end(AU, AtRadius(MARS), "ideal", 1e-3)
    assert not found.feasible
    flight, best = min(kept, key=lambda one: one[1].nearest_miss)
    start, span = flight.starts(best.nearest[None])[0], best.nearest[SPAN]
    told = SimpleNamespace(
        start=start, time=span * time_unit(AU), touches=(), initial_radius=AU, characteristic_acceleration=1e-3
    )
    (x,) = flown_by_scipy(told)
    r, speed = np.hypot(*x[:2]), AU / time_unit(AU) / 1e3
    away, across = x[:2] @ x[2:4] / r * speed, (x[0] * x[3] - x[1] * x[2]) / r * speed
    assert numbers(found.ending.nearest) == pytest.approx([r, told.time / DAY, away, across], abs=6e-5)
    assert abs(r - MARS) < 0.1


def test_solar_sail_problem_0_of_pykep_is_answered_below_its_quoted_time():
    """pykep's TOPS: 7.7586540974 with controls held over segments; a true optimum lies below."""
    a_c = 0.052476454834170821 * GRAVITY_AT_1_AU
    found = circle_to_end(AU, AtState(1.1, 0.0, 1.0), "ideal", a_c, Keeping(angle=2 * np.pi))
    assert found.feasible, found.reason
    assert found.time / time_unit(AU) == pytest.approx(7.758406383905, abs=1e-10)
    lam = [*found.costates, found.angle_costate]
    assert lam == pytest.approx([11.45712131, -2.92142974, 18.80316419, 0.69670779], rel=1e-7)
    (x,) = flown_by_scipy(found)
    assert x[:4] == pytest.approx([1.1, 0, 0, 1], abs=1e-9)


@pytest.mark.parametrize("excess", [0.0, pytest.param(0.3, marks=at_length)])
def test_the_costates_of_an_escape_end_along_the_gradient_of_the_energy(excess):
    found = circle_to_end(AU, AtEnergy(0.5 * excess**2), "ideal", 1e-3)
    assert found.feasible, found.reason
    (x,) = flown_by_scipy(found)
    r, v, q, p = x.reshape(4, 2)
    assert 0.5 * v @ v - 1 / np.hypot(*r) == pytest.approx(0.5 * excess**2, abs=1e-9)
    gradient, lam = np.concatenate([r / np.hypot(*r) ** 3, v]), np.concatenate([q, p])
    assert lam @ gradient == pytest.approx(np.linalg.norm(lam) * np.linalg.norm(gradient), rel=1e-10)


def test_a_limit_that_the_fastest_flight_keeps_to_anyway_changes_nothing():
    free = circle_to_end(AU, AtRadius(MARS), "ideal", 1e-3)
    kept = circle_to_end(AU, AtRadius(MARS), "ideal", 1e-3, Keeping(perihelion=0.9))
    assert kept.time == free.time
    assert not kept.touches
