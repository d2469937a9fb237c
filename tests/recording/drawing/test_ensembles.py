"""Many flights: the numbers of an ensemble come back from a recording, and the picture says what they are."""

from __future__ import annotations

import numpy as np
import pytest

from sailviz import compare, load_scene
from sailviz.constants import AU, DAY
from sailviz.errors import SceneError
from sailviz.recording import digest, export, read, record
from sailviz.recording.drawing.arrival_plane import RING, SIGMAS, ellipses
from sailviz.recording.views.info import info
from sailviz.simulation.loop import simulate
from sailviz.uncertainty.covariance import linear
from sailviz.uncertainty.ensembles import fly_factors

WIND = {"kind": "gamma", "shape": 2.593, "scale_nPa": 0.7793, "redraw_h": 24, "seed": 5}
SCENE = {
    "title": "ensemble",
    "start": {"kind": "circular", "radius_au": 1},
    "device": {"kind": "electric-sail", "characteristic_acceleration_mm_s2": 1, "control": {"kind": "pressure"}},
    "steering": {"kind": "orbital", "pitch_deg": 40, "clock_deg": 90},
    "environment": {"solar_wind": WIND},
    "propagation": {"duration_d": 60, "outputs": 121},
    "ensemble": [
        {"name": "no control", "flights": 400, "keep": 20, "control": "none"},
        {"name": "held", "flights": 100, "keep": 7},
    ],
}


@pytest.fixture(scope="module")
def run():
    return simulate(load_scene(SCENE))


@pytest.fixture(scope="module")
def recorded(run, tmp_path_factory):
    path = tmp_path_factory.mktemp("ensembles") / "ensemble.rrd"
    record(run, path)
    return path


def test_ensemble_of_a_scene_spreads_as_its_linear_covariance(run):
    """The spread that the sensitivities to 60 daily draws add up to; 400 flights know a deviation to 3.5 %."""
    ensemble = run.setting.ensembles[0]
    start = run.position[0], run.velocity[0]
    options = {"pitch": np.radians(40), "characteristic_acceleration": 1e-3}

    def ends(factors):
        return fly_factors(factors, DAY, *start, 60 * DAY, **options)[:, [0, 1, 3, 4]]

    found = linear(ends, 60, mean=0.953210, deviation=0.302309)
    assert ensemble.end_deviation[[0, 1, 3, 4]] == pytest.approx(found.standard_deviation, rel=0.12)
    assert np.all(np.abs(ensemble.end_mean[[0, 1, 3, 4]] - found.mean) < 3.5 * found.standard_deviation / 20)
    assert ensemble.mean_factor == pytest.approx(0.953210, abs=3.5 * 0.3023 / np.sqrt(60 * 400))


def test_controlled_flights_stay_closer_and_ensembles_end_where_the_nominal_run_does(run):
    calm = simulate(load_scene(SCENE | {"environment": {}, "ensemble": []}))
    free, held = run.setting.ensembles
    for ensemble in (free, held):
        assert np.abs(ensemble.places(ensemble.nominal[-1]) - calm.position[-1]).max() / AU < 1e-7
        assert np.array_equal(ensemble.time, run.time[ensemble.step])
    assert held.end_deviation[0] < 0.4 * free.end_deviation[0]
    assert held.mean_saturated == pytest.approx(0.0498, abs=0.01)


def test_truth_of_an_ensemble_comes_back_bit_for_bit(run, recorded):
    recording = read(recorded)
    for ensemble, name in zip(run.setting.ensembles, ("no_control", "held"), strict=True):
        table = recording[f"/ensemble/{name}"]
        assert np.array_equal(table["time_s"], ensemble.time)
        assert np.array_equal(table["radius_m"], ensemble.percentiles["radius_m"].T)
        assert np.array_equal(
            table["kept_position_m"].reshape(len(ensemble.time), -1, 3)[:, 3], ensemble.places(ensemble.kept[3])
        )
        assert np.array_equal(table.timeline("step"), ensemble.step)
        facts = recording[f"/ensemble/{name}/facts"]
        assert facts["flights"][0] == ensemble.flights
        assert np.array_equal(np.ravel(facts["end_radius_m"])[: ensemble.flights], ensemble.end[:, 0])
    assert recording["/ensemble/held"]["kept_position_m"].shape[1] == 21


def test_covariance_of_the_recording_is_that_of_the_flights_along_and_across_the_orbit(run, recorded):
    ensemble = run.setting.ensembles[0]
    found = read(recorded)["/ensemble/no_control"]["covariance_m2"][-1].reshape(3, 3)
    way = ensemble.end[:, :2] * [1.0, ensemble.mean[-1, 0]]
    assert found[:2, :2] == pytest.approx(np.cov(way.T, ddof=0), rel=0.02)
    assert found[0, 1] < 0  # farther out is behind


def test_ellipses_are_level_lines_of_the_covariance(run):
    ensemble = run.setting.ensembles[0]
    inverse = np.linalg.inv(ensemble.covariance[-1, :2, :2] * np.outer([1 / AU, 1.0], [1 / AU, 1.0]))
    for sigma, ring in zip(SIGMAS, ellipses(ensemble), strict=True):
        off = (ring[-1, :, :2] - ensemble.mean[-1, :2]) / [AU, 1.0]
        assert np.einsum("ki,ij,kj->k", off, inverse, off) == pytest.approx(np.full(RING, sigma**2), rel=1e-6)


def test_histograms_count_every_recorded_flight(run):
    for ensemble in run.setting.ensembles:
        assert ensemble.histogram.sum(axis=1) == pytest.approx(np.ones(len(ensemble.time)))
    assert run.setting.ensembles[0].histogram[0, 0] == 1  # all begin together


def test_recordings_with_ensembles_compare_export_and_tell(run, recorded, tmp_path):
    again = tmp_path / "again.rrd"
    record(simulate(load_scene(SCENE)), again)
    assert digest(again) == digest(recorded)
    assert compare(run, recorded).equal
    other = simulate(load_scene(SCENE, {"environment.solar_wind.seed": 6}))
    assert "/ensemble/held:radius_m" in {d.quantity for d in compare(run, other).different}
    written = export(recorded, tmp_path / "table.csv")
    assert {path.name for path in written} == {
        "table.csv",
        "table.ensemble.no_control.csv",
        "table.ensemble.held.csv",
    }
    facts = info(recorded)
    assert "/ensemble/held" in facts["truth"]
    assert {"Off nominal", "Flight", "Voltage of the tethers [kV]"} <= set(facts["views"])


def test_one_flight_of_a_thousand_does_not_depend_on_how_many_fly(run):
    fewer = simulate(load_scene(SCENE, {"ensemble.0.flights": 50})).setting.ensembles[0]
    assert np.array_equal(fewer.end, run.setting.ensembles[0].end[:50])


@pytest.mark.parametrize(
    ("values", "sentence"),
    [
        ({"environment.solar_wind": {"kind": "steady"}}, "in a steady wind all flights are the same"),
        ({"device.active_d": [[0, 10]]}, "sail is on all the time"),
        ({"ensemble.1.name": "No control"}, "another ensemble is called"),
        ({"ensemble.0.control": {"kind": "electrochromic"}}, "an electric sail controls its voltage"),
        ({"ensemble.0.flights": 1_000_000, "propagation.duration_d": 4000}, "more than the 1,000,000,000 that limits"),
        ({"chaos": [{"name": "gPC"}]}, "one gamma-distributed pressure for a whole flight"),
        ({"event": [{"kind": "radius", "radius_au": 1.2, "stop": True}]}, "no event may stop the run"),
        ({"steering": {"kind": "inertial", "direction": [1.0, 0.0, 0.0]}}, "depends on where each flight is"),
        (
            {
                "expect": [
                    {"quantity": "radius_au", "ensemble": "hold", "statistic": "mean", "at": "end"} | {"value": 1}
                ]
            },
            "",
        ),
    ],
)
def test_what_an_ensemble_cannot_fly_is_refused_with_its_reason(values, sentence):
    with pytest.raises(SceneError) as refused:
        load_scene(SCENE, values)
    assert sentence in str(refused.value)
