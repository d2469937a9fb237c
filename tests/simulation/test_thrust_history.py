"""Winds and controllers of a scene: what blows is the law's, what the voltage does about it is what the law says."""

from __future__ import annotations

import numpy as np
import pytest
from click.testing import CliRunner

from sailviz import load_scene
from sailviz.cli import main
from sailviz.constants import AU, DAY, YEAR
from sailviz.environment.solar_wind.pressure import PHASES
from sailviz.errors import SceneError
from sailviz.simulation.loop import simulate
from sailviz.simulation.thrust_history import schedule

GAMMA = {"kind": "gamma", "shape": 2.593, "scale_nPa": 0.7793, "seed": 7}


def scene(wind=None, control=None, days=100, **more):
    device = {"kind": "electric-sail", "characteristic_acceleration_mm_s2": 1}
    if control:
        device["control"] = control
    return load_scene(
        {
            "title": "wind",
            "start": {"kind": "circular", "radius_au": 1},
            "device": device,
            "steering": {"kind": "orbital", "pitch_deg": 40, "clock_deg": 90},
            "environment": {"solar_wind": wind} if wind else {},
            "propagation": {"duration_d": days, "outputs": 201},
        }
        | more
    )


def pressures(of):
    return schedule(of, None).histories["solar_wind_pressure_Pa"]


def test_correlated_wind_forgets_in_its_correlation_time():
    wind = GAMMA | {"variation": "correlated", "correlation_time_h": 17, "redraw_h": 1}
    root = np.sqrt(pressures(scene(wind, days=40_000)))
    root = root - root.mean()
    for hours, expected in ((1, 0.943), (17, 0.368), (34, 0.135)):  # sqrt p is all but normal: that of z within 0.01
        found = np.mean(root[hours:] * root[:-hours]) / np.mean(root**2)
        assert found == pytest.approx(expected, abs=0.015)
    assert np.mean(root) == pytest.approx(0, abs=1e-12)


@pytest.mark.parametrize(
    ("wind", "mean", "root"),
    [
        (GAMMA, 2.0207, 1.355009),
        ({"kind": "lognormal", "sigma": 0.6144, "scale_nPa": np.exp(0.4984), "seed": 1}, 1.9876, 1.3454),
        ({"kind": "burr", "c": 3.29, "d": 0.764, "scale_nPa": 1.4245, "seed": 1}, 2.04, None),
    ],
)
def test_redrawn_wind_has_the_moments_of_its_law(wind, mean, root):
    p = pressures(scene(wind | {"redraw_h": 1}, days=20_000)) * 1e9
    assert p.mean() == pytest.approx(mean, rel=0.01)
    assert root is None or np.sqrt(p).mean() == pytest.approx(root, rel=0.005)


def test_unbiased_reference_leaves_the_mean_thrust_nominal_and_a_given_one_is_taken():
    biased, unbiased, given = (
        schedule(scene(GAMMA | {"redraw_h": 1} | extra, days=4_000), None).factors
        for extra in ({}, {"reference": "unbiased"}, {"reference_nPa": 4 * 2.593 * 0.7793})
    )
    assert biased.mean() == pytest.approx(0.953210, abs=0.003)  # three standard errors of 96,000 draws
    assert unbiased.mean() == pytest.approx(1, abs=0.003)
    assert np.allclose(given, biased / 2, rtol=1e-12, atol=0)


def test_yearly_factor_stays_for_a_year():
    plain, slow = (pressures(scene(GAMMA | {"yearly_deviation": d}, days=4 * 365.25)) for d in (0.0, 0.175))
    ratio = slow / plain
    year = (np.arange(len(ratio)) * DAY // YEAR).astype(int)
    values = [ratio[year == k] for k in range(4)]
    assert all(np.ptp(part) < 1e-12 for part in values)
    assert len({round(part[0], 9) for part in values}) == 4


@pytest.fixture(autouse=True)
def _beside_the_files(tmp_path, monkeypatch):
    """A scene of no file finds its winds in the working directory."""
    monkeypatch.chdir(tmp_path)


def series(path, hours=24 * 30, gap=(), wrong=False):
    """A measured wind: pressure rises by 0.01 nPa an hour from 1 nPa."""
    rows = ["time_h,pressure_nPa,speed_km_s"] if not wrong else ["time_h,pressure_Pa,speed_km_s"]
    for i in range(hours):
        value = "" if i in gap else f"{1 + 0.01 * i + 0.2 * (i % 7)}"
        rows.append(f"{i},{value},{400 + i % 5}")
    path.write_text("\n".join(rows) + "\n")
    return {"kind": "replay", "file": path.name, "seed": 3}


def test_replayed_wind_is_the_series_with_gaps_filled_between_their_neighbours(tmp_path):
    wind = series(tmp_path / "own.csv", gap=(200, 201))
    full = np.array([1 + 0.01 * i + 0.2 * (i % 7) for i in range(720)])
    filled = full.copy()
    filled[200:202] = np.exp(np.interp([200, 201], [199, 202], np.log(full[[199, 202]])))
    met = pressures(scene(wind, days=30)) * 1e9
    assert met == pytest.approx(filled, rel=1e-12)
    met = pressures(scene(wind, days=10)) * 1e9
    assert min(np.abs(filled[k : k + 240] - met).max() for k in range(481)) < 1e-12


@pytest.mark.parametrize(
    ("options", "days", "sentence"),
    [({"wrong": True}, 10, "nPa"), ({}, 31, "does not begin again"), (None, 10, "there is no file")],
)
def test_a_bad_series_is_refused_in_one_sentence(tmp_path, options, days, sentence):
    wind = {"kind": "replay", "file": "none.csv", "seed": 1}
    if options is not None:
        wind = series(tmp_path / "own.csv", **options)
    with pytest.raises(SceneError) as refused:
        simulate(scene(wind, days=days))
    assert len(refused.value.faults) == 1
    file = tmp_path / "scene.toml"
    file.write_text(
        'title = "x"\n[start]\nkind = "circular"\nradius_au = 1\n[device]\nkind = "electric-sail"\n'
        f'characteristic_acceleration_mm_s2 = 1\n[environment.solar_wind]\nkind = "replay"\nfile = "{wind["file"]}"\n'
        f"seed = 1\n[propagation]\nduration_d = {days}\n"
    )
    found = CliRunner().invoke(main, ["run", str(file), "-o", str(tmp_path / "x.rrd")])
    assert found.exit_code == 2
    assert sentence in found.output.replace("\n", " ")
    assert "Traceback" not in found.output


def test_unsaturated_pressure_law_flies_the_nominal_flight():
    free = {"kind": "pressure", "interval_h": 1, "maximum_voltage_kV": 1e6}
    tight = {"propagation": {"duration_d": 60, "outputs": 201, "tolerance": 1e-14}}
    flown = simulate(scene(GAMMA | {"redraw_h": 1}, free, **tight))
    calm = simulate(scene(**tight))
    assert np.abs(flown.position - calm.position).max() / AU < 1e-12
    assert flown.environment["thrust_voltage_V"].max() > 30e3  # it had something to do


def test_saturated_pressure_law_loses_what_the_closed_form_says():
    law = {"kind": "pressure", "interval_h": 1, "maximum_voltage_kV": 40}
    run = simulate(scene(GAMMA | {"redraw_h": 1}, law, days=2000, propagation={"duration_d": 2000, "outputs": 48_001}))
    voltage, factor = run.environment["thrust_voltage_V"], run.environment["thrust_factor"]
    assert np.mean(voltage == 40e3) == pytest.approx(0.04982, abs=0.003)
    assert factor.mean() == pytest.approx(0.991022, abs=0.001)
    assert voltage.mean() == pytest.approx(22_901.2, rel=0.005)


@pytest.mark.parametrize(("gain", "off"), [(0.9, 0.02415), (1.1, 0.00068)])
def test_a_still_sail_is_held_by_gains_above_one(gain, off):
    """dr'' = (mu / r0^3)(1 - kp) dr from 1e-3 au, after 4 pi of the canonical time."""
    law = {"kind": "distance", "interval_h": 24, "position_gain": gain, "speed_gain": 0}
    held = load_scene(
        {
            "title": "still",
            "start": {"kind": "heliostationary", "radius_au": 1, "position_offset_au": [1e-3, 0, 0]},
            "device": {"kind": "electric-sail", "characteristic_acceleration": "as designed", "control": law},
            "propagation": {"duration_yr": 2.0000378, "outputs": 101},
        }
    )
    assert abs(np.linalg.norm(simulate(held).position[-1]) / AU - 1) == pytest.approx(off, rel=0.05)


def test_electrochromic_film_holds_the_thrust_of_a_solar_sail():
    sunlit = {"environment": {"irradiance": {"kind": "cycle", "seed": 4}}}
    device = {"kind": "solar-sail", "characteristic_acceleration_mm_s2": 0.5}
    free = simulate(scene(days=700, device=device, **sunlit))
    held = simulate(scene(days=700, device=device | {"control": {"kind": "electrochromic"}}, **sunlit))
    assert np.ptp(free.environment["thrust_factor"]) > 5e-4
    assert np.abs(held.environment["thrust_factor"] - 1).max() < 1e-12
    state = held.environment["electrochromic_state"]
    assert 0 < state.min() < 0.9
    assert 0.95 < state.max() <= 1  # under the dimmest Sun all of it is mirror


def test_phases_of_the_cycle_are_the_winds_of_the_scene_that_flies_them():
    windy = load_scene("wind/windy-or-calm")
    assert (windy.ensemble[0].solar_wind.shape, windy.ensemble[0].solar_wind.scale) == pytest.approx(
        (PHASES["2003-2005"].shape, PHASES["2003-2005"].scale)
    )
    calm = windy.environment.solar_wind
    assert (calm.shape, calm.scale) == pytest.approx((PHASES["2008-2009"].shape, PHASES["2008-2009"].scale))


def test_both_integrators_hear_the_controller():
    """Asked for by name, the multistep method flies what DOP853 flies, on an ellipse that gravity rules."""
    ends = []
    for integrator in ("dop853", "gauss-jackson"):
        given = {
            "title": "both",
            "start": {"kind": "elements", "semi_major_axis_au": 1, "eccentricity": 0.05},
            "device": {
                "kind": "electric-sail",
                "characteristic_acceleration_mm_s2": 0.02,
                "control": {"kind": "pressure", "maximum_voltage_kV": 25, "interval_h": 480},
            },
            "steering": {"kind": "orbital", "pitch_deg": 35, "clock_deg": 90},
            "environment": {"solar_wind": {**GAMMA, "redraw_h": 480}},
            "propagation": {"duration_d": 200, "outputs": 50, "tolerance": 1e-13, "integrator": integrator},
        }
        ends.append(simulate(load_scene(given)))
    assert np.abs(ends[0].position - ends[1].position).max() < 1e-9 * AU
    volts = [end.environment["thrust_voltage_V"] for end in ends]
    assert np.ptp(volts[0]) > 1000
    assert np.array_equal(*volts)
