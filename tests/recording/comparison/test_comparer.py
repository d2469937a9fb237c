"""What compare finds: every change that matters, and where; and what it lets pass."""

from dataclasses import replace

import numpy as np
import pytest
import rerun as rr

import sailviz
from sailviz.errors import RecordingError
from sailviz.recording import compare, export, record
from sailviz.recording.contract import tables
from sailviz.recording.drawing import system_view
from sailviz.recording.drawing.drawing import Drawing
from sailviz.recording.timelines import take
from sailviz.run.resample import at, cost

COLUMNS = {
    "": ("time", "position", "velocity", "mass"),
    "attitude": ("pitch", "cone", "clock", "normal", "quaternion"),
    "thrust": ("acceleration", "acceleration_rtn", "magnitude"),
    "elements": ("semi_major_axis", "eccentricity", "inclination", "raan", "argument", "true_anomaly"),
}
EACH = [(group, name) for group, names in COLUMNS.items() for name in names]
DAY = 86_400.0


def changed(run, group, name, change):
    """The run with one of its columns changed."""
    part = getattr(run, group) if group else run
    values = getattr(part, name).copy()
    change(values)
    part = replace(part, **{name: values})
    return replace(run, **{group: part}) if group else part


@pytest.fixture
def recorded(tmp_path):
    """recorded(run) -> path."""
    count = iter(range(100))

    def write(run):
        path = tmp_path / f"{next(count)}.rrd"
        record(run, path)
        return path

    return write


def test_a_recording_equals_itself_its_run_and_its_table(any_run, recorded, tmp_path):
    path = recorded(any_run)
    (table,) = export(path, tmp_path / "run.npz")
    for other in (path, any_run, table, sailviz.read(path)):
        found = compare(path, other)
        assert found.equal, str(found)
        assert all(d.largest == 0 for d in found.quantities)
    assert compare(path, path).picture_columns > 50
    assert "Equal: " in str(compare(path, path))


@pytest.mark.parametrize("on", ["sim_time", "step"])
@pytest.mark.parametrize(("group", "name"), EACH)
def test_one_part_in_a_hundred_million_of_any_column_is_found(runs, group, name, on):
    run = runs.spiral(rows=60)
    if name in ("inclination", "raan"):  # zero of a planar run; here they are numbers
        run = changed(run, group, name, lambda values: values.__iadd__(0.2))
    row = 41

    def nudge(values):
        values[row] += 1e-8 * np.abs(values).max()

    found = compare(run, changed(run, group, name, nudge), on=on)
    assert not found.equal
    assert [d.quantity.split(":")[1].startswith(name) for d in found.different] == [True]
    (worst,) = found.different
    assert worst.row == row
    assert worst.time == pytest.approx(run.time[row])


def test_one_part_in_a_hundred_million_of_the_environment_is_found(runs):
    run = runs.spiral(rows=60)
    for name, values in run.environment.items():
        other = values.copy()
        other[17] *= 1 + 1e-8 * np.abs(values).max() / abs(values[17])
        found = compare(run, replace(run, environment={**run.environment, name: other}))
        assert [(d.quantity, d.row) for d in found.different] == [(f"/environment:{name}", 17)]


def test_a_flipped_arrow_is_found_in_the_numbers_and_in_the_picture(runs, recorded):
    run = runs.displaced(rows=60)

    def flip(values):
        values[11] *= -1

    flipped = changed(changed(run, "thrust", "acceleration", flip), "thrust", "acceleration_rtn", flip)
    found = compare(recorded(run), recorded(flipped))
    assert found["/thrust:acceleration_m_s2"].beyond == 3
    assert found["/thrust:acceleration_m_s2"].row == 11
    assert found["/sail/push:vectors"].row == found["/world/craft/push:vectors"].row == 11
    assert not found.faults


def test_a_flipped_arrow_of_the_picture_alone_is_found(runs, recorded, tmp_path, monkeypatch):
    run = runs.displaced(rows=60)
    before = recorded(run)
    finish = Drawing.finish

    def lie(drawing, last):
        finish(drawing, last)
        time = rr.TimeColumn("step", sequence=[30])
        rows = rr.TimeColumn("sim_time", duration=[np.timedelta64(round(run.time[30] * 1e9), "ns")])
        utc = rr.TimeColumn("utc", timestamp=[run.setting.epoch + np.timedelta64(round(run.time[30] * 1e9), "ns")])
        arrow = rr.Arrows3D.columns(vectors=[[1.0, 0.0, 0.0]])
        drawing._stream.send_columns("/world/craft/push", [time, rows, utc], arrow)

    monkeypatch.setattr(Drawing, "finish", lie)
    record(run, tmp_path / "flipped.rrd")
    found = compare(before, tmp_path / "flipped.rrd")
    assert all(d.equal for d in found.quantities)
    assert {d.quantity for d in found.picture} == {"/world/craft/push:vectors"}
    assert not found.equal
    assert compare(before, tmp_path / "flipped.rrd", picture=False).equal


def test_a_missing_an_added_and_a_shifted_event_are_found(runs, recorded):
    run = runs.displaced(rows=60)
    (event,) = run.events
    path = recorded(run)
    without = compare(path, recorded(replace(run, events=())))
    assert any('event "halfway"' in fault and "missing in B" in fault for fault in without.faults)
    assert any("missing in A" in fault for fault in compare(replace(run, events=()), run).faults)
    twice = replace(run, events=(event, replace(event, time=event.time + DAY)))
    assert any("(number 2)" in fault for fault in compare(run, twice).faults)
    later = replace(run, events=(replace(event, time=event.time * (1 + 1e-8)),))
    assert [d.quantity for d in compare(run, later).different] == ["/events:time_s"]
    moved = event.state.copy()
    moved[1] += 1e-7
    assert [d.quantity for d in compare(run, replace(run, events=(replace(event, state=moved),))).different] == [
        "/events:position_m"
    ]


def test_a_lost_view_is_found(runs, recorded, monkeypatch):
    run = runs.displaced(rows=60)
    before = recorded(run)
    views_of = system_view.views_of
    monkeypatch.setattr(system_view, "views_of", lambda *a: [s for s in views_of(*a) if s.name != "Riding along"])
    found = compare(before, recorded(run))
    assert not found.equal
    assert any('view "Riding along"' in fault and "missing in B" in fault for fault in found.faults)
    assert all(d.equal for d in found.quantities)


def test_a_lost_entity_and_a_lost_column_are_found(runs):
    run = runs.spiral(rows=60)
    bare = compare(run, replace(run, environment={}))
    assert "/environment is missing in B" in bare.faults
    name = next(iter(run.environment))
    less = compare(replace(run, environment={name: run.environment[name]}), run)
    assert [fault for fault in less.faults if "missing in A" in fault]


def test_not_a_number_equals_itself_in_the_same_place_only(runs):
    run = runs.displaced(rows=60)
    run.elements.argument[9] = np.nan
    run.elements.semi_major_axis[7] = np.inf
    assert compare(run, run).equal
    found = compare(run, changed(run, "elements", "argument", lambda values: values.__setitem__(9, 1.0)))
    assert found["/elements:argument_rad"].largest == np.inf
    assert found["/elements:argument_rad"].row == 9
    assert "not a number" in str(found)
    found = compare(run, changed(run, "elements", "semi_major_axis", lambda values: values.__setitem__(7, -np.inf)))
    assert not found["/elements:semi_major_axis_m"].equal


def test_an_angle_equals_itself_after_a_turn_and_a_quaternion_its_negative(runs):
    run = runs.displaced(rows=60)
    turned = changed(run, "elements", "true_anomaly", lambda values: values.__iadd__(2 * np.pi))
    turned = changed(turned, "attitude", "quaternion", lambda values: values.__imul__(-1))
    assert compare(run, turned).equal


def test_a_run_that_ends_early_is_different_and_says_when(runs):
    run = runs.displaced(rows=60)
    short = take(run, slice(0, 50))
    by_time = compare(run, short)
    assert any(fault.startswith("A ends at 1.5 yr, B at") for fault in by_time.faults)
    assert all(d.equal for d in by_time.quantities), str(by_time)  # what both have is the same
    assert "rows: 10 are missing in B, the first is row 50" in compare(run, short, on="step").faults


def test_an_interrupted_recording_differs_from_the_whole(runs, recorded, tmp_path):
    run = runs.displaced(rows=60)

    def blocks():
        yield runs.in_blocks(run, 30)[0]
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        record(blocks(), tmp_path / "cut.rrd")
    faults = compare(recorded(run), tmp_path / "cut.rrd").faults
    assert "B was interrupted or cut off" in faults
    assert any('event "interrupted"' in fault for fault in faults)


@pytest.mark.parametrize("swap", [False, True])
def test_another_grid_of_the_same_motion_is_equal_and_the_result_says_that_it_interpolated(runs, swap):
    fine, coarse = runs.displaced(rows=3001), runs.displaced(rows=500)
    found = compare(coarse, fine) if swap else compare(fine, coarse)
    assert found.equal, str(found)
    assert any("was interpolated at 500 times" in note for note in found.notes)
    position = found["/state:position_m"]
    assert 0 < position.largest < 100  # m, at 1 au: cubic
    assert position.largest < 3 * position.interpolation
    assert found["/elements:true_anomaly_rad"].largest < 1e-9  # the circle's seam is no difference


def test_another_motion_on_another_grid_is_different(runs):
    fine, coarse = runs.displaced(rows=3001), runs.displaced(rows=500)
    drifted = changed(coarse, "", "position", lambda values: values.__imul__(1 + 1e-7))
    found = compare(fine, drifted)
    assert [d.quantity for d in found.different] == ["/state:position_m"]
    tight = compare(fine, coarse, atol={"/state:position_m": 1e-3})
    assert [d.quantity for d in tight.different] == ["/state:position_m"]


def test_tolerances_by_quantity_column_entity_and_for_all(runs):
    run = runs.displaced(rows=60)
    off = changed(run, "", "position", lambda values: values.__iadd__(1.0e3))
    assert not compare(run, off).equal
    for atol in ({"/state:position_m": 1001.0}, {"position_m": 1001.0}, {"/state": 1001.0}, {"": 1001.0}, 1001.0):
        assert compare(run, off, atol=atol).equal
    assert not compare(run, off, atol={"/state:position_m": 999.0}).equal
    scaled = changed(run, "", "position", lambda values: values.__imul__(1 + 1e-6))
    assert compare(run, scaled, rtol={"position_m": 1.1e-6}).equal
    assert not compare(run, scaled, rtol={"position_m": 0.9e-6}).equal


@pytest.mark.parametrize(
    ("arguments", "word"),
    [
        ({"atol": {"/state:postion_m": 1.0}}, "did you mean /state:position_m"),
        ({"rtol": {"/stat": 1.0}}, "did you mean /state"),
        ({"atol": -1.0}, "must be a number >= 0"),
        ({"atol": {"mass_kg": "x"}}, "must be a number >= 0"),
        ({"on": "utc"}, "sim_time or on step"),
    ],
)
def test_a_wrong_request_is_refused_in_one_sentence(runs, arguments, word):
    run = runs.displaced(rows=20)
    with pytest.raises(RecordingError, match=word) as error:
        compare(run, run, **arguments)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize(
    ("name", "content", "word"),
    [
        ("a.npz", b"", "not a table"),
        ("a.npz", b"PK\x03\x04 and no more", "not a table"),
        ("a.rrd", b"", "is empty"),
        ("a.rrd", b"time, x\n" * 20, "not a Rerun recording"),
        ("a.rrd", b"RRF2\x00\x63\x00\x00\x01\x02\x00\x00" + bytes(64), r"written by Rerun 0\.99"),
    ],
)
def test_what_cannot_be_compared_is_refused_in_one_sentence(runs, name, content, word, tmp_path):
    (tmp_path / name).write_bytes(content)
    with pytest.raises(RecordingError, match=word) as error:
        compare(runs.displaced(rows=20), tmp_path / name)
    assert "\n" not in str(error.value)
    with pytest.raises(RecordingError, match="no such file"):
        compare(tmp_path / "none.npz", tmp_path / name)
    with pytest.raises(RecordingError, match="cannot compare 3"):
        compare(3, tmp_path / name)


def test_an_archive_of_something_else_is_refused(runs, tmp_path):
    np.savez(tmp_path / "other.npz", x=np.arange(3))
    with pytest.raises(RecordingError, match="not written by"):
        compare(runs.displaced(rows=20), tmp_path / "other.npz")


def test_recordings_of_other_applications_are_compared_too(tmp_path):
    def write(path, values):
        stream = rr.RecordingStream("somebody_else", recording_id="x", send_properties=False)
        stream.save(str(path))
        columns = [rr.TimeColumn("frame", sequence=range(len(values)))]
        stream.send_columns("a/b", columns, rr.Scalars.columns(scalars=values))
        stream.disconnect()

    values = np.arange(5.0)
    write(tmp_path / "a.rrd", values)
    write(tmp_path / "b.rrd", values + 1e-6 * (values == 3))
    assert compare(tmp_path / "a.rrd", tmp_path / "a.rrd").equal
    found = compare(tmp_path / "a.rrd", tmp_path / "b.rrd")
    assert [(d.quantity, d.row) for d in found.different] == [("/a/b:scalars", 3)]


def test_the_result_is_ready_for_json(runs):
    import json

    run = runs.displaced(rows=20)
    run.elements.argument[9] = np.nan
    told = json.loads(json.dumps(compare(run, runs.displaced(rows=20)).to_dict()))
    assert told["equal"] is False
    argument = next(d for d in told["quantities"] if d["quantity"] == "/elements:argument_rad")
    assert (argument["largest"], argument["a"], argument["row"], argument["unit"]) == ("inf", None, 9, "rad")
    of_state = {
        d["quantity"].removeprefix("/state:") for d in told["quantities"] if d["quantity"].startswith("/state:")
    }
    assert of_state == set(tables(run)["/state"])


def test_interpolation_is_of_fourth_order_for_motion_and_its_cost_is_known():
    errors = []
    for n in (60, 120):
        grid = np.linspace(0, 6, n)
        circle = {"position_m": np.stack([np.cos(grid), np.sin(grid)], 1)}
        circle["velocity_m_s"] = np.stack([-np.sin(grid), np.cos(grid)], 1)
        times = np.linspace(0, 6, 777)
        found = at(times, "position_m", grid, circle["position_m"], circle)
        errors.append(np.abs(found - np.stack([np.cos(times), np.sin(times)], 1)).max())
        assert 0.5 < cost("position_m", grid, circle["position_m"], circle) / errors[-1] < 2
    assert errors[0] / errors[1] == pytest.approx(16, rel=0.15)
    angle = np.mod(grid * 3, 2 * np.pi)
    assert np.allclose(np.mod(at(times, "pitch_rad", grid, angle) - 3 * times + 1, 2 * np.pi), 1, atol=1e-12)
    assert np.array_equal(at(grid, "position_m", grid, circle["position_m"], circle), circle["position_m"])
