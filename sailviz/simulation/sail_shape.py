"""The shape of a scene's sail: its parts, its table, and what pushes it in the right-hand side."""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from sailviz import frames
from sailviz.constants import AU
from sailviz.errors import Fault, SailvizError, SceneError
from sailviz.propagate.callbacks import Callback
from sailviz.propagate.shape_callback import shape_thrust
from sailviz.propulsion import shaped_sail
from sailviz.propulsion.solar_sail import FILMS, Film, black_back
from sailviz.propulsion.surfaces import back_named, film_named, side_of
from sailviz.scene.device import SolarSail
from sailviz.scene.named_files import folder_of
from sailviz.scene.shape import (
    Bus,
    CapShape,
    DiscShape,
    FileShape,
    HeliogyroShape,
    PyramidShape,
    RingShape,
    SquareShape,
)
from sailviz.shapes import kept_tables, membranes, shadows, structures
from sailviz.shapes.facets import Coefficients, Part, Shape, Surface, subdivided
from sailviz.shapes.file_checks import ShapeError
from sailviz.shapes.light_table import LightTable
from sailviz.shapes.own_files import read_parts, shape_of

if TYPE_CHECKING:
    from sailviz.scene.loading import Scene

FINE = 7e-4  # share of the films' area that a facet of a file may have where it may be shaded
BLACK = Coefficients(0.5, 0.0, 0.0)


class SailShape(NamedTuple):
    """A shape and its table over the directions of the light."""

    shape: Shape
    table: LightTable

    def facing(self) -> float:
        """Force along its axis over 2 P, m2, where it faces the light."""
        return float(shaped_sail.force_and_torque([0.0, 0.0, 1.0], self.table.numbers)[0][2])


def surface_named(film: str, back: str, closed: bool) -> Surface:
    """A surface by words. ShapeError for a word that is none."""
    try:
        front = Coefficients(*film_named(film))
        return Surface(front) if closed else Surface(front, Coefficients(*back_named(film, back)))
    except ValueError as error:
        raise ShapeError(str(error)) from None


def of_file(
    file: Path | str, unit: str | None, front: str, own: Surface, named: Mapping[str, str], back: str = "same"
) -> Shape:
    """The shape of a file of facets. own : surface of its films; named : by the names of parts FILM or FILM/BACK, the
    back, where it is not said, being `back`. A closed part that is not named is black. ShapeError."""
    found = read_parts(file, unit, front)
    surfaces = {part: Surface(BLACK) if found.closed(part) else own for part in found.meshes}
    for part, word in named.items():
        film, _, its_back = word.partition("/")
        surfaces[part] = surface_named(film, its_back or back, part in found.meshes and found.closed(part))
    shape = shape_of(found, surfaces)
    return subdivided(shape, FINE) if shadows.may_shade(shape) else shape


def sail_shape(scene: Scene) -> SailShape:
    """The shape of the scene's sail. SceneError where it cannot be had."""
    device = scene.device
    assert isinstance(device, SolarSail)
    file = folder_of(scene) / device.shape.file if isinstance(device.shape, FileShape) else None
    stamp = file.stat().st_mtime_ns if file is not None and file.is_file() else 0
    try:
        return _built(device.model_dump_json(include={"film", "back", "shape"}), file, stamp, _Held(device))
    except SailvizError as error:
        raise SceneError([Fault("device.shape", f"{error}.")], scene.source) from None
    except ValueError as error:
        raise SceneError([Fault("device.shape", f"{error}.")], scene.source) from None


class _Held:
    """A device that no cache compares: what counts of it is said beside."""

    def __init__(self, device: SolarSail):
        self.device = device

    def __eq__(self, other: object) -> bool:
        return isinstance(other, _Held)

    def __hash__(self) -> int:
        return 0


@lru_cache(8)
def _built(said: str, file: Path | None, stamp: int, held: _Held) -> SailShape:
    section = held.device.shape
    assert section is not None
    own = _surface(held.device)
    if isinstance(section, FileShape):
        assert file is not None
        shape = of_file(file, section.unit, section.front, own, section.parts)
    else:
        shape = Shape((_film(section, own),))
    if section.bus is not None:
        shape = Shape((*shape.parts, _bus(section.bus)), shape.notes)
    table = kept_tables.table_of(shape, section.cells, shadow=section.shadow, interpolation=section.interpolation)
    return SailShape(shape, table)


def _film(section: Any, own: Surface) -> Part:
    """The film of a kind of shape."""
    if isinstance(section, SquareShape):
        return membranes.square(section.side, own, section.cone, section.sag)
    if isinstance(section, CapShape):
        return membranes.cap(section.diameter, own, section.edge_slope)
    if isinstance(section, DiscShape):
        return membranes.disc(section.diameter, own)
    if isinstance(section, RingShape):
        return membranes.ring(section.diameter, section.inner_diameter, own)
    if isinstance(section, HeliogyroShape):
        return membranes.heliogyro(section.blades, section.length, section.chord, own, section.pitch, section.twist)
    assert isinstance(section, PyramidShape)
    return membranes.pyramid(section.boom, own, section.cone, section.opening)


def _bus(section: Bus) -> Part:
    return structures.bus(section.size, section.centre, surface_named(section.film, "same", True).front)


def _surface(device: SolarSail) -> Surface:
    """Both sides of the film. ShapeError for a black back of a film that does not say how it radiates."""
    given, back = device.film, device.back
    if isinstance(given, str):
        front, optics = side_of(FILMS[given]), None
    else:
        values = given.model_dump()
        optics = None if "b1" in values else (given.cr, given.cs, given.Bf, given.Bb, given.ef, given.eb)  # type: ignore[union-attr]  # those of FilmOptics
        front = side_of(Film(**values) if "b1" in values else Film.from_optics(**values))
    if isinstance(back, str):
        if back == "same":
            behind = front
        elif optics is not None:
            behind = side_of(black_back(optics))
        elif isinstance(given, str):
            return surface_named(given, "black", False)
        else:
            raise ShapeError('back = "black" needs a film that says how it radiates: give the back\'s b1, b2, b3')
    else:
        assert back is not None  # or the scene would not have been accepted
        said = back.model_dump()
        behind = side_of(Film(**said) if "b1" in said else Film.from_optics(**said))
    return Surface(Coefficients(*front), Coefficients(*behind))


def thrust_of_shape(scene: Scene, pressure: float, under_sky: bool) -> Callback:
    """What pushes a sail of a shape. pressure : N/m2 at 1 au."""
    assert isinstance(scene.device, SolarSail)
    found = sail_shape(scene)
    return shape_thrust(2 * pressure * AU**2, under_sky, scene.device.roll or 0.0, found.table.numbers.tolist())


def light_torque(scene: Scene, pressure: np.ndarray, towards: np.ndarray, axes: np.ndarray) -> np.ndarray:
    """Torque (n, 3) N m of the light about the shape's origin, in body axes. pressure (n,) N/m2 where the sail is;
    towards (n, 3) the way the light travels; axes (n, 3, 3) of the body, as columns."""
    u = frames.to_frame(axes, towards)
    return np.asarray(2 * pressure[:, None] * shaped_sail.force_and_torque(u, sail_shape(scene).table.numbers)[1])
