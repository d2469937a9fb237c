"""The analytic solutions that a scene wants recorded beside its own flight."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from sailviz.simulation.first_order import FirstOrder
    from sailviz.simulation.quasi_circular import QuasiCircular
from sailviz.simulation.device import film_of, sail_strength


def _approximations(scene, body, position, velocity, design) -> dict[str, FirstOrder]:
    """The analytic trajectories that a scene wants recorded beside its own."""
    wanted = [item for item in scene.approximation if item.kind == "first-order"]
    if not wanted:
        return {}
    from sailviz.simulation.first_order import FirstOrder

    r0, mu = float(np.linalg.norm(position)), body.mu
    device, steering = scene.device, scene.steering
    law = steering.kind if steering is not None else "radial"
    pitch = steering.pitch * np.sign(np.sin(steering.clock)) if law == "orbital" else 0.0
    if device.kind == "thruster":
        size = device.acceleration * r0**2 / mu
        if law == "circumferential":
            pitch = np.pi / 2
        thrust = (size * np.cos(pitch), size * np.sin(pitch), 0)
    else:
        from sailviz.design.asymptotic import solution as asymptotic

        shape = "electric-sail" if device.kind == "electric-sail" else film_of(scene)
        thrust = asymptotic.thrust(shape, sail_strength(scene, design), pitch, r0, mu)
    return {
        item.name: FirstOrder(
            position, velocity, mu, scene.propagation.duration, thrust, item.leg, item.scheme, scene.source
        )
        for item in wanted
    }


def _quasi_circular(scene, position, velocity) -> QuasiCircular | None:
    """The analytic decay that a scene wants recorded beside its own."""
    if all(item.kind != "quasi-circular" for item in scene.approximation):
        return None
    from sailviz.simulation.quasi_circular import QuasiCircular

    return QuasiCircular(scene, position, velocity)
