"""The closed forms behind starts on an orbit that a sail holds or a spiral that it flies."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from sailviz import ephemeris
from sailviz.constants import MU_SUN
from sailviz.design import displaced, spirals
from sailviz.errors import Fault, SceneError
from sailviz.scene.steering import FrameSteering
from sailviz.simulation.device import film_of, sail_strength

if TYPE_CHECKING:
    from collections.abc import Callable

    from sailviz.design.displaced.holding import Holding, Track
    from sailviz.propulsion.solar_sail import Film
    from sailviz.scene.loading import Scene
    from sailviz.scene.start import (
        DisplacedStart,
        FlatEllipseStart,
        HeliostationaryStart,
        LagrangeStart,
        PlanetFollowingStart,
        SpiralStart,
    )

TRACK_POINTS = 720  # of the steering table, per revolution: its cubic is then good to 1e-10


def displaced_orbit(scene: Scene, start: DisplacedStart) -> Holding:
    """What holds a circular displaced orbit."""
    return _feasible(scene, displaced.circular(start.radius, start.elevation, start.rate_ratio, _sail(scene)))


def heliostationary(scene: Scene, start: HeliostationaryStart) -> Holding:
    """What holds a craft at rest."""
    return _feasible(scene, displaced.heliostationary(start.radius, _sail(scene)))


def lagrange_point(scene: Scene, start: LagrangeStart) -> Holding:
    """What holds an artificial Lagrange point."""
    third = scene.environment.third_body
    if third is None:
        return _feasible(scene, displaced.lagrange_point(start.radius, _sail(scene)))
    found = displaced.lagrange_point(start.radius, _sail(scene), planet_mu=third.mu, planet_orbit=third.radius)
    return _feasible(scene, found)


def planet_following(scene: Scene, start: PlanetFollowingStart) -> Track:
    """The track over a planet on its ellipse, over the whole run."""
    from sailviz.design.displaced import tracks

    a, e = start.semi_major_axis, start.eccentricity
    if start.planet is not None:
        a, e, *_ = (float(value[0]) for value in ephemeris.planet_elements(start.planet.capitalize(), 0.0))
    assert a is not None  # the section gives the planet, or both
    assert e is not None
    device = _sail(scene)
    period = 2 * np.pi * np.sqrt(a**3 / MU_SUN)
    return _whole_track(
        scene,
        start.true_anomaly,
        period,
        lambda nu: tracks.planet_following(a, e, nu, start.elevation, start.radius_ratio, device),
    )


def flat_ellipse(scene: Scene, start: FlatEllipseStart) -> Track:
    """The track on an ellipse lifted off the ecliptic, over the whole run."""
    from sailviz.design.displaced import tracks

    p, e, device = start.semi_latus_rectum, start.eccentricity, _sail(scene)
    period = 2 * np.pi * np.sqrt((p / (1 - e * e)) ** 3 / (start.mu_ratio * MU_SUN))
    return _whole_track(
        scene,
        start.true_anomaly,
        period,
        lambda nu: tracks.flat_ellipse(p, e, nu, start.height, start.mu_ratio, device),
    )


def logarithmic_spiral(scene: Scene, start: SpiralStart) -> spirals.LogarithmicSpiral:
    """The spiral of the sail's lightness number and pitch."""
    steering = scene.steering
    assert isinstance(steering, FrameSteering)  # the scene's check says so
    film = film_of(scene)
    pitch = steering.pitch * np.sign(np.sin(steering.clock))
    found = spirals.logarithmic(film.lightness(sail_strength(scene, None)), pitch, film)
    if not found.feasible:
        raise _infeasible(scene, found.reason)
    return found


def _sail(scene: Scene) -> Film | str:
    return "electric-sail" if scene.device.kind == "electric-sail" else film_of(scene)


def _infeasible(scene: Scene, reason: str) -> SceneError:
    return SceneError([Fault("start", f"this orbit is infeasible: {reason}.")], scene.source)


def _feasible(scene: Scene, found: Holding) -> Holding:
    if not found.feasible:
        raise _infeasible(scene, found.reason)
    return found


def _whole_track(scene: Scene, first: float, period: float, track: Callable[[np.ndarray], Track]) -> Track:
    """A track over the whole run at equal steps of true anomaly. first : true anomaly rad of the start, period s."""
    turns = scene.propagation.duration / period + 1.1
    anomaly = first + 2 * np.pi * np.arange(int(turns * TRACK_POINTS)) / TRACK_POINTS
    found = track(anomaly)
    if not np.all(found.feasible):
        raise _infeasible(scene, track(anomaly[np.argmin(found.feasible)]).reason)
    return found
