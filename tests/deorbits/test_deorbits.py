"""Descents asked for in words: the answer is the flight of the scene that is written, and says how sure it is."""

import json
import math
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from sailviz import load_scene, simulate, sweep
from sailviz.cli import main
from sailviz.constants import DAY, J2_EARTH, MU_EARTH, RADIUS_EARTH, YEAR
from sailviz.deorbits.question import (
    Question,
    drawn_values,
    scene_text,
    spreads,
    sun_synchronous,
    sweep_text,
)

SAIL = ["--altitude", "450", "--mass", "4", "--drag-area", "8", "--epoch", "2030-01-01", "--inclination", "51.6"]


def asked(*words):
    return CliRunner().invoke(main, ["deorbit", *map(str, words)])


def test_the_answer_is_that_of_the_scene_it_writes_and_the_sweep_varies_that_scene(tmp_path):
    out = tmp_path / "down.toml"
    result = asked(*SAIL, "--json", "-o", out)
    assert result.exit_code == 0, result.stderr
    told = json.loads(result.stdout)
    run = simulate(load_scene(out))
    first = told["flights"][0]
    assert first["down"] is True
    assert first["flown_yr"] == pytest.approx(run.time[-1] / YEAR, rel=1e-12)
    assert first["altitude_km"] == pytest.approx(120, abs=25)  # over the equatorial radius, not over the ellipsoid
    suns = [flight["flown_yr"] for flight in told["flights"] if "Sun" in flight["flight"]]
    assert len(suns) == 3
    assert suns[0] > suns[1] > suns[2]  # the more active the Sun, the thicker the air
    many = sweep(tmp_path / "down-sweep.toml", draws=2, engine="serial")
    assert many.failed == 0
    assert np.isfinite(many.table["time_yr@re-entry"]).all()


def test_the_air_alone_takes_longer_than_the_tether_with_it():
    words = ["--altitude", "400", "--mass", "4", "--tether", "500", "--drag-area", "0.5", "--epoch", "2030-01-01"]
    told = json.loads(asked(*words, "--years", "3", "--json").stdout)
    braked, alone = told["flights"][:2]
    assert "500 m of tether" in braked["flight"]
    assert alone["flight"].startswith("drag alone")
    assert braked["flown_yr"] < 0.8 * alone["flown_yr"]


def test_draws_give_percentiles_in_order_and_repeat_with_their_seed():
    words = [*SAIL, "--draws", 3, "--seed", 3, "--json"]
    one, two = (json.loads(asked(*words).stdout)["draws"] for _ in range(2))
    assert one == two
    years = one["years"]
    assert years["min"] <= years["p5"] < years["median"] < years["p95"] <= years["max"]
    assert [rule["down"] for rule in one["within"]] == [3, 3]
    assert set(one["drawn"]) == {"device.drag_coefficient", "environment.solar_flux_sfu"}


def test_drawn_flights_err_by_a_thousandth_of_their_time_and_fly_as_the_written_sweep_says(tmp_path):
    question = Question(mass=4.0, altitude=330e3, inclination=0.9, epoch="2030-01-01", drag_area=0.1)
    scene = load_text(scene_text(question))
    (whole, fast) = (simulate(scene.with_values(values)).time[-1] for values in ({}, drawn_values()))
    assert fast == pytest.approx(whole, rel=1e-3)
    assert fast != whole
    (tmp_path / "down.toml").write_text(scene_text(question))
    (tmp_path / "sweep.toml").write_text(sweep_text(question, "down.toml", 1, 3))
    first = sweep(tmp_path / "sweep.toml", engine="serial").table["time_yr@re-entry"][0]
    told = json.loads(
        asked(
            "--altitude", 330, "--inclination", math.degrees(0.9), "--mass", 4, "--drag-area", 0.1, "--epoch",
            "2030-01-01", "--draws", 1, "--seed", 3, "--json",
        ).stdout
    )  # fmt: skip
    assert told["draws"]["years"]["median"] == pytest.approx(first, rel=1e-9)


def test_an_interruption_keeps_what_has_flown(monkeypatch):
    def cut(scene, vary, *, path, values, **options):
        sweep(scene, vary, draws=2, seed=0, report=options["report"], values=values, path=path, engine="serial")
        raise KeyboardInterrupt

    import sailviz.deorbits.flights as flights

    monkeypatch.setattr(flights, "sweep", cut)
    result = asked(*SAIL, "--draws", 50)
    assert result.exit_code == 130
    assert "Interrupted: 2 of 50 flights have flown; of these:" in result.stdout
    assert "Of 2 flights: least" in result.stdout
    assert "5 %" not in result.stdout.split("Of 2 flights")[1].split("\n")[0]


def test_what_stays_up_is_told_as_not_down():
    result = asked("--altitude", 900, "--mass", 100, "--drag-area", 0.5, "--epoch", "2030-01-01", "--years", 0.05)
    assert result.exit_code == 0, result.stderr
    assert result.stdout.startswith("It is not down: after 18.2625 d its time is over")
    quiet = asked("--altitude", 900, "--mass", 100, "--drag-area", 0.5, "--epoch", "2030-01-01", "--years", 0.05, "-q")
    assert quiet.stdout == ""


@pytest.mark.parametrize(("altitude", "degrees"), [(550e3, 97.6), (800e3, 98.6)])
def test_a_sun_synchronous_node_turns_once_a_year(altitude, degrees):
    inclination = sun_synchronous(altitude)
    assert math.degrees(inclination) == pytest.approx(degrees, abs=0.05)
    axis = RADIUS_EARTH + altitude
    rate = -1.5 * math.sqrt(MU_EARTH / axis**3) * J2_EARTH * (RADIUS_EARTH / axis) ** 2 * math.cos(inclination)
    assert rate * 365.2422 * DAY == pytest.approx(2 * math.pi, rel=1e-9)


def test_a_weather_file_takes_the_place_of_the_cycle_and_lies_beside_the_scene(tmp_path):
    weather = Path(__file__).parent.parent / "data" / "foreign" / "sw_made_up.csv"
    out = tmp_path / "to" / "down.toml"
    out.parent.mkdir()
    words = [
        "--altitude",
        250,
        "--mass",
        4,
        "--drag-area",
        4,
        "--epoch",
        "2031-02-10",
        "--weather",
        weather,
        "--years",
        1,
    ]
    result = asked(*words, "-o", out)
    assert result.exit_code == 0, result.stderr
    assert (out.parent / "sw_made_up.csv").read_bytes() == weather.read_bytes()
    assert load_scene(out).environment.space_weather is not None
    assert "environment.solar_flux_sfu" not in (out.parent / "down-sweep.toml").read_text()


def test_every_fault_is_one_sentence_and_nothing_is_written(tmp_path):
    out = tmp_path / "down.toml"
    for words, said in (
        (["--mass", 4, "--drag-area", 1], "say where it flies"),
        (["--mass", 4, "--altitude", 500], "nothing brings it down"),
        (["--mass", 4, "--altitude", 500, "--drag-area", 1, "--inclination", "ss"], '"sso" or a number of degrees'),
        (["--mass", 4, "--altitude", 500, "--drag-area", 1, "--epoch", "soon"], "is no date"),
        (["--mass", 4, "--tle", tmp_path / "no.tle", "--drag-area", 1], "there is no file"),
        (["--mass", -4, "--altitude", 500, "--drag-area", 1], "of kg above 0"),
        (["--mass", 4, "--altitude", 20, "--drag-area", 1], "of km"),
    ):
        result = asked(*words, "-o", out)
        assert result.exit_code == 2
        assert said in result.stderr
        assert "Traceback" not in result.stderr
        assert not list(tmp_path.iterdir())


def test_a_question_becomes_a_scene_with_just_what_was_asked():
    brake = load_text(scene_text(Question(mass=4.0, altitude=600e3, epoch="2030-01-01", tether=300.0)))
    assert brake.device.kind == "plasma-brake"
    assert brake.environment.atmosphere is None
    assert set(spreads(Question(mass=4.0, altitude=6e5, tether=3.0))) == {
        "environment.ionosphere.density_factor",
        "environment.solar_flux_sfu",
    }
    assert 'scene = "down.toml"' in sweep_text(Question(mass=4.0, altitude=6e5, tether=3.0), "down.toml", 10)


def load_text(text):
    import tomllib

    return load_scene(tomllib.loads(text))
