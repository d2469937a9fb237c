"""A Kepler orbit at the begin or end of a flight: vectors instead of angles, and easier orbits on the way to it."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import numpy.typing as npt

from sailviz.constants import AU
from sailviz.elements import Elements


@dataclass(frozen=True)
class KeplerOrbit:
    """A Kepler orbit in units of au and mu = 1: semi-latus rectum p, eccentricity e, unit vectors towards periapsis
    and a quarter turn ahead of it."""

    p: float
    e: float
    P: np.ndarray
    Q: np.ndarray

    @classmethod
    def from_elements(cls, elements: Elements) -> KeplerOrbit:
        """From elements in m and rad; ValueError for what is no ellipse."""
        a, e, i = (float(x) for x in (elements.semi_major_axis / AU, elements.eccentricity, elements.inclination))
        node, w = float(elements.raan), float(elements.argument)
        if not (0 <= e < 1 and a > 0 and np.isfinite([a, i, node, w]).all()):
            raise ValueError(
                f"a transfer joins ellipses: a semi-major axis of {a:g} au with eccentricity {e:g} is none"
            )
        ahead = np.array([-np.sin(node) * np.cos(i), np.cos(node) * np.cos(i), np.sin(i)])
        along = np.array([np.cos(node), np.sin(node), 0.0])
        P, Q = np.cos(w) * along + np.sin(w) * ahead, np.cos(w) * ahead - np.sin(w) * along
        return cls(a * (1 - e * e), e, P, Q)

    @property
    def semi_major_axis(self) -> float:
        return self.p / (1 - self.e**2)

    @cached_property
    def normal(self) -> np.ndarray:
        """Unit vector (3,) of the angular momentum."""
        return np.cross(self.P, self.Q)

    @property
    def momentum(self) -> np.ndarray:
        """Angular momentum (3,)."""
        return np.sqrt(self.p) * self.normal

    def state(self, anomaly: npt.ArrayLike) -> tuple[np.ndarray, np.ndarray]:
        """Position and velocity, each (..., 3), at true anomalies (...) rad."""
        nu = np.asarray(anomaly, dtype=float)[..., None]
        c, s = np.cos(nu), np.sin(nu)
        position = self.p / (1 + self.e * c) * (c * self.P + s * self.Q)
        return position, (-s * self.P + (self.e + c) * self.Q) / np.sqrt(self.p)

    def anomaly(self, position: np.ndarray) -> float:
        """True anomaly rad of the direction of a position (3,)."""
        return float(np.arctan2(position @ self.Q, position @ self.P))

    def bent(self, share: float, plane: KeplerOrbit, radius: float) -> KeplerOrbit:
        """A share of the way from a circle of some radius in another orbit's plane (0) to this orbit (1)."""
        n0, n = plane.normal, self.normal
        axis = np.cross(n, n0)
        sine, cosine = np.linalg.norm(axis), float(n @ n0)
        axis = axis / sine if sine > 1e-12 else self.P
        turn = (1 - share) * np.arctan2(sine, cosine)
        e = share * self.e
        a = radius ** (1 - share) * self.semi_major_axis**share
        return KeplerOrbit(a * (1 - e * e), e, turned(self.P, axis, turn), turned(self.Q, axis, turn))


def cross(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """a x b of vectors (n, 3), for a fifth of what np.cross takes."""
    out = np.empty_like(a)
    for i, j, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
        out[:, i] = a[:, j] * b[:, k] - a[:, k] * b[:, j]
    return out


def length(a: np.ndarray) -> np.ndarray:
    """|a| (n,) of vectors (n, k)."""
    found: np.ndarray = np.sqrt((a * a).sum(axis=1))
    return found


def turned(x: np.ndarray, axis: np.ndarray, angle: float) -> np.ndarray:
    """Vectors (3,) turned about a unit axis: Rodrigues' formula."""
    return x * np.cos(angle) + np.cross(axis, x) * np.sin(angle) + axis * (axis @ x) * (1 - np.cos(angle))
