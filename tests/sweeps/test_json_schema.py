"""The JSON Schema of sweep files agrees with the checker, in [set] as well."""

from __future__ import annotations

import tomllib

import jsonschema
import pytest

from sailviz.shipped import shipped_sweeps
from sailviz.sweeps.json_schema import schema
from sailviz.sweeps.sweep_file import read_sweep_file

SWEEP = """
[sweep]
scene = "spirals/optical-sail"
draws = 3
[set]
{set}
[[vary]]
key = "steering.pitch_deg"
{vary}
"""
VARY = "values = [20, 30]"
VALIDATOR = jsonschema.Draft202012Validator(schema())


@pytest.mark.parametrize("name", sorted(shipped_sweeps()))
def test_it_accepts_shipped_sweeps(name):
    VALIDATOR.check_schema(schema())
    raw = tomllib.loads(shipped_sweeps()[name].read_text(encoding="utf-8"))
    assert [error.message for error in VALIDATOR.iter_errors(raw)] == []
    assert not VALIDATOR.is_valid(raw | {"varied": raw["vary"]})


@pytest.mark.parametrize(
    ("put", "vary", "good"),
    [
        ("device.film = 'ideal'\npropagation.duration_yr = 2", VARY, True),
        ("device = {kind = 'thruster', thrust_mN = 4}", VARY, True),
        ("event.0.radius_au = 0.7", VARY, True),
        ("'limits.flights' = 20", VARY, True),
        ("environment.solar_flux = 'cycle'", VARY, True),
        ("device.filme = 'ideal'", VARY, False),
        ("device.film = 'idle'", VARY, False),
        ("propagation.duration = 2", VARY, False),
        ("event.first.radius_au = 0.7", VARY, False),
        ("", "range = [20, 60, 5]\nspacing = 'log'", True),
        ("", "range = [20, 60]", False),
        ("", "distribution = 'normal(30, 1)'", True),
        ("", "distribution = 3", False),
    ],
)
def test_it_knows_what_may_be_set_and_varied(put, vary, good):
    assert VALIDATOR.is_valid(tomllib.loads(SWEEP.format(set=put, vary=vary))) == good


def test_what_it_accepts_of_set_the_sweep_file_takes(tmp_path):
    file = tmp_path / "sweep.toml"
    file.write_text(SWEEP.format(set="device.film = 'ideal'", vary=VARY))
    assert read_sweep_file(file, "sweep").faults == []
    assert VALIDATOR.is_valid(tomllib.loads(file.read_text()))
