"""A craft's own mesh: however it is given it is the same in m in body axes; what lies of itself is refused."""

import struct

import numpy as np
import pytest
import trimesh

from sailviz.shapes import membranes, structures
from sailviz.shapes.facets import Coefficients, Shape, Surface
from sailviz.shapes.file_checks import ShapeError
from sailviz.shapes.own_meshes import seen_mesh
from sailviz.shapes.primitives import inverted

LOW, HIGH = np.array([0.0, -0.9, -0.2]), np.array([0.4, 1.5, 0.7])  # m, in the mesh's own axes


def brick():
    mesh = trimesh.creation.box(HIGH - LOW)
    mesh.apply_translation((LOW + HIGH) / 2)
    return mesh


def box_of(seen):
    told = seen.told()
    return np.array([told["low_m"], told["high_m"]])


def plate():
    return trimesh.Trimesh([[0, 0, 0], [2, 0, 0], [2, 1, 0], [0, 1, 0]], [[0, 1, 2], [0, 2, 3]], process=False)


@pytest.mark.parametrize(("unit", "factor"), [("m", 1.0), ("mm", 1e3), ("cm", 1e2), ("in", 1 / 0.0254), ("km", 1e-3)])
@pytest.mark.parametrize("ending", ["", ".stl", ".obj", ".ply", ".glb"])
def test_a_mesh_is_in_metres_however_it_comes(tmp_path, unit, factor, ending):
    mesh = brick()
    mesh.apply_scale(1.0 if ending == ".glb" else factor)
    given = mesh
    if ending:
        given = tmp_path / f"craft{ending}"
        mesh.export(str(given))
    seen = seen_mesh(given, None if ending == ".glb" else unit)
    assert np.allclose(box_of(seen), [LOW, HIGH], atol=1e-6)
    assert seen.size == pytest.approx(2.4, rel=1e-6)


@pytest.mark.parametrize(
    ("front", "low", "high"),
    [("-z", LOW, HIGH), ("+x", [-0.9, -0.7, -0.4], [1.5, 0.2, 0.0]), ("+z", [0.0, -1.5, -0.7], [0.4, 0.9, 0.2])],
)
def test_the_axis_that_is_the_front_points_to_the_sun(front, low, high):
    assert np.allclose(box_of(seen_mesh(brick(), "m", front)), [low, high], atol=1e-12)


@pytest.mark.parametrize("turned", [False, True])
def test_a_plate_has_a_lit_side_towards_the_sun_however_its_facets_run(turned):
    (part,) = seen_mesh(inverted(plate()) if turned else plate(), "m").parts
    assert part.film
    assert np.all(part.mesh.face_normals[:, 2] < 0)


def test_what_shows_no_one_side_is_a_body():
    crossed = trimesh.util.concatenate([plate(), inverted(plate()).apply_translation([2, 0, 0])])
    upright = plate().apply_transform(trimesh.transformations.rotation_matrix(np.pi / 2, [1, 0, 0]))
    for mesh in (brick(), inverted(brick()), crossed, upright):
        (part,) = seen_mesh(mesh, "m").parts
        assert not part.film
        if part.mesh.is_watertight:
            assert part.mesh.volume > 0


def test_a_shape_keeps_its_parts_and_a_scene_its_places():
    film = membranes.square(10.0, Surface(*[Coefficients(0.1, 0.8, 0.0)] * 2), 0.0, 0.0, rows=2)
    shape = Shape((film, structures.bus([1, 1, 1], [0, 0, 2], Coefficients(0.5, 0, 0))))
    seen = seen_mesh(shape)
    assert [(part.name, part.film) for part in seen.parts] == [(p.name, p.is_film) for p in shape.parts]
    scene = trimesh.Scene()
    scene.add_geometry(brick(), geom_name="a", transform=trimesh.transformations.translation_matrix([3, 0, 0]))
    assert np.allclose(box_of(seen_mesh(scene, "m"))[0], LOW + np.array([3, 0, 0]))


def test_what_is_no_mesh_is_refused_in_a_sentence(tmp_path):
    lying = tmp_path / "lying.stl"
    lying.write_bytes(b"\0" * 80 + struct.pack("<I", 1000) + b"\0" * 50)
    empty = tmp_path / "empty.obj"
    empty.write_text("v 0 0 0\n")
    (tmp_path / "text.glb").write_text("no mesh")
    hole = brick()
    hole.vertices[3, 1] = np.nan
    for given, unit, front, words in (
        (lying, "m", None, "its length is not that of so many"),
        (empty, "m", None, "holds no facets"),
        (tmp_path / "text.glb", None, None, "text.glb"),
        (tmp_path / "none.stl", "m", None, "cannot be read"),
        (tmp_path / "a.step", "m", None, "its ending has to be one of"),
        (tmp_path, "m", None, "its ending has to be one of"),
        (brick(), None, None, "say whether it counts in m"),
        (brick(), "metre", None, "Allowed: m, cm"),
        (brick(), "mm", None, "its unit must be another"),
        (brick(), "m", "up", "is no side that a front may face"),
        (hole, "m", None, "is not a finite number"),
        (trimesh.Scene(), "m", None, "holds no facets"),
        ([1, 2], "m", None, "not list"),
    ):
        with pytest.raises(ShapeError) as error:
            seen_mesh(given, unit, front)
        assert words in str(error.value)
    with pytest.raises(ShapeError, match="leave unit and front out"):
        seen_mesh(Shape(()), "m")
