"""Orbital elements: round trips over every class of orbit, published examples, conventions where an angle is lost."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sailviz.constants import AU, MU_EARTH, MU_SUN
from sailviz.elements import apoapsis, elements, mean_semi_major_axis, periapsis, state

ANGLE = st.floats(0, 2 * np.pi)
SMALL = st.sampled_from([0.0, 1e-14, 1e-12, 1e-10, 1e-6, 1e-3])
ELLIPSE = SMALL | st.floats(0, 0.99)
INCLINATION = SMALL | SMALL.map(lambda x: np.pi - x) | st.floats(0, np.pi)


def round_trip_error(*shape):
    """(distance m, speed difference over circular speed) between a state and that of its elements, 1 au."""
    position, velocity = state(*shape, MU_SUN)
    e = elements(position, velocity, MU_SUN)
    again = state(e.semi_major_axis, e.eccentricity, e.inclination, e.raan, e.argument, e.true_anomaly, MU_SUN)
    size = np.linalg.norm(position)
    return (
        np.linalg.norm(again[0] - position) / size * AU,
        np.linalg.norm(again[1] - velocity) / np.sqrt(MU_SUN / size),
    )


# Below 1e-11 rad an inclination has no node: 3 m at 1 au. Near e = 1 the semi-latus rectum a (1 - e^2) loses digits
# as 1 / (1 - e).
@given(ELLIPSE, INCLINATION, ANGLE, ANGLE, ANGLE)
def test_an_ellipse_comes_back_within_ten_metres_at_1_au(e, i, raan, argument, anomaly):
    distance, speed = round_trip_error(AU, e, i, raan, argument, anomaly)
    assert distance < 10
    assert speed < 1e-10


@given(st.floats(1.001, 20), INCLINATION, ANGLE, ANGLE, st.floats(-0.9, 0.9))
def test_a_hyperbola_comes_back_within_ten_metres_at_1_au(e, i, raan, argument, share):
    """share of the way to the asymptote, whose true anomaly is acos(-1/e)."""
    distance, speed = round_trip_error(-AU, e, i, raan, argument, share * np.arccos(-1 / e))
    assert distance < 10
    assert speed < 1e-10


@given(st.floats(0.01, 0.95), st.floats(0.01, 3.13), ANGLE, ANGLE, ANGLE)
def test_elements_come_back_where_every_angle_means_something(e, i, raan, argument, anomaly):
    found = elements(*state(AU, e, i, raan, argument, anomaly, MU_SUN), MU_SUN)
    # e, i of 0.01 magnify the rounding of 1e-16 a hundredfold, e of 0.95 twentyfold
    assert found.semi_major_axis / AU == pytest.approx(1, abs=1e-12)
    assert (found.eccentricity, found.inclination) == pytest.approx((e, i), abs=1e-12)
    for angle, original in ((found.raan, raan), (found.argument, argument), (found.true_anomaly, anomaly)):
        assert abs((angle - original + np.pi) % (2 * np.pi) - np.pi) < 1e-11


def test_a_parabola_has_eccentricity_one_and_an_infinite_axis():
    """r = 2, v = 1 across, mu = 1: the energy is 1/2 - 1/2 = 0."""
    found = elements([2.0, 0, 0], [0, 1.0, 0], 1.0)
    assert (found.eccentricity, found.semi_major_axis, found.true_anomaly) == (1, np.inf, 0)


def test_vallados_example():
    """Vallado, Fundamentals of Astrodynamics, example 2-5: a published state and its elements, km and degrees."""
    r, v = np.array([6524.834, 6862.875, 6448.296]) * 1e3, np.array([4.901327, 5.533756, -1.976341]) * 1e3
    found = elements(r, v, MU_EARTH)
    assert found.semi_major_axis / 1e3 == pytest.approx(36127.343, abs=0.01)
    assert found.eccentricity == pytest.approx(0.832853, abs=1e-6)
    angles = (found.inclination, found.raan, found.argument, found.true_anomaly)
    assert np.degrees(angles) == pytest.approx((87.870, 227.898, 53.38, 92.335), abs=6e-3)


# ---------------------------------------------------------------- conventions
def test_on_an_equatorial_orbit_the_node_is_the_x_axis():
    found = elements([0, AU, 0], [-np.sqrt(MU_SUN / AU) * 1.1, 0, 0], MU_SUN)
    assert (found.raan, found.inclination) == (0, 0)
    assert found.argument == pytest.approx(np.pi / 2, abs=1e-14)
    assert found.true_anomaly == pytest.approx(0, abs=1e-14)


def test_on_a_circular_orbit_the_periapsis_is_the_node():
    found = elements(*state(AU, 0, 0.5, 1.0, 0, 0.7, MU_SUN), MU_SUN)
    assert found.argument == 0
    assert found.true_anomaly == pytest.approx(0.7, abs=1e-14)
    assert found.raan == pytest.approx(1.0, abs=1e-14)


def test_on_a_retrograde_equatorial_circle_the_anomaly_counts_with_the_motion():
    found = elements([0, -AU, 0], [-np.sqrt(MU_SUN / AU), 0, 0], MU_SUN)
    assert (found.inclination, found.raan, found.argument) == (np.pi, 0, 0)
    assert found.true_anomaly == pytest.approx(np.pi / 2, abs=1e-14)


@pytest.mark.parametrize("velocity", [(0, 0, 0), (1e4, 0, 0)])
def test_without_angular_momentum_there_is_no_plane(velocity):
    found = elements([AU, 0, 0], velocity, MU_SUN)
    assert np.isnan([found.inclination, found.raan, found.argument]).all()
    assert found.eccentricity == pytest.approx(1, abs=1e-15)
    assert found.semi_major_axis == pytest.approx(1 / (2 / AU - np.sum(np.square(velocity)) / MU_SUN), rel=1e-14)


def test_angles_lie_between_zero_and_a_turn():
    rng = np.random.default_rng(5)
    found = elements(rng.normal(size=(200, 3)), rng.normal(size=(200, 3)), 1.0)
    for angle in (found.raan, found.argument, found.true_anomaly):
        assert ((angle >= 0) & (angle < 2 * np.pi)).all()
    assert ((found.inclination >= 0) & (found.inclination <= np.pi)).all()
    assert np.array_equal(found.semi_major_axis > 0, found.eccentricity < 1)


def test_vis_viva_and_areal_velocity():
    position, velocity = state(1.3, 0.4, 0.5, 1.0, 2.0, np.linspace(0, 6, 50), 2.0)
    r = np.linalg.norm(position, axis=1)
    assert np.sum(velocity**2, axis=1) == pytest.approx(2.0 * (2 / r - 1 / 1.3), rel=1e-13)
    h = np.linalg.norm(np.cross(position, velocity), axis=1)
    assert h == pytest.approx(np.full(50, np.sqrt(2.0 * 1.3 * (1 - 0.16))), rel=1e-13)
    assert np.cross(position, velocity)[:, 2] / h == pytest.approx(np.full(50, np.cos(0.5)), abs=1e-13)


def test_an_open_orbit_has_a_periapsis_and_neither_apoapsis_nor_mean_and_warns_of_nothing():
    """At 7,000 km the escape speed is 10.67 km/s: an ellipse, a hyperbola, and a fall along a line."""
    mu = 3.986004418e14
    position = np.full((3, 3), 1.0) * [7e6, 0, 0]
    velocity = np.array([[0, 9e3, 0], [0, 12e3, 0], [1e3, 0, 0]])
    with np.errstate(all="raise"):
        mean = mean_semi_major_axis(position, velocity, mu, 1.08e-3 * 6.378e6**2)
        orbits = elements(position[:2], velocity[:2], mu)
        far, near = apoapsis(orbits), periapsis(orbits)
    assert np.isfinite(mean).tolist() == [True, False, False]
    assert near == pytest.approx([7e6, 7e6], rel=1e-12)
    assert far[0] == pytest.approx(7e6 * (1 + orbits.eccentricity[0]) / (1 - orbits.eccentricity[0]), rel=1e-12)
    assert np.isnan(far[1])
