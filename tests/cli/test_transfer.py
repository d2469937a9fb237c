"""From a question in the shell to a scene that flies the answer."""

from __future__ import annotations

import json
import tomllib

import numpy as np
import pytest
from click.testing import CliRunner

import sailviz
from sailviz.checks.expectations import check
from sailviz.cli.main import main
from sailviz.constants import AU, DAY
from sailviz.transfers import search as transfers


def ask(*words):
    return CliRunner().invoke(main, ["transfer", *map(str, words)])


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


def test_the_shell_answers_and_writes_a_scene(tmp_path):
    file = tmp_path / "mars.toml"
    said = ask("earth", "mars", "--sail", "ideal", "--acceleration", 1, "-o", file)
    assert said.exit_code == 0, said.output
    assert "407.723742 d" in said.output
    assert "Best found" in said.output
    assert sailviz.load_scene(file).target.name == "orbit of Mars"
    summary = json.loads(ask("earth", "mars", "--json").output)
    assert summary["time_d"] == pytest.approx(407.723742, abs=1e-6)
    assert summary["residual"] < 1e-9


def test_an_unreachable_target_is_told_and_nothing_is_written():
    said = ask("earth", "--radius-au", 0.003)
    assert said.exit_code == 1, said.output
    assert "No flight found: the target lies inside the Sun." in said.output


@pytest.mark.parametrize(
    ("words", "answer"),
    [
        (("earth", "mras"), 'Did you mean "mars"?'),
        (("earth", "mars", "--sail", "idael"), 'Did you mean "ideal"?'),
        (("earth",), "Say where to"),
        (("earth", "mars", "--radius-au", 2), "Say where to"),
        (("earth", "mars", "--acceleration", -1), "above 0"),
        (("earth", "mars", "--date", "20x0"), "write 2030-01-01"),
        (("earth", "ceres", "--date", "2030-01-01"), "Ceres is none of them"),
        (("earth", "mars", "--window", 10), "--date"),
        (("earth", "earth"), "nothing to fly"),
        (("earth", "mars", "--inclination-deg", 10), "--radius-au"),
        (("earth", "mars", "--table", "--orbits"), "between circles"),
    ],
)
def test_bad_questions_are_answered_in_a_sentence(words, answer):
    said = ask(*words)
    assert said.exit_code == 2
    assert answer in said.output


def test_a_flight_that_was_not_found_is_not_written():
    nothing = transfers.circle_to_circle(AU, AU, "ideal", 1e-3)
    with pytest.raises(ValueError, match="no flight to write down"):
        transfers.scene_of(nothing)
