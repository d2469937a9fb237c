"""The scene loader: files, shipped names, and what is imported for them."""

from __future__ import annotations

import subprocess
import sys

import pytest

from sailviz.errors import SceneError
from sailviz.scene.loading import load_scene
from sailviz.shipped import shipped_scenes


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (b"title = ", "not valid TOML"),
        (b"\xff\xfet\x00", "not UTF-8"),
        (b"a = " + b"[" * 5000 + b"]" * 5000, "nested too deeply"),
        (b"a." * 5000 + b"a = 1", "nested too deeply"),
        (b"title = " + b"9" * 5000, "not valid TOML"),
        (b"", "title: is missing"),
        (b'"a]b" = 1\n"a." = 2\n"" = 3', "unknown key"),
    ],
)  # fmt: skip
def test_a_file_that_is_no_scene_is_refused_in_a_sentence(tmp_path, content, words):
    file = tmp_path / "scene.toml"
    file.write_bytes(content)
    with pytest.raises(SceneError, match=words):
        load_scene(file)


@pytest.mark.parametrize("source", ["displaced/circle", "no/such", "", "x" * 5000, "\0", "."])
def test_a_name_that_is_no_scene_is_refused_in_a_sentence(source):
    with pytest.raises(SceneError, match="file"):
        load_scene(source)


def test_a_byte_order_mark_is_no_part_of_the_scene(tmp_path):
    file = tmp_path / "scene.toml"
    file.write_bytes(b"\xef\xbb\xbf" + shipped_scenes()["displaced/circular"].read_bytes())
    assert load_scene(file).identity() == load_scene("displaced/circular").identity()


def test_a_scene_remembers_its_text_and_its_name():
    scene = load_scene("displaced/circular.toml")
    assert scene.source == "displaced/circular"
    assert scene.text == shipped_scenes()["displaced/circular"].read_text()
    assert scene.with_values({"title": "other"}).text == scene.text


@pytest.mark.parametrize(
    ("code", "heavy"),
    [
        ("import sailviz", ("numpy", "pydantic", "numba", "rerun", "scipy")),
        ("import sailviz; sailviz.load_scene('displaced/circular')", ("numba", "rerun", "scipy")),
    ],
)
def test_what_is_not_needed_is_not_imported(code, heavy):
    report = f"{code}\nimport sys; print([name for name in {heavy} if name in sys.modules])"
    assert subprocess.check_output([sys.executable, "-c", report], text=True).strip() == "[]"


def test_verbs_are_found_on_first_use():
    import sailviz

    assert set(sailviz.__all__) <= set(dir(sailviz))
    for verb in ("load_scene", "simulate", "simulate_blocks"):
        assert callable(getattr(sailviz, verb))
    with pytest.raises(AttributeError, match="no attribute"):
        _ = sailviz.simulat
