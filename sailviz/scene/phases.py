"""What holds from one event to the next: the tables [[phase]], and the scene that each of them makes of the whole."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Annotated, Any

from pydantic import Discriminator, Field, Tag, ValidationError

from sailviz.scene.attitude import Attitudes, FreeAttitude, PhaseAttitude, SpinAveragedAttitude, StartsTurned
from sailviz.scene.device import Devices, ElectricSail, PlasmaBrake
from sailviz.scene.events import Crossing
from sailviz.scene.quantities import spellings
from sailviz.scene.steering import Steering
from sailviz.scene.values import POSITIVE, Section, Time, Voltage
from sailviz.units import UNITS
from sailviz.words import nearest, shown

if TYPE_CHECKING:
    from sailviz.scene.loading import Scene

AN_EQUATION = re.compile(r"\s*([A-Za-z]\w*)\s*=\s*(\S+)\s*")


class Until(Crossing):
    """The end of a phase: a quantity that crosses a value, of which `time` counts from the start of the run, or the
    duration of the phase."""

    duration: Annotated[Time, POSITIVE] | None = None


class DeviceState(Section):
    """How the device stands: on or off, at a share of its thrust, at a voltage."""

    on: bool = True
    throttle: Annotated[float, Field(ge=0, le=1)] = 1.0
    voltage: Voltage | None = None

    @property
    def level(self) -> float:
        """Share of the device's thrust."""
        return self.throttle if self.on else 0.0


class StateOfOne(DeviceState):
    """How one device in a list stands, and how it is steered: as before where that is not said."""

    name: Annotated[str, Field(min_length=1)]
    steering: Steering | None = None


def _listed(value: Any) -> str:
    """Whether a phase says how the device stands, or how each of several does."""
    return "several" if isinstance(value, (list, tuple)) else "one"


class PhasePropagation(Section):
    """How the rows of a phase come, and how accurately; what is not said is that of [propagation]."""

    outputs: Annotated[int, Field(ge=2, le=1_000_000_000)] | None = None
    output_interval: Annotated[Time, POSITIVE] | None = None
    tolerance: Annotated[float, Field(ge=1e-15, le=1e-3)] | None = None
    largest_step: Annotated[Time, POSITIVE] | None = None


class Phase(Section):
    """Steering, state of the device and rows from the end of the phase before until an event."""

    name: Annotated[str, Field(min_length=1)]
    until: str | Until | None = None
    steering: Steering | None = None
    device: Annotated[
        Annotated[DeviceState, Tag("one")] | Annotated[list[StateOfOne], Tag("several")], Discriminator(_listed)
    ] = DeviceState()
    attitude: PhaseAttitude | None = None
    propagation: PhasePropagation = PhasePropagation()

    @property
    def named(self) -> list[StateOfOne]:
        """How devices in a list stand, each by its name."""
        return self.device if isinstance(self.device, list) else []

    def state_of(self, device: Devices) -> DeviceState:
        """How a device stands; those that are not named as if there were no phases."""
        if isinstance(self.device, DeviceState):
            return self.device
        return next((state for state in self.device if state.name == device.name), DeviceState())


def steering_of_first(scene: Scene, phase: Phase) -> Steering | None:
    """What a phase says of the steering of the device that [steering] steers; None where it says nothing."""
    own = phase.state_of(scene.device)
    return own.steering if isinstance(own, StateOfOne) and own.steering is not None else phase.steering


def end_of(name: str) -> str:
    """The name of the event that ends a phase."""
    return f"end of {name}"


def until_of(phase: Phase) -> Until | str | None:
    """What ends a phase: a crossing or a duration, the name of an event, or None for the end of the run. ValueError,
    with a sentence, for an equation that says nothing."""
    if not isinstance(phase.until, str):
        return phase.until
    found = AN_EQUATION.fullmatch(phase.until)
    return phase.until if found is None else equation(found[1], found[2])


def equation(key: str, number: str) -> Until:
    """The crossing that "radius_au = 0.48" means. ValueError, with a sentence."""
    known = {name: (one.stem, one.factor) for name, one in spellings().items()}
    known |= {f"duration_{unit}": ("duration", factor) for unit, factor in UNITS["time"].items()}
    if key not in known:
        stems = {stem for stem, _ in known.values()}
        if key in stems:
            units = [name for name, (stem, _) in known.items() if stem == key]
            raise ValueError(f"{key} needs its unit: write one of {', '.join(units)}.")
        raise ValueError(f"unknown quantity {shown(key)}. {nearest(key, known)}")
    stem, factor = known[key]
    if stem in Until.why_not:
        raise ValueError(f"{stem} {Until.why_not[stem]}.")
    try:
        value = float(number)
    except ValueError:
        raise ValueError(f"{shown(number)} is no number: write {key} = 0.5, for example.") from None
    try:
        return Until.model_validate({stem: value * factor})
    except ValidationError as error:
        words = error.errors(include_url=False)[0]["msg"]
        raise ValueError(f"{key} = {number}: {words[0].lower() + words[1:]}, in SI.") from None


def scene_of(scene: Scene, phase: Phase) -> Scene:
    """The scene that holds during a phase: its steering, its device and its tolerance in place of the whole's."""
    run, own = scene.propagation, phase.propagation
    steering, turns = steering_of_first(scene, phase), attitude_in(scene, phase)
    followed = None if isinstance(turns, FreeAttitude | SpinAveragedAttitude) else scene.steering
    found = scene.model_copy(
        update={
            "steering": followed if steering is None else steering,
            "attitude": turns,
            "device": _as_in(phase, scene.device),
            "propagation": run.model_copy(
                update={
                    "tolerance": run.tolerance if own.tolerance is None else own.tolerance,
                    "largest_step": run.largest_step if own.largest_step is None else own.largest_step,
                }
            ),
        }
    )
    return found.with_beside(tuple(_as_in(phase, device) for device in scene.beside)) if scene.beside else found


def attitude_in(scene: Scene, phase: Phase) -> Attitudes | None:
    """How the craft turns during a phase: as in the whole scene where it says nothing, or nothing that can be."""
    if phase.attitude is None or not isinstance(scene.attitude, StartsTurned):
        return scene.attitude
    try:
        return phase.attitude.of(scene.attitude)
    except ValueError:
        return scene.attitude


def _as_in(phase: Phase, device: Devices) -> Devices:
    """A device with what a phase says of it; how the first one is steered the scene says."""
    state, changes = phase.state_of(device), dict[str, Any]()
    if state.voltage is not None and isinstance(device, (ElectricSail, PlasmaBrake)):
        changes["voltage"] = state.voltage
    if isinstance(state, StateOfOne) and state.steering is not None and device.steering is not None:
        changes["steering"] = state.steering
    return device.model_copy(update=changes) if changes else device
