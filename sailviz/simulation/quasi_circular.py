"""The quasi-circular decay of a scene, at the times of its run: the analytic answer beside the propagated one.

Between simulation and design: makes of a scene's ionosphere, air and craft what `sailviz.design.decay` takes.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from sailviz import elements as orbital
from sailviz.constants import FLATTENING_EARTH, J2_EARTH, MU_EARTH, RADIUS_EARTH
from sailviz.design import decay
from sailviz.environment import atmosphere, ionosphere
from sailviz.errors import Fault, SceneError
from sailviz.propulsion.plasma_brake import SPINNING, force_per_length
from sailviz.simulation.bodies import epoch_of
from sailviz.simulation.environment import season_start
from sailviz.simulation.steering import steering_of


class QuasiCircular:
    """Mean altitude of a quasi-circular descent at any time of a run."""

    def __init__(self, scene, position, velocity):
        """position (3,) m and velocity (3,) m/s of the start, whose mean semi-major axis is where the descent begins.

        Plasma and air are averaged over local time and the latitudes of the orbit: a sun-synchronous orbit, which keeps
        its local time, falls up to 9 % faster or slower at solar minimum, 4 % at medium and 1 % at maximum. The air
        is the mean over the dates for which the run is planned, or over a year.
        SceneError, naming the scene, where there is no such descent.
        """
        device, around = scene.device, scene.environment
        inclination = float(orbital.elements(position, velocity, MU_EARTH).inclination)
        oblateness = J2_EARTH * RADIUS_EARTH**2 if around.j2 else 0.0
        axis = float(orbital.mean_semi_major_axis(position, velocity, MU_EARTH, oblateness))
        brake = device.kind == "plasma-brake"
        bulge = _bulge(inclination) if around.height_above == "ellipsoid" else 0.0
        area = device.drag_area * device.drag_coefficient if around.atmosphere is not None else 0.0
        floor = device.off_below if brake else decay.BRAKE_FLOOR
        try:
            self._descent = decay.descend(
                device.mass,
                device.tether_length if brake else 0.0,
                axis - RADIUS_EARTH,
                decay.REENTRY if area else floor,
                _force(scene, inclination, bulge) if brake else None,
                drag_area=area,
                air=_air(scene, inclination, bulge) if area else None,
                brake_floor=floor,
                inclination=inclination,
                mean_radius=around.j2,
                corotation=around.corotation,
                most_nodes=scene.limits.steps,
            )
        except ValueError as error:
            what = f"there is no quasi-circular descent: {error}."
            raise SceneError([Fault("approximation", what)], scene.source) from None

    def altitude(self, time):
        """Mean semi-major axis less R_E, m, at times (n,) s since the start; NaN after the descent."""
        return self._descent.altitude_at(time)


def _bulge(inclination):
    """Mean height over the ellipsoid less that over the sphere, m, along a circular orbit: R_E f sin^2(latitude)."""
    return RADIUS_EARTH * FLATTENING_EARTH * np.sin(inclination) ** 2 / 2


def _force(scene, inclination, bulge):
    """Force along a metre of tether, N/m, over the altitude."""
    plasma, device = scene.environment.ionosphere, scene.device
    voltage = abs(device.voltage)
    if plasma.kind == "exponential-force":

        def law(altitude):
            given = ionosphere.exponential.py_func(
                altitude, plasma.reference_altitude, plasma.force_per_length, plasma.scale_height
            )
            if not scene.environment.corotation:
                return given
            # the turning plasma changes the direction of a given force and not its size
            axis = RADIUS_EARTH + altitude
            return given * decay.corotation_factor(axis, inclination, 0.0) / decay.corotation_factor(axis, inclination)

        profile = decay.ForceProfile("exponential force", law)
    elif plasma.kind == "exponential-density":

        def law(altitude):
            density = ionosphere.exponential.py_func(
                altitude, plasma.reference_altitude, plasma.density, plasma.scale_height
            )
            speed = np.sqrt(MU_EARTH / (RADIUS_EARTH + altitude))
            return force_per_length(density, plasma.ion_mass, speed, voltage, device.wire_radius)

        profile = decay.ForceProfile("exponential density", law)
    else:
        profile = decay.averaged_profile(inclination, scene.environment.solar_flux, voltage, device.wire_radius)
        if plasma.density_factor != 1.0:
            profile = profile.with_density(plasma.density_factor)
        profile = profile.extended()
    tether = steering_of(scene.steering).tether(scene.steering)
    if tether.attitude == SPINNING:
        profile = profile.scaled(tether.spin_factor)
    inner = profile.law
    return replace(profile, law=lambda h: inner(h + bulge), knots=tuple(knot - bulge for knot in profile.knots))


def _air(scene, inclination, bulge):
    """Density of the air over the altitude: a function, or a table of both."""
    air = scene.environment.atmosphere
    if air.kind == "exponential":
        return lambda h: ionosphere.exponential.py_func(
            h + bulge, air.reference_altitude, air.density, air.scale_height
        )
    days = atmosphere.days_over(season_start(scene, epoch_of(scene)), scene.propagation.duration)
    altitude, density = atmosphere.mean_profile(scene.environment.solar_flux, air.ap, inclination, days)
    return altitude - bulge, density
