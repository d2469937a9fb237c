"""What each kind of [device] goes together with."""

from __future__ import annotations

from collections.abc import Callable
from math import pi
from typing import TYPE_CHECKING, Any, Generic, NamedTuple, TypeVar

from sailviz.scene.conflicts.answers import Faults, never, no_sentences, nothing, unknown
from sailviz.scene.device import (
    Device,
    DistanceControl,
    ElectricSail,
    ElectrochromicControl,
    NoDevice,
    PlasmaBrake,
    PressureControl,
    SolarSail,
    Thruster,
)
from sailviz.scene.values import Section

if TYPE_CHECKING:
    from sailviz.scene.loading import Scene

D = TypeVar("D", bound=Device)
C = TypeVar("C", bound=Section)
STEEPEST = pi / 2  # rad, where a sail shows its edge


class DeviceFits(NamedTuple, Generic[D]):
    """Facts of a kind of device. Functions take a section of the kind."""

    sail: bool = False  # pushed by the Sun, steered by pitch and clock angle
    wind: bool = False  # feels the solar wind
    sunlight: bool = False  # feels how bright the Sun is
    directed: bool = False  # pushes wherever its steering points, which has to be said
    tether: bool = False  # hangs from a satellite in the ionosphere
    as_designed: Callable[[D], bool] = never  # its strength is that of the start's design
    design: Callable[[D], Faults] = nothing  # what keeps it from holding a designed orbit
    steepest: Callable[[D], float] = lambda device: STEEPEST  # pitch angle, rad, beyond which the force is not known
    ensemble: Callable[[D], list[str]] = no_sentences  # why many cannot fly side by side
    first_order: Callable[[D], list[str]] = no_sentences  # what the first-order solution does not know of it
    decays: bool = False  # the quasi-circular decay may know it
    decay: Callable[[Scene, D], list[str]] = no_sentences  # what that does not know of it
    density: Callable[[D], list[str]] = no_sentences  # its keys that need the density of the plasma


def _sail_as_designed(device: SolarSail | ElectricSail) -> bool:
    return device.characteristic_acceleration == "as designed"


def _film_first_order(device: SolarSail) -> list[str]:
    found = [] if device.shape is None else ["the first-order solution knows flat sails, not one with a shape"]
    if device.ageing is not None:
        found.append("the first-order solution knows films that stay as they are, not one that ages")
    return found


def _electric_design(device: ElectricSail) -> Faults:
    if device.wheel is not None:
        return [("device.wheel", "orbits are designed for a wheel that is flat")]
    return [] if device.model == "final" else [("device.model", 'orbits are designed with the "final" model')]


def _electric_steepest(device: ElectricSail) -> float:
    return device.pitch_limit if device.model in ("original", "updated") else STEEPEST


def _electric_ensemble(device: ElectricSail) -> list[str]:
    words = 'an ensemble needs thrust that falls as 1/r: model "final", "updated" or "polynomial"'
    return [words] if device.model == "original" else []


def _electric_first_order(device: ElectricSail) -> list[str]:
    if device.wheel is not None:
        return ["the first-order solution knows electric sails that are flat: device.wheel"]
    return [] if device.model == "final" else ['the first-order solution needs the electric sail\'s "final" model']


def _thruster_first_order(device: Thruster) -> list[str]:
    if device.thrust is None and device.specific_impulse is None:
        return []
    return ["the first-order solution is compared at constant acceleration, without loss of mass"]


def _brake_density(device: PlasmaBrake) -> list[str]:
    given = {
        "power": device.power is not None,
        "eclipse_power": device.eclipse_power is not None,
        "polarity": device.polarity == "positive",
    }
    return [name for name, said in given.items() if said]


def _brake_decay(scene: Scene, device: PlasmaBrake) -> list[str]:
    found, tilted = [], scene.steering is not None and scene.steering.kind == "gravity-gradient"
    if device.eclipse != "on" or device.power is not None or device.polarity == "positive":
        found.append("the quasi-circular decay knows a negative tether at full voltage")
    if tilted or scene.environment.magnetic_sensitivity > 0:
        found.append("the quasi-circular decay knows a vertical or spinning tether and no magnetic field")
    return found


DEVICES: dict[type[Section], DeviceFits[Any]] = {  # the functions of each record take the class that it stands under
    SolarSail: DeviceFits[SolarSail](
        sail=True, sunlight=True, as_designed=_sail_as_designed, first_order=_film_first_order
    ),
    ElectricSail: DeviceFits[ElectricSail](
        sail=True,
        wind=True,
        as_designed=_sail_as_designed,
        design=_electric_design,
        steepest=_electric_steepest,
        ensemble=_electric_ensemble,
        first_order=_electric_first_order,
    ),
    PlasmaBrake: DeviceFits[PlasmaBrake](tether=True, decays=True, decay=_brake_decay, density=_brake_density),
    Thruster: DeviceFits[Thruster](directed=True, first_order=_thruster_first_order),
    NoDevice: DeviceFits[NoDevice](decays=True),
}

OTHER_DEVICE = DeviceFits[Any]()  # a device that says nothing here goes with every start and every steering


class ControlFits(NamedTuple, Generic[C]):
    """Facts of a kind of control. Functions take a section of the kind."""

    voltage: bool = False  # sets an electric sail's; else how a solar sail answers to sunlight that varies
    interval: Callable[[C], float | None] = unknown  # s between updates


def _interval(control: PressureControl | DistanceControl) -> float:
    return control.interval


CONTROLS: dict[type[Section], ControlFits[Any]] = {
    PressureControl: ControlFits[PressureControl](voltage=True, interval=_interval),
    DistanceControl: ControlFits[DistanceControl](voltage=True, interval=_interval),
    ElectrochromicControl: ControlFits[ElectrochromicControl](),
}
