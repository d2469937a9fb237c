"""What an ensemble of a craft that turns draws, and what may be expected of its flights."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from sailviz.errors import SceneError
from sailviz.scene.attitude import Moving
from sailviz.scene.conflicts.answers import Faults
from sailviz.scene.conflicts.records import device_of
from sailviz.scene.conflicts.surroundings import IRRADIANCES
from sailviz.scene.draws import Draw, drawn
from sailviz.scene.overrides import place_of, same_quantity
from sailviz.scene.quantities import ON_A_CIRCLE, spellings
from sailviz.scene.sections import Ensemble, Expectation
from sailviz.words import nearest, shown

if TYPE_CHECKING:
    from sailviz.scene.loading import Scene

MOST_FLIGHTS = 10_000  # each is flown whole, one after the other
TABLES = ("attitude", "device", "start", "environment", "light")  # whose keys may be drawn
MOMENTS = ("start", "end", "min", "max", "mean")  # of each flight, of which statistics are known


def turns(scene: Scene) -> bool:
    """Whether the flights of an ensemble turn, each by itself."""
    return isinstance(scene.attitude, Moving)


def draws_of(item: Ensemble) -> tuple[Draw, ...]:
    """What each flight draws, of an ensemble without faults."""
    return tuple(drawn(one.key, one.distribution) for one in item.draw or ())


def of_turning(scene: Scene) -> Faults:
    """What keeps ensembles of a craft that turns from being flown."""
    found: Faults = []
    if scene.ensemble and any(event.stop for event in scene.event):
        found.append(("ensemble[0]", "an ensemble flies the whole duration: no event may stop the run"))
    for i, item in enumerate(scene.ensemble):
        place = f"ensemble[{i}]"
        if item.flights > MOST_FLIGHTS:
            words = f"a craft that turns is flown whole each time, {MOST_FLIGHTS:,} times at most: a sweep flies more"
            found.append((f"{place}.flights", words))
        if item.control != "device":
            found.append((f"{place}.control", "a craft that turns has no control but attitude.control"))
        if item.solar_wind is not None:
            found.append((f"{place}.solar_wind", "the solar wind acts on an electric sail only"))
        if not item.draw and not varies(scene):
            words = "nothing differs between its flights: say what they draw, draw, or let environment.irradiance vary"
            found.append((f"{place}.draw", words))
        found += _keys(scene, item, place)
    return found


def varies(scene: Scene) -> bool:
    """Whether the sunlight of each flight is another one."""
    light = scene.environment.irradiance
    return bool(device_of(scene).sunlight) and not IRRADIANCES[type(light)].steady


def drawn_by_others(scene: Scene) -> Faults:
    """A craft that stands as its steering says draws winds and sunlight alone."""
    words = 'keys are drawn for a craft that turns by itself, [attitude]; for others by a sweep, "sailviz sweep"'
    return [(f"ensemble[{i}].draw", words) for i, item in enumerate(scene.ensemble) if item.draw]


def _keys(scene: Scene, item: Ensemble, place: str) -> Faults:
    """Faults of what is drawn: how it is written, and a middle value that the scene does not take."""
    found: Faults = []
    middle: dict[str, float] = {}
    for i, one in enumerate(item.draw or ()):
        table, _, last = one.key.rpartition(".")
        root = one.key.partition(".")[0]
        before = [key.rpartition(".")[2] for key in middle if key.rpartition(".")[0] == table]
        if root not in TABLES or not table:
            words = f"drawn are keys below {', '.join(TABLES)}, such as attitude.pitch_deg. {nearest(root, TABLES)}"
            found.append((f"{place}.draw[{i}].key", words))
        elif last in before or same_quantity(last, before):
            found.append((f"{place}.draw[{i}].key", "this quantity is drawn already"))
        try:
            middle[one.key] = drawn(one.key, one.distribution).centre()
        except ValueError as error:
            found.append((f"{place}.draw[{i}].distribution", str(error).removesuffix(".")))
    return found


def middle_faults(scene: Scene, build: Callable[[dict[str, Any], dict[str, Any]], Scene]) -> Faults:
    """What is wrong with the scene of a flight that draws a middle value of each key, where the scene itself will do.
    build : makes a scene of tables and values put over them."""
    found: Faults = []
    for i, item in enumerate(scene.ensemble):
        middle = {one.key: one.centre() for one in draws_of(item)}
        try:
            build(without_ensembles(scene), middle)
        except SceneError as error:
            for fault in error.faults:
                number = _said_by(fault.where, middle)
                where = f"ensemble[{i}].draw" if number is None else f"ensemble[{i}].draw[{number}].key"
                hint = f". {fault.hint.removesuffix('.')}" if fault.hint else ""
                found.append((where, f"{fault.where}: {fault.what.removesuffix('.')}{hint}"))
    return found


def without_ensembles(scene: Scene) -> dict[str, Any]:
    """A scene's tables without its ensembles and what is expected of any flight."""
    return {key: value for key, value in scene.raw.items() if key not in ("ensemble", "expect")}


def _said_by(where: str, middle: dict[str, float]) -> int | None:
    """The number of the key that a fault is about."""
    keys = [place_of(key) for key in middle]
    return next((i for i, key in enumerate(keys) if where == key or where.startswith((f"{key}.", f"{key}["))), None)


def expected(scene: Scene, item: Expectation, place: str, met: list[str]) -> Faults:
    """What may be expected of such an ensemble. met : names of events."""
    stem = spellings()[item.quantity].stem
    if stem == "share":
        if item.at in met and item.statistic == "mean":
            return []
        words = 'share is that of the flights that meet an event: statistic = "mean", at = an event'
        return [(f"{place}.at", f"{words}. {nearest(str(item.at), met)}")]
    if item.at not in MOMENTS:
        words = f"of each flight are known its values at {', '.join(MOMENTS)}, not at {shown(item.at)}"
        return [(f"{place}.at", words)]
    if stem in ON_A_CIRCLE or stem == "closed_form_error":
        return [(f"{place}.quantity", f"{stem} has no statistics over the flights of a craft that turns")]
    return []
