"""Transfers by the direct method: confirmed by the indirect one, or flown as a table under limits."""

from __future__ import annotations

import sys
import tomllib

import numpy as np
import pytest

from sailviz import load_scene, simulate, transfers
from sailviz.cli.transfer_in_words import summary
from sailviz.constants import AU, DAY
from sailviz.design.direct.extra import NoCasadiError
from sailviz.design.direct.search import DirectFlight
from sailviz.design.minimum_time.planar_transfer import Transfer
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
    with pytest.raises(ValueError, match="between circles in one plane"):
        transfers.find("earth", "mars", method="direct", orbits=True)
    with pytest.raises(ValueError, match='no method "drect"'):
        found(method="drect")
    with pytest.raises(ValueError, match="kept by the direct method only"):
        found(method="indirect", limits=transfers.limits(cone=0.5))
    with pytest.raises(ValueError, match="cannot stay farther from the Sun"):
        found(limits=transfers.limits(closest=1.2 * AU))
