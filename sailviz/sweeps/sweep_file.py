"""The sweep file: TOML with tables [sweep], [set] and [[vary]]; where one is found and what it says."""

from __future__ import annotations

import os
import tomllib
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import Field, model_validator
from pydantic_core import ValidationError

from sailviz.errors import Fault, SceneError
from sailviz.scene.draws import Draw, drawn
from sailviz.scene.faults import faults_of, locate
from sailviz.scene.loading import find_scene
from sailviz.scene.named_files import outside
from sailviz.scene.units_in_keys import convert
from sailviz.scene.values import Section, one_of
from sailviz.shipped import shipped_scenes, shipped_sweeps
from sailviz.sweeps.distributions import MOST_VALUES, Axis, axis, varied
from sailviz.words import nearest


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
    def _one(self) -> VarySection:
        one_of(self, "values", "range", "distribution")
        return self

    @property
    def given(self) -> str:
        """Which of the three ways to vary a key is used."""
        return next(name for name in ("range", "distribution", "values") if getattr(self, name) is not None)

    def item(self, most: int) -> Axis | Draw:
        """The key with what it takes. most : values that are allowed. ValueError says what is wrong."""
        if self.range is not None:
            low, high, count = self.range
            return axis(self.key, low, high, count, self.spacing, most)
        if self.distribution is not None:
            return drawn(self.key, self.distribution)
        return varied(self.key, self.values)


class SweepFile(Section):
    """A whole sweep file."""

    sweep: SweepSection
    set: dict[str, Any] = {}
    vary: Annotated[list[VarySection], Field(min_length=1)]


@dataclass(frozen=True)
class SweepRead:
    """What a sweep file says: its [sweep] and [set], the keys that vary, each with its place in the file, and what is
    wrong with them."""

    sweep: SweepSection
    set: dict[str, Any]
    items: list[tuple[Axis | Draw, str]]
    faults: list[Fault]
    text: str


def _most_flights(settings: dict[str, Any]) -> int:
    """limits.flights of [set], as a table or with a dot in its key; a wrong one is told with the scene's faults."""
    limits = settings.get("limits")
    most = limits.get("flights") if isinstance(limits, dict) else settings.get("limits.flights")
    return most if isinstance(most, int) else MOST_VALUES


def find_sweep_file(name: str | os.PathLike[str]) -> Path | None:
    """The file of that name, or of a shipped scene or sweep, if it is a sweep and not a scene."""
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


def read_sweep_file(path: Path, source: str) -> SweepRead:
    """Read and check a sweep file. SceneError where not even its tables can be made out; what is wrong with single keys
    is left to be told with the rest."""
    text = path.read_text(encoding="utf-8-sig")
    fields, converted = convert(SweepFile, tomllib.loads(text))
    faults = converted.faults
    try:
        file = SweepFile.model_validate(fields)
    except ValidationError as error:
        raise SceneError(locate(faults + faults_of(error, converted, SweepFile), text), source) from None
    if (name := file.sweep.scene) not in shipped_scenes() and (what := outside(path.parent, name)):
        raise SceneError(locate([*faults, Fault("sweep.scene", f"{what}.")], text), source)
    most = _most_flights(file.set)
    items = []
    for i, section in enumerate(file.vary):
        try:
            items.append((section.item(most), f"vary[{i}].key"))
        except ValueError as error:
            faults.append(Fault(f"vary[{i}].{section.given}", str(error)))
    return SweepRead(file.sweep, file.set, items, faults, text)
