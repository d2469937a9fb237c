"""What a craft that turns, [attitude], goes together with."""

from __future__ import annotations

from typing import TYPE_CHECKING

from sailviz.scene.attitude import (
    ControlledAttitude,
    FreeAttitude,
    Moving,
    PrescribedAttitude,
    SlidingMass,
    SpinAveragedAttitude,
)
from sailviz.scene.conflicts.answers import Faults
from sailviz.scene.conflicts.records import start_of, steering_of
from sailviz.scene.device import NoDevice, PlasmaBrake, SolarSail, air_on_facets
from sailviz.scene.phases import attitude_in
from sailviz.scene.quantities import spellings

if TYPE_CHECKING:
    from sailviz.scene.loading import Scene

OF_LIGHT = ("light_torque",)
OF_AIR = ("air_torque",)
OF_ACTUATORS = ("control_torque", "wheel_momentum")
OF_BODY = ("body_rate", "nutation", "wheel_momentum")  # quantities that only a craft that turns has
BELONGS = 'belongs to a craft that turns: attitude.kind "free", "controlled" or "spin-averaged"'


def turning(scene: Scene) -> Faults:
    """What keeps a craft from turning."""
    attitude = scene.attitude
    if attitude is None:
        return []
    found = _known_craft(scene) + _mass(scene)
    if isinstance(attitude, Moving):
        found += _flown_alone(scene)
    held = any(phase.attitude is not None and phase.attitude.kind == "controlled" for phase in scene.phase)
    if isinstance(attitude, FreeAttitude | SpinAveragedAttitude) and scene.steering is not None and not held:
        words = f"nothing follows it: the attitude is {attitude.kind}. Leave the steering out, or control the attitude"
        found.append(("steering.kind", words))
    if isinstance(attitude, ControlledAttitude):
        found += _followed(scene, attitude)
    return found


def turning_in_phases(scene: Scene) -> Faults:
    """What keeps a craft from turning as its phases say."""
    found: Faults = []
    for i, phase in enumerate(scene.phase):
        place = f"phase[{i}].attitude"
        if phase.attitude is not None and not isinstance(scene.attitude, Moving):
            words = "this craft stands as its steering says: a phase lets go or holds what turns by itself, [attitude]"
            found.append((place, words))
        elif phase.attitude is not None:
            assert isinstance(scene.attitude, Moving)
            try:
                phase.attitude.of(scene.attitude)
            except ValueError as error:
                found.append((place, str(error)))
        turns = attitude_in(scene, phase)
        if isinstance(turns, FreeAttitude | SpinAveragedAttitude) and phase.steering is not None:
            words = f"nothing follows it in this phase: the attitude is {turns.kind}"
            found.append((f"phase[{i}].steering.kind", words))
    return found


def followed_in_phase(scene: Scene) -> Faults:
    """What keeps a controller from following the steering, in the scene of a phase."""
    found = _mass(scene) if isinstance(scene.attitude, Moving) else []
    return found + _followed(scene, scene.attitude) if isinstance(scene.attitude, ControlledAttitude) else found


def expected_of_turning(scene: Scene) -> Faults:
    """What is expected of a craft's turning is there to be expected."""
    found: Faults = []
    attitudes = [scene.attitude, *(attitude_in(scene, phase) for phase in scene.phase)]
    shaped = isinstance(scene.device, SolarSail) and scene.device.shape is not None
    for i, item in enumerate(scene.expect):
        stem = spellings()[item.quantity].stem
        where = f"expect[{i}].quantity"
        if stem in OF_BODY and not isinstance(scene.attitude, Moving):
            found.append((where, f"{stem} {BELONGS}"))
        elif stem in OF_ACTUATORS and not any(isinstance(one, ControlledAttitude) for one in attitudes):
            found.append((where, f'{stem} belongs to actuators: attitude.kind "controlled"'))
        elif stem in OF_LIGHT and not shaped:
            found.append((where, f"{stem} is that of a solar sail with a shape"))
        elif stem in OF_AIR and not air_on_facets(scene.device):
            found.append((where, f"{stem} is that of a solar sail whose shape air pushes: device.shape.air"))
    return found


def _known_craft(scene: Scene) -> Faults:
    attitude, device = scene.attitude, scene.device
    assert attitude is not None
    if scene.place is not None:
        words = (
            "a craft that turns has one device, in no list of several: no key says where on it others push and turn it"
        )
        return [("attitude.kind", words)]
    if isinstance(device, PlasmaBrake):
        return [("attitude.kind", "a tether is no rigid body: its attitude is that of its steering")]
    if isinstance(attitude, PrescribedAttitude):
        return []
    if isinstance(device, SolarSail) and device.shape is None:
        words = 'needs the shape that the light turns, also of a flat sail: {kind = "square", side_m = 9.27}'
        return [("device.shape", words)]
    if not isinstance(device, SolarSail | NoDevice):
        words = (
            f"an attitude that is {attitude.kind} is known of a solar sail with a shape and of a craft without device"
        )
        return [("device.kind", words)]
    if isinstance(device, SolarSail) and device.roll is not None and not isinstance(attitude, ControlledAttitude):
        return [("device.roll", "belongs to a steering: how the craft stands at the start says attitude.roll")]
    return []


def _mass(scene: Scene) -> Faults:
    attitude, device = scene.attitude, scene.device
    assert attitude is not None
    shaped = isinstance(device, SolarSail) and device.shape is not None
    found: Faults = []
    if attitude.film_mass is not None:
        if not shaped:
            found.append(("attitude.film_mass", "belongs to a solar sail with a shape: give inertia"))
        elif device.mass is not None and attitude.film_mass > device.mass:
            found.append(("attitude.film_mass", f"is more than the whole craft's {device.mass:g} kg"))
    if isinstance(attitude, ControlledAttitude):
        for i, one in enumerate(attitude.actuators):
            if not isinstance(device, SolarSail) and one.kind != "wheels":
                found.append((f"attitude.actuators[{i}].kind", f"{one.kind} needs the light on a solar sail"))
            if isinstance(one, SlidingMass) and device.mass is not None and one.mass >= device.mass:
                found.append((f"attitude.actuators[{i}].mass", f"is not a part of the craft's {device.mass:g} kg"))
    return found


def _flown_alone(scene: Scene) -> Faults:
    """What knows crafts that stand as their steering says."""
    attitude = scene.attitude
    assert attitude is not None
    words = f"knows crafts that stand as their steering says, and the attitude is {attitude.kind}"
    found: Faults = []
    for name, what in (
        ("chaos", "an expansion"),
        ("approximation", "an analytic solution"),
    ):
        if getattr(scene, name):
            found.append((f"{name}[0]", f"{what} {words}"))
    if scene.propagation.integrator not in ("auto", "dop853"):
        found.append(("propagation.integrator", f'{scene.propagation.integrator} {words}: "dop853"'))
    if scene.device.drag_area == "attitude":
        found.append(("device.drag_area", f'"attitude" {words}: give an area, or shape.air'))
    if start_of(scene).held:
        found.append(("start.kind", f"{scene.start.kind}: an orbit held by its steering {words}"))
    return found


def _followed(scene: Scene, attitude: ControlledAttitude) -> Faults:
    if scene.steering is None:
        return [("attitude.control", "follows a steering, and the scene has none")]
    law = steering_of(scene)
    if law.primer or law.as_designed or law.tether_only or scene.steering.kind in ("vertical", "smoothed-transfer"):
        words = f'"{scene.steering.kind}" is not followed by a controller: its normal jumps, or is none of a sail'
        return [("steering.kind", words)]
    return []
