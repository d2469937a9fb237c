"""Which way the Earth is turned at an epoch."""

from __future__ import annotations

import numpy as np
import pytest

from sailviz.constants import DAY, ROTATION_EARTH
from sailviz.ephemeris import J2000, decimal_year, earth_rotation_angle, greenwich_sidereal_time, sun_position


def test_angles_at_j2000_are_the_published_ones():
    """0.7790572732640 turns, and 18 h 41 min 50.548 s of Greenwich sidereal time (IAU 1982; 0.1 arcsec in the fit)."""
    assert earth_rotation_angle(J2000) == pytest.approx(2 * np.pi * 0.7790572732640, abs=1e-12)
    assert greenwich_sidereal_time(J2000) * 12 / np.pi == pytest.approx(18 + 41 / 60 + 50.548 / 3600, abs=5e-6)


def test_sidereal_time_of_a_worked_example():
    """J. Meeus, Astronomical Algorithms, example 12.a: 1987 April 10, 0 h UT, 13 h 10 min 46.3668 s."""
    found = greenwich_sidereal_time(np.datetime64("1987-04-10T00:00:00")) * 12 / np.pi
    assert found == pytest.approx(13 + 10 / 60 + 46.3668 / 3600, abs=1e-5)


def test_the_earth_turns_at_its_sidereal_rate():
    times = np.array([0.0, 1.0, 100.0])
    angle = earth_rotation_angle(np.datetime64("2026-07-01T03:00"), times)
    assert np.remainder(angle[1:] - angle[0], 2 * np.pi) / times[1:] == pytest.approx(ROTATION_EARTH, rel=2e-6)


def test_at_noon_in_greenwich_the_sun_stands_over_greenwich():
    """True noon: the equation of time is zero around 15 April and 1 September."""
    for day in ("2026-04-15T12:00", "2026-09-01T12:00"):
        x, y, _ = sun_position(np.datetime64(day), 0.0).ravel()
        gap = np.remainder(np.arctan2(y, x) - greenwich_sidereal_time(np.datetime64(day)) + np.pi, 2 * np.pi) - np.pi
        assert np.degrees(gap) == pytest.approx(0, abs=0.1)


def test_decimal_year_counts_julian_years_from_j2000():
    assert decimal_year(J2000) == 2000.0
    assert decimal_year(J2000 + np.timedelta64(int(DAY * 365.25 * 19), "s")) == pytest.approx(2019.0, abs=1e-9)
