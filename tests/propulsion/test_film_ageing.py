"""Films that age and how warm they get: rows of the source, written down from the balance by another hand."""

import numpy as np
import pytest

from sailviz.constants import AU, SOLAR_IRRADIANCE
from sailviz.propulsion.film_ageing import (
    Numbers,
    Optics,
    aged_coefficients,
    aged_film,
    balance,
    closest_distance,
    optics_of,
    temperature,
)
from sailviz.propulsion.solar_sail import FILMS, OPTICS, Film

SIGMA = 5.670374419e-8


@pytest.mark.parametrize(
    ("factor", "dose", "b1", "b2", "b3"),
    [
        (0.05, 1.0, 0.102304464, 0.795391071, -0.000766802),
        (0.2, 1.0, 0.172542187, 0.654915625, 0.001884479),
        (0.2, np.inf, 0.202986111, 0.594027778, 0.001584028),
    ],
)
def test_the_coefficients_of_an_aged_film_are_those_of_its_optics_at_that_dose(factor, dose, b1, b2, b3):
    film = aged_film("jpl-2015", dose, factor)
    assert (film.b1, film.b2, film.b3) == pytest.approx((b1, b2, b3), abs=6e-10)


@pytest.mark.parametrize("name", ["ideal", "jpl-1978", "jpl-2015"])
def test_a_film_without_dose_or_factor_is_the_fresh_one(name):
    fresh = Film.from_optics(*OPTICS[name])
    assert aged_film(name, 0.0, 0.2) == fresh
    assert aged_film(name, 7.0, 0.0) == fresh
    printed = FILMS[name]
    assert (fresh.b1, fresh.b2, fresh.b3) == pytest.approx((printed.b1, printed.b2, printed.b3), abs=5e-4)


def test_compiled_code_has_the_same_film_as_python():
    optics = Optics(0.85, 0.9, 0.75, 0.6, 0.04, 0.4)
    numbers = Numbers(1.0, *optics, factor=0.13, rate=np.log(2) / 0.7, heat=SOLAR_IRRADIANCE * AU**2 / SIGMA)
    film = aged_film(optics, 0.9, 0.13, 0.7)
    assert aged_coefficients.py_func(0.9, numbers) == pytest.approx((film.b1, film.b2, film.b3), rel=1e-14)
    warm = balance.py_func(np.cos(0.4), 1 / (0.3 * AU), 1.0, 0.9, numbers)
    assert warm == pytest.approx(float(temperature(0.3 * AU, 0.4, optics, 0.9, 0.13, 0.7)), rel=1e-14)


@pytest.mark.parametrize(
    ("film", "distance", "pitch", "kelvin"),
    [
        ("jpl-2015", 1.0, 0, 292.525365),
        ("jpl-2015", 1.0, 35, 278.294523),
        ("jpl-2015", 1.0, 60, 245.983531),
        ("jpl-2015", 0.5, 0, 413.693338),
        ("jpl-2015", 0.5, 35, 393.567889),
        ("jpl-2015", 0.5, 60, 347.873245),
        ("jpl-2015", 0.25, 0, 585.050729),
        ("jpl-2015", 0.25, 35, 556.589046),
        ("jpl-2015", 0.1, 0, 925.046426),
        ("jpl-2015", 0.08, 0, 1034.233345),
        ("jpl-1978", 1.0, 0, 263.218194),
        ("jpl-1978", 0.5, 0, 372.246740),
        ("jpl-1978", 0.25, 0, 526.436388),
        ("jpl-1978", 0.08, 0, 930.616850),
    ],
)
def test_a_film_is_as_warm_as_its_balance_has_it(film, distance, pitch, kelvin):
    assert float(temperature(distance * AU, np.radians(pitch), film)) == pytest.approx(kelvin, abs=6e-7)


@pytest.mark.parametrize(("dose", "kelvin"), [(1.0, 505.848923), (np.inf, 527.347970)])
def test_an_aged_film_gets_hotter(dose, kelvin):
    assert float(temperature(0.5 * AU, 0.0, "jpl-2015", dose, 0.2)) == pytest.approx(kelvin, abs=6e-7)


def test_what_a_film_takes_up_it_radiates():
    rng = np.random.default_rng(5)
    for _ in range(20):
        cr, cs, Bf, Bb, ef, eb = rng.uniform(0.05, 0.95, 6)
        r, a, d, dose, half = rng.uniform(0.05, 3) * AU, rng.uniform(0, 1.5), *rng.uniform(0, 1, 2), rng.uniform(0.1, 2)
        t = float(temperature(r, a, Optics(cr, cs, Bf, Bb, ef, eb), dose, d, half))
        left = 2.0 ** (-dose / half)
        mirrored, front = cr * (1 + d * left) / (1 + d), ef * (1 + d * (1 - left))
        taken = (1 - mirrored) * SOLAR_IRRADIANCE * (AU / r) ** 2 * np.cos(a)
        assert SIGMA * (front + eb) * t**4 == pytest.approx(taken, rel=1e-12)


@pytest.mark.parametrize(
    ("film", "kelvin", "pitch", "distance"),
    [
        ("jpl-2015", 400.0, 0, 0.534819306),
        ("jpl-2015", 500.0, 0, 0.342284356),
        ("jpl-2015", 573.15, 0, 0.260489646),
        ("jpl-2015", 400.0, 35, 0.484049010),
        ("jpl-1978", 400.0, 0, 0.433023860),
        ("jpl-1978", 500.0, 0, 0.277135271),
        ("jpl-1978", 573.15, 0, 0.210909051),
    ],
)
def test_a_film_may_come_as_near_as_its_hottest_temperature_lets_it(film, kelvin, pitch, distance):
    assert closest_distance(kelvin, film, np.radians(pitch)) / AU == pytest.approx(distance, abs=6e-10)


def test_light_on_the_back_counts_by_what_the_back_mirrors_and_on_an_unknown_one_not_at_all():
    numbers = Numbers(1.0, *optics_of("jpl-2015"), heat=SOLAR_IRRADIANCE * AU**2 / SIGMA, back=0.3)
    warm = balance.py_func(-0.5, 1 / AU, 1.0, 0.0, numbers)
    assert SIGMA * (0.025 + 0.27) * warm**4 == pytest.approx(0.7 * SOLAR_IRRADIANCE * 0.5, rel=1e-12)
    assert balance.py_func(-0.5, 1 / AU, 1.0, 0.0, numbers._replace(back=-1.0)) == 0.0
