"""trimesh as the other shapes use it: closed and open bodies of revolution, boxes, rods, and several joined to one.

All shapes import trimesh from here, since what it names and no shape needs is put off. No units; pure geometry, no
drawing.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from sailviz.shapes.deferred import deferred

with deferred("trimesh", "scipy.spatial", "scipy.optimize", "scipy.ndimage", "scipy.sparse", "networkx", "lxml"):
    import trimesh
    from trimesh import Trimesh, creation

__all__ = [
    "Trimesh",
    "ball",
    "band",
    "box",
    "cap",
    "circle",
    "cylinder",
    "disc",
    "flat_sided",
    "inverted",
    "joined",
    "moved",
    "rod",
    "scaled",
    "sheet",
    "surface_of_revolution",
    "trimesh",
    "tube",
    "turned",
    "vertex_normals",
]


def joined(meshes: Sequence[Trimesh]) -> Trimesh:
    """Several meshes as one."""
    whole = trimesh.util.concatenate(list(meshes))
    assert isinstance(whole, Trimesh)  # as what is joined
    return whole


def moved(mesh: Trimesh, offset: ArrayLike) -> Trimesh:
    """A copy of a mesh, moved by `offset` (3,)."""
    copy = mesh.copy()
    copy.apply_translation(offset)
    return copy


def turned(mesh: Trimesh, angle: float) -> Trimesh:
    """A copy of a mesh, turned about z by an angle in rad."""
    copy = mesh.copy()
    copy.apply_transform(trimesh.transformations.rotation_matrix(angle, [0.0, 0.0, 1.0]))
    return copy


def scaled(mesh: Trimesh, factor: float) -> Trimesh:
    """A copy of a mesh, larger about the origin by a factor."""
    copy = mesh.copy()
    copy.apply_scale(factor)
    return copy


def inverted(mesh: Trimesh) -> Trimesh:
    """The mesh seen from its other side. trimesh's own `invert` keeps normals that it has worked out before."""
    return Trimesh(mesh.vertices, mesh.faces[:, ::-1], process=False)


def vertex_normals(mesh: Trimesh) -> np.ndarray:
    """Unit normals (n, 3) at the vertices: those of the faces around, weighted by their angles there.

    The numbers of trimesh's own `vertex_normals`, to the last bit, without the sparse matrices that it loads for them.
    """
    good = (mesh.face_normals**2).sum(axis=1) > 0.5  # the others are of faces without an area
    corners = mesh.faces[good].ravel()
    pulls = (mesh.face_angles[good][:, :, None] * mesh.face_normals[good][:, None, :]).reshape(-1, 3)
    sums = [np.bincount(corners, pulls[:, axis], len(mesh.vertices)) for axis in range(3)]
    return np.asarray(trimesh.util.unitize(np.stack(sums, axis=1)))


def flat_sided(mesh: Trimesh) -> Trimesh:
    """The same shape with corners that no two faces share, so that each face is shaded as the plane that it is."""
    copy = mesh.copy()
    copy.unmerge_vertices()
    return copy


def box(size: ArrayLike) -> Trimesh:
    """Box about the origin with flat sides. size : (3,)."""
    return flat_sided(creation.box(extents=size))


def surface_of_revolution(profile: ArrayLike, sections: int) -> Trimesh:
    """What a line (k, 2) of distances from the z axis and heights sweeps out; open where the line ends off the axis.

    Seen from outside where the line runs upwards.
    """
    return creation.revolve(np.asarray(profile, float), sections=sections, process=False)


def tube(bottom: float, top: float, radius_bottom: float, radius_top: float, sections: int = 24) -> Trimesh:
    """Open cone or cylinder about z between two heights."""
    return surface_of_revolution([[radius_bottom, bottom], [radius_top, top]], sections)


def disc(inner: float, outer: float, sections: int = 180) -> Trimesh:
    """Flat ring in x, y, seen from +z; a full disc for inner = 0."""
    return surface_of_revolution([[outer, 0.0], [inner, 0.0]], sections)


def cylinder(radius: float, bottom: float, top: float, sections: int = 24) -> Trimesh:
    """Closed cylinder about z, round on its side and flat on its lids."""
    lid = disc(0.0, radius, sections)
    floor = lid.copy()
    floor.invert()
    side = tube(bottom, top, radius, radius, sections)
    return joined([side, moved(lid, [0.0, 0.0, top]), moved(floor, [0.0, 0.0, bottom])])


def rod(start: ArrayLike, end: ArrayLike, radius: float, sections: int = 10) -> Trimesh:
    """Closed cylinder between two points (3,)."""
    ends = np.array([start, end], float)
    length = float(np.linalg.norm(ends[1] - ends[0]))
    body = cylinder(radius, -0.5 * length, 0.5 * length, sections)
    body.apply_transform(trimesh.geometry.align_vectors([0.0, 0.0, 1.0], ends[1] - ends[0]))
    return moved(body, ends.mean(axis=0))


def cap(half_angle: float, rows: int = 24, sections: int = 72, inner: float = 0.0, radius: float = 1.0) -> Trimesh:
    """Part of a sphere within `half_angle` of +z and outside `inner`, both rad."""
    polar = np.linspace(half_angle, inner, rows + 1)
    return surface_of_revolution(radius * np.stack([np.sin(polar), np.cos(polar)], 1), sections)


def ball(rows: int = 32, sections: int = 64, radius: float = 1.0) -> Trimesh:
    """Sphere."""
    return cap(np.pi, rows, sections, radius=radius)


def sheet(points: np.ndarray) -> Trimesh:
    """The surface through a grid of points (m, k, 3), one vertex each, the second index running fastest.

    It is seen from the side of the cross product of the steps along the second index and along the first.
    """
    m, k = points.shape[:2]
    number = np.arange(m * k).reshape(m, k)
    cells = np.stack([number[:-1, :-1], number[:-1, 1:], number[1:, 1:], number[1:, :-1]], -1).reshape(-1, 4)
    return Trimesh(points.reshape(-1, 3), trimesh.geometry.triangulate_quads(cells), process=False)


def band(angle: ArrayLike, radius: ArrayLike) -> Trimesh:
    """Part of the plane x, y between directions (m,) rad and distances (k,), as a sheet of m times k vertices."""
    directions, distances = np.asarray(angle, float), np.asarray(radius, float)
    x, y = np.outer(np.cos(directions), distances), np.outer(np.sin(directions), distances)
    return sheet(np.stack([x, y, 0 * x], -1))


def circle(points: int = 97) -> np.ndarray:
    """Closed line of radius 1 in x, y. (points, 3)"""
    angle = np.linspace(0, 2 * np.pi, points)
    return np.stack([np.cos(angle), np.sin(angle), 0 * angle], 1)
