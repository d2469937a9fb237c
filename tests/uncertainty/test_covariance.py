"""Linear covariance against what it must be exactly, and against drawn flights."""

from __future__ import annotations

import numpy as np
import pytest
from numba import njit

from sailviz.constants import AU, GRAVITY_AT_1_AU, MU_SUN
from sailviz.design.minimum_time.smoothed import smoothed_transfer
from sailviz.uncertainty import control, covariance

TU = np.sqrt(AU**3 / MU_SUN)  # s
KM_S = AU / TU / 1e3


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


@njit
def rates(r, u, v, f, g):
    i = 1 / r
    w = v * i
    return u, w, v * w - i * i + f * i, g * i - u * w


@njit
def arrive(factors, radial, transverse, h):
    """Ends (flights, 4) after RK4 steps of h; factors (flights, days) change every 24 steps."""
    ends = np.empty((len(factors), 4))
    for n in range(len(factors)):
        r, theta, u, v = 1.0, 0.0, 0.0, 1.0
        for j in range(len(radial)):
            eta = factors[n, j // 24]
            f, g = radial[j] * eta, transverse[j] * eta
            a = rates(r, u, v, f, g)
            b = rates(r + h / 2 * a[0], u + h / 2 * a[2], v + h / 2 * a[3], f, g)
            c = rates(r + h / 2 * b[0], u + h / 2 * b[2], v + h / 2 * b[3], f, g)
            d = rates(r + h * c[0], u + h * c[2], v + h * c[3], f, g)
            r += h / 6 * (a[0] + 2 * (b[0] + c[0]) + d[0])
            theta += h / 6 * (a[1] + 2 * (b[1] + c[1]) + d[1])
            u += h / 6 * (a[2] + 2 * (b[2] + c[2]) + d[2])
            v += h / 6 * (a[3] + 2 * (b[3] + c[3]) + d[3])
        ends[n] = r, theta, u, v
    return ends


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


@pytest.mark.parametrize(
    ("radius", "costates", "time", "shift", "sweep", "deviation"),
    [
        (1.523679, (0.6835, 0.2181, 0.6966), 8.98, -0.07867, 12.370, [0.02908, 6.515, 0.4964, 0.4452]),
        (0.723332, (-0.6394, -0.0636, -0.7662), 4.95, None, None, [0.00845, 1.115, 0.2628, 0.3403]),
    ],
)
def test_transfers_in_daily_redrawn_wind_spread_as_published(radius, costates, time, shift, sweep, deviation):
    # Mars and Venus, a_c = 1 mm/s2, controls held for an hour, factor redrawn every 24 steps from the start
    a_c = 1e-3 / GRAVITY_AT_1_AU
    plan = smoothed_transfer(radius, a_c, costates, time, 3600 / TU)
    n = len(plan.pitch)
    h = plan.time / n
    radial = 0.25 * a_c * plan.throttle * (3 + np.cos(2 * plan.pitch))
    transverse = 0.25 * a_c * plan.throttle * np.sin(2 * plan.pitch)

    def end(factors):
        r, theta, u, v = arrive(factors, radial, transverse, h).T
        return np.column_stack([r, np.degrees(theta), KM_S * u, KM_S * v])

    wind = control.saturation(2.593, 0.7793e-9, 20e3, 40e3)
    count = -(-n // 24)
    mean, spread = wind.uncontrolled_thrust, wind.uncontrolled_deviation
    found = covariance.linear(end, count, mean, spread, step=0.01, block=count)
    assert found.standard_deviation == pytest.approx(deviation, rel=0.003)
    if shift is not None:
        moved = found.mean - end(np.ones((1, count)))[0]
        assert moved[:2] == pytest.approx([shift, sweep], rel=1e-3)


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
