"""A craft's own mesh as it is drawn: from a file, from trimesh or a `Shape`, in m in body axes. It pushes nothing here,
so that it need not be closed, nor wound one way, and may be seen from both sides.
"""

from __future__ import annotations

import hashlib
import os
from typing import NamedTuple

import numpy as np

from sailviz.shapes import file_checks
from sailviz.shapes.facets import Shape
from sailviz.shapes.file_checks import ShapeError
from sailviz.shapes.own_files import FRONTS, UNITS, check_size, read_meshes, towards_sun
from sailviz.shapes.primitives import Trimesh, inverted, joined, trimesh
from sailviz.words import nearest, shown

SQUARE = 0.5  # of the area of a film that faces one way; what is bent more is a body
OwnMesh = str | os.PathLike[str] | Trimesh | trimesh.Scene | Shape


class SeenPart(NamedTuple):
    """A part of a craft. film : it has a lit and a dark side, its front along -z."""

    name: str
    mesh: Trimesh
    film: bool


class SeenMesh(NamedTuple):
    """What is drawn of a craft. size : its longest side, m."""

    parts: tuple[SeenPart, ...]
    size: float

    def told(self) -> dict[str, object]:
        """What a recording says of it: digest, number of facets, and the corners of the box around it, m."""
        corners = np.concatenate([part.mesh.vertices for part in self.parts])
        found = hashlib.sha256()
        for part in self.parts:
            found.update(repr((part.name, part.film)).encode())
            found.update(np.ascontiguousarray(part.mesh.triangles, "<f8").tobytes())
        return {
            "digest": found.hexdigest()[:16],
            "facets": int(sum(len(part.mesh.faces) for part in self.parts)),
            "low_m": corners.min(axis=0).tolist(),
            "high_m": corners.max(axis=0).tolist(),
        }


def seen_mesh(mesh: OwnMesh, unit: str | None = None, front: str | None = None) -> SeenMesh:
    """The parts of a craft to be drawn.

    mesh : the path of an STL, OBJ, GLB, PLY or 3MF file, a mesh or a scene of trimesh, or a `Shape`, which is in m in
    body axes already. unit : in which it counts, one of UNITS; GLB and 3MF files say it themselves. front : the axis
    of the mesh that points to the Sun when the craft faces it, which is -z of the body and the default. ShapeError, in
    a sentence, for what is none of these, is cut or damaged, or says of itself what is not so.
    """
    if isinstance(mesh, Shape):
        if unit is not None or front is not None:
            raise ShapeError("a Shape is in m and in body axes: leave unit and front out")
        return _seen({part.name: (part.mesh, part.is_film) for part in mesh.parts}, "the shape")
    if front is not None and front not in FRONTS:
        raise ShapeError(f"{shown(front)} is no side that a front may face: {', '.join(FRONTS)}")
    if isinstance(mesh, str | os.PathLike):
        meshes, factor, name = read_meshes(mesh, unit)
    elif isinstance(mesh, Trimesh | trimesh.Scene):
        meshes, factor, name = _given(mesh), _factor(unit), "the mesh"
    else:
        kind = type(mesh).__name__
        raise ShapeError(f"a mesh is the path of a file, a mesh or a scene of trimesh, or a Shape, not {kind}")
    turn = factor * towards_sun(front or "-z")
    found = {}
    for part, corners in meshes.items():
        file_checks.facets(len(corners.faces), name)
        placed = _placed(corners, turn, part, name)
        if placed is not None:
            found[part] = placed
    if not found:
        raise ShapeError(f"{shown(name)} holds no facets that have an area")
    check_size({part: placed for part, (placed, _) in found.items()}, name, unit)
    return _seen(found, name)


def _seen(parts: dict[str, tuple[Trimesh, bool]], name: str) -> SeenMesh:
    file_checks.facets(sum(len(mesh.faces) for mesh, _ in parts.values()), name)
    corners = np.concatenate([mesh.vertices for mesh, _ in parts.values()])
    seen = tuple(SeenPart(part, mesh, film) for part, (mesh, film) in parts.items())
    return SeenMesh(seen, float(np.ptp(corners, axis=0).max()))


def _given(mesh: Trimesh | trimesh.Scene) -> dict[str, Trimesh]:
    """The parts of what trimesh holds."""
    if isinstance(mesh, Trimesh):
        return {"mesh": mesh}
    found: dict[str, list[Trimesh]] = {}
    for node in mesh.graph.nodes_geometry:
        transform, geometry = mesh.graph[node]
        part = mesh.geometry[geometry]
        if isinstance(part, Trimesh):
            placed = Trimesh(part.vertices, part.faces, process=False)
            placed.apply_transform(transform)
            found.setdefault(str(geometry), []).append(placed)
    return {part: joined(meshes) for part, meshes in found.items()}


def _factor(unit: str | None) -> float:
    if unit is None:
        raise ShapeError(f"a mesh of trimesh has no unit of its own: say whether it counts in {', '.join(UNITS)}")
    if unit not in UNITS:
        raise ShapeError(f"{shown(unit)} is no unit of length here. {nearest(unit, UNITS)}")
    return UNITS[unit]


def _placed(mesh: Trimesh, turn: np.ndarray, part: str, name: str) -> tuple[Trimesh, bool] | None:
    """A part in m in body axes, without facets that have no area, and whether it is a film; None where none has."""
    if not np.all(np.isfinite(mesh.vertices)):
        raise ShapeError(f"{shown(name)}: a corner of the part {shown(part)} is not a finite number")
    if len(mesh.faces) and (mesh.faces.min() < 0 or mesh.faces.max() >= len(mesh.vertices)):
        raise ShapeError(f"{shown(name)}: a facet of the part {shown(part)} names a corner that there is not")
    corners = np.asarray(mesh.vertices, float) @ turn.T
    a, b, c = np.moveaxis(corners[mesh.faces], 1, 0)
    wide = np.linalg.norm(np.cross(b - a, c - a), axis=1) > 1e-10 * np.ptp(corners, axis=0).max() ** 2
    if not wide.any():
        return None
    clean = Trimesh(corners, mesh.faces[wide], process=False)
    clean.merge_vertices()
    clean.remove_unreferenced_vertices()
    if clean.is_watertight:
        return (inverted(clean) if clean.is_winding_consistent and clean.volume < 0 else clean), False
    facing = float(np.sum(clean.area_faces * clean.face_normals[:, 2]))
    if not clean.is_winding_consistent or abs(facing) < SQUARE * clean.area:
        return clean, False
    return (inverted(clean) if facing > 0 else clean), True
