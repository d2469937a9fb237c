"""JSON Schema of the files that people write: every quantity in each of its units, every key with its meaning."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Any

from pydantic import BaseModel

from sailviz.scene.descriptions import description_of, table_description
from sailviz.scene.units_in_keys import dimension_and_models
from sailviz.units import UNITS, spelled
from sailviz.version import __version__

DIALECT = "https://json-schema.org/draft/2020-12/schema"
BOUNDS = ("minimum", "maximum", "exclusiveMinimum", "exclusiveMaximum")
IN_WORDS = {  # units whose key does not say them plainly
    "au": "au (149,597,870.7 km)",
    "earth_radii": "equatorial radii of the Earth (6378.137 km)",
    "solar_radii": "radii of the Sun (695,700 km)",
    "um": "µm",
    "K": "kelvins",
    "yr": "years of 365.25 days",
    "d": "days",
    "h": "hours",
    "min": "minutes",
    "deg": "degrees",
    "rad": "radians",
    "rad_s": "rad/s",
    "deg_s": "degrees per second",
    "deg_d": "degrees per day",
    "m_s": "m/s",
    "km_s": "km/s",
    "m_s2": "m/s²",
    "mm_s2": "mm/s²",
    "um_s2": "µm/s²",
    "t": "tonnes",
    "u": "atomic mass units",
    "m2": "m²",
    "km2": "km²",
    "uN_m2": "µN/m²",
    "W_m2": "W/m²",
    "uN": "µN",
    "N_m": "N/m",
    "nN_m": "nN/m",
    "mN_km": "mN/km",
    "per_m3": "1/m³",
    "per_cm3": "1/cm³",
    "kg_m3": "kg/m³",
    "g_cm3": "g/cm³",
    "rpm": "turns a minute",
    "torque N_m": "N m",  # of a force per length it is another unit
    "mN_m": "mN m",
    "uN_m": "µN m",
    "N_m_s": "N m s",
    "mN_m_s": "mN m s",
    "kg_m2": "kg m²",
    "sfu": "solar flux units (1e-22 W/m²/Hz at 10.7 cm)",
    "m3_s2": "m³/s²",
    "km3_s2": "km³/s²",
    "J_kg": "J/kg",
    "MJ_kg": "MJ/kg",
    "km2_s2": "km²/s²",
    "m2_s": "m²/s",
    "km2_s": "km²/s",
}


def schema_of(model: type[BaseModel], what: str) -> dict[str, Any]:
    """JSON Schema of a file whose tables are those of a model. what : kind of file, e.g. "scene"."""
    made = model.model_json_schema()
    models = {found.__name__: found for found in models_in(model)}
    for name, part in ((model.__name__, made), *made.get("$defs", {}).items()):
        if name not in models:
            continue
        part |= {"title": _title(name), "description": table_description(models[name])}
        for key, value in part.get("properties", {}).items():
            value["title"] = key.replace("_", " ")
            if said := description_of(models[name], key):
                word = f'"{value["const"]}": ' if "const" in value else ""  # editors show those of all kinds together
                value["description"] = word + said
        _spell_out(part)
    head = {"$schema": DIALECT, "$id": f"urn:sailviz:{__version__}:{what}", "title": f"sailviz {what} file"}
    without_null: dict[str, Any] = _without_null({key: value for key, value in made.items() if key != "title"})
    return head | without_null


def _title(name: str) -> str:
    """Of a model in words: Solar sail."""
    return re.sub(r"(?<=[a-z0-9])(?=[A-Z])", " ", name).capitalize()


def models_in(model: type[BaseModel]) -> Iterator[type[BaseModel]]:
    """A model and all that stand inside it, each once."""
    found, waiting = {model}, [model]
    while waiting:
        here = waiting.pop()
        yield here
        for info in here.model_fields.values():
            _, inner = dimension_and_models(info.annotation, info.metadata)
            waiting += [one for one in dict.fromkeys(inner) if one not in found]
            found |= set(inner)


def partial(schema: dict[str, Any]) -> dict[str, Any]:
    """A schema of some of the keys of a file, as they are put over those of another: none is required, a table may be
    of any of its kinds, and a table in a list may go by its number."""
    loose: dict[str, Any] = _loosened(schema)
    return loose


def _loosened(part: Any) -> Any:
    if isinstance(part, list):
        return [_loosened(item) for item in part]
    if not isinstance(part, dict):
        return part
    made = {
        "anyOf" if key == "oneOf" else key: _loosened(value)
        for key, value in part.items()
        if key not in ("required", "default", "discriminator", "minItems", "if", "then")
        and not (key == "oneOf" and "type" in part)  # which of its spellings a quantity must have
    }
    items = part.get("items")
    if isinstance(items, dict) and ("$ref" in items or "oneOf" in items):
        numbered = {"type": "object", "patternProperties": {"^[0-9]+$": made["items"]}, "additionalProperties": False}
        words = {key: made.pop(key) for key in ("title", "description") if key in made}
        return words | {"anyOf": [made, numbered]}
    return made


def _dimension_of(schema: dict[str, Any]) -> str | None:
    if "x-dimension" in schema:
        return str(schema["x-dimension"])
    options = schema.get("anyOf", [])
    return next((found for option in options if (found := _dimension_of(option))), None)


def _without_null(part: Any) -> Any:
    """Without what TOML cannot say."""
    if isinstance(part, list):
        return [_without_null(item) for item in part]
    if not isinstance(part, dict):
        return part
    made = {key: _without_null(value) for key, value in part.items() if not (key == "default" and value is None)}
    if isinstance(options := made.get("anyOf"), list):
        left = [option for option in options if option != {"type": "null"}]
        if len(left) == 1 and isinstance(left[0], dict):
            del made["anyOf"]
            return left[0] | made
        made["anyOf"] = left
    return made


def _in_unit(value: Any, factor: float) -> Any:
    """A number in SI, or numbers in lists, in another unit; with 15 digits, so that half a turn is 180 degrees."""
    if isinstance(value, list):
        return [_in_unit(item, factor) for item in value]
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        return value
    return float(f"{value / factor:.15g}")


def _of_unit(schema: Any, factor: float) -> Any:
    """What a quantity may be in a unit, its words left out."""
    if isinstance(schema, list):
        return [_of_unit(item, factor) for item in schema if not _words(item)]
    if not isinstance(schema, dict):
        return schema
    made = {}
    for key, value in schema.items():
        if key in BOUNDS or (key == "default" and not isinstance(value, str)):
            made[key] = _in_unit(value, factor)
        elif key not in ("x-dimension", "default"):
            made[key] = _of_unit(value, factor)
    return made


def _words(option: Any) -> list[str]:
    """What may stand in place of a number."""
    if not isinstance(option, dict):
        return []
    return [option["const"]] if "const" in option else list(option.get("enum", []))


def _spell_out(schema: dict[str, Any]) -> None:
    """Puts a key for each of its units in the place of every quantity."""
    properties = schema.get("properties", {})
    required = schema.get("required", [])
    groups = []
    for name in list(properties):
        dimension = _dimension_of(properties[name])
        if not dimension:
            continue
        quantity = properties.pop(name)
        said = quantity.get("description", "")
        title = quantity["title"]
        keys = spelled(name, dimension)
        for key, (unit, factor) in zip(keys, UNITS[dimension].items(), strict=True):
            properties[key] = _of_unit(quantity, factor) | {"title": f"{title} in {unit}"}
            if said:
                properties[key]["description"] = (
                    f"{said} In {IN_WORDS.get(f'{dimension} {unit}', IN_WORDS.get(unit, unit))}."
                )
        words = [word for option in quantity.get("anyOf", []) for word in _words(option)]
        if words:
            properties[name] = {"title": title, "enum": words}
            if isinstance(quantity.get("default"), str):
                properties[name]["default"] = quantity["default"]
            if said:
                properties[name]["description"] = f"{said} As a word here; a number has its unit in the key."
            keys = [*keys, name]
        if name in required:
            required.remove(name)
            groups.append(keys)
    if groups:
        schema |= _one_of_each(groups)


def _one_of_each(groups: list[list[str]]) -> dict[str, Any]:
    """That exactly one key of every group is there; without allOf, since Taplo completes no keys of a table that has
    one."""
    first, *others = groups
    one = {"oneOf": [{"required": [key]} for key in first]}
    return one | {"if": True, "then": _one_of_each(others)} if others else one
