"""Logarithmic spirals: the numbers of the derivation, its limits, and the way onto a spiral without an impulse."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from sailviz.design import spirals
from sailviz.propulsion.solar_sail import FILMS

deg = np.radians
BEST = np.arctan(np.sqrt(0.5))
MARS, VENUS = 1.523679, 0.723332


# beta, pitch; slope, gamma deg; C, v0, e, nu deg; r1, time, angle
ROWS = {
    "S1": ("ideal", 0.05, BEST, 0.0395979127, 2.267608571, 0.9720213851, 0.9866840981, 0.04758449718, 126.0136182,
           MARS, 15.0407929542, 10.6351011074),
    "S2": ("ideal", 0.1, BEST, 0.08168311176, 4.669730292, 0.9424229102, 0.9740179049, 0.09613036565, 126.7945905,
           MARS, 7.4050116311, 5.1556288210),
    "S3": ("ideal", 0.1, -BEST, -0.08168311176, -4.669730292, 0.9424229102, 0.9740179049, 0.09613036565, -126.7945905,
           VENUS, 3.2352235424, 3.9651643709),
    "S5": ("jpl-1978", 0.1, BEST, 0.07395277247, 4.229482594, 0.9404797569, 0.9724316184, 0.09154241, 130.5561622,
           MARS, 8.1875082457, 5.6945506046),
    "S6": ("jpl-1978", 0.05, deg(50), 0.02898070761, 1.660007601, 0.9845575958, 0.9926653552, 0.03244395122,
           118.4226395, MARS, 20.4197954743, 14.5313154811),
    "S8": ("jpl-2015", 0.3, -BEST, -0.2651531762, None, 0.802234727, 0.926626574, 0.290445883, -132.9141931,
           VENUS, 1.0802192770, 1.2215088994),
}  # fmt: skip


@pytest.mark.parametrize("name", ROWS)
def test_spiral_has_the_tabled_shape_time_and_angle(name):
    film, beta, pitch, slope, gamma, factor, speed, e, nu, r1, time, angle = ROWS[name]
    found = spirals.logarithmic(beta, pitch, film)
    assert found.slope == pytest.approx(slope, rel=6e-10)
    if gamma is not None:
        assert np.degrees(found.flight_path_angle) == pytest.approx(gamma, abs=0.51e-9)
    assert found.speed_factor == pytest.approx(factor, rel=6e-10)
    assert np.sqrt(factor * (1 + slope**2)) == pytest.approx(speed, rel=6e-10)
    assert found.eccentricity == pytest.approx(e, rel=2e-9)
    assert np.degrees(found.true_anomaly) == pytest.approx(nu, abs=0.6e-7)
    assert found.time(1, r1, 1) == pytest.approx(time, abs=0.6e-10)
    assert found.angle(1, r1) == pytest.approx(angle, abs=0.6e-10)


@pytest.mark.parametrize("name", ["S2", "S8"])
def test_spiral_solves_the_equations_of_motion(name):
    film, beta, pitch, *_, r1, time, angle = ROWS[name]
    k_r, k_t = (beta * k for k in FILMS[film].components(pitch))
    found = spirals.logarithmic(beta, pitch, film)
    v = np.sqrt(found.speed_factor)

    def rates(t, y):
        r, _, vr, vt = y
        return [vr, vt / r, vt**2 / r - (1 - k_r) / r**2, -vr * vt / r + k_t / r**2]

    end = solve_ivp(rates, (0, time), [1, 0, found.slope * v, v], method="DOP853", rtol=1e-13, atol=1e-13).y[:, -1]
    assert end[:2] == pytest.approx([r1, angle], rel=1e-9)


@pytest.mark.parametrize(
    ("film", "largest"),
    [
        ("ideal", (0.593829, 0.612372, 0.861465)),
        ("jpl-1978", (0.620148, 0.643879, 0.902837)),
        ("jpl-2015", (0.615217, 0.637770, 0.894281)),
    ],
)
def test_spirals_end_at_the_tabled_lightness(film, largest):
    pitch = deg([20, 35.2644, 50])
    limit = spirals.largest_lightness(pitch, film)
    assert limit == pytest.approx(largest, abs=0.6e-6)
    assert spirals.largest_lightness(-pitch, film) == pytest.approx(limit, rel=1e-15)
    at = spirals.logarithmic(limit * (1 - 1e-13), pitch, film)
    assert at.slope == pytest.approx(np.sqrt(2), abs=1e-5)
    assert np.degrees(at.flight_path_angle) == pytest.approx(54.7356, abs=1e-3)
    beyond = spirals.logarithmic(limit * (1 + 1e-9), pitch, film)
    assert not beyond.feasible.any()
    assert np.isnan(beyond.slope).all()
    assert np.isnan(beyond.classical_slope).all()


def test_refused_spiral_names_the_largest_lightness():
    assert "0.612372" in spirals.logarithmic(0.7, BEST).reason
    assert "conic" in spirals.logarithmic(0.1, 0.0).reason
    assert np.isnan(spirals.largest_lightness(0.0))
    edge_on = spirals.logarithmic(0.1, np.pi / 2)
    assert edge_on.slope == pytest.approx(0, abs=1e-30)


def test_an_imperfect_film_spirals_like_an_ideal_one_of_its_thrust():
    eta, ideal = spirals.logarithmic(0.1, BEST, "eta-perfect"), spirals.logarithmic(0.085, BEST)
    assert eta.slope == pytest.approx(ideal.slope, rel=1e-14)


def test_classical_approximation_is_the_limit_of_small_angles():
    for beta in (1e-3, 1e-2):
        found = spirals.logarithmic(beta, BEST)
        error = 2 * (found.transverse / (1 - found.radial)) ** 2  # the next term of the root: T = T0 (1 + T0^2 / 2)
        assert found.slope / found.classical_slope - 1 == pytest.approx(error, rel=0.01)
        assert found.classical_time(1, MARS, 1) / found.time(1, MARS, 1) - 1 == pytest.approx(error / 2, rel=0.02)
        assert found.classical_angle(1, MARS) / found.angle(1, MARS) - 1 == pytest.approx(error, rel=0.01)
        assert found.classical_speed_factor / found.speed_factor - 1 == pytest.approx(error, rel=0.01)


# ---------------------------------------------------------------- insertion
@pytest.mark.parametrize(
    ("film", "e", "nu", "pitch", "lightness"),
    [
        ("ideal", 0.0167, 120, 41.2541183, 0.0194031564),
        ("ideal", 0.2056, 150, 16.6723248, 0.195227063),
        ("jpl-2015", 0.0167, 120, 45.8683662, 0.0225771489),
    ],
)
def test_insertion_needs_the_tabled_sail(film, e, nu, pitch, lightness):
    found = spirals.insertion(e, deg(nu), film)
    assert np.degrees(found.pitch) == pytest.approx(pitch, abs=0.51e-7)
    assert found.lightness == pytest.approx(lightness, rel=3e-9)
    inwards = spirals.insertion(e, -deg(nu), film)
    assert (inwards.pitch, inwards.lightness) == (-found.pitch, found.lightness)


@pytest.mark.parametrize("film", ["ideal", "eta-perfect", "jpl-1978", "jpl-2015"])
@pytest.mark.parametrize(("e", "nu"), [(1e-3, 140), (0.2, 150), (0.2, -150), (0.6, 170), (0.9, 178)])
def test_insertion_and_spiral_are_inverses(film, e, nu):
    onto = spirals.insertion(e, deg(nu), film)
    spiral = spirals.logarithmic(onto.lightness, onto.pitch, film)
    assert onto.feasible
    assert spiral.slope == pytest.approx(onto.slope, rel=1e-10)
    assert (spiral.eccentricity, spiral.true_anomaly) == pytest.approx((e, deg(nu)), rel=1e-9)


@pytest.mark.parametrize(("film", "limit"), [("ideal", 90), ("jpl-1978", 55.482498), ("jpl-2015", 58.625497)])
def test_insertion_ends_at_the_films_largest_cone_angle(film, limit):
    from sailviz.design.displaced.force_shape import force_shape

    assert np.degrees(force_shape(film).cone_limit()) == pytest.approx(limit, abs=0.51e-6)
    refused = spirals.insertion(0.0934, deg(80), film)
    first = float(refused.reason.split(" of ")[1].split(" to ")[0])
    allowed = spirals.insertion(0.0934, deg(first + 1e-3), film)
    assert allowed.feasible
    assert not spirals.insertion(0.0934, deg(first - 1e-3), film).feasible
    assert np.degrees(allowed.cone) == pytest.approx(limit, abs=0.01)


def test_insertion_refuses_what_has_no_spiral():
    found = spirals.insertion(0.0934, deg(95), "jpl-1978")
    assert not found.feasible
    assert np.isnan(found.pitch)
    assert "55.482" in found.reason
    assert "circle" in spirals.insertion(0.0, deg(120)).reason
    assert "apsis" in spirals.insertion(0.1, np.pi).reason
    many = spirals.insertion(np.array([0.0, 0.1, 0.1, 1.2]), deg(np.array([120, 120, 60, 120])))
    assert many.feasible.tolist() == [False, True, False, False]
    assert (np.isnan(many.lightness) == ~many.feasible).all()
    assert many.reason == ""
