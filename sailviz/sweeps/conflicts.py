"""What does not go together in a sweep, and what is wrong with single values of its keys, before anything flies."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from sailviz.errors import Fault, SceneError
from sailviz.scene.draws import Draw
from sailviz.scene.loading import Scene
from sailviz.scene.overrides import same_quantity
from sailviz.sweeps.distributions import Axis

PROBED = 300  # listed values of a key that are tried before the first flight


def disagreements(
    items: Sequence[Axis | Draw],
    draws: object,
    seed: object,
    together: bool,
    place: Mapping[str, str],
    any_before: bool,
) -> list[Fault]:
    """Faults of keys, draws and seed beside each other. place : key -> where it is written; any_before : whether
    faults were found already, of which some of these might only be the consequence."""
    found = []
    if not items and not any_before:
        found.append(Fault("vary", "nothing varies: name a key and its values."))
    found += _draws_faults(draws, any(isinstance(item, Draw) for item in items), any_before)
    found += _twice(items, place)
    counted = [item for item in items if isinstance(item, Axis)]
    if together and len({len(item.values) for item in counted}) > 1:
        counts = ", ".join(f"{item.key} has {len(item.values)}" for item in counted)
        found.append(Fault("together", f"keys that step together need as many values each: {counts}."))
    if seed is not None and not _whole(seed, 0):
        found.append(Fault("seed", f"is a whole number, 0 or more, not {seed!r}."))
    return found


def _whole(number: object, least: int) -> bool:
    return isinstance(number, (int, np.integer)) and not isinstance(number, bool) and int(number) >= least


def _draws_faults(draws: object, any_drawn: bool, any_before: bool) -> list[Fault]:
    if draws is not None and not _whole(draws, 1):
        return [Fault("draws", f"is a whole number, 1 or more, not {draws!r}.")]
    if any_drawn and draws is None:
        return [Fault("draws", "is missing: how many flights are drawn from a distribution?")]
    if draws is not None and not any_drawn and not any_before:
        return [Fault("draws", "nothing is drawn: no key has a distribution.")]
    return []


def _twice(items: Sequence[Axis | Draw], place: Mapping[str, str]) -> list[Fault]:
    """Keys that say a quantity which an earlier one says."""
    found = []
    for i, item in enumerate(items):
        table, _, last = item.key.rpartition(".")
        before = {other.key.rpartition(".")[2] for other in items[:i] if other.key.rpartition(".")[0] == table}
        if last in before or same_quantity(last, before):
            found.append(Fault(place[item.key], f"{item.key}: this quantity varies already."))
    return found


def value_faults(scene: Scene, items: Sequence[Axis | Draw], place: Mapping[str, str]) -> list[Fault]:
    """What is wrong with the keys and with single values of theirs; what only a flight can find out is left to it."""
    first = {item.key: item.values[0] if isinstance(item, Axis) else item.centre() for item in items}

    def about(fault: Fault) -> str | None:
        path = re.sub(r"\[(\d+)\]", r".\1", fault.where)
        return next((key for key in first if path == key or path.startswith(key + ".")), None)

    found = []
    for fault in _faults(scene, first):
        key = about(fault)
        where = fault.where if key is None else place[key]
        words = fault.what if where in (fault.where, key) else f"{fault.where}: {fault.what}"
        found.append(Fault(where, words, fault.hint))
    for item in items if not found else ():
        for value in item.values[1:PROBED] if isinstance(item, Axis) else ():
            mine = [fault for fault in _faults(scene, first | {item.key: value}) if about(fault) == item.key]
            # a value that is fine by itself is at fault only in the company of the other keys' first values
            if mine and _faults(scene, {item.key: value}):
                words = "" if place[item.key] == item.key else f"{item.key}: "
                found.append(Fault(place[item.key], words + mine[0].what, mine[0].hint))
                break
    return found


def _faults(scene: Scene, values: dict[str, Any]) -> list[Fault]:
    try:
        scene.with_values(values)
    except SceneError as error:
        return error.faults
    return []
