"""The bodies and the epoch of a scene as the propagator knows them."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from sailviz import sky
from sailviz.run.arrays import Body

if TYPE_CHECKING:
    from sailviz.scene.loading import Scene

BODIES = {word: Body(body.name, body.mu, body.radius) for word, body in sky.BODIES.items()}


def body_of(scene: Scene) -> Body:
    """What the craft flies round."""
    if isinstance(scene.body, str):
        return BODIES[scene.body]
    return Body(scene.body.name, scene.body.mu, scene.body.radius)


def epoch_of(scene: Scene) -> np.datetime64 | None:
    """UTC of t = 0."""
    return None if scene.epoch_utc is None else np.datetime64(scene.epoch_utc, "ns")
