"""Whether several devices go together on one craft: what each may be, how it is steered, and the propellant of all."""

from __future__ import annotations

from itertools import pairwise
from math import exp, expm1
from typing import TYPE_CHECKING

from sailviz.constants import STANDARD_GRAVITY
from sailviz.scene.conflicts import craft, departures
from sailviz.scene.conflicts.answers import Faults
from sailviz.scene.conflicts.records import start_of
from sailviz.scene.conflicts.sky import light, steered_by_light
from sailviz.scene.device import Devices, NoDevice, PlasmaBrake, SolarSail, Thruster, control_of
from sailviz.scene.phases import Until, until_of
from sailviz.words import duration, shown

if TYPE_CHECKING:
    from sailviz.scene.loading import Scene

    Burning = tuple[list[departures.Burn], Thruster, float]

# laws that depend on time and state alone and need no table
STEERS_BESIDE = (
    "sun-facing",
    "radial",
    "circumferential",
    "tangential",
    "orbital",
    "meridian",
    "inertial",
    "sun-frame",
)
SOLVED = ("optimal", "smoothed-transfer", "as designed")  # laws made for one device
OF_THE_CRAFT = ("drag_area", "edge_area")
OF_ALL_TOGETHER = ("cone", "thrust_acceleration")  # quantities that the first device alone does not make
PIECES = 32  # of a burn whose throttle changes


def together(scene: Scene) -> Faults:
    """What a craft with several devices is not."""
    if not scene.beside:
        return []
    found = _kinds(scene, scene.device, "device")
    if scene.steering is not None and scene.steering.kind in SOLVED:
        found.append(("steering.kind", f'"{scene.steering.kind}" was made for a craft with one device'))
    if start_of(scene).held or scene.start.kind == "spiral":
        found.append(("start.kind", f"{scene.start.kind}: such an orbit is designed for a craft with one device"))
    for name in ("ensemble", "chaos"):
        if getattr(scene, name):
            found.append((f"{name}[0]", "an ensemble flies one device"))
    if scene.approximation:
        found.append(("approximation[0]", "an analytic solution knows one device"))
    for i, event in enumerate(scene.event):
        for stem in (stem for stem in event.quantities() if stem in OF_ALL_TOGETHER):
            words = f"{stem.replace('_', ' ')} is that of all devices together, which no event watches"
            found.append((f"event[{i}].{stem}", words))
    found += _ends_of_phases(scene)
    burnt = burnt_out(scene)
    if burnt is not None:
        words = f"all thrusters together burn the whole mass in {duration(burnt)}: shorten the run, or end the thrust"
        found.append(("device.active", f"{words} with active"))
    return found


def _ends_of_phases(scene: Scene) -> Faults:
    """No phase ends by what all devices make together."""
    found: Faults = []
    for i, phase in enumerate(scene.phase):
        try:
            until = until_of(phase)
        except ValueError:  # which the questions about phases tell
            continue
        quantities = until.quantities() if isinstance(until, Until) else {}
        for stem in (stem for stem in quantities if stem in OF_ALL_TOGETHER):
            words = f"{stem.replace('_', ' ')} is that of all devices together, which ends no phase"
            found.append((f"phase[{i}].until", words))
    return found


def beside_conflicts(scene: Scene) -> Faults:
    """(place among the devices beside the first one, sentence) of everything that is wrong with them."""
    found: Faults = []
    names = [_word(scene.device.name)]
    for i, device in enumerate(scene.beside):
        place = f"device[{i}]"
        found += _kinds(scene, device, place)
        if isinstance(device, SolarSail) and device.shape is not None:
            words = "a craft turns with its first sail, and has that one's shape: give this one its area"
            found.append((f"{place}.shape", words))
        if _word(device.name) in names:
            found.append((f"{place}.name", f"another device is called {shown(device.name)} already"))
        names.append(_word(device.name))
        found += _steered(device, place)
        for key in OF_THE_CRAFT:
            if getattr(device, key) is not None:
                words = f"the whole craft has one {key}: give it with {scene.device.name}"
                found.append((f"{place}.{key}", words))
        if not found:
            found += [(f"{place}{where.removeprefix('device')}", what) for where, what in _alone(scene.alone(device))]
    return found


def _kinds(scene: Scene, device: Devices, place: str) -> Faults:
    if isinstance(device, PlasmaBrake):
        return [(f"{place}.kind", "a brake stands alone: no other device goes with it")]
    if isinstance(device, NoDevice):
        return [(f"{place}.kind", '"none" is no device beside others: leave it out')]
    found = []
    if control_of(device) is not None:
        found.append((f"{place}.control", "a controller sets the thrust of a craft with one device"))
    if getattr(device, "characteristic_acceleration", None) == "as designed":
        where = f"{place}.characteristic_acceleration"
        found.append((where, "an orbit is designed for a craft with one device: give the acceleration"))
    return found


def _steered(device: Devices, place: str) -> Faults:
    steering = device.steering
    if steering is None:
        words = "needs a steering of its own, a table [device.steering] below it: [steering] steers the first sail only"
        return [(place, words)]
    if steering.kind not in STEERS_BESIDE:
        words = ", ".join(f'"{word}"' for word in STEERS_BESIDE)
        return [(f"{place}.steering.kind", f'"{steering.kind}" steers the first sail only; this device: {words}')]
    if getattr(steering, "in_shadow", None) is not None:
        return [(f"{place}.steering.in_shadow", "belongs to the first sail, by whose attitude the air brakes")]
    return []


def _alone(view: Scene) -> Faults:
    """What would be wrong with a device and its steering if it were the only one, at places of such a scene."""
    found = [*craft.direction_of_thrust(view), *craft.steepest_pitch(view), *departures.frame_of_steering(view)]
    found += [*light(view), *steered_by_light(view)]
    places = {"steering": "device.steering"}
    told = []
    for where, what in found:
        head, dot, rest = where.partition(".")
        if head == "device" or head in places:
            told.append((places.get(head, head) + dot + rest, what))
    return told


def burnt_out(scene: Scene) -> float | None:
    """When, s, the thrusters of a craft have burnt all of its mass; None where they do not within the run. Sizes of
    constant thrust take away evenly, constant accelerations a share."""
    burns = _burns(scene)
    mass = start = scene.device.mass or 1.0
    for begin, end in pairwise(_times(burns, scene.propagation.duration)):
        rate, share = _rates(burns, begin, end)
        span = end - begin
        left = mass * exp(-share * span) + (rate * expm1(-share * span) / share if share else -rate * span)
        if left <= start * exp(-departures.LARGEST_RATIO):
            return begin + span * mass / (mass - left) if mass > left else begin
        mass = left
    return None


def _burns(scene: Scene) -> list[Burning]:
    """Of each thruster that burns propellant its throttle over the run, itself, and the speed of its exhaust, m/s."""
    found = []
    for view in (scene, *(scene.alone(device) for device in scene.beside)):
        device = view.device
        if isinstance(device, Thruster) and device.specific_impulse is not None:
            found.append((departures.burns_of(view), device, STANDARD_GRAVITY * device.specific_impulse))
    return found


def _times(burns: list[Burning], end: float) -> list[float]:
    """Moments, s, between which every throttle is as good as constant."""
    edges = {0.0, end}
    for pieces, _, _ in burns:
        for first, last, low, high in pieces:
            edges |= {first, last}
            if low != high:
                edges |= {first + k / PIECES * (last - first) for k in range(1, PIECES)}
    return sorted(time for time in edges if 0.0 <= time <= end)


def _rates(burns: list[Burning], begin: float, end: float) -> tuple[float, float]:
    """What all thrusters take from the mass between two such moments, kg/s, and the share of it that they take, 1/s."""
    rate = share = 0.0
    for pieces, device, exhaust in burns:
        throttle = sum(0.5 * (c[2] + c[3]) for piece in pieces if (c := departures.cut_to(piece, begin, end)))
        rate += throttle * (device.thrust or 0.0) / exhaust
        share += throttle * (device.acceleration or 0.0) / exhaust
    return rate, share


def _word(name: str | None) -> str:
    """A name as part of a recording's paths."""
    return "".join(letter if letter.isalnum() else "_" for letter in (name or "").lower())
