"""Attitude laws: which way the normal points, seen through what the propagator observes."""

from __future__ import annotations

import numpy as np
import pytest

from sailviz import frames
from sailviz.propagate import dynamics
from sailviz.steering import attitude

RNG = np.random.default_rng(11)
STATES = np.concatenate([RNG.normal(size=(6, 40)), np.ones((1, 40))])
POSITION, VELOCITY = STATES[:3].T, STATES[3:6].T


def normals(steering, parameters=(), times=None, states=STATES, **more):
    """Normal (n, 3) that a law asks for at states (7, n)."""
    model = dynamics.model(1.0, steering=steering, steering_parameters=parameters, **more)
    n = states.shape[1]
    times = np.zeros(n) if times is None else np.asarray(times, dtype=float)
    return dynamics.observe(times, np.ascontiguousarray(states), np.ones(n), model)[0]


def test_sun_facing_is_along_the_position():
    assert normals(attitude.RADIAL) == pytest.approx(frames.unit(POSITION), abs=1e-15)


@pytest.mark.parametrize(("clock", "axis", "sign"), [(0, 2, 1), (90, 1, 1), (180, 2, -1), (270, 1, -1)])
def test_orbital_clock_runs_from_the_orbit_normal_towards_the_motion(clock, axis, sign):
    """0 deg along h_hat, 90 along t_hat, 180 against h_hat, 270 against t_hat."""
    found = normals(attitude.ORBITAL, attitude.direction_parameters(np.pi / 2, np.radians(clock)))
    assert found == pytest.approx(sign * frames.rtn(POSITION, VELOCITY)[:, :, axis], abs=1e-13)


@pytest.mark.parametrize(("pitch", "clock"), [(0.3, 0.7), (1.2, 4.0), (2.0, 2.5)])
def test_orbital_law_keeps_pitch_and_clock_everywhere(pitch, clock):
    found = normals(attitude.ORBITAL, attitude.direction_parameters(pitch, clock))
    angles = frames.pitch_cone_clock(frames.rtn(POSITION, VELOCITY), found, found)
    assert np.allclose(np.transpose(angles), [pitch, pitch, clock], atol=1e-12)


def test_meridian_law_leans_towards_the_pole_in_the_meridian_plane():
    """Clock 0: no component along longitude, towards the pole; clock 90 deg: along increasing longitude."""
    r_hat = frames.unit(POSITION)
    east = frames.unit(np.cross([0, 0, 1.0], r_hat))
    north = np.cross(r_hat, east)
    assert (north[:, 2] > 0).all()
    up = normals(attitude.MERIDIAN, attitude.direction_parameters(0.4, 0.0))
    assert up == pytest.approx(np.cos(0.4) * r_hat + np.sin(0.4) * north, abs=1e-13)
    across = normals(attitude.MERIDIAN, attitude.direction_parameters(0.4, np.pi / 2))
    assert across == pytest.approx(np.cos(0.4) * r_hat + np.sin(0.4) * east, abs=1e-13)


def test_circumferential_and_tangential_thrust_point_along_the_motion():
    across = normals(attitude.TRANSVERSE)
    assert across == pytest.approx(frames.rtn(POSITION, VELOCITY)[:, :, 1], abs=1e-13)
    assert normals(attitude.TANGENTIAL) == pytest.approx(frames.unit(VELOCITY), abs=1e-15)


def test_inertial_direction_is_fixed_in_space():
    assert normals(attitude.INERTIAL, (0.6, 0.0, 0.8)) == pytest.approx(np.tile([0.6, 0, 0.8], (40, 1)), abs=0)


def test_every_law_gives_unit_vectors():
    for steering in (attitude.ORBITAL, attitude.MERIDIAN):
        found = normals(steering, attitude.direction_parameters(1.1, 2.2))
        assert np.linalg.norm(found, axis=1) == pytest.approx(np.ones(40), abs=1e-13)


# ---------------------------------------------------------------- tables
TIMES, PITCH, CLOCK = np.array([0.0, 2.0, 3.0, 7.0]), np.array([0.4, 0.5, 0.55, 0.9]), np.array([1.0, 1.5, 1.6, 2.5])


def read_table(times, interpolation, frame=attitude.TABLE_ORBITAL, throttle=None):
    """Pitch and clock (2, n) of the normal at times."""
    n = len(times)
    states = np.tile(np.array([1.0, 0.2, 0.3, -0.1, 0.9, 0.4, 1.0])[:, None], (1, n))
    rows = attitude.table(TIMES, PITCH, CLOCK, throttle, interpolation)
    found = normals(frame, times=times, states=states, table=rows, interpolation=attitude.INTERPOLATIONS[interpolation])
    pitch, _, clock = frames.pitch_cone_clock(frames.rtn(states[:3].T, states[3:6].T), found, found)
    return np.array([pitch, clock])


def test_linear_table_runs_straight_between_rows_and_stops_at_its_ends():
    times = np.array([-5, 0, 0.5, 2, 2.25, 3, 6.9, 7, 100])
    expected = [np.interp(times, TIMES, column) for column in (PITCH, CLOCK)]
    assert read_table(times, "linear") == pytest.approx(np.array(expected), abs=1e-13)


def test_held_table_keeps_each_row_until_the_next():
    times = np.array([-1, 0, 1.9999, 2, 2.5, 3, 6.9999, 7, 50])
    rows = [0, 0, 0, 1, 1, 2, 2, 3, 3]
    assert read_table(times, "hold") == pytest.approx(np.array([PITCH[rows], CLOCK[rows]]), abs=1e-13)


def test_cubic_table_reproduces_a_cubic():
    """A not-a-knot spline through four rows is the one cubic through them."""
    times = np.linspace(0, 7, 29)
    expected = [np.polyval(np.polyfit(TIMES, column, 3), times) for column in (PITCH, CLOCK)]
    assert read_table(times, "cubic") == pytest.approx(np.array(expected), abs=1e-12)


def test_a_table_in_the_meridian_frame_is_read_in_that_frame():
    rows = attitude.table([0, 1], [0.4, 0.4], [0.0, 0.0])
    found = normals(attitude.TABLE_MERIDIAN, table=rows, interpolation=attitude.LINEAR)
    assert found == pytest.approx(normals(attitude.MERIDIAN, attitude.direction_parameters(0.4, 0.0)), abs=1e-15)


def test_throttle_scales_the_thrust():
    """Half thrust at half time of a table from nothing to full."""
    rows = attitude.table([0, 10], [0.4, 0.4], [1.0, 1.0], [0.0, 1.0])
    model = dynamics.model(
        1.0, device=dynamics.THRUSTER, device_parameters=(0.2, 0, 0), steering=attitude.TABLE_ORBITAL, table=rows
    )
    times = np.array([0.0, 5.0, 10.0, 20.0])
    _, acceleration, _ = dynamics.observe(times, np.ascontiguousarray(STATES[:, :4]), np.ones(4), model)
    assert np.linalg.norm(acceleration, axis=1) == pytest.approx([0, 0.1, 0.2, 0.2], abs=1e-15)
