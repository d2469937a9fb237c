"""Quaternions of a flight from elsewhere: in either order and direction they are one attitude, recorded as given."""

import numpy as np
import pytest

import sailviz
from sailviz import frames
from sailviz.constants import AU, MU_SUN
from sailviz.run.from_arrays import TrajectoryError, trajectory

N = 25
ANGLE = np.linspace(0, 1.5, N)
TIME = ANGLE * np.sqrt(AU**3 / MU_SUN)
PLACE = AU * np.stack([np.cos(ANGLE), np.sin(ANGLE), 0 * ANGLE], 1)
SPEED = np.sqrt(MU_SUN / AU) * np.stack([-np.sin(ANGLE), np.cos(ANGLE), 0 * ANGLE], 1)
HALF = 0.4 * ANGLE + 2.0
ABOUT = np.array([0.3, 0.5, -0.81]) / np.linalg.norm([0.3, 0.5, -0.81])
Q = np.column_stack([np.sin(HALF)[:, None] * ABOUT, np.cos(HALF)])  # x y z w, body to world


def _run(q=Q, **options):
    return trajectory(TIME, PLACE, SPEED, attitude=q, **options)


@pytest.mark.parametrize(
    ("q", "scalar", "direction"),
    [
        (Q, "last", "body_to_world"),
        (-Q, "last", "body_to_world"),
        (np.roll(Q, 1, axis=1), "first", "body_to_world"),
        (Q * [-1, -1, -1, 1], "last", "world_to_body"),
        (Q * np.where(np.arange(N) % 2, 1, -1)[:, None] * 1.005, "last", "body_to_world"),
    ],
)
def test_one_attitude_in_every_convention(q, scalar, direction):
    run = _run(q, scalar=scalar, direction=direction)
    assert np.abs(np.abs(np.sum(run.attitude.quaternion * Q, axis=1)) - 1).max() < 1e-14
    assert np.all(np.sum(run.attitude.quaternion[1:] * run.attitude.quaternion[:-1], axis=1) > 0)
    v = np.array([0.0, 0.0, 1.0])
    u, w = Q[:, :3], Q[:, 3:]
    turned = v + 2 * w * np.cross(u, v) + 2 * np.cross(u, np.cross(u, v))  # q v q*
    assert np.abs(run.attitude.normal - turned).max() < 1e-14


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"direction": "body_to_world"}, "scalar"),
        ({"scalar": "last"}, "direction"),
        ({"scalar": "last", "direction": "body_to_world", "normal": PLACE}, "leave one of them out"),
        ({"scalar": "last", "direction": "body_to_world", "q": 1.02 * Q}, "length 1.02"),
        ({"scalar": "last", "direction": "body_to_world", "q": Q[:, :3]}, "shape"),
        ({"scalar": "last", "direction": "body_to_world", "q": Q * np.nan}, "attitude"),
    ],
)
def test_what_is_no_attitude_is_refused(options, words):
    with pytest.raises(TrajectoryError, match=words):
        _run(**options)


def test_the_craft_is_drawn_as_its_quaternions_say(tmp_path):
    run = _run(scalar="last", direction="body_to_world")
    sailviz.record(run, tmp_path / "a.rrd")
    recording = sailviz.read(tmp_path / "a.rrd")
    assert np.abs(np.abs(np.sum(recording["/attitude"]["quaternion"] * Q, axis=1)) - 1).max() < 1e-14
    drawn = np.array(recording["/world/craft/body"]["quaternion"])
    assert np.abs(np.abs(np.sum(drawn.reshape(-1, 4)[-N:] * Q, axis=1)) - 1).max() < 1e-6


def test_axes_of_a_quaternion_are_those_of_its_matrix():
    assert np.abs(np.abs(np.sum(frames.quaternion(frames.rotation(Q)) * Q, axis=1)) - 1).max() < 1e-15
