"""The definition of a sweep: a scene, the keys that vary, and what to measure; checked whole before anything flies.

Written on a command line, as a TOML file or in Python. Every flight follows from the definition and its own number
alone.
"""

from __future__ import annotations

import hashlib
import json
import re
import tomllib
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import Field, model_validator
from pydantic_core import ValidationError

import sailviz
from sailviz.errors import Fault, SceneError
from sailviz.scene.conflicts import conflicts
from sailviz.scene.faults import faults_of, locate
from sailviz.scene.loading import Scene, find_scene, load_scene
from sailviz.scene.overrides import same_quantity
from sailviz.scene.sections import Expectation
from sailviz.scene.units_in_keys import convert
from sailviz.scene.values import Section, one_of
from sailviz.shipped import shipped_sweeps
from sailviz.sweeps.distributions import Axis, Draw, axis, drawn, flight_seed, varied
from sailviz.units import UNITS
from sailviz.words import nearest

PROBED = 300  # listed values of a key that are tried before the first flight
_TIME = re.compile(r"([0-9.]+(?:e[+-]?[0-9]+)?)(" + "|".join(UNITS["time"]) + ")")


# ---------------------------------------------------------------- the file
class SweepSection(Section):
    """Table [sweep]."""

    scene: Annotated[str, Field(min_length=1)]
    draws: Annotated[int, Field(ge=1)] | None = None
    seed: Annotated[int, Field(ge=0)] = 0
    together: bool = False
    report: list[str] = []
    record: list[str | int] = []


class VarySection(Section):
    """Table [[vary]]."""

    key: Annotated[str, Field(min_length=1)]
    values: Annotated[list[Any], Field(min_length=1)] | None = None
    range: Annotated[list[int | float], Field(min_length=3, max_length=3)] | None = None
    spacing: Literal["linear", "log"] = "linear"
    distribution: str | None = None

    @model_validator(mode="after")
    def _one(self):
        one_of(self, "values", "range", "distribution")
        return self


class SweepFile(Section):
    """A whole sweep file."""

    sweep: SweepSection
    set: dict[str, Any] = {}
    vary: Annotated[list[VarySection], Field(min_length=1)]


# ---------------------------------------------------------------- the definition
@dataclass(frozen=True)
class Definition:
    """A sweep that can be flown. Flight i belongs to cell i // repeats of the grid, and is draw i % repeats there."""

    raw: dict  # the scene with what was set, as tomllib would give it
    text: str
    source: str
    axes: tuple[Axis, ...]
    drawn: tuple[Draw, ...]
    together: bool  # the axes step together instead of making a grid
    draws: int | None
    seed: int
    report: tuple[str, ...]
    expected: tuple[str, ...]  # column of every [[expect]] of the scene
    version: str  # of the sailviz that flies it

    @property
    def repeats(self) -> int:
        return self.draws or 1

    @property
    def flights(self) -> int:
        """How many there are."""
        return self._cells * self.repeats

    @cached_property
    def _cells(self) -> int:
        lengths = [len(item.values) for item in self.axes]
        return (lengths[0] if lengths else 1) if self.together else int(np.prod(lengths, dtype=object))

    @property
    def keys(self) -> tuple[str, ...]:
        """Of the scene, those that vary."""
        return tuple(item.key for item in (*self.axes, *self.drawn))

    def values(self, flight: int) -> dict[str, Any]:
        """Key -> value of one flight. The last listed key varies fastest."""
        cell, draw = divmod(flight, self.repeats)
        found, rest = {}, cell
        for item in reversed(self.axes):
            if self.together:
                found[item.key] = item.values[cell]
            else:
                rest, place = divmod(rest, len(item.values))
                found[item.key] = item.values[place]
        found |= {item.key: item.value(self.seed, cell, draw) for item in self.drawn}
        return {key: found[key] for key in self.keys}

    def seed_of(self, flight: int) -> int:
        """The flight's own seed, what `seed` as a distribution gives."""
        return flight_seed(self.seed, *divmod(flight, self.repeats))

    def facts(self) -> dict:
        """Everything that decides what the flights are, ready for JSON."""
        facts = {
            "scene": self.source,
            "values": _flat(self.raw),
            "vary": {item.key: item.words() for item in (*self.axes, *self.drawn)},
            "together": self.together,
            "draws": self.draws,
            "seed": self.seed,
            "report": list(self.report),
            "sailviz": self.version,
        }
        return json.loads(json.dumps(facts, default=str))

    @cached_property
    def identity(self) -> str:
        """Hash of the facts, 16 hexadecimal digits."""
        return hashlib.sha256(json.dumps(self.facts(), sort_keys=True).encode()).hexdigest()[:16]

    def scene(self) -> Scene:
        """The scene that the flights vary."""
        made = load_scene(self.raw)
        made._text, made._source = self.text, self.source
        return made

    def reported(self) -> list[Expectation]:
        """What `report` asks for, in the form in which a scene asks for it."""
        return [_reported(item) for item in self.report]


def define(scene, vary=None, draws=None, seed=None, report=(), together=None, values=None) -> tuple[Definition, list]:
    """(definition, what the sweep file wants recorded) of a scene or a sweep file with what stands over it.

    scene : a Scene, a scene or sweep file, a shipped name, a dict. vary : {key: values or text as in sweep_laws.py}.
    values : put over the scene's own. SceneError lists every fault at once.
    """
    settings = dict(values or {})
    varied_by, faults, source, record, text = [], [], "sweep", [], ""
    if isinstance(scene, (str, Path)) and (path := _sweep_file(scene)) is not None:
        file, varied_by, faults, text = _read(path)
        source = str(scene)
        if file is None:
            raise SceneError(locate(faults, text), source)
        beside = path.parent / file.sweep.scene
        scene = str(beside) if beside.is_file() else file.sweep.scene
        settings = _flat(file.set) | settings
        draws = file.sweep.draws if draws is None else draws
        seed = file.sweep.seed if seed is None else seed
        together = file.sweep.together if together is None else together
        report, record = (*file.sweep.report, *report), file.sweep.record
    if not isinstance(scene, Scene):
        try:
            scene = load_scene(scene, settings)
        except SceneError as error:
            if not faults:
                raise
            raise SceneError([*locate(faults, text), *error.faults], source) from None
    elif settings:
        scene = scene.with_values(settings)
    new = {}
    for key, wanted in (vary or {}).items():
        try:
            new[key] = varied(key, wanted)
        except ValueError as error:
            faults.append(Fault(key, str(error)))
    place = {item.key: where for item, where in varied_by} | {key: key for key in new}
    items = [new.pop(item.key, item) for item, _ in varied_by] + list(new.values())
    report = tuple(dict.fromkeys(report))
    axes = tuple(item for item in items if isinstance(item, Axis))
    random = tuple(item for item in items if isinstance(item, Draw))
    faults += _disagreements(items, axes, random, draws, bool(together), place, faults)
    faults += [Fault("seed", f"is a whole number, 0 or more, not {seed!r}.")] * (
        seed is not None and (isinstance(seed, bool) or not isinstance(seed, (int, np.integer)) or seed < 0)
    )
    faults += _report_faults(scene, report)
    probed = _probe(scene, items, place) if items else []
    known = {fault.where for fault in faults}
    faults += [fault for fault in probed if fault.where not in known]
    if faults:
        raise SceneError(locate(faults, text), source)
    expected = tuple(column(item) for item in scene.expect)
    return (
        Definition(
            raw=scene._raw,
            text=scene.text,
            source=scene.source,
            axes=axes,
            drawn=random,
            together=bool(together),
            draws=None if draws is None else int(draws),
            seed=int(seed or 0),
            report=report,
            expected=tuple(_numbered(expected)),
            version=sailviz.__version__,
        ),
        list(record),
    )


def column(item: Expectation) -> str:
    """Name of the column that holds an expected or reported quantity, in the form of --report."""
    name = f"{item.quantity}:{item.closed_form}" if item.closed_form else item.quantity
    return f"{name}@{item.at if item.at is not None else f'{item.at_time:.10g}s'}"


def _numbered(names) -> Iterator[str]:
    seen: dict[str, int] = {}
    for name in names:
        seen[name] = seen.get(name, 0) + 1
        yield name if seen[name] == 1 else f"{name} #{seen[name]}"


# ---------------------------------------------------------------- reading a file
def _sweep_file(name) -> Path | None:
    """The file if it is a sweep and not a scene."""
    known = shipped_sweeps()
    path = known.get(str(name).removesuffix(".toml"))
    try:
        if Path(name).is_file():
            path = Path(name)
        elif path is None:
            path, _ = find_scene(name)
    except OSError:
        return None
    except SceneError:
        hint = nearest(str(name), known)
        if hint.startswith("Did"):
            raise SceneError(
                [Fault("file", "no such file, shipped scene or shipped sweep.", hint)], str(name)
            ) from None
        return None
    try:
        raw = tomllib.loads(path.read_text(encoding="utf-8-sig"))
    except (OSError, ValueError, RecursionError):
        return None  # load_scene says what is wrong with it
    return path if "sweep" in raw or "vary" in raw else None


def _read(path: Path) -> tuple[SweepFile | None, list, list[Fault], str]:
    """(file, [(axis or draw, its place)], faults, text)."""
    text = path.read_text(encoding="utf-8-sig")
    fields, converted = convert(SweepFile, tomllib.loads(text))
    faults = converted.faults
    try:
        file = SweepFile.model_validate(fields)
    except ValidationError as error:
        return None, [], faults + faults_of(error, converted, SweepFile), text
    items = []
    for i, section in enumerate(file.vary):
        where = f"vary[{i}]"
        try:
            if section.range is not None:
                item = axis(section.key, *section.range, section.spacing)
            elif section.distribution is not None:
                item = drawn(section.key, section.distribution)
            else:
                item = varied(section.key, section.values)
        except ValueError as error:
            given = next(name for name in ("range", "distribution", "values") if getattr(section, name) is not None)
            faults.append(Fault(f"{where}.{given}", str(error)))
            continue
        items.append((item, f"{where}.key"))
    return file, items, faults, text


def _flat(table: dict, above: str = "") -> dict:
    """Nested tables as dotted keys."""
    found = {}
    for key, value in table.items():
        if isinstance(value, dict):
            found |= _flat(value, f"{above}{key}.")
        else:
            found[above + key] = value
    return found


# ---------------------------------------------------------------- what does not go together
def _disagreements(items, axes, random, draws, together, place, earlier) -> list[Fault]:
    found = []
    if not items and not earlier:
        found.append(Fault("vary", "nothing varies: name a key and its values."))
    if draws is not None and (isinstance(draws, bool) or not isinstance(draws, (int, np.integer)) or draws < 1):
        found.append(Fault("draws", f"is a whole number, 1 or more, not {draws!r}."))
    elif random and draws is None:
        found.append(Fault("draws", "is missing: how many flights are drawn from a distribution?"))
    elif draws is not None and not random and not earlier:
        found.append(Fault("draws", "nothing is drawn: no key has a distribution."))
    for i, item in enumerate(items):
        table, _, last = item.key.rpartition(".")
        before = {other.key.rpartition(".")[2] for other in items[:i] if other.key.rpartition(".")[0] == table}
        if last in before or same_quantity(last, dict.fromkeys(before)):
            found.append(Fault(place[item.key], f"{item.key}: this quantity varies already."))
    if together and len({len(item.values) for item in axes}) > 1:
        counts = ", ".join(f"{item.key} has {len(item.values)}" for item in axes)
        found.append(Fault("together", f"keys that step together need as many values each: {counts}."))
    return found


def _reported(text: str) -> Expectation:
    """`radius_au@end`, `time_d@arrival`, `closed_form_error:kepler@max`, `radius_au@120d`."""
    name, _, at = text.partition("@")
    quantity, _, form = name.partition(":")
    moment = {"at": at}
    if found := _TIME.fullmatch(at):
        moment = {"at_time": float(found[1]) * UNITS["time"][found[2]]}
    return Expectation(quantity=quantity, closed_form=form or None, value=0.0, within=1.0, **moment)


def _report_faults(scene: Scene, report) -> list[Fault]:
    found, good = [], {}
    for i, text in enumerate(report):
        if not isinstance(text, str) or not all(text.partition("@")):
            found.append(Fault(f"report[{i}]", f'"{text}" is not QUANTITY@MOMENT, e.g. radius_au@end.'))
            continue
        try:
            good[i] = _reported(text)
        except ValidationError as error:
            found += [Fault(f"report[{i}]", fault["msg"]) for fault in error.errors()]
    asked = scene.model_copy(update={"expect": list(good.values())})
    for where, what in conflicts(asked):
        if part := re.match(r"expect\[(\d+)\]", where):
            found.append(Fault(f"report[{list(good)[int(part[1])]}]", what))
    return found


def _probe(scene: Scene, items, place) -> list[Fault]:
    """What is wrong with the keys and with single values of theirs; what only a flight can find out is left to it."""
    first = {item.key: item.values[0] if isinstance(item, Axis) else item.centre() for item in items}

    def faults(values) -> list[Fault]:
        try:
            scene.with_values(values)
        except SceneError as error:
            return error.faults
        return []

    def about(fault) -> str | None:
        path = re.sub(r"\[(\d+)\]", r".\1", fault.where)
        return next((key for key in first if path == key or path.startswith(key + ".")), None)

    found = []
    for fault in faults(first):
        key = about(fault)
        where = place.get(key, fault.where)
        words = fault.what if where in (fault.where, key) else f"{fault.where}: {fault.what}"
        found.append(Fault(where, words, fault.hint))
    for item in items if not found else ():
        for value in item.values[1:PROBED] if isinstance(item, Axis) else ():
            mine = [fault for fault in faults(first | {item.key: value}) if about(fault) == item.key]
            if mine and not _only_in_company(scene, item.key, value):
                words = "" if place[item.key] == item.key else f"{item.key}: "
                found.append(Fault(place[item.key], words + mine[0].what, mine[0].hint))
                break
    return found


def _only_in_company(scene: Scene, key: str, value) -> bool:
    """Whether a value is fine by itself, so that its fault comes from the values of other keys."""
    try:
        scene.with_values({key: value})
    except SceneError:
        return False
    return True
