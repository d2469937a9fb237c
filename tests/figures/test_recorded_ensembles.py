"""Ensembles and swings on paper: every band is read back from the figure and compared with what was flown."""

from __future__ import annotations

import numpy as np
import pytest

pytest.importorskip("matplotlib")

from sailviz import load_scene
from sailviz.constants import AU, DAY, MU_EARTH
from sailviz.figures import draw_recording, page
from sailviz.figures.recorded import curves_page, ensembles_page
from sailviz.figures.recorded_curves import curve_of
from sailviz.figures.recorded_ensembles import MILLI_AU, ensembles_of
from sailviz.figures.recorded_swings import bands_of, revolutions
from sailviz.recording import read, record, record_trajectory
from sailviz.recording.recorded_run import run_of
from sailviz.simulation.loop import simulate

SCENE = {
    "title": "ensemble",
    "start": {"kind": "circular", "radius_au": 1},
    "device": {"kind": "electric-sail", "characteristic_acceleration_mm_s2": 1, "control": {"kind": "pressure"}},
    "steering": {"kind": "orbital", "pitch_deg": 40, "clock_deg": 90},
    "environment": {"solar_wind": {"kind": "gamma", "shape": 2.593, "scale_nPa": 0.7793, "redraw_h": 24, "seed": 5}},
    "propagation": {"duration_d": 60, "outputs": 121},
    "ensemble": [
        {"name": "no control", "flights": 200, "keep": 20, "control": "none"},
        {"name": "held", "flights": 100, "keep": 7},
    ],
}
SHORT = {"propagation.duration_d": 200, "propagation.outputs": 150, "expect": []}


@pytest.fixture(scope="module", params=["planar", "displaced"])
def flown(request, tmp_path_factory):
    """A run with ensembles and its recording: round the Sun, and above it."""
    scene = load_scene(SCENE) if request.param == "planar" else load_scene("wind/held-displaced", SHORT)
    run = simulate(scene)
    path = tmp_path_factory.mktemp("ensembles") / "run.rrd"
    record(run, path)
    return run, path


def composed(made, style="light"):
    entry, options = made
    return page.compose(entry, style, options)


def line(axes, gid):
    return next(one for one in axes.lines if one.get_gid() == gid)


def edges(axes, gid):
    """Lower and upper edge of a band over its own times."""
    [band] = [one for one in axes.collections if one.get_gid() == gid]
    vertices = band.get_paths()[0].vertices
    half = len(vertices) // 2
    return vertices[1:half, 1], vertices[half + 1 : -1, 1][::-1]


def test_the_mean_and_its_deviations_are_those_of_the_flights_as_they_were_flown(flown):
    """The recording knows positions and a covariance; the figure gets back what the statistics had before."""
    run, path = flown
    found = {ensemble.name: ensemble for ensemble in ensembles_of(read(path))}
    assert len(found) == len(run.setting.ensembles)
    for truth in run.setting.ensembles:
        ours = found[truth.name]
        deviation = np.sqrt(truth.covariance[:, [0, 1, 2], [0, 1, 2]])
        size = np.array([AU, 1.0, AU])
        np.testing.assert_allclose(ours.nominal / size, truth.nominal[:, :3] / size, atol=1e-9)
        np.testing.assert_allclose(ours.mean / size, truth.mean[:, :3] / size, atol=1e-9)
        np.testing.assert_allclose(ours.deviation / size, deviation / size, atol=1e-9)


def test_bands_are_one_two_and_three_deviations_about_the_mean_less_the_calm_flight(flown):
    run, path = flown
    drawn = composed(ensembles_page(run_of(read(path)), ensembles_of(read(path))))
    column = {"distance": (0, MILLI_AU), "azimuth": (1, np.pi / 180), "height": (2, MILLI_AU)}
    assert len(drawn.axes) == (3 if run.setting.ensembles[0].planar else 4)
    for axes, name in zip(drawn.axes[:-1], column, strict=False):
        k, size = column[name]
        for truth in run.setting.ensembles:
            mean = (truth.mean - truth.nominal)[:, k] / size
            spread = np.sqrt(truth.covariance[:, k, k]) / size
            slack = 1e-6 * max(np.abs(mean).max(), spread.max()) + 1e-7
            x, y = line(axes, f"{name}, {truth.name}, mean").get_data()
            np.testing.assert_allclose(x, truth.time / DAY, atol=1e-9)
            np.testing.assert_allclose(y, mean, atol=slack)
            for count in (1, 2, 3):
                low, high = edges(axes, f"{name}, {truth.name}, {count} sigma")
                np.testing.assert_allclose(low, mean - count * spread, atol=slack)
                np.testing.assert_allclose(high, mean + count * spread, atol=slack)


def test_the_histogram_has_the_shares_of_the_last_row(flown):
    run, path = flown
    axes = composed(ensembles_page(run_of(read(path)), ensembles_of(read(path)))).axes[-1]
    for truth in run.setting.ensembles:
        [steps] = [one for one in axes.patches if one.get_gid() == f"end, {truth.name}"]
        values, places, _ = steps.get_data()
        np.testing.assert_allclose(values, 100 * truth.histogram[-1], atol=1e-9)
        np.testing.assert_allclose(places, truth.histogram_edges / MILLI_AU, rtol=1e-9)
        assert values.sum() == pytest.approx(100)


def test_a_quantity_that_ensembles_have_stands_in_their_midst(flown, tmp_path):
    run, path = flown
    recording, rows = read(path), run_of(read(path))
    curves = [curve_of(rows, name) for name in ("radius", "thrust_voltage_V")]
    radius, voltage = composed(curves_page(recording, rows, curves)).axes
    truth = run.setting.ensembles[0]
    named = {one.get_gid() for one in radius.lines}
    if truth.planar:
        low, high = edges(radius, f"radius, {truth.name}, 2 sigma")
        deviation = np.sqrt(truth.covariance[:, 0, 0]) / AU
        np.testing.assert_allclose(0.5 * (high + low), truth.mean[:, 0] / AU, rtol=1e-9)
        np.testing.assert_allclose(0.25 * (high - low), deviation, atol=1e-9)
        np.testing.assert_allclose(line(radius, "radius, calm flight").get_ydata(), truth.nominal[:, 0] / AU, rtol=1e-9)
    else:
        assert named == {"radius"}, "the distance from an axis is not that from the Sun"
    for one in run.setting.ensembles:
        middle = line(voltage, f"thrust_voltage_V, {one.name}, median").get_ydata()
        np.testing.assert_allclose(middle, one.percentiles["thrust_voltage_V"][2], rtol=1e-9)
    assert draw_recording(path, tmp_path / "a.svg").read_text().startswith("<?xml")


@pytest.fixture(scope="module")
def swinging(tmp_path_factory):
    """A hundred turns of an ellipse round the Earth, a hundred rows each, whose axis shrinks by 1 %."""
    anomaly = np.linspace(0, 200 * np.pi, 10_001)
    a, e = 9e6 * (1 - 0.01 * anomaly / anomaly[-1]), 0.2
    r = a * (1 - e * np.cos(anomaly))
    position = np.stack([a * (np.cos(anomaly) - e), a * np.sqrt(1 - e * e) * np.sin(anomaly), 0 * a], 1)
    rate = np.sqrt(MU_EARTH / a**3) * a / r
    time = np.concatenate([[0], np.cumsum(np.diff(anomaly) * 0.5 * (1 / rate[1:] + 1 / rate[:-1]))])
    velocity = rate[:, None] * np.stack([-a * np.sin(anomaly), a * np.sqrt(1 - e * e) * np.cos(anomaly), 0 * a], 1)
    path = tmp_path_factory.mktemp("swings") / "run.rrd"
    record_trajectory(time, position, velocity, path, mu=MU_EARTH)
    return path, time, r


def test_what_swings_within_a_revolution_is_a_band_from_its_least_to_its_largest_value(swinging):
    path, time, r = swinging
    run = run_of(read(path))
    assert revolutions(run) == pytest.approx(100, rel=0.003)
    bands = bands_of(run, r / 1e3)
    assert 90 < len(bands.time) <= 100
    share = np.clip((time - time[0]) / (time[-1] - time[0]) * len(bands.time), 0, len(bands.time) - 1).astype(int)
    for k in (0, 7, len(bands.time) - 1):
        inside = r[share == k] / 1e3
        assert bands.low[k] == inside.min()
        assert bands.high[k] == inside.max()
        assert bands.mean[k] == pytest.approx(inside.mean(), rel=1e-12)
    [axes] = composed(curves_page(read(path), run, [curve_of(run, "radius_km")])).axes
    low, high = edges(axes, "radius_km, least to largest")
    np.testing.assert_allclose(low, bands.low, rtol=1e-12)
    np.testing.assert_allclose(high, bands.high, rtol=1e-12)
    np.testing.assert_allclose(line(axes, "radius_km, mean").get_ydata(), bands.mean, rtol=1e-12)
    assert not any(one.get_gid() == "radius_km" for one in axes.lines)


def test_an_angle_that_begins_anew_has_a_band_but_no_mean_and_what_creeps_is_a_line(swinging):
    run = run_of(read(swinging[0]))
    angle = curve_of(run, "true_anomaly")
    assert np.isnan(bands_of(run, angle.values, angle.turn).mean).all()
    assert bands_of(run, curve_of(run, "semi_major_axis_km").values) is None
