"""The dipole against the whole IGRF-14, and its use for the magnetic knob."""

from __future__ import annotations

import numpy as np
import pytest

from sailviz.environment.magnetic import alignment, field

R = 7_078_137.0  # m, 700 km
# nT along x (0 E on the equator), y (90 E), z (north): all 195 coefficients of IGRF-14 for 2025, summed independently
IGRF = {
    (R, 0, 0): (9326.49, -1601.40, 19692.55),
    (0, R, 0): (1034.73, 8633.55, 28368.33),
    (0, 0, -R): (8805.13, -6273.40, -37592.63),
    (-R / 2**0.5, 0, R / 2**0.5): (32616.34, -1195.56, -8079.43),
}


def dipole(place, greenwich=0.0):
    return np.array(field.py_func(*map(float, place), 1 / np.linalg.norm(place), greenwich))


@pytest.mark.parametrize("place", IGRF)
def test_the_direction_is_the_fields_to_within_the_rest_of_it(place):
    """34 deg at the worst, which is near the first place."""
    b, whole = dipole(place), np.array(IGRF[place])
    cosine = b @ whole / np.linalg.norm(b) / np.linalg.norm(whole)
    assert np.degrees(np.arccos(cosine)) < (34 if place[0] > 0 else 15)
    assert np.linalg.norm(b) / np.linalg.norm(whole) * 1e9 == pytest.approx(1.0, abs=0.35)


def test_the_field_points_north_over_the_equator_and_down_at_the_north_pole():
    assert dipole((R, 0, 0))[2] > 2e-5
    assert dipole((0, 0, R))[2] < -4e-5
    assert dipole((0, 0, -R))[2] < -4e-5


def test_the_field_turns_with_the_planet():
    turned = dipole((0, R, 0), np.pi / 2)
    x, y, z = dipole((R, 0, 0), 0.0)
    assert turned == pytest.approx((-y, x, z), rel=1e-12)


def test_the_dipole_falls_with_the_cube_of_the_distance_and_is_twice_as_strong_at_its_pole():
    axis = np.array([-1410.3, 4545.5, -29350.0])
    axis /= np.linalg.norm(axis)
    across = np.cross(axis, [1.0, 0, 0])
    pole, equator = dipole(R * axis), dipole(R * across / np.linalg.norm(across))
    assert np.linalg.norm(pole) == pytest.approx(2 * np.linalg.norm(equator), rel=1e-12)
    assert dipole(2 * R * axis) == pytest.approx(pole / 8, rel=1e-12)


def test_a_vertical_tether_is_along_the_field_at_the_magnetic_pole_and_across_it_on_the_magnetic_equator():
    axis = np.array([-1410.3, 4545.5, -29350.0])
    axis /= np.linalg.norm(axis)
    across = np.cross(axis, [0.0, 0, 1])
    across /= np.linalg.norm(across)
    assert alignment.py_func(*(R * axis), 1 / R, 0.0, *axis) == pytest.approx(1, abs=1e-12)
    assert alignment.py_func(*(R * across), 1 / R, 0.0, *across) == pytest.approx(0, abs=1e-12)
    assert alignment.py_func(*(R * across), 1 / R, 0.0, *axis) == pytest.approx(1, abs=1e-12)
