"""What distinguishes a scene: the parameter table of a recording."""

from __future__ import annotations

from typing import TYPE_CHECKING

from sailviz.scene.environment import GammaWind
from sailviz.simulation.start import departure
from sailviz.words import acceleration, angle, duration, length

if TYPE_CHECKING:
    from sailviz.scene.loading import Scene
    from sailviz.simulation.start import Rows


def parameters_in_words(scene, design, strength) -> list[tuple[str, str]]:
    """(name, value) pairs of what distinguishes a scene, most telling first. design: of a designed orbit, or None.
    strength: characteristic acceleration of a sail, m/s2, or None."""
    rows = []
    device = scene.device
    rows += departure(scene).words(scene.start, design)
    if strength is not None:
        rows += [("a_c", acceleration(strength))]
        if device.kind == "solar-sail" and device.lightness_number is not None:
            rows += [("lightness number", f"{device.lightness_number:.6g}")]
    if device.kind == "plasma-brake":
        rows += [
            ("tether", length(device.tether_length)),
            ("voltage", f"{'+' if device.polarity == 'positive' else '−'}{abs(device.voltage):g} V"),
            ("mass", f"{device.mass:g} kg"),
        ]
    if device.kind == "thruster":
        if device.acceleration is not None:
            rows += [("acceleration", acceleration(device.acceleration))]
        else:
            rows += [("thrust", f"{device.thrust * 1e3:g} mN"), ("mass", f"{device.mass:g} kg")]
    steering = scene.steering
    if steering is not None and steering.kind in ("orbital", "meridian"):
        rows += [("pitch", angle(steering.pitch))]
    elif steering is not None and steering.kind == "as designed" and getattr(design.pitch, "ndim", 0) == 0:
        rows += [("pitch", angle(float(design.pitch)))]
    return rows + _wind(scene) + _expectations(scene)


def _wind(scene: Scene) -> Rows:
    wind = scene.environment.solar_wind
    if not isinstance(wind, GammaWind):
        return []
    pressure = f"{wind.shape * wind.scale * 1e9:.4g} nPa"
    return [("mean pressure", pressure), ("redrawn every", duration(wind.redraw))]


def _expectations(scene: Scene) -> Rows:
    """The first of what the scene expects of its own flight."""
    rows = []
    for item in [item for item in scene.expect if item.ensemble is None][:3]:
        when = item.at if item.at is not None else duration(item.at_time or 0.0)
        rows.append((f"expected {item.quantity} ({when})", f"{item.value:.7g}"))
    return rows
