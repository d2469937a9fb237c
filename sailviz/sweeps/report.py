"""What a sweep measures of each flight, as a person asks for it: QUANTITY@MOMENT, such as radius_au@end."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Sequence

from pydantic_core import ValidationError

from sailviz.errors import Fault
from sailviz.scene.conflicts import conflicts
from sailviz.scene.loading import Scene
from sailviz.scene.sections import Expectation
from sailviz.units import UNITS

_TIME = re.compile(r"([0-9.]+(?:e[+-]?[0-9]+)?)(" + "|".join(UNITS["time"]) + ")")


def reported(text: str) -> Expectation:
    """`radius_au@end`, `time_d@arrival`, `closed_form_error:kepler@max` or `radius_au@120d` in the form in which a
    scene asks for it. pydantic's ValidationError where there is no such thing."""
    name, _, at = text.partition("@")
    quantity, _, form = name.partition(":")
    asked = {"quantity": quantity, "closed_form": form or None, "value": 0.0, "within": 1.0}
    if found := _TIME.fullmatch(at):
        return Expectation.model_validate(asked | {"at_time": float(found[1]) * UNITS["time"][found[2]]})
    return Expectation.model_validate(asked | {"at": at})


def column(item: Expectation) -> str:
    """Name of the column that holds an expected or reported quantity, in the form of --report."""
    name = f"{item.quantity}:{item.closed_form}" if item.closed_form else item.quantity
    return f"{name}@{item.at if item.at is not None else f'{item.at_time:.10g}s'}"


def numbered(names: Iterable[str]) -> Iterator[str]:
    """Names with " #2" and so on after those that came before."""
    seen: dict[str, int] = {}
    for name in names:
        seen[name] = seen.get(name, 0) + 1
        yield name if seen[name] == 1 else f"{name} #{seen[name]}"


def report_faults(scene: Scene, report: Sequence[str]) -> list[Fault]:
    """What is wrong with what is asked for, and what this scene cannot tell."""
    found: list[Fault] = []
    good: dict[int, Expectation] = {}
    for i, text in enumerate(report):
        if not isinstance(text, str) or not all(text.partition("@")):
            found.append(Fault(f"report[{i}]", f'"{text}" is not QUANTITY@MOMENT, e.g. radius_au@end.'))
            continue
        try:
            good[i] = reported(text)
        except ValidationError as error:
            found += [Fault(f"report[{i}]", fault["msg"]) for fault in error.errors()]
    asked = scene.model_copy(update={"expect": list(good.values())})
    for where, what in conflicts(asked):
        if part := re.match(r"expect\[(\d+)\]", where):
            found.append(Fault(f"report[{list(good)[int(part[1])]}]", what))
    return found
