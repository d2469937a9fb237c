"""Every key that a person may write says what it means, and nothing is said of keys that there are not."""

from __future__ import annotations

import importlib
import inspect
import json
import re
import subprocess
import sys
from collections import Counter
from pathlib import Path
from typing import Literal, get_args, get_origin

import pytest

import sailviz
from sailviz.scene.descriptions import description_of, told_in
from sailviz.scene.json_schema import IN_WORDS, models_in
from sailviz.scene.loading import Scene
from sailviz.scene.loading import schema as scene_schema
from sailviz.scene.units_in_keys import dimension_and_models
from sailviz.sweeps.json_schema import schema as sweep_schema
from sailviz.sweeps.sweep_file import SweepFile
from sailviz.units import UNITS

MODELS = [*models_in(Scene), *models_in(SweepFile)]
SCHEMAS = {"scene": scene_schema, "sweep": sweep_schema}
PACKAGE = Path(sailviz.__file__).parent


def place(model, key):
    """File, table and key of a sentence."""
    owner = next(one for one in model.__mro__ if key in inspect.get_annotations(one))
    return f"{owner.__module__.replace('.', '/')}.toml [{owner.__name__}] {key}"


def tables(schema):
    """Every table of a schema with its name: the file's own and those inside it."""
    yield "", schema
    yield from schema["$defs"].items()


def test_every_key_has_a_sentence_of_its_own():
    missing = {place(model, key) for model in MODELS for key in model.model_fields if not description_of(model, key)}
    assert not missing, "keys without a description; write a sentence for each:\n" + "\n".join(sorted(missing))
    for model in MODELS:
        said = Counter(description_of(model, key) for key in model.model_fields)
        assert max(said.values()) == 1, f"{model.__name__} says twice: {said.most_common(1)[0][0]}"


@pytest.mark.parametrize("what", SCHEMAS)
def test_the_schema_describes_every_key_and_every_table(what):
    for name, table in tables(SCHEMAS[what]()):
        assert table["description"], name
        for key, value in table.get("properties", {}).items():
            assert value.get("description", "").endswith("."), f"{name} {key}"
            assert value["title"], f"{name} {key}"


def test_no_sentence_is_left_over():
    for file in PACKAGE.rglob("*.toml"):
        if "scenes" in file.relative_to(PACKAGE).parts:
            continue
        name = ".".join(("sailviz", *file.relative_to(PACKAGE).with_suffix("").parts))
        module = importlib.import_module(name)
        for model, sentences in told_in(name).items():
            found = getattr(module, model, None)
            assert getattr(found, "__module__", "") == name, f"{file.name}: there is no [{model}]"
            for key in sentences:
                assert key == "" or key in found.model_fields, f"{file.name}: [{model}] has no {key}"


def test_a_sentence_is_one_plain_line_that_names_no_unit_of_its_key():
    for model in MODELS:
        for key, info in model.model_fields.items():
            said = description_of(model, key)
            assert re.fullmatch(r"[A-Z0-9\"].*[.]", said), f"{place(model, key)}: {said!r}"
            assert "  " not in said
            dimension, _ = dimension_and_models(info.annotation, info.metadata)
            if dimension:  # the schema adds it for every spelling
                assert not re.search(r"\b[Ii]n (metres|seconds|degrees|radians|kilometres|days)\b", said), said


def test_the_words_and_defaults_that_a_sentence_names_are_those_of_the_checker():
    for model in MODELS:
        for key, info in model.model_fields.items():
            said, allowed = description_of(model, key), words_allowed(info.annotation)
            beside = re.findall(r'(\w+) = "([^"]+)"', said)
            for other, word in beside:
                found = next((one.model_fields[other] for one in (model, Scene) if other in one.model_fields), None)
                assert found is None or word in words_allowed(found.annotation) or not words_allowed(found.annotation)
            for word, rest in re.findall(r'"([^"]+)"((?: \([^)]*\))?)', re.sub(r'\w+ = "[^"]+"', "", said)):
                assert not allowed or word in allowed, f"{place(model, key)}: {word}"
                if rest.startswith(" (the default") and info.default is not None:
                    assert info.default == word, place(model, key)


def words_allowed(annotation):
    """What a field may be in words."""
    if get_origin(annotation) is Literal:
        return set(get_args(annotation))
    return set().union(*(words_allowed(part) for part in get_args(annotation))) if get_args(annotation) else set()


def test_a_quantity_says_its_unit_in_every_spelling():
    properties = scene_schema()["$defs"]["CircularStart"]["properties"]
    assert properties["radius_au"]["description"].endswith(" In au (149,597,870.7 km).")
    assert properties["inclination_deg"]["description"].endswith(" In degrees.")
    plain = {"m", "km", "mm", "s", "kg", "g", "V", "kV", "A", "mA", "Pa", "nPa", "W", "mW", "kW", "N", "mN", ""}
    assert {unit for units in UNITS.values() for unit in units} <= plain | set(IN_WORDS)


def test_each_kind_says_its_word_since_editors_show_all_kinds_together():
    kind = scene_schema()["$defs"]["CircularStart"]["properties"]["kind"]
    assert kind["description"] == '"circular": Start on a circular Keplerian orbit.'


def test_bounds_and_defaults_are_in_the_unit_of_the_key():
    properties = scene_schema()["$defs"]
    inclination = properties["ElementsStart"]["properties"]["inclination_deg"]
    assert (inclination["minimum"], inclination["maximum"], inclination["default"]) == (0, 180, 0)
    assert properties["PressureControl"]["properties"]["interval_h"]["default"] == 1
    assert properties["SpaceWeather"]["properties"]["continued_solar_flux_sfu"]["maximum"] == 300


def test_models_of_one_name_would_be_taken_for_each_other():
    for root in (Scene, SweepFile):
        names = Counter(model.__name__ for model in models_in(root))
        assert names.most_common(1)[0][1] == 1
    assert not {model.__name__ for model in models_in(Scene)} & {model.__name__ for model in models_in(SweepFile)}


def test_a_scene_is_checked_without_reading_a_sentence():
    program = (
        "import sys\n"
        "from sailviz.scene import load_scene\n"
        "load_scene('wind/mars')\n"
        "print([name for name in sys.modules if name.endswith(('descriptions', 'json_schema')) and 'sailviz' in name])"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert json.loads(done.stdout.replace("'", '"')) == []
