"""A film in the direct method: its normal as the control.

a = (a_c / (b1 + b2 + b3)) r^-2 c [b1 r_hat + (b2 c + b3) n], c = n . r_hat >= 0, |n| = 1: (3.17), (3.23). No angles,
which would turn round where the sail faces the Sun.

While it searches |n| <= 1 holds, which stays within the convex hull of what the film can do and lets the sail change
sides through no thrust; the fastest flight has |n| = 1 wherever a thrust is worth something, and else none.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from sailviz.design.direct.limits import Limits, heat_factor
from sailviz.propulsion.solar_sail import Film

HALF = 0.5  # length of a control below which it stands for no thrust

if TYPE_CHECKING:
    import casadi as ca

    from sailviz.design.direct.frames_of_state import Axes


@dataclass(frozen=True)
class FilmSail:
    """A film as `transcription` reads it: strength is its characteristic acceleration in units of mu = 1 and one au."""

    device: Film | str
    film: Film
    strength: float

    fall = 2.0
    throttles = False  # its thrust is the attitude's alone

    def thrust(self, axes: Axes, x: ca.SX, n: ca.SX, throttle: ca.SX | None) -> list[ca.SX]:
        """Acceleration along the axes, of a normal n."""
        outward, r = axes.outward(x), axes.radius(x)
        c = sum(n[i] * outward[i] for i in range(axes.axes))
        size = self.strength / self.film.total * c / r**2
        along = self.film.b2 * c + self.film.b3
        return [size * (self.film.b1 * outward[i] + along * n[i]) for i in range(axes.axes)]

    def constraints(self, axes: Axes, x: ca.SX, n: ca.SX, throttle: ca.SX | None, limits: Limits) -> list[ca.SX]:
        """Expressions that must not be negative."""
        c = sum(n[i] * o for i, o in enumerate(axes.outward(x)))
        found = [c - (0.0 if limits.cone is None else np.cos(limits.cone))]
        if limits.hottest is not None:
            found.append(heat_factor(limits.hottest, self.device) * axes.radius(x) ** 2 - c)
        return found

    def normals(self, outward: np.ndarray, vectors: np.ndarray, throttle: np.ndarray) -> np.ndarray:
        """Unit normals (n, 3) of controls (n, 3); edge-on where those are short, which is no thrust."""
        size = np.linalg.norm(vectors, axis=1)[:, None]
        along = np.sum(vectors * outward, axis=1)[:, None]
        across = vectors - along * outward
        edge = across / np.maximum(np.linalg.norm(across, axis=1), 1e-300)[:, None]
        return np.asarray(np.where(size > HALF, vectors / np.maximum(size, HALF), edge))

    def vector_of(self, pitch: float) -> tuple[float, float]:
        """The control's parts along r_hat and across, of a pitch, rad."""
        return float(np.cos(pitch)), float(np.sin(pitch))
