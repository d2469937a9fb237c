"""`sailviz schema`: what editors read is printed, or stands whole beside the scenes."""

import json

import pytest
from click.testing import CliRunner

from sailviz.cli import main
from sailviz.scene import schema as scene_schema
from sailviz.sweeps import schema as sweep_schema


@pytest.fixture
def shell(tmp_path, monkeypatch):
    """Call sailviz in an empty folder."""
    monkeypatch.chdir(tmp_path)
    return lambda *words: CliRunner().invoke(main, [str(word) for word in words])


def test_scene_and_sweep_schema_are_printed(shell):
    for words, expected in (("schema",), scene_schema()), (("schema", "--sweep"), sweep_schema()):
        found = json.loads(shell(*words).output)
        assert found == json.loads(json.dumps(expected))
        assert found["$schema"] == "https://json-schema.org/draft/2020-12/schema"
    assert scene_schema()["$id"].startswith("urn:sailviz:")
    assert scene_schema()["$id"].endswith(":scene")
    assert sweep_schema()["$id"] == scene_schema()["$id"].replace(":scene", ":sweep")


def test_a_folder_gets_both_and_is_told_the_first_line(shell, tmp_path):
    done = shell("schema", "-o", ".")
    assert done.exit_code == 0
    assert [line.split("; ")[-1] for line in done.output.splitlines()] == [
        "first line of a scene file beside it: #:schema ./sailviz.schema.json",
        "first line of a sweep file beside it: #:schema ./sailviz-sweep.schema.json",
    ]
    assert json.loads((tmp_path / "sailviz.schema.json").read_text(encoding="utf-8")) == scene_schema()
    assert json.loads((tmp_path / "sailviz-sweep.schema.json").read_text(encoding="utf-8")) == sweep_schema()


def test_a_file_gets_the_one_that_was_asked_for(shell, tmp_path):
    assert shell("schema", "--sweep", "-o", "my.json").exit_code == 0
    assert json.loads((tmp_path / "my.json").read_text(encoding="utf-8"))["$id"].endswith(":sweep")
    assert [file.name for file in tmp_path.iterdir()] == ["my.json"]


def test_what_cannot_be_written_is_told_in_a_sentence(shell):
    for words in (("-o", "nowhere/my.json"), ("-o", ""), ("--sweep", "-o", ".")):
        done = shell("schema", *words)
        assert (done.exit_code, "Traceback" in done.output) == (2, False)
