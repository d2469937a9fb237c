"""Whether the phases of a scene follow each other, end somewhere, and go together with the rest, each by itself."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

from sailviz.scene.conflicts.answers import Faults
from sailviz.scene.conflicts.hybrids import beside_conflicts
from sailviz.scene.conflicts.limits import too_many
from sailviz.scene.conflicts.moments import unknown_here
from sailviz.scene.conflicts.records import device_of, steering_of
from sailviz.scene.device import Devices, ElectricSail, NoDevice, PlasmaBrake, VoltageControl, control_of
from sailviz.scene.phases import DeviceState, Phase, Until, scene_of, steering_of_first, until_of
from sailviz.scene.steering import SmoothedSteering
from sailviz.words import nearest, shown

if TYPE_CHECKING:
    from sailviz.scene.loading import Scene

Question = Callable[["Scene"], Faults]


def phases(scene: Scene) -> Faults:
    """What keeps the phases of a scene from following each other."""
    found: Faults = [(place, sentence) for place, sentence in _not_in_phases(scene)]
    names: set[str] = set()
    latest, rows = 0.0, 0.0
    for i, phase in enumerate(scene.phase):
        place = f"phase[{i}]"
        word = "".join(letter if letter.isalnum() else "_" for letter in phase.name.lower())
        if word in names:
            found.append((f"{place}.name", f"another phase is called {shown(phase.name)} already"))
        names.add(word)
        found += _end(scene, phase, place, i == len(scene.phase) - 1)
        until = _readable(phase)
        if isinstance(until, Until) and until.time is not None:
            if until.time <= latest:
                words = "times count from the start of the run, and this one is not after that of a phase before"
                found.append((_place_of_time(phase, place), words))
            latest = max(latest, until.time)
        found += _devices(scene, phase, place)
        found += _steering(scene, phase, place)
        own = phase.propagation
        if own.outputs is not None and own.output_interval is not None:
            found.append((f"{place}.propagation", "give outputs or output_interval, not both"))
        rows += own.outputs or 0
        if own.output_interval is not None:
            rows += scene.propagation.duration / own.output_interval
            found += too_many(scene, rows, "rows", "rows", f"{place}.propagation.output_interval")
        elif own.outputs:
            found += too_many(scene, rows, "rows", "rows", f"{place}.propagation.outputs")
    return found


def _place_of_time(phase: Phase, place: str) -> str:
    return f"{place}.until" if isinstance(phase.until, str) else f"{place}.until.time"


def _not_in_phases(scene: Scene) -> Faults:
    """What of a scene knows one way to fly for all the flight."""
    if not scene.phase:
        return []
    found: Faults = []
    if scene.ensemble or scene.chaos:
        place = "ensemble[0]" if scene.ensemble else "chaos[0]"
        words = "its flights would change phase each at its own time: ensembles and chaos fly scenes without [[phase]]"
        found.append((place, words))
    if scene.approximation:
        words = "an analytic solution knows one law of thrust for the whole flight: it goes with no [[phase]]"
        found.append(("approximation[0]", words))
    if isinstance(control_of(scene.device), VoltageControl):
        words = "a voltage controller steers by what it set before, which no phase hands on: it goes with no [[phase]]"
        found.append(("device.control", words))
    return found


def _readable(phase: Phase) -> Until | str | None:
    """What ends a phase, None where it cannot be read."""
    try:
        return until_of(phase)
    except ValueError:
        return None


def _end(scene: Scene, phase: Phase, place: str, last: bool) -> Faults:
    """Whether a phase ends, and where something can end it."""
    where = f"{place}.until"
    if last:
        words = "the last phase lasts until the end of the run: leave until out, or stop the run by an [[event]]"
        return [] if phase.until is None else [(where, words)]
    if phase.until is None:
        words = 'is missing: what ends this phase, e.g. "radius_au = 0.48", {time_d = 30}, or the name of an event'
        return [(where, words)]
    try:
        until = until_of(phase)
    except ValueError as error:
        return [(where, str(error))]
    if isinstance(until, str):
        return _end_at_event(scene, until, where)
    assert until is not None
    given = [*until.quantities(), *(["duration"] if until.duration is not None else [])]
    if len(given) != 1:
        has = f", has {' and '.join(given)}" if given else ""
        return [(where, f"needs one quantity and its value, or duration{has}")]
    if until.time is not None and until.time >= scene.propagation.duration:
        return [(_place_of_time(phase, place), "this is not before the end of the run")]
    at = where if not isinstance(phase.until, str) else place
    found = unknown_here(scene, until, at)
    return [(where, f"{until.quantity}: {words}") for _, words in found] if isinstance(phase.until, str) else found


def _end_at_event(scene: Scene, name: str, where: str) -> Faults:
    known = {item.called: item.stop for item in scene.event}
    if name not in known:
        hint = nearest(name, known) if known else "This scene has none."
        words = f"{shown(name)} is no event of this scene, nor a quantity and its value. {hint}"
        return [(where, words)]
    return [(where, f"{shown(name)} stops the run: no phase can follow")] if known[name] else []


def _devices(scene: Scene, phase: Phase, place: str) -> Faults:
    """Whether the devices can stand as a phase wants them."""
    if isinstance(phase.device, DeviceState):
        if scene.place is None or phase.device == DeviceState():
            return _device(scene.device, phase.device, f"{place}.device")
        words = "the devices of a list are set each by its name: [[phase.device]] with name"
        return [(f"{place}.device", words)]
    if scene.place is None:
        return [(f"{place}.device", "this scene has one device, no list [[device]]: write one table, [phase.device]")]
    found, named = Faults(), {device.name: device for device in scene.devices}
    told: set[str] = set()
    for i, state in enumerate(phase.device):
        where = f"{place}.device[{i}]"
        if state.name not in named:
            known = [str(name) for name in named]
            found.append((f"{where}.name", f"no such device {shown(state.name)}. {nearest(state.name, known)}"))
            continue
        if state.name in told:
            found.append((f"{where}.name", f"this phase says already how {shown(state.name)} stands"))
        told.add(state.name)
        found += _device(named[state.name], state, where)
        if state.name == scene.device.name and state.steering is not None and phase.steering is not None:
            words = "steers this device already: say it once"
            found.append((f"{where}.steering", f"{place}.steering {words}"))
    return found


def _of_devices_beside(scene: Scene, phase: Phase, place: str) -> Faults:
    """What is wrong with the steering that a phase gives to devices beside the first one."""
    found: Faults = []
    before = beside_conflicts(scene)
    names = [state.name for state in phase.named]
    for where, words in beside_conflicts(scene_of(scene, phase)):
        head, _, rest = where.removeprefix("device[").partition("]")
        name = scene.beside[int(head)].name
        if (where, words) not in before and name in names:
            found.append((f"{place}.device[{names.index(str(name))}]{rest}", words))
    return found


def _device(device: Devices, state: DeviceState, place: str) -> Faults:
    """Whether a device can stand as a phase wants it."""
    found = Faults()
    if isinstance(device, NoDevice) and (not state.on or state.throttle != 1.0):
        found.append((place, "nothing pushes: the device is none"))
    if state.voltage is None:
        return found
    where = f"{place}.voltage"
    if isinstance(device, ElectricSail):
        if device.voltage is None:
            words = "the sail gives its strength as an acceleration: set throttle, or give it tethers and a voltage"
            found.append((where, words))
        elif state.voltage <= device.wind_potential:
            found.append((where, "must exceed device.wind_potential, or there is no thrust: on = false"))
    elif isinstance(device, PlasmaBrake):
        if state.voltage == 0:
            found.append((where, "voltage 0 makes no brake: on = false"))
        elif state.voltage < 0 and device.polarity == "positive":
            found.append((where, 'voltage is negative and polarity "positive": give one sign only'))
    else:
        found.append((where, f"a {device.kind} has no voltage: set throttle"))
    return found


def _steering(scene: Scene, phase: Phase, place: str) -> Faults:
    """What a steering asks that a phase does not give."""
    found = _of_devices_beside(scene, phase, place) if phase.named else Faults()
    steering = steering_of_first(scene, phase)
    if steering is None:
        return found
    if steering is not phase.steering:
        place = _of_first(scene, phase, place)
    where = f"{place}.steering.kind"
    if device_of(scene).tether:
        words = "a tether lies as [steering] says in all phases; a phase switches it and sets its voltage"
        found.append((where, words))
    if isinstance(steering, SmoothedSteering):
        words = "a smoothed transfer is solved from the start of the run to its end: it is no phase"
        found.append((where, words))
    if steering_of(scene_of(scene, phase)).planar(steering) and phase is not scene.phase[0]:
        words = "three costates belong to a start without inclination: give six in a later phase"
        found.append((f"{place}.steering.costates", words))
    return found


def asked_of_each(scene: Scene, questions: Sequence[Question], later: Sequence[Question]) -> Faults:
    """Faults of the scenes that the phases make: all questions of the first, those that no start decides of the
    others."""
    found: Faults = []
    for i, phase in enumerate(scene.phase):
        one = scene_of(scene, phase)
        for question in later if i else questions:
            for place, words in question(one):
                fault = (_placed(scene, phase, i, place), words)
                if fault not in found:
                    found.append(fault)
    return found


def _of_first(scene: Scene, phase: Phase, place: str) -> str:
    """Where a phase says how the device stands that [steering] steers."""
    names = [state.name for state in phase.named]
    return f"{place}.device[{names.index(scene.device.name)}]" if scene.device.name in names else place


def _placed(scene: Scene, phase: Phase, i: int, place: str) -> str:
    """Where in the file a fault of a phase's own scene lies."""
    first, named = place.split(".", 1)[0], _of_first(scene, phase, f"phase[{i}]")
    steering, voltage = steering_of_first(scene, phase), phase.state_of(scene.device).voltage
    if first == "steering" and steering is not None:
        return f"phase[{i}].{place}" if steering is phase.steering else f"{named}.{place}"
    if phase.named and place == "device.voltage" and voltage is not None:
        return f"{named}.voltage"
    own = voltage is not None and place == "device.voltage"
    own |= place.startswith("propagation.") and getattr(phase.propagation, place.split(".")[1], None) is not None
    return f"phase[{i}].{place}" if own else place
