"""Frames and rotations: round trips, handedness, and angles as the thesis defines them."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from sailviz import frames

COORDINATE = st.floats(-1, 1)
VECTOR = st.tuples(COORDINATE, COORDINATE, COORDINATE).map(np.array)


def rotation(q):
    """Rotation matrix of a unit quaternion (x, y, z, w), by its definition v' = q v q*."""
    x, y, z, w = q
    skew = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + 2 * w * skew + 2 * skew @ skew


@given(VECTOR, VECTOR)
def test_orbital_frame_is_right_handed_and_follows_position_and_motion(position, velocity):
    h = np.cross(position, velocity)
    assume(np.linalg.norm(h) > 1e-6)
    r_hat, t_hat, h_hat = frames.rtn(position, velocity).T
    assert np.abs(frames.rtn(position, velocity).T @ frames.rtn(position, velocity) - np.eye(3)).max() < 1e-14
    assert np.cross(r_hat, t_hat) == pytest.approx(h_hat, abs=1e-14)
    assert r_hat @ position == pytest.approx(np.linalg.norm(position), rel=1e-14)
    assert h_hat @ h == pytest.approx(np.linalg.norm(h), rel=1e-9)
    assert t_hat @ velocity > 0


@pytest.mark.parametrize("velocity", [(0, 0, 0), (2, 0, 0), (-3, 0, 0)])
def test_without_an_orbit_plane_the_frame_is_that_of_longitude_and_pole(velocity):
    """A craft at rest, or on a radial line, on the x axis: t_hat = y, h_hat = z."""
    assert frames.rtn((2, 0, 0), velocity) == pytest.approx(np.eye(3), abs=1e-15)


def test_on_the_pole_without_a_plane_there_still_is_a_frame():
    axes = frames.rtn((0, 0, 3.0), (0, 0, 0))
    assert axes.T @ axes == pytest.approx(np.eye(3), abs=1e-15)
    assert np.linalg.det(axes) == pytest.approx(1, abs=1e-15)


def test_frame_of_a_nearly_radial_motion_is_orthonormal():
    """Position and velocity 1e-5 rad apart: eleven digits of h are left, its direction is made perpendicular again."""
    axes = frames.rtn((-1.0, -0.99999, 1.0), (-0.99999, -1.0, 1.0))
    assert axes.T @ axes == pytest.approx(np.eye(3), abs=1e-15)


@given(VECTOR, VECTOR, VECTOR)
def test_to_a_frame_and_back_is_where_it_began(position, velocity, vector):
    axes = frames.rtn(position, velocity)
    assume(np.linalg.norm(position) > 1e-6)
    assert frames.from_frame(axes, frames.to_frame(axes, vector)) == pytest.approx(vector, abs=1e-14)


@given(st.tuples(COORDINATE, COORDINATE, COORDINATE, COORDINATE).map(np.array))
def test_quaternion_of_a_rotation_is_the_one_it_was_made_of(q):
    assume(np.linalg.norm(q) > 1e-3)
    q = q / np.linalg.norm(q)
    found = frames.quaternion(rotation(q))
    assert found[3] >= 0
    assert min(np.abs(found - q).max(), np.abs(found + q).max()) < 1e-14


@pytest.mark.parametrize("axis", range(3))
def test_half_turns_have_a_quaternion(axis):
    """Where w = 0 the textbook formula divides by zero."""
    q = np.eye(4)[axis]
    assert np.abs(frames.quaternion(rotation(q))) == pytest.approx(q, abs=1e-15)


@given(VECTOR, VECTOR)
def test_sail_stands_on_its_normal_with_its_edge_along_the_hint(normal, hint):
    assume(np.linalg.norm(normal) > 1e-3)
    x, y, z = frames.body_axes(normal, hint).T
    assert z == pytest.approx(normal / np.linalg.norm(normal), abs=1e-14)
    assert np.cross(x, y) == pytest.approx(z, abs=1e-13)
    assert np.linalg.norm(x) == pytest.approx(1, abs=1e-13)
    flat = hint - hint @ z * z
    if np.linalg.norm(flat) > 1e-6:
        assert x @ flat == pytest.approx(np.linalg.norm(flat), rel=1e-9)


@given(st.floats(0.001, np.pi - 0.001), st.floats(0.001, 2 * np.pi - 0.001), st.floats(0, 1.5), VECTOR, VECTOR)
def test_pitch_cone_and_clock_are_those_of_the_vectors(pitch, clock, cone, position, velocity):
    """(3.6)-(3.8): n = cos(a) r + sin(a) (sin(d) t + cos(d) h)."""
    assume(np.linalg.norm(np.cross(position, velocity)) > 1e-6)
    axes = frames.rtn(position, velocity)

    def leaning(angle):
        return axes @ [np.cos(angle), np.sin(angle) * np.sin(clock), np.sin(angle) * np.cos(clock)]

    found = frames.pitch_cone_clock(axes, leaning(pitch), 3e-3 * leaning(cone))
    assert found == pytest.approx((pitch, cone, clock), abs=1e-11)


def test_clock_counts_from_the_orbit_normal_towards_the_motion():
    axes = np.eye(3)
    for clock, direction in ((0, (0, 0, 1)), (np.pi / 2, (0, 1, 0)), (np.pi, (0, 0, -1)), (1.5 * np.pi, (0, -1, 0))):
        assert frames.pitch_cone_clock(axes, direction, (1, 0, 0)) == pytest.approx((np.pi / 2, 0, clock), abs=1e-15)
    assert frames.pitch_cone_clock(axes, (1, 0, 0), (0, 0, 0)) == (0, 0, 0)


def test_unit_vectors_leave_zero_at_zero():
    assert np.array_equal(frames.unit([[3, 4, 0], [0, 0, 0]]), [[0.6, 0.8, 0], [0, 0, 0]])


def test_one_vector_or_many_give_the_same():
    rng = np.random.default_rng(3)
    r, v, a = rng.normal(size=(3, 5, 3))
    axes = frames.rtn(r, v)
    assert axes.shape == (5, 3, 3)
    for i in range(5):
        assert np.array_equal(frames.rtn(r[i], v[i]), axes[i])
        assert np.array_equal(frames.to_frame(axes, a)[i], frames.to_frame(axes[i], a[i]))
        assert np.array_equal(frames.quaternion(axes)[i], frames.quaternion(axes[i]))


def test_the_frame_of_the_equator_of_march_2026():
    """From the angles of IAU 2006 by hand; 1e-9 of them passes in a minute."""
    found = frames.icrf_to("equator-of-date", frames.centuries_since_j2000(np.datetime64("2026-03-20", "ns")))
    assert found[0] == pytest.approx((0.9999795756380, -0.0058618752719, -0.0025469050030), abs=1e-9)
    assert found[2] == pytest.approx((0.0025469048131, -0.0000074972969, 0.9999967566046), abs=1e-9)


def test_the_obliquity_is_that_of_erfa():
    erfa = pytest.importorskip("erfa")
    for centuries in (-0.5, 0.2626, 0.5):
        found = float(frames.obliquity_of_date(centuries))
        assert found == pytest.approx(erfa.obl06(2_451_545.0, centuries * 36_525), abs=1e-6 / 206_265)


@pytest.mark.parametrize("frame", frames.FRAMES)
def test_every_frame_keeps_lengths_and_handedness(frame):
    axes = frames.icrf_to(frame, 0.3)
    assert axes @ axes.T == pytest.approx(np.eye(3), abs=1e-15)
    assert np.linalg.det(axes) == pytest.approx(1.0)


def test_the_pole_of_the_ecliptic_leans_over_the_equator():
    pole = frames.icrf_to("ecliptic-j2000").T @ [0.0, 0.0, 1.0]
    assert np.degrees(np.arccos(pole[2])) == pytest.approx(84_381.448 / 3600, abs=1e-12)
    assert pole[1] < 0
    equinox = frames.ecliptic_of_date_to_icrf(0.0) @ [0.0, 0.0, 1.0]
    assert equinox == pytest.approx(pole, abs=3e-7)  # IAU 1976 and 2006 differ by 0.042 arcsec


def test_a_frame_that_nobody_knows_is_refused():
    with pytest.raises(ValueError, match="ecliptic-j2000, icrf, equator-of-date"):
        frames.icrf_to("icrs")
