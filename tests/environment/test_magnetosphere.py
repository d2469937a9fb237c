"""The Earth's magnetopause of J.-H. Shue et al. (1998), by its closed formula."""

from __future__ import annotations

import numpy as np
import pytest

from sailviz.constants import AU, RADIUS_GEOMAGNETIC
from sailviz.environment.magnetosphere import SPHERE, Parameters, outside, shue


@pytest.mark.parametrize(
    ("pressure", "field", "radii"),
    [(2e-9, 0.0, (10.251873, 15.427840, 23.217051)), (5e-9, -5e-9, (8.535098, 13.289022, 20.690811))],
)
def test_the_magnetopause_is_where_the_formula_has_it(pressure, field, radii):
    """Towards the Sun, 90 and 120 deg from there, in radii of 6,371.2 km; out of the plane too."""
    found = shue(pressure, field)
    for angle, radius in zip((0.0, 90.0, 120.0), radii, strict=True):
        for clock in (0.0, 2.1):
            c, s = np.cos(np.radians(angle)), np.sin(np.radians(angle))
            place = radius * RADIUS_GEOMAGNETIC * np.array([c, s * np.cos(clock), s * np.sin(clock)])
            distance = outside.py_func(*place, AU, 0.0, 0.0, found)
            assert distance / RADIUS_GEOMAGNETIC == pytest.approx(0.0, abs=6e-7)


def test_the_tail_is_open_and_a_sphere_is_closed():
    assert outside.py_func(-1e10, 0.0, 0.0, AU, 0.0, 0.0, shue()) < 0.0
    assert outside.py_func(-1e10, 0.0, 0.0, AU, 0.0, 0.0, Parameters(SPHERE, -1, 1e8)) == pytest.approx(9.9e9)
