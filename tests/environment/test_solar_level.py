"""F10.7 in time: constant, and the 11-year cycle."""

from __future__ import annotations

import numpy as np
import pytest

from sailviz.constants import YEAR
from sailviz.environment.solar_level import constant, cycle, flux


def at(parameters, years):
    """F10.7 after a number of years."""
    return flux.py_func(years * YEAR, parameters)


def test_a_constant_sun_stays():
    assert at(constant(123.0), 0.0) == at(constant(123.0), 50.0) == 123.0


@pytest.mark.parametrize("start", [2019.96, 2026.0, 1990.5])
def test_the_cycle_follows_its_formula_from_any_start(start):
    for years in (0.0, 3.3, 40.0):
        expected = 70 + 61.5 * (1 - np.cos(2 * np.pi * (start + years - 2019.96) / 11))
        assert at(cycle(start), years) == pytest.approx(expected, abs=1e-9)


def test_minimum_in_december_2019_maximum_five_and_a_half_years_later_and_again_after_eleven():
    assert at(cycle(2019.96), 0.0) == pytest.approx(70)
    assert at(cycle(2019.96), 5.5) == pytest.approx(193)
    assert at(cycle(2023.0), 11.0) == pytest.approx(at(cycle(2023.0), 0.0))
    assert at(cycle(2023.0), 0.5) > at(cycle(2023.0), 0.0)
