"""The definition of a sweep: a scene, the keys that vary, and what to measure; checked whole before anything flies.

Written on a command line, as a TOML file or in Python. Every flight follows from the definition and its own number
alone.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from math import prod
from typing import Any

import numpy as np

import sailviz
from sailviz.errors import Fault, SceneError
from sailviz.scene.draws import Draw
from sailviz.scene.faults import locate
from sailviz.scene.loading import Scene, SceneSource, build_scene, load_scene
from sailviz.scene.sections import Expectation
from sailviz.sweeps.conflicts import disagreements, value_faults
from sailviz.sweeps.distributions import Axis, too_many, varied
from sailviz.sweeps.report import column, numbered, report_faults, reported
from sailviz.uncertainty.draws import flight_seed, value_of


@dataclass(frozen=True)
class Definition:
    """A sweep that can be flown. Flight i belongs to cell i // repeats of the grid, and is draw i % repeats there."""

    raw: dict[str, Any]  # the scene with what was set, as tomllib would give it
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
        """Flights per cell of the grid."""
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
    def items(self) -> tuple[Axis | Draw, ...]:
        """What varies, listed values first."""
        return (*self.axes, *self.drawn)

    @property
    def keys(self) -> tuple[str, ...]:
        """Of the scene, those that vary."""
        return tuple(item.key for item in self.items)

    def values(self, flight: int) -> dict[str, Any]:
        """Key -> value of one flight. The last listed key varies fastest."""
        cell, draw = divmod(flight, self.repeats)
        found: dict[str, Any] = {}
        rest = cell
        for item in reversed(self.axes):
            if self.together:
                found[item.key] = item.values[cell]
            else:
                rest, place = divmod(rest, len(item.values))
                found[item.key] = item.values[place]
        found |= {item.key: value_of(item, self.seed, cell, draw) for item in self.drawn}
        return {key: found[key] for key in self.keys}

    def seed_of(self, flight: int) -> int:
        """The flight's own seed, what `seed` as a distribution gives."""
        return flight_seed(self.seed, *divmod(flight, self.repeats))

    def facts(self) -> dict[str, Any]:
        """Everything that decides what the flights are, ready for JSON."""
        facts = {
            "scene": self.source,
            "values": {key: value for key, value in _flat(self.raw).items() if not key.startswith("limits.")},
            "vary": {item.key: item.words() for item in self.items},
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
        return build_scene(self.raw, {}, self.text, self.source)

    @cached_property
    def asked(self) -> dict[str, Expectation]:
        """Column -> what it holds, of all that is measured."""
        return dict(zip(self.expected, self.scene().expect, strict=True)) | dict(
            zip(self.report, self.reported(), strict=True)
        )

    def reported(self) -> list[Expectation]:
        """What `report` asks for, in the form in which a scene asks for it."""
        return [reported(item) for item in self.report]


def define(
    scene: SceneSource,
    vary: Mapping[str, Any] | None = None,
    draws: int | None = None,
    seed: int | None = None,
    report: Iterable[str] = (),
    together: bool | None = None,
    values: Mapping[str, Any] | None = None,
) -> tuple[Definition, list[str | int]]:
    """(definition, what the sweep file wants recorded) of a scene or a sweep file with what stands over it.

    scene : a Scene, a scene or sweep file, a shipped name, a dict. vary : {key: values or text as in distributions.py}.
    values : put over the scene's own. SceneError lists every fault at once.
    """
    asked = _with_file(_Asked(scene, dict(values or {}), draws, seed, tuple(report), together))
    made = _scene_of(asked)
    most = made.limits.flights
    items, place, faults = _with_arguments(asked, vary or {}, most)
    report = tuple(dict.fromkeys(asked.report))
    faults += disagreements(items, asked.draws, asked.seed, bool(asked.together), place, bool(faults))
    faults += report_faults(made, report)
    if not faults:
        faults += _too_many_flights(items, asked, most)
    known = {fault.where for fault in faults}
    faults += [fault for fault in (value_faults(made, items, place) if items else ()) if fault.where not in known]
    if faults:
        raise SceneError(locate(faults, asked.text), asked.source)
    definition = Definition(
        raw=made.raw,
        text=made.text,
        source=made.source,
        axes=tuple(item for item in items if isinstance(item, Axis)),
        drawn=tuple(item for item in items if isinstance(item, Draw)),
        together=bool(asked.together),
        draws=None if asked.draws is None else int(asked.draws),
        seed=int(asked.seed or 0),
        report=report,
        expected=tuple(numbered(column(item) for item in made.expect)),
        version=sailviz.__version__,
    )
    return definition, list(asked.record)


def _too_many_flights(items: Sequence[Axis | Draw], asked: _Asked, most: int) -> list[Fault]:
    """A fault where a grid and its draws are more flights than the limit."""
    lengths = [len(item.values) for item in items if isinstance(item, Axis)]
    flights = (max(lengths, default=1) if asked.together else prod(lengths)) * int(asked.draws or 1)
    if flights <= most:
        return []
    return [Fault("draws" if asked.draws and asked.draws > most else "vary", too_many(flights, "flights", most))]


@dataclass(frozen=True)
class _Asked:
    """What is asked for, unchecked: by arguments, and by a sweep file where they are silent."""

    scene: SceneSource
    settings: dict[str, Any]
    draws: int | None
    seed: int | None
    report: tuple[str, ...]
    together: bool | None
    record: Sequence[str | int] = ()
    items: Sequence[tuple[Axis | Draw, str]] = ()  # of the file, each with its place in it
    faults: tuple[Fault, ...] = ()
    source: str = "sweep"
    text: str = ""


def _with_file(asked: _Asked) -> _Asked:
    """What the sweep file says, if the scene is one, under what was asked for."""
    if isinstance(asked.scene, (Scene, dict)):
        return asked
    from sailviz.sweeps.sweep_file import find_sweep_file, read_sweep_file

    path = find_sweep_file(asked.scene)
    if path is None:
        return asked
    file = read_sweep_file(path, str(asked.scene))
    beside = path.parent / file.sweep.scene
    return replace(
        asked,
        scene=str(beside) if beside.is_file() else file.sweep.scene,
        settings=_flat(file.set) | asked.settings,
        draws=file.sweep.draws if asked.draws is None else asked.draws,
        seed=file.sweep.seed if asked.seed is None else asked.seed,
        together=file.sweep.together if asked.together is None else asked.together,
        report=(*file.sweep.report, *asked.report),
        record=file.sweep.record,
        items=file.items,
        faults=tuple(file.faults),
        source=str(asked.scene),
        text=file.text,
    )


def _scene_of(asked: _Asked) -> Scene:
    """The scene that varies. SceneError with the faults of the sweep file before its own."""
    try:
        return load_scene(asked.scene, asked.settings)
    except SceneError as error:
        if not asked.faults:
            raise
        faults = [*locate(list(asked.faults), asked.text), *error.faults]
        raise SceneError(faults, asked.source) from None


def _with_arguments(
    asked: _Asked, vary: Mapping[str, Any], most: int
) -> tuple[list[Axis | Draw], dict[str, str], list[Fault]]:
    """(what varies, key -> where that is written, faults), the keys of `vary` over those of the file."""
    faults = list(asked.faults)
    new: dict[str, Axis | Draw] = {}
    for key, wanted in vary.items():
        try:
            new[key] = varied(key, wanted, most)
        except ValueError as error:
            faults.append(Fault(key, str(error)))
    place = {item.key: where for item, where in asked.items} | {key: key for key in new}
    return [new.pop(item.key, item) for item, _ in asked.items] + list(new.values()), place, faults


def _flat(table: Mapping[str, Any], above: str = "") -> dict[str, Any]:
    """Nested tables as dotted keys."""
    found: dict[str, Any] = {}
    for key, value in table.items():
        if isinstance(value, dict):
            found |= _flat(value, f"{above}{key}.")
        else:
            found[above + key] = value
    return found
