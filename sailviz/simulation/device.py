"""What a scene says of its device, as numbers of the right-hand side."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from sailviz.constants import AU, STANDARD_GRAVITY
from sailviz.propagate import dynamics
from sailviz.propulsion import electric_sail
from sailviz.propulsion.solar_sail import FILMS, Film
from sailviz.simulation.low_orbit import brake_device

if TYPE_CHECKING:
    pass


def film_of(scene) -> Film:
    """Force coefficients of the scene's solar sail."""
    given = scene.device.film
    if isinstance(given, str):
        return FILMS[given]
    values = given.model_dump()
    return Film(**values) if "b1" in values else Film.from_optics(**values)


def _sail_name(scene):
    """The scene's sail as design functions take it: a Film, or the name of an E-sail model."""
    if scene.device.kind == "solar-sail":
        return film_of(scene)
    return "electric-sail" if scene.device.model == "final" else f"electric-sail-{scene.device.model}"


def sail_strength(scene, design) -> float:
    """Characteristic acceleration, m/s2, of either sail."""
    device = scene.device
    if device.characteristic_acceleration == "as designed":
        return float(np.max(design.characteristic_acceleration))  # of a track: at full throttle
    if device.characteristic_acceleration is not None:
        return device.characteristic_acceleration
    if device.kind == "electric-sail":
        return float(
            electric_sail.characteristic_acceleration(
                device.tethers,
                device.tether_length,
                device.voltage,
                device.mass,
                device.wind_pressure,
                device.wind_potential,
            )
        )
    return film_of(scene).characteristic_acceleration(
        lightness=device.lightness_number, area=device.area, mass=device.mass
    )


def _device(scene, design):
    """(id, parameters) for the right-hand side."""
    device = scene.device
    if device.kind == "solar-sail":
        film = film_of(scene)
        strength = sail_strength(scene, design) * AU**2 / film.total
        return dynamics.SOLAR_SAIL, (strength, film.b1, film.b2, film.b3)
    if device.kind == "electric-sail":
        model = electric_sail.MODELS[device.model]
        return dynamics.ELECTRIC_SAIL, (sail_strength(scene, design), model, device.pitch_limit)
    if device.kind == "plasma-brake":
        return dynamics.PLASMA_BRAKE, brake_device(scene)
    if device.kind == "thruster":
        size = device.thrust if device.thrust is not None else device.acceleration
        exhaust = device.specific_impulse
        inverse = 0.0 if exhaust is None else 1.0 / (STANDARD_GRAVITY * exhaust)
        return dynamics.THRUSTER, (size, float(device.thrust is not None), inverse)
    return dynamics.NO_DEVICE, ()
