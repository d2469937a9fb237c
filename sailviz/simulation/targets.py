"""The body that moves on the orbit which a scene wants to reach."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

import numpy as np

from sailviz.constants import DAY
from sailviz.elements import state
from sailviz.ephemeris import seconds_since_j2000, true_anomaly
from sailviz.exchange.small_bodies import J2000
from sailviz.scene.conflicts.known_starts import julian_date
from sailviz.simulation.bodies import epoch_of
from sailviz.sky.places import tdb_ahead

if TYPE_CHECKING:
    from sailviz.run.arrays import Body
    from sailviz.scene.loading import Scene


def moving_target(scene: Scene, body: Body, time: np.ndarray) -> dict[str, np.ndarray]:
    """Name -> places (n, 3) m, in the scene's frame, at times (n,) s of the body on the target orbit: nothing where the
    scene does not say where on it one is. The ellipse stays as it is, as the search for flights to it has it."""
    wanted, epoch = scene.target, epoch_of(scene)
    if wanted is None or epoch is None or wanted.elements_date is None or wanted.mean_anomaly is None:
        return {}
    a = wanted.radius or wanted.semi_major_axis
    assert a is not None  # a planet has no mean anomaly of its own
    now = seconds_since_j2000(epoch) + tdb_ahead(epoch) + np.asarray(time, dtype=float)
    since = now - (julian_date(wanted.elements_date) - J2000) * DAY
    anomaly = true_anomaly(wanted.mean_anomaly + np.sqrt(body.mu / a**3) * since, wanted.eccentricity)
    place, _ = state(a, wanted.eccentricity, wanted.inclination, wanted.raan, wanted.argument, anomaly, body.mu)
    return {body_name(wanted.name): place}


def body_name(orbit: str | None) -> str:
    """What a body on a named orbit is called, fit for the path of an entity."""
    word = re.sub(r"[^\w.-]+", "-", (orbit or "").removeprefix("orbit of ")).strip("-")
    return word or "target"
