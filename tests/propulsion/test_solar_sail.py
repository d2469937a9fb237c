"""Films of solar sails: the thesis' table, values by hand, limits and symmetries."""

from __future__ import annotations

import numpy as np
import pytest

from sailviz.constants import AU, GRAVITY_AT_1_AU, MU_SUN
from sailviz.design.displaced.force_shape import force_shape
from sailviz.propulsion.solar_sail import FILMS, Film, acceleration, film

DEG = np.pi / 180
# table 3.1: cr, cs, Bf, Bb, ef, eb
OPTICS = {
    "ideal": (1, 1, 2 / 3, 2 / 3, 0, 0),
    "jpl-1978": (0.88, 0.94, 0.79, 0.55, 0.05, 0.55),
    "jpl-2015": (0.91, 0.94, 0.79, 0.67, 0.025, 0.27),
}


def pitched(pitch, radius=AU):
    """Position on the x axis and a normal leaning by the pitch towards y."""
    return np.array([radius, 0, 0]), np.array([np.cos(pitch), np.sin(pitch), 0])


# by hand from (3.18)-(3.20): e.g. 1978: b1 = (1 - 0.8272)/2, b3 = (0.79 0.88 0.06 + 0.12 (0.0395 - 0.3025)/0.6)/2
@pytest.mark.parametrize(
    ("name", "b1", "b2", "b3"),
    [("ideal", 0, 1, 0), ("jpl-1978", 0.0864, 0.8272, -0.005444), ("jpl-2015", 0.0723, 0.8554, -0.003015)],
)
def test_optical_properties_give_the_coefficients_of_table_3_1(name, b1, b2, b3):
    computed = Film.from_optics(*OPTICS[name])
    assert (computed.b1, computed.b2, computed.b3) == pytest.approx((b1, b2, b3), abs=5e-7)
    printed = film(name)
    assert (printed.b1, printed.b2) == pytest.approx((b1, b2), abs=1e-15)
    assert printed.b3 == pytest.approx(b3, abs=6e-5)  # printed to four decimals


def test_ideal_force_goes_with_cos_squared_along_the_normal():
    """1 mm/s2 at 1 au; at 60 deg a quarter of it, at 2 au a quarter of that."""
    position, normal = pitched(60 * DEG, 2 * AU)
    assert acceleration(position, normal, 1e-3) == pytest.approx(1e-3 / 16 * normal, abs=1e-18)


# a / a_c along (r_hat, t_hat) at pitch 40 deg, evaluated apart from sailviz with table 3.1's coefficients:
# k_r = (b1 c + b2 c^3 + b3 c^2) / sum, k_t = (b2 c^2 s + b3 c s) / sum
@pytest.mark.parametrize(
    ("name", "along", "across"),
    [
        ("ideal", 0.4495333323, 0.3772032534),
        ("eta-perfect", 0.4495333323, 0.3772032534),
        ("jpl-1978", 0.4788158572, 0.3406170134),
        ("jpl-2015", 0.4738351395, 0.3473369215),
    ],
)
def test_film_pushes_as_by_hand(name, along, across):
    found = acceleration(*pitched(40 * DEG), 2e-3, name) / 2e-3
    assert found == pytest.approx([along, across, 0], abs=1e-9)
    assert film(name).components(40 * DEG) == pytest.approx((along, across), abs=1e-9)


def test_normal_and_tangential_components_follow_3_27_to_3_30():
    """a_n = K (b1 c^2 + (b2 c + b3) c), a_t = K b1 s c along (r_hat - c n_hat) / s, in the sail's plane."""
    b1, b2, b3 = 0.0864, 0.8272, -0.0055
    for pitch in np.radians([5, 35, 80]):
        position, normal = pitched(pitch)
        a = acceleration(position, normal, 1.0, "jpl-1978")
        c, s, k = np.cos(pitch), np.sin(pitch), 1 / (b1 + b2 + b3)
        assert a @ normal == pytest.approx(k * (b1 * c * c + (b2 * c + b3) * c), rel=1e-14)
        assert a @ (np.array([1, 0, 0]) - c * normal) / s == pytest.approx(k * b1 * s * c, rel=1e-13)


@pytest.mark.parametrize("name", sorted(FILMS))
def test_characteristic_acceleration_is_what_the_sail_feels_at_1_au_facing_the_sun(name):
    assert acceleration([AU, 0, 0], [1, 0, 0], 1e-3, name) == pytest.approx([1e-3, 0, 0], rel=1e-15)


def test_optical_film_tends_to_the_ideal_one():
    """1 - cr = 1 - cs = x makes a difference of order x."""
    differences = []
    for x in (1e-3, 1e-4, 1e-5):
        nearly = Film.from_optics(1 - x, 1 - x, 2 / 3, 2 / 3, 0, 0)
        gap = acceleration(*pitched(40 * DEG), 1.0, nearly) - acceleration(*pitched(40 * DEG), 1.0)
        differences.append(np.linalg.norm(gap))
    assert differences[0] < 1e-3
    assert differences[0] / differences[1] == pytest.approx(10, rel=0.01)
    assert differences[1] / differences[2] == pytest.approx(10, rel=0.01)
    exactly = Film.from_optics(*OPTICS["ideal"])
    assert np.array_equal(acceleration(*pitched(1.0), 1.0, exactly), acceleration(*pitched(1.0), 1.0))


@pytest.mark.parametrize("name", sorted(FILMS))
@pytest.mark.parametrize("pitch", [90.000001, 120, 180, -150])
def test_sail_turned_backwards_feels_nothing(name, pitch):
    assert np.array_equal(acceleration(*pitched(pitch * DEG), 1e-3, name), [0, 0, 0])
    assert film(name).components(pitch * DEG) == (0, 0)


@pytest.mark.parametrize("name", sorted(FILMS))
def test_sail_leaning_the_other_way_pushes_the_other_way(name):
    left, right = acceleration(*pitched(0.6), 1e-3, name), acceleration(*pitched(-0.6), 1e-3, name)
    assert np.array_equal(left * [1, -1, 1], right)


def test_largest_transverse_force_of_an_ideal_sail_is_at_35_26_deg():
    pitch = np.linspace(0, np.pi / 2, 100_001)
    across = film("ideal").components(pitch)[1]
    assert across.max() == pytest.approx(2 / (3 * np.sqrt(3)), abs=1e-9)
    assert pitch[across.argmax()] == pytest.approx(np.arctan(2**-0.5), abs=2e-5)


# re-derived with the printed coefficients: largest cone angle and the pitch where it is reached
@pytest.mark.parametrize(
    ("name", "cone", "pitch"), [("jpl-1978", 55.482498, 72.559168), ("jpl-2015", 58.625497, 74.215973)]
)
def test_a_real_film_cannot_push_sideways_beyond_its_largest_cone_angle(name, cone, pitch):
    shape = force_shape(name)
    assert shape.cone_limit() / DEG == pytest.approx(cone, abs=1e-6)
    assert shape.pitch(shape.cone_limit()) / DEG == pytest.approx(pitch, abs=1e-4)  # flat there: half the digits go
    assert np.isnan(shape.pitch((cone + 1e-5) * DEG))
    inverse = shape.pitch(np.radians([0, 10, 40, 55]))
    k_r, k_t = film(name).components(inverse)
    assert np.arctan2(k_t, k_r) / DEG == pytest.approx([0, 10, 40, 55], abs=1e-10)


def test_lightness_number_and_loading_give_the_characteristic_acceleration():
    """beta g at 1 au, 5.930083519 mm/s2; eta beta g for the imperfect film; 2 P (A/m) (b1 + b2 + b3)."""
    assert pytest.approx(5.930083519e-3, rel=1e-10) == GRAVITY_AT_1_AU
    assert film("ideal").characteristic_acceleration(lightness=0.1) == pytest.approx(0.1 * MU_SUN / AU**2, rel=1e-15)
    assert film("jpl-2015").characteristic_acceleration(lightness=0.1) == pytest.approx(0.1 * MU_SUN / AU**2)
    assert film("eta-perfect").characteristic_acceleration(lightness=0.1) == pytest.approx(0.085 * MU_SUN / AU**2)
    assert film("eta-perfect").lightness(0.085 * GRAVITY_AT_1_AU) == pytest.approx(0.1, rel=1e-14)
    assert film("jpl-1978").characteristic_acceleration(area=100, mass=2) == pytest.approx(4.563e-4 * 0.9081)
    assert film("eta-perfect").characteristic_acceleration(area=100, mass=2) == pytest.approx(4.563e-4 * 0.85)


@pytest.mark.parametrize("size", [0, -1.0, np.nan, np.inf, 1j, np.float64(-2)])
@pytest.mark.parametrize("name", ["area", "mass"])
def test_a_sail_has_an_area_and_a_mass_or_there_is_no_acceleration(name, size):
    with pytest.raises(ValueError, match=f"the {name} must be a positive number"):
        film("ideal").characteristic_acceleration(**{"area": 100.0, "mass": 2.0, name: size})


def test_lightsail_2_and_ikaros_feel_what_was_published():
    """LightSail 2, 32 m2, perfect: 0.2920 mN, quoted 0.291. IKAROS, 196 m2: the measured 1.12 mN lies between a pure
    absorber and the film of 2015."""
    assert film("ideal").characteristic_acceleration(area=32, mass=1) == pytest.approx(0.29203e-3, abs=5e-9)
    black = Film.from_optics(0, 0, 2 / 3, 2 / 3, 0.5, 0.5).characteristic_acceleration(area=196, mass=1)
    assert black == pytest.approx(0.894e-3, abs=5e-7)
    assert film("jpl-2015").characteristic_acceleration(area=196, mass=1) == pytest.approx(1.654e-3, abs=5e-7)


def test_one_vector_or_many_give_the_same():
    rng = np.random.default_rng(0)
    position, normal = AU * (1 + rng.random((4, 3))), rng.normal(size=(4, 3))
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    many = acceleration(position, normal, 1e-3, "jpl-2015")
    one = [acceleration(p, n, 1e-3, "jpl-2015") for p, n in zip(position, normal, strict=True)]
    assert many.shape == (4, 3)
    assert one[0].shape == (3,)
    assert np.array_equal(many, one)
    assert acceleration(position, normal[0], 1e-3).shape == (4, 3)
    with pytest.raises(ValueError, match="three components"):
        acceleration([AU, 0], [1, 0], 1e-3)
