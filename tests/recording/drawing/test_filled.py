"""Between rows far apart the craft goes along its way: against Kepler's and SciPy's flights; and no point is a row."""

import numpy as np
import pytest

import sailviz
from sailviz import frames
from sailviz.constants import AU
from sailviz.recording.comparison.digest import digest_by_entity
from sailviz.run.filling import points_between
from sailviz.run.from_arrays import trajectory
from tests.recording.drawing.test_ways import flown

START = [AU, 0, 0, 1e3, 33e3, 4e3]
HALF = 0.02 * np.arange(15)
TURNED = np.column_stack([np.sin(HALF), 0 * HALF, 0 * HALF, np.cos(HALF)])  # about x


def coast(rows=15, **options):
    run, truth = flown(700, rows, START)
    return trajectory(run.time, run.position, run.velocity, epoch="2031-04-01", **options), truth


@pytest.fixture(scope="module")
def recorded(tmp_path_factory):
    """A coast of fifteen rows in a turn and a half, with an attitude that turns, and its recording."""
    run, truth = coast(attitude=TURNED, scalar="last", direction="body_to_world")
    path = tmp_path_factory.mktemp("filled") / "a.rrd"
    sailviz.record(run, path)
    return run, truth, sailviz.read(path)


@pytest.mark.parametrize("rows", [5, 9, 15, 40])
def test_points_of_a_coast_lie_on_the_conic(rows):
    run, truth = coast(rows)
    points = points_between(run)
    assert len(points.row) >= 30
    assert points.coast.all()
    assert not len(points.unknown)
    assert np.linalg.norm(points.position - truth(points.time), axis=1).max() < 1e-7 * AU
    h = 1.0
    speed = (truth(points.time + h) - truth(points.time - h)) / (2 * h)
    assert np.abs(points.velocity - speed).max() < 0.05  # m/s, of 33 km/s
    assert np.all((points.time > run.time[points.row]) & (points.time < run.time[points.row + 1]))
    out = np.concatenate([frames.unit(run.position), frames.unit(points.position)])
    out = out[np.argsort(np.concatenate([run.time, points.time]))]
    assert np.degrees(np.arccos(np.sum(out[1:] * out[:-1], axis=1).min())) < 8


def test_points_under_thrust_are_true_to_a_thousandth_of_the_distance():
    run, truth = flown(500, 9, [AU, 0, 0, 0, 29.8e3, 0], push=1.2e-4)
    points = points_between(run)
    assert not points.coast.any()
    assert np.linalg.norm(points.position - truth(points.time), axis=1).max() < 1e-3 * AU


def test_where_nothing_leads_from_row_to_row_nothing_is_filled_and_it_is_dashed_and_said(tmp_path):
    run, _ = flown(700, 15, START)
    leaping = run.position * np.where(np.arange(15) > 6, -1, 1)[:, None]
    leap = trajectory(run.time, leaping, run.velocity * np.where(np.arange(15) > 6, -1, 1)[:, None])
    points = points_between(leap)
    assert points.unknown.tolist() == [6]
    assert 6 not in points.row
    told = sailviz.record(leap, tmp_path / "a.rrd").remarks
    assert any("once no way is known to the next row, and it is dashed" in line for line in told)
    assert "/world/trail/unknown" in sailviz.read(tmp_path / "a.rrd").entities


def test_nothing_is_filled_over_a_gap_or_a_jump():
    run, _ = flown(700, 15, START)
    gap = trajectory(run.time, run.position, run.velocity, gaps=[(run.time[3], run.time[4])])
    assert 3 not in points_between(gap).row
    twice = np.insert(np.arange(15), 7, 7)
    speed = run.velocity[twice].copy()
    speed[7] += 1.0
    jump = trajectory(run.time[twice], run.position[twice], speed)
    assert 7 not in points_between(jump).row


def test_points_are_no_rows(recorded):
    run, _, recording = recorded
    filled = recording["/filled"]
    assert len(filled["time_s"]) > 60
    assert filled["coast"].all()
    assert recording["/scene"]["rows"][0] == len(recording["/state"]["time_s"]) == len(run) == 15
    assert np.array_equal(recording["/state"]["position_m"], run.position)
    assert sailviz.compare(run, recording).equal
    assert "/filled" not in digest_by_entity(recording)
    speeds = recording["/plots/speed"]
    assert len(speeds.timeline("step")) == 15


def between(recording, entity, component):
    """Times (m,) s and values (m, k) of what stands between rows, which has no step."""
    found = []
    for chunk in recording.chunks(entity):
        batch = chunk.to_record_batch()
        if chunk.is_static or "step" in batch.schema.names:
            continue
        ns = batch["sim_time"].cast("int64").to_numpy()
        found += zip(ns * 1e-9, (value[0] for value in batch[component].to_pylist()), strict=True)
    return np.array([time for time, _ in found]), np.array([value for _, value in found])


def test_the_craft_goes_along_the_points_and_turns_evenly(recorded):
    run, truth, recording = recorded
    time, place = between(recording, "/world/craft", "Transform3D:translation")
    assert np.abs(time - recording["/filled"]["time_s"]).max() < 1e-6
    assert np.linalg.norm(place - truth(time) / AU, axis=1).max() < 1e-6
    time, q = between(recording, "/world/craft/body", "Transform3D:quaternion")
    half = np.interp(time, run.time, HALF)
    wanted = np.column_stack([np.sin(half), 0 * half, 0 * half, np.cos(half)])
    assert np.abs(np.abs(np.sum(q * wanted, axis=1)) - 1).max() < 1e-6


def test_rows_close_to_one_another_and_flights_of_scenes_are_not_filled(tmp_path):
    run, _ = flown(365.25, 200, [AU, 0, 0, 0, 30e3, 0])
    sailviz.record(run, tmp_path / "a.rrd")
    assert "/filled" not in sailviz.read(tmp_path / "a.rrd")
    scene = sailviz.load_scene("spirals/logarithmic").with_values({"propagation.outputs": 20, "expect": []})
    sailviz.record(sailviz.simulate(scene), tmp_path / "b.rrd")
    assert "/filled" not in sailviz.read(tmp_path / "b.rrd")
