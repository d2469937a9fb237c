"""A question about a transfer in the shell, and its answer."""

from __future__ import annotations

import json

import pytest
from click.testing import CliRunner

import sailviz
from sailviz.cli import main


def ask(*words):
    return CliRunner().invoke(main, ["transfer", *map(str, words)])


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
        (("earth", "kamoalewa", "--date", "2030-01-01"), 'Did you mean "kamooalewa"?'),
        (("earth", "apophis", "--date", "2029-06-01"), "Apophis passes Earth on 2029-04-14"),
        (("earth", "--body-file", "nowhere.json", "--date", "2030-01-01"), "nowhere.json cannot be read"),
        (("earth", "--body-file", "a.json", "--radius-au", 2), "Say where to"),
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


def test_all_that_does_not_go_together_is_told_at_once():
    said = ask("earth", "--window", 10, "--inclination-deg", 5, "--sail", "ideal", "--sail", "jpl-2015")
    assert said.exit_code == 2
    for answer in ("Say where to", "--inclination-deg is that", "--window counts", "Several sails"):
        assert answer in said.output
