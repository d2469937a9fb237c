"""A scene's events as the propagator watches them."""

from __future__ import annotations

from typing import TYPE_CHECKING

from sailviz.propagate import events as happening

if TYPE_CHECKING:
    pass


_SENSE = {"up": 1, "down": -1, "both": 0}


def _watched(scene, body):
    """Names and Watch of the scene's events and of those that come with a device."""
    names, rows = [], []
    for event in scene.event:
        sense = _SENSE[event.sense]
        kind = {"radius": happening.RADIUS, "altitude": happening.RADIUS, "node": happening.NODE}.get(event.kind)
        level = event.radius or (body.radius + event.altitude if event.altitude else 0.0)
        if event.kind == "mean-altitude":
            kind = happening.MEAN_AXIS if scene.environment.j2 else happening.AXIS
        elif event.kind == "escape":
            kind, sense = happening.ENERGY, 1
        elif event.kind in ("periapsis", "apoapsis"):
            kind, sense = happening.APSIS, 1 if event.kind == "periapsis" else -1
        names.append(event.name or event.kind)
        rows.append((kind, level, sense, happening.STOP if event.stop else happening.RECORD))
    if scene.device.kind == "plasma-brake":
        names.append("brake off")
        rows.append((happening.RADIUS, body.radius + scene.device.off_below, -1, happening.END_OF_USE))
    return tuple(names), happening.watch(rows)
