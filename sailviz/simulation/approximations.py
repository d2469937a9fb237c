"""The analytic solutions that a scene wants recorded beside its own flight."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from sailviz.scene.device import ElectricSail, Thruster
from sailviz.scene.sections import FirstOrderApproximation, QuasiCircularApproximation
from sailviz.scene.steering import FrameSteering
from sailviz.simulation.device import film_of, sail_strength

if TYPE_CHECKING:
    from sailviz.run.arrays import Body
    from sailviz.scene.loading import Scene
    from sailviz.simulation.first_order import FirstOrder
    from sailviz.simulation.quasi_circular import QuasiCircular
    from sailviz.simulation.start import Design


def first_orders(
    scene: Scene, body: Body, position: np.ndarray, velocity: np.ndarray, design: Design
) -> dict[str, FirstOrder]:
    """Name -> first-order solution, whose positions are recorded. SceneError where one breaks down before the end."""
    wanted = [item for item in scene.approximation if isinstance(item, FirstOrderApproximation)]
    if not wanted:
        return {}
    from sailviz.simulation.first_order import FirstOrder

    thrust = _canonical_thrust(scene, body, float(np.linalg.norm(position)), design)
    duration = scene.propagation.duration
    return {
        item.name: FirstOrder(position, velocity, body.mu, duration, thrust, item.leg, item.scheme, scene.source)
        for item in wanted
    }


def _canonical_thrust(scene: Scene, body: Body, r0: float, design: Design) -> tuple[float, float, float]:
    """(radial, transverse, exponent of 1/r), canonical for a length r0 in m: what the scene's check lets through."""
    device, steering = scene.device, scene.steering
    pitch = 0.0
    if isinstance(steering, FrameSteering):
        pitch = float(steering.pitch * np.sign(np.sin(steering.clock)))
    if isinstance(device, Thruster) and device.acceleration is not None:
        size = device.acceleration * r0**2 / body.mu
        if steering is not None and steering.kind == "circumferential":
            pitch = np.pi / 2
        return size * np.cos(pitch), size * np.sin(pitch), 0
    from sailviz.design import asymptotic

    shape = "electric-sail" if isinstance(device, ElectricSail) else film_of(scene)
    return asymptotic.thrust(shape, sail_strength(scene, design), pitch, r0, body.mu)


def quasi_circular_decay(scene: Scene, position: np.ndarray, velocity: np.ndarray) -> QuasiCircular | None:
    """The decay by quadrature, whose altitude is recorded; None where the scene does not ask for it."""
    if not any(isinstance(item, QuasiCircularApproximation) for item in scene.approximation):
        return None
    from sailviz.simulation.quasi_circular import QuasiCircular

    return QuasiCircular(scene, position, velocity)
