"""Ensembles of flights: without spread they are the single flight; what they cannot fly they say."""

import numpy as np
import pytest
from click.testing import CliRunner

import sailviz
from sailviz.cli.entry import main

WIND = {"kind": "gamma", "shape": 1e12, "scale_nPa": 2e-12, "reference_nPa": 2.0, "seed": 3}  # 2 nPa, to a millionth
MANY = {"name": "many", "flights": 4, "seed": 1, "keep": 4}


def scene(**more):
    return {
        "title": "Many",
        "epoch": "2026-03-20",
        "start": {"kind": "cartesian", "position_au": [1.0, 0.0, 0.0], "velocity_km_s": [0.0, 29.78, 0.5]},
        "device": {"kind": "electric-sail", "characteristic_acceleration_mm_s2": 0.3},
        "steering": {"kind": "radial"},
        "environment": {"solar_wind": WIND},
        "propagation": {"duration_d": 100.0, "outputs": 100},
        "ensemble": [MANY],
    } | more


@pytest.mark.parametrize(
    "more",
    [
        {},
        {"frame": "icrf"},
        {"start": {"kind": "from-planet", "planet": "mars", "c3_km2_s2": 4.0}, "frame": "icrf"},
        {
            "start": {"kind": "from-planet", "planet": "mars", "c3_km2_s2": 4.0},
            "frame": "icrf",
            "steering": {"kind": "meridian", "pitch_deg": 20.0, "clock_deg": 70.0},
        },
        {"light": {"kind": "ephemeris"}, "steering": {"kind": "orbital", "pitch_deg": 20.0, "clock_deg": 70.0}},
    ],
    ids=["ecliptic", "ICRF", "from a planet", "meridian of the ICRF", "light of the Sun"],
)
def test_flights_through_one_wind_are_the_single_flight(more):
    run = sailviz.simulate(scene(**more))
    (many,) = run.setting.ensembles
    alone = run.position[many.step]
    size = np.linalg.norm(alone, axis=1).max()
    for places in (many.places(many.nominal), *many.places(many.kept)):
        assert np.linalg.norm(places - alone, axis=1).max() < 2e-8 * size  # the wind differs by 1e-6 of itself


FACING = {"kind": "sun-frame", "pitch_deg": 0.0, "clock_deg": 90.0}
CYCLE = {"kind": "cycle", "seed": 2}
SAIL = {"kind": "solar-sail", "characteristic_acceleration_mm_s2": 0.3}
HIGH = {"kind": "cartesian", "position_km": [42_164.169, 0.0, 0.0], "velocity_km_s": [0.0, 3.0, 0.7]}


@pytest.mark.parametrize(
    ("more", "words"),
    [
        ({"environment": {"gravity_of": ["venus"], "solar_wind": WIND}}, "knows no gravity but the Sun's"),
        (
            {"environment": {"magnetosphere": {"radius_km": 1e5}, "solar_wind": WIND}},
            "knows no shadow, no magnetosphere",
        ),
        ({"device": SAIL, "environment": {"shadow_of": ["earth"], "irradiance": CYCLE}}, "knows no shadow"),
        ({"steering": FACING}, "no steering by the light's frame"),
        (
            {"light": {"kind": "fixed", "direction": [1.0, 0.0, 0.0], "distance_au": 1.0}, "steering": FACING},
            "no steering by the light's frame",
        ),
        (
            {"body": "earth", "start": HIGH, "device": SAIL, "steering": FACING, "environment": {"irradiance": CYCLE}},
            "flies a solar sail or an electric sail round the Sun",
        ),
        (
            {"body": {"name": "Altaira", "mu_km3_s2": 139348062043.343}},
            "flies a solar sail or an electric sail round the Sun",
        ),
        (
            {"phase": [{"name": "a", "until": "time_d = 30"}, {"name": "b", "device": {"on": False}}]},
            "ensembles and chaos fly scenes without",
        ),
        (
            {"device": [scene()["device"], SAIL | {"steering": {"kind": "radial"}}]},
            "an ensemble flies one device",
        ),
    ],
)
def test_what_an_ensemble_cannot_fly_is_said_before_anything_flies(more, words, tmp_path):
    path = tmp_path / "many.toml"
    path.write_text("\n".join(f"{key} = {_said(value)}" for key, value in scene(**more).items()))
    found = CliRunner().invoke(main, ["run", str(path), "-o", str(tmp_path / "a.rrd")])
    assert found.exit_code == 2
    assert words in found.output
    assert "Traceback" not in found.output
    assert not (tmp_path / "a.rrd").exists()


def _said(value):
    if isinstance(value, dict):
        return "{" + ", ".join(f"{key} = {_said(one)}" for key, one in value.items()) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(map(_said, value)) + "]"
    if isinstance(value, bool):
        return str(value).lower()
    return f'"{value}"' if isinstance(value, str) else repr(value)
