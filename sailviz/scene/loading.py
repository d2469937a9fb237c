"""The scene file: TOML with the unit in every physical key, checked whole, SI once loaded.

Imports neither rerun nor numba nor scipy, so that `sailviz check` answers at once. What the values mean as arrays is
the business of `simulation`.
"""

from __future__ import annotations

import hashlib
import json
import os
import tomllib
from collections.abc import Mapping
from datetime import datetime
from functools import cache
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import Field, PrivateAttr
from pydantic_core import ValidationError

from sailviz.calendar import naive_utc
from sailviz.errors import Fault, SceneError
from sailviz.scene.attitude import Attitudes
from sailviz.scene.body import CENTRE, CustomBody, Target
from sailviz.scene.conflicts import beside_conflicts, conflicts
from sailviz.scene.conflicts.known_starts import dated
from sailviz.scene.conflicts.turning_ensembles import middle_faults
from sailviz.scene.device import Devices
from sailviz.scene.device_list import Beside, taken_apart
from sailviz.scene.environment import Environment
from sailviz.scene.ephemeris_name import EphemerisName
from sailviz.scene.events import Watched
from sailviz.scene.faults import faults_of, locate
from sailviz.scene.light import Light
from sailviz.scene.overrides import overridden, place_of
from sailviz.scene.phases import Phase
from sailviz.scene.sections import Approximation, Chaos, Ensemble, Expectation, Limits, Propagation, Recording
from sailviz.scene.sky import shadow_kind
from sailviz.scene.start import Start
from sailviz.scene.steering import Steering
from sailviz.scene.units_in_keys import convert
from sailviz.scene.values import Moment, Section
from sailviz.shipped import shipped_scenes
from sailviz.words import nearest

UNSAID = {  # by table, keys without which scenes were complete before they were known
    "": ("light", "frame", "attitude"),
    "start": ("frame",),
    "light": ("kind", "distance", "longitude", "obliquity", "period", "direction", "mu", "radius"),
    "environment": ("gravity_of", "shadow_of", "magnetosphere", "space_weather"),
    "device": ("edge_area", "name", "steering", "shape", "back", "roll", "ageing", "hottest", "wheel"),
    "device.shape": ("air",),
    "expect": ("device", "percent"),
    "ensemble": ("draw",),
    "phase": ("attitude",),
    "steering": ("in_shadow", "minimum_perigee", "margin", "arcs", "touches", "hottest"),
    "target": ("mean_anomaly", "elements_date"),
}

LISTS = ("expect", "ensemble", "phase")  # of them, those of which there may be several


class Scene(Section):
    """A whole scene, SI. Build it with `load_scene`."""

    title: Annotated[str, Field(min_length=1)]
    about: str = ""
    thesis: str = ""
    look_for: list[str] = []
    family: Literal["displaced", "spirals", "deorbit", "wind", "transfers", "planets"] | None = None
    epoch: Moment | None = None
    ephemeris: EphemerisName = "mean-elements"
    body: CENTRE | CustomBody = "sun"
    frame: Literal["ecliptic-j2000", "icrf", "equator-of-date"] | None = None
    start: Start
    device: Devices
    steering: Steering | None = None
    attitude: Attitudes | None = None
    target: Target | None = None
    environment: Environment = Environment()
    light: Light | None = None
    propagation: Propagation
    event: list[Watched] = []
    phase: Annotated[list[Phase], Field(max_length=1000)] = []
    approximation: list[Approximation] = []
    ensemble: list[Ensemble] = []
    chaos: list[Chaos] = []
    recording: Recording = Recording()
    limits: Annotated[Limits, Field(exclude=True)] = Limits()  # no part of what is flown, hence none of the identity
    expect: list[Expectation] = []

    _text: str = PrivateAttr("")
    _source: str = PrivateAttr("scene")
    _raw: dict[str, Any] = PrivateAttr(default_factory=dict)
    _beside: tuple[Devices, ...] = PrivateAttr(())  # devices that push beside `device`, each with its own steering
    _place: int | None = PrivateAttr(None)  # of `device` in the list [[device]]; None where there is no list

    @property
    def text(self) -> str:
        """The scene file as it was read, overrides not included; "" if the scene was not made from a file."""
        return self._text

    @property
    def source(self) -> str:
        """File or shipped name that the scene came from, for messages."""
        return self._source

    @property
    def raw(self) -> dict[str, Any]:
        """The tables as tomllib would give them, with the values that were put over them."""
        return self._raw

    @property
    def beside(self) -> tuple[Devices, ...]:
        """The devices that push beside `device`, in the order of the list; each has its own steering."""
        return self._beside

    @property
    def place(self) -> int | None:
        """Of `device` in the list [[device]]; None where there is no list."""
        return self._place

    @property
    def devices(self) -> tuple[Devices, ...]:
        """All devices, as they are written."""
        at = self._place or 0
        return (*self._beside[:at], self.device, *self._beside[at:])

    def alone(self, device: Devices) -> Scene:
        """The scene with one of the devices beside as its only one."""
        changes: dict[str, Any] = {
            "device": device,
            "steering": device.steering,
            "approximation": [],
            "ensemble": [],
            "chaos": [],
        }
        copy = self.model_copy(update=changes)
        copy._beside = ()
        return copy

    def with_beside(self, beside: tuple[Devices, ...]) -> Scene:
        """The scene with other devices beside its first one."""
        copy = self.model_copy()
        copy._beside = beside
        return copy

    def resolved(self) -> dict[str, Any]:
        """Every value, defaults included, SI, ready for JSON. Keys that came later are left out where they are
        not said: what scenes were before they could be said, they still are."""
        values = self.model_dump(mode="json")
        beside = [device.model_dump(mode="json") for device in self._beside]
        tables = [
            ("", values),
            *((name, values[name] or {}) for name in UNSAID if name in values and name not in LISTS),
        ]
        tables += [("device", device) for device in beside]
        tables += [("device.shape", device.get("shape") or {}) for device in (values["device"], *beside)]
        tables += [("steering", device["steering"] or {}) for device in beside]
        tables += [(name, one) for name in LISTS for one in values[name]]
        for name, table in tables:
            for key in UNSAID[name]:
                if table.get(key, "") is None:
                    del table[key]
        if not self.phase:
            del values["phase"]
        values["environment"]["shadow"] = shadow_kind(self)
        if self._place is not None:
            values["device"] = [*beside[: self._place], values["device"], *beside[self._place :]]
        return values

    def identity(self) -> str:
        """Hash of the resolved scene, 16 hexadecimal digits: equal scenes have equal recordings."""
        canonical = json.dumps(self.resolved(), sort_keys=True, separators=(",", ":"))
        return hashlib.sha256(canonical.encode()).hexdigest()[:16]

    def with_values(self, values: Mapping[str, Any]) -> Scene:
        """A copy with other values. values : {"device.lightness_number": 0.1, "propagation.duration_yr": 2}, keys
        and units as in a scene file; a key in another unit replaces the one in the file. SceneError as for
        `load_scene`."""
        return build_scene(self._raw, values, self._text, self._source)

    @property
    def epoch_utc(self) -> datetime | None:
        """The epoch as a naive UTC datetime."""
        return None if self.epoch is None else naive_utc(self.epoch)


SceneSource = str | os.PathLike[str] | dict[str, Any] | Scene  # what every verb that takes a scene takes


def load_scene(source: SceneSource, set: Mapping[str, Any] | None = None) -> Scene:
    """Read, check and convert a scene.

    source : path of a TOML file, the name of a shipped scene ("displaced/circular"), a dict as tomllib would give it,
    or a Scene, which comes back as it is. set : values to put over those of the source, keys dotted:
    {"propagation.duration_yr": 1}. Raises SceneError with every fault at once.
    """
    if isinstance(source, Scene):
        return source.with_values(set) if set else source
    if isinstance(source, dict):
        return build_scene(source, set or {}, "", "scene")
    path, name = find_scene(source)
    try:
        text = path.read_text(encoding="utf-8-sig")
    except OSError as error:
        raise SceneError([Fault("file", error.strerror or str(error))], name) from None
    except UnicodeDecodeError:
        raise SceneError([Fault("file", "is not UTF-8 text, so not a scene")], name) from None
    try:
        raw = tomllib.loads(text)
    except ValueError as error:  # tomllib's own, or Python's for a number of thousands of digits
        raise SceneError([Fault("file", f"is not valid TOML: {error}")], name) from None
    except RecursionError:
        raise SceneError([_TOO_DEEP], name) from None
    return build_scene(raw, set or {}, text, name)


def find_scene(source: str | os.PathLike[str]) -> tuple[Path, str]:
    """(file, name for messages) of a path or a shipped name. SceneError, with the nearest name, if there is none."""
    path = Path(source)
    try:
        if path.is_file():
            return path, str(source)
    except OSError as error:  # a name that no file can have
        raise SceneError([Fault("file", error.strerror or str(error))], str(source)) from None
    known = shipped_scenes()
    name = str(source).removesuffix(".toml")
    if name in known:
        return known[name], name
    what = "is a folder, not a scene file." if path.is_dir() else "no such file or shipped scene."
    raise SceneError([Fault("file", f"{what} {nearest(name, known)}")], str(source))


_TOO_DEEP = Fault("file", "is nested too deeply")


def build_scene(raw: dict[str, Any], values: Mapping[str, Any], text: str, name: str) -> Scene:
    """A scene of tables as tomllib gives them, with values put over them. text : of the file they were read from, "" if
    none; name : of the source, for messages. SceneError as for `load_scene`."""
    try:
        return _validated(overridden(raw, values, name), text, name, [place_of(key) for key in values])
    except RecursionError:
        raise SceneError([_TOO_DEEP], name) from None


def _validated(raw: dict[str, Any], text: str, source: str, given: list[str]) -> Scene:
    apart = taken_apart(raw)
    fields, converted = convert(Scene, apart.tables)
    fields_beside, converted_beside = convert(Beside, {"device": apart.beside})
    faults = apart.faults + apart.written(converted.faults) + apart.written(converted_beside.faults, beside=True)
    scene, beside = None, Beside()
    try:
        scene = Scene.model_validate(fields)
    except ValidationError as error:
        faults += apart.written(faults_of(error, converted, Scene))
    try:
        beside = Beside.model_validate(fields_beside)
    except ValidationError as error:
        faults += apart.written(faults_of(error, converted_beside, Beside), beside=True)
    if scene is None:
        raise SceneError(locate(faults, text, given), source)
    scene._text, scene._source, scene._raw = text, source, raw
    scene._beside, scene._place = tuple(beside.device), apart.place if apart.listed else None
    if not faults:
        scene, told = dated(scene)
        faults = apart.written(Fault(converted.path(place) or place, what) for place, what in told)
    if not faults:
        faults = apart.written(Fault(converted.path(place) or place, what) for place, what in conflicts(scene))
    if not faults and scene.ensemble:
        told = middle_faults(scene, lambda tables, values: build_scene(tables, values, text, source))
        faults = apart.written(Fault(converted.path(place) or place, what) for place, what in told)
    if not faults:
        found = beside_conflicts(scene)
        told_beside = (Fault(converted_beside.path(place) or place, what) for place, what in found)
        faults = apart.written(told_beside, beside=True)
    if faults:
        raise SceneError(locate(faults, text, given), source)
    return scene


@cache
def schema() -> dict[str, Any]:
    """JSON Schema of the scene file, every spelling of every quantity included, for editors and other tools."""
    from sailviz.scene.json_schema import schema_of

    found = schema_of(Scene, "scene")
    one = found["properties"]["device"]
    told = {key: one.pop(key) for key in ("title", "description") if key in one}
    found["properties"]["device"] = told | {"anyOf": [one, {"type": "array", "items": one, "minItems": 1}]}
    return found
