"""Real space weather in a scene: what a low orbit meets on its dates, and scenes that ask for days that are lacking."""

import shutil
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import sailviz
from sailviz.constants import MU_EARTH, RADIUS_EARTH, ROTATION_EARTH
from sailviz.environment import atmosphere, space_weather
from sailviz.environment.sun import local_time, sun_parameters
from sailviz.errors import SceneError

FOREIGN = Path(__file__).parents[1] / "data" / "foreign"
SCENE = """
title = "Weather"
body = "earth"
epoch = 2031-03-05T06:00:00
[start]
kind = "circular"
altitude_km = 400
inclination_deg = 51.6
[device]
kind = "none"
mass_kg = 40
drag_area_m2 = 2.0
[environment]
space_weather = {file = "sw_made_up.csv"}
atmosphere = {kind = "nrlmsis-2.1"}
corotation = true
[propagation]
duration_d = 2
outputs = 100
"""


@pytest.fixture
def folder(tmp_path):
    for name in ("sw_made_up.csv", "sw_made_up.txt", "gfz_made_up.txt"):
        shutil.copy(FOREIGN / name, tmp_path)
    (tmp_path / "scene.toml").write_text(SCENE)
    return tmp_path


def _load(folder, text=SCENE, **settings):
    (folder / "scene.toml").write_text(text)
    return sailviz.load_scene(folder / "scene.toml", settings or None)


def _faults(folder, text):
    with pytest.raises(SceneError) as caught:
        sailviz.simulate(_load(folder, text))
    return [(fault.where, fault.what) for fault in caught.value.faults]


@pytest.mark.parametrize("storms", [False, True])
def test_a_flight_through_a_storm_is_that_of_an_independent_integration(folder, storms):
    text = SCENE.replace("2031-03-05T06", "2031-03-11T06").replace('.csv"}', f'.csv", storms = {str(storms).lower()}}}')
    scene = _load(folder, text)
    run = sailviz.simulate(scene)
    start = np.datetime64("2031-03-11T06:00:00", "s")
    row = atmosphere.table_of_weather(start, 2 * 86_400.0, space_weather.read(FOREIGN / "sw_made_up.csv").given, storms)
    sun = sun_parameters(np.datetime64(start, "ns"), 0.0)

    def slope(t, s):
        r = np.linalg.norm(s[:3])
        place = np.arcsin(s[2] / r), local_time.py_func(t, s[0], s[1], sun), r - RADIUS_EARTH
        rho = atmosphere.density(*place, 0.0, row, t)
        q = s[3:] - np.cross([0, 0, ROTATION_EARTH], s[:3])
        drag = -0.5 * rho * 2.2 * 2.0 / 40.0 * np.linalg.norm(q) * q
        return np.concatenate([s[3:], -MU_EARTH * s[:3] / r**3 + drag])

    first = np.concatenate([run.position[0], run.velocity[0]])
    at = np.searchsorted(run.time, 43_200.0) - 1
    found = solve_ivp(slope, (0.0, run.time[at]), first, "DOP853", rtol=1e-10, atol=1e-3, max_step=30.0)
    assert found.success
    assert np.linalg.norm(found.y[:3, -1] - run.position[at]) < 1.0  # m, of 12 km that the air costs
    assert run.environment["air_density_kg_m3"][at] > 0.0


def test_what_is_recorded_is_what_the_air_was_given(folder):
    run = sailviz.simulate(_load(folder))
    weather = space_weather.read(FOREIGN / "sw_made_up.csv")
    dates = np.datetime64("2031-03-05T06:00:00", "ns") + (run.time * 1e9).astype("timedelta64[ns]")
    flux, mean_flux, ap = weather.given(dates)
    np.testing.assert_array_equal(run.environment["solar_flux_sfu"], flux)
    np.testing.assert_array_equal(run.environment["solar_flux_mean_sfu"], mean_flux)
    np.testing.assert_array_equal(run.environment["geomagnetic_ap"], ap[:, 0])
    assert ("space weather", "sw_made_up.csv") in run.setting.parameters
    assert ("days of it", "3 observed") in run.setting.parameters


def test_the_three_formats_fly_the_same(folder):
    runs = [
        sailviz.simulate(_load(folder, SCENE.replace("sw_made_up.csv", name)))
        for name in ("sw_made_up.csv", "sw_made_up.txt")
    ]
    np.testing.assert_array_equal(runs[0].position, runs[1].position)


def test_a_tolerance_a_hundred_times_finer_moves_the_end_by_centimetres(folder):
    text = SCENE.replace("2031-03-05T06", "2031-03-11T06").replace('.csv"}', '.csv", storms = true}')
    runs = [sailviz.simulate(_load(folder, text + f"tolerance = {tolerance}\n")) for tolerance in (1e-10, 1e-12)]
    assert np.linalg.norm(runs[0].position[-1] - runs[1].position[-1]) < 1.0


def test_the_tether_meets_the_plasma_of_the_mean_flux(folder):
    text = SCENE.replace('[device]\nkind = "none"\nmass_kg = 40\ndrag_area_m2 = 2.0', BRAKE)
    text = text.replace('atmosphere = {kind = "nrlmsis-2.1"}', 'ionosphere = {kind = "iri-2020"}')
    text = text.replace("altitude_km = 400", "altitude_km = 700")
    run = sailviz.simulate(_load(folder, text))
    fixed = text.replace('space_weather = {file = "sw_made_up.csv"}', "solar_flux_sfu = 119.7")
    other = sailviz.simulate(_load(folder, fixed))
    mean = run.environment["solar_flux_mean_sfu"]
    assert abs(mean.mean() - 119.7) < 0.5
    ratio = run.environment["plasma_density_per_m3"][:20] / other.environment["plasma_density_per_m3"][:20]
    np.testing.assert_allclose(ratio, 1.0, atol=0.01)


BRAKE = """[steering]
kind = "vertical"
[device]
kind = "plasma-brake"
mass_kg = 10
tether_length_m = 500
voltage_V = -1000
"""


@pytest.mark.parametrize(
    ("change", "place", "words"),
    [
        (("sw_made_up.csv", "sw_made_up.cvs"), "environment.space_weather.file", "there is no file"),
        (
            ("2031-03-05T06", "2031-01-03T06"),
            "environment.space_weather.file",
            "begins on 2031-01-01, and this run needs it from 2030-12-30 on",
        ),
        (
            ("2031-03-05T06", "2031-05-09T06"),
            "environment.space_weather.continuation",
            "ends on 2031-05-10, and this run needs it until 2031-05-11",
        ),
        (("corotation = true", "solar_flux_sfu = 100"), "environment.solar_flux_sfu", "says how active the Sun is"),
        (('nrlmsis-2.1"}', 'nrlmsis-2.1", ap = 4}'), "environment.atmosphere.ap", "the file of space weather says it"),
        (
            ('{kind = "nrlmsis-2.1"}', '{kind = "exponential", density_kg_m3 = 1e-12, scale_height_km = 60}'),
            "environment.space_weather",
            "nothing in this scene depends on it",
        ),
        (("epoch = 2031-03-05T06:00:00\n", ""), "epoch", "is read by date"),
        (('.csv"}', '.csv", continuation = "constant"}'), "environment.space_weather", "go together"),
        (('.csv"}', '.csv", continued_solar_flux_sfu = 100}'), "environment.space_weather", "go together"),
        (('.csv"}', '.csv", continuation = "cycel"}'), "environment.space_weather.continuation", "cycle"),
        (
            ("duration_d = 2", "duration_d = 9000"),
            "environment.space_weather",
            "more than the 4,000 that limits.air_tables allows",
        ),
    ],
)
def test_days_that_are_not_there_are_told(folder, change, place, words):
    assert change[0] in SCENE
    found = _faults(folder, SCENE.replace(*change))
    assert any(place == where and words in what for where, what in found), found


@pytest.mark.parametrize(
    ("continuation", "words"),
    [
        ('continuation = "cycle"', "1 predicted, 4 continued by the smooth cycle"),
        (
            'continuation = "constant", continued_solar_flux_sfu = 90, continued_ap = 4',
            "4 continued by a constant 90 sfu",
        ),
    ],
)
def test_a_run_goes_on_beyond_its_file_where_the_scene_says_how(folder, continuation, words):
    text = SCENE.replace("2031-03-05T06", "2031-05-10T06").replace("duration_d = 2", "duration_d = 4")
    run = sailviz.simulate(_load(folder, text.replace('.csv"}', f'.csv", {continuation}}}')))
    said = dict(run.setting.parameters)["days of it"]
    assert words in said
    if "constant" in continuation:
        assert run.environment["solar_flux_sfu"][-1] == 90.0
        assert run.environment["geomagnetic_ap"][-1] == 4.0


def test_a_cut_file_is_told_by_its_line(folder):
    path = folder / "sw_made_up.csv"
    path.write_text("\n".join(path.read_text().splitlines()[:90])[:-40])
    (place, words), *rest = _faults(folder, SCENE)
    assert not rest
    assert place == "environment.space_weather.file"
    assert "sw_made_up.csv: line 90 has" in words
