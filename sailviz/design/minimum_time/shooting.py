"""Boundary-value problems by shooting: Levenberg-Marquardt with differenced Jacobians, whose flights fly in one batch.

Source: J. J. Moré, The Levenberg-Marquardt algorithm: implementation and theory (1978), scaling of the unknowns; the
damping follows H. B. Nielsen, Damping parameter in Marquardt's method (1999). Re-derived from the normal equations.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt


@dataclass(frozen=True)
class Root:
    """What a search ended with: unknowns (n,), residual its largest entry, evaluations of the residual."""

    unknowns: np.ndarray
    residual: float
    evaluations: int


def solve(
    residuals: Callable[[np.ndarray], np.ndarray],
    unknowns: npt.ArrayLike,
    *,
    step: float = 1e-7,
    goal: float = 1e-12,
    most: int = 60,
    limit: npt.ArrayLike | None = None,
) -> Root:
    """The unknowns (n,) that bring residuals(batch (m, n)) -> (m, k), k >= n, to zero, or as near as the search got.

    step : of the differences, relative to the larger of 1 and an unknown's size. goal : largest entry of the residual
    at which it ends. limit (n,) : largest change of an unknown in one iteration. Entries that are not finite are
    refused as steps. Ends early where it makes no headway.
    """
    x = np.array(unknowns, dtype=float)
    n = len(x)
    limit = np.full(n, np.inf) if limit is None else np.asarray(limit, dtype=float)
    damping, growth, weight = 1e-3, 2.0, np.zeros(n)
    f, count, slow = None, 0, 0
    for _ in range(most):
        if f is not None and np.abs(f).max() <= goal:
            break
        h = step * np.maximum(1.0, np.abs(x))
        known = f is not None  # from the step that led here
        batch = np.empty((n if known else n + 1, n))
        batch[:] = x
        batch[-n:].flat[:: n + 1] += h
        values = residuals(batch)
        count += len(batch)
        if not np.isfinite(values).all():
            break
        if f is None:
            f = values[0]
            if np.abs(f).max() <= goal:
                break
        jacobian = ((values[-n:] - f) / h[:, None]).T
        weight = np.maximum(weight, np.sqrt((jacobian * jacobian).sum(axis=0)))
        weight[weight == 0.0] = 1.0
        scaled = jacobian / weight
        u, sigma, vt = np.linalg.svd(scaled, full_matrices=False)
        along = u.T @ f
        moved = False
        for _ in range(12):
            change = -(vt.T @ (sigma / (sigma**2 + damping) * along)) / weight
            shrink = np.max(np.abs(change) / limit)
            change = change / max(1.0, shrink)
            trial = residuals((x + change)[None])[0]
            count += 1
            foreseen = f + jacobian @ change
            expected = f @ f - foreseen @ foreseen
            gain = (f @ f - trial @ trial) / expected if np.isfinite(trial).all() and expected > 0.0 else -1.0
            if gain > 1e-4:
                damping *= max(1.0 / 10.0, 1.0 - (2.0 * min(gain, 1.5) - 1.0) ** 3)
                growth, moved = 2.0, True
                slow = slow + 1 if trial @ trial > 0.9 * (f @ f) else 0
                x, f = x + change, trial
                break
            damping, growth = damping * growth, growth * 2.0
        if not moved or slow > 8:
            break
    residual = np.inf if f is None else float(np.abs(f).max())
    return Root(x, residual, count)
