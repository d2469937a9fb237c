"""Solar irradiance: its cycle and flicker, and what a brighter Sun does to a sail."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from sailviz.constants import AU, DAY, MU_SUN, YEAR
from sailviz.environment import irradiance


def end_of_flight(factor):
    """r m, angle rad, u m/s, v m/s of an ideal sail, a_c = 0.5 mm/s2, pitch 35.26 deg, after 700 d from 1 au."""
    alpha = np.radians(35.26)

    def rates(t, y):
        r, _, u, v = y
        a = 0.5e-3 * factor * (AU / r) ** 2 * np.cos(alpha) ** 2
        return [u, v / r, v * v / r - MU_SUN / r**2 + a * np.cos(alpha), -u * v / r + a * np.sin(alpha)]

    start = [AU, 0.0, 0.0, np.sqrt(MU_SUN / AU)]
    return solve_ivp(rates, (0, 700 * DAY), start, method="DOP853", rtol=1e-12, atol=1e-6).y[:, -1]


def test_a_tenth_of_a_percent_more_light_moves_a_sail_by_50_000_km_in_700_days():
    nominal, brighter = end_of_flight(1.0), end_of_flight(1.001)
    assert nominal[0] / AU == pytest.approx(1.583611, abs=1e-6)
    change = brighter - nominal
    assert change[0] / 1e3 == pytest.approx(51_584, rel=0.01)
    assert np.degrees(change[1]) == pytest.approx(-0.19555, rel=0.01)
    assert change[2] == pytest.approx(-5.550, rel=0.01)
    assert change[3] == pytest.approx(-1.483, rel=0.01)


def test_cycle_swings_once_in_eleven_years_around_the_mean():
    years = np.linspace(0, 11.15, 1001) * YEAR
    s = irradiance.cycle(years)
    assert s[0] == pytest.approx(1 + 3.6e-4, abs=1e-15)
    assert s[500] == pytest.approx(1 - 3.6e-4, abs=1e-15)
    assert s[:-1].mean() == pytest.approx(1, abs=1e-12)
    assert irradiance.cycle(0.0, irradiance.PERIOD / 4) == pytest.approx(1, abs=1e-15)
    assert irradiance.since_maximum("1992-01-27T16:00") == 365 * DAY


def test_flicker_has_its_deviation_and_forgets_a_fifth_a_day():
    noise = irradiance.flicker(DAY * np.arange(200_000), seed=4)
    # the deviation of n values with memory rho is known to sqrt((1 + rho^2) / (1 - rho^2) / 2n) = 0.34 %
    assert noise.std() * 1360.96 == pytest.approx(0.334, rel=0.015)
    assert np.corrcoef(noise[:-1], noise[1:])[0, 1] == pytest.approx(0.8, abs=0.006)
    np.testing.assert_array_equal(irradiance.flicker(DAY * np.arange(50), seed=4), noise[:50])
    half_days = irradiance.flicker(DAY / 2 * np.arange(200_000), seed=4)
    assert np.corrcoef(half_days[:-2], half_days[2:])[0, 1] == pytest.approx(0.8, abs=0.01)


def test_replay_takes_the_series_as_it_is_and_never_begins_again():
    series = 1361.0 + np.sin(np.arange(100.0))
    found = irradiance.replay(series, DAY, DAY / 4 * np.arange(9), start=10)
    np.testing.assert_allclose(found * 1360.96, series[[10, 10, 10, 10, 11, 11, 11, 11, 12]], rtol=1e-15)
    drawn = irradiance.replay(series, DAY, DAY * np.arange(100), seed=1)
    np.testing.assert_allclose(drawn * 1360.96, series, rtol=1e-15)
    for bad, options, words in (
        (series, {"start": 95}, "needs 9 from 95"),
        (series, {}, "start or a seed"),
        (series / 1000, {"start": 0}, "median irradiance is 1.361 W/m2"),
        (np.where(series > 1361.9, np.nan, series), {"start": 0}, "are missing"),
    ):
        with pytest.raises(ValueError, match=words):
            irradiance.replay(bad, DAY, DAY * np.arange(9), **options)
