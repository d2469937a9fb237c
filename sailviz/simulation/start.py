"""Where a scene starts, and the designed orbit behind it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from sailviz import elements as orbital
from sailviz import ephemeris
from sailviz.constants import AU, DAY, J2_EARTH, MU_SUN, RADIUS_EARTH
from sailviz.design import displaced, spirals
from sailviz.environment.sun import sun_parameters
from sailviz.errors import Fault, SceneError
from sailviz.scene.start import DesignedStart

if TYPE_CHECKING:
    pass
from sailviz.simulation.bodies import epoch_of
from sailviz.simulation.device import film_of, sail_strength


def _design(scene):
    """The closed form behind a start "on the designed orbit"; SceneError where it does not exist."""
    start = scene.start
    if isinstance(start, DesignedStart):
        device = "electric-sail" if scene.device.kind == "electric-sail" else film_of(scene)
        third = scene.environment.third_body
        if start.kind == "displaced":
            found = displaced.circular(start.radius, start.elevation, start.rate_ratio, device)
        elif start.kind == "heliostationary":
            found = displaced.heliostationary(start.radius, device)
        elif start.kind == "lagrange-point":
            planet = {} if third is None else {"planet_mu": third.mu, "planet_orbit": third.radius}
            found = displaced.lagrange_point(start.radius, device, **planet)
        else:
            return _track(scene, device)
    elif start.kind == "spiral":
        found = spirals.logarithmic(
            film_of(scene).lightness(sail_strength(scene, None)),
            scene.steering.pitch * np.sign(np.sin(scene.steering.clock)),
            film_of(scene),
        )
    else:
        return None
    if not found.feasible:
        raise SceneError([Fault("start", f"this orbit is infeasible: {found.reason}.")], scene.source)
    return found


TRACK_POINTS = 720  # of the steering table, per revolution: its cubic is then good to 1e-10


def _track(scene, device):
    """The Track of an elliptic displaced orbit over the whole run, at equal steps of true anomaly."""
    from sailviz.design.displaced import tracks as displaced_tracks

    start = scene.start
    if start.kind == "planet-following":
        a, e = start.semi_major_axis, start.eccentricity
        if start.planet is not None:
            a, e, *_ = (float(value[0]) for value in ephemeris.planet_elements(start.planet.capitalize(), 0.0))
        period = 2 * np.pi * np.sqrt(a**3 / MU_SUN)
    else:
        e = start.eccentricity
        period = 2 * np.pi * np.sqrt((start.semi_latus_rectum / (1 - e * e)) ** 3 / (start.mu_ratio * MU_SUN))
    turns = scene.propagation.duration / period + 1.1
    anomaly = start.true_anomaly + 2 * np.pi * np.arange(int(turns * TRACK_POINTS)) / TRACK_POINTS

    def track(nu):
        if start.kind == "planet-following":
            return displaced_tracks.planet_following(a, e, nu, start.elevation, start.radius_ratio, device)
        return displaced_tracks.flat_ellipse(start.semi_latus_rectum, e, nu, start.height, start.mu_ratio, device)

    found = track(anomaly)
    if not np.all(found.feasible):
        reason = track(anomaly[np.argmin(found.feasible)]).reason
        raise SceneError([Fault("start", f"this orbit is infeasible: {reason}.")], scene.source)
    return found


def _initial_state(scene, body, design):
    start = scene.start
    if isinstance(start, DesignedStart):
        if start.kind == "displaced":
            position, velocity = displaced.state(start.radius, start.elevation, start.rate_ratio, start.azimuth)
        elif start.kind == "heliostationary":
            position, velocity = displaced.state(start.radius, start.elevation, 0.0, start.azimuth)
        elif start.kind == "lagrange-point":
            third = scene.environment.third_body
            orbit, azimuth = (AU, 0.0) if third is None else (third.radius, third.azimuth)
            position, velocity = displaced.state(start.radius, 0.0, (start.radius / orbit) ** 1.5, azimuth)
        else:
            position, velocity = design.position[0], design.velocity[0]
        return position + start.position_offset, velocity + start.velocity_offset
    if start.kind == "cartesian":
        return np.array(start.position), np.array(start.velocity)
    if start.kind == "spiral":
        return design.state(start.radius, start.azimuth, body.mu)
    if start.kind == "circular":
        shape = (_circle(start, scene, body), 0.0, start.inclination, _node(scene), 0.0, start.argument_of_latitude)
    else:
        shape = (
            start.semi_major_axis,
            start.eccentricity,
            start.inclination,
            start.raan,
            start.argument,
            start.true_anomaly,
        )
    position, velocity = orbital.state(*shape, body.mu)
    if not np.isfinite(position).all() or np.linalg.norm(position) <= body.radius:
        raise SceneError([Fault("start", f"this point is not above the surface of the {body.name}.")], scene.source)
    return position, velocity


def _circle(start, scene, body) -> float:
    """Radius, m, of a circular start; for a mean altitude the one whose mean semi-major axis lies there."""
    if start.radius is not None:
        return start.radius
    if start.mean_altitude is None:
        return body.radius + start.altitude
    return orbital.osculating_radius(
        body.radius + start.mean_altitude,
        start.inclination,
        start.argument_of_latitude,
        J2_EARTH * RADIUS_EARTH**2 if scene.environment.j2 else 0.0,
    )


def _node(scene) -> float:
    """Right ascension of the ascending node, rad, from itself or from the local time of passing it."""
    start = scene.start
    if start.ltan is None:
        return start.raan or 0.0
    sun = sun_parameters(epoch_of(scene), scene.environment.sun_right_ascension or 0.0)
    return float(np.remainder(sun[0] + 2 * np.pi * (start.ltan / DAY - 0.5), 2 * np.pi))
