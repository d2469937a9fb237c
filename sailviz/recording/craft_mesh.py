"""The craft of a recording as a mesh for other programs: Wavefront OBJ with its materials and textures, in m, in the
axes of the craft. What is seen there is what the recording shows: its meshes are read back, its lines become rods."""

from __future__ import annotations

import io
import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from sailviz.frames import rotation
from sailviz.recording.drawing import style
from sailviz.recording.entity import Entity
from sailviz.recording.reader import Recording
from sailviz.recording.recorded_run import craft_of
from sailviz.run.arrays import Craft

SHAPES = ("/sail/body/shape", "/world/rtn/body/shape", "/world/craft/body/shape")  # from close by first
FRONT, BACK = 2, 3  # Rerun's words for a mesh that is seen from one side
APART = 5e-4  # of the craft's size, between the two sides of a film, or one would shine through the other
ROD = 2e-3  # radius of what is drawn as a line, over the craft's size
SIDES = 3  # of such a rod
PIXELS = 512  # of a film's texture
SEAM = 3  # pixels
NOMINAL = {"solar-sail": 50.0, "electric-sail": 10_000.0}  # m, of a craft whose scene says no size; others: 1
SATELLITE = 0.15  # m, from the middle of a satellite to where its tether begins


@dataclass(frozen=True)
class Part:
    """One colour of a craft. corners (n, 3) m; normals (n, 3); faces (k, 3), fronts outwards; color (4,) 0 to 1;
    seams : lines (k, 3) m of the texture that lies on it along z, if it has one."""

    name: str
    corners: np.ndarray
    normals: np.ndarray
    faces: np.ndarray
    color: tuple[float, ...]
    seams: tuple[np.ndarray, ...] = ()


@dataclass(frozen=True)
class CraftMesh:
    """A craft in m. nominal : its scene says no size."""

    parts: tuple[Part, ...]
    nominal: bool

    @property
    def extent(self) -> float:
        """m, the longest side of the box about it."""
        corners = np.concatenate([part.corners for part in self.parts])
        return float(np.ptp(corners, axis=0).max())


def craft_mesh(recording: Recording) -> CraftMesh | None:
    """The craft that a recording shows, None where it shows a point."""
    root = next((root for root in SHAPES if root in recording), None)
    if root is None or "/scene" not in recording:
        return None
    scene = recording["/scene"]
    craft = craft_of({name: np.asarray(scene[name]) for name in scene}, recording.resolved)
    size, nominal = _size(craft)
    lines = {name: _strips(recording[name]) for name in _below(recording, root) if "strips" in recording[name]}
    seams = tuple(size * strip for strip in lines.pop(f"{root}/seams", []))
    parts = []
    for name in _below(recording, root):
        entity = recording[name]
        if "vertex_positions" in entity:
            parts.append(_mesh(entity, _word(name), size, seams if "/film_" in name else ()))
        elif name in lines:
            color = _color(entity["colors"])
            parts.append(_rods(_word(name), [size * strip for strip in lines[name]], ROD * size, color))
    if not parts:
        return None
    if craft.kind == "plasma-brake" and craft.tether_length:
        ends = np.array([[0.0, 0.0, -SATELLITE], [0.0, 0.0, -craft.tether_length]])
        parts.append(_rods("tether", [ends], ROD * craft.tether_length / 4, tuple(np.array(style.TETHER_BRAKE) / 255)))
    return CraftMesh(tuple(parts), nominal)


def _size(craft: Craft) -> tuple[float, bool]:
    """m of what is drawn as 1, and whether the scene does not say."""
    known = {"solar-sail": craft.side, "electric-sail": craft.tether_length}.get(craft.kind)
    if known is not None:
        return float(known), False
    return NOMINAL.get(craft.kind, 1.0), craft.kind in NOMINAL


def _below(recording: Recording, root: str) -> list[str]:
    return [name for name in recording.entities if name.startswith(f"{root}/")]


def _word(name: str) -> str:
    """A name of letters for a material."""
    return re.sub(r"\W+", "_", name.rsplit("/", 1)[-1], flags=re.ASCII)


def _strips(entity: Entity) -> list[np.ndarray]:
    return [np.array(strip, float) for strip in entity.arrow("strips").to_pylist()[0]]


def _color(packed: object) -> tuple[float, ...]:
    value = int(np.ravel(np.asarray(packed))[0])
    return tuple(((value >> shift) & 255) / 255 for shift in (24, 16, 8, 0))


def _mesh(entity: Entity, name: str, size: float, seams: tuple[np.ndarray, ...]) -> Part:
    corners = size * np.asarray(entity["vertex_positions"][0], float)
    faces = np.asarray(entity["triangle_indices"][0], np.int64)
    own = "vertex_normals" in entity
    normals = np.asarray(entity["vertex_normals"][0], float) if own else _normals(corners, faces)
    side = int(np.ravel(entity["face_rendering"])[0]) if "face_rendering" in entity else 0
    if side == BACK:
        faces, normals = faces[:, ::-1], -normals
    if side in (FRONT, BACK):
        corners = corners + APART * size * normals
    if "translations" in entity:
        corners, normals, faces = _instances(entity, size, corners, normals, faces)
    return Part(name, corners, normals, faces, _color(entity["albedo_factor"]), seams)


def _normals(corners: np.ndarray, faces: np.ndarray) -> np.ndarray:
    """(n, 3) of flat meshes, whose corners no two planes share."""
    a, b, c = (corners[faces[:, k]] for k in range(3))
    across = np.cross(b - a, c - a)
    found = np.zeros_like(corners)
    for k in range(3):
        np.add.at(found, faces[:, k], across)
    length = np.linalg.norm(found, axis=1, keepdims=True)
    return np.where(length > 0.0, found / np.where(length > 0.0, length, 1.0), [0.0, 0.0, 1.0])


def _instances(
    entity: Entity, size: float, corners: np.ndarray, normals: np.ndarray, faces: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """A mesh that stands in several places."""
    places = size * np.array(entity.arrow("translations").to_pylist()[0], float)
    turns = rotation(np.array(entity.arrow("quaternions").to_pylist()[0], float))
    count = len(corners)
    moved = np.einsum("kij,nj->kni", turns, corners) + places[:, None]
    turned = np.einsum("kij,nj->kni", turns, normals)
    numbers = faces[None] + count * np.arange(len(places))[:, None, None]
    return moved.reshape(-1, 3), turned.reshape(-1, 3), numbers.reshape(-1, 3)


def _rods(name: str, lines: Iterable[np.ndarray], radius: float, color: tuple[float, ...]) -> Part:
    """Lines as rods of three sides."""
    corners, normals, faces, count = [], [], [], 0
    around = 2 * np.pi * np.arange(SIDES) / SIDES
    for line in lines:
        for start, end in pairwise(line):
            along = end - start
            if not np.any(along):
                continue
            along = along / np.linalg.norm(along)
            x = np.cross(along, [1.0, 0.0, 0.0] if abs(along[0]) < 0.9 else [0.0, 1.0, 0.0])
            x = x / np.linalg.norm(x)
            out = np.outer(np.cos(around), x) + np.outer(np.sin(around), np.cross(along, x))
            corners += [start + radius * out, end + radius * out]
            normals += [out, out]
            near, far = count + np.arange(SIDES), count + SIDES + np.arange(SIDES)
            after = np.roll(near, -1)
            faces += [np.column_stack([near, after, far]), np.column_stack([after, np.roll(far, -1), far])]
            count += 2 * SIDES
    if not count:
        return Part(name, np.zeros((0, 3)), np.zeros((0, 3)), np.zeros((0, 3), int), color)
    return Part(name, np.concatenate(corners), np.concatenate(normals), np.concatenate(faces), (*color[:3], 1.0))


def obj_text(mesh: CraftMesh, library: str) -> str:
    """The mesh as Wavefront OBJ. library : the file of its materials."""
    lines = ["# The craft of a flight by sailviz, in m; z is its normal", f"mtllib {library}"]
    base = textures = 0
    half = 0.5 * mesh.extent
    for part in mesh.parts:
        lines += [f"g {part.name}", f"usemtl {part.name}"]
        lines += ["v {:.7g} {:.7g} {:.7g}".format(*corner) for corner in part.corners.tolist()]
        lines += ["vn {:.5f} {:.5f} {:.5f}".format(*normal) for normal in part.normals.tolist()]
        if part.seams:
            places = 0.5 + 0.5 * part.corners[:, :2] / half
            lines += ["vt {:.5f} {:.5f}".format(*place) for place in places.tolist()]
        for face in (part.faces + 1).tolist():
            words = (f"{base + k}/{textures + k if part.seams else ''}/{base + k}" for k in face)
            lines.append("f " + " ".join(words))
        base += len(part.corners)
        textures += len(part.corners) if part.seams else 0
    return "\n".join([*lines, ""])


def materials_text(mesh: CraftMesh) -> str:
    """The materials of the mesh: its colours, and of a film with seams its texture, NAME.png."""
    lines = ["# The colours of a craft of a flight by sailviz"]
    for part in mesh.parts:
        color = (1.0, 1.0, 1.0) if part.seams else part.color[:3]
        lines += [f"newmtl {part.name}", "Kd {:.4f} {:.4f} {:.4f}".format(*color), "Ks 0.1 0.1 0.1", "Ns 20", "illum 2"]
        lines += [f"d {part.color[3]:.4f}"] if part.color[3] < 1.0 else []
        lines += [f"map_Kd {part.name}.png"] if part.seams else []
    return "\n".join([*lines, ""])


def textures(mesh: CraftMesh) -> dict[str, bytes]:
    """PNG files by their names: the colour of a film with its seams, as seen along z."""
    from PIL import Image, ImageDraw

    found = {}
    for part in mesh.parts:
        if not part.seams:
            continue
        image = Image.new("RGB", (PIXELS, PIXELS), _bytes(part.color[:3]))
        pen = ImageDraw.Draw(image)
        for seam in part.seams:
            places = (0.5 + seam[:, :2] / mesh.extent) * [1, -1] + [0, 1]  # v runs upwards
            pen.line([tuple(place) for place in (places * PIXELS).tolist()], _bytes(np.array(style.SEAM) / 255), SEAM)
        stored = io.BytesIO()
        image.save(stored, "PNG", optimize=True)
        found[f"{part.name}.png"] = stored.getvalue()
    return found


def _bytes(color: Sequence[float] | np.ndarray) -> tuple[int, int, int]:
    red, green, blue = (round(255 * float(share)) for share in color[:3])
    return red, green, blue
