"""Shapes from files of one's own: STL, OBJ, GLB, PLY and 3MF, read by trimesh after a look at what they claim.

Units: a GLB file counts in metres and a 3MF file says its unit; of the others it has to be said. GLB has +y up by its
standard, which is not turned here: `front`, an axis of the file, says where the front of the films faces, and that axis
becomes -z of the body, towards the Sun. Textures are not read.
"""

from __future__ import annotations

import io
import os
import stat
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from sailviz.shapes import file_checks
from sailviz.shapes.facets import Part, Shape, Surface
from sailviz.shapes.file_checks import ShapeError
from sailviz.shapes.primitives import Trimesh, inverted, joined, trimesh
from sailviz.words import nearest, shown

UNITS = {"m": 1.0, "cm": 0.01, "mm": 1e-3, "in": 0.0254, "ft": 0.3048, "km": 1e3}
OF_3MF = {"micron": 1e-6, "millimeter": 1e-3, "centimeter": 1e-2, "inch": 0.0254, "foot": 0.3048, "meter": 1.0}
FRONTS = ("+x", "-x", "+y", "-y", "+z", "-z")
SMALLEST, LARGEST = 0.1, 2000.0  # m: what a sail measures, so that a wrong unit is noticed
FORMATS = {".stl": "stl", ".obj": "obj", ".glb": "glb", ".ply": "ply", ".3mf": "3mf"}


@dataclass(frozen=True)
class FileParts:
    """What a file holds: meshes in m in body axes by the names of their parts, and what there is to say of them."""

    name: str
    meshes: dict[str, Trimesh]
    notes: tuple[str, ...]

    def closed(self, part: str) -> bool:
        """Whether a part is closed all round, and so meets light from outside alone."""
        return bool(self.meshes[part].is_watertight)


def read_parts(path: str | os.PathLike[str], unit: str | None = None, front: str = "-z") -> FileParts:
    """The parts of a file. unit : of UNITS, for STL, OBJ and PLY, which have none; front : of FRONTS. ShapeError."""
    _check_front(front)
    meshes, factor, name, notes = _read(path, unit)
    turn = factor * towards_sun(front)
    found = {}
    for part, mesh in meshes.items():
        found[part], said = _cleaned(mesh, turn, part, name)
        notes += said
    check_size(found, name, unit)
    return FileParts(name, found, tuple(notes))


def read_meshes(path: str | os.PathLike[str], unit: str | None) -> tuple[dict[str, Trimesh], float, str]:
    """The meshes of a file by the names of their parts, in its own axes; metres in its unit; its name. ShapeError."""
    return _read(path, unit)[:3]


def _check_front(front: str) -> None:
    if front not in FRONTS:
        raise ShapeError(f"{shown(front)} is no side that a front may face: {', '.join(FRONTS)}")


def _read(path: str | os.PathLike[str], unit: str | None) -> tuple[dict[str, Trimesh], float, str, list[str]]:
    """(meshes in the file's own axes and unit, metres in it, name of the file, what there is to say)"""
    file = Path(path)
    name = file.name
    kind = FORMATS.get(file.suffix.lower())
    if kind is None:
        raise ShapeError(f"{shown(name)} is no file of facets: its ending has to be one of {', '.join(FORMATS)}")
    if unit is not None and unit not in UNITS:
        raise ShapeError(f"{shown(unit)} is no unit of length here. {nearest(unit, UNITS)}")
    content = _content(file)
    factor = _factor(kind, content, name, unit)
    if kind == "obj":
        file_checks.materials(file, name, content)
    meshes, notes = _meshes(kind, content, name)
    file_checks.facets(sum(len(mesh.faces) for mesh in meshes.values()), name)
    return meshes, factor, name, notes


def _content(file: Path) -> bytes:
    """Bytes of a regular file, not more of them than may be."""
    try:
        handle = os.open(file, os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0))
        with open(handle, "rb") as stream:
            facts = os.fstat(handle)
            if not stat.S_ISREG(facts.st_mode):
                raise ShapeError(f"{shown(str(file))} is not a regular file")
            file_checks.size(facts.st_size, file.name)
            return stream.read(file_checks.LARGEST_FILE)
    except OSError as error:
        raise ShapeError(f"{shown(str(file))} cannot be read: {(error.strerror or str(error)).lower()}") from None


def _factor(kind: str, content: bytes, name: str, unit: str | None) -> float:
    """Metres in the file's unit."""
    if kind == "3mf":
        own = file_checks.threemf(content, name)
        if own not in OF_3MF:
            raise ShapeError(f"{shown(name)} counts in {shown(own)}, which is no unit of 3MF")
        if unit is not None and UNITS[unit] != OF_3MF[own]:
            raise ShapeError(f"{shown(name)} says itself that it counts in {own}, not in {unit}: leave the unit out")
        return OF_3MF[own]
    checks: dict[str, Callable[[bytes, str], None]] = {
        "stl": file_checks.stl,
        "obj": file_checks.obj,
        "ply": file_checks.ply,
        "glb": file_checks.glb,
    }
    checks[kind](content, name)
    if kind == "glb":
        if unit not in (None, "m"):
            raise ShapeError(f"{shown(name)} counts in metres, as every GLB file, not in {unit}: leave the unit out")
        return 1.0
    if unit is None:
        raise ShapeError(f"{shown(name)} has no unit of its own: say whether it counts in {', '.join(UNITS)}")
    return UNITS[unit]


def _meshes(kind: str, content: bytes, name: str) -> tuple[dict[str, Trimesh], list[str]]:
    """Meshes by the names of their parts, in the file's own axes and unit, and what there is to say."""
    options: dict[str, Any] = {"split_objects": True, "group_material": False} if kind == "obj" else {}
    try:
        scene = trimesh.load_scene(io.BytesIO(content), file_type=kind, process=False, **options)
        found: dict[str, list[Trimesh]] = {}
        passed = 0
        for node in scene.graph.nodes_geometry:
            transform, geometry = scene.graph[node]
            mesh = scene.geometry[geometry]
            if not isinstance(mesh, Trimesh):
                passed += 1
                continue
            placed = Trimesh(mesh.vertices, mesh.faces, process=False)
            placed.apply_transform(transform)
            found.setdefault(_part_name(str(geometry), name, kind), []).append(placed)
    except ModuleNotFoundError as error:
        raise ShapeError(
            f"{shown(name)} needs {error.name}, which is not installed: pip install 'sailviz[shapes]'"
        ) from None
    except MemoryError:
        raise ShapeError(f"{shown(name)} wants more memory than there is") from None
    except Exception as error:  # trimesh raises whatever its readers do on what is damaged
        why = str(error).splitlines()[0][:120] if str(error) else type(error).__name__
        raise ShapeError(f"{shown(name)} cannot be read as {kind.upper()}: {why}") from None
    if not found or not any(len(mesh.faces) for meshes in found.values() for mesh in meshes):
        raise ShapeError(f"{shown(name)} holds no facets")
    notes = [f"{passed} of its objects are not made of facets and are left out"] if passed else []
    whole = {part: joined(meshes) for part, meshes in found.items()}
    return {part: mesh for part, mesh in whole.items() if len(mesh.faces)}, notes


def _part_name(geometry: str, file: str, kind: str) -> str:
    """A part's name; of a file that names none, "film"."""
    nameless = kind in ("stl", "ply") or geometry in (file, f"{kind}_0") or geometry.startswith("geometry_")
    return "film" if nameless else geometry


def towards_sun(front: str) -> np.ndarray:
    """A rotation (3, 3) that lays an axis of the file along -z."""
    axis, sign = "xyz".index(front[1]), 1.0 if front[0] == "+" else -1.0
    z = np.zeros(3)
    z[axis] = -sign
    x = np.zeros(3)
    x[(axis + 1) % 3] = 1.0
    if axis == 2:  # x stays x
        x = np.array([1.0, 0.0, 0.0])
    return np.stack([x, np.cross(z, x), z])


def _cleaned(mesh: Trimesh, turn: np.ndarray, part: str, name: str) -> tuple[Trimesh, list[str]]:
    """A mesh in m in body axes without facets that have no area, its front outwards; and what there is to say."""
    if not np.all(np.isfinite(mesh.vertices)):
        raise ShapeError(f"{shown(name)}: a corner of the part {shown(part)} is not a finite number")
    if len(mesh.faces) and (mesh.faces.min() < 0 or mesh.faces.max() >= len(mesh.vertices)):
        raise ShapeError(f"{shown(name)}: a facet of the part {shown(part)} names a corner that there is not")
    corners = (mesh.vertices @ turn.T)[mesh.faces]
    sides = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max(axis=1)
    area = 0.5 * np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    good = area > 1e-10 * np.maximum(sides, 1e-300) ** 2
    notes = []
    if not np.all(good):
        notes.append(f"{np.sum(~good)} facets of {shown(part)} without an area are dropped")
    if not np.any(good):
        raise ShapeError(f"{shown(name)}: no facet of the part {shown(part)} has an area")
    clean = Trimesh(mesh.vertices @ turn.T, mesh.faces[good], process=False)
    clean.merge_vertices()
    clean.remove_unreferenced_vertices()
    if clean.is_watertight:
        if not clean.is_winding_consistent or clean.volume < 0:
            raise ShapeError(f"{shown(name)}: the part {shown(part)} is inside out: turn its facets round")
        return clean, notes
    if not clean.is_winding_consistent:
        raise ShapeError(
            f"{shown(name)}: neighbouring facets of {shown(part)} face opposite ways: turn some of them round"
        )
    facing = float(np.sum(clean.area_faces * clean.face_normals[:, 2]))
    if abs(facing) < 1e-3 * clean.area:
        raise ShapeError(f"{shown(name)}: the part {shown(part)} shows no side to the front that is said")
    if facing > 0:
        clean = inverted(clean)
        notes.append(f"the front of {shown(part)} is the back of its facets, by the front that is said")
    return clean, notes


def check_size(meshes: Mapping[str, Trimesh], name: str, unit: str | None) -> None:
    """A size that a craft may have, or the unit was wrong."""
    corners = np.concatenate([mesh.vertices for mesh in meshes.values()])
    size = float(np.ptp(corners, axis=0).max())
    if not SMALLEST <= size <= LARGEST:
        word = f" counted in {unit}" if unit else ""
        raise ShapeError(
            f"{shown(name)} measures {size:.4g} m{word}: a shape from a file is {SMALLEST:g} to {LARGEST:g} m long, "
            "so its unit must be another"
        )


def shape_of(parts: FileParts, surfaces: Mapping[str, Surface]) -> Shape:
    """A Shape of a file's parts. surfaces : of every part by its name; ShapeError where one is missing or not there,
    and where a part that is not closed has no back."""
    for part in surfaces:
        if part not in parts.meshes:
            raise ShapeError(f"{shown(parts.name)} has no part {shown(part)}. {nearest(part, parts.meshes)}")
    found = []
    for part, mesh in parts.meshes.items():
        if part not in surfaces:
            raise ShapeError(f"{shown(parts.name)} has a part {shown(part)}: say what it is made of")
        surface = surfaces[part]
        if surface.back is None and not parts.closed(part):
            raise ShapeError(
                f"{shown(parts.name)}: the part {shown(part)} is not closed, so light meets its back: say it"
            )
        if parts.closed(part):
            surface = replace_back(surface)
        found.append(Part(part, mesh, surface))
    return Shape(tuple(found), parts.notes)


def replace_back(surface: Surface) -> Surface:
    """The outside of a closed body."""
    return surface._replace(back=None)
