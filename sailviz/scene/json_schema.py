"""JSON Schema of a scene file, every quantity spelled out in each of its units."""

from __future__ import annotations

from typing import Any

from sailviz.units import spelled


def with_units(schema: dict[str, Any]) -> dict[str, Any]:
    """A JSON Schema in which every quantity is spelled out in each of its units."""
    for part in (schema, *schema.get("$defs", {}).values()):
        _spell_out(part)
    return schema


def _dimension_of(schema: dict[str, Any]) -> str | None:
    if "x-dimension" in schema:
        return str(schema["x-dimension"])
    options = schema.get("anyOf", [])
    return next((found for option in options if (found := _dimension_of(option))), None)


def _without_si(schema: dict[str, Any]) -> dict[str, Any]:
    """The property without what holds in SI only: bounds other than zero, defaults."""
    bounds = ("minimum", "maximum", "exclusiveMinimum", "exclusiveMaximum")
    kept = {
        key: [_without_si(option) for option in value] if key == "anyOf" else value
        for key, value in schema.items()
        if key not in ("x-dimension", "default", "title") and not (key in bounds and value != 0)
    }
    if "anyOf" in kept:
        kept["anyOf"] = [option for option in kept["anyOf"] if option.get("type") != "null"]
    return kept


def _spell_out(schema: dict[str, Any]) -> None:
    properties = schema.get("properties", {})
    required = schema.get("required", [])
    for name in list(properties):
        dimension = _dimension_of(properties[name])
        if not dimension:
            continue
        plain = _without_si(properties.pop(name))
        keys = spelled(name, dimension)
        for key in keys:
            properties[key] = plain
        words = [option.get("const") for option in plain.get("anyOf", []) if "const" in option]
        if words:
            properties[name] = {"enum": words}
            keys = [*keys, name]
        if name in required:
            required.remove(name)
            schema.setdefault("allOf", []).append({"oneOf": [{"required": [key]} for key in keys]})
