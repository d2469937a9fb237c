"""Files of facets: what they hold, and what is refused in one sentence."""

import json
import os
import struct
import zipfile
from pathlib import Path

import numpy as np
import pytest
import trimesh

from sailviz.shapes import membranes, structures
from sailviz.shapes.facets import Coefficients, Surface
from sailviz.shapes.file_checks import ShapeError
from sailviz.shapes.own_files import FRONTS, read_parts, shape_of
from sailviz.shapes.primitives import Trimesh, inverted

B = Coefficients(0.0723, 0.8554, -0.0030)
FILM, BUS = Surface(B, B), Surface(Coefficients(0.5, 0.0, 0.0))


def sail() -> Trimesh:
    return membranes.square(10.0, FILM, np.radians(3), 0.03, rows=4).mesh


def two_parts() -> trimesh.Scene:
    scene = trimesh.Scene()
    scene.add_geometry(sail(), geom_name="film")
    scene.add_geometry(structures.bus([1, 1, 1], [0, 0, -2], BUS.front).mesh, geom_name="bus")
    return scene


def written(folder: Path, name: str, what: Trimesh | trimesh.Scene) -> Path:
    what.export(str(folder / name))
    return folder / name


@pytest.mark.parametrize(("name", "unit"), [("a.glb", None), ("a.obj", "m"), ("a.3mf", None)])
def test_files_with_parts_keep_their_names_and_sizes(tmp_path, name, unit):
    if name.endswith("3mf"):
        pytest.importorskip("lxml")
        pytest.importorskip("networkx")
    scene = two_parts()
    if name.endswith("3mf"):
        scene.apply_scale(1000)  # 3MF counts in millimetres
    shape = shape_of(read_parts(written(tmp_path, name, scene), unit), {"film": FILM, "bus": BUS})
    assert sorted(part.name for part in shape.parts) == ["bus", "film"]
    film = next(part for part in shape.parts if part.name == "film")
    assert film.area == pytest.approx(float(sail().area), rel=1e-6)
    assert np.all(film.elements.normal[:, 2] < 0)
    assert next(part for part in shape.parts if part.name == "bus").area == pytest.approx(6, rel=1e-6)


@pytest.mark.parametrize("name", ["a.stl", "a.ply"])
@pytest.mark.parametrize(("unit", "factor"), [("m", 1.0), ("mm", 1e3), ("in", 1 / 0.0254), ("cm", 100.0)])
def test_files_without_a_unit_are_of_the_unit_that_is_said(tmp_path, name, unit, factor):
    mesh = sail()
    mesh.apply_scale(factor)
    parts = read_parts(written(tmp_path, name, mesh), unit)
    assert list(parts.meshes) == ["film"]
    assert parts.meshes["film"].area == pytest.approx(float(sail().area), rel=1e-5)


@pytest.mark.parametrize("name", ["a.stl", "a.ply", "a.obj"])
def test_a_file_without_a_unit_needs_one(tmp_path, name):
    with pytest.raises(ShapeError, match="has no unit of its own: say whether it counts in m, cm, mm, in, ft, km"):
        read_parts(written(tmp_path, name, sail()))


@pytest.mark.parametrize("front", FRONTS)
def test_the_front_that_is_said_looks_at_the_sun(tmp_path, front):
    """A sail built to face any axis of the file is the same sail."""
    mesh = sail()
    axis, sign = "xyz".index(front[1]), 1.0 if front[0] == "+" else -1.0
    towards = np.zeros(3)
    towards[axis] = sign
    mesh.apply_transform(trimesh.geometry.align_vectors([0, 0, -1], towards))
    parts = read_parts(written(tmp_path, "a.ply", mesh), "m", front)
    found = parts.meshes["film"]
    assert parts.notes == ()
    assert np.all(found.face_normals[:, 2] < 0)
    assert np.ptp(found.vertices[:, 2]) == pytest.approx(np.ptp(sail().vertices[:, 2]), rel=1e-5)
    assert found.vertices[:, 2].max() > 0.1  # blown downwind still


def test_a_film_wound_the_other_way_is_turned_and_that_is_said(tmp_path):
    mesh = inverted(sail())
    parts = read_parts(written(tmp_path, "a.stl", mesh), "m")
    assert np.all(parts.meshes["film"].face_normals[:, 2] < 0)
    assert any("is the back of its facets" in note for note in parts.notes)


def test_facets_without_an_area_are_dropped_and_counted(tmp_path):
    mesh = sail()
    mesh.faces = np.vstack([mesh.faces, [[0, 0, 1], [2, 3, 3]]])
    parts = read_parts(written(tmp_path, "a.ply", mesh), "m")
    assert "2 facets of 'film' without an area are dropped" in " ".join(parts.notes).replace('"', "'")


def refused(path: Path, words: str, unit: str | None = None, front: str = "-z") -> None:
    with pytest.raises(ShapeError, match=words) as told:
        read_parts(path, unit, front)
    assert "\n" not in str(told.value)
    assert len(str(told.value)) < 400


@pytest.mark.parametrize(("factor", "unit"), [(1.0, "mm"), (1e3, "m"), (1.0, "km")])
def test_a_wrong_unit_is_seen_by_the_size(tmp_path, factor, unit):
    mesh = sail()
    mesh.apply_scale(factor)
    refused(written(tmp_path, "a.stl", mesh), "so its unit must be another", unit)


def test_a_unit_against_the_files_own_is_refused(tmp_path):
    refused(written(tmp_path, "a.glb", two_parts()), "counts in metres", "mm")
    refused(written(tmp_path, "a.3mf", two_parts()), "says itself that it counts in millimeter", "m")
    refused(written(tmp_path, "a.stl", sail()), "is no unit of length here", "parsec")


def test_a_body_that_is_inside_out_is_refused(tmp_path):
    scene = two_parts()
    scene.geometry["bus"] = inverted(scene.geometry["bus"])
    refused(written(tmp_path, "a.glb", scene), "the part .bus. is inside out")


def test_a_film_whose_facets_disagree_is_refused(tmp_path):
    mesh = sail()
    mesh.faces[::2] = mesh.faces[::2, ::-1]
    refused(written(tmp_path, "a.ply", mesh), "face opposite ways", "m")


def test_a_side_that_the_film_does_not_show_is_refused(tmp_path):
    flat = membranes.square(10.0, FILM, rows=2).mesh
    refused(written(tmp_path, "a.stl", flat), "shows no side to the front", "m", "+x")
    refused(written(tmp_path, "b.stl", flat), "is no side that a front may face", "m", "up")


def test_corners_that_are_no_numbers_are_refused(tmp_path):
    mesh = sail()
    vertices = mesh.vertices.copy()
    vertices[3, 1] = np.nan
    bad = Trimesh(vertices, mesh.faces, process=False)
    for name in ("a.ply", "a.glb"):
        refused(written(tmp_path, name, bad), "not a finite number|cannot be read", "m" if name == "a.ply" else None)
    triangle = struct.pack("<12fH", 0, 0, -1, 0, 0, 0, float("nan"), 5, 0, 5, 0, 0, 0)
    (tmp_path / "n.stl").write_bytes(b" " * 80 + struct.pack("<I", 1) + triangle)
    refused(tmp_path / "n.stl", "not a finite number|holds no facets|no facet", "m")


@pytest.mark.parametrize("claimed", [1_000_000, 2**32 - 1])
def test_a_million_facets_are_refused_before_they_are_read(tmp_path, claimed):
    (tmp_path / "a.stl").write_bytes(b" " * 80 + struct.pack("<I", claimed) + b"\0" * 100)
    refused(tmp_path / "a.stl", f"has {claimed} facets, more than 200000: decimate it", "m")
    (tmp_path / "a.ply").write_text(f"ply\nformat ascii 1.0\nelement vertex 3\nelement face {claimed}\nend_header\n")
    refused(tmp_path / "a.ply", "more than 200000: decimate it", "m")


def test_a_million_facets_of_text_are_refused(tmp_path):
    (tmp_path / "a.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\n" + "f 1 2 3\n" * 1_000_000)
    refused(tmp_path / "a.obj", "has 1000000 facets", "m")


def test_a_zip_bomb_is_refused_unopened(tmp_path):
    with zipfile.ZipFile(tmp_path / "a.3mf", "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("3D/3dmodel.model", b" " * 250_000_000)
    assert (tmp_path / "a.3mf").stat().st_size < 1_000_000
    refused(tmp_path / "a.3mf", "unpacks to 250 MB")
    with zipfile.ZipFile(tmp_path / "b.3mf", "w") as archive:
        for i in range(2000):
            archive.writestr(f"{i}.txt", b"")
    refused(tmp_path / "b.3mf", "in 2000 files")


def test_entities_in_a_3mf_file_are_refused(tmp_path):
    bomb = '<?xml version="1.0"?><!DOCTYPE m [<!ENTITY a "aaaa">]><model unit="meter">&a;</model>'
    with zipfile.ZipFile(tmp_path / "a.3mf", "w") as archive:
        archive.writestr("3D/3dmodel.model", bomb)
    refused(tmp_path / "a.3mf", "declares entities")


@pytest.mark.parametrize("where", ["../skin.png", "/etc/passwd", "C:\\skin.png", "https://example.org/skin.png"])
def test_textures_outside_the_folder_are_refused(tmp_path, where):
    (tmp_path / "a.mtl").write_text(f"newmtl m\nmap_Kd {where}\n")
    written(tmp_path, "a.obj", sail())
    text = (tmp_path / "a.obj").read_text()
    (tmp_path / "a.obj").write_text("mtllib a.mtl\n" + text)
    (tmp_path / "a.mtl").write_text(f"newmtl m\nmap_Kd {where}\n")
    refused(tmp_path / "a.obj", "lies outside its folder", "m")
    (tmp_path / "b.obj").write_text(f"mtllib {where}\n" + text)
    refused(tmp_path / "b.obj", "lies outside its folder", "m")
    refused(with_image(written(tmp_path, "a.glb", two_parts()), where), "lies outside its folder")


def with_image(path: Path, uri: str) -> Path:
    """A GLB file that also names an image."""
    content = path.read_bytes()
    length = struct.unpack("<I", content[12:16])[0]
    described = json.loads(content[20 : 20 + length])
    described["images"] = [{"uri": uri}]
    text = json.dumps(described).encode()
    text += b" " * (-len(text) % 4)
    rest = content[20 + length :]
    head = struct.pack("<4sIIII", b"glTF", 2, 20 + len(text) + len(rest), len(text), 0x4E4F534A)
    path.write_bytes(head + text + rest)
    return path


def test_a_glb_file_that_lies_is_refused(tmp_path):
    path = written(tmp_path, "a.glb", two_parts())
    content = path.read_bytes()
    for damaged in (content[:200], b"glTF" + b"\xff" * 60, content.replace(b'"count"', b'"Count"')):
        path.write_bytes(damaged)
        refused(path, "GLB file|damaged|cannot be read")
    many = content.replace(b'"count":', b'"count":9999', 1)
    path.write_bytes(many)
    refused(path, "no whole GLB|more than|damaged|cannot be read")


def test_what_is_no_file_of_facets_is_refused(tmp_path):
    (tmp_path / "a.txt").write_text("hello")
    refused(tmp_path / "a.txt", r"ending has to be one of \.stl, \.obj, \.glb, \.ply, \.3mf")
    (tmp_path / "a.stl").mkdir()
    refused(tmp_path / "a.stl", "not a regular file|cannot be read|is a directory", "m")
    refused(tmp_path / "none.stl", "cannot be read: no such file", "m")
    for name in ("b.stl", "b.obj", "b.ply", "b.glb", "b.3mf"):
        for content in (b"", b"hello\n" * 30, os.urandom(500)):
            (tmp_path / name).write_bytes(content)
            refused(tmp_path / name, ".", None if name in ("b.glb", "b.3mf") else "m")


def test_a_pipe_is_refused_and_not_waited_for(tmp_path):
    os.mkfifo(tmp_path / "a.stl")
    refused(tmp_path / "a.stl", "not a regular file", "m")


def test_every_part_says_what_it_is_made_of(tmp_path):
    parts = read_parts(written(tmp_path, "a.glb", two_parts()))
    with pytest.raises(ShapeError, match=r"has a part .bus.: say what it is made of"):
        shape_of(parts, {"film": FILM})
    with pytest.raises(ShapeError, match=r"has no part .flim.\. Did you mean"):
        shape_of(parts, {"flim": FILM, "bus": BUS})
    with pytest.raises(ShapeError, match="not closed, so light meets its back"):
        shape_of(parts, {"film": BUS, "bus": BUS})
