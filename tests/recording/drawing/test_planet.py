"""The planet in the centre turns as it does."""

import numpy as np

from sailviz.recording import read, record


def column(recording, entity, name):
    """The rows of one component of a picture's entity, and the numbers of the rows."""
    table = recording[entity]
    return np.asarray(table[name], float), table.timeline("step")


def turn(quaternion):
    """Angle of a turn about z, rad."""
    return 2 * np.arctan2(quaternion[:, 2], quaternion[:, 3])


def angle_between(a, b):
    return np.abs(np.mod(a - b + np.pi, 2 * np.pi) - np.pi)


def test_the_globe_turns_by_the_rotation_of_the_earth(runs, tmp_path, low_orbit):
    run = low_orbit.with_everything(runs.descent(rows=300, days=1.0))
    record(run, tmp_path / "day.rrd")
    quaternion, step = column(read(tmp_path / "day.rrd"), "/world/center/globe", "quaternion")
    assert np.array_equal(step, np.arange(300))
    assert np.abs(quaternion[:, :2]).max() == 0
    assert angle_between(turn(quaternion), run.environment["earth_rotation_rad"]).max() < 1e-6  # float32
