"""Zonal harmonics against the slope of their potential, and heights against the ellipsoid's exact parametrisation."""

from __future__ import annotations

import numpy as np
import pytest

from sailviz.constants import FLATTENING_EARTH, J2_EARTH, J3_EARTH, J4_EARTH, MU_EARTH, RADIUS_EARTH
from sailviz.environment.gravity import geodetic_altitude, gravity, strengths

HARMONICS = {2: J2_EARTH, 3: J3_EARTH, 4: J4_EARTH}


def potential(x, y, z, harmonics):
    r = np.sqrt(x * x + y * y + z * z)
    legendre = (np.polynomial.legendre.Legendre.basis(n)(z / r) * j * (RADIUS_EARTH / r) ** n for n, j in harmonics)
    return MU_EARTH / r * (1 - sum(legendre))


@pytest.mark.parametrize("orders", [(2,), (2, 3), (2, 4), (2, 3, 4)])
@pytest.mark.parametrize("place", [(7e6, 0, 0), (3e6, -2e6, 5.5e6), (1e6, 4e6, -5.9e6), (0, 0, 7.1e6)])
def test_gravity_is_the_slope_of_the_potential(orders, place):
    """Central differences over 100 m, of 4th order; their rounding is 1e-9 m/s2, J3's and J4's share 1e-5 m/s2."""
    harmonics = [(n, HARMONICS[n]) for n in orders]
    found = gravity.py_func(
        *map(float, place), 1 / np.linalg.norm(place), MU_EARTH,
        *strengths(MU_EARTH, RADIUS_EARTH, **{f"j{n}": j for n, j in harmonics}),
    )  # fmt: skip
    point_mass = -MU_EARTH * np.array(place, dtype=float) / np.linalg.norm(place) ** 3
    for axis in range(3):
        step = 100.0 * (np.arange(3) == axis)
        ahead, behind, far, back = (
            potential(*(np.array(place) + k * step), harmonics) - MU_EARTH / np.linalg.norm(np.array(place) + k * step)
            for k in (1, -1, 2, -2)
        )
        slope = (8 * (ahead - behind) - (far - back)) / (12 * 100.0)
        assert found[axis] - point_mass[axis] == pytest.approx(slope, abs=2e-9)


def test_a_sphere_and_j2_alone_need_no_further_arguments():
    place = 3e6, -2e6, 5.5e6, 1 / np.sqrt(9e12 + 4e12 + 30.25e12)
    j2 = strengths(MU_EARTH, RADIUS_EARTH, J2_EARTH)
    assert j2[0] == pytest.approx(1.5 * J2_EARTH * MU_EARTH * RADIUS_EARTH**2)
    assert gravity.py_func(*place, MU_EARTH, j2[0]) == gravity.py_func(*place, MU_EARTH, *j2)
    assert gravity.py_func(*place, MU_EARTH, 0.0) == pytest.approx(
        tuple(-MU_EARTH * c * place[3] ** 3 for c in place[:3]), rel=1e-14
    )


def test_the_pear_shape_pulls_across_the_equator():
    """By hand on the equator: a_z = -mu J3 R^3 / r^5 P_3'(0) with P_3'(0) = -3/2."""
    r = 7e6
    only_j3 = strengths(MU_EARTH, RADIUS_EARTH, 1e-30, J3_EARTH)
    found = gravity.py_func(r, 0.0, 0.0, 1 / r, MU_EARTH, *only_j3)
    assert found[2] == pytest.approx(1.5 * J3_EARTH * MU_EARTH * RADIUS_EARTH**3 / r**5, rel=1e-12)


@pytest.mark.parametrize(("height", "error"), [(0.0, 1e-6), (120e3, 0.01), (700e3, 0.04), (1500e3, 0.06), (4e7, 0.21)])
def test_height_over_the_ellipsoid(height, error):
    """Points made from geodetic latitude and height, which is exact; metres."""
    latitude = np.radians(np.linspace(-90, 90, 721))
    squash = FLATTENING_EARTH * (2 - FLATTENING_EARTH)
    normal = RADIUS_EARTH / np.sqrt(1 - squash * np.sin(latitude) ** 2)
    x, z = (normal + height) * np.cos(latitude), (normal * (1 - squash) + height) * np.sin(latitude)
    assert geodetic_altitude.py_func(z, np.hypot(x, z)) == pytest.approx(height, abs=error)


def test_the_poles_are_21_kilometres_nearer_to_the_centre():
    r = RADIUS_EARTH + 500e3
    assert geodetic_altitude.py_func(0.0, r) == pytest.approx(500e3, abs=1e-6)
    assert geodetic_altitude.py_func(r, r) == pytest.approx(500e3 + RADIUS_EARTH * FLATTENING_EARTH, abs=1e-6)
