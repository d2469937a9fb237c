"""A question about a transfer in the shell, and its answer."""

from __future__ import annotations

import json
import os
import signal
import sys

import numpy as np
import pytest
from click.testing import CliRunner

import sailviz
from sailviz import transfers
from sailviz.checks.expectations import check
from sailviz.cli import main
from sailviz.cli import transfer as command
from sailviz.constants import AU
from sailviz.design.minimum_time import search
from sailviz.design.minimum_time.effort import Effort


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


def test_a_body_is_passed_where_it_is_and_the_scene_ends_there(tmp_path):
    file = tmp_path / "apophis.toml"
    said = ask("earth", "apophis", "--flyby", "--date", "2026-08-16", "-o", file)
    assert said.exit_code == 0, said.output
    assert "Earth past Apophis where it is, at any speed" in said.output
    assert "passes it at       9.8142 km/s" in said.output
    scene = sailviz.load_scene(file)
    run = sailviz.simulate(scene)
    assert all(verdict.passed for verdict in check(scene, run))
    body = transfers.place("apophis").body
    there = body.state(np.datetime64("2026-08-16", "ns"), run.time[-1])[0][0]
    assert np.linalg.norm(run.position[-1] - there) < 1e-7 * AU


def test_an_unreachable_target_is_told_and_nothing_is_written():
    said = ask("earth", "--radius-au", 0.003)
    assert said.exit_code == 1, said.output
    assert "Impossible: the target lies inside the Sun." in said.output
    assert json.loads(ask("earth", "--radius-au", 0.003, "--json").stdout)["outcome"] == "impossible"


def test_a_search_without_time_enough_says_what_it_tried_and_what_to_change():
    said = ask("earth", "mercury", "-a", 0.3, "--time-limit", 1e-3)
    assert said.exit_code == 1, said.output
    assert "Not found by this search, which proves nothing" in said.output
    assert "stopped by its time limit" in said.output
    assert "give the search more time" in said.output
    summary = json.loads(ask("earth", "mercury", "--time-limit", 1e-3, "--json").stdout)
    assert (summary["outcome"], summary["stopped"], summary["time_d"]) == ("not found", "time limit", None)


@pytest.mark.skipif(os.name == "nt", reason="Windows sends no SIGINT to one process")
def test_ctrl_c_keeps_the_best_flight_so_far_and_writes_it_with_a_mark(tmp_path, monkeypatch):
    """Pressed once four starts have been finished; five would have to agree before the search ends by itself."""
    pressed = []

    def count(effort, what, n=1):
        if "finished" in what and not pressed:
            pressed.append(os.kill(os.getpid(), signal.SIGINT))

    monkeypatch.setattr(Effort, "count", count)
    monkeypatch.setattr(search, "AGREE", 5)
    file = tmp_path / "mars.toml"
    said = ask("earth", "mars", "-a", 1, "-o", file)
    assert said.exit_code == 130, said.output
    assert "407.723742 d" in said.output
    assert "The search was interrupted: more time may find a faster flight." in said.output
    assert "The search was interrupted" in sailviz.load_scene(file).about


def test_a_table_tells_what_was_not_searched_from_what_was_not_found(monkeypatch):
    monkeypatch.setattr(command, "TABLE_MM_S2", (2.0, 1.0))
    monkeypatch.setattr(Effort, "count", lambda effort, what, n=1: effort.end("time limit") if "fin" in what else None)
    said = ask("earth", "mars", "--table", "--sail", "ideal", "--sail", "jpl-2015")
    assert said.exit_code == 0, said.output
    assert said.output.count("not searched") == 3
    assert "stopped by its time limit" in said.output
    assert ask("earth", "--radius-au", 0.004, "--table").output.count("impossible") == 2


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
        (("earth", "mars", "--table", "--cone-deg", 30), "flights of the indirect method"),
        (("earth", "mars", "--orbits", "--method", "direct"), "flights in one plane"),
        (("earth", "mars", "--cone-deg", 30, "--method", "indirect"), "direct method only"),
        (("earth", "mars", "--date", "2030-01-01", "--revolutions", 1), "for flights in one plane"),
        (("earth", "mars", "--date", "2030-01-01", "--slew-deg-day", 1), "for flights in one plane"),
        (("earth", "mars", "--perihelion-au", 0.5), "or --method direct"),
    ],
)
def test_bad_questions_are_answered_in_a_sentence(words, answer):
    said = ask(*words)
    assert said.exit_code == 2
    assert answer in said.output


def test_a_method_that_is_not_installed_is_told_with_what_to_install(monkeypatch):
    monkeypatch.setitem(sys.modules, "casadi", None)
    said = ask("earth", "mars", "--method", "direct")
    assert said.exit_code == 2
    assert "the direct method needs casadi: pip install 'sailviz[direct]'" in said.output


def test_all_that_does_not_go_together_is_told_at_once():
    said = ask("earth", "--window", 10, "--inclination-deg", 5, "--sail", "ideal", "--sail", "jpl-2015")
    assert said.exit_code == 2
    for answer in ("Say where to", "--inclination-deg is that", "--window counts", "Several sails"):
        assert answer in said.output
