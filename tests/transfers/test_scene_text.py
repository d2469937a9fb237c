"""The answer to a question, written as a scene, flies to the same end."""

from __future__ import annotations

import tomllib

import numpy as np
import pytest

import sailviz
from sailviz import transfers
from sailviz.checks.expectations import check
from sailviz.constants import AU, DAY
from sailviz.design.minimum_time import circle_to_circle


@pytest.fixture(scope="module")
def solutions():
    return {
        "circles": transfers.find("earth", "mars", "electric-sail", 1e-3),  # coasts on the way
        "film": transfers.find("earth", "venus", "jpl-2015", 1e-3),  # stands edge-on for a while
        "orbits": transfers.find("earth", transfers.circle(0.8 * AU, np.radians(3.0)), "ideal", 1e-3, starts=6),
        "rendezvous": transfers.find("earth", "venus", "ideal", 1e-3, departure="2029-07-22"),
    }


@pytest.mark.parametrize("name", ["circles", "film", "orbits", "rendezvous"])
@pytest.mark.parametrize(("form", "miss"), [("costates", 1e-8), ("table", 1e-5)])
def test_a_written_transfer_flies_to_the_same_end(solutions, name, form, miss):
    solution = solutions[name]
    assert solution.flight.feasible, solution.flight.reason
    scene = sailviz.load_scene(tomllib.loads(transfers.scene_of(solution, form)))
    run = sailviz.simulate(scene)
    position, velocity, switches = transfers.path_of(solution.flight)
    assert np.linalg.norm(run.position[-1] - position[-1]) < miss * np.linalg.norm(position[-1])
    assert np.linalg.norm(run.velocity[-1] - velocity[-1]) < miss * np.linalg.norm(velocity[-1])
    assert all(verdict.passed for verdict in check(scene, run))
    thrust = [event.time for event in run.events if event.name.startswith("thrust ")]
    assert thrust == pytest.approx(list(switches), abs=1e-3 * DAY)


def test_the_target_is_drawn_where_the_flight_ends(solutions):
    scene = sailviz.load_scene(tomllib.loads(transfers.scene_of(solutions["orbits"])))
    run = sailviz.simulate(scene)
    target = next(r.points for r in run.setting.references if r.role == "target")
    initial = next(r.points for r in run.setting.references if r.role == "initial")
    # 361 points of a circle lie 0.0044 of its radius from anything between them
    assert np.linalg.norm(target - run.position[-1], axis=1).min() < 0.01 * AU
    assert np.linalg.norm(initial - run.position[0], axis=1).min() < 0.01 * AU


def test_a_designed_result_can_be_written_without_words(solutions):
    text = transfers.scene_of(solutions["circles"].flight, title="x")
    scene = sailviz.load_scene(tomllib.loads(text))
    assert scene.target.radius == pytest.approx(1.52371034 * AU, rel=1e-7)


def test_a_flight_that_was_not_found_is_not_written():
    nothing = circle_to_circle(AU, AU, "ideal", 1e-3)
    with pytest.raises(ValueError, match="no flight to write down"):
        transfers.scene_of(nothing)
