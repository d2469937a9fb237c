"""A shape that pushes: named parts of plane facets in body axes, their fronts known, and what light meets on them.

Body axes: +z away from the Sun for a craft that faces it, u = (0, 0, 1) the way that its sunlight travels then. A
facet's corners run right-handed about its front normal, which a film that faces the Sun has along -z. One shape is what
pushes and what is drawn. Lengths in m.
"""

from __future__ import annotations

import hashlib
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np

from sailviz.shapes.primitives import Trimesh, joined


class Coefficients(NamedTuple):
    """Force coefficients of one side of a surface: b1 along the light, b2 and b3 along the normal; thesis (3.17)."""

    b1: float
    b2: float
    b3: float


class Surface(NamedTuple):
    """Both sides of a film, or of a body that is closed the outside alone."""

    front: Coefficients
    back: Coefficients | None = None


@dataclass(frozen=True)
class Elements:
    """Plane pieces of a surface, k of them, or the points of a quadrature over a smooth one.

    centre (k, 3) m, normal (k, 3) unit vectors out of the front, area (k,) m2.
    """

    centre: np.ndarray
    normal: np.ndarray
    area: np.ndarray

    def __len__(self) -> int:
        return len(self.area)


@dataclass(frozen=True)
class Part:
    """A part of a shape, in m. mesh : its facets, fronts outwards; surface : what they are made of; smooth : of a film
    whose true surface is curved, the points of a quadrature over it."""

    name: str
    mesh: Trimesh
    surface: Surface
    smooth: Elements | None = None

    @property
    def is_film(self) -> bool:
        """Whether light may meet it from both sides."""
        return self.surface.back is not None

    @cached_property
    def elements(self) -> Elements:
        """Its facets, by their corners: exact for a plane facet, on which the pressure is the same everywhere."""
        return elements_of(self.mesh.triangles)

    @property
    def area(self) -> float:
        """m2, of one side."""
        return float(np.sum((self.smooth or self.elements).area))

    @property
    def is_flat(self) -> bool:
        """Whether all facets lie in one plane, and so cannot shade each other."""
        found, size = self.elements, float(np.ptp(self.mesh.vertices, axis=0).max())
        lifts = (found.centre - found.centre[0]) @ found.normal[0]
        return bool(np.all(np.abs(found.normal @ found.normal[0] - 1) < 1e-12) and np.all(np.abs(lifts) < 1e-9 * size))


@dataclass(frozen=True)
class Shape:
    """Parts in the same body axes. notes : what there was to say when it was made, in sentences."""

    parts: tuple[Part, ...]
    notes: tuple[str, ...] = field(default=(), compare=False)

    @cached_property
    def mesh(self) -> Trimesh:
        """All facets, part after part."""
        return joined([part.mesh for part in self.parts])

    @cached_property
    def elements(self) -> Elements:
        """All facets, part after part."""
        found = [part.elements for part in self.parts]
        return Elements(
            np.concatenate([each.centre for each in found]),
            np.concatenate([each.normal for each in found]),
            np.concatenate([each.area for each in found]),
        )

    @cached_property
    def part_of(self) -> np.ndarray:
        """Number of the part that each facet belongs to, (k,)."""
        return np.repeat(np.arange(len(self.parts)), [len(part.elements) for part in self.parts])

    @property
    def film_area(self) -> float:
        """m2 of films, one side; of a shape without films, of all facets."""
        films = [part.area for part in self.parts if part.is_film]
        return sum(films) if films else float(np.sum(self.elements.area))

    @property
    def size(self) -> float:
        """Longest side of the box around it, m."""
        return float(np.ptp(self.mesh.vertices, axis=0).max())

    @property
    def steepest(self) -> float:
        """Sine of the largest angle between a film's normal and the z axis."""
        slopes = [np.sqrt(np.maximum(0.0, 1 - part.elements.normal[:, 2] ** 2)).max() for part in self.films]
        return float(max(slopes, default=1.0))

    @property
    def films(self) -> list[Part]:
        """The parts that light may meet from both sides."""
        return [part for part in self.parts if part.is_film]

    def digest(self) -> str:
        """Hash of facets and surfaces, 16 hexadecimal digits."""
        found = hashlib.sha256()
        for part in self.parts:
            found.update(repr((part.name, part.surface)).encode())
            found.update(np.ascontiguousarray(part.mesh.triangles, "<f8").tobytes())
            if part.smooth is not None:
                for values in (part.smooth.centre, part.smooth.normal, part.smooth.area):
                    found.update(np.ascontiguousarray(values, "<f8").tobytes())
        return found.hexdigest()[:16]


def elements_of(triangles: np.ndarray) -> Elements:
    """Elements of triangles (k, 3, 3), m."""
    across = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    double = np.linalg.norm(across, axis=1)
    return Elements(triangles.mean(axis=1), across / double[:, None], 0.5 * double)


def film_inertia(triangles: np.ndarray) -> np.ndarray:
    """Inertia of a film about the origin for 1 kg/m2, m4, (3, 3): exact for plane triangles (k, 3, 3) m."""
    found = elements_of(triangles)
    outer = np.einsum("kvi,kvj->kij", triangles, triangles) + 9 * np.einsum("ki,kj->kij", found.centre, found.centre)
    second = np.einsum("k,kij->ij", found.area / 12, outer)
    return np.asarray(np.trace(second) * np.eye(3) - second)


def subdivided(shape: Shape, share: float = 1e-4, limit: int = 200_000) -> Shape:
    """A shape whose films have no facet larger than a share of all films' area, so that a shadow's edge, which is as
    wide as a facet, costs no more. limit : of the facets of all parts; no film is divided beyond it."""
    largest, parts = share * shape.film_area, list(shape.parts)
    for at, part in enumerate(parts):
        mesh = part.mesh
        while part.is_film and mesh.area_faces.max() > largest:
            if sum(len(each.mesh.faces) for each in parts) + 3 * int(np.sum(mesh.area_faces > largest)) > limit:
                break
            mesh = halved(mesh, mesh.area_faces > largest)
            parts[at] = replace(part, mesh=mesh)
    return replace(shape, parts=tuple(parts))


def halved(mesh: Trimesh, chosen: np.ndarray) -> Trimesh:
    """A mesh whose chosen facets (k,) bool are each cut into four at the middles of their sides."""
    a, b, c = np.moveaxis(mesh.triangles[chosen], 1, 0)
    ab, bc, ca = (a + b) / 2, (b + c) / 2, (c + a) / 2
    new = np.stack([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]).transpose(2, 0, 1, 3).reshape(-1, 3, 3)
    corners = np.concatenate([mesh.triangles[~chosen], new]).reshape(-1, 3)
    return Trimesh(corners, np.arange(len(corners)).reshape(-1, 3), process=False)
