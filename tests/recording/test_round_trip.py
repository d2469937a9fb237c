"""What a run holds comes back from its recording bit for bit, under the names of the contract."""

from dataclasses import replace

import numpy as np
import pytest

from sailviz.errors import RecordingError
from sailviz.recording import Memory, read, record
from sailviz.recording.contract import tables
from sailviz.recording.timelines import take

CONTRACT = {
    "/state": {"time_s", "position_m", "velocity_m_s", "mass_kg"},
    "/attitude": {"pitch_rad", "cone_rad", "clock_rad", "normal", "quaternion"},
    "/thrust": {"acceleration_m_s2", "acceleration_rtn_m_s2", "magnitude_m_s2", "on"},
    "/elements": {
        "semi_major_axis_m",
        "eccentricity",
        "inclination_rad",
        "raan_rad",
        "argument_rad",
        "true_anomaly_rad",
    },
    "/events": {"name", "time_s", "state"},
}


def test_every_number_of_a_run_comes_back_bit_for_bit(any_run, tmp_path):
    record(any_run, tmp_path / "run.rrd")
    recording = read(tmp_path / "run.rrd")
    for entity, table in tables(any_run).items():
        for name, values in table.items():
            back = recording[entity][name]
            assert back.dtype == values.dtype
            assert back.shape == values.shape
            assert back.tobytes() == np.ascontiguousarray(values).tobytes(), f"{entity} {name}"


def test_nan_and_infinity_come_back(runs, tmp_path):
    run = runs.spiral(rows=50)
    run.elements.semi_major_axis[7] = np.inf
    run.elements.argument[9] = np.nan
    record(run, tmp_path / "run.rrd")
    elements = read(tmp_path / "run.rrd")["/elements"]
    assert elements["semi_major_axis_m"][7] == np.inf
    assert np.isnan(elements["argument_rad"][9])


def test_entities_carry_the_names_of_the_contract(runs, tmp_path):
    record(runs.displaced(), tmp_path / "run.rrd")
    recording = read(tmp_path / "run.rrd")
    assert recording.contract == "sailviz/1"
    for entity, names in CONTRACT.items():
        assert set(recording[entity]) == names


def test_environment_columns_keep_their_names(runs, tmp_path):
    run = runs.spiral()
    record(run, tmp_path / "run.rrd")
    assert set(read(tmp_path / "run.rrd")["/environment"]) == set(run.environment)


@pytest.mark.parametrize("size", [7, 100])
def test_blocks_join_to_the_whole_run(runs, size, tmp_path):
    run = runs.displaced(rows=150)
    record(iter(runs.in_blocks(run, size)), tmp_path / "run.rrd")
    recording = read(tmp_path / "run.rrd")
    assert np.array_equal(recording["/state"]["position_m"], run.position)
    assert np.array_equal(recording["/state"].timeline("step"), np.arange(150))


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


def test_scene_and_provenance_travel_with_the_numbers(runs, tmp_path):
    run = runs.displaced()
    recorded = record(run, tmp_path / "run.rrd")
    recording = read(tmp_path / "run.rrd")
    assert recording.scene_text == run.setting.text
    assert recording.resolved == run.setting.resolved
    assert recording.versions == run.setting.versions
    assert recording.accuracy == run.setting.accuracy
    assert recording.identity == recorded.identity == run.setting.identity
    assert recording.application_id == f"sailviz_displaced_{run.setting.identity[:8]}"
    assert recording.complete
    assert recorded.complete
    assert recorded.rows == len(run)
    assert recording["/scene"]["craft_tether_length_m"][0] == 20e3


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


def test_memory_holds_what_a_file_would(runs, tmp_path):
    memory = Memory()
    run = runs.spiral(rows=60)
    record(run, memory)
    (tmp_path / "memory.rrd").write_bytes(memory.bytes)
    assert np.array_equal(read(tmp_path / "memory.rrd")["/state"]["velocity_m_s"], run.velocity)


def test_one_run_goes_to_two_files_at_once(runs, tmp_path):
    record(runs.displaced(rows=30), tmp_path / "a.rrd", str(tmp_path / "b.rrd"))
    assert len(read(tmp_path / "a.rrd")["/state"]["time_s"]) == len(read(tmp_path / "b.rrd")["/state"]["time_s"]) == 30


def test_a_run_of_three_centuries_is_refused_with_the_reason(runs, tmp_path):
    run = runs.displaced(rows=30, years=300)
    with pytest.raises(RecordingError, match="292 years"):
        record(run, tmp_path / "run.rrd")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("entity", "column", "near"), [("/stat", None, "/state"), ("/state", "position", "position_m")]
)
def test_a_wrong_name_is_answered_with_the_nearest(runs, entity, column, near, tmp_path):
    record(runs.displaced(rows=30), tmp_path / "run.rrd")
    recording = read(tmp_path / "run.rrd")
    with pytest.raises(KeyError, match=near):
        _ = recording[entity] if column is None else recording[entity][column]


def test_a_run_of_one_row_is_recorded(any_run, tmp_path):
    run = take(any_run, slice(0, 1))
    record(replace(run, setting=replace(run.setting, rows=1), events=()), tmp_path / "run.rrd")
    assert len(read(tmp_path / "run.rrd")["/state"]["time_s"]) == 1
