"""Flights that end on no orbit: written as a scene they come to the same end; what cannot be asked is refused."""

from __future__ import annotations

import tomllib

import numpy as np
import pytest

import sailviz
from sailviz import transfers
from sailviz.checks.expectations import check
from sailviz.constants import AU, DAY
from sailviz.propulsion.film_ageing import temperature

EARTH = transfers.circle(AU)


@pytest.fixture(scope="module")
def solutions():
    near = transfers.Bounds(perihelion=0.3 * AU)
    turned = transfers.Bounds(revolutions=1.0)
    there = transfers.Arrival(1.1 * AU, 29784.7)
    return {
        "fly-by": transfers.find(EARTH, "mars", "ideal", 1e-3, end=transfers.FlyBy()),
        "past the Sun": transfers.find(EARTH, None, "ideal", 2.4e-3, end=transfers.Distance(3 * AU), within=near),
        "in one revolution": transfers.find(EARTH, None, "ideal", 0.3112e-3, end=there, within=turned),
    }


@pytest.mark.parametrize("name", ["fly-by", "past the Sun", "in one revolution"])
@pytest.mark.parametrize(("form", "miss"), [("costates", 1e-7), ("table", 1e-5)])
def test_a_written_flight_comes_to_the_same_end(solutions, name, form, miss):
    solution = solutions[name]
    assert solution.flight.feasible, solution.flight.reason
    scene = sailviz.load_scene(tomllib.loads(transfers.scene_of(solution, form)))
    run = sailviz.simulate(scene)
    position, velocity, _ = transfers.path_of(solution.flight)
    assert np.linalg.norm(run.position[-1] - position[-1]) < miss * np.linalg.norm(position[-1])
    assert np.linalg.norm(run.velocity[-1] - velocity[-1]) < miss * np.linalg.norm(velocity[-1])
    assert all(verdict.passed for verdict in check(scene, run))


@pytest.mark.parametrize(
    ("ask", "answer"),
    [
        (lambda: transfers.Distance(-1.0), "positive"),
        (lambda: transfers.Escape(-1.0), "at least 0"),
        (lambda: transfers.find("earth", None), "needs a target"),
        (lambda: transfers.find("earth", "mars", end=transfers.Distance(AU)), "no other end has one"),
        (
            lambda: transfers.find("earth", "mars", within=transfers.Bounds(hottest=500.0)),
            "an ideal film mirrors all light",
        ),
        (
            lambda: transfers.find("earth", "mars", "electric-sail", within=transfers.Bounds(hottest=500.0)),
            "an electric sail has none",
        ),
    ],
)
def test_what_cannot_be_asked_of_ends_is_refused_in_words(ask, answer):
    with pytest.raises(ValueError, match=r".") as error:
        ask()
    assert answer in str(error.value)


def test_a_limit_beyond_the_start_is_impossible_and_says_why():
    far = transfers.Bounds(perihelion=2 * AU)
    found = transfers.find("earth", None, end=transfers.Distance(5 * AU), within=far)
    assert found.outcome == "impossible"
    assert "nearer to the Sun than the limit" in found.flight.reason


def test_a_film_that_is_kept_cool_flies_at_its_limit_and_takes_longer():
    cool = transfers.find(
        EARTH, "mars", "jpl-2015", 1e-3, end=transfers.FlyBy(), within=transfers.Bounds(hottest=270.0)
    )
    run = sailviz.simulate(sailviz.load_scene(tomllib.loads(transfers.scene_of(cool))))
    cosine = np.sum(run.attitude.normal * run.position, axis=1) / np.linalg.norm(run.position, axis=1)
    warm = temperature(np.linalg.norm(run.position, axis=1), np.arccos(np.minimum(cosine, 1.0)), "jpl-2015")
    assert warm.max() == pytest.approx(270.0, rel=1e-9)
    assert cool.flight.time > 1.05 * 169.463 * DAY  # of the film that may face the Sun
