"""Orbits that a designed thrust holds: displaced, following a planet, at a Lagrange point; and that thrust."""

from __future__ import annotations

import numpy as np
from independent.constants import AU, MU_SUN
from independent.film import esail_force, film_components
from scipy.optimize import brentq

PLANETS = {  # semi-major axis au and eccentricity at J2000: Standish, JPL
    "mercury": (0.38709927, 0.20563593),
    "venus": (0.72333566, 0.00677672),
    "earth": (1.00000261, 0.01671123),
    "mars": (1.52371034, 0.09339410),
    "jupiter": (5.20288700, 0.04838624),
}


def held(scene, t):
    """(position, velocity, thrust acceleration that holds it) on the designed orbit at time t."""
    start = scene.start
    if start.kind == "displaced" or start.kind == "heliostationary":
        ratio = start.rate_ratio if start.kind == "displaced" else 0.0
        rate, azimuth = ratio * np.sqrt(MU_SUN / start.radius**3), start.azimuth
        rho, z = start.radius * np.cos(start.elevation), start.radius * np.sin(start.elevation)
        r, v, a = circling(rho, z, rate, azimuth + rate * t)
    elif start.kind == "lagrange-point":
        third = scene.environment.third_body
        mu, radius, azimuth = (third.mu, third.radius, third.azimuth) if third else (0.0, AU, 0.0)
        rate = np.sqrt((MU_SUN + mu) / radius**3)
        r, v, a = circling(start.radius, 0.0, rate, azimuth + rate * t)
        a = a - third_body(scene, t, r)
    elif start.kind == "planet-following":
        # r = k times the planet's ellipse, at the planet's longitude and a fixed elevation
        a, e = PLANETS[start.planet] if start.planet else (start.semi_major_axis / AU, start.eccentricity)
        x, dx, ddx = ellipse(a * AU, e, MU_SUN, start.true_anomaly, t)
        up = np.array([0, 0, np.tan(start.elevation)])
        k = start.radius_ratio * np.cos(start.elevation)
        size = np.linalg.norm(x)
        speed = x @ dx / size
        bend = (dx @ dx + x @ ddx - speed**2) / size
        r, v, a = k * (x + size * up), k * (dx + speed * up), k * (ddx + bend * up)
    elif start.kind == "flat-ellipse":
        e = start.eccentricity
        r, v, a = ellipse(start.semi_latus_rectum / (1 - e * e), e, start.mu_ratio * MU_SUN, start.true_anomaly, t)
        r = r + np.array([0, 0, start.height])
    else:
        raise NotImplementedError(start.kind)
    return r, v, a + MU_SUN * r / np.linalg.norm(r) ** 3


def circling(rho, z, rate, angle):
    """Position, velocity and acceleration on a circle about the z axis."""
    out, along = np.array([np.cos(angle), np.sin(angle), 0]), np.array([-np.sin(angle), np.cos(angle), 0])
    return rho * out + np.array([0, 0, z]), rate * rho * along, -(rate**2) * rho * out


def ellipse(a, e, mu, true_anomaly, t):
    """Position, velocity and acceleration on a Keplerian ellipse in the x-y plane, perihelion on the x axis."""
    half = np.tan(true_anomaly / 2) * np.sqrt((1 - e) / (1 + e))
    begin = 2 * np.arctan(half)
    mean = begin - e * np.sin(begin) + np.sqrt(mu / a**3) * t
    anomaly = brentq(lambda x: x - e * np.sin(x) - mean, mean - 1, mean + 1, xtol=1e-15, rtol=1e-15)
    shape = np.sqrt(1 - e * e)
    r = a * np.array([np.cos(anomaly) - e, shape * np.sin(anomaly), 0])
    rate = np.sqrt(mu / a**3) / (1 - e * np.cos(anomaly))
    v = a * rate * np.array([-np.sin(anomaly), shape * np.cos(anomaly), 0])
    return r, v, -mu * r / np.linalg.norm(r) ** 3


def third_body(scene, t, r):
    """Pull of a planet on a circular orbit in the ecliptic, on the craft less on the Sun."""
    third = scene.environment.third_body
    if third is None:
        return np.zeros(3)
    angle = third.azimuth + np.sqrt((MU_SUN + third.mu) / third.radius**3) * t
    planet = third.radius * np.array([np.cos(angle), np.sin(angle), 0])
    d = planet - r
    return third.mu * (d / np.linalg.norm(d) ** 3 - planet / third.radius**3)


def designed(scene, t):
    """(pitch, clock, characteristic acceleration) that hold the designed orbit at time t, by the force law alone."""
    r, v, a = held(scene, t)
    size, r_hat = np.linalg.norm(r), r / np.linalg.norm(r)
    out, sideways = a @ r_hat, a - (a @ r_hat) * r_hat
    across = np.linalg.norm(sideways)
    law = esail_force if scene.device.kind == "electric-sail" else lambda x: film_components(scene.device, x)
    most = np.arccos(3**-0.5) if scene.device.kind == "electric-sail" else np.radians(54)
    pitch, clock = 0.0, 0.0
    if across > 1e-12 * out:
        pitch = brentq(lambda x: law(x)[1] * out - across * law(x)[0], 0, most, xtol=1e-15)
        h = np.cross(r, v)
        h = h / np.linalg.norm(h)
        clock = np.arctan2(sideways @ np.cross(h, r_hat), sideways @ h)
    return pitch, clock, np.linalg.norm(a) / np.hypot(*law(pitch)) * (size / AU) ** law(pitch).exponent
