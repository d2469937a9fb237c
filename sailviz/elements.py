"""Osculating orbital elements and back. SI and radians, two-body, any central body."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Generic, TypeVar

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

CIRCULAR = 1e-11  # eccentricity below which the apse line is rounding noise
PARABOLIC = 1e-14  # of the distance over the semi-major axis, which below is rounding and none
EQUATORIAL = 1e-11  # sine of the inclination below which the node is rounding noise
Number = TypeVar("Number", bound=np.ndarray | float, covariant=True)  # columns (n,), or one of each


@dataclass(frozen=True)
class Elements(Generic[Number]):
    """Classical elements, each (n,) or scalar: semi_major_axis m (negative on a hyperbola, inf on a parabola),
    eccentricity, inclination, raan (right ascension or longitude of the ascending node), argument (of periapsis),
    true_anomaly rad."""

    semi_major_axis: Number
    eccentricity: Number
    inclination: Number
    raan: Number
    argument: Number
    true_anomaly: Number


def elements(position: ArrayLike, velocity: ArrayLike, mu: float) -> Elements[np.ndarray]:
    """Osculating elements of a state. position m, velocity m/s : (..., 3), mu m3/s2.

    Conventions where an angle loses its meaning: on an equatorial orbit the node is the x axis (raan 0), on a
    circular orbit the periapsis is the node (argument 0). Without angular momentum inclination, raan and argument
    are NaN. Source: Bate, Mueller and White, Fundamentals of Astrodynamics (1971), section 2.4; angles by atan2.
    """
    r_vec, v_vec = np.broadcast_arrays(np.asarray(position, float), np.asarray(velocity, float))
    r = np.linalg.norm(r_vec, axis=-1)
    v2 = np.sum(v_vec * v_vec, axis=-1)
    h_vec = np.cross(r_vec, v_vec)
    h = np.linalg.norm(h_vec, axis=-1)
    e_vec = np.cross(v_vec, h_vec) / mu - r_vec / r[..., None]
    e = np.linalg.norm(e_vec, axis=-1)
    with np.errstate(divide="ignore", invalid="ignore"):
        inverse = 2.0 / r - v2 / mu
        a = np.where(np.abs(inverse) < PARABOLIC / r, np.inf, 1.0 / inverse)
        h_hat = np.where((h > 1e-14 * r * np.sqrt(v2))[..., None], h_vec / h[..., None], np.nan)
    sin_i = np.hypot(h_hat[..., 0], h_hat[..., 1])
    inclination = np.arctan2(sin_i, h_hat[..., 2])
    flat = sin_i < EQUATORIAL
    raan = np.where(flat, 0.0, np.arctan2(h_hat[..., 0], -h_hat[..., 1]))
    node = np.stack([np.cos(raan), np.sin(raan), np.zeros_like(raan)], axis=-1)
    ahead = np.cross(h_hat, node)  # 90 degrees ahead of the node, in the orbit plane
    round_ = e < CIRCULAR
    argument = np.where(round_, 0.0, np.arctan2(np.sum(e_vec * ahead, -1), np.sum(e_vec * node, -1)))
    latitude = np.arctan2(np.sum(r_vec * ahead, -1), np.sum(r_vec * node, -1))
    anomaly = np.mod(latitude - argument, 2 * np.pi)
    return Elements(a, e, inclination, np.mod(raan, 2 * np.pi), np.mod(argument, 2 * np.pi), anomaly)


def periapsis(orbit: Elements[np.ndarray]) -> np.ndarray:
    """Distance (n,) m of the nearest point from the centre; NaN on a parabola, which has no axis."""
    a = np.where(np.isfinite(orbit.semi_major_axis), orbit.semi_major_axis, np.nan)
    found: np.ndarray = a * (1 - orbit.eccentricity)
    return found


def apoapsis(orbit: Elements[np.ndarray]) -> np.ndarray:
    """Distance (n,) m of the farthest point from the centre; NaN on an open orbit, which has none."""
    a = np.where(np.isfinite(orbit.semi_major_axis), orbit.semi_major_axis, np.nan)
    return np.where(orbit.eccentricity < 1, a * (1 + orbit.eccentricity), np.nan)


def state(
    semi_major_axis: ArrayLike,
    eccentricity: ArrayLike,
    inclination: ArrayLike,
    raan: ArrayLike,
    argument: ArrayLike,
    true_anomaly: ArrayLike,
    mu: float,
) -> tuple[np.ndarray, np.ndarray]:
    """Position m and velocity m/s, each (..., 3), of elements in m and rad; negative semi-major axis for a hyperbola.

    Source: Bate, Mueller and White (1971), section 2.5.
    """
    a, e, i, node, w, nu = np.broadcast_arrays(semi_major_axis, eccentricity, inclination, raan, argument, true_anomaly)
    p = a * (1 - e * e)
    r = p / (1 + e * np.cos(nu))
    u = nu + w
    cos_node, sin_node, cos_i, sin_i = np.cos(node), np.sin(node), np.cos(i), np.sin(i)

    def in_plane(x: np.ndarray, y: np.ndarray) -> np.ndarray:  # x along the node, y ahead of it
        return np.stack([x * cos_node - y * sin_node * cos_i, x * sin_node + y * cos_node * cos_i, y * sin_i], axis=-1)

    speed = np.sqrt(mu / p)
    position = in_plane(r * np.cos(u), r * np.sin(u))
    velocity = in_plane(-speed * (np.sin(u) + e * np.sin(w)), speed * (np.cos(u) + e * np.cos(w)))
    return position, velocity


def mean_semi_major_axis(position: ArrayLike, velocity: ArrayLike, mu: float, oblateness: float) -> np.ndarray:
    """Semi-major axis (...,) m without the swing that an oblate body forces on it within a revolution.

    position m, velocity m/s : (..., 3), mu m3/s2, oblateness = J2 R^2 in m2. First order in J2, some ten metres in low
    Earth orbit; it is the mean over time of the osculating one. NaN where there is no revolution, from escape speed on.
    Source: the energy integral in the J2 field; its mean
    as in D. Brouwer, Astron. J. 64, 378 (1959).
    """
    r_vec, v_vec = np.asarray(position, float), np.asarray(velocity, float)
    r = np.linalg.norm(r_vec, axis=-1)
    h = np.cross(r_vec, v_vec)
    h2 = np.sum(h * h, axis=-1)
    energy = 2.0 / r - np.sum(v_vec * v_vec, axis=-1) / mu
    a = 1.0 / np.where(energy > PARABOLIC / r, energy, np.nan)
    h2 = np.where(h2 > 0, h2, np.nan)
    sin2_i = 1.0 - h[..., 2] ** 2 / h2
    now = (a / r) ** 3 * (1.0 - 3.0 * (r_vec[..., 2] / r) ** 2)
    mean = (1.0 - 1.5 * sin2_i) * (mu * a / h2) ** 1.5
    found: np.ndarray = a - oblateness / a * (now - mean)
    return found


def osculating_radius(mean_radius: float, inclination: float, argument_of_latitude: float, oblateness: float) -> float:
    """Radius m of the osculating circle whose mean semi-major axis about an oblate body is mean_radius.

    inclination, argument_of_latitude rad; oblateness = J2 R^2 in m2. First order in J2, as `mean_semi_major_axis`.
    """
    sin2_i = np.sin(inclination) ** 2
    swing = 1.5 * sin2_i * (1.0 - 2.0 * np.sin(argument_of_latitude) ** 2)
    radius = mean_radius
    for _ in range(4):
        radius = mean_radius + oblateness / radius * swing
    return radius
