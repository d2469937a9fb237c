"""Damaged sweeps: told in one sentence, and no flight that is whole is lost or replaced."""

import json
import os
import random
import signal
import subprocess
import sys
from contextlib import suppress

import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from sailviz.errors import SailvizError
from sailviz.shipped import shipped_sweeps
from sailviz.sweeps.definition import define
from sailviz.sweeps.flight import fly
from sailviz.sweeps.store import FileStore, SweepError

COASTING = {
    "title": "A circle round the Sun",
    "start": {"kind": "circular", "radius_au": 1.0},
    "device": {"kind": "none", "mass_kg": 100.0},
    "propagation": {"duration_d": 20.0, "outputs": 5},
}


def defined(radii="0.5:1.5:30"):
    return define(COASTING, {"start.radius_au": radii}, None, None, ("radius_au@end",), None, {})[0]


@pytest.fixture(scope="module")
def definition():
    return defined()


@pytest.fixture(scope="module")
def flown(definition, tmp_path_factory):
    """The parts of a sweep, name -> bytes; the table that they make, as bytes; and as rows."""
    path = tmp_path_factory.mktemp("sweep") / "a.parquet"
    store = FileStore(definition, path)
    for first in (20, 0, 10):
        store.add(fly(definition, first, first + 10))
    parts = {part.name: part.read_bytes() for part in path.with_name("a.parquet.parts").iterdir()}
    store.close()
    return parts, path.read_bytes(), pq.read_table(path)


@pytest.fixture
def laid(flown, tmp_path):
    """A function that lays out a killed sweep with one of its files changed -> the path of its table."""

    def lay(name="", content=b""):
        path = tmp_path / "a.parquet"
        folder = tmp_path / "a.parquet.parts"
        folder.mkdir(exist_ok=True)
        for part, whole in flown[0].items():
            (folder / part).write_bytes(content if part == name else whole)
        return path

    return lay


def opened(definition, path):
    """(the store, "") or, where it is refused, (None, the sentence)."""
    try:
        return FileStore(definition, path), ""
    except SweepError as error:
        return None, str(error)


def files_of(folder):
    return {path.name: path.read_bytes() for path in folder.rglob("*") if path.is_file()}


def test_a_damaged_part_or_table_is_told_in_one_sentence_or_changes_nothing(definition, flown, tmp_path, harmed):
    parts, table, rows = flown
    chance, told = random.Random(8), []
    path, folder = tmp_path / "a.parquet", tmp_path / "a.parquet.parts"
    names = [name for name in parts if name.endswith(".parquet")]
    for _ in range(60):
        folder.mkdir(exist_ok=True)
        path.unlink(missing_ok=True)
        for name, content in parts.items():
            (folder / name).write_bytes(content)
        if chance.random() < 0.3:
            for file in folder.iterdir():
                file.unlink()
            path.write_bytes(harmed(table, chance))
        else:
            name = chance.choice(names)
            (folder / name).write_bytes(harmed(parts[name], chance))
        before = files_of(tmp_path)
        store, sentence = opened(definition, path)
        if store is None:
            assert "\n" not in sentence
            assert files_of(tmp_path) == before
            told.append(sentence)
            continue
        assert store.done.all()
        store.close()
        assert pq.read_table(path).equals(rows)
    assert len(told) > 30


@pytest.mark.parametrize("content", [b"", b"{", b"[1, 2]", b'{"values": 3, "vary": []}', b"\xff\xfe\x00"])
def test_a_damaged_note_of_the_definition_loses_nothing(content, definition, flown, laid):
    path = laid("definition.json", content)
    store = FileStore(definition, path)
    assert store.done.all()
    store.close()
    assert pq.read_table(path).equals(flown[2])
    assert [file.name for file in path.parent.iterdir()] == ["a.parquet"]


def test_parts_that_were_swapped_or_come_from_another_sweep_are_refused(definition, flown, laid, tmp_path):
    parts = flown[0]
    other = defined("0.6:1.6:30")
    store = FileStore(other, tmp_path / "other.parquet")
    store.add(fly(other, 0, 10))
    foreign = next((tmp_path / "other.parquet.parts").glob("*.parquet")).read_bytes()
    name = "000000000000-10.parquet"
    with pytest.raises(SweepError, match=r"holds another sweep: vary start.radius_au was \[0.6, .* and is \[0.5, "):
        FileStore(definition, laid(name, foreign))
    with pytest.raises(SweepError, match="does not say of which sweep"):
        FileStore(definition, laid(name, pq_of({"a": [1, 2]}, tmp_path)))
    store = FileStore(definition, laid(name, parts["000000000010-10.parquet"]))  # its rows say which flights they are
    assert not store.done[:10].any()
    assert store.done[10:].all()


def pq_of(columns, folder):
    pq.write_table(pa.table(columns), folder / "some.parquet")
    return (folder / "some.parquet").read_bytes()


def test_what_else_lies_among_the_parts_is_left_there(definition, laid, tmp_path):
    path = laid()
    (tmp_path / "a.parquet.parts" / "thesis.txt").write_text("years of work")
    FileStore(definition, path).close()
    assert (tmp_path / "a.parquet.parts" / "thesis.txt").read_text() == "years of work"


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="no pipes with names")
@pytest.mark.parametrize("place", ["a.parquet", "a.parquet.parts/000000000000-10.parquet"])
def test_a_pipe_in_place_of_a_table_is_refused_and_remains(place, definition, tmp_path):
    (tmp_path / "a.parquet.parts").mkdir()
    os.mkfifo(tmp_path / place)
    with pytest.raises(SweepError, match="no regular file"):
        FileStore(definition, tmp_path / "a.parquet")
    assert (tmp_path / place).is_fifo()


@pytest.mark.skipif(not hasattr(signal, "SIGXFSZ"), reason="no limit on the size of files")
def test_a_sweep_beyond_the_limit_of_the_shell_goes_on_later(flown, tmp_path):
    (tmp_path / "scene.json").write_text(json.dumps(COASTING))
    program = (
        "import json, resource, sys\n"
        "from sailviz import sweep\n"
        "from sailviz.sweeps.store import SweepError\n"
        "if len(sys.argv) > 2:\n"
        "    resource.setrlimit(resource.RLIMIT_FSIZE, (int(sys.argv[2]),) * 2)\n"
        "try:\n"
        "    found = sweep(json.load(open('scene.json')), {'start.radius_au': '0.5:1.5:30'}, path=sys.argv[1],\n"
        "                  report=['radius_au@end'], engine='serial')\n"
        "    print('resumed', found.resumed)\n"
        "except SweepError as error:\n"
        "    print(error)\n"
    )
    words = [sys.executable, "-c", program, "a.parquet"]
    limited = subprocess.run([*words, "4000"], cwd=tmp_path, capture_output=True, text=True, check=True).stdout
    assert "grows beyond what this system or shell allows" in limited
    assert limited.count("\n") == 1
    assert not (tmp_path / "a.parquet").exists()
    done = subprocess.run(words, cwd=tmp_path, capture_output=True, text=True, check=True).stdout
    assert done.startswith("resumed")
    columns = ["index", "start.radius_au", "radius_au@end"]
    assert pq.read_table(tmp_path / "a.parquet", columns=columns).equals(flown[2].select(columns))


def test_a_damaged_sweep_file_is_told_with_its_faults(tmp_path, harmed):
    chance, texts = random.Random(5), [path.read_bytes() for path in shipped_sweeps().values()]
    for _ in range(60):
        (tmp_path / "sweep.toml").write_bytes(harmed(chance.choice(texts), chance))
        with suppress(SailvizError):
            define(tmp_path / "sweep.toml")
