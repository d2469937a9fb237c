"""The singular throttle: the check number of its derivation in polar form."""

from __future__ import annotations

import numpy as np
import pytest

from sailviz.design.minimum_time.state_costate import OWN, canonical_sail
from sailviz.steering.singular import switching_rates


def test_throttle_of_the_final_model_is_that_of_the_planar_form():
    """r 2, u 0.15, v 0.65, 1 mm/s2, entered with lam_r = P (5 s v / 4 + u / 3) / r: -1.5862973413 by two forms of the
    reference. No flight may have it, but no other sign or factor gives it."""
    sail, r, u, v = canonical_sail("electric-sail", 1e-3), 2.0, 0.15, 0.65
    c, s = -1 / 3, np.sqrt(8) / 3
    q = (5 * s * v / 4 + u / 3) / r, (c * v - s * u) / r
    a_c = sail.parameters[OWN]
    first, drift, gain = switching_rates.py_func(
        r, 0.0, 0.0, u, v, 0.0, c, s, 0.0, *q, 0.0, r, 1.0, 1.0, c, a_c / r, 1.0, c, s, 0.25 * (3 + c), 0.25 * s
    )
    assert first == pytest.approx(0.0, abs=1e-15)
    assert -drift / gain == pytest.approx(-1.5862973413, abs=2e-10)
    assert gain == pytest.approx(4 / 9 * a_c / r**2, rel=1e-12)  # a third of 16 A P / (3 r^2), A = a_c / 4
