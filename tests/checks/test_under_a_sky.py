"""The fixture, `compare` and exported archives hold flights under a sky as they hold others."""

import pytest

import sailviz
from sailviz.checks.baselines import Regression
from sailviz.recording import export

SCENE = {
    "title": "In its sky",
    "body": "earth",
    "epoch": "2026-03-20T00:00:00",
    "start": {"kind": "cartesian", "position_km": [42_164.169, 0.0, 0.0], "velocity_km_s": [0.0, 2.6627, 1.5373]},
    "device": {"kind": "solar-sail", "characteristic_acceleration_mm_s2": 0.1},
    "steering": {"kind": "sun-frame", "pitch_deg": 35.0, "clock_deg": 90.0},
    "environment": {"gravity_of": ["moon", "sun"], "shadow_of": ["earth", "moon"]},
    "propagation": {"duration_d": 3.0, "outputs": 60},
    "phase": [{"name": "out", "until": "time_d = 1"}, {"name": "stowed", "device": {"on": False}}],
}


@pytest.mark.parametrize(
    ("changed", "columns"),
    [
        ({"environment.gravity_of": ["moon"]}, ["/state:position_m", "/state:velocity_m_s"]),
        ({"environment.shadow_of": ["moon"]}, ["/environment:sunlit_fraction"]),
        ({"phase.0.until": "time_d = 2"}, ["/thrust:on", "/phases:number"]),
        ({"frame": "icrf"}, ["/state:position_m"]),
        ({"light.kind": "circular"}, ["/thrust:acceleration_m_s2"]),
    ],
    ids=lambda value: next(iter(value)),
)
def test_a_change_of_the_sky_is_found_and_named(changed, columns, tmp_path):
    regression = Regression(tmp_path / "baselines", "sky", rows=60)
    regression.update(sailviz.load_scene(SCENE), None)
    again = regression.check(sailviz.load_scene(SCENE), None, lambda: tmp_path, False)
    assert again.passed
    found = regression.check(sailviz.load_scene(SCENE), changed, lambda: tmp_path, False)
    assert not found.passed
    for column in columns:
        assert any(column in line and "DIFFERENT" in line for line in found.report.splitlines()), column


def test_an_archive_equals_its_recording(tmp_path):
    sailviz.record(SCENE, tmp_path / "a.rrd")
    export(tmp_path / "a.rrd", tmp_path / "a.npz")
    assert sailviz.compare(tmp_path / "a.rrd", tmp_path / "a.npz").equal
    assert sailviz.compare(tmp_path / "a.rrd", sailviz.simulate(SCENE)).equal
