"""From the keys that a person writes, unit in each, to fields in SI."""

from __future__ import annotations

import types
from dataclasses import dataclass
from typing import Annotated, Any, Literal, Union, get_args, get_origin

from pydantic import BaseModel

from sailviz.errors import Fault
from sailviz.units import UNITS, spelled
from sailviz.words import nearest


@dataclass(frozen=True)
class Dimension:
    """Marks a field as a physical quantity: its key in the file ends in a unit of this dimension."""

    name: str

    def __get_pydantic_json_schema__(self, core_schema, handler):
        found = handler(core_schema)
        found["x-dimension"] = self.name
        return found


@dataclass(frozen=True)
class _Written:
    """How a field stands in the file."""

    path: str
    factor: float = 1.0
    unit: str = ""


class Places(dict):
    """Field path -> _Written; `get` yields the path as written. `passed_over`: names of the union members that a
    table without a kind does not resemble."""

    def __init__(self):
        self.passed_over: set[str] = set()

    def get(self, path, default=None):
        found = super().get(path)
        return found.path if found else default


def _inside(annotation, metadata=()) -> tuple[str | None, list[type[BaseModel]]]:
    """Dimension and section models that an annotation holds, however deeply."""
    dimension = next((m.name for m in metadata if isinstance(m, Dimension)), None)
    models = []
    origin = get_origin(annotation)
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        models.append(annotation)
    elif origin is Annotated:
        first, *rest = get_args(annotation)
        inner, found = _inside(first, rest)
        dimension, models = dimension or inner, models + found
    elif origin in (Union, types.UnionType, list):
        for part in get_args(annotation):
            inner, found = _inside(part)
            dimension, models = dimension or inner, models + found
    return dimension, models


def _kinds(model: type[BaseModel]) -> tuple[str, ...]:
    field = model.model_fields.get("kind")
    return get_args(field.annotation) if field and get_origin(field.annotation) is Literal else ()


def _is_number(value) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool)


def _to_si(value, factor):
    """value * factor through lists; what is not a number stays as it is, for pydantic to complain about."""
    if isinstance(value, list):
        return [_to_si(item, factor) for item in value]
    try:
        return value * factor if _is_number(value) else value
    except OverflowError:
        return value


def convert(model: type[BaseModel], raw: Any) -> tuple[Any, list[Fault], Places]:
    """(fields in SI for pydantic, faults of the keys, where each field stands in the file)."""
    faults: list[Fault] = []
    places = Places()
    return _section(model, raw, "", "", faults, places), faults, places


def _section(model, raw, field_path, path, faults, places):
    if not isinstance(raw, dict):
        return raw
    out = {}
    fields = model.model_fields
    allowed = {}  # key as written -> (field, unit)
    for name, field in fields.items():
        dimension, _ = _inside(field.annotation, field.metadata)
        if dimension:
            for unit, key in zip(UNITS[dimension], spelled(name, dimension), strict=True):
                allowed[key] = (name, dimension, unit)
        else:
            allowed[name] = (name, None, "")
    for key, value in raw.items():
        here = f"{path}.{key}" if path else str(key)
        if key in fields and key not in allowed:  # a quantity without its unit
            dimension, _ = _inside(fields[key].annotation, fields[key].metadata)
            if not isinstance(value, str):
                words = ", ".join(spelled(key, dimension))
                faults.append(Fault(here, "needs its unit in the key.", f"Write one of {words}."))
            field_here = f"{field_path}.{key}" if field_path else key
            places[field_here] = _Written(here)
            out.setdefault(key, value)
            continue
        if key not in allowed:
            faults.append(Fault(here, "unknown key.", _hint(key, allowed)))
            continue
        name, dimension, unit = allowed[key]
        field_here = f"{field_path}.{name}" if field_path else name
        if dimension:
            if name in out:
                faults.append(Fault(here, f"says {name} a second time, in another unit."))
            factor = UNITS[dimension][unit]
            out[name] = _to_si(value, factor)
            places[field_here] = _Written(here, factor, unit)
            continue
        places[field_here] = _Written(here)
        _, models = _inside(fields[key].annotation, fields[key].metadata)
        out[name] = _value(models, value, field_here, here, faults, places)
    return out


def _value(models, value, field_here, here, faults, places):
    """A value that may be a section, or a list of sections, or plain."""
    if not models:
        return value
    if isinstance(value, list):
        return [
            _value(models, item, f"{field_here}[{i}]", f"{here}[{i}]", faults, places) for i, item in enumerate(value)
        ]
    if not isinstance(value, dict):
        return value
    kinds = {kind: model for model in models for kind in _kinds(model)}
    if not kinds:
        chosen = max(models, key=lambda m: len(set(m.model_fields) & set(value)))
        places.passed_over |= {m.__name__ for m in models if m is not chosen}
        return _section(chosen, value, field_here, here, faults, places)
    kind = value.get("kind")
    if isinstance(kind, str) and kind in kinds:
        return _section(kinds[kind], value, field_here, here, faults, places)
    if "kind" not in value:
        faults.append(Fault(f"{here}.kind", "is missing.", f"Allowed: {', '.join(kinds)}."))
    else:
        faults.append(Fault(f"{here}.kind", f"{_shown(kind)} is not a kind of {here}.", nearest(str(kind), kinds)))
    places[field_here] = _Written(here)
    return value


def _hint(key, allowed) -> str:
    """The nearest allowed key, preferring the same quantity in a known unit."""
    stem = str(key)
    same = [word for word, (name, dimension, _) in allowed.items() if dimension and stem.startswith(name)]
    if same:
        return nearest(stem, same) if len(same) > 8 else f"Allowed units: {', '.join(same)}."
    return nearest(stem, allowed)


def _shown(value) -> str:
    try:
        text = repr(value) if not isinstance(value, str) else f'"{value}"'
    except ValueError:  # Python writes no number of more than 4300 digits
        return "a number of thousands of digits"
    return text if len(text) <= 60 else text[:57] + "..."
