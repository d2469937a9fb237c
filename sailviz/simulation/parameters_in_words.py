"""What distinguishes a scene: the parameter table of a recording."""

from __future__ import annotations

from sailviz.words import acceleration, angle, duration, length


def parameters_in_words(scene, design, strength) -> list[tuple[str, str]]:
    """(name, value) pairs of what distinguishes a scene, most telling first. design: of a designed orbit, or None.
    strength: characteristic acceleration of a sail, m/s2, or None."""
    rows = []
    start, device = scene.start, scene.device
    if start.kind == "displaced":
        rows += [
            ("distance from the Sun", length(start.radius)),
            ("elevation", angle(start.elevation)),
            ("Ω / Ω_K", f"{start.rate_ratio:.6g}"),
            ("cone angle", angle(float(design.cone))),
        ]
    elif start.kind in ("heliostationary", "lagrange-point"):
        rows += [("distance from the Sun", length(start.radius))]
    elif start.kind == "planet-following":
        rows += [("elevation", angle(start.elevation)), ("distance over the planet's", f"{start.radius_ratio:.6g}")]
    elif start.kind == "flat-ellipse":
        rows += [("height", length(start.height)), ("eccentricity", f"{start.eccentricity:.6g}")]
    elif start.kind == "spiral":
        rows += [("flight-path angle", angle(float(design.flight_path_angle)))]
    elif start.kind == "circular":
        sizes = (("radius", start.radius), ("altitude", start.altitude), ("mean altitude", start.mean_altitude))
        rows += [(f"initial {name}", length(value)) for name, value in sizes if value is not None]
        if start.inclination:
            rows += [("inclination", angle(start.inclination))]
    elif start.kind == "elements":
        rows += [("semi-major axis", length(start.semi_major_axis)), ("eccentricity", f"{start.eccentricity:.6g}")]
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
    wind = scene.environment.solar_wind
    if wind.kind == "gamma":
        rows += [
            ("mean pressure", f"{wind.shape * wind.scale * 1e9:.4g} nPa"),
            ("redrawn every", duration(wind.redraw)),
        ]
    for item in [item for item in scene.expect if item.ensemble is None][:3]:
        when = item.at if item.at is not None else duration(item.at_time)
        rows += [(f"expected {item.quantity} ({when})", f"{item.value:.7g}")]
    return rows
