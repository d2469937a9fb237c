"""Whole solutions of GTOC13: made-up ones with known verdicts, broken ones, and ones that break a single rule."""

import json
import time
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner
from scipy.integrate import solve_ivp

from sailviz import two_body
from sailviz.checks.gtoc13 import judge, rules, sail
from sailviz.checks.gtoc13.passages import body_state
from sailviz.cli.entry import main
from sailviz.constants import DAY, YEAR
from sailviz.elements import elements
from sailviz.errors import RecordingError
from sailviz.exchange.gtoc13 import CompetitionBody

FOREIGN = Path(__file__).parents[2] / "data" / "foreign"
BODY_10 = "10,PlanetX,3411912.397,12993.800,15955016885.357,0.345,40.000,341.693,30.000,133.427,50"
AU = rules.AU


@pytest.fixture
def catalogue(tmp_path):
    folder = tmp_path / "catalogue"
    folder.mkdir()
    (folder / "gtoc13_planets.csv").write_text(f"#number,name,...\n{BODY_10}\n")
    return folder


def _command(*arguments):
    return CliRunner().invoke(main, ["gtoc13", *map(str, arguments)])


def _rows(name):
    text = (FOREIGN / name).read_text().splitlines()
    return np.array([[float(word) for word in line.split(",")] for line in text if not line.startswith("#")])


def _written(path, rows):
    path.write_text("".join(", ".join(f"{value:.17g}" for value in row) + "\n" for row in rows))
    return path


def test_a_legal_solution_has_its_score(catalogue):
    found = judge(FOREIGN / "gtoc13_legal.txt", catalogue)
    assert found.legal
    assert not found.notes
    assert found.score == pytest.approx(18.571307511, abs=5e-10)
    (flyby,) = found.flybys
    assert flyby.v_inf == pytest.approx(22926.8353, abs=1e-4)
    assert flyby.quality == pytest.approx(0.37142615, abs=5e-9)
    assert flyby.altitude / flyby.body.radius == pytest.approx(3.0, abs=1e-6)
    (wheel,) = found.as_json()["wheel"]
    assert (wheel["body"], wheel["flybys"]) == (10, 1)
    assert wheel["points"] == pytest.approx(found.score)
    assert wheel["sectors"].index(1) == int(np.degrees(np.arctan2(flyby.place[1], flyby.place[0])) % 360 // 30)


def test_200_m_off_are_found_at_the_conic_and_at_the_flyby(catalogue):
    found = judge(FOREIGN / "gtoc13_off_200_m.txt", catalogue)
    assert [(each.row, each.name) for each in found.violations] == [(2, "conic"), (3, "flyby")]
    assert [each.size for each in found.violations] == pytest.approx([0.2, 0.2], abs=1e-5)  # km


def test_a_normal_that_points_outward_breaks_two_rules(catalogue):
    found = judge(FOREIGN / "gtoc13_normal_outward.txt", catalogue)
    assert [(each.row, each.name) for each in found.violations] == [(7, "cone"), (8, "cone"), (8, "sail error")]
    assert found.violations[0].size == pytest.approx(145.0, abs=1e-4)
    assert found.violations[2].size == pytest.approx(4.8e-2, rel=0.01)
    assert found.score == pytest.approx(18.571307511, abs=5e-10)


@pytest.mark.parametrize(("name", "nearest", "legal"), [("deep_once", 0.030, True), ("burnt", 0.008, False)])
def test_the_perihelion_between_two_rows_is_found(name, nearest, legal):
    found = judge(FOREIGN / f"gtoc13_{name}.txt")
    assert found.legal is legal
    assert found.approaches[0].distance / AU == pytest.approx(nearest, abs=1e-9)
    assert [each.name for each in found.violations] == ([] if legal else ["perihelion"])
    assert found.score == 0.0


def test_the_command_tells_rows_sizes_and_score(catalogue):
    path = FOREIGN / "gtoc13_normal_outward.txt"
    said = _command(path, "--catalogue", catalogue)
    assert said.exit_code == 1
    assert "3 violations, J/c = 18.571307511" in said.output
    assert "145 deg" in said.output
    found = json.loads(_command(path, "--catalogue", catalogue, "--json").output)
    assert found["score_over_c"] == pytest.approx(18.571307511, abs=5e-10)
    assert [(each["row"], each["line"], each["name"]) for each in found["violations"]] == [
        (7, 8, "cone"), (8, 9, "cone"), (8, 9, "sail error"),
    ]  # fmt: skip
    assert _command(FOREIGN / "gtoc13_legal.txt", "--catalogue", catalogue, "-q").output == ""
    assert _command(FOREIGN / "gtoc13_deep_once.txt").exit_code == 0


def test_flybys_need_the_catalogue(tmp_path):
    said = _command(FOREIGN / "gtoc13_legal.txt")
    assert said.exit_code == 2
    assert "--catalogue" in said.output
    (tmp_path / "gtoc13_comets.csv").write_text("2001,1e10,0.9,10,20,30,40,1\n")
    said = _command(FOREIGN / "gtoc13_legal.txt", "--catalogue", tmp_path)
    assert said.exit_code == 2
    assert "body 10" in said.output
    assert _command(FOREIGN / "gtoc13_legal.txt", "--catalogue", tmp_path / "none").exit_code == 2


def _scaled(time=1.0, place=1.0, speed=1.0):
    rows = _rows("gtoc13_legal.txt")
    rows[:, 2] *= time
    rows[:, 3:6] *= place
    rows[:, 6:9] *= speed
    return rows


@pytest.mark.parametrize(
    ("rows", "words"),
    [
        (_scaled(time=1 / DAY), "days, km and km/s"),
        (_scaled(time=1 / YEAR), "years, km and km/s"),
        (_scaled(place=1e3), "1000"),
        (_scaled(place=1e3 / AU), "possible"),
        (_scaled(speed=1e3), "s, km and m/s"),
    ],
)
def test_other_units_are_named(tmp_path, catalogue, rows, words):
    said = _command(_written(tmp_path / "scaled.txt", rows), "--catalogue", catalogue)
    assert said.exit_code == 2
    if words != "1000":
        assert words in said.output


def test_broken_files_are_refused_in_one_sentence_or_judged(tmp_path, catalogue):
    text = (FOREIGN / "gtoc13_legal.txt").read_bytes()
    lines = text.splitlines(keepends=True)
    generator = np.random.default_rng(5)
    broken = [text[:cut] for cut in (0, 1, 60, 100, 700, 1500, len(text) - 30, len(text) - 200)]
    broken += [b"".join(lines[:-1]), b"".join(lines[:4]), b"".join(lines[1:2]), b"".join(lines[5:7])]
    broken += [b"".join(lines[i] for i in generator.permutation(len(lines))) for _ in range(12)]
    for word in (b"nan", b"inf", b"1e400", b"abc", b"", b"1_0", b"-1", b"99", b"0x10", b"1d5", b"\xff", b"\x00"):
        for column in (0, 1, 2, 3, 8, 11):
            row = lines[6].split(b",")
            row[column] = word
            broken.append(b"".join([*lines[:6], b",".join(row).rstrip() + b"\n", *lines[7:]]))
    for _ in range(40):
        letters = bytearray(text)
        for place in generator.integers(0, len(text), 6):
            letters[place] = int(generator.integers(0, 256))
        broken.append(bytes(letters))
    refused = 0
    for i, content in enumerate(broken):
        path = tmp_path / f"{i}.txt"
        path.write_bytes(content)
        said = _command(path, "--catalogue", catalogue)
        assert said.exit_code in (0, 1, 2), (content[:200], said.output, said.exception)
        assert "Traceback" not in said.output
        if said.exit_code == 2:
            refused += 1
            assert said.output.count("\n") == 1
    assert refused > 50


def test_two_hundred_years_of_sail_are_judged_within_half_a_minute(tmp_path):
    start = np.array([-200 * AU, 3.0 * AU, 0.1 * AU, 30e3, 0.0, 0.0])

    def tilted(place):
        s = -place / np.linalg.norm(place)
        across = np.cross([0.0, 0.0, 1.0], s)
        return np.cos(0.6) * s + np.sin(0.6) * across / np.linalg.norm(across)

    def rate(_, y):
        r = np.linalg.norm(y[:3])
        u, s = tilted(y[:3]), -y[:3] / r
        push = rules.CHARACTERISTIC_ACCELERATION * (AU / r) ** 2 * (u @ s) ** 2
        return np.concatenate([y[3:], -rules.MU * y[:3] / r**3 - push * u])

    # steps as long as the angle about the star allows: short ones near it
    flown = solve_ivp(rate, (0.0, 200 * YEAR), start, "DOP853", rtol=1e-12, atol=1e-6, dense_output=True)
    x, times = 0.0, [0.0]
    while x < 200 * YEAR:
        y = flown.sol(x)
        x = min(x + max(60.0, 2e-3 * np.linalg.norm(y[:3]) / np.linalg.norm(y[3:])), 200 * YEAR)
        times.append(x)
    states = flown.sol(np.array(times)).T
    normals = np.array([tilted(y[:3]) for y in states])
    rows = np.column_stack([np.zeros(len(times)), np.ones(len(times)), times, states / 1e3, normals])
    path = _written(tmp_path / "long.txt", rows)
    begun = time.process_time()
    found = judge(path)
    assert len(times) > 5000
    assert found.legal, found.violations[:3]
    assert time.process_time() - begun < 30.0


def _asteroid_flight(tmp_path, second, jump=0.0):
    """A conic that leads past the star to an asteroid, twice as it may be; rows and a catalogue."""
    folder = tmp_path / "catalogue"
    folder.mkdir(exist_ok=True)
    start = np.array([-200 * AU, 40 * AU, 0.0]), np.array([28e3, 0.0, 0.0])
    spans = np.array([second, second + 0.5 * YEAR])
    place, speed = two_body.advance(np.tile(start[0], (2, 1)), np.tile(start[1], (2, 1)), spans, rules.MU)
    across = np.cross([0, 0, 1.0], place[0] / np.linalg.norm(place[0]))
    here = elements(place[0], -1.02 * np.sqrt(rules.MU / np.linalg.norm(place[0])) * across, rules.MU)
    e, true = float(here.eccentricity), float(here.true_anomaly)
    eccentric = 2 * np.arctan(np.sqrt((1 - e) / (1 + e)) * np.tan(true / 2))
    a = float(here.semi_major_axis)
    anomaly = eccentric - e * np.sin(eccentric) - np.sqrt(rules.MU / a**3) * second
    angles = [float(np.degrees(value)) for value in (here.inclination, here.raan, here.argument, anomaly)]
    line = ",".join(f"{value:.17g}" for value in (1001, a / 1e3, e, *angles, 3))
    (folder / "gtoc13_asteroids.csv").write_text(line + "\n")
    body = CompetitionBody(1001, "", 0, 0, a, e, *np.radians(angles), 3)
    at, velocity = (vector[0] for vector in body_state(body, np.array([second])))
    assert np.linalg.norm(at - place[0]) < 1.0
    zero = np.zeros(3)
    kick = np.array([jump, 0, 0])
    rows = [
        [0, 0, 0, *start[0] / 1e3, *start[1] / 1e3, *zero],
        [0, 0, spans[0], *place[0] / 1e3, *speed[0] / 1e3, *zero],
        [1001, 1, spans[0], *place[0] / 1e3, *speed[0] / 1e3, *(speed[0] - velocity) / 1e3],
        [1001, 1, spans[0], *place[0] / 1e3, *(speed[0] + kick) / 1e3, *(speed[0] + kick - velocity) / 1e3],
    ]
    return _written(tmp_path / "asteroid.txt", rows), folder


def test_an_asteroid_counts_after_the_first_perihelion_only(tmp_path):
    before = judge(*_asteroid_flight(tmp_path, 20 * YEAR))
    assert before.legal
    assert before.score == 0.0
    assert not before.flybys[0].counts
    after = judge(*_asteroid_flight(tmp_path, 60 * YEAR))
    assert after.legal, after.violations
    assert after.approaches[0].time < 60 * YEAR
    assert after.score > 0.0


def test_a_file_that_ends_while_it_comes_closer_has_not_passed_its_perihelion(tmp_path):
    """Within 0.05 au the end counts as near as it came, and no asteroid scores by it."""
    end, span = (np.array([[0.03 * AU, 0.0, 0.0]]), np.array([[-9e4, 3e4, 0.0]])), 1e4
    start = two_body.advance(*end, [-span], rules.MU)
    states = [[0.0, 0.0, at] for at in (0.0, span)]
    rows = [[*row, *(r[0] / 1e3), *(v[0] / 1e3), 0, 0, 0] for row, (r, v) in zip(states, (start, end), strict=True)]
    found = judge(_written(tmp_path / "inward.txt", rows))
    assert [each.passed for each in found.approaches] == [False]
    assert {each.name for each in found.violations} == {"start"}


def test_an_asteroid_does_not_bend_the_way(tmp_path):
    found = judge(*_asteroid_flight(tmp_path, 20 * YEAR, jump=0.01))
    assert [(each.row, each.name) for each in found.violations] == [(4, "flyby")]
    assert found.violations[0].size == pytest.approx(1e-5, rel=1e-3)  # km/s


def _changed(catalogue, tmp_path, change):
    rows = _rows("gtoc13_legal.txt")
    change(rows)
    return judge(_written(tmp_path / "changed.txt", rows), catalogue)


def _named(found):
    return [(each.row, each.name) for each in found.violations]


def test_the_start_is_held_to_its_place_and_direction(catalogue, tmp_path):
    def change(rows):
        rows[0, 3] += 0.2
        rows[0, 7] = 3e-7

    found = _changed(catalogue, tmp_path, change)
    assert _named(found)[:2] == [(1, "start"), (1, "start")]
    assert [each.size for each in found.violations[:2]] == pytest.approx([0.2, 3e-7], rel=1e-4)


def test_a_joint_whose_rows_differ_is_found_and_a_digit_is_a_note(catalogue, tmp_path):
    def change(rows):
        rows[13, 2] += 3600.0
        rows[12, 2] += 1e-3

    assert (13, "joint") in _named(_changed(catalogue, tmp_path, change))

    def little(rows):
        rows[12, 6] += 5e-10

    found = _changed(catalogue, tmp_path, little)
    assert found.legal
    assert [(each.row, each.name) for each in found.notes] == [(13, "joint")]


def test_a_flyby_without_a_turn_is_infinitely_high(catalogue, tmp_path):
    def change(rows):
        rows[3, 6:] = rows[2, 6:]

    found = _changed(catalogue, tmp_path, change)
    assert (4, "altitude") in _named(found)
    assert json.loads(json.dumps(found.as_json(), allow_nan=False))["flybys"][0]["altitude_km"] is None


def test_a_flyby_that_turns_too_much_is_too_low(catalogue, tmp_path):
    def change(rows):
        rows[3, 9:] = -rows[2, 9:]
        rows[3, 6:9] += rows[3, 9:] - _rows("gtoc13_legal.txt")[3, 9:]

    found = _changed(catalogue, tmp_path, change)
    (low,) = (each for each in found.violations if each.name == "altitude")
    assert low.size == pytest.approx(-1.0, abs=1e-6)  # straight through the centre


def test_a_flyby_that_gains_speed_is_found(catalogue, tmp_path):
    def change(rows):
        way = rows[3, 9:] / np.linalg.norm(rows[3, 9:])
        rows[3:5, 6:9] += 1e-6 * way

    found = _changed(catalogue, tmp_path, change)
    assert found.violations[0][:3:2] == (4, "flyby")
    assert found.violations[0].size == pytest.approx(1e-6, rel=1e-3)


def test_normals_are_of_length_one_and_none_is_lacking(catalogue, tmp_path):
    def change(rows):
        rows[6, 9:] = 0.0
        rows[7, 9:] *= 1 + 3e-6

    found = _changed(catalogue, tmp_path, change)
    assert {(7, "normal"), (8, "normal")} <= set(_named(found))


def test_a_step_under_a_minute_is_too_short(catalogue, tmp_path):
    rows = _rows("gtoc13_legal.txt")
    steps = sail.Steps(rows[4:5, 3:9] * 1e3, np.array([50.0]), rows[4:5, 9:], rows[4:5, 9:], rows[4:5, 9:])
    end = sail.fly(steps).state[0] / 1e3
    extra = [0, 1, rows[4, 2] + 50.0, *end, *rows[4, 9:]]
    found = judge(_written(tmp_path / "short.txt", [*rows[:5], extra, *rows[5:]]), catalogue)
    assert _named(found) == [(6, "sail step")]
    assert found.violations[0].size == pytest.approx(50.0)


def test_what_no_file_can_mean_is_refused(tmp_path):
    path = tmp_path / "one.txt"
    path.write_text("0 1 0 -2.9919574138200005e10 1 1 20 0 0 1 0 0\n")
    with pytest.raises(RecordingError, match="a sail arc of one row"):
        judge(path)
