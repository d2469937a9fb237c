"""Flights that have not come yet are counted as such, and what is said of all of them holds whatever they will do."""

from __future__ import annotations

import json

import numpy as np
import pyarrow.csv
import pyarrow.parquet as pq
import pytest
from click.testing import CliRunner
from hypothesis import given
from hypothesis import strategies as st

import sailviz
from sailviz.cli import main
from sailviz.sweeps.censoring import statistics

OUTWARD = {  # a radial push on a sail that flies out, past a distance where somebody waits
    "title": "Outward",
    "start": {"kind": "circular", "radius_au": 1.0},
    "device": {"kind": "solar-sail", "lightness_number": 0.3, "mass_kg": 10},
    "steering": {"kind": "sun-facing"},
    "propagation": {"duration_d": 300.0, "outputs": 20},
    "event": [{"kind": "radius", "name": "arrival", "radius_au": 1.2, "sense": "up", "stop": True}],
}
SWEEP = {
    "vary": {"device.lightness_number": [0.05, 0.1, 0.3, 0.4, 0.45]},  # 0.05 turns back at 1.11 au, the others come
    "report": ["time_d@arrival", "radius_au@arrival", "radius_au@end"],
    "engine": "serial",
}


@pytest.fixture(scope="module")
def found():
    return sailviz.sweep(OUTWARD, **SWEEP)


def test_a_sail_that_turns_back_is_running_when_its_time_is_over_and_not_failed(found):
    """A sun-facing sail of lightness b flies as under (1 - b) mu, from periapsis at 1 au out to 1 / (1 - 2 b) au."""
    table = found.table
    lightness = table["device.lightness_number"]
    outermost = 1 / (1 - 2 * lightness)
    comes = outermost > 1.2
    assert (found.failed, found.running) == (0, int((~comes).sum()))
    assert table["status"].tolist() == ["ok" if here else "running" for here in comes]
    assert table["reason"].tolist() == [""] * 5
    assert np.isnan(table["time_d@arrival"]).tolist() == (~comes).tolist()
    np.testing.assert_array_equal(table["time_d@arrival at least"], np.where(comes, np.nan, 300.0))
    assert "radius_au@arrival at least" not in table
    assert (table["radius_au@end"] > 0.9).all()


def test_the_median_of_a_sweep_in_which_some_never_come_is_told_as_what_it_is(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    scene = tmp_path / "outward.toml"
    scene.write_text(
        'title = "Outward"\n[start]\nkind = "circular"\nradius_au = 1\n[device]\nkind = "solar-sail"\n'
        'lightness_number = 0.3\nmass_kg = 10\n[steering]\nkind = "sun-facing"\n[propagation]\nduration_d = 150\n'
        'outputs = 20\n[[event]]\nkind = "radius"\nname = "arrival"\nradius_au = 1.2\nsense = "up"\nstop = true\n'
    )
    words = ["sweep", scene, "--engine", "serial", "--report", "time_d@arrival", "--vary"]

    def run(*more):
        result = CliRunner().invoke(main, [str(word) for word in (*words, *more)], catch_exceptions=False)
        assert result.exit_code == 0, result.output
        return result.output

    told = run("device.lightness_number=0.01,0.02,0.03,0.3,0.4")
    head, row = told.splitlines()[1:3]
    assert head.split() == [
        "quantity",
        "flights",
        "running",
        "mean",
        "deviation",
        "min",
        "5",
        "%",
        "median",
        "95",
        "%",
        "max",
    ]
    assert row.split()[:3] == ["time_d@arrival", "2", "3"]
    assert row.count("at least 150") == 3  # median, 95 % and maximum: the mean is at least something else
    assert "3 had not come where they were awaited" in told
    mostly = json.loads(run("device.lightness_number=0.01,0.3,0.4,0.45,0.35", "-o", "table.csv", "--json"))
    numbers = mostly["statistics"]["time_d@arrival"]
    assert (mostly["running"], numbers["running"], numbers["flights"]) == (1, 1, 4)
    assert "median" not in numbers["at_least"]
    assert set(numbers["at_least"]) == {"mean", "p95", "max"}
    table = pyarrow.csv.read_csv("table.csv")
    assert table.column_names == pq.read_schema("table.parquet").names
    assert table["time_d@arrival"].to_pylist() == pq.read_table("table.parquet")["time_d@arrival"].to_pylist()
    again = json.loads(run("device.lightness_number=0.01,0.3,0.4,0.45,0.35", "-o", "table.csv", "--json"))
    assert again["resumed"] == 5


@given(
    st.lists(st.floats(0, 100), min_size=1, max_size=8),
    st.lists(st.tuples(st.floats(0, 100), st.floats(0, 300)), max_size=5),
)
def test_what_is_said_of_all_holds_whatever_the_others_will_do(known, later):
    """later : of each censored flight its bound, and how much more it will be."""
    bounds = np.array([bound for bound, _ in later])
    told = statistics(known, bounds)
    truth = statistics([*known, *(bound + more for bound, more in later)], [])
    for name, number in told.items():
        true = truth[name].value
        if number.at_least:
            assert true >= number.value - 1e-9
        else:
            assert true == pytest.approx(number.value, abs=1e-9)
    assert ("deviation" in told) == (not later)


def test_statistics_without_censoring_are_those_of_numpy():
    values = np.random.default_rng(3).normal(size=57)
    told = {name: number.value for name, number in statistics([*values, np.nan], []).items()}
    wanted = {"mean": values.mean(), "deviation": values.std(ddof=1), "min": values.min(), "max": values.max()}
    wanted |= dict(zip(("p5", "median", "p95"), np.percentile(values, [5, 50, 95]), strict=True))
    assert told == pytest.approx(wanted, rel=1e-14)
    assert statistics([np.nan], [np.nan]) == {}


@pytest.mark.parametrize(
    ("vary", "draws", "number"),
    [
        ({"device.mass_kg": "1:2:1000000000"}, None, "1,000,000,000 values (a table of some 100 GB)"),
        ({"device.mass_kg": "1:2:5000", "start.radius_au": "1:2:5000"}, None, "25,000,000 flights"),
        ({"device.mass_kg": "normal(5, 1)"}, 10**12, "1,000,000,000,000 flights"),
        ({"device.mass_kg": "1:2:101"}, None, ""),
    ],
)
def test_more_flights_than_the_limit_are_counted_and_refused(vary, draws, number):
    from sailviz.errors import SceneError
    from sailviz.sweeps.definition import define

    values = {} if number else {"limits.flights": 100}
    with pytest.raises(SceneError, match=r"that limits\.flights of the scene allows") as caught:
        define(OUTWARD, vary, draws, values=values)
    assert number in str(caught.value)
    if not number:
        more, _ = define(OUTWARD, vary, draws, values={"limits.flights": 101})
        assert more.identity == define(OUTWARD, vary, draws)[0].identity  # a limit is no part of what is flown
