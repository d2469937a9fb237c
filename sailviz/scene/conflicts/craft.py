"""Whether start, device and steering go together, and with the body and what shines and blows on them."""

from __future__ import annotations

from typing import TYPE_CHECKING

from sailviz.scene.attitude import Moving
from sailviz.scene.conflicts.answers import Faults
from sailviz.scene.conflicts.devices import CONTROLS
from sailviz.scene.conflicts.records import device_of, devices_of, start_of, steering_of
from sailviz.scene.conflicts.starts import STARTS
from sailviz.scene.conflicts.surroundings import IRRADIANCES, WINDS
from sailviz.scene.device import ElectrochromicControl, SolarSail, control_of
from sailviz.scene.film import tells_film
from sailviz.scene.units_in_keys import words_of_kind

if TYPE_CHECKING:
    from sailviz.scene.loading import Scene


def direction_of_thrust(scene: Scene) -> Faults:
    """A steering that points what the craft pushes with."""
    device, steering, found = device_of(scene), steering_of(scene), []
    word = scene.steering.kind if scene.steering else None
    if device.directed and not steering.directs:
        words = '"radial", "circumferential", "tangential", "inertial", "orbital", "meridian" or "table"'
        found.append(("steering.kind", f"a thruster needs a direction: {words}"))
    if device.sail and not steering.sail:
        found.append(("steering.kind", f'"{word}" is a thruster\'s law; a sail is steered by pitch and clock angle'))
    if steering.primer and not device.sail:
        found.append(("steering.kind", f'"{word}" steers a solar sail or an electric sail'))
    return found


def planar_costates(scene: Scene) -> Faults:
    """A law for one plane begins in it."""
    if not steering_of(scene).planar(scene.steering) or not start_of(scene).inclined(scene.start):
        return []
    return [("steering.costates", "three costates belong to a planar flight: a start without inclination")]


def designed_orbit(scene: Scene) -> Faults:
    """An orbit that is held, and what holds it."""
    start, device = start_of(scene), device_of(scene)
    strength, steering = device.as_designed(scene.device), steering_of(scene).as_designed
    if not start.held:
        held = [word for kind, fits in STARTS.items() if fits.held for word in words_of_kind(kind)]
        needs = f'"as designed" needs a start.kind that is held: {", ".join(held)}'
        places = (("device.characteristic_acceleration", strength), ("steering.kind", steering))
        return [(place, needs) for place, asked in places if asked]
    kind = scene.start.kind
    if not device.sail:
        return [("start.kind", f"{kind}: such an orbit is held by a solar sail or an electric sail")]
    found: Faults = device.design(scene.device)
    if not found and start.track and not (strength and steering):
        found.append(("start.kind", f'{kind} needs characteristic_acceleration and steering "as designed"'))
    return found


def round_the_sun(scene: Scene) -> Faults:
    """What is known among the planets only."""
    found, target = [], scene.target
    if target is not None and target.planet is not None and scene.body != "sun":
        found.append(("target.planet", "a planet's orbit goes round the Sun"))
    if target is not None and target.elements_date is not None and scene.epoch is None:
        found.append(("target.elements_date", "where the body stands is known at a date: give epoch"))
    if scene.environment.third_body is not None and scene.body != "sun":
        found.append(("environment.third_body", "a third body goes round the Sun"))
    return found


def what_the_start_asks(scene: Scene) -> Faults:
    """What one kind of start alone asks of the scene."""
    found: Faults = start_of(scene).conflicts(scene, scene.start)
    return found


def what_the_transfer_asks(scene: Scene) -> Faults:
    """What a law that solves for a transfer asks of the scene."""
    found: Faults = steering_of(scene).transfer(scene, scene.steering)
    return found


def surface_of_the_body(scene: Scene) -> Faults:
    """An altitude is counted from something."""
    if not start_of(scene).over_surface(scene.start) or has_surface(scene):
        return []
    return [("start.altitude", "the body has no radius to measure an altitude from")]


def has_surface(scene: Scene) -> bool:
    """Whether the central body has a radius."""
    return isinstance(scene.body, str) or scene.body.radius != 0


def brightness(scene: Scene) -> Faults:
    """How bright the light is matters where it makes an acceleration of area and mass."""
    if scene.light is None or not scene.light.bright:
        return []
    if any(isinstance(device, SolarSail) and device.by_area for device in scene.devices) or tells_film(scene):
        return []
    words = "acts on a solar sail that gives its area and its mass, or on a film that ages or gets too hot, on no other"
    return [("light", f"the brightness of the light {words}")]


def varying_drive(scene: Scene) -> Faults:
    """Wind, sunlight and control that vary need a craft that feels them, and an end."""
    found: Faults = []
    devices = devices_of(scene)
    wind, light, control = scene.environment.solar_wind, scene.environment.irradiance, control_of(scene.device)
    blows, shines = WINDS[type(wind)], IRRADIANCES[type(light)]
    if not blows.steady and not any(device.wind for device in devices):
        found.append(("environment.solar_wind", "the solar wind acts on an electric sail only"))
    if not shines.steady and not any(device.sunlight for device in devices):
        found.append(("environment.irradiance", "irradiance that varies acts on a solar sail only"))
    if control is None:
        return found
    answers = CONTROLS[type(control)]
    if not answers.voltage and shines.steady:
        found.append(("device.control", "in steady sunlight there is nothing to control"))
    return found


def sail_with_a_shape(scene: Scene) -> Faults:
    """What knows flat sails only."""
    device = scene.device
    if not isinstance(device, SolarSail) or device.shape is None:
        return []
    found: Faults = []
    if device.control is not None:
        found.append(("device.control", "a film that darkens is known of flat sails only, not of one with a shape"))
    for i, item in enumerate(scene.ensemble):
        if isinstance(item.control, ElectrochromicControl):
            found.append((f"ensemble[{i}].control", "a film that darkens is known of flat sails only"))
        if not isinstance(scene.attitude, Moving) and steering_of(scene).frame(scene.steering) == "meridian":
            words = "a shape that is laid by the meridian turns along the flight: count from the orbit's frame"
            found.append((f"ensemble[{i}].name", words))
    return found


def steepest_pitch(scene: Scene) -> Faults:
    """Pitch angles for which the force is known."""
    device, angles = device_of(scene), steering_of(scene).pitch(scene.steering)
    limit = device.steepest(scene.device)
    if not device.sail or not angles or max(map(abs, angles)) <= limit * (1 + 1e-12):
        return []
    degrees = limit * 57.29577951308232
    return [("steering.pitch", f"beyond {degrees:.4g} deg the {scene.device.kind}'s force model does not hold")]
