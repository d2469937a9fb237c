"""Flights beside the one of a report: the same craft without its device, and under a quiet and an active Sun."""

from __future__ import annotations

from copy import deepcopy
from dataclasses import dataclass
from typing import Any

from sailviz.deorbits.disposal import Descent, descent_of
from sailviz.errors import SailvizError
from sailviz.run.arrays import Run
from sailviz.scene import Scene
from sailviz.scene.loading import build_scene

SUNS = (
    ("quiet Sun, F10.7 = 70 sfu", 70.0),
    ("mean Sun, F10.7 = 140 sfu", 140.0),
    ("active Sun, F10.7 = 190 sfu", 190.0),
)
ROWS = 40  # of a flight of which the end alone is told
NOT_FLOWN_BESIDE = (
    "expect",
    "approximation",
    "ensemble",
    "chaos",
    "phase",
    "recording",
    "look_for",
    "steering",
    "target",
)
KEPT_OF_CRAFT = ("mass", "drag_")  # beginnings of the keys that belong to the craft, not to its device


@dataclass(frozen=True)
class Companion:
    """A flight beside another. descent : how it ended; None where it could not be flown, with why."""

    name: str
    descent: Descent | None
    why: str = ""

    @property
    def words(self) -> str:
        """How it ended."""
        return self.why if self.descent is None else self.descent.words

    def verdict(self, limit: float) -> str:
        """Whether a limit, s, is kept."""
        return "-" if self.descent is None else self.descent.verdict(limit)


def companions_of(scene: Scene) -> tuple[tuple[Companion, ...], str]:
    """The flights beside a descent, and a sentence about what was not flown."""
    found = []
    if scene.place is not None:
        return (), "Flights beside this one are not made for a list of devices."
    if scene.device.kind != "none":
        found.append(_without_device(scene))
    why = ""
    if scene.environment.solar_flux is None:
        why = "Neither air nor plasma of this scene depends on the Sun's activity: no other Suns are flown."
    else:
        found += [_flown(name, scene, {"environment.solar_flux_sfu": flux}) for name, flux in SUNS]
    return tuple(found), why


def _without_device(scene: Scene) -> Companion:
    """The craft as it is, with its mass and drag area, and nothing that brakes or pushes."""
    name = "drag alone, without the device"
    if not isinstance(scene.device.drag_area, float):
        return Companion(name, None, "not flown: the scene gives the craft no drag area of its own")
    raw = deepcopy(scene.raw)
    craft = {key: value for key, value in raw["device"].items() if key.startswith(KEPT_OF_CRAFT)}
    return _flown(name, scene, {}, {"device": {"kind": "none", **craft}})


def _flown(name: str, scene: Scene, values: dict[str, Any], tables: dict[str, Any] | None = None) -> Companion:
    """A variation, flown with few rows and without what only judges or draws."""
    from sailviz.simulation import simulate

    keeps = tables is None  # the device and how it is steered
    raw = {
        key: deepcopy(table)
        for key, table in scene.raw.items()
        if key not in NOT_FLOWN_BESIDE or (keeps and key in ("steering", "target", "phase"))
    } | (tables or {})
    propagation = {
        key: value
        for key, value in raw["propagation"].items()
        if key != "dense" and not key.startswith(("output", "redraw"))
    }
    raw["propagation"] = propagation | {"outputs": ROWS}
    try:
        run: Run = simulate(build_scene(raw, values, scene.text, scene.source))
    except SailvizError as error:
        return Companion(name, None, f"not flown: {str(error).splitlines()[-1].strip()}")
    descent = descent_of(run)
    return Companion(name, descent)
