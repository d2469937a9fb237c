"""Inertia and centre of mass of a craft: as its scene says them, or of the shape that flies."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from sailviz.errors import Fault, SceneError

if TYPE_CHECKING:
    from sailviz.scene.loading import Scene
    from sailviz.shapes.facets import Shape


class MassProperties(NamedTuple):
    """inertia (3, 3) kg m2 about the centre of mass, which is (3,) m in the axes of the shape."""

    inertia: np.ndarray
    centre: np.ndarray


def mass_properties(scene: Scene) -> MassProperties:
    """Of the scene's craft. SceneError where the shape has nothing to hold its mass."""
    section = scene.attitude
    assert section is not None  # asked of crafts whose attitude says its mass
    said = section.matrix
    if said is not None:
        return MassProperties(np.array(said), np.array(section.centre_of_mass or [0.0, 0.0, 0.0]))
    from sailviz.simulation.sail_shape import sail_shape

    assert section.film_mass is not None
    assert scene.device.mass is not None
    rest = scene.device.mass - section.film_mass
    try:
        return of_shape(sail_shape(scene).shape, section.film_mass, rest)
    except ValueError as error:
        raise SceneError([Fault("attitude.film_mass", f"{error}.")], scene.source) from None


def of_shape(shape: Shape, film_mass: float, rest: float) -> MassProperties:
    """Of films that weigh film_mass kg, all alike, and closed bodies, alike and filled, that weigh the rest. ValueError
    where there is nothing to hold it."""
    from sailviz.shapes.facets import elements_of, film_inertia  # trimesh: only where a shape is weighed

    films, bodies = [part.mesh.triangles for part in shape.films], [p.mesh for p in shape.parts if not p.is_film]
    if film_mass > 0 and not films:
        raise ValueError("the shape has no film to hold this mass")
    if rest > 1e-9 * film_mass and not bodies:
        raise ValueError(f"the shape has no closed body to hold the {rest:g} kg beside: a bus, or give inertia")
    parts: list[tuple[float, np.ndarray, np.ndarray]] = []  # mass, centre, inertia about the origin
    if films:
        triangles = np.concatenate(films)
        found = elements_of(triangles)
        density = film_mass / float(found.area.sum())
        parts.append((film_mass, found.area @ found.centre / found.area.sum(), density * film_inertia(triangles)))
    volume = sum(abs(float(mesh.volume)) for mesh in bodies)
    for mesh in bodies:
        mass = rest * abs(float(mesh.volume)) / volume
        centre = np.asarray(mesh.center_mass, float)
        own = mass / float(mesh.volume) * np.asarray(mesh.moment_inertia, float)
        parts.append((mass, centre, own + shifted(mass, centre)))
    whole = sum(mass for mass, _, _ in parts)
    middle = np.asarray(sum(mass * centre for mass, centre, _ in parts) / whole)
    inertia = np.asarray(sum(matrix for _, _, matrix in parts)) - shifted(whole, middle)
    return MassProperties(inertia, middle)


def shifted(mass: float, by: np.ndarray) -> np.ndarray:
    """What a mass, kg, has more of inertia, kg m2, about a point `by` (3,) m from its centre."""
    return np.asarray(mass * (by @ by * np.eye(3) - np.outer(by, by)))
