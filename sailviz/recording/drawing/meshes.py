"""Shapes for the picture, numpy only: sails, tethers, boxes, spheres. No units; pure geometry, no drawing.

A craft stands in its own frame: +z is the sail's normal, away from the Sun, the film lies in x, y; a tether hangs to
-z.
"""

from __future__ import annotations

import json
import struct
from dataclasses import dataclass

import numpy as np

from sailviz.frames import unit


@dataclass(frozen=True)
class Mesh:
    """vertices (n, 3), faces (m, 3) counter-clockwise seen from outside, normals (n, 3)."""

    vertices: np.ndarray
    faces: np.ndarray
    normals: np.ndarray

    def moved(self, offset) -> Mesh:
        return Mesh(self.vertices + np.asarray(offset, float), self.faces, self.normals)

    def turned(self, rotation) -> Mesh:
        """rotation (3, 3)."""
        return Mesh(self.vertices @ rotation.T, self.faces, self.normals @ rotation.T)


def joined(meshes: list[Mesh]) -> Mesh:
    """Several meshes as one."""
    starts = np.cumsum([0, *(len(mesh.vertices) for mesh in meshes[:-1])])
    return Mesh(
        np.concatenate([mesh.vertices for mesh in meshes]),
        np.concatenate([mesh.faces + start for mesh, start in zip(meshes, starts, strict=True)]),
        np.concatenate([mesh.normals for mesh in meshes]),
    )


def with_normals(vertices, faces) -> Mesh:
    """Smooth normals: at each vertex the mean of its faces' normals, weighted by their areas."""
    vertices, faces = np.asarray(vertices, float), np.asarray(faces)
    corners = vertices[faces]
    face_normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals = np.zeros_like(vertices)
    for corner in range(3):
        np.add.at(normals, faces[:, corner], face_normals)
    return Mesh(vertices, faces, unit(normals))


def grid_faces(rows: int, columns: int) -> np.ndarray:
    """Two triangles for each cell of a grid of (rows + 1) x (columns + 1) vertices."""
    i, j = np.meshgrid(np.arange(rows), np.arange(columns), indexing="ij")
    a = (i * (columns + 1) + j).ravel()
    b = a + columns + 1
    return np.concatenate([np.stack([a, b, b + 1], 1), np.stack([a, b + 1, a + 1], 1)])


def about_z(angle: float) -> np.ndarray:
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])


def sphere(rows: int = 48, columns: int = 96):
    """Unit sphere with a seam at longitude 180 degrees -> Mesh, uv (n, 2), v down from the north pole."""
    latitude, longitude = np.meshgrid(
        np.linspace(np.pi / 2, -np.pi / 2, rows + 1), np.linspace(-np.pi, np.pi, columns + 1), indexing="ij"
    )
    vertices = np.stack(
        [np.cos(latitude) * np.cos(longitude), np.cos(latitude) * np.sin(longitude), np.sin(latitude)], -1
    ).reshape(-1, 3)
    uv = np.stack([(longitude + np.pi) / (2 * np.pi), (np.pi / 2 - latitude) / np.pi], -1).reshape(-1, 2)
    return Mesh(vertices, grid_faces(rows, columns), vertices), uv


def cap(half_angle: float, rows: int = 24, columns: int = 72, inner: float = 0.0) -> Mesh:
    """Part of the unit sphere within half_angle of +z and outside `inner`, rad."""
    polar, azimuth = np.meshgrid(
        np.linspace(inner, half_angle, rows + 1), np.linspace(0, 2 * np.pi, columns + 1), indexing="ij"
    )
    vertices = np.stack([np.sin(polar) * np.cos(azimuth), np.sin(polar) * np.sin(azimuth), np.cos(polar)], -1)
    vertices = vertices.reshape(-1, 3)
    return Mesh(vertices, grid_faces(rows, columns), vertices)


def annulus(inner: float, outer: float, rows: int = 2, columns: int = 180) -> Mesh:
    """Flat ring in x, y."""
    radius, azimuth = np.meshgrid(
        np.linspace(inner, outer, rows + 1), np.linspace(0, 2 * np.pi, columns + 1), indexing="ij"
    )
    vertices = np.stack([radius * np.cos(azimuth), radius * np.sin(azimuth), 0 * radius], -1).reshape(-1, 3)
    return Mesh(vertices, grid_faces(rows, columns), np.tile([0.0, 0.0, 1.0], (len(vertices), 1)))


def tube(bottom: float, top: float, radius_bottom: float, radius_top: float, columns: int = 24) -> Mesh:
    """Open cone or cylinder about z between two heights."""
    height, azimuth = np.meshgrid([bottom, top], np.linspace(0, 2 * np.pi, columns + 1), indexing="ij")
    radius = np.array([[radius_bottom], [radius_top]])
    vertices = np.stack([radius * np.cos(azimuth), radius * np.sin(azimuth), height], -1).reshape(-1, 3)
    faces = grid_faces(1, columns)[:, ::-1]
    outward = np.stack([np.cos(azimuth), np.sin(azimuth), 0 * azimuth], -1).reshape(-1, 3)
    slope = np.array([0.0, 0.0, (radius_bottom - radius_top) / (top - bottom)])
    return Mesh(vertices, faces, unit(outward + slope))


def cylinder(radius: float, bottom: float, top: float, columns: int = 24) -> Mesh:
    """Closed cylinder about z."""
    lid = annulus(0.0, radius, 1, columns)
    floor = Mesh(lid.vertices, lid.faces[:, ::-1], -lid.normals)
    return joined([tube(bottom, top, radius, radius, columns), lid.moved([0, 0, top]), floor.moved([0, 0, bottom])])


def rod(start, end, radius: float, columns: int = 10) -> Mesh:
    """Closed cylinder between two points."""
    start, end = np.asarray(start, float), np.asarray(end, float)
    z = unit(end - start)
    x = unit(np.cross(z, [0.0, 0.0, 1.0] if abs(z[2]) < 0.9 else [1.0, 0.0, 0.0]))
    return (
        cylinder(radius, 0.0, float(np.linalg.norm(end - start)), columns)
        .turned(np.stack([x, np.cross(z, x), z], 1))
        .moved(start)
    )


def box(size) -> Mesh:
    """Box about the origin with flat sides. size (3,)."""
    meshes = []
    for axis in range(3):
        for sign in (-1.0, 1.0):
            normal = sign * np.eye(3)[axis]
            u = np.eye(3)[(axis + 1) % 3]
            v = np.cross(normal, u)
            corners = np.array([normal - u - v, normal + u - v, normal + u + v, normal - u + v])
            meshes.append(Mesh(corners, np.array([[0, 1, 2], [0, 2, 3]]), np.tile(normal, (4, 1))))
    whole = joined(meshes)
    return Mesh(whole.vertices * np.asarray(size, float) / 2, whole.faces, whole.normals)


BILLOW = 0.06  # depth of the pillows as a fraction of the side
SCALLOP = 0.05  # how far the edges are drawn in


def film_point(u, v, a, b):
    """A point of one quadrant of a square sail of side 1 between the booms a and b. u, v (n,) >= 0, u + v <= 1 -> (n,
    3).

    A pillow (27 u v w is 1 in the middle) that pushes along +z, and an outer edge that hangs between the boom tips.
    """
    w = np.maximum(1 - u - v, 0)
    reach = np.maximum(u + v, 1e-9)
    drawn_in = 1 - SCALLOP * 4 * u * v / reach
    flat = (np.multiply.outer(u, a) + np.multiply.outer(v, b)) * drawn_in[..., None]
    depth = BILLOW * (27 * u * v * w * 0.9 + 4 * u * v * 0.35)
    return flat + np.multiply.outer(depth, [0.0, 0.0, 1.0])


def quadrants() -> list[tuple[np.ndarray, np.ndarray]]:
    """The boom ends of a square sail of side 1, in neighbouring pairs."""
    ends = [about_z(quarter * np.pi / 2) @ [np.sqrt(0.5), 0.0, 0.0] for quarter in range(4)]
    return [(ends[quarter], ends[(quarter + 1) % 4]) for quarter in range(4)]


def film(n: int = 14) -> Mesh:
    """The film of a square sail of side 1: four billowed quadrants between diagonal booms. +z is the dark side."""
    i, j = np.array([(i, j) for i in range(n + 1) for j in range(n + 1 - i)]).T
    number = {pair: k for k, pair in enumerate(zip(i.tolist(), j.tolist(), strict=True))}
    faces = [[number[p, q], number[p + 1, q], number[p, q + 1]] for p in range(n) for q in range(n - p)]
    faces += [[number[p + 1, q], number[p + 1, q + 1], number[p, q + 1]] for p in range(n) for q in range(n - p - 1)]
    return joined([with_normals(film_point(i / n, j / n, a, b), faces) for a, b in quadrants()])


def seams(rows: int = 5, n: int = 14) -> list[np.ndarray]:
    """Lines across the film, each (n + 1, 3), for a sail of side 1."""
    share = np.linspace(0, 1, n + 1)
    return [
        film_point(reach * (1 - share), reach * share, a, b)
        for a, b in quadrants()
        for reach in np.linspace(1 / rows, 1, rows)
    ]


def booms() -> Mesh:
    return joined([rod([0, 0, 0], end, 0.006) for end, _ in quadrants()])


def vanes() -> Mesh:
    """Steering vanes on the boom tips."""
    tip = np.sqrt(0.5)
    corners = np.array(
        [[tip, 0, 0], [tip * 1.055, tip * 0.028, tip * 0.016], [tip * 1.055, -tip * 0.028, -tip * 0.016]]
    )
    both = with_normals(np.concatenate([corners, corners]), [[0, 1, 2], [5, 4, 3]])
    return joined([both.turned(about_z(quarter * np.pi / 2)) for quarter in range(4)])


def spokes(count: int) -> np.ndarray:
    """Directions of `count` tethers in the plane of an E-sail, (count, 3)."""
    angle = np.linspace(0, 2 * np.pi, count, endpoint=False)
    return np.stack([np.cos(angle), np.sin(angle), 0 * angle], 1)


def spoke_quaternions(count: int) -> np.ndarray:
    """Rotations about z that lay the x axis along the tethers, xyzw (count, 4)."""
    half = np.linspace(0, np.pi, count, endpoint=False)
    return np.stack([0 * half, 0 * half, np.sin(half), np.cos(half)], 1)


def ring(points: int = 97) -> np.ndarray:
    """Unit circle in x, y, closed, (points, 3)."""
    angle = np.linspace(0, 2 * np.pi, points)
    return np.stack([np.cos(angle), np.sin(angle), 0 * angle], 1)


def textured_glb(mesh: Mesh, uv: np.ndarray, jpeg: bytes) -> bytes:
    """A binary glTF file of a mesh with a JPEG on it, unlit: a tenth of the size that Rerun needs for a raw texture.

    Normals of zero length keep the viewer from shading it with its own two lamps, which know nothing of the Sun.
    """
    arrays = [
        ("POSITION", np.ascontiguousarray(mesh.vertices, "<f4"), "VEC3", 5126, 34962),
        ("NORMAL", np.zeros(mesh.vertices.shape, "<f4"), "VEC3", 5126, 34962),
        ("TEXCOORD_0", np.ascontiguousarray(uv, "<f4"), "VEC2", 5126, 34962),
        ("indices", np.ascontiguousarray(mesh.faces.ravel(), "<u2"), "SCALAR", 5123, 34963),
    ]
    blob, views, accessors = b"", [], []
    for number, (_, values, kind, component, target) in enumerate(arrays):
        data = values.tobytes()
        views.append({"buffer": 0, "byteOffset": len(blob), "byteLength": len(data), "target": target})
        accessor = {"bufferView": number, "componentType": component, "count": len(values), "type": kind}
        if number == 0:
            accessor |= {"min": values.min(0).tolist(), "max": values.max(0).tolist()}
        accessors.append(accessor)
        blob += data
    views.append({"buffer": 0, "byteOffset": len(blob), "byteLength": len(jpeg)})
    blob += jpeg + b"\0" * (-len(jpeg) % 4)
    material = {"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}, "metallicFactor": 0, "roughnessFactor": 1}}
    document = {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [
            {"primitives": [{"attributes": {"POSITION": 0, "NORMAL": 1, "TEXCOORD_0": 2}, "indices": 3, "material": 0}]}
        ],
        "materials": [material],
        "textures": [{"source": 0}],
        "images": [{"bufferView": 4, "mimeType": "image/jpeg"}],
        "bufferViews": views,
        "accessors": accessors,
        "buffers": [{"byteLength": len(blob)}],
    }
    text = json.dumps(document, separators=(",", ":")).encode()
    text += b" " * (-len(text) % 4)
    size = 12 + 8 + len(text) + 8 + len(blob)
    return (
        struct.pack("<4sII", b"glTF", 2, size)
        + struct.pack("<I4s", len(text), b"JSON")
        + text
        + struct.pack("<I4s", len(blob), b"BIN\0")
        + blob
    )
