"""The records of the sections that a scene has: one look-up each, so that no question asks for a kind by its word."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from sailviz.scene.conflicts.devices import DEVICES, OTHER_DEVICE, DeviceFits
from sailviz.scene.conflicts.starts import STARTS, StartFits
from sailviz.scene.conflicts.steerings import NO_STEERING, OTHER_STEERING, STEERINGS, SteeringFits
from sailviz.scene.conflicts.surroundings import ATMOSPHERES, IONOSPHERES, LayerFits

if TYPE_CHECKING:
    from sailviz.scene.loading import Scene

NO_LAYER = LayerFits()


def start_of(scene: Scene) -> StartFits[Any]:
    """Facts of the scene's kind of start."""
    return STARTS[type(scene.start)]


def device_of(scene: Scene) -> DeviceFits[Any]:
    """Facts of the scene's kind of device."""
    return DEVICES.get(type(scene.device), OTHER_DEVICE)


def devices_of(scene: Scene) -> list[DeviceFits[Any]]:
    """Facts of the kinds of all devices of the craft."""
    return [DEVICES.get(type(device), OTHER_DEVICE) for device in scene.devices]


def steering_of(scene: Scene) -> SteeringFits[Any]:
    """Facts of the scene's kind of steering, or of having none."""
    return NO_STEERING if scene.steering is None else STEERINGS.get(scene.steering.kind, OTHER_STEERING)


def ionosphere_of(scene: Scene) -> LayerFits:
    """Facts of the scene's kind of ionosphere, or of having none."""
    plasma = scene.environment.ionosphere
    return NO_LAYER if plasma is None else IONOSPHERES[type(plasma)]


def atmosphere_of(scene: Scene) -> LayerFits:
    """Facts of the scene's kind of atmosphere, or of having none."""
    air = scene.environment.atmosphere
    return NO_LAYER if air is None else ATMOSPHERES[type(air)]
