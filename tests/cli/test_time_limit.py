"""--time-limit of `run` and `sweep`: one sentence, exit code 2, and what was done until then stays."""

from __future__ import annotations

import pytest
from click.testing import CliRunner

import sailviz
from sailviz.cli.entry import main
from sailviz.scene import load_scene

LONG = """
title = "Bound to a point"
[start]
kind = "cartesian"
position_km = [149604870.7, 0.0, 0.0]
velocity_km_s = [0.0, 3809.0, 0.0]
[device]
kind = "none"
[environment.third_body]
mu_km3_s2 = 1e11
radius_au = 1.0
[propagation]
duration_d = 300
output_interval_s = 3600
[limits]
integration_steps = 100_000_000_000
"""


@pytest.fixture
def long(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "long.toml").write_text(LONG)
    sailviz.simulate(load_scene(tmp_path / "long.toml", {"propagation.duration_d": 0.05}))  # compiled
    return tmp_path


def test_run_that_takes_too_long_leaves_a_recording_that_says_so(long):
    result = CliRunner().invoke(main, ["run", "long.toml", "--time-limit", "1"])
    assert result.exit_code == 2
    assert "long.toml: the time limit of 1 s is over: the flight had reached" in result.stderr
    assert "Unfinished: long.rrd is valid up to" in result.stderr
    recording = sailviz.read(long / "long.rrd")
    assert not recording["/scene"]["complete"][0]
    assert recording["/events"]["name"][-1].startswith("the time limit of 1 s is over")


def test_time_limit_must_be_a_time(long):
    for word in ("0", "-1", "nan", "soon"):
        assert CliRunner().invoke(main, ["run", "long.toml", "--time-limit", word]).exit_code == 2
        assert not list(long.glob("*.rrd"))


@pytest.mark.parametrize(("engine", "limit"), [("processes", "25"), ("threads", "6"), ("serial", "6")])
def test_sweep_that_takes_too_long_keeps_the_flights_that_are_done(long, engine, limit):
    durations = "propagation.duration_d=0.01,0.02,300"
    arguments = ["sweep", "long.toml", "--vary", durations, "--set", "propagation.output_interval_s=60"]
    arguments += ["--set", "expect=[]", "--report", "time_d@end", "--engine", engine, "--workers", "1"]
    result = CliRunner().invoke(main, [*arguments, "--time-limit", limit])
    assert result.exit_code == 2, result.output
    assert f"the time limit of {limit} s is over: 2 of 3 flights are done" in result.stderr
    assert "long-sweep.parquet holds the 2 flights that are done. The same command goes on from there." in result.stderr
