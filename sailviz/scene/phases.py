"""What holds from one event to the next: the tables [[phase]], and the scene that each of them makes of the whole."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Annotated

from pydantic import Field, ValidationError

from sailviz.scene.device import ElectricSail, PlasmaBrake
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
    device: DeviceState = DeviceState()
    propagation: PhasePropagation = PhasePropagation()


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
    device = scene.device
    if phase.device.voltage is not None and isinstance(device, (ElectricSail, PlasmaBrake)):
        device = device.model_copy(update={"voltage": phase.device.voltage})
    return scene.model_copy(
        update={
            "steering": scene.steering if phase.steering is None else phase.steering,
            "device": device,
            "propagation": run.model_copy(
                update={
                    "tolerance": run.tolerance if own.tolerance is None else own.tolerance,
                    "largest_step": run.largest_step if own.largest_step is None else own.largest_step,
                }
            ),
        }
    )
