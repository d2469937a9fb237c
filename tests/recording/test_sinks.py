"""Where a recording may go, and what is refused before it begins."""

import numpy as np
import pytest

from sailviz.errors import RecordingError
from sailviz.recording import Connect, Memory, Recorder, read, record


def test_memory_holds_what_a_file_would(runs, tmp_path):
    memory = Memory()
    run = runs.spiral(rows=60)
    record(run, memory)
    (tmp_path / "memory.rrd").write_bytes(memory.bytes)
    assert np.array_equal(read(tmp_path / "memory.rrd")["/state"]["velocity_m_s"], run.velocity)


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
