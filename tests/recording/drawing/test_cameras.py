"""Where views look from."""

import numpy as np
import pytest

from sailviz.recording.drawing import cameras


def test_the_close_up_sees_the_sunlit_side_of_a_film():
    normal = np.array([np.cos(0.6), np.sin(0.6), 0.0])
    eye = cameras.apart([[1.0, 0, 0], [0, 1.0, 0], normal], facing=normal)
    assert eye @ normal < -0.1
    assert np.linalg.norm(eye) == pytest.approx(1)
