"""The electric sail's four thrust models: values by hand, limits and symmetries."""

from __future__ import annotations

import numpy as np
import pytest

from sailviz.constants import AU
from sailviz.propulsion.electric_sail import (
    CONE_MAX,
    MODELS,
    PITCH_AT_CONE_MAX,
    acceleration,
    characteristic_acceleration,
    cone_angle,
    dimensionless_acceleration,
    pitch_angle,
)

DEG = np.pi / 180


def pitched(pitch, radius=AU):
    """Position on the x axis and a normal leaning by the pitch towards y."""
    return np.array([radius, 0, 0]), np.array([np.cos(pitch), np.sin(pitch), 0])


def size_and_cone(pitch_deg, model):
    """|a| / a_c at 1 au, and the cone angle in deg."""
    a = acceleration(*pitched(pitch_deg * DEG), 1.0, model)
    return np.linalg.norm(a), np.degrees(np.arctan2(a[1], a[0]))


def test_final_model_at_60_degrees_by_hand():
    """(3.39): a_c/2 [r_hat + cos(60) n_hat] = a_c (5/8, sqrt(3)/8)."""
    assert acceleration(*pitched(60 * DEG), 2e-3) == pytest.approx([1.25e-3, 2e-3 * np.sqrt(3) / 8, 0], abs=1e-18)


def test_original_model_by_hand():
    """(3.33): 64 times closer than 1 au the thrust is 64^(7/6) = 128 a_c, at half the pitch angle."""
    found = acceleration(*pitched(40 * DEG, AU / 64), 1e-3, "original")
    assert found == pytest.approx(0.128 * np.array([np.cos(20 * DEG), np.sin(20 * DEG), 0]), rel=1e-13, abs=1e-18)


def test_updated_model_by_hand():
    """(3.35): the same with exponent 1."""
    found = acceleration(*pitched(40 * DEG, AU / 64), 1e-3, "updated")
    assert found == pytest.approx(0.064 * np.array([np.cos(20 * DEG), np.sin(20 * DEG), 0]), rel=1e-13, abs=1e-18)


# (3.36)-(3.38) summed by hand, e.g. at 20 deg: phi = 9.706 + 1.4608 - 2.1288 + 1.01152 - 0.26544 + 0.0235584 deg,
# gamma = 1 + 0.0013808 - 0.05084 + 0.0056216 - 0.0020176 + 0.00062176 - 0.0000377344
@pytest.mark.parametrize(
    ("pitch", "cone", "gamma"),
    [(10, 5.0073931, 0.9885758404), (20, 9.8076384, 0.9547288256), (0, 0, 1)],
)
def test_polynomial_model_by_hand(pitch, cone, gamma):
    assert size_and_cone(pitch, "polynomial") == pytest.approx((gamma, cone), abs=1e-9)


@pytest.mark.parametrize(("model", "exponent"), [("final", 1), ("updated", 1), ("polynomial", 1), ("original", 7 / 6)])
def test_thrust_weakens_with_distance(model, exponent):
    near, far = (acceleration(*pitched(0.5, r * AU), 1e-3, model) for r in (0.7, 1.4))
    assert near / 2**exponent == pytest.approx(far, rel=1e-13)


@pytest.mark.parametrize("model", sorted(MODELS))
def test_characteristic_acceleration_is_what_the_sail_feels_at_1_au_facing_the_sun(model):
    assert acceleration([AU, 0, 0], [1, 0, 0], 1e-3, model) == pytest.approx([1e-3, 0, 0], rel=1e-14)


@pytest.mark.parametrize("model", sorted(MODELS))
def test_the_sail_plane_has_no_front(model):
    rng = np.random.default_rng(2)
    position, normal = rng.normal(size=(50, 3)) * AU, rng.normal(size=(50, 3))
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    front = acceleration(position, normal, 1e-3, model)
    assert np.array_equal(front, acceleration(position, -normal, 1e-3, model), equal_nan=True)
    assert np.isnan(front).any() == (model in ("original", "updated"))  # half of the attitudes lie beyond 60 deg


@pytest.mark.parametrize("model", sorted(MODELS))
def test_thrust_lies_between_sun_line_and_normal(model):
    for pitch in (1, 20, 50, -30):
        a = acceleration(*pitched(pitch * DEG), 1.0, model)
        assert a[2] == 0
        assert 0 < np.arctan2(a[1], a[0]) / (pitch * DEG) < 1


@pytest.mark.parametrize("model", ["original", "updated"])
def test_beyond_their_pitch_limit_the_early_models_say_nothing(model):
    assert np.isfinite(acceleration(*pitched(60 * DEG), 1e-3, model)).all()
    assert np.isnan(acceleration(*pitched(60.001 * DEG), 1e-3, model)).all()
    assert np.isfinite(acceleration(*pitched(60.001 * DEG), 1e-3, model, pitch_limit=70 * DEG)).all()
    assert np.isfinite(acceleration(*pitched(90 * DEG), 1e-3, "final")).all()


def test_edge_on_the_final_model_keeps_half_its_thrust():
    assert acceleration(*pitched(90 * DEG), 1e-3) == pytest.approx([0.5e-3, 0, 0], abs=1e-18)


def test_switched_off_there_is_no_thrust():
    assert np.array_equal(acceleration(*pitched(0.3), 1e-3, on=False), [0, 0, 0])


def test_polynomial_is_clamped_where_the_fit_turns_unphysical():
    """Its cone angle is negative beyond 89.88 deg, its gamma above 1 below 0.6 deg."""
    assert size_and_cone(89.99, "polynomial")[1] == 0
    assert size_and_cone(0.3, "polynomial")[0] <= 1


def test_polynomial_differs_from_the_final_model_by_a_third_of_a_degree_at_most():
    """Computed independently: up to a pitch of 70 deg 0.2907 deg in the cone angle and 0.0037 in gamma."""
    gaps = np.array(
        [np.subtract(size_and_cone(p, "polynomial"), size_and_cone(p, "final")) for p in np.linspace(0, 70, 1401)]
    )
    assert np.abs(gaps).max(axis=0) == pytest.approx([0.0037, 0.2907], abs=5e-5)


# ---------------------------------------------------------------- the final model's angles
def test_largest_cone_angle_is_asin_one_third():
    """At cos^2(alpha) = 1/3, where gamma = 1 / sqrt 2; the thesis rounds it to 19.45 and 19.2 deg."""
    assert np.degrees([CONE_MAX, PITCH_AT_CONE_MAX]) == pytest.approx([19.4712206345, 54.7356103172], abs=1e-9)
    pitch = np.linspace(0, np.pi / 2, 200_001)
    assert cone_angle(pitch).max() == pytest.approx(CONE_MAX, abs=1e-10)
    assert pitch[cone_angle(pitch).argmax()] == pytest.approx(PITCH_AT_CONE_MAX, abs=1e-5)
    assert dimensionless_acceleration(PITCH_AT_CONE_MAX) == pytest.approx(2**-0.5, rel=1e-15)


def test_cone_angle_and_size_are_those_of_the_thrust():
    """(3.43)-(3.44) in the thesis' form: gamma = sqrt(1 + 3 c^2) / 2, cos(phi) = (1 + c^2) / sqrt(1 + 3 c^2)."""
    for pitch in np.linspace(-89, 89, 45):
        c, (size, cone) = np.cos(pitch * DEG), size_and_cone(pitch, "final")
        assert size == pytest.approx(np.sqrt(1 + 3 * c * c) / 2, rel=1e-14)
        assert cone * DEG == pytest.approx(cone_angle(pitch * DEG), abs=1e-14)
        assert np.cos(cone * DEG) == pytest.approx((1 + c * c) / np.sqrt(1 + 3 * c * c), rel=1e-14)
        assert np.sign(cone) == np.sign(pitch)
        assert dimensionless_acceleration(pitch * DEG) == pytest.approx(size, rel=1e-14)


def test_pitch_angle_inverts_the_cone_angle():
    """To 1e-9 rad up to the largest cone angle, where the slope vanishes and half the digits go; both signs."""
    pitch = np.radians(np.linspace(-54.7, 54.7, 1095))
    assert pitch_angle(cone_angle(pitch)) == pytest.approx(pitch, abs=1e-11)
    assert pitch_angle(cone_angle(1e-9)) == pytest.approx(1e-9, rel=1e-12)
    assert pitch_angle(CONE_MAX) == pytest.approx(PITCH_AT_CONE_MAX, abs=2e-8)
    assert pitch_angle(0.0) == 0


def test_pitch_angle_is_the_thesis_smaller_root():
    """(3.46): cos(alpha) = sqrt(2 (3 cos^2(phi) + cos(phi) sqrt(9 cos^2(phi) - 8) - 2)) / 2."""
    cone = np.radians([3, 10, 15, 19])
    c = np.cos(cone)
    thesis = np.arccos(np.sqrt(2 * (3 * c * c + c * np.sqrt(9 * c * c - 8) - 2)) / 2)
    assert pitch_angle(cone) == pytest.approx(thesis, abs=1e-12)
    assert np.degrees(pitch_angle(np.radians([15, 18, 10]))) == pytest.approx(
        [32.968664449, 42.989843166, 20.697815126], abs=1e-9
    )


def test_no_pitch_reaches_beyond_the_largest_cone_angle():
    assert np.isnan(pitch_angle(CONE_MAX + 1e-6))
    assert np.isnan(pitch_angle(np.array([0.1, 0.4]))).tolist() == [False, True]


# ---------------------------------------------------------------- hardware
def test_hardware_gives_thrust_by_3_40_and_3_41():
    """20 kV, 1 kV, 2 nPa: sigma = 0.18 * 19000 * sqrt(8.8541878e-12 * 2e-9) = 4.5511e-7 N/m; 2000 km push 0.9102 N."""
    sigma = characteristic_acceleration(1, 1.0, 20e3, 1.0)
    assert sigma == pytest.approx(4.5511e-7, abs=5e-12)
    assert characteristic_acceleration(1, 1.0, 40e3, 1.0) == pytest.approx(9.3417e-7, abs=5e-12)
    assert characteristic_acceleration(100, 20e3, 20e3, 910.0) == pytest.approx(1e-3, rel=3e-4)
    assert characteristic_acceleration(1, 1.0, 20e3, 1.0, pressure=8e-9) == pytest.approx(2 * sigma, rel=1e-14)


def test_below_the_potential_of_the_wind_a_tether_pushes_nothing():
    assert characteristic_acceleration(1, 1.0, 900.0, 1.0) == 0
    assert characteristic_acceleration(1, 1.0, np.array([500.0, 2e3]), 1.0)[0] == 0


def test_without_a_mass_there_is_no_acceleration():
    found = characteristic_acceleration(1, 1.0, 20e3, np.array([1.0, 0.0, -1.0, np.nan]))
    assert np.isfinite(found).tolist() == [True, False, False, False]
    assert np.isnan(characteristic_acceleration(1, 1.0, 20e3, 0))


def test_one_vector_or_many_give_the_same():
    rng = np.random.default_rng(0)
    position, normal = AU * (1 + rng.random((4, 3))), rng.normal(size=(4, 3))
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    many = acceleration(position, normal, 1e-3)
    assert many.shape == (4, 3)
    assert np.array_equal(many, [acceleration(p, n, 1e-3) for p, n in zip(position, normal, strict=True)])
    assert acceleration(position[0], normal, 1e-3, on=False).shape == (4, 3)
