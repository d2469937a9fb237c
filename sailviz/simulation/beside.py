"""Devices beside the first one of a craft: their numbers for the right-hand side, their times, and what they did."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from sailviz import frames
from sailviz.propagate import beside_callback, dynamics, force_callback
from sailviz.propagate.parameters import Pushed
from sailviz.propulsion.devices import CALLED, THRUSTER
from sailviz.run.arrays import Thrust
from sailviz.scene.device import ElectricSail, SolarSail, Thruster, by_force
from sailviz.scene.environment import Environment
from sailviz.simulation.device import DEVICES
from sailviz.simulation.lowered import Array, Flight, LoweredDevice, Switches
from sailviz.simulation.steering import steering_of
from sailviz.simulation.thrust_history import Schedule, schedule

if TYPE_CHECKING:
    from sailviz.propagate.callbacks import Callback
    from sailviz.scene.device import Devices
    from sailviz.scene.loading import Scene
    from sailviz.simulation.plan import Plan

CALM = Environment()  # where nothing varies


class BesideDevice(NamedTuple):
    """One device beside the first."""

    name: str
    numbers: Array  # of `propagate.beside_callback`
    burns: bool  # propellant

    @property
    def callback(self) -> Callback:
        """Its force, for `dynamics.model`."""
        return beside_callback.beside(self.numbers)


def _felt(scene: Scene, device: Devices) -> Scene:
    """The scene with what a device feels of wind and sunlight that vary."""
    around = scene.environment
    changes: dict[str, Any] = {}
    if not isinstance(device, ElectricSail):
        changes["solar_wind"] = CALM.solar_wind
    if not isinstance(device, SolarSail):
        changes["irradiance"] = CALM.irradiance
    return scene.model_copy(update={"environment": around.model_copy(update=changes)}) if changes else scene


def schedules(scene: Scene, table: Array | None, jumps: tuple[float, ...] = ()) -> tuple[Schedule, list[Schedule]]:
    """The thrust of the first device, with breaks wherever the thrust of any device has one, and that of each of the
    others. table, and jumps s : of the first one's steering."""
    if not scene.beside:
        return schedule(scene, table, jumps), []
    first = schedule(_felt(scene, scene.device), table, jumps)
    others = [schedule(_felt(scene.alone(device), device), None) for device in scene.beside]
    breaks = np.unique(np.concatenate([each.breaks for each in (first, *others)]))
    histories: dict[str, np.ndarray] = {}
    for each in (*others, first):
        at = np.searchsorted(each.breaks, breaks, side="right") - 1
        histories |= {name: values[at] for name, values in each.histories.items()}
    at = np.searchsorted(first.breaks, breaks, side="right") - 1
    switches: Switches = ()
    for device, each in zip((scene.device, *scene.beside), (first, *others), strict=True):
        switches += _called(name_of(device), each.switches)
    return replace(first, breaks=breaks, factors=first.factors[at], switches=switches, histories=histories), others


def in_phase(times: list[Schedule], levels: list[float]) -> list[Schedule]:
    """The thrust of each device beside the first one at its level in a phase."""
    return [replace(each, factors=each.factors * level) for each, level in zip(times, levels, strict=True)]


def _called(name: str, switches: Switches) -> Switches:
    """Switches by the name of the device that they are of."""
    return tuple((time, f"{name} {word.removeprefix('thrust ')}") for time, word in switches)


def named_switches(scene: Scene, switches: Switches) -> Switches:
    """Switches of the first device, by its name where it has others beside it."""
    return _called(name_of(scene.device), switches) if scene.beside else switches


def mass_of_strength(scene: Scene, device: Devices) -> float:
    """kg, at which a sail has the strength that its area or its hardware makes, where propellant burns beside it; else
    0, and its acceleration stays as it is."""
    burns = any(isinstance(one, Thruster) and one.specific_impulse is not None for one in scene.devices)
    return device.mass or 0.0 if burns and by_force(device) else 0.0


def by_its_force(scene: Scene, device: LoweredDevice, overhead: dict[str, Any]) -> tuple[LoweredDevice, dict[str, Any]]:
    """The first device, and the keywords of `dynamics.model` beside it, so that a sail pushes with its force while
    the mass of the craft falls. overhead : keywords of its sky."""
    mass = mass_of_strength(scene, scene.device)
    if mass == 0.0:
        return device, overhead
    sky: dict[str, Any] = overhead.get("sky", {})
    pushed = sky.get("pushed", Pushed())
    if device.kind != CALLED:  # as it is where a sky pushes it
        pushed = pushed._replace(device=device.kind)
        device = device._replace(kind=CALLED, callback=force_callback.sail_by_force())
    return device, overhead | {"sky": sky | {"pushed": pushed._replace(mass=mass)}}


def devices_beside(
    scene: Scene, position: Array, velocity: Array, times: list[Schedule], under_sky: bool
) -> list[BesideDevice]:
    """The devices beside the first one. times : the thrust of each."""
    found = []
    for device, when in zip(scene.beside, times, strict=True):
        view, record = scene.alone(device), DEVICES[type(device)]
        lowered: LoweredDevice = record.lower(device, view, None)
        flight = Flight(view, None, position, velocity, lowered, None, None)
        steered = steering_of(device.steering).lower(device.steering, flight)
        law = steered.by_light
        in_frame = len(steered.parameters) == 0
        direction = (law.along, law.east, law.north) if in_frame else steered.parameters
        numbers = beside_callback.numbers(
            lowered.kind,
            lowered.parameters,
            steered.kind,
            direction,
            bool(law.by_orbit),
            under_sky,
            mass_of_strength(scene, device),
            when.breaks,
            when.factors,
        )
        burns = lowered.kind == THRUSTER and lowered.parameters[2] != 0.0
        found.append(BesideDevice(name_of(device), numbers, burns))
    return found


def thrust_of(acceleration: Array, axes: Array, on: Array) -> Thrust:
    """A Thrust (n,) from an acceleration (n, 3) m/s2, the axes (n, 3, 3) of the orbit, and when it is on."""
    return Thrust(acceleration, frames.to_frame(axes, acceleration), np.linalg.norm(acceleration, axis=1), on)


def observed_devices(p: Plan, time: Array, states: Array, factor: Array, axes: Array) -> dict[str, Thrust]:
    """Name -> what each device of a list did, in its order. time (n,) s, states (7, n), factor (n,) of the first one's
    thrust, axes (n, 3, 3)."""
    scene, model = p.scene, p.model
    _, acceleration, throttle = dynamics.observe(time, states, factor, dynamics.without_user_force(model))
    on = (factor * throttle != 0) & (model.device != dynamics.NO_DEVICE)
    found = {name_of(scene.device): thrust_of(acceleration, axes, on)}
    for device in p.beside:
        _, acceleration, factors = beside_callback.observe_beside(time, states, model.parameters, device.numbers)
        found[device.name] = thrust_of(acceleration, axes, factors != 0.0)
    return {name_of(device): found[name_of(device)] for device in scene.devices}


def name_of(device: Devices) -> str:
    """A device's name, or the word of its kind."""
    return device.name or device.kind


def sum_of(devices: dict[str, Thrust], but: str | None) -> Array:
    """The acceleration (n, 3) m/s2 of all devices but one."""
    others = [each.acceleration for name, each in devices.items() if name != but]
    first = next(iter(devices.values()))
    return np.sum(others, axis=0) if others else np.zeros_like(first.acceleration)
