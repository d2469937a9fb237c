"""Where views look from."""

import numpy as np
import pytest

from sailviz.recording.drawing import cameras


def test_a_fixed_eye_sees_the_sunlit_side_of_a_film_at_a_slant():
    normal = np.array([[np.cos(0.6), np.sin(0.6), 0.0]])
    eye = cameras.fixed_eye(normal, normal, np.ones(1), True, (20, 28, 36))
    assert 0.1 < -(eye @ normal[0]) < 0.9
    assert np.linalg.norm(eye) == pytest.approx(1)


def test_a_wheel_is_never_seen_edge_on():
    normal = np.array([[1.0, 0.0, 0.0]])
    eye = cameras.fixed_eye(normal, normal, np.ones(1), False, (20, 28, 36))
    assert abs(eye @ normal[0]) > 0.25


def test_a_globe_is_seen_from_its_day_side():
    sun = np.array([0.0, 1.0, 0.0])
    eye = cameras.over_planet(np.array([0.6, 0.0, 0.8]), sun)
    assert eye @ sun > 0.4
