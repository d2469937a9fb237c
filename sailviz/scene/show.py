"""A scene in words: the parameter table of a recording and the text of `sailviz show`."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from pydantic import BaseModel

from sailviz.scene.units_in_keys import dimension_and_models
from sailviz.words import acceleration, angle, duration, length

if TYPE_CHECKING:
    from sailviz.scene.loading import Scene

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
    "current": "A",
    "irradiance": "W/m²",
    "temperature": "K",
    "specific_energy": "J/kg",
    "specific_angular_momentum": "m²/s",
    "force": "N",
    "force_per_length": "N/m",
    "mass_density": "kg/m³",
    "solar_flux": "sfu",
    "number_density": "1/m³",
    "mu": "m³/s²",
    "angular_rate": "rad/s",
    "torque": "N m",
    "angular_momentum": "N m s",
    "inertia": "kg m²",
}
_WORDS = {"length": length, "time": duration, "angle": angle, "acceleration": acceleration}


def resolved_lines(scene: Scene) -> list[str]:
    """Every value of a scene, defaults included: path = SI value, and in words where that reads better."""
    lines: list[str] = []
    for name in type(scene).model_fields:
        if name == "device" and scene.place is not None:
            lines += _value_lines(list(scene.devices), None, name)
        else:
            dimension, _ = dimension_and_models(*_annotation(scene, name))
            lines += _value_lines(getattr(scene, name), dimension, name)
    return lines


def _annotation(section: BaseModel, name: str) -> tuple[object, list[object]]:
    field = type(section).model_fields[name]
    return field.annotation, field.metadata


def _section_lines(section: BaseModel, path: str) -> Iterator[str]:
    for name in type(section).model_fields:
        dimension, _ = dimension_and_models(*_annotation(section, name))
        yield from _value_lines(getattr(section, name), dimension, f"{path}.{name}" if path else name)


def _value_lines(value: object, dimension: str | None, here: str) -> Iterator[str]:
    if isinstance(value, BaseModel):
        yield from _section_lines(value, here)
    elif isinstance(value, list) and value and isinstance(value[0], BaseModel):
        for i, item in enumerate(value):
            yield from _section_lines(item, f"{here}[{i}]")
    elif dimension and isinstance(value, (int, float)):
        unit = _SI[dimension]
        said = _WORDS[dimension](value) if dimension in _WORDS else ""
        words = f"   ({said})" if said and said != f"{value:.6g} {unit}" else ""
        yield f"{here} = {value:.12g} {unit}{words}"
    elif value is not None:
        unit = f" {_SI[dimension]}" if dimension and not isinstance(value, str) else ""
        yield f"{here} = {value!r}{unit}" if isinstance(value, str) else f"{here} = {value}{unit}"
