"""Fits of a pressure series and histories drawn from a law.

    from sailviz.uncertainty import wind
    series = wind.read_omni("omni2_2003.dat")
    fits = wind.fit(series)
    pressure = wind.generate(fits["lognormal"].law, times, seed=1, kind="correlated")

Pressures in Pa. Maximum likelihood; AIC and likelihood are quoted with p in nPa, on which they depend.
"""

from __future__ import annotations

from collections.abc import ItemsView, Iterable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from sailviz.environment.solar_wind.laws import (
    LAWS,
    Burr,
    Gamma,
    InverseGamma,
    InverseGaussian,
    Law,
    Lognormal,
    Weibull,
    named,
)
from sailviz.environment.solar_wind.pressure import KINDS, PHASES, history, yearly_factor
from sailviz.environment.solar_wind.series import Repairs, Series, check_pressures, read_omni, read_series, series

__all__ = [
    "KINDS",
    "PHASES",
    "Fit",
    "Fits",
    "Law",
    "Repairs",
    "Series",
    "autocorrelation",
    "fit",
    "generate",
    "named",
    "read_omni",
    "read_series",
    "series",
]

NPA = 1e-9


@dataclass(frozen=True)
class Fit:
    """One law fitted. ks : largest distance between the distribution functions. aic : with p in nPa, less is better."""

    law: Law
    ks: float
    aic: float

    @property
    def parameters(self) -> dict[str, float]:
        """By name, scales in Pa."""
        return self.law.parameters


@dataclass(frozen=True)
class Fits:
    """All laws fitted to one series, the best first. count values went in, left_out were missing; mean,
    standard_deviation Pa."""

    count: int
    left_out: int
    mean: float
    standard_deviation: float
    laws: dict[str, Fit]

    def __getitem__(self, name) -> Fit:
        return self.laws[name]

    def __iter__(self):
        return iter(self.laws)

    def __len__(self):
        return len(self.laws)

    def items(self) -> ItemsView[str, Fit]:
        return self.laws.items()

    @property
    def best(self) -> str:
        """Name of the law of the smallest AIC."""
        return next(iter(self.laws))


def fit(pressure: npt.ArrayLike | Series, laws: Iterable[str] = tuple(LAWS)) -> Fits:
    """Laws fitted by maximum likelihood, all six or those named.

    pressure : (n,) Pa, NaN left out and counted, or a Series, of which only what was measured counts.
    fit(p)["gamma"].parameters, .ks, .aic; KS p-values are not given, an hourly series is too long and too correlated
    for them to mean anything. ValueError for values that are not positive, a wrong unit, too few or an unknown law.
    """
    unknown = sorted(set(laws) - set(_FITTED))
    if unknown:
        raise ValueError(f"there is no law {', '.join(unknown)} to fit, only {', '.join(_FITTED)}")
    left_out = 0
    if isinstance(pressure, Series):
        left_out = int(np.sum(~pressure.measured))
        pressure = pressure.pressure[pressure.measured]
    known, missing = check_pressures(pressure)
    x, weight = np.unique(known / NPA, return_counts=True)  # measurements are rounded: few distinct values
    if len(x) < 3:
        raise ValueError(f"the series has only {len(x)} different pressures: no law can be fitted")
    n = len(known)
    after = np.cumsum(weight) / n
    before = after - weight / n
    found = {}
    for name in laws:
        law = _FITTED[name](x, np.log(x), weight / n)
        f = law.distribution(x * NPA)
        ks = float(max(np.max(after - f), np.max(f - before)))
        log_likelihood = float(weight @ (law.log_density(x * NPA) + np.log(NPA)))
        found[name] = Fit(law, ks, 2 * len(law.parameters) - 2 * log_likelihood)
    best_first = dict(sorted(found.items(), key=lambda item: item[1].aic))
    return Fits(n, left_out + missing, float(known.mean()), float(known.std()), best_first)


# Each of these: the law that makes x (nPa, distinct, with logarithms log) with weights w (sum 1) most likely.


def _lognormal(x, log, w):
    mean = w @ log
    return Lognormal(float(np.sqrt(w @ (log - mean) ** 2)), float(np.exp(mean)) * NPA)


def _gamma(x, log, w):
    k = _gamma_shape(np.log(w @ x) - w @ log)
    return Gamma(k, float(w @ x / k) * NPA)


def _inverse_gamma(x, log, w):
    inverse = w @ (1 / x)
    k = _gamma_shape(np.log(inverse) + w @ log)  # 1 / p follows a gamma law
    return InverseGamma(k, float(k / inverse) * NPA)


def _inverse_gaussian(x, log, w):
    return InverseGaussian(float(w @ x) * NPA, float(1 / (w @ (1 / x) - 1 / (w @ x))) * NPA)


def _gamma_shape(excess):
    """k of ln k - digamma(k) = ln E x - E ln x, by Newton on 1 / k."""
    from scipy.special import digamma, polygamma

    k = (3 - excess + np.sqrt((excess - 3) ** 2 + 24 * excess)) / (12 * excess)  # good to 1.5 %
    for _ in range(20):
        slope = 1 / k - polygamma(1, k)
        change = (np.log(k) - digamma(k) - excess) / (k * k * slope)
        k = 1 / (1 / k + change)
        if abs(change) * k < 1e-14:
            break
    return float(k)


def _weibull(x, log, w):
    from scipy.optimize import brentq

    def slope(c):
        power = w * np.exp(c * (log - log.max()))
        return power @ log / power.sum() - 1 / c - w @ log

    c = brentq(slope, 1e-2, 1e3, xtol=1e-13)
    return Weibull(float(c), float((w @ x**c) ** (1 / c)) * NPA)


def _burr(x, log, w):
    """c and scale by descent, d by its closed form given them."""
    from scipy.optimize import minimize

    def misfit(u):
        c, log_scale = np.exp(u[0]), u[1]
        y = log - log_scale
        soft = np.logaddexp(0.0, c * y)  # ln(1 + (p / s)^c)
        d = 1 / (w @ soft)
        share = np.exp(c * y - soft)
        value = -(np.log(c) + np.log(d) - log_scale + (c - 1) * (w @ y) - (d + 1) / d)
        by_c = -(1 / c + w @ y - (d + 1) * (w @ (share * y)))
        by_scale = -(-c + (d + 1) * c * (w @ share))
        return value, np.array([c * by_c, by_scale])

    mean = w @ log
    start = [np.log(1.7 / np.sqrt(w @ (log - mean) ** 2)), mean]
    u = minimize(misfit, start, jac=True, method="BFGS", options={"gtol": 1e-10}).x
    c, log_scale = float(np.exp(u[0])), float(u[1])
    d = 1 / (w @ np.logaddexp(0.0, c * (log - log_scale)))
    return Burr(c, float(d), float(np.exp(log_scale)) * NPA)


_FITTED = {
    "burr": _burr,
    "gamma": _gamma,
    "inverse-gamma": _inverse_gamma,
    "inverse-gaussian": _inverse_gaussian,
    "lognormal": _lognormal,
    "weibull": _weibull,
}


def generate(
    law: Law | Fit | str,
    times: npt.ArrayLike,
    seed: int,
    kind: str = "redrawn",
    *,
    flights: int | None = None,
    first_flight: int = 0,
    yearly: float | None = None,
    factor: float = 1.0,
    **options,
) -> np.ndarray:
    """Pressures (n,) Pa at 1 au, or (flights, n) of several flights, each value from its time on until the next.

    law : a Law, a Fit, or a law's word with its parameters among the options, generate("gamma", times, 1, shape=2.593,
    scale=0.7793e-9). times : (n,) s. kind : "constant", "redrawn" (interval=s) or "correlated" (correlation_time=s,
    17 h), see `solar_wind.pressure.history`. flights : flight i is the same however many are drawn; several calls with
    first_flight share the work. yearly : standard deviation of a factor exp(N(0, yearly)) per year; factor : on all
    pressures, for example `solar_wind.pressure.phase_factor("2008-2009")`.
    """
    of_kind = {key: options.pop(key) for key in ("interval", "correlation_time") if key in options}
    if isinstance(law, str):
        law = named(law, **options)
    elif options:
        raise ValueError(f"a law that is complete takes no {', '.join(options)}")
    law = law.law if isinstance(law, Fit) else law

    def one(flight):
        p = history(law, times, seed, kind, flight=flight, **of_kind)
        slow = 1.0 if not yearly else yearly_factor(times, seed, yearly, flight)
        return factor * slow * p

    if flights is None:
        return one(None)
    return np.stack([one(first_flight + i) for i in range(flights)])


def autocorrelation(x: npt.ArrayLike, lags: npt.ArrayLike) -> np.ndarray:
    """Correlation of x (n,) with itself `lags` (m,) steps later; NaN are left out pair by pair."""
    off = np.asarray(x, dtype=float) - np.nanmean(np.asarray(x, dtype=float))
    variance = np.nanmean(off * off)
    return np.array([np.nanmean(off[: len(off) - lag] * off[lag:]) for lag in np.asarray(lags, dtype=int)]) / variance
