"""The replay of a judged solution: where the craft flies between its rows, what is marked, and in which colours."""

from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner
from scipy.integrate import solve_ivp

import sailviz
from sailviz.checks.gtoc13 import judge, rules
from sailviz.checks.gtoc13.replay import replay
from sailviz.cli.entry import main
from sailviz.constants import YEAR

FOREIGN = Path(__file__).parents[2] / "data" / "foreign"
BODY_10 = "10,PlanetX,3411912.397,12993.800,15955016885.357,0.345,40.000,341.693,30.000,133.427,50"


@pytest.fixture
def catalogue(tmp_path):
    (tmp_path / "gtoc13_planets.csv").write_text(BODY_10 + "\n")
    return tmp_path


def test_filled_rows_lie_on_the_flight_and_are_marked(catalogue):
    found = judge(FOREIGN / "gtoc13_legal.txt", catalogue)
    run = replay(found, catalogue)
    filled = run.environment["filled"]
    assert np.count_nonzero(~filled) == 8  # moments, one of them twice: before and after the flyby
    assert 500 < filled.sum() < 3000
    assert np.all(np.diff(run.time) >= 0)
    first = np.concatenate([run.position[0], run.velocity[0]])
    coast = run.time <= found.solution.time[1]

    def rate(_, y):
        return np.concatenate([y[3:], -rules.MU * y[:3] / np.linalg.norm(y[:3]) ** 3])

    span = run.time[0], found.solution.time[1]
    known = solve_ivp(rate, span, first, "DOP853", rtol=1e-12, atol=1e-3, dense_output=True)
    off = run.position[coast] - known.sol(run.time[coast])[:3].T
    assert np.linalg.norm(off, axis=1).max() < 1e3  # m, of 3e13


def test_coasts_and_sail_arcs_have_two_colours_and_names(catalogue, tmp_path):
    run = replay(judge(FOREIGN / "gtoc13_legal.txt", catalogue), catalogue)
    assert [phase.name for phase in run.setting.phases] == ["coast", "sail", "coast"]
    path = tmp_path / "replay.rrd"
    sailviz.record(run, path)
    recording = sailviz.read(path)
    from sailviz.recording.drawing.phases import words_and_colors

    words = [word for word, _ in words_and_colors(run.setting)]
    assert words == ["cyan", "yellow", "cyan"]
    assert "/world/flybys" in recording
    assert "/world/violations" not in recording


def test_the_score_rises_at_the_flyby(catalogue):
    found = judge(FOREIGN / "gtoc13_legal.txt", catalogue)
    run = replay(found, catalogue)
    score = run.environment["score"]
    assert score[0] == 0.0
    assert score[-1] == pytest.approx(found.score)
    assert run.time[np.argmax(score > 0)] == pytest.approx(16 * YEAR)
    (event,) = run.events
    assert event.name == "flyby of PlanetX: 3 radii up, 22.93 km/s"


def test_the_push_is_that_of_the_rules_and_a_coast_has_none(catalogue):
    run = replay(judge(FOREIGN / "gtoc13_legal.txt", catalogue), catalogue)
    coasting = ~np.any(run.attitude.normal, axis=1)
    assert not run.thrust.acceleration[coasting].any()
    r = np.linalg.norm(run.position[~coasting], axis=1)
    cone = np.arccos(np.sum(run.attitude.normal[~coasting] * run.position[~coasting], axis=1) / r)
    known = 3.24156e-4 * (rules.AU / r) ** 2 * np.cos(cone) ** 2
    assert run.thrust.magnitude[~coasting] == pytest.approx(known, rel=1e-6)


def test_violations_are_events_with_their_rows(catalogue, tmp_path):
    path = tmp_path / "out.rrd"
    arguments = [FOREIGN / "gtoc13_normal_outward.txt", "--catalogue", catalogue, "-o", path]
    said = CliRunner().invoke(main, ["gtoc13", *map(str, arguments)])
    assert said.exit_code == 1
    assert "Recorded" in said.output
    names = [event.name for event in sailviz.read(path).events]
    assert "violation, row 7: the normal points away from the star, 145 deg" in names
    assert sum(name.startswith("violation, row 8") for name in names) == 2


def test_a_file_that_cannot_be_written_is_told_before_judging(catalogue):
    arguments = [FOREIGN / "gtoc13_legal.txt", "--catalogue", catalogue, "-o", catalogue / "no" / "where.rrd"]
    said = CliRunner().invoke(main, ["gtoc13", *map(str, arguments)])
    assert said.exit_code == 2
    assert "J/c" not in said.output


def test_every_broken_solution_is_drawn_or_refused_in_a_sentence(catalogue, tmp_path):
    lines = (FOREIGN / "gtoc13_legal.txt").read_text().splitlines()
    generator = np.random.default_rng(8)
    for i in range(25):
        path = tmp_path / f"{i}.txt"
        some = [lines[k] for k in sorted(generator.choice(len(lines), 9, replace=False))]
        if i % 2:
            some = [lines[k] for k in generator.permutation(len(lines))]
        path.write_text("\n".join(some))
        arguments = [path, "--catalogue", catalogue, "-o", tmp_path / "out.rrd", "-q"]
        said = CliRunner().invoke(main, ["gtoc13", *map(str, arguments)])
        assert said.exit_code in (0, 1, 2), (said.output, said.exception)
