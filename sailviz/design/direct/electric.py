"""An electric sail in the direct method: the convex hull of what it can do.

Its thrust of full voltage is A (3 r_hat + p_hat) / r, A = a_c / 4, p_hat any direction, twice as far from r_hat as the
sail's normal (3.39); with partial voltage tau in [0, 1] of it. The controls are w = tau p_hat and tau:

    a = A (3 tau r_hat + w) / r,  |w| <= tau <= 1,

a convex set, in which arcs of partial voltage are found as any other. Checked against the indirect method.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from sailviz.design.direct.limits import Limits

if TYPE_CHECKING:
    import casadi as ca

    from sailviz.design.direct.frames_of_state import Axes


@dataclass(frozen=True)
class ElectricSail:
    """An electric sail of the final model; strength: its characteristic acceleration in units of mu = 1 and one au."""

    strength: float

    device = "electric-sail"
    fall = 1.0
    throttles = True

    def thrust(self, axes: Axes, x: ca.SX, n: ca.SX, throttle: ca.SX) -> list[ca.SX]:
        """Acceleration along the axes, of n = w; or, where the normal itself turns (`thrust_of_normal`)."""
        size = self.strength / (4 * axes.radius(x))
        return [size * (3 * throttle * o + n[i]) for i, o in enumerate(axes.outward(x))]

    def thrust_of_normal(self, axes: Axes, x: ca.SX, n: ca.SX, throttle: ca.SX) -> list[ca.SX]:
        """Acceleration along the axes, of the unit normal n of the sail's plane: (3.39)."""
        outward = axes.outward(x)
        c = sum(n[i] * o for i, o in enumerate(outward))
        size = self.strength * throttle / (2 * axes.radius(x))
        return [size * (o + c * n[i]) for i, o in enumerate(outward)]

    def constraints(self, axes: Axes, x: ca.SX, n: ca.SX, throttle: ca.SX, limits: Limits) -> list[ca.SX]:
        """Expressions that must not be negative."""
        found = [throttle**2 - sum(n[i] ** 2 for i in range(axes.axes))]
        if limits.cone is not None and limits.cone < np.pi / 2:  # p_hat stands at twice the pitch
            along = sum(n[i] * o for i, o in enumerate(axes.outward(x)))
            found.append(along - throttle * np.cos(2 * limits.cone))
        return found

    def normals(self, outward: np.ndarray, vectors: np.ndarray, throttle: np.ndarray) -> np.ndarray:
        """Unit normals (n, 3), halfway from r_hat to p_hat, of controls (n, 3)."""
        size = np.linalg.norm(vectors, axis=1)
        p = np.where(size[:, None] > 0, vectors / np.maximum(size, 1e-300)[:, None], outward)
        middle = outward + p
        return middle / np.maximum(np.linalg.norm(middle, axis=1), 1e-300)[:, None]

    def vector_of(self, pitch: float) -> tuple[float, float]:
        """The control's parts along r_hat and across, of a pitch, rad."""
        return float(np.cos(2 * pitch)), float(np.sin(2 * pitch))
