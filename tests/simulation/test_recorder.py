"""`sailviz.record` takes a run, its blocks, or a scene in every form that `load_scene` takes."""

import tomllib

import numpy as np
import pytest

import sailviz
from sailviz.errors import RecordingError, SceneError
from sailviz.recording import Memory
from sailviz.shipped import shipped_folder

NAME = "displaced/heliostationary"


@pytest.fixture(scope="module")
def run():
    return sailviz.simulate(sailviz.load_scene(NAME))


def source_of(form, run):
    path = shipped_folder("scenes") / f"{NAME}.toml"
    return {
        "run": lambda: run,
        "blocks": lambda: sailviz.simulate_blocks(sailviz.load_scene(NAME), block_rows=100),
        "list": lambda: [run],
        "scene": lambda: sailviz.load_scene(NAME),
        "name": lambda: NAME,
        "path": lambda: path,
        "text of a path": lambda: str(path),
        "dictionary": lambda: tomllib.loads(path.read_text(encoding="utf-8")),
    }[form]()


@pytest.mark.parametrize("form", ["run", "blocks", "list", "scene", "name", "path", "text of a path", "dictionary"])
def test_every_form_of_a_scene_is_flown_into_the_recording(form, run):
    memory = Memory()
    recorded = sailviz.record(source_of(form, run), memory)
    assert recorded.complete
    assert np.array_equal(sailviz.read(memory)["/state"]["position_m"], run.position)


def test_a_faulty_scene_leaves_no_file(tmp_path):
    with pytest.raises(SceneError):
        sailviz.record({"title": "nothing"}, tmp_path / "run.rrd")
    assert list(tmp_path.iterdir()) == []


def test_a_sink_that_cannot_be_written_is_refused_before_anything_is_flown(tmp_path):
    with pytest.raises(RecordingError, match="no directory"):
        sailviz.record(NAME, tmp_path / "nowhere" / "run.rrd")
