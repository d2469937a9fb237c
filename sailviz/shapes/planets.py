"""A planet of radius 1 with its map, as a binary glTF file. z is its axis, longitude 0 lies at x."""

from __future__ import annotations

import json
import struct
from typing import Any, BinaryIO

import numpy as np

from sailviz.shapes.primitives import Trimesh, sheet, trimesh

LONG, SHORT = 5125, 5123  # of whole numbers without a sign, as glTF calls them


class FlatMesh(Trimesh):
    """A mesh that no lamp shades: its normals have no length."""

    @property
    def vertex_normals(self) -> np.ndarray:
        """Zeros (n, 3). Without any, a viewer makes its own and shades by lamps that know nothing of the Sun."""
        return np.zeros(self.vertices.shape)


class StoredJpeg:
    """A JPEG file where trimesh wants a picture: it is kept byte for byte, since to decode and to encode it again
    takes time and loses sharpness."""

    format = "JPEG"

    def __init__(self, content: bytes):
        self._content = content

    def save(self, file: BinaryIO, format: str) -> None:
        """Write the file."""
        if format != self.format:
            raise ValueError(f"a JPEG is kept as it is, and cannot become {format}")
        file.write(self._content)

    def copy(self) -> StoredJpeg:
        """The same; nothing changes it."""
        return self


def mapped_ball(rows: int = 48, columns: int = 96) -> tuple[Trimesh, np.ndarray]:
    """Sphere of radius 1 with a seam at longitude 180 degrees -> mesh and its place on a map (n, 2): from west to east
    and from south to north, 0 to 1.
    """
    u, v = np.meshgrid(np.linspace(0, 1, columns + 1), np.linspace(0, 1, rows + 1))
    longitude, latitude = np.pi * (2 * u - 1), np.pi * (v - 0.5)
    across = np.cos(latitude)
    points = np.stack([across * np.cos(longitude), across * np.sin(longitude), np.sin(latitude)], -1)
    return sheet(points), np.stack([u, v], -1).reshape(-1, 2)


def globe(map_jpeg: bytes, rows: int = 48, columns: int = 96) -> bytes:
    """A binary glTF file of a planet, unlit, with a map from longitude -180 to 180 degrees, north up, as a JPEG.

    As a file because it takes a tenth of what a viewer needs for a raw texture.
    """
    ball, uv = mapped_ball(rows, columns)
    material = trimesh.visual.material.PBRMaterial(
        baseColorTexture=StoredJpeg(map_jpeg), metallicFactor=0.0, roughnessFactor=1.0
    )
    visual = trimesh.visual.TextureVisuals(uv=uv, material=material)
    mesh = FlatMesh(ball.vertices, ball.faces, visual=visual, process=False)
    content: bytes = trimesh.exchange.gltf.export_glb(mesh.scene(), include_normals=True)
    return short_indices(content)


def parts_of(glb: bytes) -> tuple[dict[str, Any], list[bytes]]:
    """What a binary glTF file says of itself, and the parts of its content, one for each of its views."""
    size = int.from_bytes(glb[12:16], "little")
    described, content = json.loads(glb[20 : 20 + size]), glb[20 + size + 8 :]
    return described, [content[view.get("byteOffset", 0) :][: view["byteLength"]] for view in described["bufferViews"]]


def joined(described: dict[str, Any], parts: list[bytes]) -> bytes:
    """A binary glTF file of such parts, whatever their lengths are now."""
    packed = b""
    for view, part in zip(described["bufferViews"], parts, strict=True):
        view |= {"byteOffset": len(packed), "byteLength": len(part)}
        packed += part + bytes(-len(part) % 4)
    described["buffers"][0]["byteLength"] = len(packed)
    text = json.dumps(described).encode()
    text += b" " * (-len(text) % 4)
    head = struct.pack("<4sII", b"glTF", 2, 12 + 8 + len(text) + 8 + len(packed)) + struct.pack(
        "<I4s", len(text), b"JSON"
    )
    return head + text + struct.pack("<I4s", len(packed), b"BIN\0") + packed


def short_indices(glb: bytes) -> bytes:
    """The same with corners counted in two bytes, of which trimesh takes four; up to 65,535 of them."""
    described, parts = parts_of(glb)
    for accessor in described["accessors"]:
        if accessor["componentType"] == LONG:
            view = accessor["bufferView"]
            corners = np.frombuffer(parts[view], np.uint32)
            if corners.max() < 0xFFFF:
                parts[view], accessor["componentType"] = corners.astype(np.uint16).tobytes(), SHORT
    return joined(described, parts)
