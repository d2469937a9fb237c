"""A scene in words: the parameter table of a recording and the text of `sailviz show`."""

from __future__ import annotations

from sailviz.words import acceleration, angle, duration, length

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
    from sailviz.scene.units_in_keys import _inside

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
