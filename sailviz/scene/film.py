"""What a scene asks of the film of its sail beside its push: whether it ages, and whether its temperature is told.
Plain words."""

from __future__ import annotations

from typing import TYPE_CHECKING

from sailviz.scene.device import Device, FilmOptics, SolarSail
from sailviz.scene.phases import Until, until_of
from sailviz.scene.quantities import spellings

if TYPE_CHECKING:
    from sailviz.scene.loading import Scene

WITH_OPTICS = ("ideal", "jpl-1978", "jpl-2015")  # films whose optics table 3.1 of the thesis gives


def ages(scene: Scene) -> bool:
    """Whether the film of the scene's sail ages."""
    return isinstance(scene.device, SolarSail) and scene.device.ageing is not None


def has_optics(device: Device) -> bool:
    """Whether the optics of a sail's film are known."""
    return isinstance(device, SolarSail) and (isinstance(device.film, FilmOptics) or device.film in WITH_OPTICS)


def radiates(device: Device) -> bool:
    """Whether a film with optics has a temperature: what radiates nothing has none."""
    if not isinstance(device, SolarSail) or not has_optics(device):
        return False
    film = device.film
    return film.ef + film.eb > 0 if isinstance(film, FilmOptics) else film != "ideal"


def asked_for(scene: Scene, stem: str) -> list[str]:
    """Places of the scene's expectations at which a quantity stands, and of its events and phases."""
    found = [f"expect[{i}].quantity" for i, item in enumerate(scene.expect) if spellings()[item.quantity].stem == stem]
    found += [f"event[{i}].{stem}" for i, item in enumerate(scene.event) if item.quantity == stem]
    for i, phase in enumerate(scene.phase):
        try:
            until = until_of(phase)
        except ValueError:  # which the questions about phases tell
            continue
        if isinstance(until, Until) and until.quantity == stem:
            found.append(f"phase[{i}].until")
    return found


def tells_temperature(scene: Scene) -> bool:
    """Whether the film's temperature is reckoned and recorded."""
    device = scene.device
    if not isinstance(device, SolarSail) or not radiates(device):
        return False
    return device.hottest is not None or device.ageing is not None or bool(asked_for(scene, "film_temperature"))


def heats_shape(scene: Scene) -> bool:
    """Whether that is the temperature of a shape's films."""
    return isinstance(scene.device, SolarSail) and scene.device.shape is not None and tells_temperature(scene)


def tells_film(scene: Scene) -> bool:
    """Whether a run of the scene has columns of its film."""
    return ages(scene) or tells_temperature(scene)
