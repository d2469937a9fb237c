"""The bodies and the epoch of a scene as the propagator knows them."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from sailviz.constants import MU_EARTH, MU_SUN, RADIUS_EARTH, RADIUS_SUN
from sailviz.run.arrays import Body

if TYPE_CHECKING:
    from sailviz.scene.loading import Scene

BODIES = {
    "sun": Body("Sun", MU_SUN, RADIUS_SUN),
    "earth": Body("Earth", MU_EARTH, RADIUS_EARTH),
}


def body_of(scene: Scene) -> Body:
    """What the craft flies round."""
    if isinstance(scene.body, str):
        return BODIES[scene.body]
    return Body(scene.body.name, scene.body.mu, scene.body.radius)


def third_body(scene: Scene) -> tuple[float, ...]:
    """mu m3/s2, radius m, rate rad/s and azimuth rad of a third body on its circle; () without one."""
    third = scene.environment.third_body
    if third is None:
        return ()
    return third.mu, third.radius, np.sqrt(MU_SUN / third.radius**3), third.azimuth


def epoch_of(scene: Scene) -> np.datetime64 | None:
    """UTC of t = 0."""
    return None if scene.epoch_utc is None else np.datetime64(scene.epoch_utc, "ns")
