"""Drawn rows: where the craft is, close rows and rows far apart on their orbit, and lines between them."""

from dataclasses import replace

import numpy as np

from sailviz.constants import DAY, ROTATION_EARTH
from sailviz.frames import unit
from sailviz.recording import read, record
from sailviz.recording.drawing import orbit_plane
from sailviz.recording.drawing.samples import Frame, orbits, rings, smooth_lines
from sailviz.recording.timelines import take


def test_smooth_lines_follow_a_circle_to_a_thousandth_of_its_radius():
    angle = np.linspace(0, 2 * np.pi, 13)
    place, pace = (
        np.stack([np.cos(angle), np.sin(angle), 0 * angle], 1),
        np.stack([-np.sin(angle), np.cos(angle), 0 * angle], 1),
    )
    line = smooth_lines(angle, place, pace, 6)
    assert np.abs(np.linalg.norm(line, axis=1) - 1).max() < 1e-3
    assert np.array_equal(line[::6], place)


def column(recording, entity, name):
    """The rows of one component of a picture's entity, and the numbers of the rows."""
    table = recording[entity]
    values = np.asarray(table[name], float)
    return values.reshape(len(values), -1), table.timeline("step")


def turn(quaternion):
    """Angle of a turn about z, rad."""
    return 2 * np.arctan2(quaternion[:, 2], quaternion[:, 3])


def angle_between(a, b):
    return np.abs(np.mod(a - b + np.pi, 2 * np.pi) - np.pi)


def test_a_slowed_orbit_and_the_globe_keep_their_number_of_revolutions_a_day(years, low_orbit):
    run, path = years
    frame = Frame.of(run)
    quaternion, step = column(read(path), "/world/center/globe", "quaternion")
    time = run.time[step]
    ends = (time < 0.39 * time[-1]) | (time > 0.41 * time[-1])
    expected = low_orbit.GREENWICH + ROTATION_EARTH * time / frame.slowed
    assert frame.slowed > 500
    assert angle_between(turn(quaternion), expected)[ends].max() < 1e-5


def test_in_a_dense_window_craft_and_globe_are_where_they_were(years, low_orbit):
    run, path = years
    recording = read(path)
    place, step = column(recording, "/world/craft", "positions")
    quaternion, _ = column(recording, "/world/center/globe", "quaternion")
    gap = np.diff(run.time[step], prepend=-np.inf)
    inside = (gap < 600) & (np.roll(gap, 1) < 600)
    assert inside.sum() > 300
    assert np.abs(place * low_orbit.RADIUS - run.position[step])[inside].max() < 2.0  # m, float32
    truth = run.environment["earth_rotation_rad"][step]
    assert angle_between(turn(quaternion), truth)[inside].max() < 1e-6


def test_outside_it_the_craft_is_drawn_on_the_orbit_of_its_row(years, low_orbit):
    run, path = years
    place, step = column(read(path), "/world/craft", "positions")
    e = take(run, step).elements
    normal = unit(np.cross(run.position, run.velocity))[step]
    distance = np.linalg.norm(place, axis=1) * low_orbit.RADIUS
    assert np.abs(np.sum(place * normal, axis=1)).max() < 1e-6
    assert np.all(distance > e.semi_major_axis * (1 - e.eccentricity) - 2)
    assert np.all(distance < e.semi_major_axis * (1 + e.eccentricity) + 2)


def test_evenly_spaced_rows_that_leap_along_the_orbit_are_all_slowed(runs, tmp_path):
    run = runs.descent(rows=601, days=0.1 * 600 * 5_800 / DAY)  # a tenth of a revolution from row to row
    frame = Frame.of(run)
    assert frame.sparse
    record(run, tmp_path / "run.rrd")
    place, _ = column(read(tmp_path / "run.rrd"), "/world/craft", "positions")
    step = np.arccos(np.clip(np.sum(unit(place[1:]) * unit(place[:-1]), 1), -1, 1))
    assert step.max() < 2 * np.pi * 30 / 600 * 1.05  # 30 revolutions over the run, on a nearly circular orbit


def test_a_ring_is_the_osculating_orbit(runs):
    run = runs.descent(rows=20)
    frame = Frame.of(run)
    placed = rings(run, np.broadcast_to(np.eye(3), (20, 3, 3)), frame)
    circle = np.stack([np.cos(np.linspace(0, 6.2, 50)), np.sin(np.linspace(0, 6.2, 50)), np.zeros(50)], 1)
    line = (
        orbit_plane.turned_by(placed["quaternion"], placed["scale"][:, None] * circle) + placed["translation"][:, None]
    )
    normal = unit(np.cross(run.position, run.velocity))
    assert np.abs(np.einsum("nki,ni->nk", line, normal)).max() < 1e-12
    e = run.elements
    apse = orbits(replace(run, elements=replace(e, true_anomaly=0 * e.true_anomaly)), frame, 3)[:, 0]
    cosine = np.sum(unit(line) * unit(apse)[:, None], -1)
    p = (e.semi_major_axis * (1 - e.eccentricity**2) / frame.unit)[:, None]
    expected = p / (1 + e.eccentricity[:, None] * cosine)  # the polar equation of a conic section
    assert np.abs(np.linalg.norm(line, axis=-1) - expected).max() < 1e-12
