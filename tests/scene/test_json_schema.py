"""The JSON Schema of scene files agrees with the checker."""

from __future__ import annotations

import copy
import tomllib
from contextlib import chdir
from datetime import date, datetime

import jsonschema
import pytest

from sailviz.scene.loading import load_scene, schema
from sailviz.shipped import shipped_folder, shipped_scenes
from sailviz.units import UNITS

from .small import SMALL, with_parts

VALIDATOR = jsonschema.Draft202012Validator(schema())
RAW = {name: tomllib.loads(path.read_text(encoding="utf-8")) for name, path in shipped_scenes().items()}


def plain(value):
    """As an editor's JSON Schema validator sees TOML: dates are strings there."""
    if isinstance(value, dict):
        return {key: plain(part) for key, part in value.items()}
    if isinstance(value, list):
        return [plain(part) for part in value]
    return value.isoformat() if isinstance(value, (date, datetime)) else value


@pytest.fixture(autouse=True, scope="module")
def beside_the_files_that_scenes_name():
    with chdir(shipped_folder("scenes") / "deorbit"):
        yield


@pytest.mark.parametrize("name", sorted(RAW))
def test_json_schema_accepts_shipped_scenes_and_rejects_a_misspelt_key(name):
    good = plain(RAW[name])
    assert [error.message for error in VALIDATOR.iter_errors(good)] == []
    for where in ("start", "device", "propagation"):
        bad = copy.deepcopy(good)
        table = bad[where][0] if isinstance(bad[where], list) else bad[where]
        key = next((key for key in table if key != "kind"), "kind")
        table[key + "x"] = table.pop(key)
        assert not VALIDATOR.is_valid(bad)


def test_schema_knows_devices_in_phases_each_by_its_name():
    phases = [
        {"name": "a", "until": "time_d = 3", "device": [{"name": "engine", "on": False}]},
        {"name": "b", "device": {"throttle": 0.5}},
    ]
    assert VALIDATOR.is_valid(SMALL | {"phase": phases})
    phases[0]["device"][0]["oon"] = True
    assert not VALIDATOR.is_valid(SMALL | {"phase": phases})


def test_schema_wants_a_unit_and_only_one():
    VALIDATOR.check_schema(schema())
    assert VALIDATOR.is_valid(SMALL)
    assert not VALIDATOR.is_valid(with_parts(propagation={"duration": 10}))
    assert not VALIDATOR.is_valid(with_parts(propagation={"duration_d": 10, "duration_s": 10}))
    assert not VALIDATOR.is_valid(with_parts(propagation={}))


def test_schema_knows_every_unit_of_every_quantity():
    properties = schema()["$defs"]["Propagation"]["properties"]
    assert {f"duration_{unit}" for unit in UNITS["time"]} <= set(properties)
    assert "duration" not in properties


def test_every_quantity_that_is_required_is_asked_for_beside_the_others():
    window = {"start_d": 1, "end_d": 2, "output_interval_h": 1}
    asked = with_parts(propagation={"duration_d": 10, "dense": [window]})
    assert VALIDATOR.is_valid(asked)
    for key in window:
        short = [{name: value for name, value in window.items() if name != key}]
        assert not VALIDATOR.is_valid(with_parts(propagation={"duration_d": 10, "dense": short}))
        assert not VALIDATOR.is_valid(
            with_parts(propagation={"duration_d": 10, "dense": [window | {key[:-1] + "s": 1}]})
        )


def test_no_table_of_the_schema_hides_its_keys_from_taplo():
    assert [name for name, table in schema()["$defs"].items() if "allOf" in table or "allOf" in schema()] == []


def test_a_quantity_with_words_takes_each_of_them_without_a_unit_and_numbers_with_one():
    wind = {"kind": "gamma", "shape": 3, "scale_nPa": 0.7, "seed": 1}
    for more, good in (
        ({"reference": "mean"}, True),
        ({"reference": "unbiased"}, True),
        ({"reference_nPa": 2}, True),
        ({"reference": 2}, False),
        ({"reference_nPa": "mean"}, False),
        ({"reference": "middle"}, False),
    ):
        assert VALIDATOR.is_valid(with_parts(environment={"solar_wind": wind | more})) == good, more


MANY = ("length", "time", "angle", "speed", "acceleration", "mass", "area", "voltage", "pressure", "force")
OTHERS = (
    "wire",
    "force_per_length",
    "ion_mass",
    "inertia",
    "rates",
    "frequency",
    "torque",
    "storage",
    "control_torque",
    "air_torque",
)  # whose units end as those of other dimensions


def in_other_units(table):
    """The same tables, every quantity in the last of its units that is not the one it has."""
    if isinstance(table, list):
        return [in_other_units(part) for part in table]
    if not isinstance(table, dict):
        return table
    made = {}
    for key, value in table.items():
        fits = [(len(unit), name, unit) for name in MANY for unit in UNITS[name] if key.endswith(f"_{unit}")]
        if not fits or isinstance(value, (str, bool)) or key.startswith(OTHERS):
            made[key] = in_other_units(value)
            continue
        _, dimension, unit = max(fits)
        other = [name for name in UNITS[dimension] if name != unit][-1]
        made[key.removesuffix(unit) + other] = scaled(value, UNITS[dimension][unit] / UNITS[dimension][other])
    return made


def scaled(value, factor):
    return [scaled(part, factor) for part in value] if isinstance(value, list) else value * factor


@pytest.mark.parametrize("name", sorted(RAW))
def test_a_scene_in_other_units_is_the_same_to_schema_and_checker(name, monkeypatch):
    monkeypatch.chdir(shipped_scenes()[name].parent)  # where the files are that it names
    moved = in_other_units(RAW[name])
    assert plain(moved) != plain(RAW[name])
    assert VALIDATOR.is_valid(plain(moved))
    assert load_scene(moved).propagation.duration == pytest.approx(load_scene(RAW[name]).propagation.duration)
