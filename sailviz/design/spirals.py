"""Logarithmic spirals of a solar sail at fixed pitch: r = r0 exp(theta tan(gamma)), gamma the flight-path angle.

Source: paper J.9's subject; equations re-derived from the equations of motion and checked against integration.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

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
    feasible: np.ndarray
    reason: str = ""

    def time(self, r0, r1, mu):
        """Flight time in s between two radii in m (r1 on the side the spiral goes), mu in m3/s2."""
        q = np.abs(np.asarray(r1, dtype=float) ** 1.5 - np.asarray(r0, dtype=float) ** 1.5)
        return 2 * q / (3 * np.sqrt(2 * mu * self.transverse * self.slope))

    def angle(self, r0, r1):
        """Swept angle in rad between two radii in m."""
        return np.log(np.asarray(r1, dtype=float) / r0) / self.slope

    def state(self, radius, azimuth, mu):
        """Position m and velocity m/s, each (3,), in the x-y plane at a radius in m and an azimuth in rad."""
        v_t = np.sqrt(self.speed_factor * mu / radius)
        r_hat = np.array([np.cos(azimuth), np.sin(azimuth), 0.0])
        t_hat = np.array([-np.sin(azimuth), np.cos(azimuth), 0.0])
        return radius * r_hat, v_t * (self.slope * r_hat + t_hat)


def logarithmic(lightness, pitch, film: Film | str = "ideal") -> LogarithmicSpiral:
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
        largest = 1 / (film.efficiency * float(k_r + 2 * np.sqrt(2) * abs(k_t)))
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
        feasible[()],
        reason,
    )
