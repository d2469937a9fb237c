"""Quantities of a state, one formula each: compiled code calls them with numbers, where an event is watched, Python by
`.py_func` with columns, where rows are judged and drawn.

x, y, z m and vx, vy, vz m/s, inertial, from the central body; mu m3/s2. From the inverse of the semi-major axis on,
they are for numbers alone, the twins of `sailviz.elements`, which tests hold to it; and where an element is infinite on
the way to escape, as the semi-major axis and the apoapsis are, its inverse, which goes on.
"""

# What numpy makes of numbers has no type for mypy.
# mypy: disable-error-code="no-any-return"
from __future__ import annotations

import numpy as np

from sailviz.compiled import inlined

CIRCULAR, EQUATORIAL = 1e-11, 1e-11  # as in elements: below, the apse line or the node is rounding noise


@inlined
def radius(x: float, y: float, z: float) -> float:
    """Distance from the centre, m."""
    return np.sqrt(x * x + y * y + z * z)


@inlined
def elevation(x: float, y: float, z: float) -> float:
    """Angle over the reference plane, rad."""
    return np.arctan2(z, np.hypot(x, y))


@inlined
def longitude(x: float, y: float) -> float:
    """Angle about the pole from the x axis, rad, -pi to pi."""
    return np.arctan2(y, x)


@inlined
def radial_speed(x: float, y: float, z: float, vx: float, vy: float, vz: float) -> float:
    """Speed away from the centre, m/s."""
    return (x * vx + y * vy + z * vz) / np.sqrt(x * x + y * y + z * z)


@inlined
def angular_momentum_z(x: float, y: float, vx: float, vy: float) -> float:
    """Its component along the pole, m2/s."""
    return x * vy - y * vx


@inlined
def angular_momentum(x: float, y: float, z: float, vx: float, vy: float, vz: float) -> float:
    """Per mass, m2/s."""
    hx, hy, hz = y * vz - z * vy, z * vx - x * vz, x * vy - y * vx
    return np.sqrt(hx * hx + hy * hy + hz * hz)


@inlined
def transverse_speed(x: float, y: float, z: float, vx: float, vy: float, vz: float) -> float:
    """Speed across the radius, m/s."""
    hx, hy, hz = y * vz - z * vy, z * vx - x * vz, x * vy - y * vx
    return np.sqrt((hx * hx + hy * hy + hz * hz) / (x * x + y * y + z * z))


@inlined
def flight_path_angle(x: float, y: float, z: float, vx: float, vy: float, vz: float) -> float:
    """Angle of the velocity over the local horizon, rad."""
    hx, hy, hz = y * vz - z * vy, z * vx - x * vz, x * vy - y * vx
    return np.arctan2(x * vx + y * vy + z * vz, np.sqrt(hx * hx + hy * hy + hz * hz))


@inlined
def energy(x: float, y: float, z: float, vx: float, vy: float, vz: float, mu: float) -> float:
    """Kinetic and potential, per mass, J/kg."""
    return 0.5 * (vx * vx + vy * vy + vz * vz) - mu / np.sqrt(x * x + y * y + z * z)


@inlined
def inverse_axis(x: float, y: float, z: float, vx: float, vy: float, vz: float, mu: float) -> float:
    """One over the semi-major axis, 1/m: negative on a hyperbola."""
    return 2.0 / radius(x, y, z) - (vx * vx + vy * vy + vz * vz) / mu


@inlined
def eccentricity_vector(
    x: float, y: float, z: float, vx: float, vy: float, vz: float, mu: float
) -> tuple[float, float, float]:
    """Towards the periapsis, of the eccentricity's length."""
    hx, hy, hz = y * vz - z * vy, z * vx - x * vz, x * vy - y * vx
    inverse = 1.0 / radius(x, y, z)
    return (
        (vy * hz - vz * hy) / mu - x * inverse,
        (vz * hx - vx * hz) / mu - y * inverse,
        (vx * hy - vy * hx) / mu - z * inverse,
    )


@inlined
def eccentricity(x: float, y: float, z: float, vx: float, vy: float, vz: float, mu: float) -> float:
    """Of the osculating orbit."""
    ex, ey, ez = eccentricity_vector(x, y, z, vx, vy, vz, mu)
    return np.sqrt(ex * ex + ey * ey + ez * ez)


@inlined
def inclination(x: float, y: float, z: float, vx: float, vy: float, vz: float) -> float:
    """Of the plane of the orbit, rad, 0 to pi."""
    hx, hy, hz = y * vz - z * vy, z * vx - x * vz, x * vy - y * vx
    return np.arctan2(np.hypot(hx, hy), hz)


@inlined
def raan(x: float, y: float, z: float, vx: float, vy: float, vz: float) -> float:
    """Longitude of the ascending node, rad, -pi to pi; 0 where there is none."""
    hx, hy, hz = y * vz - z * vy, z * vx - x * vz, x * vy - y * vx
    if np.hypot(hx, hy) < EQUATORIAL * np.sqrt(hx * hx + hy * hy + hz * hz):
        return 0.0
    return np.arctan2(hx, -hy)


@inlined
def true_anomaly(x: float, y: float, z: float, vx: float, vy: float, vz: float, mu: float) -> float:
    """Angle from the periapsis, of a circle from the node, rad, -pi to pi."""
    hx, hy, hz = y * vz - z * vy, z * vx - x * vz, x * vy - y * vx
    h = np.sqrt(hx * hx + hy * hy + hz * hz)
    ex, ey, ez = eccentricity_vector(x, y, z, vx, vy, vz, mu)
    if np.sqrt(ex * ex + ey * ey + ez * ez) < CIRCULAR:
        node = raan(x, y, z, vx, vy, vz)
        ex, ey, ez = np.cos(node), np.sin(node), 0.0
    ahead = (hx * (ey * z - ez * y) + hy * (ez * x - ex * z) + hz * (ex * y - ey * x)) / h
    return np.arctan2(ahead, ex * x + ey * y + ez * z)


@inlined
def periapsis(x: float, y: float, z: float, vx: float, vy: float, vz: float, mu: float) -> float:
    """Distance of the nearest point from the centre, m."""
    h = angular_momentum(x, y, z, vx, vy, vz)
    return h * h / mu / (1.0 + eccentricity(x, y, z, vx, vy, vz, mu))


@inlined
def inverse_apoapsis(x: float, y: float, z: float, vx: float, vy: float, vz: float, mu: float) -> float:
    """One over the distance of the farthest point from the centre, 1/m: negative on an open orbit."""
    h = angular_momentum(x, y, z, vx, vy, vz)
    return (1.0 - eccentricity(x, y, z, vx, vy, vz, mu)) * mu / (h * h)


@inlined
def oblate_swing(x: float, y: float, z: float, vx: float, vy: float, vz: float, mu: float, oblateness: float) -> float:
    """By how much, m, the semi-major axis is over its mean within a revolution round an oblate body, to first order;
    oblateness = J2 R^2 in m2. As `elements.mean_semi_major_axis`."""
    r = radius(x, y, z)
    a = 1.0 / inverse_axis(x, y, z, vx, vy, vz, mu)
    hz, radial = x * vy - y * vx, x * vx + y * vy + z * vz
    h2 = r * r * (vx * vx + vy * vy + vz * vz) - radial * radial
    near, s = a / r, z / r
    swing = near * near * near * (1.0 - 3.0 * s * s)
    swing -= (1.0 - 1.5 * (1.0 - hz * hz / h2)) * (mu * a / h2) ** 1.5
    return oblateness / a * swing
