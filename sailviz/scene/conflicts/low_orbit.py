"""Whether plasma, air, shadow and tether of a scene go together round the Earth."""

from __future__ import annotations

from typing import TYPE_CHECKING

from sailviz.scene.conflicts.answers import Faults
from sailviz.scene.conflicts.records import atmosphere_of, device_of, ionosphere_of, start_of, steering_of
from sailviz.scene.device import PlasmaBrake, air_on_facets
from sailviz.scene.environment import MsisAtmosphere

if TYPE_CHECKING:
    from sailviz.scene.loading import Scene


def known_of_the_earth(scene: Scene) -> Faults:
    """What is known of no other body."""
    found, around = [], scene.environment
    if scene.body != "earth":
        for name in ("j2", "j3", "j4", "atmosphere", "solar_flux", "space_weather"):
            if getattr(around, name):
                found.append((f"environment.{name}", f'{name} is known for body = "earth"'))
        if device_of(scene).tether:
            found.append(("device.kind", 'a plasma brake works in the ionosphere: body = "earth"'))
    if (around.j3 or around.j4) and not around.j2:
        found.append(("environment.j2", "j3 and j4 are corrections to j2: turn it on"))
    return found


def tether(scene: Scene) -> Faults:
    """A plasma brake hangs or spins in a plasma, and nothing else does."""
    device, steering, plasma = scene.device, steering_of(scene), scene.environment.ionosphere
    if not isinstance(device, PlasmaBrake):
        if not steering.tether_only or scene.steering is None:
            return []
        return [("steering.kind", f'"{scene.steering.kind}" is for a plasma-brake tether')]
    found = []
    if plasma is None:
        found.append(("environment.ionosphere", "a plasma brake needs an ionosphere"))
    if not steering.tether:
        words = '"vertical", "gravity-gradient" or "spinning"'
        found.append(("steering.kind", f"a plasma-brake tether hangs along the gravity gradient or spins: {words}"))
    found += steering.brake(scene, device)
    return found


def density_of_plasma(scene: Scene) -> Faults:
    """Currents need a density."""
    if ionosphere_of(scene).density:
        return []
    words = "needs an ionosphere with a density, not a given force"
    return [(f"device.{name}", words) for name in device_of(scene).density(scene.device)]


def drag(scene: Scene) -> Faults:
    """Air needs an area to brake, and an area needs air."""
    device, air, found = scene.device, scene.environment.atmosphere, []
    if air_on_facets(device):
        if air is None:
            found.append(("device.shape.air", "air on a shape without an atmosphere does nothing"))
        if device.drag_area is not None:
            found.append(("device.drag_area", "the air pushes the facets of the shape: leave the area out"))
        return found
    if air is not None and (device.drag_area is None or device.mass is None):
        found.append(("device.drag_area", "an atmosphere needs the area and the mass that it brakes"))
    if device.drag_area is not None and air is None:
        found.append(("environment.atmosphere", "drag_area without an atmosphere does nothing"))
    return found


def solar_flux(scene: Scene) -> Faults:
    """Tables of plasma and air need the Sun's level, within their range; nothing else does."""
    found, flux, weather = [], scene.environment.solar_flux, scene.environment.space_weather
    range_of_table = ionosphere_of(scene).flux or atmosphere_of(scene).flux
    if weather is not None and flux is not None:
        found.append(("environment.solar_flux", "the file of space weather says how active the Sun is"))
    if weather is not None and not range_of_table:
        found.append(("environment.space_weather", "nothing in this scene depends on it"))
    if range_of_table and flux is None and weather is None:
        words = 'tables need the sun\'s level: solar_flux_sfu = 70 ... 193, solar_flux = "cycle" or space_weather'
        found.append(("environment.solar_flux", words))
    if range_of_table and isinstance(flux, float):
        low, high, words = range_of_table
        if not low <= flux <= high:
            found.append(("environment.solar_flux", f"{words} from {low:g} to {high:g} sfu"))
    if flux is not None and not range_of_table:
        found.append(("environment.solar_flux", "nothing in this scene depends on it"))
    return found


def date_and_sun(scene: Scene) -> Faults:
    """Where the Sun and its cycle stand is said once."""
    found, around = [], scene.environment
    if around.solar_flux == "cycle" and scene.epoch is None:
        found.append(("epoch", "where the solar cycle stands needs a date"))
    if around.space_weather is not None and scene.epoch is None:
        found.append(("epoch", "the file of space weather is read by date"))
    air = around.atmosphere
    if around.space_weather is not None and isinstance(air, MsisAtmosphere) and "ap" in air.model_fields_set:
        found.append(("environment.atmosphere.ap", "the file of space weather says it"))
    if around.sun_right_ascension is not None and scene.epoch is not None:
        found.append(("environment.sun_right_ascension", "the epoch says where the Sun is"))
    return found


def start_round_the_earth(scene: Scene) -> Faults:
    """Ways to say an orbit that only the Earth knows."""
    found: Faults = [] if scene.body == "earth" else start_of(scene).of_the_earth(scene.start)
    return found


def room_for_the_tether(scene: Scene) -> Faults:
    """A tether shorter than its way down, in a plasma that is known there."""
    device, around = scene.device, scene.environment
    altitudes = start_of(scene).altitudes(scene.start) if scene.body == "earth" else None
    if not isinstance(device, PlasmaBrake) or altitudes is None:
        return []
    (low, high), found = altitudes, []
    room = low - device.off_below
    if device.tether_length >= room > 0:
        words = f"longer than the {room / 1e3:.4g} km between the orbit and where the brake goes off"
        found.append(("device.tether_length", words))
    end = ionosphere_of(scene).highest(around.ionosphere)
    if end is not None and high > end:
        words = f'the orbit reaches {high / 1e3:.5g} km, the table 1500: above_table = "hold" keeps its last value'
        found.append(("environment.ionosphere.above_table", words))
    return found
