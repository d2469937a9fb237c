"""Where each kind of start begins, in plain numbers: enough to say that a place lies inside the body or that a craft
has no orbit plane, without the arrays that fly it."""

from __future__ import annotations

from math import cos, hypot, sin, sqrt
from typing import TYPE_CHECKING

from sailviz.constants import AU, J2_EARTH, MU_SUN, RADIUS_EARTH
from sailviz.scene.start import (
    CartesianStart,
    CircularStart,
    DisplacedStart,
    ElementsStart,
    FlatEllipseStart,
    HeliostationaryStart,
    LagrangeStart,
    PlanetFollowingStart,
    SpiralStart,
)
from sailviz.sky.bodies import BODIES

if TYPE_CHECKING:
    from sailviz.scene.loading import Scene

Vector = tuple[float, float, float]
PLANETS = {  # semi-major axis au and eccentricity, to a part in a thousand: the Sun's radius is 0.005 au
    "mercury": (0.387, 0.206),
    "venus": (0.723, 0.007),
    "earth": (1.0, 0.017),
    "mars": (1.524, 0.093),
    "jupiter": (5.203, 0.048),
    "saturn": (9.537, 0.054),
    "uranus": (19.189, 0.047),
    "neptune": (30.07, 0.009),
}


def radius_of_body(scene: Scene) -> float:
    """Of the central body, m; 0 of a point."""
    return BODIES[scene.body].radius if isinstance(scene.body, str) else scene.body.radius


def mu_of_body(scene: Scene) -> float:
    """Gravitational parameter of the central body, m3/s2."""
    return BODIES[scene.body].mu if isinstance(scene.body, str) else scene.body.mu


def cartesian(scene: Scene, start: CartesianStart) -> Vector:
    """Position, m."""
    x, y, z = start.position
    return x, y, z


def elements(scene: Scene, start: ElementsStart) -> Vector:
    """Position, m, as in `sailviz.elements.state`."""
    a, e, nu = start.semi_major_axis, start.eccentricity, start.true_anomaly
    r = a * (1 - e) * (1 + e) / (1 + e * cos(nu))
    return _in_plane(r, start.inclination, start.raan, start.argument + nu)


def circular(scene: Scene, start: CircularStart) -> Vector:
    """Position, m; the local time of the node, which turns it about the pole, left out."""
    radius = start.radius or radius_of_body(scene) + (start.altitude or start.mean_altitude or 0.0)
    u = start.argument_of_latitude
    if start.mean_altitude is not None and scene.environment.j2:  # first order in J2, `elements.osculating_radius`
        swing = 1.5 * sin(start.inclination) ** 2 * (1 - 2 * sin(u) ** 2)
        radius += J2_EARTH * RADIUS_EARTH**2 / radius * swing
    return _in_plane(radius, start.inclination, start.raan or 0.0, u)


def _in_plane(r: float, inclination: float, node: float, u: float) -> Vector:
    """Position at a distance r and an argument of latitude u."""
    x, y = r * cos(u), r * sin(u)
    flat = y * cos(inclination)
    return x * cos(node) - flat * sin(node), x * sin(node) + flat * cos(node), y * sin(inclination)


def _at(r: float, elevation: float, azimuth: float, offset: list[float]) -> Vector:
    """Position at a distance, elevation and azimuth, and a little beside."""
    x, y, z = offset
    rho = r * cos(elevation)
    return rho * cos(azimuth) + x, rho * sin(azimuth) + y, r * sin(elevation) + z


def displaced(scene: Scene, start: DisplacedStart) -> Vector:
    """Position, m."""
    return _at(start.radius, start.elevation, start.azimuth, start.position_offset)


def heliostationary(scene: Scene, start: HeliostationaryStart) -> Vector:
    """Position, m."""
    return _at(start.radius, start.elevation, start.azimuth, start.position_offset)


def lagrange(scene: Scene, start: LagrangeStart) -> Vector:
    """Position, m."""
    third = scene.environment.third_body
    return _at(start.radius, 0.0, 0.0 if third is None else third.azimuth, start.position_offset)


def planet_following(scene: Scene, start: PlanetFollowingStart) -> Vector:
    """Position, m; for a planet by name to a part in a thousand."""
    if start.planet is not None:
        axis, e = PLANETS[start.planet]
        a = axis * AU
    else:
        a, e = start.semi_major_axis or 0.0, start.eccentricity or 0.0
    r = start.radius_ratio * a * (1 - e * e) / (1 + e * cos(start.true_anomaly))
    return _at(r, start.elevation, start.true_anomaly, start.position_offset)


def flat_ellipse(scene: Scene, start: FlatEllipseStart) -> Vector:
    """Position, m."""
    rho = start.semi_latus_rectum / (1 + start.eccentricity * cos(start.true_anomaly))
    x, y, z = _at(rho, 0.0, start.true_anomaly, start.position_offset)
    return x, y, z + start.height


def spiral(scene: Scene, start: SpiralStart) -> Vector:
    """Position, m."""
    return _at(start.radius, 0.0, start.azimuth, [0.0, 0.0, 0.0])


def cartesian_velocity(scene: Scene, start: CartesianStart) -> Vector:
    """Velocity, m/s."""
    x, y, z = start.velocity
    return x, y, z


def displaced_velocity(scene: Scene, start: DisplacedStart) -> Vector:
    """Velocity, m/s: round the pole at rate_ratio times the Keplerian rate, and the offset."""
    rate = start.rate_ratio * sqrt(MU_SUN / start.radius) * cos(start.elevation)
    x, y, z = start.velocity_offset
    return x - rate * sin(start.azimuth), y + rate * cos(start.azimuth), z


def heliostationary_velocity(scene: Scene, start: HeliostationaryStart) -> Vector:
    """Velocity, m/s: the offset."""
    x, y, z = start.velocity_offset
    return x, y, z


def has_plane(position: Vector, velocity: Vector) -> bool:
    """Whether position and velocity span a plane, to rounding."""
    r, v = hypot(*position), hypot(*velocity)
    if r == 0 or v == 0:
        return False
    a, b = [x / r for x in position], [x / v for x in velocity]
    cross = (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])
    return hypot(*cross) > 1e-14
