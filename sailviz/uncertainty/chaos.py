"""Generalised polynomial chaos: mean, spread and percentiles of anything from a handful of flights.

One gamma-distributed pressure p that stays the same for the whole flight. The function is known at P + 1 pressures, the
Gauss nodes of the law; its expansion in polynomials orthonormal under the law gives the statistics (non-intrusive
spectral projection). Basis "laguerre" takes polynomials in p, which the thesis' contents name (7.2.1). The thrust goes
with sqrt p, though, and has a root at p = 0, so the basis "root", polynomials in sqrt p, converges faster at the same
cost. Re-derived.

A constant pressure overstates the dispersion of a flight in the real wind about four times; for winds that change on
the way see `covariance` or draw them.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
import numpy.typing as npt

from sailviz.environment.solar_wind.laws import Gamma

BASES = ("root", "laguerre")
SAMPLES = 20_000  # pressures, equally probable, whose images give the percentiles
_FINE = 400  # nodes of the quadrature in which the recurrence of the root basis is found
_SPAN = 9.0  # of sqrt(p / scale) around its mean; beyond, the density is below 1e-30


@dataclass(frozen=True)
class Expansion:
    """A function of the pressure as a series of orthonormal polynomials.

    pressures (Q,) Pa and weights (Q,) : the nodes. values (Q, ...) : the function there. coefficients (P + 1, ...).
    """

    law: Gamma
    basis: str
    pressures: np.ndarray
    weights: np.ndarray
    values: np.ndarray
    coefficients: np.ndarray

    @property
    def order(self) -> int:
        return len(self.coefficients) - 1

    @property
    def mean(self) -> np.ndarray:
        return self.coefficients[0]

    @property
    def standard_deviation(self) -> np.ndarray:
        return np.sqrt(np.sum(self.coefficients[1:] ** 2, axis=0))

    @property
    def tail(self) -> np.ndarray:
        """Share (...) of the last order in the standard deviation: where it is not small, the order is too low."""
        spread = self.standard_deviation
        return np.abs(self.coefficients[-1]) / np.where(spread > 0, spread, 1.0)

    def at(self, pressure: npt.ArrayLike) -> np.ndarray:
        """Value of the series (m, ...) at pressures (m,) Pa."""
        x = np.asarray(pressure, dtype=float) / self.law.scale
        table = _polynomials(self.law.shape, self.basis, self.order, x)
        return np.tensordot(table, self.coefficients, axes=(0, 0))

    def percentile(self, p: npt.ArrayLike) -> np.ndarray:
        """The value that p percent of the flights stay below: (...), or (m, ...) for p (m,).

        From the series at 20 000 pressures of equal probability: no random numbers, the same every time.
        """
        from scipy.special import ndtri

        pressures = self.law.from_normal(ndtri((np.arange(SAMPLES) + 0.5) / SAMPLES))
        table = _polynomials(self.law.shape, self.basis, self.order, pressures / self.law.scale).T
        flat = self.coefficients.reshape(self.order + 1, -1)
        levels = np.asarray(p, dtype=float)
        step = max(1, 2**24 // SAMPLES)  # outputs at a time, 130 MB
        parts = [
            np.percentile(table @ flat[:, first : first + step], levels, axis=0)
            for first in range(0, flat.shape[1], step)
        ]
        return np.concatenate(parts, axis=-1).reshape(np.shape(p) + self.coefficients.shape[1:])[()]


def nodes(shape: float, scale: float, count: int, basis: str = "root") -> tuple[np.ndarray, np.ndarray]:
    """Pressures (count,) Pa, rising, and weights (count,), sum 1, of the Gauss rule of a basis under a gamma law."""
    a, b = _recurrence(shape, basis, count)
    x, vectors = np.linalg.eigh(np.diag(a[:count]) + np.diag(b[1:count], 1) + np.diag(b[1:count], -1))  # Golub-Welsch
    return scale * (x * x if basis == "root" else x), vectors[0] ** 2


def expand(
    function: Callable[[np.ndarray], npt.ArrayLike], shape: float, scale: float, order: int, basis: str = "root"
) -> Expansion:
    """Expansion of a function of a gamma-distributed pressure to an order, from order + 1 evaluations.

    function : pressures (order + 1,) Pa -> values (order + 1, ...), any number of outputs; it is called once.
    shape : -, scale : Pa, of the law. basis : "root" or "laguerre". ValueError for values of the wrong shape or not
    finite.
    """
    _check(shape, scale, order, basis)
    pressures, _ = nodes(shape, scale, order + 1, basis)
    return _expansion(shape, scale, order, basis, np.asarray(function(pressures), dtype=float))


def _expansion(shape: float, scale: float, order: int, basis: str, values: np.ndarray) -> Expansion:
    """The expansion from values (order + 1, ...) at the nodes."""
    pressures, weights = nodes(shape, scale, order + 1, basis)
    if values.shape[:1] != pressures.shape:
        raise ValueError(f"the function made {values.shape} of {len(pressures)} pressures; one row for each is needed")
    lost = ~np.isfinite(values).reshape(len(values), -1).all(axis=1)
    if lost.any():
        raise ValueError(f"the function is not finite at {', '.join(f'{p * 1e9:.4g} nPa' for p in pressures[lost])}")
    table = _polynomials(shape, basis, order, pressures / scale)
    coefficients = np.tensordot(table * weights, values, axes=(1, 0))
    return Expansion(Gamma(shape, scale), basis, pressures, weights, values, coefficients)


@dataclass(frozen=True)
class Convergence:
    """Expansions of rising order. orders (m,); mean, standard_deviation (m, ...)."""

    basis: str
    orders: np.ndarray
    mean: np.ndarray
    standard_deviation: np.ndarray

    def error(self, standard_deviation: npt.ArrayLike | None = None) -> np.ndarray:
        """Relative error of the standard deviation (m, ...) against a better one, or (m - 1, ...) against the last."""
        if standard_deviation is not None:
            return np.abs(self.standard_deviation / standard_deviation - 1)
        return np.abs(self.standard_deviation[:-1] / self.standard_deviation[-1] - 1)


def convergence(
    function: Callable[[np.ndarray], npt.ArrayLike],
    shape: float,
    scale: float,
    orders: Sequence[int] = (1, 2, 3, 5, 8, 12),
    basis: str = "root",
) -> Convergence:
    """The same expansion at several orders, rising; arguments as of `expand`. All nodes are evaluated in one call."""
    rising = sorted({int(order) for order in orders})
    for order in rising:
        _check(shape, scale, order, basis)
    places = np.cumsum([0, *(order + 1 for order in rising)])
    pressures = np.concatenate([nodes(shape, scale, order + 1, basis)[0] for order in rising])
    values = np.asarray(function(pressures), dtype=float)
    parts = [
        _expansion(shape, scale, order, basis, values[begin:end])
        for order, begin, end in zip(rising, places[:-1], places[1:], strict=True)
    ]
    mean, deviation = np.array([part.mean for part in parts]), np.array([part.standard_deviation for part in parts])
    return Convergence(basis, np.array(rising), mean, deviation)


def _check(shape, scale, order, basis):
    if basis not in BASES:
        raise ValueError(f"a basis is {' or '.join(BASES)}, not {basis!r}")
    if not (0 < shape < np.inf and 0 < scale < np.inf):
        raise ValueError(f"shape and scale of a gamma law must be positive, not {shape:g} and {scale:g}")
    if not 0 <= order <= 60:
        raise ValueError(f"the order must lie between 0 and 60, not at {order}")


def _polynomials(shape, basis, order, x):
    """Orthonormal polynomials (order + 1, m) at x = p / scale (m,)."""
    a, b = _recurrence(shape, basis, order + 1)
    y = np.sqrt(x) if basis == "root" else x
    table = np.empty((order + 1, *np.shape(x)))
    table[0] = 1.0
    for n in range(order):
        table[n + 1] = (y - a[n]) * table[n] - (b[n] * table[n - 1] if n else 0.0)
        table[n + 1] /= b[n + 1]
    return table


def _recurrence(shape, basis, count):
    """a, b (count,) of b_(n+1) P_(n+1) = (y - a_n) P_n - b_n P_(n-1) for orthonormal polynomials; b_0 is not used."""
    if basis == "laguerre":  # weight x^(k-1) e^-x
        n = np.arange(count)
        return 2 * n + shape, np.sqrt(n * (n + shape - 1))
    return _stieltjes(float(shape), int(count))


@lru_cache(maxsize=64)
def _stieltjes(shape, count):
    """The same for y = sqrt x with the density 2 y^(2k-1) e^(-y^2) / Gamma(k): discretised Stieltjes procedure.

    The substitution y = low + (high - low) t^m takes the edge off y^(2k-1) at 0, so that Gauss-Legendre nodes in t
    integrate it to rounding.
    """
    low, high = max(0.0, np.sqrt(shape) - _SPAN), np.sqrt(shape) + _SPAN
    m = 1 if low > 0 else max(1, int(np.ceil(20 / (2 * shape))))
    t, w = np.polynomial.legendre.leggauss(_FINE)
    t = 0.5 * (t + 1)
    y = low + (high - low) * t**m
    log_weight = np.log(w) + (m - 1) * np.log(t) + (2 * shape - 1) * np.log(y) - y * y
    weight = np.exp(log_weight - log_weight.max())
    weight /= weight.sum()
    a, b = np.empty(count), np.zeros(count)
    before, here = np.zeros_like(y), np.ones_like(y)
    for n in range(count):
        a[n] = weight @ (y * here * here)
        if n + 1 == count:
            break
        after = (y - a[n]) * here - b[n] * before
        b[n + 1] = np.sqrt(weight @ (after * after))
        before, here = here, after / b[n + 1]
    a.flags.writeable = b.flags.writeable = False
    return a, b
