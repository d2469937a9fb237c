"""Displaced non-Keplerian orbits: the sail that holds a circle whose plane does not contain the Sun.

Source: thesis, section 4.2, (4.2)-(4.5), read in excerpt; optical films and the feasibility bound re-derived.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sailviz.constants import AU, MU_SUN
from sailviz.design.force_shape import force_shape


@dataclass(frozen=True)
class CircularOrbit:
    """What holds a circular displaced orbit. cone, pitch rad; clock 0 above, pi below the ecliptic; characteristic_acceleration
    m/s2; feasible; reason "" or a sentence (scalar requests). NaN where infeasible."""

    cone: np.ndarray
    pitch: np.ndarray
    clock: np.ndarray
    characteristic_acceleration: np.ndarray
    feasible: np.ndarray
    reason: str = ""


def circular(radius, elevation, rate_ratio, device="electric-sail") -> CircularOrbit:
    """Requirements of a circular displaced orbit; scalars or arrays, broadcast.

    radius : m, distance from the Sun. elevation : rad over the ecliptic, negative below. rate_ratio : Omega / sqrt(mu / r^3).
    device : "electric-sail" (final model), a film's name or a Film. The thrust lies in the meridian plane:
    tan(phi) = w sin(psi) cos(psi) / (1 - w cos^2(psi)), w = rate_ratio^2                                          (4.4)
    a_c from |a| = (mu / r^2) sqrt(1 - 2 w cos^2(psi) + w^2 cos^2(psi))                                            (4.5)
    """
    r, psi, ratio = np.broadcast_arrays(*(np.asarray(x, dtype=float) for x in (radius, elevation, rate_ratio)))
    shape = force_shape(device)
    w, c, s = ratio**2, np.cos(psi), np.abs(np.sin(psi))
    outward, sideways = 1 - w * c * c, w * s * c  # in units of mu / r^2: (4.2), (4.3)
    cone = np.arctan2(sideways, outward)
    limit = shape.cone_limit()
    feasible = (outward > 0) & (cone <= limit * (1 + 1e-12)) & (r > 0)
    pitch = np.where(feasible, shape.pitch(np.where(feasible, np.minimum(cone, limit), 0.0)), np.nan)
    k_r, k_t = shape.components(pitch)
    size = np.hypot(outward, sideways)
    ac = np.where(feasible, MU_SUN * size / (r**2 * np.hypot(k_r, k_t)) * (r / AU) ** shape.exponent, np.nan)
    reason = ""
    if r.ndim == 0 and not feasible:
        if not r > 0:
            reason = "the distance from the Sun must be positive"
        elif outward <= 0:
            reason = (
                f"at {float(ratio):.4g} of the Keplerian rate the thrust would have to point towards the Sun; "
                f"below {1 / float(c):.4g} it points outwards"
            )
        else:
            reason = (
                f"it needs a cone angle of {np.degrees(float(cone)):.4g} deg, the device reaches {np.degrees(limit):.4g} deg; "
                f"a rate ratio up to {float(largest_rate_ratio(psi, device)):.4g} is possible"
            )
    return CircularOrbit(
        np.where(feasible, cone, np.nan)[()], pitch[()], np.where(psi < 0, np.pi, 0.0)[()], ac[()], feasible[()], reason
    )


def largest_rate_ratio(elevation, device="electric-sail"):
    """Largest feasible Omega / Omega_K at an elevation in rad, same shape: w <= T / (s c + T c^2), T = tan(cone limit)."""
    limit = force_shape(device).cone_limit()
    c, s = np.cos(elevation), np.abs(np.sin(elevation))
    return np.sqrt(np.sin(limit) / (s * c * np.cos(limit) + np.sin(limit) * c * c))


def state(radius, elevation, rate_ratio, azimuth=0.0):
    """Position m and velocity m/s, each (3,), on the orbit: same arguments, azimuth rad from the x axis."""
    rho, z = radius * np.cos(elevation), radius * np.sin(elevation)
    speed = rate_ratio * np.sqrt(MU_SUN / radius**3) * rho
    c, s = np.cos(azimuth), np.sin(azimuth)
    return np.array([rho * c, rho * s, z]), np.array([-speed * s, speed * c, 0.0])
