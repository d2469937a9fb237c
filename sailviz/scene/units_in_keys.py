"""From the keys that a person writes, unit in each, to fields in SI."""

from __future__ import annotations

import types
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from functools import cache
from typing import Annotated, Any, Literal, Union, get_args, get_origin

from pydantic import BaseModel, GetJsonSchemaHandler
from pydantic.json_schema import JsonSchemaValue
from pydantic_core import CoreSchema

from sailviz.errors import Fault
from sailviz.units import UNITS, spelled
from sailviz.words import nearest, shown

Models = Sequence[type[BaseModel]]


@dataclass(frozen=True)
class Dimension:
    """Marks a field as a physical quantity: its key in the file ends in a unit of this dimension."""

    name: str

    def __get_pydantic_json_schema__(self, core_schema: CoreSchema, handler: GetJsonSchemaHandler) -> JsonSchemaValue:
        found = handler(core_schema)
        found["x-dimension"] = self.name
        return found


@dataclass(frozen=True)
class Written:
    """How a field stands in the file."""

    path: str
    factor: float = 1.0
    unit: str = ""


@dataclass
class Conversion:
    """What came of the keys of a scene file."""

    faults: list[Fault] = field(default_factory=list)
    places: dict[str, Written] = field(default_factory=dict)  # by the path of the field
    passed_over: set[str] = field(default_factory=set)  # union members that a table without a kind does not resemble

    def path(self, field_path: str) -> str | None:
        """Where a field stands in the file, None if it does not."""
        found = self.places.get(field_path)
        return found.path if found else None


def dimension_and_models(annotation: object, metadata: Iterable[object] = ()) -> tuple[str | None, Models]:
    """Dimension and section models that an annotation holds, however deeply."""
    dimension = next((m.name for m in metadata if isinstance(m, Dimension)), None)
    models: list[type[BaseModel]] = []
    origin = get_origin(annotation)
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        models.append(annotation)
    elif origin is Annotated:
        first, *rest = get_args(annotation)
        inner, found = dimension_and_models(first, rest)
        dimension, models = dimension or inner, [*models, *found]
    elif origin in (Union, types.UnionType, list):
        for part in get_args(annotation):
            inner, found = dimension_and_models(part)
            dimension, models = dimension or inner, [*models, *found]
    return dimension, models


@cache
def _held(model: type[BaseModel], name: str) -> tuple[str | None, Models]:
    """`dimension_and_models` of a field."""
    info = model.model_fields[name]
    return dimension_and_models(info.annotation, info.metadata)


@cache
def words_of_kind(model: type[BaseModel]) -> tuple[str, ...]:
    """What may stand as the `kind` of a section, e.g. ("circular",)."""
    kind = model.model_fields.get("kind")
    return get_args(kind.annotation) if kind and get_origin(kind.annotation) is Literal else ()


def convert(model: type[BaseModel], raw: object) -> tuple[object, Conversion]:
    """(fields in SI for pydantic, what was found on the way: faults of the keys, where each field stands)."""
    found = Conversion()
    return _section(model, raw, "", "", found), found


def _to_si(value: object, factor: float) -> object:
    """value * factor through lists; what is not a number stays as it is, for pydantic to complain about."""
    if isinstance(value, list):
        return [_to_si(item, factor) for item in value]
    if not isinstance(value, (int, float)) or isinstance(value, bool):
        return value
    try:
        return value * factor
    except OverflowError:
        return value


@dataclass(frozen=True)
class _Spelling:
    """A key that a section allows."""

    name: str  # of the field
    dimension: str | None
    unit: str


@cache
def _spellings(model: type[BaseModel]) -> dict[str, _Spelling]:
    """Every key that a section allows."""
    allowed = {}
    for name in model.model_fields:
        dimension, _ = _held(model, name)
        if dimension:
            for unit, key in zip(UNITS[dimension], spelled(name, dimension), strict=True):
                allowed[key] = _Spelling(name, dimension, unit)
        else:
            allowed[name] = _Spelling(name, None, "")
    return allowed


def _section(model: type[BaseModel], raw: object, field_path: str, path: str, found: Conversion) -> object:
    if not isinstance(raw, dict):
        return raw
    out: dict[str, object] = {}
    allowed = _spellings(model)
    for key, value in raw.items():
        here = f"{path}.{key}" if path else str(key)
        spelling = allowed.get(key)
        if spelling is not None:
            field_here = f"{field_path}.{spelling.name}" if field_path else spelling.name
            out[spelling.name] = _field(model, spelling, value, spelling.name in out, field_here, here, found)
        elif key in model.model_fields:
            found.places[f"{field_path}.{key}" if field_path else key] = Written(here)
            out.setdefault(key, _without_unit(model, key, value, here, found))
        else:
            why = _why_not(model, str(key))
            found.faults.append(Fault(here, why) if why else Fault(here, "unknown key.", _hint(key, allowed)))
    return out


def _why_not(model: type[BaseModel], key: str) -> str:
    """Why a section does not take a quantity that is known elsewhere; "" where it does not say."""
    against: dict[str, str] = getattr(model, "why_not", {})
    return next((f"{words}." for stem, words in against.items() if key == stem or key.startswith(f"{stem}_")), "")


def _without_unit(model: type[BaseModel], key: str, value: object, here: str, found: Conversion) -> object:
    """A quantity whose key has no unit, which is right for a word in its place only."""
    dimension, _ = _held(model, key)
    if dimension and not isinstance(value, str):
        words = ", ".join(spelled(key, dimension))
        found.faults.append(Fault(here, "needs its unit in the key.", f"Write one of {words}."))
    return value


def _field(
    model: type[BaseModel],
    spelling: _Spelling,
    value: object,
    again: bool,
    field_here: str,
    here: str,
    found: Conversion,
) -> object:
    """The value of a field in SI. again : the table has said it before."""
    if not spelling.dimension:
        found.places[field_here] = Written(here)
        _, models = _held(model, spelling.name)
        return _value(models, value, field_here, here, found)
    if again:
        found.faults.append(Fault(here, f"says {spelling.name} a second time, in another unit."))
    factor = UNITS[spelling.dimension][spelling.unit]
    found.places[field_here] = Written(here, factor, spelling.unit)
    return _to_si(value, factor)


def _value(models: Models, value: object, field_here: str, here: str, found: Conversion) -> object:
    """A value that may be a section, or a list of sections, or plain."""
    if not models:
        return value
    if isinstance(value, list):
        return [_value(models, item, f"{field_here}[{i}]", f"{here}[{i}]", found) for i, item in enumerate(value)]
    if not isinstance(value, dict):
        return value
    kinds = {kind: model for model in models for kind in words_of_kind(model)}
    if not kinds:
        chosen = max(models, key=lambda model: len(set(model.model_fields) & set(value)))
        found.passed_over |= {model.__name__ for model in models if model is not chosen}
        return _section(chosen, value, field_here, here, found)
    kind: Any = value.get("kind")
    if isinstance(kind, str) and kind in kinds:
        return _section(kinds[kind], value, field_here, here, found)
    if "kind" not in value:
        found.faults.append(Fault(f"{here}.kind", "is missing.", f"Allowed: {', '.join(kinds)}."))
    else:
        what = f"{shown(kind)} is not a kind of {here}."
        found.faults.append(Fault(f"{here}.kind", what, nearest(str(kind), kinds)))
    found.places[field_here] = Written(here)
    return value


def _hint(key: object, allowed: dict[str, _Spelling]) -> str:
    """The nearest allowed key, preferring the same quantity in a known unit."""
    stem = str(key)
    same = [word for word, spelling in allowed.items() if spelling.dimension and stem.startswith(spelling.name)]
    if same:
        return nearest(stem, same) if len(same) > 8 else f"Allowed units: {', '.join(same)}."
    return nearest(stem, allowed)
