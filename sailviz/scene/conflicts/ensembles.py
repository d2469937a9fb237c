"""What [[ensemble]] and [[chaos]] go together with, and whether a scene's own do."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any, Generic, NamedTuple, TypeVar

from sailviz.scene.conflicts import turning_ensembles
from sailviz.scene.conflicts.answers import Faults
from sailviz.scene.conflicts.devices import CONTROLS
from sailviz.scene.conflicts.limits import too_many
from sailviz.scene.conflicts.records import device_of, steering_of
from sailviz.scene.conflicts.surroundings import IRRADIANCES, WINDS
from sailviz.scene.device import Device, ElectricSail, VoltageControl, control_of
from sailviz.scene.sections import Chaos, Ensemble, ManyFlights
from sailviz.scene.values import Section
from sailviz.words import shown

if TYPE_CHECKING:
    from sailviz.scene.loading import Scene

M = TypeVar("M", bound=ManyFlights)


class EnsembleFits(NamedTuple, Generic[M]):
    """Facts of a way to fly many."""

    draws: Callable[[Scene, M, str], Faults]  # what keeps one, at a place, from its winds or sunshine


def _drawn(scene: Scene, item: Ensemble, place: str) -> Faults:
    """What keeps an ensemble from drawing winds of its own."""
    found: Faults = []
    around = scene.environment
    if device_of(scene).sunlight:
        light = around.irradiance
        shines = IRRADIANCES[type(light)]
        step = shines.step(light)
        if shines.steady:
            words = "in steady sunlight all flights are the same: environment.irradiance"
            found.append((f"{place}.name", words))
    else:
        wind = item.solar_wind or around.solar_wind
        blows = WINDS[type(wind)]
        step = blows.step(wind)
        if blows.steady:
            words = "in a steady wind all flights are the same: environment.solar_wind, or its own"
            found.append((f"{place}.name", words))
        found += blows.ensemble(wind, item, place)
    return found + _changes(scene, item, place, item.flights, step)


def _changes(scene: Scene, item: ManyFlights, place: str, flights: int, step: float | None) -> Faults:
    """Changes of wind or voltage in all flights together. step : s between changes of the wind, None where it is
    steady."""
    duration = scene.propagation.duration
    control = control_of(scene.device) if item.control == "device" else item.control
    every = None if control is None or isinstance(control, str) else CONTROLS[type(control)].interval(control)
    asked = flights * duration / min(step or duration, every or duration)
    return too_many(scene, asked, "changes", "changes of wind or voltage in all flights together", place)


def _expanded(scene: Scene, item: Chaos, place: str) -> Faults:
    """What keeps polynomial chaos from the one kind of pressure that it knows."""
    wind = item.solar_wind or scene.environment.solar_wind
    if WINDS[type(wind)].expands(wind):
        return _changes(scene, item, place, item.order + 1, None)
    words = "polynomial chaos knows one gamma-distributed pressure for a whole flight"
    whose = place if item.solar_wind else "environment"
    return [(f"{whose}.solar_wind", f'{words}: kind = "gamma", variation = "constant"')]


ENSEMBLES: dict[type[Section], EnsembleFits[Any]] = {
    Ensemble: EnsembleFits[Ensemble](_drawn),
    Chaos: EnsembleFits[Chaos](_expanded),
}


def placed_ensembles(scene: Scene) -> list[tuple[str, Ensemble | Chaos]]:
    """(place in the file, section) of everything that flies many."""
    placed: list[tuple[str, Ensemble | Chaos]] = [(f"ensemble[{i}]", item) for i, item in enumerate(scene.ensemble)]
    return placed + [(f"chaos[{i}]", item) for i, item in enumerate(scene.chaos)]


def ensembles(scene: Scene) -> Faults:
    """Whether a scene's ensembles have names of their own, fly its craft, and find what they draw."""
    placed = placed_ensembles(scene)
    found = _names(placed)
    if turning_ensembles.turns(scene):
        return found + turning_ensembles.of_turning(scene)
    found += turning_ensembles.drawn_by_others(scene)
    if placed:
        found += [(placed[0][0], sentence) for sentence in _not_side_by_side(scene)]
    for place, item in placed:
        found += _unlike_the_device(scene, item, place)
    for kind, fits in ENSEMBLES.items():
        for place, item in placed:
            if isinstance(item, kind):
                found += fits.draws(scene, item, place)
    return found


def _names(placed: Sequence[tuple[str, ManyFlights]]) -> Faults:
    """Names are told apart as the paths of a recording are."""
    found: Faults = []
    words: set[str] = set()
    for place, item in placed:
        word = "".join(letter if letter.isalnum() else "_" for letter in item.name.lower())
        if word in words:
            found.append((f"{place}.name", f"another ensemble is called {shown(item.name)} already"))
        words.add(word)
    return found


def _not_side_by_side(scene: Scene) -> list[str]:
    """What of a scene an ensemble cannot fly."""
    device = device_of(scene)
    if not device.sail or scene.body != "sun":
        return ["an ensemble flies a solar sail or an electric sail round the Sun"]
    found: list[str] = [] if scene.steering is None else steering_of(scene).ensemble(scene, scene.steering)
    if scene.environment.third_body is not None:
        found.append("an ensemble knows no gravity but the Sun's")
    found += device.ensemble(scene.device)
    if scene.device.active is not None:
        found.append("an ensemble's sail is on all the time: device.active is not for it")
    if any(event.stop for event in scene.event):
        found.append("an ensemble flies the whole duration: no event may stop the run")
    return found


def _unlike_the_device(scene: Scene, item: ManyFlights, place: str) -> Faults:
    """What an ensemble asks of a craft that has it not."""
    found, control, device, electric = [], item.control, scene.device, device_of(scene).wind
    if not isinstance(control, str):
        if electric != CONTROLS[type(control)].voltage:
            has = "an electric sail controls its voltage" if electric else "a solar sail has electrochromic control"
            found.append((f"{place}.control", has))
        elif _too_low(control, device):
            words = "must exceed device.wind_potential, or there is no thrust"
            found.append((f"{place}.control.nominal_voltage", words))
    if item.solar_wind is not None and not electric:
        found.append((f"{place}.solar_wind", "the solar wind acts on an electric sail only"))
    return found


def _too_low(control: Section, device: Device) -> bool:
    """Whether a voltage keeps no solar-wind ion away."""
    if not isinstance(device, ElectricSail) or not isinstance(control, VoltageControl):
        return False
    return control.nominal_voltage <= device.wind_potential
