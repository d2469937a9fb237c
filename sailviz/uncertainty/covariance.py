"""Linear covariance of an arrival in a wind that changes on the way (LinCov).

Every redraw interval's thrust factor moves the final state by G_i times its deviation; summed over the intervals this
gives mean and covariance from two flights per interval, without any drawing. Linear: it holds while the spread is small
against the curvature of the flight, and needs the mean factor as the point to linearise about, since thrust at the mean
pressure is not the mean thrust. Re-derived.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt


@dataclass(frozen=True)
class Covariance:
    """mean (m,) : the final state under the mean factor. covariance (m, m). sensitivity (n, m) : d state / d factor of
    every interval."""

    mean: np.ndarray
    covariance: np.ndarray
    sensitivity: np.ndarray

    @property
    def standard_deviation(self) -> np.ndarray:
        return np.sqrt(np.diag(self.covariance))


def linear(
    function: Callable[[np.ndarray], npt.ArrayLike],
    count: int,
    mean: npt.ArrayLike = 1.0,
    deviation: npt.ArrayLike = 0.3,
    correlation: npt.ArrayLike | None = None,
    step: float = 1e-3,
    block: int = 256,
) -> Covariance:
    """Mean and covariance of a final state under `count` random thrust factors.

    function : factors (flights, count) -> final states (flights, m), any units; called with `block` flights at a time.
    mean, deviation : of the factors, scalars or (count,). correlation : None for independent intervals, or the
    correlation (count,) of factors 0, 1, 2 ... intervals apart. step : of the central differences, whose error is of
    its square. ValueError for shapes that do not fit and values that are not finite.
    """
    if count < 1:
        raise ValueError("a flight has at least one interval")
    mean, deviation = (np.broadcast_to(np.asarray(x, dtype=float), (count,)) for x in (mean, deviation))
    if not step > 0 or np.any(deviation < 0):
        raise ValueError("the step must be positive and no deviation negative")

    def states(factors):
        found = np.asarray(function(factors), dtype=float)
        if found.ndim != 2 or len(found) != len(factors):
            raise ValueError(f"the function made {found.shape} of {len(factors)} flights; one row for each is needed")
        if not np.isfinite(found).all():
            raise ValueError("the function is not finite near the mean flight")
        return found

    centre = states(mean[None, :].copy())[0]
    sensitivity = np.empty((count, len(centre)))
    for first in range(0, count, block):
        rows = np.arange(first, min(first + block, count))
        change = np.zeros((len(rows), count))
        change[np.arange(len(rows)), rows] = step
        ends = states(np.concatenate([mean + change, mean - change]))
        sensitivity[rows] = (ends[: len(rows)] - ends[len(rows) :]) / (2 * step)
    weighted = deviation[:, None] * sensitivity
    if correlation is None:
        covariance = weighted.T @ weighted
    else:
        lags = np.asarray(correlation, dtype=float)
        if lags.shape != (count,) or abs(lags[0] - 1) > 1e-12:
            raise ValueError(f"correlations must be ({count},) and begin with 1")
        i = np.arange(count)
        covariance = weighted.T @ lags[np.abs(i[:, None] - i)] @ weighted
    return Covariance(centre, covariance, sensitivity)
