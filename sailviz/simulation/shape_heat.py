"""What the films of a scene's shape are to the light that heats them."""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING, Any

import numpy as np

from sailviz.errors import Fault, SceneError
from sailviz.propulsion.film_ageing import Optics
from sailviz.propulsion.shaped_heat import HeatedFilm, heat_numbers
from sailviz.propulsion.solar_sail import OPTICS
from sailviz.scene.device import SolarSail
from sailviz.scene.film import WITH_OPTICS
from sailviz.scene.shape import FileShape
from sailviz.shapes import facing, kept_tables
from sailviz.shapes.facets import Shape
from sailviz.shapes.shadows import may_shade
from sailviz.simulation.film import mirrored_by_back, optics
from sailviz.simulation.sail_shape import sail_shape

if TYPE_CHECKING:
    from sailviz.scene.loading import Scene

Material = tuple[Optics, float, bool]  # of the front; reflectivity of the back, negative if not known; whether it ages


def shape_heat(scene: Scene) -> np.ndarray:
    """Numbers of `propulsion.shaped_heat` for the scene's shape. SceneError where a film's optics are not known."""
    device = scene.device
    assert isinstance(device, SolarSail)
    assert device.shape is not None
    shape, films = sail_shape(scene).shape, dict[Material, list[int]]()
    for number, part in enumerate(shape.parts):
        if part.is_film:
            found = _material(device, part.name, scene.source)
            if found[0].ef + found[0].eb > 0:  # what takes up and radiates nothing has no temperature
                films.setdefault(found, []).append(number)
    if not films:
        words = "no part of the shape is a film that radiates: none has a temperature."
        raise SceneError([Fault("device.shape", words)], scene.source)
    parts, cells = tuple(map(tuple, films.values())), device.shape.cells
    left = None
    if device.shape.shadow and may_shade(shape):
        left = _left(shape.digest(), parts, cells, _Held(shape))
    heated = [
        HeatedFilm(*material, facing.normals_of(shape, numbers), None if left is None else left[i])
        for i, (material, numbers) in enumerate(films.items())
    ]
    return heat_numbers(heated, device.roll or 0.0)


def _material(device: SolarSail, part: str, source: Any) -> Material:
    """What a film is made of."""
    named = device.shape.parts.get(part) if isinstance(device.shape, FileShape) else None
    if named is None:
        return optics(device), mirrored_by_back(device), device.ageing is not None
    film, _, its_back = named.partition("/")
    if film not in WITH_OPTICS:
        words = f'the part "{part[:40]}" is of a film whose optics are not known: it has no temperature that is told.'
        raise SceneError([Fault("device.shape.parts", words)], source)
    back = its_back or (device.back if isinstance(device.back, str) else "same")
    cr = Optics(*OPTICS[film]).cr
    return Optics(*OPTICS[film]), {"same": cr, "black": 0.0}.get(back, -1.0), False


class _Held:
    """A shape that no cache compares: its digest is beside."""

    def __init__(self, shape: Shape):
        self.shape = shape

    def __eq__(self, other: object) -> bool:
        return isinstance(other, _Held)

    def __hash__(self) -> int:
        return 0


@lru_cache(8)
def _left(digest: str, parts: tuple[tuple[int, ...], ...], cells: int, held: _Held) -> np.ndarray:
    return kept_tables.shares_of(held.shape, parts, cells)
