"""Whatever is done to a scene, it is a scene or a list of faults: never another exception."""

from __future__ import annotations

import copy
import tomllib
from contextlib import chdir
from datetime import UTC, time

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from sailviz.errors import SceneError
from sailviz.scene.loading import load_scene, schema
from sailviz.shipped import shipped_folder, shipped_scenes
from sailviz.simulation.plan import plan

RAW = {name: tomllib.loads(path.read_text(encoding="utf-8")) for name, path in shipped_scenes().items()}


def words_of(value):
    if isinstance(value, dict):
        return set(value) | set().union(*map(words_of, value.values()))
    if isinstance(value, list):
        return set().union(*map(words_of, value))
    return {value} if isinstance(value, str) else set()


@pytest.fixture(autouse=True, scope="module")
def beside_the_files_that_scenes_name():
    with chdir(shipped_folder("scenes") / "deorbit"):
        yield


def without_sentences(value):
    """A schema whose texts are what a file may say."""
    if isinstance(value, list):
        return [without_sentences(part) for part in value]
    if not isinstance(value, dict):
        return value
    kept = {key: part for key, part in value.items() if not (key in ("title", "description") and isinstance(part, str))}
    return {key: without_sentences(part) for key, part in kept.items()}


WORDS = sorted(
    set().union(*map(words_of, RAW.values())) | words_of(without_sentences(schema())) | {"", ".", "a]b", "\n", "é", "0"}
)
SCALARS = st.one_of(
    st.sampled_from(WORDS),
    st.text(max_size=5),
    st.booleans(),
    st.integers(),
    st.sampled_from([10**400, -(10**400), 2**63, 0]),
    st.floats(),
    st.dates(),
    st.datetimes(timezones=st.sampled_from([None, UTC])),
    st.just(time(3, 4)),
)
VALUES = st.recursive(
    SCALARS,
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(st.sampled_from(WORDS), inner, max_size=4),
    max_leaves=12,
)


def places(value, path=()):
    """Paths of everything inside a nested value."""
    inner = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    return [place for key, part in inner for place in [(*path, key), *places(part, (*path, key))]]


@st.composite
def mutated(draw):
    """A shipped scene with up to three keys replaced, removed, added or renamed."""
    raw = copy.deepcopy(RAW[draw(st.sampled_from(sorted(RAW)))])
    for _ in range(draw(st.integers(1, 3))):
        path = draw(st.sampled_from(places(raw)))
        table = raw
        for key in path[:-1]:
            table = table[key]
        change = draw(st.sampled_from(["replace", "remove", "add", "rename"]))
        if change == "replace" or not isinstance(table, dict):
            table[path[-1]] = draw(VALUES)
        elif change == "remove":
            del table[path[-1]]
        else:
            word = draw(st.sampled_from(WORDS))
            table[word] = draw(VALUES) if change == "add" else table.pop(path[-1])
        if not places(raw):
            break
    return raw


def accepted(load):
    """What load returns, or None if it refused with a list of faults. Any other exception is a bug."""
    faulty = None
    try:
        result = load()
    except SceneError as error:
        faulty, result = error, None
    assert faulty is None or (faulty.faults and str(faulty))
    return result


FAST = settings(max_examples=150, deadline=None, suppress_health_check=list(HealthCheck))


@FAST
@given(mutated())
def test_a_mutated_scene_is_a_scene_or_a_list_of_faults_and_so_is_its_plan(raw):
    scene = accepted(lambda: load_scene(raw))
    if scene is not None:
        assert len(scene.identity()) == 16
        accepted(lambda: plan(scene))


@FAST
@given(st.dictionaries(st.sampled_from(WORDS), VALUES, max_size=6))
def test_any_table_is_a_scene_or_a_list_of_faults(raw):
    accepted(lambda: load_scene(raw))


@FAST
@given(st.lists(st.sampled_from(WORDS) | st.text(max_size=3), min_size=1, max_size=4).map(".".join), VALUES)
def test_any_override_is_a_scene_or_a_list_of_faults(key, value):
    accepted(lambda: load_scene("displaced/circular").with_values({key: value}))


@FAST
@given(st.sampled_from(sorted(RAW)), st.data())
def test_a_file_with_damaged_characters_is_a_scene_or_a_list_of_faults(tmp_path_factory, name, data):
    text = shipped_scenes()[name].read_text(encoding="utf-8")
    start = data.draw(st.integers(0, len(text)))
    end = data.draw(st.integers(start, min(len(text), start + 20)))
    file = tmp_path_factory.getbasetemp() / "damaged.toml"
    file.write_text(
        text[:start] + data.draw(st.text("[]{}\"'=.#\n\0 -_aé10", max_size=8)) + text[end:], encoding="utf-8"
    )
    accepted(lambda: load_scene(file))
