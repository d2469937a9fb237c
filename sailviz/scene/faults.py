"""From what pydantic finds wrong with fields in SI to sentences that a person can act on, at places in the file."""

from __future__ import annotations

import re
from collections.abc import Collection
from dataclasses import replace

from pydantic import BaseModel
from pydantic_core import ErrorDetails, ValidationError

from sailviz.errors import Fault
from sailviz.scene.units_in_keys import Conversion, Written, dimension_and_models
from sailviz.units import spelled
from sailviz.words import nearest, shown

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


def _sentence(error: ErrorDetails, written: Written) -> str:
    kind, context, value = error["type"], error.get("ctx", {}), error["input"]
    if kind in _LIMITS:
        words, key = _LIMITS[kind]
        limit = context[key] / written.factor
        try:
            got = f"{value / written.factor:.6g}"
        except OverflowError:  # a whole number beyond the range of float
            got = shown(value)
        return f"must be {words} {limit:.6g}{' ' + written.unit if written.unit else ''}, is {got}."
    if kind in _TYPE_WORDS:
        return f"must be {_TYPE_WORDS[kind]}, is {shown(value)}."
    if kind == "literal_error":
        allowed = re.findall(r"'([^']*)'", context["expected"])
        return f"{shown(value)} is not allowed here. {nearest(str(value), allowed)}"
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


_FOUND_BEFORE = ("union_tag_invalid", "union_tag_not_found", "extra_forbidden")  # `convert` has said it, with a hint


def faults_of(errors: ValidationError, converted: Conversion, model: type[BaseModel]) -> list[Fault]:
    """Sentences for what pydantic found wrong with a model's fields in SI, at their places in the file."""
    quantities = _quantities(model)
    grouped: dict[str, list[str]] = {}
    for error in errors.errors(include_url=False):
        if error["type"] in _FOUND_BEFORE or converted.passed_over & set(error["loc"]):
            continue
        last = str(error["loc"][-1])
        if error["type"] == "literal_error" and last.startswith("literal[") and isinstance(error["input"], dict):
            continue  # a table where a word was also allowed: what is wrong with the table is said elsewhere
        if error["type"] == "string_type" and isinstance(error["input"], dict) and _else_wrong(errors, error):
            continue  # likewise
        path, written = _place(error, converted)
        if error["type"] == "missing":
            dimension = quantities.get(last)
            sentence = "is missing." + (f" Write {' or '.join(spelled(last, dimension))}." if dimension else "")
        else:
            sentence = _sentence(error, written)
        sentences = grouped.setdefault(path, [])
        if sentence not in sentences:
            sentences.append(sentence)
    return [
        Fault(path, " Or: ".join([s for s in sentences if not s.startswith("must be a table")] or sentences))
        for path, sentences in grouped.items()
    ]


def _else_wrong(errors: ValidationError, error: ErrorDetails) -> bool:
    """Whether something else than a word is wrong at the place of an error, or within it."""
    if error["loc"][-1] != "str":  # of a field that takes text alone
        return False
    place = error["loc"][:-1]
    others = [other["loc"] for other in errors.errors(include_url=False) if other["type"] != "literal_error"]
    return any(loc != error["loc"] and loc[: len(place)] == place for loc in others)


def _quantities(model: type[BaseModel], seen: dict[str, str] | None = None) -> dict[str, str]:
    """Field name -> dimension of every quantity in a model and its sections."""
    seen = {} if seen is None else seen
    for name, field in model.model_fields.items():
        dimension, models = dimension_and_models(field.annotation, field.metadata)
        if dimension:
            seen.setdefault(name, dimension)
        for inner in models:
            _quantities(inner, seen)
    return seen


def _place(error: ErrorDetails, converted: Conversion) -> tuple[str, Written]:
    """Path in the file of a pydantic error. Its location also names union members, which no file has: they are
    skipped by following only what the converted scene knows."""
    path = ""
    known = Written("")
    location = error["loc"]
    for i, part in enumerate(location):
        if isinstance(part, int):
            path += f"[{part}]"
            continue
        step = f"{path}.{part}" if path else str(part)
        if step in converted.places:
            path = step
            known = converted.places[step]
        elif error["type"] == "missing" and i == len(location) - 1:
            path = step
    written = converted.path(path)
    if written is None:  # a missing field, or an entry of a list: the nearest known parent, as written
        parent = re.sub(r"(\.[^.\[\]]+|\[\d+\])$", "", path)
        rest = path[len(parent) :]
        written = (converted.path(parent) or parent) + rest if parent != path else path
    return written.lstrip("."), known


def _parent(path: str) -> str:
    """The place that holds a place; always shorter, whatever characters a key is made of."""
    return path[: max(path.rfind("."), path.rfind("["), 0)]


def locate(faults: list[Fault], text: str, given: Collection[str] = ()) -> list[Fault]:
    """Faults without repetition, with line numbers where the text of the file tells them. given : places of values that
    were put over those of the file."""
    lines = _lines(text)
    found: list[Fault] = []
    paths: list[str] = []
    for fault in faults:
        if (
            any(fault.where == p or fault.where.startswith((p + ".", p + "[")) for p in paths)
            and "missing" in fault.what
        ):
            continue
        paths.append(fault.where)
        where = fault.where
        put = _put_over(where, given)
        if put:
            found += [] if (fault := replace(fault, given=put)) in found else [fault]
            continue
        line = lines.get(where)
        while line is None and where:
            where = _parent(where)
            line = lines.get(where) if where else None
        fault = replace(fault, line=line)
        if fault not in found:
            found.append(fault)
    return found


def _put_over(where: str, given: Collection[str]) -> str:
    """The value put over the file's that a place lies in, or that lies in the place; "" if there is none."""
    for key in given:
        if where == key or where.startswith((f"{key}.", f"{key}[")):
            return key
    return next((key for key in given if key.startswith((f"{where}.", f"{where}["))), "")


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
            table = _within(header[1], counts)
            found[table] = number
        elif key := re.match(r"\s*([\w.-]+)\s*=", line):
            found.setdefault(f"{table}.{key[1]}" if table else key[1], number)
    return found


def _within(header: str, counts: dict[str, int]) -> str:
    """The place of a table that a header names: [phase.steering] after a third [[phase]] is phase[2].steering."""
    first, dot, rest = header.partition(".")
    return f"{first}[{counts[first] - 1}]{dot}{rest}" if dot and first in counts else header
