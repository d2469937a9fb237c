"""The timelines of a recording, and which rows are drawn."""

import numpy as np
import pytest

from sailviz.errors import RecordingError
from sailviz.recording import digest, read, record
from sailviz.recording.timelines import Picker


def test_timelines_count_rows_nanoseconds_and_utc(runs, tmp_path):
    run = runs.displaced(rows=40)
    record(run, tmp_path / "run.rrd")
    state = read(tmp_path / "run.rrd")["/state"]
    ns = np.round(run.time * 1e9).astype("int64").astype("timedelta64[ns]")
    assert np.array_equal(state.timeline("step"), np.arange(40))
    assert np.array_equal(state.timeline("sim_time"), ns)
    assert np.array_equal(state.timeline("utc"), run.setting.epoch + ns)


def test_without_an_epoch_there_is_no_utc(runs, tmp_path):
    record(runs.displaced(rows=40, epoch=False), tmp_path / "run.rrd")
    with pytest.raises(KeyError, match="not on a timeline utc"):
        read(tmp_path / "run.rrd")["/state"].timeline("utc")


def test_a_run_of_three_centuries_is_refused_with_the_reason(runs, tmp_path):
    run = runs.displaced(rows=30, years=300)
    with pytest.raises(RecordingError, match="292 years"):
        record(run, tmp_path / "run.rrd")
    assert list(tmp_path.iterdir()) == []


def test_evenly_spaced_rows_are_thinned_evenly_and_others_by_time_too():
    class Rows:
        def __init__(self, time, first=0):
            self.time, self.first = time, first

        def __len__(self):
            return len(self.time)

    even = np.linspace(0, 1e6, 10_001)
    assert np.array_equal(Picker(10_001, 1000, 1e6).pick(Rows(even)), np.arange(0, 10_001, 11))
    time = np.concatenate([np.linspace(0, 10.0, 9_000), np.linspace(1e3, 1e6, 1000)])
    picker = Picker(10_000, 1000, 1e6)
    chosen = picker.pick(Rows(time))
    assert np.all(np.isin(np.arange(0, 10_000, 10), chosen))
    gap = 1.5 * 10 * 1e6 / 9_999
    late = chosen[time[chosen] > 1e3]
    assert np.diff(time[late]).max() < gap + 1e3 + 1  # the row at which the gap is reached: rows are 1000 s apart
    assert len(chosen) <= 1000 + 1e6 / gap + 1
    again, parts = Picker(10_000, 1000, 1e6), []
    for start in range(0, 10_000, 777):
        parts.append(start + again.pick(Rows(time[start : start + 777], start)))
    assert np.array_equal(np.concatenate(parts), chosen)


def test_the_blocks_of_an_uneven_run_do_not_count(runs, tmp_path, low_orbit):
    run = low_orbit.with_everything(runs.descent(time=low_orbit.uneven(days=300.0, far=200, close=200)))
    record(run, tmp_path / "whole.rrd")
    record(iter(runs.in_blocks(run, 37)), tmp_path / "blocks.rrd")
    assert digest(tmp_path / "whole.rrd") == digest(tmp_path / "blocks.rrd")
