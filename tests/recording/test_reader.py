"""Recordings read back: names, files that were cut off, files that are no recordings."""

import numpy as np
import pytest
import rerun as rr

from sailviz.errors import RecordingError
from sailviz.recording import digest, read, record


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
