"""How the force of a sail points and weakens with pitch, for designers: one face for films and the electric sail.

A force is a = a_c (r_E / r)^k (k_r r_hat + k_t t_hat) at pitch alpha; the cone angle is atan2(k_t, k_r).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
import numpy.typing as npt

from sailviz.propulsion import electric_sail
from sailviz.propulsion.solar_sail import FILMS, Film


@dataclass(frozen=True)
class ForceShape:
    """film : the solar sail's Film, None for the electric sail (final model). exponent : k above."""

    film: Film | None
    exponent: int

    def components(self, pitch: npt.ArrayLike) -> tuple[np.ndarray, np.ndarray]:
        """(k_r, k_t) at a pitch in rad; sqrt(k_r^2 + k_t^2) is 1 facing the Sun."""
        if self.film is not None:
            return self.film.components(pitch)
        c, s = np.cos(pitch), np.sin(pitch)
        return (1 + c * c) / 2, s * c / 2  # (3.39) along r_hat and t_hat

    def cone_limit(self) -> float:
        """Largest cone angle, rad."""
        if self.film is None:
            return float(electric_sail.CONE_MAX)
        return _film_limit(self.film)[0]

    def slope_limit(self) -> float:
        """Tangent of the largest cone angle, exact for the electric sail: 1 / (2 sqrt 2)."""
        return 1 / (2 * np.sqrt(2)) if self.film is None else float(np.tan(self.cone_limit()))

    def pitch(self, cone: npt.ArrayLike) -> np.ndarray:
        """The smaller pitch that gives a cone angle >= 0, rad, same shape; NaN beyond the limit."""
        if self.film is None:
            return electric_sail.pitch_angle(cone)
        return _film_pitch(self.film, np.asarray(cone, dtype=float))


def force_shape(device: Film | str) -> ForceShape:
    """ForceShape of "electric-sail", of a film's name, or of a Film. ValueError for anything else."""
    if isinstance(device, Film):
        return ForceShape(device, 2)
    if device == "electric-sail":
        return ForceShape(None, 1)
    if device in FILMS:
        return ForceShape(FILMS[device], 2)
    known = ", ".join(["electric-sail", *FILMS])
    raise ValueError(f"{device!r} is no device for a design; there are {known}, or a Film of your own")


def _film_cone(film, pitch):
    k_r, k_t = film.components(pitch)
    return np.arctan2(k_t, k_r)


@lru_cache(maxsize=64)
def _film_limit(film) -> tuple[float, float]:
    """(largest cone angle, pitch where it is reached), rad. An ideal film tends to 90 deg edge-on, without force.

    cos(alpha) divides out of both components; the maximum of k_t / k_r is found by golden section: it is unimodal.
    """

    def cone(alpha):
        c, s = np.cos(alpha), np.sin(alpha)
        return np.arctan2((film.b2 * c + film.b3) * s, film.b1 + (film.b2 * c + film.b3) * c)

    if film.b1 == 0.0 and film.b3 == 0.0:
        return np.pi / 2, np.pi / 2
    low, high, golden = 0.5, np.pi / 2, (np.sqrt(5) - 1) / 2
    for _ in range(80):
        a, b = high - golden * (high - low), low + golden * (high - low)
        low, high = (a, high) if cone(a) < cone(b) else (low, b)
    best = (low + high) / 2
    return float(cone(best)), float(best)


def _film_pitch(film, cone):
    limit, at = _film_limit(film)
    low, high = np.zeros_like(cone), np.full_like(cone, at)
    for _ in range(60):  # bisection to the last bit: the cone angle grows with pitch up to `at`
        middle = (low + high) / 2
        below = _film_cone(film, middle) < cone
        low, high = np.where(below, middle, low), np.where(below, high, middle)
    inside = (cone >= 0) & (cone <= limit * (1 + 1e-12))
    return np.where(inside, (low + high) / 2, np.nan)
