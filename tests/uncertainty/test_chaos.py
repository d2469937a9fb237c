"""Polynomial chaos: Gauss rules against their moments, and flights whose statistics are known to many digits."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.special import gammaln, roots_genlaguerre

from sailviz.uncertainty import chaos

K, THETA, P_REF = 2.6, 0.77e-9, 2.002e-9
YEAR = 2 * np.pi  # canonical


def flight(ac, pitch_deg, years):
    """Function of pressures: final r, angle, u, v (canonical) of an E-sail from a circle at 1 au, ac in mm/s2."""
    q, alpha = ac / 5.930083519 / 4, np.radians(pitch_deg)
    radial, transverse = q * (3 + np.cos(2 * alpha)), q * np.sin(2 * alpha)

    def end(pressure):
        eta, n = np.sqrt(pressure / P_REF), len(pressure)

        def rates(t, y):
            r, _, u, v = y.reshape(4, n)
            a = eta / r
            return np.concatenate([u, v / r, v * v / r - 1 / r**2 + radial * a, -u * v / r + transverse * a])

        start = np.repeat([1.0, 0.0, 0.0, 1.0], n)
        return (
            solve_ivp(rates, (0, years * YEAR), start, method="DOP853", rtol=1e-12, atol=1e-12).y[:, -1].reshape(4, n).T
        )

    return end


A, B = flight(0.5, 45, 1), flight(1.0, 45, 1)
ERRORS = {  # of the standard deviation of r, stated to two digits: order -> (p, sqrt p)
    "A": {1: (2.8e-2, 1.6e-2), 2: (5.3e-3, 1.6e-3), 3: (2.5e-3, 3.6e-5), 5: (9.7e-4, 2.1e-6), 8: (3.3e-4, 1.8e-9)},
    "B": {2: (1.6e-2, 1.9e-3), 3: (4.3e-3, 3.3e-4), 5: (6.2e-4, 2.7e-6), 8: (1.7e-4, 2.7e-7)},
    "C": {1: (0.97, 0.40), 2: (0.14, 0.012), 3: (0.058, 6e-4), 5: (0.020, 5.9e-5), 8: (6.1e-3, 6.3e-6)},
    "D": {3: (2.7e-2, 1.3e-2), 5: (4.1e-3, 2.3e-3), 8: (4.1e-3, 6.8e-4), 12: (7.3e-4, 1.0e-4)},
}
CASES = {"A": A, "B": B, "C": flight(1.0, -45, 0.75), "D": flight(1.0, 45, 2)}


def test_laguerre_nodes_are_those_of_the_table():
    p, w = chaos.nodes(K, THETA, 6, "laguerre")
    assert p / 1e-9 == pytest.approx([0.569128, 1.674944, 3.395465, 5.850395, 9.284186, 14.337882], abs=6e-7)
    book, weights = roots_genlaguerre(6, K - 1)
    np.testing.assert_allclose(p / THETA, book, rtol=1e-13)
    np.testing.assert_allclose(w, weights / weights.sum(), rtol=1e-12)


@pytest.mark.parametrize("shape", [0.3, 0.6, 2.6, 40.0, 500.0])
def test_root_nodes_integrate_powers_of_the_root_exactly(shape):
    p, w = chaos.nodes(shape, 1.0, 9)
    for power in range(18):  # nine nodes carry 17 powers
        exact = np.exp(gammaln(shape + power / 2) - gammaln(shape))
        assert w @ p ** (power / 2) == pytest.approx(exact, rel=1e-11)


@pytest.mark.parametrize("basis", chaos.BASES)
def test_polynomials_of_the_basis_are_found_exactly(basis):
    found = chaos.expand(lambda p: np.column_stack([p / THETA, (p / THETA) ** 2]), K, THETA, 4, basis)
    assert found.mean == pytest.approx([K, K * (K + 1)], rel=1e-12)
    fourth = K * (K + 1) * (K + 2) * (K + 3)
    assert found.standard_deviation**2 == pytest.approx([K, fourth - (K * (K + 1)) ** 2], rel=1e-11)
    np.testing.assert_allclose(found.at([1e-9, 3e-9])[:, 0], np.array([1e-9, 3e-9]) / THETA, rtol=1e-12)
    from scipy.stats import gamma

    wanted = gamma(K).ppf([0.05, 0.5, 0.95])
    np.testing.assert_allclose(found.percentile([5, 50, 95])[:, 0], wanted, rtol=1e-3)
    assert found.percentile(50).shape == (2,)


@pytest.mark.parametrize("basis", chaos.BASES)
def test_variance_of_the_series_is_that_of_the_nodes(basis):
    found = chaos.expand(np.log, K, THETA, 6, basis)
    assert found.mean == pytest.approx(found.weights @ found.values, rel=1e-13)
    spread = found.weights @ (found.values - found.mean) ** 2
    assert found.standard_deviation**2 == pytest.approx(spread, rel=1e-12)


def test_flight_a_has_its_nominal_end_and_statistics():
    np.testing.assert_allclose(A(np.array([P_REF]))[0], [1.513032, 4.433563, 0.030695, 0.748459], atol=6e-7)
    root = chaos.expand(A, K, THETA, 5)
    assert root.mean[0] == pytest.approx(1.494925, abs=1e-5)
    assert root.standard_deviation[0] == pytest.approx(0.226960, abs=1e-5)
    laguerre = chaos.expand(A, K, THETA, 5, "laguerre")
    assert laguerre.mean[0] == pytest.approx(1.495024, abs=1e-6)
    assert laguerre.standard_deviation[0] == pytest.approx(0.226739, abs=1e-6)


@pytest.mark.parametrize(
    ("end", "mean", "deviation"),
    [
        (A, [1.494925, 4.545834, 0.034998, 0.766024], [0.226960, 0.437633, 0.045773, 0.084285]),
        (B, [2.304553, 3.575834, 0.235282, 0.565605], [0.532555, 0.478917, 0.140295, 0.099715]),
    ],
)
def test_whole_final_state_has_the_tabled_statistics(end, mean, deviation):
    found = chaos.expand(end, K, THETA, 20)
    np.testing.assert_allclose(found.mean, mean, atol=6e-7)
    np.testing.assert_allclose(found.standard_deviation, deviation, atol=6e-7)
    assert (found.tail < 1e-5).all()


@pytest.mark.parametrize("case", CASES)
def test_orders_reach_their_stated_errors(case):
    end = CASES[case]
    best = chaos.expand(end, K, THETA, 40).standard_deviation[0]
    for i, basis in enumerate(("laguerre", "root")):
        found = chaos.convergence(lambda p: end(p)[:, 0], K, THETA, ERRORS[case], basis)
        for order, error in zip(found.orders, found.error(best), strict=True):
            stated = ERRORS[case][order][i]
            assert error == pytest.approx(stated, rel=0.07), (basis, order)  # stated to two digits


def test_percentiles_are_those_of_the_flights_themselves():
    pressures = np.random.Generator(np.random.PCG64(3)).gamma(K, THETA, 4000)
    drawn = np.percentile(B(pressures)[:, 0], [10, 50, 90])
    found = chaos.expand(lambda p: B(p)[:, 0], K, THETA, 8).percentile([10, 50, 90])
    np.testing.assert_allclose(found, drawn, atol=0.04)  # three standard errors of 4000 flights


def test_a_whole_trajectory_is_one_call():
    calls = []

    def tube(p):
        calls.append(len(p))
        return p[:, None, None] * np.ones((300, 4))

    found = chaos.expand(tube, K, THETA, 3)
    assert calls == [4]
    assert found.percentile([5, 95]).shape == (2, 300, 4)
    assert chaos.convergence(tube, K, THETA, (1, 2)).mean.shape == (2, 300, 4)


def test_functions_and_laws_that_cannot_be_expanded_are_refused():
    for arguments, words in (
        ((lambda p: 1.0, K, THETA, 3), "one row for each"),
        ((lambda p: np.where(p > 3e-9, np.nan, p), K, THETA, 3), "not finite at"),
        ((np.sqrt, K, THETA, 3, "hermite"), "root or laguerre"),
        ((np.sqrt, -1, THETA, 3), "must be positive"),
        ((np.sqrt, K, THETA, 99), "between 0 and 60"),
    ):
        with pytest.raises(ValueError, match=words):
            chaos.expand(*arguments)
