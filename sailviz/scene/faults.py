"""From the keys a person writes to SI fields, and from what pydantic finds wrong to sentences that person can act
on."""

from __future__ import annotations

import re
import types
from dataclasses import dataclass, replace
from difflib import get_close_matches
from typing import Annotated, Any, Literal, Union, get_args, get_origin

from pydantic import BaseModel
from pydantic_core import ValidationError

from sailviz.errors import Fault
from sailviz.units import UNITS, spelled


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


def nearest(word: str, words) -> str:
    """ "Did you mean ...?" or the list of what is allowed."""
    words = list(words)
    low = {w.lower(): w for w in words}
    close = get_close_matches(str(word).lower(), low, n=1, cutoff=0.6)
    if close:
        return f'Did you mean "{low[close[0]]}"?'
    return f"Allowed: {', '.join(words)}." if len(words) <= 24 else ""


# ---------------------------------------------------------------- keys with units -> fields in SI
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


# ---------------------------------------------------------------- what pydantic found -> sentences
def _shown(value) -> str:
    try:
        text = repr(value) if not isinstance(value, str) else f'"{value}"'
    except ValueError:  # Python writes no number of more than 4300 digits
        return "a number of thousands of digits"
    return text if len(text) <= 60 else text[:57] + "..."


_TYPE_WORDS = {
    "float_type": "a number",
    "int_type": "a whole number",
    "int_from_float": "a whole number",
    "string_type": "text",
    "bool_type": "true or false",
    "list_type": "a list",
    "model_type": "a table",
    "model_attributes_type": "a table",
    "dict_type": "a table",
    "datetime_type": "a date",
    "date_type": "a date",
}
_LIMITS = {
    "greater_than": ("greater than", "gt"),
    "greater_than_equal": ("at least", "ge"),
    "less_than": ("less than", "lt"),
    "less_than_equal": ("at most", "le"),
}


def _sentence(error, written: _Written) -> str:
    kind, context, value = error["type"], error.get("ctx", {}), error["input"]
    if kind in _LIMITS:
        words, key = _LIMITS[kind]
        limit = context[key] / written.factor
        try:
            got = f"{value / written.factor:.6g}"
        except OverflowError:  # a whole number beyond the range of float
            got = _shown(value)
        return f"must be {words} {limit:.6g}{' ' + written.unit if written.unit else ''}, is {got}."
    if kind in _TYPE_WORDS:
        return f"must be {_TYPE_WORDS[kind]}, is {_shown(value)}."
    if kind == "literal_error":
        words = re.findall(r"'([^']*)'", context["expected"])
        return f"{_shown(value)} is not allowed here. {nearest(str(value), words)}"
    if kind == "finite_number":
        return "must be finite."
    if kind in ("too_short", "too_long"):
        least, most = context.get("min_length"), context.get("max_length")
        want = f"{least} or more" if kind == "too_short" else f"{most}"
        return f"has {context['actual_length']} entries, needs {want}."
    if kind == "string_too_short":
        return "must not be empty."
    message = error["msg"]
    return message[0].lower() + message[1:] + ("" if message.endswith((".", "?")) else ".")


def faults_of(errors, places: Places | None = None, model=None) -> list[Fault]:
    """Faults from a pydantic ValidationError, or from (place, sentence) pairs."""
    if not isinstance(errors, ValidationError):
        return [Fault(place, what) for place, what in errors]
    places = Places() if places is None else places
    quantities = _quantities(model) if model else {}
    grouped: dict[str, list[str]] = {}
    for error in errors.errors(include_url=False):
        if error["type"] in _FOUND_BEFORE or places.passed_over & set(error["loc"]):
            continue
        path, written = _place(error, places)
        among_others = str(error["loc"][-1]).startswith("literal[")
        if error["type"] == "literal_error" and among_others and isinstance(error["input"], dict):
            continue  # a table where a word was also allowed: what is wrong with the table is said elsewhere
        if error["type"] == "missing":
            dimension = quantities.get(error["loc"][-1])
            sentence = "is missing." + (
                f" Write {' or '.join(spelled(error['loc'][-1], dimension))}." if dimension else ""
            )
        else:
            sentence = _sentence(error, written)
        sentences = grouped.setdefault(path, [])
        if sentence not in sentences:
            sentences.append(sentence)
    return [
        Fault(path, " Or: ".join([s for s in sentences if not s.startswith("must be a table")] or sentences))
        for path, sentences in grouped.items()
    ]


_FOUND_BEFORE = ("union_tag_invalid", "union_tag_not_found", "extra_forbidden")  # `convert` has said it, with a hint


def _quantities(model, seen=None) -> dict[str, str]:
    """Field name -> dimension of every quantity in a model and its sections."""
    seen = {} if seen is None else seen
    for name, field in model.model_fields.items():
        dimension, models = _inside(field.annotation, field.metadata)
        if dimension:
            seen.setdefault(name, dimension)
        for inner in models:
            _quantities(inner, seen)
    return seen


def _place(error, places: Places) -> tuple[str, _Written]:
    """Path in the file of a pydantic error. Its location also names union members, which no file has: they are
    skipped by following only what the converted scene knows."""
    path = ""
    known = _Written("")
    location = error["loc"]
    for i, part in enumerate(location):
        if isinstance(part, int):
            path += f"[{part}]"
            continue
        step = f"{path}.{part}" if path else str(part)
        if dict.__contains__(places, step):
            path = step
            known = dict.__getitem__(places, step)
        elif error["type"] == "missing" and i == len(location) - 1:
            path = step
    written = places.get(path)
    if written is None:  # a missing field, or an entry of a list: the nearest known parent, as written
        parent = re.sub(r"(\.[^.\[\]]+|\[\d+\])$", "", path)
        rest = path[len(parent) :]
        written = (places.get(parent, parent) or "") + rest if parent != path else path
    return written.lstrip("."), known


def _parent(path: str) -> str:
    """The place that holds a place; always shorter, whatever characters a key is made of."""
    return path[: max(path.rfind("."), path.rfind("["), 0)]


def locate(faults: list[Fault], text: str) -> list[Fault]:
    """Faults without repetition, with line numbers where the text of the file tells them."""
    lines = _lines(text)
    found, paths = [], []
    for fault in faults:
        if (
            any(fault.where == p or fault.where.startswith((p + ".", p + "[")) for p in paths)
            and "missing" in fault.what
        ):
            continue
        paths.append(fault.where)
        where = fault.where
        line = lines.get(where)
        while line is None and where:
            where = _parent(where)
            line = lines.get(where) if where else None
        fault = replace(fault, line=line)
        if fault not in found:
            found.append(fault)
    return found


def _lines(text: str) -> dict[str, int]:
    """Dotted path -> line number of every table header and key that stands on a line of its own."""
    found: dict[str, int] = {}
    counts: dict[str, int] = {}
    table = ""
    for number, line in enumerate(text.splitlines(), start=1):
        if many := re.match(r"\s*\[\[\s*([\w.-]+)\s*\]\]", line):
            index = counts.get(many[1], 0)
            counts[many[1]] = index + 1
            table = f"{many[1]}[{index}]"
            found[table] = number
        elif header := re.match(r"\s*\[\s*([\w.-]+)\s*\]", line):
            table = header[1]
            found[table] = number
        elif key := re.match(r"\s*([\w.-]+)\s*=", line):
            found.setdefault(f"{table}.{key[1]}" if table else key[1], number)
    return found


# ---------------------------------------------------------------- JSON Schema
def with_units(schema: dict) -> dict:
    """A JSON Schema in which every quantity is spelled out in each of its units."""
    for part in (schema, *schema.get("$defs", {}).values()):
        _spell_out(part)
    return schema


def _dimension_of(schema) -> str | None:
    if "x-dimension" in schema:
        return schema["x-dimension"]
    options = schema.get("anyOf", [])
    return next((found for option in options if (found := _dimension_of(option))), None)


def _without_si(schema):
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


def _spell_out(schema: dict) -> None:
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
