"""Fastest flights to Apophis and Kamo'oalewa at their places, on given dates and on the best ones.

Reference rows: an indirect method and a direct one of other codes, from the same fixed ellipse of the Earth; ideal
sail, 1 mm/s2, departure with the Earth's velocity.
"""

from __future__ import annotations

import os
import re

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from sailviz.constants import AU, DAY
from sailviz.design.direct.limits import Limits
from sailviz.design.minimum_time import launch_dates, rendezvous
from sailviz.design.minimum_time.body_flyby import Passing
from sailviz.design.minimum_time.effort import Effort
from sailviz.design.minimum_time.moving_bodies import SmallBodyOrbit
from sailviz.design.minimum_time.planet_conditions import Meeting
from sailviz.design.minimum_time.state_costate import SPEED_UNIT, TIME_UNIT, canonical_sail
from sailviz.design.minimum_time.unknowns import Unknowns
from sailviz.elements import Elements
from sailviz.transfers import direct_bodies

ELEMENTS = {  # epoch JD TDB, a au, e, i, node, argument, mean anomaly deg
    "Earth": (2451545.0, 1.00000011, 0.01671022, 0.00005, -11.26064, 114.20783, -2.48284),
    "Apophis": (2459215.5, 0.9225071817339578, 0.1915216892529348, 3.336751319526047, 204.0389271089114,
                126.6520518833791, 127.3225632500591),
    "Kamooalewa": (2460400.5, 1.00094, 0.10269, 7.79605, 65.7907, 305.0478, 175.153),
}  # fmt: skip
FIRST, LAST = 2460676.5, 2461406.5  # JD TDB
A_C = 1e-3 / 5.930083519e-3  # of the Sun's pull at one au


def body(name):
    date, a, e, *angles = ELEMENTS[name]
    i, node, argument, anomaly = (float(np.radians(x)) for x in angles)
    return SmallBodyOrbit(name, Elements(a * AU, e, i, node, argument, 0.0), anomaly, date)


def utc(day):
    """Of a JD of TDB, 69.184 s ahead."""
    return np.datetime64("2000-01-01T12:00", "ns") + np.timedelta64(
        round(((day - 2451545.0) * DAY - 69.184) * 1e9), "ns"
    )


def julian(date):
    return (
        2451545.0
        + (float((date - np.datetime64("2000-01-01T12:00", "ns")) / np.timedelta64(1, "ns")) * 1e-9 + 69.184) / DAY
    )


def place_by_hand(name, day):
    """Position and velocity (6,), au and mu = 1, with Kepler's equation by a bracket."""
    date, a, e, *angles = ELEMENTS[name]
    i, node, w, mean = np.radians(angles)
    rate = a**-1.5
    mean = (mean + rate * (day - date) * DAY / TIME_UNIT) % (2 * np.pi)
    x = brentq(lambda x: x - e * np.sin(x) - mean, -1, 8, xtol=1e-15)
    p = np.array([np.cos(node) * np.cos(w) - np.sin(node) * np.sin(w) * np.cos(i),
                  np.sin(node) * np.cos(w) + np.cos(node) * np.sin(w) * np.cos(i), np.sin(w) * np.sin(i)])  # fmt: skip
    q = np.array([-np.cos(node) * np.sin(w) - np.sin(node) * np.cos(w) * np.cos(i),
                  -np.sin(node) * np.sin(w) + np.cos(node) * np.cos(w) * np.cos(i), np.cos(w) * np.sin(i)])  # fmt: skip
    b, pace = np.sqrt(1 - e * e), a * rate / (1 - e * np.cos(x))
    r = a * ((np.cos(x) - e) * p + b * np.sin(x) * q)
    return np.concatenate([r, pace * (-np.sin(x) * p + b * np.cos(x) * q)])


def motion(t, y):
    """State and costates of an ideal sail, a = A w^2 n / r^4 with w = n . r; dH/dr at a fixed normal."""
    r, v, q, p = y[:3], y[3:6], y[6:9], y[9:]
    size = np.linalg.norm(r)
    up = r / size
    c = p @ up / np.linalg.norm(p)
    across = p / np.linalg.norm(p) - c * up
    s = np.linalg.norm(across)
    tangent = (np.sqrt(8 + c * c) - 3 * c) / (4 * s)  # dH/d alpha = 0
    n = (up + tangent * across / s) / np.sqrt(1 + tangent**2)
    w = n @ r
    push = A_C * w * w / size**4
    pull = p / size**3 - 3 * (p @ r) * r / size**5
    change = A_C * (n @ p) * (2 * w * n / size**4 - 4 * w * w * r / size**6)
    return np.concatenate([v, push * n - r / size**3, pull - change, -q])


@pytest.fixture(scope="module")
def kamooalewa():
    return rendezvous(body("Kamooalewa"), utc(2461123.5), origin=body("Earth"))


def test_kamooalewa_on_a_date_from_a_cold_start(kamooalewa):
    assert kamooalewa.time / DAY == pytest.approx(224.8366250, abs=2e-6)
    known = (20.1168538, 5.9994260, 13.8637207, 5.1482652, 22.3667937, -6.3232872)
    assert kamooalewa.costates == pytest.approx(known, rel=1e-6)
    assert kamooalewa.slope == pytest.approx(0.00253, abs=5e-6)
    assert kamooalewa.residual < 1e-12


def test_scipy_flies_the_same_flight_to_the_same_place(kamooalewa):
    start = np.concatenate([place_by_hand("Earth", 2461123.5), kamooalewa.costates])
    flown = solve_ivp(motion, (0, kamooalewa.time / TIME_UNIT), start, "DOP853", rtol=1e-12, atol=1e-13).y[:, -1]
    there = place_by_hand("Kamooalewa", 2461123.5 + kamooalewa.time / DAY)
    assert np.abs(flown[:6] - there).max() < 2e-10


def nearest_best(name, found, day):
    """The local best date that a flight of a date, JD, leads to."""
    meeting = Meeting(body("Earth"), body(name), utc(FIRST), canonical_sail("ideal", 1e-3))
    x = Unknowns(found.costates / np.linalg.norm(found.costates), found.time / TIME_UNIT, (day - FIRST) * DAY)
    return meeting, launch_dates.local_best(meeting, x, 0.0, (LAST - FIRST) * DAY)


def test_the_best_date_for_kamooalewa(kamooalewa):
    meeting, best = nearest_best("Kamooalewa", kamooalewa, 2461123.5)
    assert best.flight.span * TIME_UNIT / DAY == pytest.approx(224.8363449, abs=1e-7)
    assert FIRST + best.flight.departure / DAY == pytest.approx(2461123.2778657, abs=2e-6)
    assert not best.at_edge
    known = (20.0149881, 5.8579974, 13.8804833, 5.1644273, 22.2312687, -6.2678254)
    assert best.flight.costates / meeting.ends(best.flight).arrival == pytest.approx(known, rel=1e-6)


@pytest.mark.parametrize(
    ("date", "days", "within", "best_date", "to"),
    [(2461270.0, 301.3611764, 1e-7, 2461278.32615, 1e-5), (2460890.0, 381.69, 5e-3, 2460906.4, 0.05)],
)
def test_best_dates_for_apophis_one_of_them_a_local_one(date, days, within, best_date, to):
    found = rendezvous(body("Apophis"), utc(date), origin=body("Earth"))
    _, best = nearest_best("Apophis", found, date)
    assert best.flight.span < found.time / TIME_UNIT
    assert best.flight.span * TIME_UNIT / DAY == pytest.approx(days, abs=within)
    assert FIRST + best.flight.departure / DAY == pytest.approx(best_date, abs=to)


def test_the_slope_is_what_a_day_costs(kamooalewa):
    meeting = Meeting(body("Earth"), body("Kamooalewa"), utc(2461123.5), canonical_sail("ideal", 1e-3))
    x = Unknowns(kamooalewa.costates / np.linalg.norm(kamooalewa.costates), kamooalewa.time / TIME_UNIT, 0.0)
    before, after = (meeting.nearby(x, day * DAY, 1e-13).span * TIME_UNIT / DAY for day in (-0.05, 0.05))
    assert (after - before) / 0.1 == pytest.approx(kamooalewa.slope, rel=1e-3)


def test_a_windows_edge_is_told():
    """Its last days before the best date: later would be faster."""
    found = rendezvous(body("Kamooalewa"), (utc(2461095.5), utc(2461110.5)), origin=body("Earth"), dates=3)
    assert found.window.edge == "last"
    assert found.slope < -0.05
    assert julian(found.departure) == pytest.approx(2461110.5, abs=1e-6)
    assert found.time == pytest.approx(found.window.times.min(), rel=1e-6)


@pytest.mark.skipif("SAILVIZ_LONG_TESTS" not in os.environ, reason="half a minute of CPU: set SAILVIZ_LONG_TESTS")
@pytest.mark.parametrize(
    ("name", "days", "date"), [("Apophis", 301.3611764, 2461278.32615), ("Kamooalewa", 224.8363449, 2461123.27787)]
)
def test_the_best_date_of_two_years_from_nothing(name, days, date):
    found = rendezvous(body(name), (utc(FIRST), utc(LAST)), origin=body("Earth"))
    assert found.time / DAY == pytest.approx(days, abs=1e-6)
    assert julian(found.departure) == pytest.approx(date, abs=1e-4)
    assert len(found.window.best_times) > 2


@pytest.fixture(scope="module")
def past_kamooalewa():
    return rendezvous(body("Kamooalewa"), utc(2461123.5), origin=body("Earth"), flyby=True)


def test_passing_a_body_satisfies_the_necessary_conditions_as_scipy_flies_it(past_kamooalewa, kamooalewa):
    """Its place is reached, the primer vanishes, and H - lam_r . (velocity of the body) = 1."""
    found = past_kamooalewa
    assert found.time < 0.9 * kamooalewa.time
    start = np.concatenate([place_by_hand("Earth", 2461123.5), found.costates])
    assert motion_hamiltonian(start) == pytest.approx(found.hamiltonian, abs=1e-9)
    flown = solve_ivp(motion, (0, found.time / TIME_UNIT), start, "DOP853", rtol=1e-12, atol=1e-13).y[:, -1]
    there = place_by_hand("Kamooalewa", 2461123.5 + found.time / DAY)
    assert np.abs(flown[:3] - there[:3]).max() < 2e-10
    assert np.linalg.norm(flown[9:]) < 1e-8 * np.linalg.norm(start[6:])
    assert motion_hamiltonian(start) - flown[6:9] @ there[3:] == pytest.approx(1.0, abs=1e-7)
    speed = np.linalg.norm(flown[3:6] - there[3:]) * SPEED_UNIT
    assert found.passing_speed == pytest.approx(speed, rel=1e-8)


def motion_hamiltonian(y):
    """Of the ideal sail: lam . motion."""
    rates = motion(0.0, y)
    return y[6:9] @ rates[:3] + y[9:] @ rates[3:6]


def test_the_slope_of_a_fly_by_is_what_a_day_costs(past_kamooalewa):
    meeting = Passing(body("Earth"), body("Kamooalewa"), utc(2461123.5), canonical_sail("ideal", 1e-3))
    lam = past_kamooalewa.costates / np.linalg.norm(past_kamooalewa.costates)
    x = Unknowns(lam, past_kamooalewa.time / TIME_UNIT, 0.0)
    before, after = (meeting.nearby(x, day * DAY, 1e-13).span * TIME_UNIT / DAY for day in (-0.05, 0.05))
    assert (after - before) / 0.1 == pytest.approx(past_kamooalewa.slope, rel=1e-3)


def test_direct_method_passes_the_body_in_the_same_time(past_kamooalewa, monkeypatch):
    pytest.importorskip("casadi")
    monkeypatch.setattr(direct_bodies, "INTERVALS", 12)
    monkeypatch.setattr(direct_bodies, "STRETCHES", (1.0,))
    day = utc(2461123.5)
    found = direct_bodies.to_body(
        body("Earth"), body("Kamooalewa"), (day, day), "ideal", 1e-3, flyby=True, limits=Limits(), effort=Effort()
    )
    assert found.method == "direct method, then shooting"
    assert found.time == pytest.approx(past_kamooalewa.time, rel=1e-9)
    assert found.costates == pytest.approx(past_kamooalewa.costates, rel=1e-6)


@pytest.mark.skipif("SAILVIZ_LONG_TESTS" not in os.environ, reason="half a minute of CPU: set SAILVIZ_LONG_TESTS")
@pytest.mark.parametrize(("name", "flyby"), [("Apophis", False), ("Kamooalewa", False), ("Apophis", True)])
def test_direct_method_finds_the_best_date_of_a_window_and_costates_confirm_it(name, flyby):
    pytest.importorskip("casadi")
    first, last = (2461218.5, 2461398.5) if name == "Apophis" else (2461083.5, 2461163.5)
    found = direct_bodies.to_body(
        body("Earth"), body(name), (utc(first), utc(last)), "ideal", 1e-3, flyby=flyby, limits=Limits(), effort=Effort()
    )
    assert found.method == "direct method, then shooting"
    assert abs(found.slope) < 1e-8 or flyby
    if not flyby:
        days, date = {"Apophis": (301.3611764, 2461278.32615), "Kamooalewa": (224.8363449, 2461123.27787)}[name]
        assert found.time / DAY == pytest.approx(days, abs=1e-6)
        assert julian(found.departure) == pytest.approx(date, abs=1e-4)


def test_an_open_orbit_is_refused():
    with pytest.raises(ValueError, match=r"its eccentricity is 1\.2"):
        SmallBodyOrbit("Oumuamua", Elements(-AU, 1.2, 0.0, 0.0, 0.0, 0.0), 0.0, FIRST)


def test_units():
    """What the reference calls 1 mm/s2 in units of the Sun's pull at one au, and one au per unit of time."""
    assert pytest.approx(58.132440872 * DAY, rel=1e-9) == TIME_UNIT
    assert pytest.approx(29784.6918, rel=1e-8) == SPEED_UNIT


@pytest.mark.parametrize("dates", ["2031-03-01", ("2031-03-01", "2031-04-01")], ids=["date", "window"])
def test_where_none_is_found_the_flight_between_circles_is_told(monkeypatch, dates):
    """407.70 d between circles of 1 and 1.5237 au; the orbits of that day are a little larger."""
    monkeypatch.setattr(Meeting, "fresh", lambda *_: [])
    found = rendezvous("Mars", dates)
    assert not found.feasible
    assert "2031-03-01T00:00:00" in re.split("[ ;]", found.reason)
    (days,) = re.findall(r"it takes (\S+) d", found.ending.nearest)
    assert float(days) == pytest.approx(407.70, abs=0.1)
