"""The wheel of a scene's electric sail as a body: to the right-hand side, in the recording, in words."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from sailviz.constants import AU
from sailviz.errors import Fault, SceneError
from sailviz.propagate import wheel_callback
from sailviz.propulsion.esail_wheel import Bend, Numbers, parabola, straight
from sailviz.scene.device import ElectricSail, Wheel
from sailviz.scene.phases import scene_of
from sailviz.scene.steering import FrameSteering
from sailviz.words import angle, duration

if TYPE_CHECKING:
    from sailviz.propagate.dynamics import Model
    from sailviz.scene.loading import Scene
    from sailviz.simulation.lowered import Array, Columns, Words


def wheel_of(scene: Scene) -> Wheel | None:
    """The wheel of the scene's electric sail, where it is a body."""
    return scene.device.wheel if isinstance(scene.device, ElectricSail) else None


def spins(scene: Scene) -> bool:
    """Whether the spin of a wheel is told, which the state then carries."""
    wheel = wheel_of(scene)
    return wheel is not None and wheel.spin_period is not None


def bend_of(wheel: Wheel) -> Bend:
    """How its tethers are bent."""
    return straight(wheel.cone) if wheel.rise is None else parabola(wheel.rise)


def wheel_numbers(scene: Scene, strength: float) -> Numbers | tuple[()]:
    """Numbers of the wheel for `dynamics.model`; none where there is none. strength : a_c of the flat wheel, m/s2."""
    wheel, device = wheel_of(scene), scene.device
    if wheel is None:
        return ()
    assert isinstance(device, ElectricSail)
    assert device.tethers is not None
    assert device.tether_length is not None
    assert device.mass is not None
    length, inertia, spin = device.tether_length, 0.0, 0.0
    if wheel.spin_period is not None:
        inertia = device.tethers * (wheel.tip_mass + wheel.tether_mass / 3) * length**2
        first = scene_of(scene, scene.phase[0]).steering if scene.phase else scene.steering
        pitch = first.pitch if isinstance(first, FrameSteering) else 0.0
        spin = 2 * np.pi / wheel.spin_period * abs(float(np.cos(pitch)))
    lever = strength * device.mass * length * AU
    return Numbers(strength * AU, *bend_of(wheel), lever, inertia, spin, float(wheel.hold))


def refuse_saturated(scene: Scene, model: Model, state: Array) -> None:
    """SceneError where a wheel's voltage cannot hold its axis from the start. state (7,)."""
    if wheel_of(scene) is None:
        return
    share = wheel_callback.observe_wheel(np.zeros(1), state[:, None].copy(), np.ones(1), model.parameters)
    asked = float(share[wheel_callback.SHARE, 0])
    if asked > 1.0:
        words = (
            f"the voltage would have to swing by {asked:.3g} of its mean to hold the axis, and 1 is all: less cone, "
        )
        raise SceneError([Fault("device.wheel", f"{words}pitch or spin, or hold = false.")], scene.source)


def wheel_columns(scene: Scene, model: Model, time: Array, states: Array, factor: Array) -> Columns:
    """Columns (n,) of the environment. time (n,) s, states (7, n), factor (n,) of the thrust."""
    wheel = wheel_of(scene)
    if wheel is None:
        return {}
    values = wheel_callback.observe_wheel(time, np.ascontiguousarray(states), factor, model.parameters)
    columns: Columns = {"wheel_torque_N_m": values[wheel_callback.TORQUE]}
    if wheel.hold:
        columns |= {"modulation": values[wheel_callback.SHARE], "thrust_lost": values[wheel_callback.LOST]}
    if wheel.spin_period is not None:
        columns["spin_rate_rad_s"] = values[wheel_callback.SPIN]
    return columns


def wheel_words(scene: Scene) -> Words:
    """Rows of the parameter table."""
    wheel = wheel_of(scene)
    if wheel is None:
        return []
    bent = f"coned by {angle(wheel.cone)}" if wheel.rise is None else f"a parabola of rise {wheel.rise:g}"
    rows = [("wheel", f"{bent}, {'held by its voltage' if wheel.hold else 'not held'}")]
    if wheel.spin_period is not None:
        rows.append(("spin", f"one turn in {duration(wheel.spin_period)} at the start"))
    return rows
