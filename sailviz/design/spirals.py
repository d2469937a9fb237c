"""Logarithmic spirals of a solar sail at fixed pitch: r = r0 exp(theta tan(gamma)), gamma the flight-path angle.

Source: paper J.9's subject, not read; equations re-derived from the equations of motion and checked against
integration. The classical approximations are those of small flight-path angles.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from sailviz.design.displaced.force_shape import force_shape
from sailviz.propulsion.solar_sail import FILMS, Film


@dataclass(frozen=True)
class LogarithmicSpiral:
    """slope tan(gamma), flight_path_angle rad, speed_factor v_theta^2 r / mu, and the constant osculating eccentricity
    and true_anomaly rad. Outwards for positive slope. feasible, reason as elsewhere; NaN where infeasible."""

    slope: np.ndarray
    flight_path_angle: np.ndarray
    speed_factor: np.ndarray
    eccentricity: np.ndarray
    true_anomaly: np.ndarray
    transverse: np.ndarray  # eps_theta, transverse acceleration over mu / r^2
    radial: np.ndarray  # eps_r, radial acceleration over mu / r^2
    feasible: np.ndarray
    reason: str = ""

    def time(self, r0: npt.ArrayLike, r1: npt.ArrayLike, mu: float) -> np.ndarray:
        """Flight time in s between two radii in m (r1 on the side the spiral goes), mu in m3/s2."""
        q = np.abs(np.asarray(r1, dtype=float) ** 1.5 - np.asarray(r0, dtype=float) ** 1.5)
        return 2 * q / (3 * np.sqrt(2 * mu * self.transverse * self.slope))

    def angle(self, r0: npt.ArrayLike, r1: npt.ArrayLike) -> np.ndarray:
        """Swept angle in rad between two radii in m."""
        return np.log(np.asarray(r1, dtype=float) / r0) / self.slope

    @property
    def classical_slope(self) -> np.ndarray:
        """tan(gamma) for small angles: 2 eps_t / (1 - eps_r), short by its half square as a share."""
        return np.where(self.feasible, 2 * self.transverse / (1 - self.radial), np.nan)[()]

    @property
    def classical_speed_factor(self) -> np.ndarray:
        """v_theta^2 r / mu of a circular orbit under the Sun lightened by the sail: 1 - eps_r."""
        return np.where(self.feasible, 1 - self.radial, np.nan)[()]

    def classical_time(self, r0: npt.ArrayLike, r1: npt.ArrayLike, mu: float) -> np.ndarray:
        """Flight time in s for small angles: (1 / 3) sqrt(1 - eps_r) (r1^1.5 - r0^1.5) / (|eps_t| sqrt(mu))."""
        q = np.abs(np.asarray(r1, dtype=float) ** 1.5 - np.asarray(r0, dtype=float) ** 1.5)
        return q * np.sqrt(self.classical_speed_factor / mu) / (3 * np.abs(self.transverse))

    def classical_angle(self, r0: npt.ArrayLike, r1: npt.ArrayLike) -> np.ndarray:
        """Swept angle in rad for small angles."""
        return np.log(np.asarray(r1, dtype=float) / r0) / self.classical_slope

    def state(self, radius: float, azimuth: float, mu: float) -> tuple[np.ndarray, np.ndarray]:
        """Position m and velocity m/s, each (3,), in the x-y plane at a radius in m and an azimuth in rad."""
        v_t = np.sqrt(self.speed_factor * mu / radius)
        r_hat = np.array([np.cos(azimuth), np.sin(azimuth), 0.0])
        t_hat = np.array([-np.sin(azimuth), np.cos(azimuth), 0.0])
        return radius * r_hat, v_t * (self.slope * r_hat + t_hat)


def logarithmic(lightness: npt.ArrayLike, pitch: npt.ArrayLike, film: Film | str = "ideal") -> LogarithmicSpiral:
    """The spiral that a lightness number and a pitch in rad allow (negative pitch: inwards); scalars or arrays.

    tan(gamma) is the small root of eps_t T^2 - (1 - eps_r) T + 2 eps_t = 0, with a_r = eps_r mu/r^2, a_t = eps_t
    mu/r^2.
    Feasible where eps_r < 1 and |eps_t| / (1 - eps_r) <= 1 / (2 sqrt 2).
    """
    film = FILMS[film] if isinstance(film, str) else film
    lightness, pitch = np.broadcast_arrays(np.asarray(lightness, dtype=float), np.asarray(pitch, dtype=float))
    k_r, k_t = film.components(pitch)
    eps_r, eps_t = film.efficiency * lightness * k_r, film.efficiency * lightness * k_t
    room = (1 - eps_r) ** 2 - 8 * eps_t**2
    feasible = (eps_r < 1) & (room >= 0) & (eps_t != 0)
    with np.errstate(invalid="ignore", divide="ignore"):
        slope = np.where(feasible, 4 * eps_t / ((1 - eps_r) + np.sqrt(np.where(room > 0, room, 0.0))), np.nan)
        factor = 2 * eps_t / slope
    e_cos, e_sin = factor - 1, 2 * eps_t
    reason = ""
    if lightness.ndim == 0 and not feasible:
        largest = float(largest_lightness(pitch, film))
        reason = (
            "without transverse thrust the orbit is a conic, not a spiral"
            if eps_t == 0
            else f"a lightness number up to {largest:.6g} gives a logarithmic spiral at this pitch"
        )
    return LogarithmicSpiral(
        slope[()],
        np.arctan(slope)[()],
        factor[()],
        np.where(feasible, np.hypot(e_cos, e_sin), np.nan)[()],
        np.where(feasible, np.arctan2(e_sin, e_cos), np.nan)[()],
        eps_t[()],
        eps_r[()],
        feasible[()],
        reason,
    )


def largest_lightness(pitch: npt.ArrayLike, film: Film | str = "ideal") -> np.ndarray:
    """Largest lightness number that still spirals at a pitch in rad, same shape: 1 / (k_r + 2 sqrt(2) |k_t|), at a
    flight-path angle of 54.7356 deg. NaN where the film gives no transverse thrust."""
    film = FILMS[film] if isinstance(film, str) else film
    k_r, k_t = film.components(pitch)
    with np.errstate(divide="ignore"):
        return np.where(k_t == 0, np.nan, 1 / (film.efficiency * (k_r + 2 * np.sqrt(2) * np.abs(k_t))))[()]


@dataclass(frozen=True)
class Insertion:
    """The sail that takes a craft from an ellipse onto a logarithmic spiral without an impulse; NaN where infeasible.

    pitch rad (negative: inwards), lightness; slope tan(gamma) of the spiral, cone rad. reason for scalar requests.
    """

    pitch: np.ndarray
    lightness: np.ndarray
    slope: np.ndarray
    cone: np.ndarray
    feasible: np.ndarray
    reason: str = ""


def insertion(eccentricity: npt.ArrayLike, true_anomaly: npt.ArrayLike, film: Film | str = "ideal") -> Insertion:
    """Pitch and lightness number that continue an ellipse as a spiral with the same position and velocity; broadcast.

    eccentricity in (0, 1), true_anomaly : rad, where the sail opens. eps_t = e sin(nu) / 2 and
    eps_r = -e cos(nu) - e^2 sin^2(nu) / (2 (1 + e cos(nu))), positive near aphelion, never on a circle.
    tan(gamma) = e sin(nu) / (1 + e cos(nu)); over sqrt(2) it is the steep one of the two spirals of this sail.
    Feasible where the cone angle atan2(eps_t, eps_r) is within the film's reach. Re-derived.
    """
    from scipy.optimize import brentq  # half a second to import, seldom needed

    film = FILMS[film] if isinstance(film, str) else film
    shape = force_shape(film)
    e, nu = np.broadcast_arrays(np.asarray(eccentricity, dtype=float), np.asarray(true_anomaly, dtype=float))

    def needs(e, nu):
        c, s = np.cos(nu), np.sin(nu)
        return -e * c - (e * s) ** 2 / (2 * (1 + e * c)), e * s / 2

    eps_r, eps_t = needs(e, nu)
    cone = np.arctan2(eps_t, eps_r)
    limit = shape.cone_limit()
    # the rounding of true anomalies like pi leaves no transverse thrust worth the name
    feasible = (e > 0) & (e < 1) & (eps_r > 0) & (np.abs(cone) <= limit * (1 + 1e-12)) & (np.abs(eps_t) > 1e-15 * e)
    pitch = shape.pitch(np.where(feasible, np.minimum(np.abs(cone), limit), 0.0)) * np.sign(eps_t)
    k_r, _ = film.components(pitch)
    with np.errstate(divide="ignore", invalid="ignore"):
        lightness, slope = eps_r / (film.efficiency * k_r), e * np.sin(nu) / (1 + e * np.cos(nu))
    pitch, lightness, slope, cone = (np.where(feasible, x, np.nan)[()] for x in (pitch, lightness, slope, cone))
    reason = ""
    if e.ndim == 0 and not feasible:
        if not 0 < e < 1:
            reason = "it takes an ellipse: a circle or a hyperbola does not touch a logarithmic spiral"
        elif np.abs(eps_t) <= 1e-15 * e:
            reason = "at an apsis the spiral would be a circle: open the sail before or after aphelion"
        else:
            first = brentq(lambda x: np.arctan2(*needs(float(e), x)[::-1]) - min(limit, np.pi / 2), 1e-9, np.pi)
            reason = (
                f"the film reaches cone angles up to {np.degrees(limit):.5g} deg; true anomalies of "
                f"{np.degrees(first):.4f} to {360 - np.degrees(first):.4f} deg are possible, 180 deg excepted"
            )
    return Insertion(pitch, lightness, slope, cone, feasible[()], reason)
