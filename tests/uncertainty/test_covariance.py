"""Linear covariance against what it must be exactly, and against drawn flights."""

from __future__ import annotations

import numpy as np
import pytest

from sailviz.uncertainty import covariance


def fly(factors):
    """Final r, angle, u, v (canonical) of E-sails, a_c = 1 mm/s2, pitch 45 deg, one year; factors (flights, n) of
    equal intervals, RK4 with two steps in each."""
    q = 1 / 5.930083519 / 4
    flights, n = factors.shape
    y = np.repeat([[1.0], [0.0], [0.0], [1.0]], flights, axis=1)
    h = 2 * np.pi / n / 2

    def rates(y, eta):
        r, _, u, v = y
        a = q * eta / r
        return np.array([u, v / r, v * v / r - 1 / r**2 + 3 * a, -u * v / r + a])

    for eta in factors.T:
        for _ in range(2):
            a = rates(y, eta)
            b = rates(y + h / 2 * a, eta)
            c = rates(y + h / 2 * b, eta)
            y = y + h / 6 * (a + 2 * b + 2 * c + rates(y + h * c, eta))
    return y.T


def test_linear_function_has_its_covariance_exactly():
    matrix = np.random.Generator(np.random.PCG64(1)).normal(size=(30, 3))
    found = covariance.linear(lambda x: x @ matrix + 5, 30, mean=0.9, deviation=0.3, block=7)
    np.testing.assert_allclose(found.mean, 0.9 * matrix.sum(axis=0) + 5, rtol=1e-12)
    np.testing.assert_allclose(found.sensitivity, matrix, atol=1e-11)
    np.testing.assert_allclose(found.covariance, 0.09 * matrix.T @ matrix, rtol=1e-10)
    same = covariance.linear(lambda x: x @ matrix, 30, deviation=0.3, correlation=np.ones(30))
    np.testing.assert_allclose(same.standard_deviation, 0.3 * np.abs(matrix.sum(axis=0)), rtol=1e-9)


@pytest.mark.parametrize("memory", [0.0, 0.8])
def test_drawn_flights_spread_as_the_linear_covariance_says(memory):
    n, flights, deviation = 180, 3000, 0.3
    lags = memory ** np.arange(n)
    found = covariance.linear(fly, n, mean=0.95, deviation=deviation, correlation=lags)
    z = np.random.Generator(np.random.PCG64(7)).standard_normal((flights, n))
    for i in range(1, n):
        z[:, i] = memory * z[:, i - 1] + np.sqrt(1 - memory**2) * z[:, i]
    ends = fly(0.95 + deviation * z)
    # deviations of 3000 flights are known to 1.3 %; the rest is what the linearisation leaves out
    np.testing.assert_allclose(found.standard_deviation, ends.std(axis=0), rtol=0.05)
    drawn = np.corrcoef(ends.T)
    deviations = found.standard_deviation
    np.testing.assert_allclose(found.covariance / np.outer(deviations, deviations), drawn, atol=0.05)


def test_requests_that_make_no_sense_are_refused():
    for arguments, words in (
        ((fly, 0), "at least one interval"),
        ((lambda x: x[0], 5), "one row for each"),
        ((lambda x: np.full((len(x), 2), np.nan), 5), "not finite"),
    ):
        with pytest.raises(ValueError, match=words):
            covariance.linear(*arguments)
    with pytest.raises(ValueError, match="begin with 1"):
        covariance.linear(fly, 5, correlation=np.zeros(5))
