"""Recordings read back: names, files that were cut off, files that are no recordings."""

import io
import re
from collections.abc import Mapping

import numpy as np
import pytest
import rerun as rr

from sailviz.errors import RecordingError
from sailviz.recording import Memory, digest, read, record


@pytest.mark.parametrize(
    ("entity", "column", "near"), [("/stat", None, "/state"), ("/state", "position", "position_m")]
)
def test_a_wrong_name_is_answered_with_the_nearest(runs, entity, column, near, tmp_path):
    record(runs.displaced(rows=30), tmp_path / "run.rrd")
    recording = read(tmp_path / "run.rrd")
    with pytest.raises(KeyError, match=near):
        _ = recording[entity] if column is None else recording[entity][column]


@pytest.mark.parametrize("share", [0.5, 0.999])
def test_a_file_that_was_cut_off_is_read_as_far_as_it_goes(runs, share, run, tmp_path):
    record(runs.in_blocks(run, 10), tmp_path / "run.rrd")
    whole = (tmp_path / "run.rrd").read_bytes()
    (tmp_path / "cut.rrd").write_bytes(whole[: int(share * len(whole))])
    recording = read(tmp_path / "cut.rrd")
    position = recording["/state"]["position_m"]
    assert not recording.complete
    assert 0 < len(position) <= len(run)
    assert np.array_equal(position, run.position[: len(position)])
    assert recording.scene_text == run.setting.text


@pytest.mark.parametrize(
    ("content", "word"),
    [
        (b"", "is empty"),
        (b"RRF2\x00\x29", "cut off"),
        (b"time, x, y\n1, 2, 3\n" * 9, "not a Rerun recording"),
        (b"RRF2\x00\x63\x00\x00\x01\x02\x00\x00" + bytes(64), r"Rerun 0\.99.*up to 0\.41"),
        (b"RRF2\x00\x29\x00\x00\x01\x02\x00\x00" + bytes(8), "holds no recording"),
        (b"RRF2\x00\x29\x00\x00\x01\x02\x00\x00" + b"\xff" * 4000, "cut off|cannot be read"),
    ],
)
def test_what_is_no_recording_is_refused_in_one_sentence(content, word, tmp_path):
    (tmp_path / "file.rrd").write_bytes(content)
    with pytest.raises(RecordingError, match=word) as error:
        read(tmp_path / "file.rrd")
    assert "\n" not in str(error.value)


def test_a_missing_file_is_refused_in_one_sentence(tmp_path):
    with pytest.raises(RecordingError, match="no such file"):
        read(tmp_path / "none.rrd")


def test_a_recording_of_another_application_is_read_without_a_contract(tmp_path):
    stream = rr.RecordingStream("somebody_else", recording_id="x", send_properties=False)
    stream.save(str(tmp_path / "other.rrd"))
    stream.send_columns("a/b", [rr.TimeColumn("frame", sequence=range(5))], rr.Scalars.columns(scalars=np.arange(5.0)))
    stream.disconnect()
    recording = read(tmp_path / "other.rrd")
    assert recording.application_id == "somebody_else"
    assert recording.contract == ""
    assert not recording.complete
    assert np.array_equal(recording["/a/b"]["scalars"], np.arange(5.0))
    assert len(digest(tmp_path / "other.rrd")) == 64


@pytest.fixture
def recording(runs, tmp_path):
    record(runs.displaced(rows=30), tmp_path / "run.rrd")
    return read(tmp_path / "run.rrd")


def test_a_recording_is_a_mapping_of_its_entities(recording):
    assert isinstance(recording, Mapping)
    assert list(recording) == list(recording.keys()) == sorted(recording.entities)
    assert len(recording) == len(recording.entities) > 50
    assert "/state" in recording
    assert "state" in recording
    assert "/nothing" not in recording
    assert 3 not in recording
    assert recording.get("/nothing") is None
    assert dict(recording.items())["/state"] is recording["/state"]
    assert recording == recording
    assert recording != read(recording.path)


def test_an_entity_is_a_mapping_of_its_columns(recording, run):
    state = recording["/state"]
    assert isinstance(state, Mapping)
    assert set(state) == {"time_s", "position_m", "velocity_m_s", "mass_kg"}
    assert len(state) == 4
    assert {name: values.shape for name, values in state.items()} == {
        "time_s": (30,),
        "position_m": (30, 3),
        "velocity_m_s": (30, 3),
        "mass_kg": (30,),
    }
    assert state.get("position_km") is None


def test_a_recording_names_its_columns_with_shapes_and_units(recording):
    told = re.sub(r"\n {5,}", " ", repr(recording))  # lines that were folded
    lines = told.splitlines()
    (state,) = (line for line in lines if line.split()[0] == "/state")
    assert "30 rows" in state
    assert "time_s (n,) s" in state
    assert "position_m (n, 3) m" in state
    assert "velocity_m_s (n, 3) m/s" in state
    (attitude,) = (line for line in lines if line.split()[0] == "/attitude")
    assert "pitch_rad (n,) rad" in attitude
    assert "quaternion (n, 4)" in attitude
    assert lines[0] == f"<Recording {recording.path}: {len(recording)} entities>"
    assert not any("/world" in line for line in lines)
    assert int(lines[-1].split()[1]) + len(lines) - 2 == len(recording)
    assert "normal (n, 3)" in repr(recording["/attitude"])
    assert max(len(line) for line in repr(recording).splitlines()) <= 110


def test_a_long_recording_is_named_without_reading_its_rows(runs, tmp_path):
    run = runs.displaced(rows=40_000)
    record(run, tmp_path / "long.rrd")
    recording = read(tmp_path / "long.rrd")
    assert "40000 rows" in repr(recording)
    assert len(recording.head("/state")["time_s"]) < len(run)


def test_a_recording_by_others_is_named_too(tmp_path):
    stream = rr.RecordingStream("somebody_else", recording_id="x", send_properties=False)
    stream.save(str(tmp_path / "other.rrd"))
    stream.send_columns("a/b", [rr.TimeColumn("frame", sequence=range(5))], rr.Scalars.columns(scalars=np.arange(5.0)))
    stream.disconnect()
    assert "/a/b  5 rows: scalars (n,)" in repr(read(tmp_path / "other.rrd"))


@pytest.mark.parametrize("form", ["str", "path", "bytes", "file", "stream", "memory", "recording"])
def test_a_recording_is_read_from_whatever_holds_it(form, run, tmp_path):
    path, memory = tmp_path / "run.rrd", Memory()
    record(run, path)
    record(run, memory)
    with open(path, "rb") as file:
        source = {
            "str": str(path),
            "path": path,
            "bytes": memory.bytes,
            "file": file,
            "stream": io.BytesIO(memory.bytes),
            "memory": memory,
            "recording": read(path),
        }[form]
        recording = read(source)
    assert np.array_equal(recording["/state"]["position_m"], run.position)
    assert recording.complete


@pytest.mark.parametrize("source", [3, None, io.StringIO("text"), b"text that is long enough", io.BytesIO(b"")])
def test_what_holds_no_recording_is_refused_in_one_sentence(source):
    with pytest.raises(RecordingError) as error:
        read(source)
    assert "\n" not in str(error.value)
