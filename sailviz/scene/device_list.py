"""One craft with several devices: the list [[device]], taken apart into the device that [steering] steers and those
beside it, and the places of both as they are written.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field, replace
from typing import Any

from sailviz.errors import Fault
from sailviz.scene.device import Devices
from sailviz.scene.values import Section
from sailviz.units import spelled

SAILS = ("solar-sail", "electric-sail")


class Beside(Section):
    """The devices beside the first one."""

    device: list[Devices] = []


@dataclass(frozen=True)
class TakenApart:
    """Tables of a scene in which one device stands, and the tables of the others."""

    tables: dict[str, Any]
    beside: list[Any] = field(default_factory=list)
    listed: bool = False  # [[device]], not [device]
    place: int = 0  # in the list, of the device that stands in the tables
    own_steering: bool = False  # which says its steering itself
    faults: list[Fault] = field(default_factory=list)

    def place_of(self, index: int) -> int:
        """In the list, of one of those beside."""
        return index + (index >= self.place)

    def as_written(self, where: str, beside: bool = False) -> str:
        """A place as it stands in the file. beside : where it counts the devices beside."""
        if beside:
            head, _, rest = where.removeprefix("device[").partition("]")
            return f"device[{self.place_of(int(head))}]{rest}" if head.isdecimal() else where
        device = f"device[{self.place}]" if self.listed else "device"
        if where == "device" or where.startswith("device."):
            return device + where.removeprefix("device")
        steering = where == "steering" or where.startswith("steering.")
        return f"{device}.{where}" if steering and self.own_steering else where

    def written(self, faults: Iterable[Fault], beside: bool = False) -> list[Fault]:
        """The faults at places of the file."""
        found = []
        for fault in faults:
            where = self.as_written(fault.where, beside)
            own, written = (place.removesuffix(".kind") for place in (fault.where, where))
            what = fault.what.replace(f"a kind of {own}.", f"a kind of {written}.")
            found.append(replace(fault, where=where, what=what))
        return found


def taken_apart(raw: dict[str, Any]) -> TakenApart:
    """A scene's tables with one device. [steering] steers the first sail of a list, the first device where there is no
    sail; the mass that one of them gives is that of the whole craft, hence of each."""
    given = raw.get("device")
    if isinstance(given, list):
        return _of_list(raw, given)
    if not isinstance(given, dict) or "steering" not in given:
        return TakenApart(raw)
    device, steering, faults = _without_steering(given, raw, "device")
    return TakenApart({**raw, "device": device, "steering": steering}, own_steering=True, faults=faults)


def _of_list(raw: dict[str, Any], given: list[Any]) -> TakenApart:
    if not given:
        what = "lists no device: write [[device]] for each, or one [device]."
        return TakenApart({**raw, "device": {"kind": "none"}}, listed=True, faults=[Fault("device", what)])
    devices = [dict(device) if isinstance(device, dict) else device for device in given]
    tables = [device for device in devices if isinstance(device, dict)]
    faults = _one_mass(devices)
    _name(tables)
    kinds = [device.get("kind") if isinstance(device, dict) else None for device in devices]
    place = next((i for i, kind in enumerate(kinds) if kind in SAILS), 0)
    first, others = devices[place], devices[:place] + devices[place + 1 :]
    if not isinstance(first, dict) or "steering" not in first:
        return TakenApart({**raw, "device": first}, others, True, place, faults=faults)
    first, steering, more = _without_steering(first, raw, f"device[{place}]")
    tables_of_scene = {**raw, "device": first, "steering": steering}
    return TakenApart(tables_of_scene, others, True, place, True, faults + more)


def _without_steering(
    device: dict[str, Any], raw: dict[str, Any], where: str
) -> tuple[dict[str, Any], Any, list[Fault]]:
    """(the device, its steering, what is wrong with giving it there)"""
    twice = [Fault("steering", f"{where} has a steering of its own: say it once.")] if "steering" in raw else []
    return {key: value for key, value in device.items() if key != "steering"}, device["steering"], twice


def _one_mass(devices: list[Any]) -> list[Fault]:
    """Puts the mass that one table gives into all; faults where several give it."""
    keys = spelled("mass", "mass")
    said = [(i, key) for i, device in enumerate(devices) if isinstance(device, dict) for key in keys if key in device]
    if not said:
        return []
    giver, key = said[0]
    for device in devices:
        if isinstance(device, dict) and not any(other in device for other in keys):
            device[key] = devices[giver][key]
    what = f"a craft has one mass, which device[{giver}] says already."
    return [Fault(f"device[{i}].{other}", what) for i, other in said[1:] if i != giver]


def _name(tables: list[dict[str, Any]]) -> None:
    """Gives each device without a name that of its kind, the second of a kind with its number."""
    taken = [table["name"] for table in tables if isinstance(table.get("name"), str)]
    for table in tables:
        kind = table.get("kind")
        if "name" in table or not isinstance(kind, str):
            continue
        name, number = kind, 1
        while name in taken:
            number += 1
            name = f"{kind} {number}"
        table["name"] = name
        taken.append(name)
