"""What the records of a scene's parts hand over to the right-hand side."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from sailviz.propagate.callbacks import Callback
from sailviz.propulsion.solar_sail import Film
from sailviz.steering import attitude, by_light

if TYPE_CHECKING:
    from sailviz.run.arrays import Body, Phase
    from sailviz.scene.loading import Scene

Array = np.ndarray[Any, Any]
Words = list[tuple[str, str]]  # rows of the parameter table: name and value
Columns = dict[str, Array]  # of the recording's environment, unit in each name
Switches = tuple[tuple[float, str], ...]  # (time s, "thrust on" | "thrust off")


def no_words(*_: Any) -> Words:
    """A part that has nothing to say in the parameter table."""
    return []


def no_columns(*_: Any) -> Columns:
    """A part that adds nothing to what is recorded."""
    return {}


class LoweredDevice(NamedTuple):
    """A device: a kind of propulsion.devices with its Parameters, or the kind CALLED with a callback. forces : what it
    adds beside, whatever the thrust's direction."""

    kind: int
    parameters: Sequence[float] = ()
    callback: Callback | None = None
    forces: tuple[Callback, ...] = ()


class LoweredSteering(NamedTuple):
    """A steering: a kind of steering.attitude with its parameters or its table, or CALLED with a callback."""

    kind: int = attitude.RADIAL
    parameters: Sequence[float] = ()
    table: Array | None = None
    interpolation: int = attitude.LINEAR
    switches: Switches = ()
    callback: Callback | None = None
    steer_as: tuple[int, Sequence[float]] = (0, ())  # the sail of a primer law: id and parameters
    primer_kind: int = 0
    breaks: tuple[float, ...] = ()  # s, where its thrust jumps
    phases: tuple[Phase, ...] = ()  # what it flies one after the other
    by_light: by_light.Parameters = by_light.Parameters()  # of a law that counts from the light


@dataclass(frozen=True)
class Flight:
    """What a steering may need to know: the scene, its design, the state at the start (m, m/s), the device."""

    scene: Scene
    design: Any  # of a start that asks for one, else None
    position: Array
    velocity: Array
    device: LoweredDevice  # before its sky
    sail: Film | str | None  # as design functions take it; None where the device is no sail
    strength: float | None  # its characteristic acceleration, m/s2
    begin: float = 0.0  # s, when the steering takes over: what it counts in time counts from there


@dataclass(frozen=True)
class Place:
    """What a part of the environment may need to know."""

    scene: Scene
    body: Body
    epoch: np.datetime64 | None


def merged(*parts: dict[str, Any]) -> dict[str, Any]:
    """Keywords of `dynamics.model` from several parts: forces add up, all else is said once. One force without numbers
    of its own, asked for twice, acts once."""
    found: dict[str, Any] = {}
    forces: list[Callback] = []
    for part in parts:
        for force in part.get("forces", ()):
            if force.numbers or force not in forces:
                forces.append(force)
        found |= part
    return found | {"forces": tuple(forces)}


Lower = Callable[[Any, Place], dict[str, Any]]
