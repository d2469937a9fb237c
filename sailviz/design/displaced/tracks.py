"""Displaced orbits that are no circles: above a planet on its ellipse, a flat ellipse, any track that is prescribed.

Source: thesis, section 4.3, not read; re-derived from spherical kinematics and checked by integration.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from sailviz.constants import AU, MU_SUN
from sailviz.design.displaced.force_shape import force_shape
from sailviz.design.displaced.holding import Motion, Track, hold_track
from sailviz.propulsion.solar_sail import Film


def planet_following(
    semi_major_axis: npt.ArrayLike,
    eccentricity: npt.ArrayLike,
    true_anomaly: npt.ArrayLike,
    elevation: npt.ArrayLike,
    radius_ratio: npt.ArrayLike = 1.0,
    device: Film | str = "electric-sail",
) -> Track:
    """Requirements for keeping a planet's longitude at a fixed elevation; all broadcast.

    semi_major_axis : m, eccentricity < 1, true_anomaly : rad, of the planet (any number of revolutions); perihelion on
    the x axis. elevation : rad. radius_ratio : distance of the craft over that of the planet, from the Sun. With L =
    ratio^3, in units of mu/r^2: a_r = 1 - L cos^2(psi) + L e cos(nu) sin^2(psi), a_perp = L sin(psi) cos(psi) (1 + e
    cos(nu)).
    With ratio 1 the cone angle is 90 deg - psi all along: a constant attitude, only the voltage follows the planet,
    max / min = ((1 + e) / (1 - e))^2. Gravity of the planet neglected.
    """
    a, e, nu, psi, ratio = np.broadcast_arrays(
        *(np.asarray(x, dtype=float) for x in (semi_major_axis, eccentricity, true_anomaly, elevation, radius_ratio))
    )
    p = a * (1 - e * e)
    w = 1 + e * np.cos(nu)
    planet, rate = p / w, np.sqrt(MU_SUN / p**3) * w**2
    speed, fall = np.sqrt(MU_SUN / p) * e * np.sin(nu), MU_SUN / p**2 * w**2 * (w - 1)  # r' and r'' of the planet

    def reason():
        if not (a > 0 and 0 <= e < 1 and ratio > 0):
            return "an ellipse needs a positive axis, an eccentricity under 1 and a positive distance"
        t, s, c = force_shape(device).slope_limit(), abs(np.sin(psi)), np.cos(psi)
        burden = s * c * w / t + c * c - e * np.cos(nu) * s * s  # times L, at most 1
        most = np.cbrt(1 / burden) if burden > 0 else np.inf
        return f"here the device allows up to {float(most):.6g} of the planet's distance, not {float(ratio):.6g}"

    azimuth_rate_change = -2 * rate * speed / planet
    zero = np.zeros_like(nu)
    return hold_track(
        _time(a, e, nu, MU_SUN),
        (ratio * planet, ratio * speed, ratio * fall),
        (psi, zero, zero),
        (nu, rate, azimuth_rate_change),
        MU_SUN,
        device,
        reason,
    )


def flat_ellipse(
    semi_latus_rectum: npt.ArrayLike,
    eccentricity: npt.ArrayLike,
    true_anomaly: npt.ArrayLike,
    height: npt.ArrayLike,
    mu_ratio: npt.ArrayLike = 1.0,
    device: Film | str = "electric-sail",
) -> Track:
    """Requirements for a Keplerian ellipse lifted off the ecliptic: its focus above the Sun; all broadcast.

    semi_latus_rectum : m, eccentricity < 1, true_anomaly : rad from the perihelion on the x axis. height : m over the
    ecliptic, negative below. mu_ratio : mu' / mu, the gravity under which the ellipse is run through.
    rho = p / (1 + e cos(nu)), a_rho = mu rho / r^3 - mu' / rho^2, a_z = mu z / r^3.
    """
    p, e, nu, z, k = np.broadcast_arrays(
        *(np.asarray(x, dtype=float) for x in (semi_latus_rectum, eccentricity, true_anomaly, height, mu_ratio))
    )
    mu = k * MU_SUN
    w = 1 + e * np.cos(nu)
    rho, rate = p / w, np.sqrt(mu / p**3) * w**2
    rho_d, rho_dd = np.sqrt(mu / p) * e * np.sin(nu), mu / p**2 * w**2 * (w - 1)
    r = np.hypot(rho, z)
    r_d = rho * rho_d / r
    r_dd = (rho_d**2 + rho * rho_dd - r_d**2) / r
    psi_d = -z * rho_d / r**2
    psi_dd = -z * rho_dd / r**2 + 2 * z * rho_d * r_d / r**3

    def reason():
        if not (p > 0 and 0 <= e < 1 and k >= 0):
            return "an ellipse needs a positive parameter, an eccentricity under 1 and gravity"
        t = force_shape(device).slope_limit()
        most = rho / r / (abs(z) / (rho * t) + 1)
        return f"at this point the device allows mu' / mu up to {float(most):.6g}, not {float(k):.6g}"

    with np.errstate(divide="ignore", invalid="ignore"):
        time = _time(p / (1 - e * e), e, nu, mu)
    return hold_track(
        time,
        (r, r_d, r_dd),
        (np.arctan2(z, rho), psi_d, psi_dd),
        (nu, rate, -2 * rate * rho_d / rho),
        MU_SUN,
        device,
        reason,
    )


def track(
    time: npt.ArrayLike, radius: Motion, elevation: Motion, azimuth: Motion, device: Film | str = "electric-sail"
) -> Track:
    """Requirements for a prescribed track. radius m, elevation rad, azimuth rad: each (value, rate, second rate) over
    time in s, scalars or arrays, all broadcast."""
    return hold_track(
        time,
        radius,
        elevation,
        azimuth,
        MU_SUN,
        device,
        lambda: "the device cannot push in the direction that is needed here",
    )


def sampled_track(time: npt.ArrayLike, position: npt.ArrayLike, device: Film | str = "electric-sail") -> Track:
    """Requirements for a track that is given as points. time (n,) s, increasing, n >= 8; position (n, 3) m from the
    Sun.

    Differentiated as a spline of degree 7: with 100 points a revolution the thrust is good to about 1e-8, less at the
    ends (1e-4). On the z axis the azimuth, and with it the result, is undefined.
    """
    from scipy.interpolate import make_interp_spline  # half a second to import, seldom needed

    time, position = np.asarray(time, dtype=float), np.asarray(position, dtype=float) / AU
    if time.ndim != 1 or len(time) < 8 or position.shape != (len(time), 3) or not np.all(np.diff(time) > 0):
        raise ValueError("a sampled track needs eight increasing times (n,) or more, and positions (n, 3)")
    scale = time[-1] - time[0]
    curve = make_interp_spline((time - time[0]) / scale, position, k=7)
    x, v, a = (curve((time - time[0]) / scale, nu=k) / scale**k for k in range(3))
    rho2 = x[:, 0] ** 2 + x[:, 1] ** 2
    rho, r = np.sqrt(rho2), np.sqrt(rho2 + x[:, 2] ** 2)
    rho_d = (x[:, 0] * v[:, 0] + x[:, 1] * v[:, 1]) / rho
    theta_d = (x[:, 0] * v[:, 1] - x[:, 1] * v[:, 0]) / rho2
    rho_dd = (x[:, 0] * a[:, 0] + x[:, 1] * a[:, 1]) / rho + rho * theta_d**2
    theta_dd = (x[:, 0] * a[:, 1] - x[:, 1] * a[:, 0]) / rho2 - 2 * rho_d * theta_d / rho
    z, z_d, z_dd = x[:, 2], v[:, 2], a[:, 2]
    r_d = (rho * rho_d + z * z_d) / r
    r_dd = (rho_d**2 + rho * rho_dd + z_d**2 + z * z_dd - r_d**2) / r
    psi_d = (rho * z_d - z * rho_d) / r**2
    psi_dd = (rho * z_dd - z * rho_dd) / r**2 - 2 * r_d * psi_d / r
    return hold_track(
        time,
        (AU * r, AU * r_d, AU * r_dd),
        (np.arctan2(z, rho), psi_d, psi_dd),
        (np.unwrap(np.arctan2(x[:, 1], x[:, 0])), theta_d, theta_dd),
        MU_SUN,
        device,
    )


def _time(a, e, nu, mu):
    """Time in s since perihelion at a true anomaly in rad of any size: Kepler's equation."""
    b = e / (1 + np.sqrt(1 - e * e))
    anomaly = nu - 2 * np.arctan2(b * np.sin(nu), 1 + b * np.cos(nu))
    return np.sqrt(a**3 / mu) * (anomaly - e * np.sin(anomaly))
