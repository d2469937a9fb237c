"""The shape of a scene's sail: its parts, its table, and what pushes it in the right-hand side."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from sailviz import frames
from sailviz.constants import AU
from sailviz.errors import Fault, SailvizError, SceneError
from sailviz.propagate import shape_air_callback
from sailviz.propagate.callbacks import Callback
from sailviz.propagate.shape_callback import WEAK, shape_thrust
from sailviz.propulsion import shaped_sail
from sailviz.propulsion.film_ageing import Optics, aged_film, worn
from sailviz.propulsion.solar_sail import FILMS, OPTICS, Film, black_back
from sailviz.propulsion.surfaces import back_named, film_named, side_of
from sailviz.scene.attitude import Moving
from sailviz.scene.device import SolarSail
from sailviz.scene.named_files import folder_of
from sailviz.scene.shape import (
    Air,
    Bus,
    CapShape,
    DiscShape,
    FileShape,
    HeliogyroShape,
    PyramidShape,
    RingShape,
    SquareShape,
)
from sailviz.scene.shape import Shape as ShapeSection
from sailviz.shapes import air_law, kept_tables, membranes, shadows, structures
from sailviz.shapes.facets import Coefficients, Part, Shape, Surface, subdivided
from sailviz.shapes.file_checks import ShapeError
from sailviz.shapes.light_force import LIGHT, Law, pressure
from sailviz.shapes.light_table import LightTable, of_one_coefficient, with_age
from sailviz.shapes.own_files import read_parts, shape_of
from sailviz.simulation.lowered import Array
from sailviz.steering import optimal_pitch

if TYPE_CHECKING:
    from sailviz.scene.loading import Scene

Progress = Callable[[float], None]
FINE = 7e-4  # share of the films' area that a facet of a file may have where it may be shaded
BLACK = Coefficients(0.5, 0.0, 0.0)


class SailShape(NamedTuple):
    """A shape and its table over the directions of the light. facts : what a recording says of them."""

    shape: Shape
    table: LightTable
    air: LightTable | None  # of the law of the air, where that pushes it
    surface_at: Callable[[float], Surface] | None  # of a film that ages, at a dose in s
    facts: dict[str, Any]

    def facing(self) -> float:
        """Force along its axis over 2 P, m2, where it faces the light."""
        return float(shaped_sail.force_and_torque([0.0, 0.0, 1.0], self.table.numbers)[0][2])

    def at_dose(self, dose: float) -> Shape:
        """The shape whose films have had a dose, s."""
        if self.surface_at is None:
            return self.shape
        film = self.surface_at(dose)
        parts = (replace(part, surface=film) if part.is_film else part for part in self.shape.parts)
        return Shape(tuple(parts), self.shape.notes)

    def pressures(self, u: np.ndarray, dose: np.ndarray | None = None) -> np.ndarray:
        """Pressure of light (n, k) over 2 P on its facets, for directions u (n, 3) in body axes; dose (n,) s of films
        that age."""
        caster = shadows.Shadows(self.shape) if self.facts["shadow"] else None
        visible = [None] * len(u) if caster is None else caster.visible(u)
        shapes = [self.shape] * len(u) if dose is None else [self.at_dose(float(one)) for one in dose]
        rows = zip(shapes, u, visible, strict=True)
        return np.stack([pressure(shape, one, seen) for shape, one, seen in rows])

    def changes(self, dose: np.ndarray) -> np.ndarray:
        """By what b1, b2, b3 of the front and b3 of the back have changed at doses (n,) s, (n, 4)."""
        assert self.surface_at is not None
        fresh, aged = _four(self.surface_at(0.0)), [_four(self.surface_at(float(one))) for one in dose]
        return np.array(aged) - fresh


def _four(film: Surface) -> np.ndarray:
    """What of a film changes with its age: b1, b2, b3 of its front, b3 of its back."""
    assert film.back is not None
    return np.array([*film.front, film.back.b3])


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


def sail_shape(scene: Scene, progress: Progress | None = None) -> SailShape:
    """The shape of the scene's sail, found again where it was made before. progress : hears the share that is done of
    its tables. SceneError where it cannot be had."""
    device = scene.device
    assert isinstance(device, SolarSail)
    file = folder_of(scene) / device.shape.file if isinstance(device.shape, FileShape) else None
    stamp = file.stat().st_mtime_ns if file is not None and file.is_file() else 0
    try:
        said = device.model_dump_json(include={"film", "back", "shape", "ageing"})
        return _built(said, file, stamp, _Held(device, progress))
    except SailvizError as error:
        raise SceneError([Fault("device.shape", f"{error}.")], scene.source) from None
    except ValueError as error:
        raise SceneError([Fault("device.shape", f"{error}.")], scene.source) from None


class _Held:
    """A device that no cache compares, and who hears of its tables: what counts of it is said beside."""

    def __init__(self, device: SolarSail, progress: Progress | None):
        self.device, self.progress = device, progress

    def __eq__(self, other: object) -> bool:
        return isinstance(other, _Held)

    def __hash__(self) -> int:
        return 0


@lru_cache(8)
def _built(said: str, file: Path | None, stamp: int, held: _Held) -> SailShape:
    section = held.device.shape
    assert section is not None
    own = surface_of_film(held.device)
    if isinstance(section, FileShape):
        assert file is not None
        shape = of_file(file, section.unit, section.front, own, section.parts)
    else:
        shape = Shape((_film(section, own),))
    if section.bus is not None:
        shape = Shape((*shape.parts, _bus(section.bus)), shape.notes)
    facts = {
        "kind": section.kind,
        "hash": shape.digest(),
        "facets": len(shape.elements),
        "film_area_m2": shape.film_area,
        "size_m": shape.size,
        "cells": section.cells,
        "shadow": section.shadow,
    }
    if file is not None:
        facts["file_sha256"] = hashlib.sha256(file.read_bytes()).hexdigest()
    parts = 1 if section.air is None else 2
    table, facts["table"], facts["rays"] = _table(shape, section, LIGHT, _share(held.progress, 0, parts))
    air = None
    if section.air is not None:
        of_air, law = _in_air(shape, section.air)
        air, facts["air_table"], _ = _table(of_air, section, law, _share(held.progress, 1, parts))
    age = held.device.ageing
    if age is None:
        return SailShape(shape, table, air, None, facts)
    aged = _ageing(shape, table, held.device, own, facts)
    return SailShape(shape, aged, air, lambda dose: aged_surface(held.device, dose), facts)


def _ageing(shape: Shape, fresh: LightTable, device: SolarSail, own: Surface, facts: dict[str, Any]) -> LightTable:
    """The table of a shape whose films age, and into the facts what it is made of. ShapeError where a film is another
    than the one that ages, or there is none."""
    films, section = shape.films, device.shape
    assert section is not None
    if not films:
        raise ShapeError("ageing is that of films, and every part of the shape is a closed body")
    others = [part.name for part in films if part.surface != own]
    if others:
        named = ", ".join(f'"{name[:40]}"' for name in others[:5])
        raise ShapeError(f"ageing is that of the device's film: no other film is known to age, as that of {named}")
    shapes = of_one_coefficient(shape, device.back == "black")
    shadow, interpolation = section.shadow, section.interpolation
    groups = kept_tables.tables_of(shapes, section.cells, shadow=shadow, interpolation=interpolation)
    facts["ageing_tables"] = [kept_tables.key(one, section.cells, shadow, interpolation, LIGHT) for one in shapes]
    return with_age(fresh, groups, shape.film_area)


def _share(progress: Progress | None, done: int, parts: int) -> Progress | None:
    """Who hears of one of several tables."""
    return None if progress is None else lambda share: progress((done + share) / parts)


def _table(shape: Shape, section: ShapeSection, law: Law, progress: Progress | None) -> tuple[LightTable, str, str]:
    """(a table, its hash, what casts its rays)."""
    shadow, interpolation = section.shadow, section.interpolation
    table = kept_tables.table_of(
        shape, section.cells, shadow=shadow, interpolation=interpolation, law=law, progress=progress
    )
    return table, kept_tables.key(shape, section.cells, shadow, interpolation, law), table.backend


def _in_air(shape: Shape, said: Air) -> tuple[Shape, Law]:
    """A shape and its law in air. The limit's law is that of light, with coefficients of its own."""
    gas = air_law.Air(
        said.speed_ratio, said.normal_accommodation, said.tangential_accommodation, said.wall_temperature_ratio
    )
    b = gas.hyperthermal
    parts = (replace(part, surface=Surface(b, b if part.is_film else None)) for part in shape.parts)
    return Shape(tuple(parts)), LIGHT if said.law == "hyperthermal" else gas


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


def surface_of_film(device: SolarSail) -> Surface:
    """Both sides of the film. ShapeError for a black back of a film that does not say how it radiates."""
    given, back = device.film, device.back
    if device.ageing is not None:  # of its optics, which change, not the printed numbers
        return aged_surface(device, 0.0)
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


def aged_surface(device: SolarSail, dose: float) -> Surface:
    """Both sides of a film of known optics at a dose, s. Its front ages; its back stays as it is said, but that a black
    one, which radiates with the front, gets the less of it the more the front does."""
    age, back = device.ageing, device.back
    assert age is not None
    optics = Optics(*OPTICS[device.film]) if isinstance(device.film, str) else Optics(**device.film.model_dump())
    front = aged_film(optics, dose, age.factor, age.half_dose)
    if back == "same":
        behind = Film.from_optics(*optics)
    elif back == "black":
        _, gained = worn.py_func(np.float64(dose), age.factor, np.log(2.0) / age.half_dose)
        behind = black_back(optics._replace(ef=float(gained * optics.ef)))
    else:
        assert back is not None
        said = back.model_dump()
        behind = Film(**said) if "b1" in said else Film.from_optics(**said)
    return Surface(Coefficients(*side_of(front)), Coefficients(*side_of(behind)))


def thrust_of_shape(scene: Scene, pressure: float, under_sky: bool) -> Callback:
    """What pushes a sail of a shape. pressure : N/m2 at 1 au."""
    device = scene.device
    assert isinstance(device, SolarSail)
    found, push, roll = sail_shape(scene), 2 * pressure * AU**2, device.roll or 0.0
    if found.surface_at is None:
        return shape_thrust(push, under_sky, roll, found.table.numbers.tolist())
    from sailviz.propagate.aged_shape_callback import aged_shape_thrust  # machine code that other shapes do without

    assert device.mass is not None  # or the scene would not have been accepted
    fresh = _four(found.surface_at(0.0)).tolist()
    turns = isinstance(scene.attitude, Moving)
    return aged_shape_thrust(turns, push, under_sky, roll, found.table.numbers.tolist(), device.mass, fresh)


def acceleration_in_orbit(scene: Scene, pressure: float) -> Callable[[Array], Array]:
    """A function of normals (k, 3) along r, t, h: the acceleration (k, 3) m/s2 of the light along these, at 1 au, of
    the scene's sail, whose axes are as `shape_callback` has them. pressure : N/m2 at 1 au."""
    device = scene.device
    assert isinstance(device, SolarSail)
    assert device.mass is not None  # or the scene would not have been accepted
    roll, push, numbers = device.roll or 0.0, 2 * pressure / device.mass, sail_shape(scene).table.numbers

    def acceleration(normal: Array) -> Array:
        along = np.array([0.0, 1.0, 0.0]) - normal[:, 1:2] * normal
        size = np.linalg.norm(along, axis=1)
        if np.any(size < WEAK):
            raise ValueError("a normal along the flight leaves open how the shape is rolled about it")
        x = along / size[:, None]
        axes = np.stack([x, np.cross(normal, x), normal], axis=-1) @ frames.turn_z(roll).T
        force, _ = shaped_sail.force_and_torque(frames.to_frame(axes, np.tile([1.0, 0.0, 0.0], (len(x), 1))), numbers)
        return np.asarray(push * np.einsum("kij,kj->ki", axes, force))

    return acceleration


def given_up(found: SailShape, film: Film) -> float:
    """The largest share of the push along a primer that a shape gives up where its law turns it as the flat film would
    be best turned, over what it could give at the best angle in the plane of light and primer. Primers to 110 deg from
    the light, whatever the azimuth of the light about the axis."""
    pitch = np.radians(np.arange(0.0, 90.0))
    azimuth = np.radians(np.arange(0.0, 360.0, 30.0))
    a, d = (each.ravel() for each in np.meshgrid(pitch, azimuth, indexing="ij"))
    u = np.stack([np.sin(a) * np.cos(d), np.sin(a) * np.sin(d), np.cos(a)], axis=-1)
    across = np.stack([-np.cos(a) * np.cos(d), -np.cos(a) * np.sin(d), np.sin(a)], axis=-1)
    force = shaped_sail.force_and_torque(u, found.table.numbers)[0]
    along, aside = (np.sum(force * each, axis=1).reshape(len(pitch), -1) for each in (u, across))
    worst = 0.0
    for theta in np.radians(np.arange(0.0, 111.0, 5.0)):
        push = np.cos(theta) * along + np.sin(theta) * aside
        flown = optimal_pitch(theta, film)
        if not flown.on:
            continue
        had = np.array([np.interp(flown.pitch, pitch, column) for column in push.T])
        worst = max(worst, float(np.max(1 - had / push.max(axis=0))))
    return worst


def air_on_shape(scene: Scene) -> list[float] | None:
    """What a model reads of the air on the scene's shape; None where it pushes none."""
    device = scene.device
    if not isinstance(device, SolarSail) or device.shape is None or device.shape.air is None:
        return None
    table = sail_shape(scene).air
    assert table is not None
    return shape_air_callback.numbers(device.roll or 0.0, table.numbers)


def light_torque(
    scene: Scene, pressure: np.ndarray, towards: np.ndarray, axes: np.ndarray, dose: np.ndarray | None = None
) -> np.ndarray:
    """Torque (n, 3) N m of the light about the shape's origin, in body axes. pressure (n,) N/m2 where the sail is;
    towards (n, 3) the way the light travels; axes (n, 3, 3) of the body, as columns; dose (n,) s of a film that
    ages."""
    u, found = frames.to_frame(axes, towards), sail_shape(scene)
    if dose is None:
        torque = shaped_sail.force_and_torque(u, found.table.numbers)[1]
    else:
        torque = shaped_sail.aged_force_and_torque(u, found.table.numbers, found.changes(dose))[1]
    return np.asarray(2 * pressure[:, None] * torque)
