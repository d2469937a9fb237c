"""A scene's Earth as the propagator sees it: zonal gravity, Sun, shadow, air, plasma and the brake's own numbers."""

from __future__ import annotations

import numpy as np

from sailviz import ephemeris
from sailviz.constants import J2_EARTH, J3_EARTH, J4_EARTH, MU_EARTH, RADIUS_EARTH, ROTATION_EARTH
from sailviz.environment import atmosphere, ionosphere, solar_level
from sailviz.environment.eclipse import CONE, CYLINDER, NO_SHADOW
from sailviz.environment.gravity import strengths
from sailviz.environment.sun import sun_parameters
from sailviz.propagate import low_orbit_callback as low_orbit
from sailviz.propagate import parameters as row
from sailviz.propulsion.plasma_brake import spin_factor, tether_mass

SPIN_AXES = {"along-track": 0.0, "across-track": np.pi / 2}  # rad between the velocity and the plane of spin
ATTITUDES = {"vertical": row.VERTICAL, "gravity-gradient": row.TILTED, "spinning": row.SPINNING}


def low_orbit_parts(scene, body, epoch) -> dict:
    """Keywords of `dynamics.model` for what surrounds a craft; nothing that a heliocentric scene needs."""
    if body.radius == 0 and scene.environment.ionosphere is None:
        return {}
    around = scene.environment
    parts = {
        "rotation": ROTATION_EARTH if scene.body == "earth" and around.corotation else 0.0,
        "plasma": _plasma(around.ionosphere, body),
        "air": _air(scene, body),
        "height": int(around.height_above == "ellipsoid"),
    }
    if scene.body != "earth":
        return parts
    use = [J2_EARTH * around.j2, J3_EARTH * around.j3, J4_EARTH * around.j4]
    parts["j2_strength"], *parts["zonal"] = strengths(MU_EARTH, RADIUS_EARTH, *use)
    parts["sun"] = sun_parameters(epoch, around.sun_right_ascension or 0.0)
    parts["shadow"] = {"cylinder": CYLINDER, "cone": CONE}[around.shadow] if watches_shadow(scene) else NO_SHADOW
    if around.solar_flux is not None:
        steady = around.solar_flux != "cycle"
        parts["flux"] = (
            solar_level.constant(around.solar_flux) if steady else solar_level.cycle(ephemeris.decimal_year(epoch))
        )
        if getattr(around.ionosphere, "kind", None) == "iri-2020":
            parts["plasma_table"] = ionosphere.table(around.solar_flux if steady else None)
        if getattr(around.atmosphere, "kind", None) == "nrlmsis-2.1":
            levels = around.solar_flux if steady else atmosphere.LEVELS
            parts["air_table"] = atmosphere.table(levels, around.atmosphere.ap)
    if scene.device.kind == "plasma-brake":
        parts["brake"] = _brake(scene, epoch)
    if scene.device.kind == "plasma-brake" or "air_table" in parts:
        parts["low_orbit"] = low_orbit.acceleration_plug()
    return parts


def watches_shadow(scene) -> bool:
    """Whether sunlight and shadow matter to a scene, or are at least known in it."""
    if scene.body != "earth":
        return False
    return scene.epoch is not None or scene.environment.sun_right_ascension is not None or _depends_on_light(scene)


def _depends_on_light(scene) -> bool:
    return getattr(scene.device, "eclipse", "on") != "on"


def _plasma(profile, body):
    if profile is None:
        return ()
    if profile.kind == "iri-2020":
        return (low_orbit.TABLE_PROFILE,)
    value = profile.force_per_length if profile.kind == "exponential-force" else profile.density
    mass = getattr(profile, "ion_mass", 0.0)
    kind = ionosphere.PROFILES[profile.kind]
    return kind, profile.reference_altitude, value, profile.scale_height, mass, body.radius


def _air(scene, body):
    air = scene.environment.atmosphere
    if air is None:
        return ()
    area = scene.device.drag_area * scene.device.drag_coefficient
    if air.kind == "exponential":
        return row.EXPONENTIAL_AIR, area, body.radius + air.reference_altitude, air.density, air.scale_height
    return row.TABLED_AIR, area


def brake_device(scene):
    """The first numbers of a brake in the row, from DEVICE on."""
    device = scene.device
    attitude = ATTITUDES[scene.steering.kind if scene.steering else "vertical"]
    return device.tether_length, abs(device.voltage), device.wire_radius, device.polarity == "positive", attitude


def _brake(scene, epoch):
    device, around = scene.device, scene.environment
    power = np.inf if device.power is None else device.power
    in_shadow = {"on": power, "off": 0.0, "limited": device.eclipse_power}[device.eclipse]
    tether = device.tether_mass if device.tether_mass is not None else tether_mass(device.tether_length)
    spinning = scene.steering is not None and scene.steering.kind == "spinning"
    return (
        device.wire_diameter,
        device.efficiency,
        power,
        in_shadow,
        (device.tip_mass or 0.0) + tether / 3,
        float(spin_factor(SPIN_AXES[scene.steering.plane])) if spinning else 1.0,
        around.magnetic_sensitivity,
        getattr(around.ionosphere, "density_factor", 1.0),
        0.0 if epoch is None else float(ephemeris.greenwich_sidereal_time(epoch)),
        1.0,
    )
