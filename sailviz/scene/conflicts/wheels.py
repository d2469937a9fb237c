"""What an electric sail's wheel that is a body goes together with."""

from __future__ import annotations

from typing import TYPE_CHECKING

from sailviz.scene.conflicts.answers import Faults
from sailviz.scene.device import ElectricSail, Wheel
from sailviz.scene.film import asked_for
from sailviz.scene.sky import light_away, magnetosphere_of
from sailviz.scene.steering import FrameSteering, OptimalSteering, PlainSteering

if TYPE_CHECKING:
    from sailviz.scene.loading import Scene

OF_A_WHEEL = ("spin_rate", "modulation", "thrust_lost", "wheel_torque")
FOLLOWS = ("sun-facing", "radial", "orbital")  # laws whose axis keeps its angles to the orbit
STEEPEST = 1.5  # rad; edge-on nothing holds an axis


def wheel_of_the_sail(scene: Scene) -> Faults:
    """What a wheel asks of the scene, and where its quantities are known."""
    device, found = scene.device, list[tuple[str, str]]()
    if (
        any(isinstance(one, ElectricSail) and one.wheel is not None for one in scene.devices)
        and scene.place is not None
    ):
        found.append(("device.wheel", "a wheel as a body is its craft's only device, in no list of several"))
    if not isinstance(device, ElectricSail) or device.wheel is None:
        for stem in OF_A_WHEEL:
            words = "is known of an electric sail with a wheel: device.wheel"
            found += [(place, f"{stem} {words}") for place in asked_for(scene, stem)]
        return found
    return found + _of_its_hardware(scene, device) + _of_its_steering(scene) + _of_its_spin(scene, device.wheel)


def _of_its_hardware(scene: Scene, device: ElectricSail) -> Faults:
    found, where = list[tuple[str, str]](), "device.wheel"
    if device.model != "final":
        found.append((where, 'the wheel is made of the final model\'s tethers: model = "final"'))
    if device.tethers is None:
        found.append((where, "needs the hardware: tethers, tether_length, voltage and mass"))
    elif device.tethers < 3:
        found.append(("device.tethers", "three tethers or more make a wheel"))
    if device.control is not None:
        found.append((where, "the voltage turns with the wheel already: control or wheel"))
    if light_away(scene) or magnetosphere_of(scene) != "none":
        found.append((where, "is known in the wind of the body at the centre"))
    if scene.ensemble or scene.chaos:
        place = "ensemble[0]" if scene.ensemble else "chaos[0]"
        found.append((place, "ensembles fly wheels that are flat: device.wheel"))
    return found


def _of_its_steering(scene: Scene) -> Faults:
    found, steering = list[tuple[str, str]](), scene.steering
    if isinstance(steering, OptimalSteering) and steering.reckons_with is None:
        words = 'was solved for a flat wheel: reckons_with = "electric-sail", or another steering'
        found.append(("steering.kind", f'"{steering.kind}" {words}'))
    if isinstance(steering, PlainSteering) and steering.kind == "as designed":
        found.append(("steering.kind", "orbits are designed for a wheel that is flat and does not spin"))
    if isinstance(steering, FrameSteering) and abs(steering.pitch) > STEEPEST:
        found.append(("steering.pitch", "beyond 85.9 deg no voltage holds the axis of a wheel"))
    return found


def _of_its_spin(scene: Scene, wheel: Wheel) -> Faults:
    found, steering = list[tuple[str, str]](), scene.steering
    if wheel.spin_period is not None:
        if steering is not None and steering.kind not in FOLLOWS:
            words = "the drift of the spin is known of axes that keep their angles to the orbit"
            found.append(("steering.kind", f"{words}: {', '.join(FOLLOWS)}"))
        if scene.propagation.integrator not in ("auto", "dop853"):
            words = "the spin of a wheel is carried by DOP853 alone, which auto takes"
            found.append(("propagation.integrator", words))
        for place in asked_for(scene, "mass"):
            if not place.startswith("expect"):
                found.append((place, "no propellant burns beside a wheel that spins: the mass stays as it is"))
    else:
        words = "is known of a wheel that gives its spin_period"
        found += [(place, f"spin_rate {words}") for place in asked_for(scene, "spin_rate")]
    return found
