"""Transfers by the direct method: confirmed by the indirect one, or flown as a table under limits."""

from __future__ import annotations

import os
import sys
import tomllib

import numpy as np
import pytest

from sailviz import load_scene, simulate, transfers
from sailviz.cli.transfer_in_words import summary
from sailviz.constants import AU, DAY, GRAVITY_AT_1_AU
from sailviz.design.direct.extra import NoCasadiError
from sailviz.design.direct.search import DirectFlight
from sailviz.design.minimum_time.planar_transfer import Transfer
from sailviz.design.minimum_time.state_costate import SPEED_UNIT, TIME_UNIT
from sailviz.transfers import direct

SLEW = np.radians(0.8) / DAY


def found(**asked) -> transfers.Solution:
    start, end = transfers.circle(AU), transfers.circle(1.6 * AU)
    return transfers.find(start, end, **asked)


@pytest.fixture(scope="module")
def held() -> transfers.Solution:
    pytest.importorskip("casadi")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(direct, "INTERVALS", 20)
        return found(limits=transfers.limits(turn_rate=SLEW))


def test_direct_flight_of_an_electric_sail_is_confirmed_to_all_digits_by_costates(monkeypatch):
    pytest.importorskip("casadi")
    monkeypatch.setattr(direct, "INTERVALS", 24)
    flight = found(device="electric-sail", method="direct").flight
    assert isinstance(flight, Transfer)
    assert flight.method.startswith("direct method, then")
    assert flight.time / DAY == pytest.approx(571.701024, abs=1e-6)
    assert flight.costates == pytest.approx([11.9610085, 3.5541107, 12.5650196], abs=2e-7)
    assert flight.residual < 1e-9


MARS = transfers.circle(1.52366231 * AU)
PAST_THE_SUN = 0.4 * GRAVITY_AT_1_AU  # lightness 0.4
long = pytest.mark.skipif("SAILVIZ_LONG_TESTS" not in os.environ, reason="seconds of CPU each: set SAILVIZ_LONG_TESTS")


def ended(target, a_c=1e-3, device="ideal", method="direct", **asked) -> transfers.Solution:
    return transfers.find(transfers.circle(AU), target, device, a_c, method=method, **asked)


def test_direct_flight_past_a_circle_is_confirmed_to_all_digits_by_costates(monkeypatch):
    pytest.importorskip("casadi")
    monkeypatch.setattr(direct, "INTERVALS", 12)
    flight = ended(MARS, end=transfers.FlyBy()).flight
    assert isinstance(flight, Transfer)
    assert flight.method == "direct method, then shooting"
    assert flight.time / DAY == pytest.approx(166.388947, abs=1e-6)
    assert flight.costates == pytest.approx([7.9260581, 1.3416406, 13.4102426], abs=2e-7)
    assert flight.residual < 1e-9


@long
@pytest.mark.parametrize(
    ("asked", "a_c", "days"),
    # numbers of an indirect and a direct code that are independent of this one
    [
        ({"end": transfers.FlyBy(), "target": MARS}, 0.5e-3, 286.987457),
        ({"end": transfers.Distance(5 * AU), "perihelion": 0.2}, PAST_THE_SUN, 322.640648),
        ({"end": transfers.Distance(5 * AU), "perihelion": 0.3}, PAST_THE_SUN, 351.066735),
        ({"target": transfers.circle(5.2026 * AU)}, 1e-3, 3779.827616),
        ({"target": transfers.circle(5.2026 * AU)}, 2e-3, 2394.877495),
        (
            {"end": transfers.Arrival(1.1 * AU, SPEED_UNIT), "revolutions": 1.0},
            0.052476454834170821 * GRAVITY_AT_1_AU,
            7.758406383905 * TIME_UNIT / DAY,
        ),
    ],
)
def test_direct_flights_to_other_ends_are_confirmed_by_costates(asked, a_c, days):
    pytest.importorskip("casadi")
    near, turns = asked.pop("perihelion", None), asked.pop("revolutions", None)
    within = transfers.Bounds(perihelion=None if near is None else near * AU, revolutions=turns)
    flight = ended(asked.pop("target", None), a_c, within=within, **asked).flight
    assert isinstance(flight, Transfer)
    assert flight.method.startswith("direct method, then")
    assert flight.time / DAY == pytest.approx(days, rel=1e-8)
    assert len(flight.touches) == (near is not None)


@long
@pytest.mark.parametrize(
    ("device", "asked"),
    [
        ("ideal", {"end": transfers.Escape(1e4)}),
        ("electric-sail", {"end": transfers.FlyBy(), "target": MARS}),
        ("jpl-2015", {"end": transfers.FlyBy(), "target": MARS, "within": transfers.Bounds(hottest=270.0)}),
    ],
)
def test_both_methods_find_the_same_flight_to_an_end_that_is_no_orbit(device, asked):
    pytest.importorskip("casadi")
    target = asked.pop("target", None)
    one, other = (ended(target, device=device, method=method, **asked).flight for method in ("direct", "indirect"))
    assert isinstance(one, Transfer)
    assert one.time == pytest.approx(other.time, rel=1e-9)
    assert one.residual < 1e-9


@long
def test_sail_held_within_a_cone_passes_mars_later_and_its_table_ends_there(monkeypatch):
    pytest.importorskip("casadi")
    monkeypatch.setattr(direct, "INTERVALS", 12)
    found = ended(MARS, method="auto", end=transfers.FlyBy(), limits=transfers.limits(cone=np.radians(30)))
    flight = found.flight
    assert isinstance(flight, DirectFlight)
    assert 166.389 < flight.time / DAY < 167.0
    assert np.abs(flight.table.pitch).max() <= np.radians(30)
    text = tomllib.loads(transfers.scene_of(found))
    run = simulate(load_scene(text))
    assert np.linalg.norm(run.position[-1]) / MARS.radius == pytest.approx(1.0, abs=3 * max(flight.miss, 1e-8))
    assert summary(found)["end"] == "flyby"


def test_sail_that_may_turn_only_slowly_takes_longer_and_is_told_as_unconfirmed(held):
    flight = held.flight
    assert isinstance(flight, DirectFlight)
    assert flight.feasible, flight.reason
    assert flight.time > 1.01 * found(method="indirect").flight.time
    assert "direct method" in flight.claim
    assert flight.miss < 1e-4
    told = summary(held)
    assert (told["outcome"], told["nearest"], told["advice"]) == ("found", "", [])


def test_scene_of_a_direct_flight_ends_where_its_own_flight_ended(held):
    flight = held.flight
    run = simulate(load_scene(tomllib.loads(transfers.scene_of(held))))
    last = np.linalg.norm(run.position[-1]) / AU
    assert last == pytest.approx(1.6, abs=3 * max(flight.miss, 1e-8) * 1.6)
    assert last == pytest.approx(np.linalg.norm(flight.flown.position[-1]) / AU, abs=1e-7)
    assert run.time[-1] == pytest.approx(flight.time, rel=1e-12)


def test_direct_method_without_its_extra_says_what_to_install(monkeypatch):
    monkeypatch.setitem(sys.modules, "casadi", None)
    with pytest.raises(NoCasadiError, match="needs casadi: pip install 'sailviz\\[direct\\]'"):
        found(method="direct")
    assert found().flight.feasible  # what needs no casadi is answered without


def test_questions_that_the_direct_method_has_no_answer_to_are_refused():
    with pytest.raises(ValueError, match="flights in one plane"):
        transfers.find("earth", "mars", method="direct", orbits=True)
    with pytest.raises(ValueError, match='no method "drect"'):
        found(method="drect")
    with pytest.raises(ValueError, match="kept by the direct method only"):
        found(method="indirect", limits=transfers.limits(cone=0.5))
    with pytest.raises(ValueError, match="cannot stay farther from the Sun"):
        found(limits=transfers.limits(closest=1.2 * AU))
