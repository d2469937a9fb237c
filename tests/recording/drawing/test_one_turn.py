"""One revolution of many: which it is, that it is drawn where it was flown, and that the time line has it selected."""

from dataclasses import replace

import numpy as np
import pytest
from rerun.chunk import RrdReader

from sailviz import load_scene, read, record, simulate
from sailviz.constants import RADIUS_EARTH
from sailviz.recording import timelines
from sailviz.recording.drawing.one_turn import OneTurn
from sailviz.recording.drawing.samples import Frame


@pytest.fixture(scope="module")
def sail():
    """86 revolutions, 30 rows in each."""
    return simulate(load_scene("earth/lightsail-2", {"propagation.duration_d": 6, "propagation.outputs": 2600}))


def found_in(run, size):
    """What is found where the run comes in blocks of so many rows."""
    turn = OneTurn(Frame.of(run))
    for start in range(0, len(run), size):
        turn.add(replace(timelines.take(run, slice(start, start + size)), first=start))
    return turn


@pytest.mark.parametrize("size", [7, 64, 5000])
def test_it_is_the_first_revolution_however_the_rows_come(sail, size):
    turn = found_in(sail, size)
    period = 2 * np.pi * np.sqrt((RADIUS_EARTH + 720e3) ** 3 / 3.986004e14)
    step = sail.time[1]
    assert turn.span[0] == 0
    assert period - step < turn.span[1] <= period + step
    assert np.array_equal(turn.numbers, np.arange(len(turn.numbers)))
    assert np.array_equal(turn.rows.position, sail.position[turn.numbers])


def test_none_is_found_where_rows_are_far_apart_or_the_flight_is_short(sail):
    sparse = timelines.take(sail, slice(None, None, 3))  # ten in a revolution
    assert found_in(replace(sparse, setting=replace(sail.setting, rows=len(sparse))), 64).span is None
    short = replace(sail.setting, duration=0.1 * sail.setting.duration)
    assert found_in(replace(sail, setting=short), 64).span is None


def test_it_is_drawn_where_it_was_flown_and_selected_on_the_time_line(sail, tmp_path):
    path = tmp_path / "sail.rrd"
    record(sail, path)
    last = found_in(sail, 5000).span[1]
    drawn = read(path)["/world/rtn"]
    steps, places = drawn.timeline("step"), drawn["translation"] * RADIUS_EARTH
    off = np.linalg.norm(places - sail.position[steps], axis=1)
    inside = sail.time[steps] <= last
    assert np.array_equal(steps[inside], np.arange(inside.sum()))
    assert off[inside].max() < 2.0  # m, of float32
    assert np.median(off[~inside]) > 1e6  # the others are slowed
    reader = RrdReader(str(path))
    blueprint = (chunk.to_record_batch() for chunk in reader.stream(store=reader.blueprints()[-1]))
    name = "TimePanelBlueprint:time_selection"
    (selected,) = {str(part.column(name).to_pylist()[-1]) for part in blueprint if name in part.schema.names}
    assert selected == str([{"min": 0, "max": round(1e9 * last)}])
