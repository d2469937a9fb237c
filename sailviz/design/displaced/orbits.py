"""Displaced non-Keplerian orbits: the sail that holds an orbit whose plane does not contain the Sun.

Circles here; ellipses and prescribed tracks in `tracks`, stability in `linear_stability`.
Source: thesis, section 4.2, (4.2)-(4.7), read in excerpt; optical films, feasibility bounds and all after (4.7)
re-derived.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import numpy.typing as npt

from sailviz.constants import AU, MU_SUN
from sailviz.design.displaced.force_shape import force_shape
from sailviz.design.displaced.holding import Holding, attitude
from sailviz.propulsion.solar_sail import Film


def circular(
    radius: npt.ArrayLike, elevation: npt.ArrayLike, rate_ratio: npt.ArrayLike, device: Film | str = "electric-sail"
) -> Holding:
    """Requirements of a circular displaced orbit; scalars or arrays, broadcast.

    radius : m, distance from the Sun. elevation : rad over the ecliptic, negative below. rate_ratio : Omega / sqrt(mu /
    r^3).
    device : "electric-sail" (final model), a film's name or a Film. The thrust lies in the meridian plane:
    tan(phi) = w sin(psi) cos(psi) / (1 - w cos^2(psi)), w = rate_ratio^2                                          (4.4)
    a_c from |a| = (mu / r^2) sqrt(1 - 2 w cos^2(psi) + w^2 cos^2(psi))                                            (4.5)
    The clock angle is 0 above, pi below the ecliptic.
    """
    r, psi, ratio = np.broadcast_arrays(*(np.asarray(x, dtype=float) for x in (radius, elevation, rate_ratio)))
    w, c, s = ratio**2, np.cos(psi), np.abs(np.sin(psi))
    outward, sideways = 1 - w * c * c, w * s * c  # in units of mu / r^2: (4.2), (4.3)
    with np.errstate(divide="ignore"):
        gravity = MU_SUN / r**2
    cone, pitch, ac, feasible = attitude(r, gravity * outward, gravity * sideways, device)
    reason = ""
    if r.ndim == 0 and not feasible:
        limit = force_shape(device).cone_limit()
        if not r > 0:
            reason = "the distance from the Sun must be positive"
        elif outward <= 0:
            possible = largest_rate_ratio(psi, device)
            reason = (
                f"at {float(ratio):.4g} of the Keplerian rate the thrust would have to point towards the Sun; "
                f"a rate ratio up to {float(possible):.4g} is possible"
            )
        else:
            reason = (
                f"it needs a cone angle of {np.degrees(np.arctan2(sideways, outward)):.4g} deg, "
                f"the device reaches {np.degrees(limit):.4g} deg; "
                f"a rate ratio up to {float(largest_rate_ratio(psi, device)):.4g} is possible"
            )
    clock = np.where(feasible, np.where(psi < 0, np.pi, 0.0), np.nan)
    size = gravity * np.hypot(outward, sideways)
    return Holding(cone[()], pitch[()], clock[()], ac[()], size[()], feasible[()], reason)


def largest_rate_ratio(elevation: npt.ArrayLike, device: Film | str = "electric-sail") -> np.ndarray:
    """Largest feasible Omega / Omega_K at an elevation in rad, same shape: w <= T / (s c + T c^2), T = tan(cone
    limit)."""
    limit = force_shape(device).cone_limit()
    c, s = np.cos(elevation), np.abs(np.sin(elevation))
    return np.sqrt(np.sin(limit) / (s * c * np.cos(limit) + np.sin(limit) * c * c))


def type_ii(radius: npt.ArrayLike, elevation: npt.ArrayLike, device: Film | str = "electric-sail") -> Holding:
    """Requirements of a Type II orbit, which keeps the period of a Keplerian orbit of its radius: phi = 90 deg - psi.
    (4.7)

    radius m, elevation rad, broadcast. Feasible from an elevation of 90 deg less the device's largest cone angle on:
    70.5288 deg for the electric sail, exact. a_c r / r_E = (mu / r_E^2) sin(psi) / gamma falls with elevation there.
    """
    found = circular(radius, elevation, 1.0, device)
    if found.reason and np.asarray(radius) > 0:
        least = 90 - np.degrees(force_shape(device).cone_limit())
        return replace(found, reason=f"a Type II orbit of this device needs an elevation of {least:.6g} deg or more")
    return found


def ecliptic(radius: npt.ArrayLike, rate_ratio: npt.ArrayLike, device: Film | str = "electric-sail") -> Holding:
    """Requirements of a circular orbit in the ecliptic at other than the Keplerian rate: Sun-facing. radius m,
    broadcast."""
    return circular(radius, 0.0, rate_ratio, device)


def heliostationary(radius: npt.ArrayLike, device: Film | str = "electric-sail") -> Holding:
    """Requirements for resting at a distance in m from the Sun, in any direction: Sun-facing, |a| = mu / r^2."""
    return circular(radius, 0.0, 0.0, device)


def lagrange_point(
    radius: npt.ArrayLike,
    device: Film | str = "electric-sail",
    *,
    planet_mu: npt.ArrayLike = 0.0,
    planet_orbit: npt.ArrayLike = AU,
) -> Holding:
    """Requirements of an artificial Lagrange point on the line from the Sun to a planet; scalars or arrays, broadcast.

    radius : m from the Sun. planet_mu : m3/s2, 0 leaves the planet's gravity out (constants.MU_EARTH for the Earth).
    planet_orbit : m, its circular orbit. The sail faces the Sun and gives
    a_r = mu / r^2 - Omega^2 r -+ mu_p / (r_p - r)^2 + mu_p / r_p^2, Omega^2 = (mu + mu_p) / r_p^3, upper sign inside
    the planet's orbit; the last term is the Sun's own fall towards the planet. Re-derived; exact for two bodies on
    circles about each other. Neglected: the eccentricity of the planet's orbit, by which the point would have to
    move to and fro by e r_p (1.7 % for the Earth), its moons, other planets.
    """
    from scipy.optimize import brentq  # half a second to import, seldom needed

    r, orbit, mu = np.broadcast_arrays(*(np.asarray(x, dtype=float) for x in (radius, planet_orbit, planet_mu)))

    def outward(r, orbit=orbit, mu=mu):
        with np.errstate(divide="ignore", invalid="ignore"):
            pull = np.where(mu > 0, mu / (orbit - r) ** 2, 0.0)
        fall = mu / orbit**2 - mu * r / orbit**3  # of the Sun towards the planet, less what that adds to Omega^2 r
        return MU_SUN / r**2 - MU_SUN * r / orbit**3 - np.sign(orbit - r) * pull + fall

    with np.errstate(divide="ignore"):
        size = outward(r)
    with np.errstate(invalid="ignore"):
        cone, pitch, ac, feasible = attitude(r, size, 0.0 * size, device)
    reason = ""
    if r.ndim == 0 and not feasible:
        o, m = float(orbit), float(mu)
        if not r > 0:
            reason = "the distance from the Sun must be positive"
        elif m == 0:
            reason = f"the thrust would have to point towards the Sun; up to {o / AU:.6g} au it points outwards"
        else:
            hill = o * np.cbrt(m / (3 * MU_SUN))
            inner = brentq(lambda x: float(outward(x, o, m)), o - 3 * hill, o - 0.3 * hill)
            outer = brentq(lambda x: float(outward(x, o, m)), o + 0.3 * hill, o + 3 * hill)
            reason = (
                f"the thrust would have to point towards the Sun; it points outwards up to {inner / AU:.7g} au "
                f"and from {o / AU:.7g} to {outer / AU:.7g} au"
            )
    clock = np.where(feasible, 0.0, np.nan)
    return Holding(cone[()], pitch[()], clock[()], ac[()], np.abs(size)[()], feasible[()], reason)


def state(radius: float, elevation: float, rate_ratio: float, azimuth: float = 0.0) -> tuple[np.ndarray, np.ndarray]:
    """Position m and velocity m/s, each (3,), on the circular orbit: same arguments, azimuth rad from the x axis."""
    rho, z = radius * np.cos(elevation), radius * np.sin(elevation)
    speed = rate_ratio * np.sqrt(MU_SUN / radius**3) * rho
    c, s = np.cos(azimuth), np.sin(azimuth)
    return np.array([rho * c, rho * s, z]), np.array([-speed * s, speed * c, 0.0])
