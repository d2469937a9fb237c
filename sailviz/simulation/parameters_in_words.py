"""What distinguishes a scene: the parameter table of a recording."""

from __future__ import annotations

from typing import TYPE_CHECKING

from sailviz.propulsion.solar_sail import FILMS
from sailviz.scene.device import SolarSail
from sailviz.scene.phases import Until, until_of
from sailviz.scene.steering import PrimerSteering
from sailviz.simulation.bodies import body_of, epoch_of
from sailviz.simulation.device import device_of, film_of, radiation_pressure, shape_facts, strength_or_none
from sailviz.simulation.environment import parts_of
from sailviz.simulation.film import film_words
from sailviz.simulation.lowered import Place
from sailviz.simulation.start import departure
from sailviz.simulation.steering import steering_of
from sailviz.simulation.wheel import wheel_words
from sailviz.words import acceleration, duration

if TYPE_CHECKING:
    from sailviz.scene.loading import Scene
    from sailviz.simulation.lowered import Words
    from sailviz.simulation.start import Design


def parameters_in_words(scene: Scene, design: Design) -> Words:
    """(name, value) pairs of what distinguishes a scene, most telling first. design: of a designed orbit, or None."""
    rows: Words = [*departure(scene).words(scene.start, design)]
    strength = strength_or_none(scene, design)
    if strength is not None:
        rows.append(("a_c", acceleration(strength)))
    pressure = radiation_pressure(scene)
    if pressure is not None:
        rows.append(("radiation pressure", f"{pressure * 1e6:.6g} µN/m² at 1 au"))
    rows += device_of(scene).words(scene.device) + _shape(scene)
    rows += film_words(scene) + wheel_words(scene)
    rows += steering_of(scene.steering).words(scene.steering, design)
    rows += _as_flat_film(scene)
    place = Place(scene, body_of(scene), epoch_of(scene))
    for part, record in parts_of(scene):
        rows += record.words(part, place)
    return rows + _phases(scene) + _expectations(scene)


def _shape(scene: Scene) -> Words:
    """A shape's facets and table."""
    facts = shape_facts(scene)
    if facts is None:
        return []
    rays = {"none": "no shadows"}.get(facts["rays"], f"shadows by {facts['rays']}")
    area = f"{facts['film_area_m2']:.6g} m²"
    return [("shape", f"{facts['kind']}, {facts['facets']} facets, {area} of film, {rays}, table {facts['table'][:8]}")]


def _as_flat_film(scene: Scene) -> Words:
    """What a sail with a shape gives up under a law that makes the most of a flat film."""
    device, steering = scene.device, scene.steering
    if not isinstance(device, SolarSail) or device.shape is None or not isinstance(steering, PrimerSteering):
        return []
    from sailviz.simulation.sail_shape import given_up, sail_shape

    film = film_of(scene) if steering.reckons_with is None else FILMS.get(steering.reckons_with)
    if film is None:  # an electric sail, whose best pitch is of no use to a film
        return [("law", f"reckons with {steering.reckons_with}")]
    lost = given_up(sail_shape(scene), film)
    return [("law", f"reckons with a flat film; of the shape's push along the primer this gives up {lost:.2g} at most")]


def _phases(scene: Scene) -> Words:
    """What ends each phase."""
    rows = []
    for i, phase in enumerate(scene.phase):
        until = until_of(phase)
        if isinstance(until, Until):
            words = f"for {duration(until.duration)}" if until.duration is not None else f"until {until.words}"
        else:
            words = f"until {until}" if until else "until the end"
        rows.append((f"phase {i + 1}", f"{phase.name}, {words}"))
    return rows


def _expectations(scene: Scene) -> Words:
    """The first of what the scene expects of its own flight."""
    rows = []
    for item in [item for item in scene.expect if item.ensemble is None][:3]:
        when = item.at if item.at is not None else duration(item.at_time or 0.0)
        rows.append((f"expected {item.quantity} ({when})", f"{item.value:.7g}"))
    return rows
