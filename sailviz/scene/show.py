"""A scene in words: the parameter table of a recording and the text of `sailviz show`."""

from __future__ import annotations

import math

from sailviz.constants import AU, DAY, YEAR


def length(value: float) -> str:
    """A length in m in the unit a reader expects."""
    if abs(value) >= 0.01 * AU:
        return f"{value / AU:.6g} au"
    if abs(value) >= 1e3:
        return f"{value / 1e3:,.6g} km"
    return f"{value:.6g} m" if abs(value) >= 0.1 else f"{value * 1e3:.6g} mm"


def duration(value: float) -> str:
    """A time in s in years, days, hours, minutes or seconds."""
    for size, word in ((YEAR, "yr"), (DAY, "d"), (3600.0, "h"), (60.0, "min")):
        if abs(value) >= size * 0.999_999:
            return f"{value / size:.6g} {word}"
    return f"{value:.6g} s"


def angle(value: float) -> str:
    """An angle in rad in degrees."""
    return f"{math.degrees(value):.6g}°"


def acceleration(value: float) -> str:
    """An acceleration in m/s2 in mm/s2, or um/s2 when small."""
    return f"{value * 1e3:.5g} mm/s²" if abs(value) >= 1e-5 else f"{value * 1e6:.5g} µm/s²"


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


_SI = {
    "length": "m",
    "thickness": "m",
    "time": "s",
    "angle": "rad",
    "speed": "m/s",
    "acceleration": "m/s²",
    "mass": "kg",
    "ion_mass": "kg",
    "area": "m²",
    "voltage": "V",
    "pressure": "Pa",
    "power": "W",
    "force": "N",
    "force_per_length": "N/m",
    "mass_density": "kg/m³",
    "solar_flux": "sfu",
    "number_density": "1/m³",
    "mu": "m³/s²",
    "angular_rate": "rad/s",
}
_WORDS = {"length": length, "time": duration, "angle": angle, "acceleration": acceleration}


def resolved_lines(scene) -> list[str]:
    """Every value of a scene, defaults included: path = SI value, and in words where that reads better."""
    from sailviz.scene.faults import _inside

    lines = []

    def walk(section, path):
        for name, field in type(section).model_fields.items():
            value = getattr(section, name)
            here = f"{path}.{name}" if path else name
            dimension, _ = _inside(field.annotation, field.metadata)
            show(value, dimension, here)

    def show(value, dimension, here):
        if hasattr(type(value), "model_fields"):
            walk(value, here)
        elif isinstance(value, list) and value and hasattr(type(value[0]), "model_fields"):
            for i, item in enumerate(value):
                walk(item, f"{here}[{i}]")
        elif dimension and isinstance(value, (int, float)):
            unit = _SI[dimension]
            said = _WORDS[dimension](value) if dimension in _WORDS else ""
            words = f"   ({said})" if said and said != f"{value:.6g} {unit}" else ""
            lines.append(f"{here} = {value:.12g} {unit}{words}")
        elif value is not None:
            unit = f" {_SI[dimension]}" if dimension and not isinstance(value, str) else ""
            lines.append(f"{here} = {value!r}{unit}" if isinstance(value, str) else f"{here} = {value}{unit}")

    walk(scene, "")
    return lines
