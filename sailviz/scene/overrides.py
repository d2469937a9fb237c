"""Values put over those of a scene file by their dotted keys, as `--set` and a sweep do."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from typing import Any

from sailviz.errors import Fault, SceneError
from sailviz.units import UNITS


def overridden(raw: Mapping[str, Any], values: Mapping[str, Any], name: str) -> dict[str, Any]:
    """A deep copy of a scene's tables with dotted keys replaced. name : of the scene, for messages. SceneError for a
    key that no place can have."""
    result: dict[str, Any] = _copy(raw)
    for key, value in values.items():
        *path, last = key.split(".")
        table: Any = result
        for part in path:
            table = _inner(table, part)
        if isinstance(table, list) and _numbered(table, last):
            table[int(last)] = _copy(value)
            continue
        if not isinstance(table, dict):
            raise SceneError([Fault(key, "no such place in the scene", given=key)], name)
        for sibling in same_quantity(last, table):
            del table[sibling]
        table[last] = _copy(value)
    return result


def place_of(key: str) -> str:
    """A dotted key as places in a file are told: expect.1.value is expect[1].value."""
    return re.sub(r"\.(\d+)(?=\.|$)", r"[\1]", key)


def _inner(table: Any, part: str) -> Any:
    """The table or list under a name or a number, made if it is not there; None where there can be none."""
    if isinstance(table, list):
        return table[int(part)] if _numbered(table, part) else None
    if not isinstance(table, dict):
        return None
    if not isinstance(table.get(part), (dict, list)):
        twin = next((name for name in same_quantity(part, table) if isinstance(table[name], list)), None)
        table[part] = {} if twin is None else _scaled(table.pop(twin), _factor(twin, part))
    return table[part]


def _factor(one: str, other: str) -> float:
    """What a quantity in the unit of a key is multiplied by, to be in that of another key of the same quantity."""
    found = 1.0
    for units in UNITS.values():
        ends = [
            max((unit for unit in units if unit and key.endswith(f"_{unit}")), key=len, default="")
            for key in (one, other)
        ]
        if all(ends) and one.removesuffix(f"_{ends[0]}") == other.removesuffix(f"_{ends[1]}"):
            found = units[ends[0]] / units[ends[1]]
    return found


def _scaled(value: Any, factor: float) -> Any:
    """Numbers in lists, in another unit."""
    if isinstance(value, list):
        return [_scaled(item, factor) for item in value]
    return value * factor if isinstance(value, (int, float)) and not isinstance(value, bool) else value


def _numbered(items: list[Any], part: str) -> bool:
    """Whether a part of a key is the number of an item, 0 the first."""
    return part.isdecimal() and len(part) < 9 and int(part) < len(items)


def _copy(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _copy(item) for key, item in value.items()}
    return [_copy(item) for item in value] if isinstance(value, list) else value


def same_quantity(key: str, table: Iterable[str]) -> list[str]:
    """Keys of a table that say the same quantity in another unit."""
    for units in UNITS.values():
        for unit in units:
            if unit and key.endswith(f"_{unit}"):
                stem = key.removesuffix(f"_{unit}")
                twins = {stem, *(f"{stem}_{other}" for other in units)}
                found = [name for name in table if name in twins and name != key]
                if found:
                    return found
    return []
