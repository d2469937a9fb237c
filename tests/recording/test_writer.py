"""Runs into recordings: blocks, events, and recordings that end early or never begin."""

from dataclasses import replace

import numpy as np
import pytest

from sailviz.errors import PropagationError, RecordingError
from sailviz.recording import Recorder, read, record
from sailviz.recording.timelines import take


def stopping(runs, run, error, after=2, size=50):
    for number, block in enumerate(runs.in_blocks(run, size)):
        if number == after:
            raise error
        yield block


@pytest.mark.parametrize("size", [7, 100])
def test_blocks_join_to_the_whole_run(runs, size, tmp_path):
    run = runs.displaced(rows=150)
    record(iter(runs.in_blocks(run, size)), tmp_path / "run.rrd")
    recording = read(tmp_path / "run.rrd")
    assert np.array_equal(recording["/state"]["position_m"], run.position)
    assert np.array_equal(recording["/state"].timeline("step"), np.arange(150))


@pytest.mark.parametrize("size", [20, 300])
def test_an_event_stands_at_the_first_row_not_before_it(runs, size, tmp_path):
    run = runs.displaced()
    blocks = runs.in_blocks(run, size)
    told_early = [replace(block, events=run.events if block.first == 0 else ()) for block in blocks]
    record(told_early, tmp_path / "run.rrd")
    (event,) = read(tmp_path / "run.rrd").events
    assert (event.name, event.time) == ("halfway", run.events[0].time)
    assert np.array_equal(event.state, run.events[0].state)
    assert run.time[event.step - 1] < event.time <= run.time[event.step]


def test_one_run_goes_to_two_files_at_once(runs, tmp_path):
    record(runs.displaced(rows=30), tmp_path / "a.rrd", str(tmp_path / "b.rrd"))
    assert len(read(tmp_path / "a.rrd")["/state"]["time_s"]) == len(read(tmp_path / "b.rrd")["/state"]["time_s"]) == 30


def test_a_run_of_one_row_is_recorded(any_run, tmp_path):
    run = take(any_run, slice(0, 1))
    record(replace(run, setting=replace(run.setting, rows=1), events=()), tmp_path / "run.rrd")
    assert len(read(tmp_path / "run.rrd")["/state"]["time_s"]) == 1


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


def test_an_empty_run_is_refused(run, tmp_path):
    with pytest.raises(RecordingError, match="no rows"):
        record([], tmp_path / "run.rrd")
    assert list(tmp_path.iterdir()) == []
