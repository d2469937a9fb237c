"""The Sun in compiled code: the Almanac's formulae again, the even Sun without an epoch, and local time."""

from __future__ import annotations

import numpy as np
import pytest

from sailviz.constants import DAY, YEAR
from sailviz.environment.sun import direction, local_time, mean_right_ascension, sun_parameters
from sailviz.ephemeris import sun_position

EPOCH = np.datetime64("2026-05-01T06:30")


@pytest.mark.parametrize("days", [0.0, 0.3, 80.0, 365.0, 3650.0])
def test_the_compiled_direction_is_the_almanacs(days):
    expected = sun_position(EPOCH, days * DAY)
    found = direction.py_func(days * DAY, sun_parameters(EPOCH))
    assert found == pytest.approx(expected / np.linalg.norm(expected), abs=1e-9)  # the drift squared: 3e-10 in 10 yr


def test_without_an_epoch_the_sun_moves_evenly_around_the_ecliptic_in_365_and_a_quarter_days():
    p = sun_parameters(None, 0.7)
    start, half, whole = (direction.py_func(f * YEAR, p) for f in (0, 0.5, 1))
    assert np.linalg.norm(start) == pytest.approx(1, abs=1e-15)
    assert start == pytest.approx(whole, abs=1e-12)
    assert np.array(half) == pytest.approx(-np.array(start), abs=1e-12)
    assert direction.py_func(0.25 * YEAR, sun_parameters(None, 0.0)) == pytest.approx(
        (0, np.cos(np.radians(23.439)), np.sin(np.radians(23.439))), abs=1e-12
    )
    assert mean_right_ascension.py_func(YEAR / 8, p) == pytest.approx(0.7 + np.pi / 4)


def test_the_mean_sun_leads_and_follows_the_true_one_by_the_equation_of_time():
    """True minus mean right ascension: +14.2 min around 11 February, -16.4 min around 3 November; published."""
    for epoch, minutes in (("2026-02-11T12:00", 14.2), ("2026-11-03T12:00", -16.4)):
        p = sun_parameters(np.datetime64(epoch))
        x, y, _ = direction.py_func(0.0, p)
        ahead = np.remainder(np.arctan2(y, x) - mean_right_ascension.py_func(0.0, p) + np.pi, 2 * np.pi) - np.pi
        assert np.degrees(ahead) * 4 == pytest.approx(minutes, abs=0.2)


def test_below_the_mean_sun_it_is_noon_and_to_the_east_it_is_later():
    p, t = sun_parameters(None, 1.0), 40 * DAY
    sun = mean_right_ascension.py_func(t, p)
    for offset in (0.0, 0.5, -2.0):
        angle = sun + offset
        time = local_time.py_func(t, np.cos(angle), np.sin(angle), p)
        assert np.remainder(time, 2 * np.pi) == pytest.approx(np.remainder(np.pi + offset, 2 * np.pi))
