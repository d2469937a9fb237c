"""Recordings that end early or never begin, and files that are no recordings."""

from dataclasses import replace

import numpy as np
import pytest
import rerun as rr

from sailviz.errors import PropagationError, RecordingError
from sailviz.recording import Connect, Memory, Recorder, digest, read, record


def stopping(runs, run, error, after=2, size=50):
    for number, block in enumerate(runs.in_blocks(run, size)):
        if number == after:
            raise error
        yield block


def test_an_interrupted_run_leaves_a_whole_file_that_says_so(runs, run, tmp_path):
    with pytest.raises(KeyboardInterrupt):
        record(stopping(runs, run, KeyboardInterrupt()), tmp_path / "run.rrd")
    recording = read(tmp_path / "run.rrd")
    assert not recording.complete
    assert np.array_equal(recording["/state"]["position_m"], run.position[:100])
    last = recording.events[-1]
    assert last.name.startswith("interrupted at")
    assert last.time == run.time[99]
    assert last.step == 99
    assert np.array_equal(last.state[:3], run.position[99])
    assert [path.name for path in tmp_path.iterdir()] == ["run.rrd"]


def test_a_failed_integration_leaves_a_whole_file_with_its_sentence(runs, run, tmp_path):
    error = PropagationError("the step became too small", 12.0, np.arange(7.0))
    with pytest.raises(PropagationError):
        record(stopping(runs, run, error), tmp_path / "run.rrd")
    recording = read(tmp_path / "run.rrd")
    assert not recording.complete
    assert recording.events[-1].name == str(error)


def test_what_fails_before_the_first_block_leaves_nothing(runs, run, tmp_path):
    with pytest.raises(ZeroDivisionError):
        record(stopping(runs, run, ZeroDivisionError(), after=0), tmp_path / "run.rrd")
    assert list(tmp_path.iterdir()) == []


def test_a_file_appears_only_when_it_is_whole(runs, run, tmp_path):
    with Recorder(tmp_path / "run.rrd") as recorder:
        for block in runs.in_blocks(run, 100):
            recorder.add(block)
            assert not (tmp_path / "run.rrd").exists()
    assert (tmp_path / "run.rrd").exists()
    assert recorder.recorded.complete


def test_a_recording_replaces_an_older_one_of_its_name(run, tmp_path):
    (tmp_path / "run.rrd").write_text("old")
    record(run, tmp_path / "run.rrd")
    assert read(tmp_path / "run.rrd").complete


def test_blocks_out_of_order_are_refused(runs, run, tmp_path):
    first, _, third = runs.in_blocks(run, 100)
    with pytest.raises(RecordingError, match="row 100 was due, row 200 came"):
        record([first, third], tmp_path / "run.rrd")


@pytest.mark.parametrize(
    ("sink", "word"),
    [("nowhere/run.rrd", "no directory"), (".", "is a directory"), (3, "cannot go to 3"), (None, "cannot go to None")],
)
def test_an_impossible_sink_is_refused_before_the_first_block(sink, word, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)

    def never():
        raise AssertionError("the run was asked for a block")
        yield

    with pytest.raises(RecordingError, match=word):
        record(never(), sink)
    assert list(tmp_path.iterdir()) == []


def test_sinks_that_exclude_each_other_are_refused(tmp_path):
    with pytest.raises(RecordingError, match="alone"):
        Recorder(tmp_path / "run.rrd", Memory())
    with pytest.raises(RecordingError, match="twice"):
        Recorder(tmp_path / "run.rrd", tmp_path / "." / "run.rrd")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("url", "word"), [("nonsense", "no address"), ("rerun+http://127.0.0.1:9/proxy", "no viewer answers")]
)
def test_a_viewer_that_does_not_answer_is_refused_at_once(url, word):
    with pytest.raises(RecordingError, match=word):
        Recorder(Connect(url))


def test_an_empty_run_is_refused(run, tmp_path):
    with pytest.raises(RecordingError, match="no rows"):
        record([], tmp_path / "run.rrd")
    assert list(tmp_path.iterdir()) == []


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


def test_a_run_without_thrust_is_drawn(runs, tmp_path):
    run = runs.displaced(rows=60)
    still = replace(
        run.thrust,
        acceleration=0 * run.thrust.acceleration,
        acceleration_rtn=0 * run.thrust.acceleration_rtn,
        magnitude=0 * run.thrust.magnitude,
        on=np.zeros(60, bool),
    )
    record(replace(run, thrust=still), tmp_path / "run.rrd")
    assert read(tmp_path / "run.rrd").complete
