"""Primitives: volumes and areas of their formulas, normals on the side of their faces."""

import numpy as np
import pytest

from sailviz.shapes import primitives

CLOSED = {
    "box": (primitives.box([1, 2, 3]), 6.0),
    "cylinder": (primitives.cylinder(1.0, 0.0, 2.0, 200), 2 * np.pi),
    "rod": (primitives.rod([0, 0, 0], [1, 2, 2], 0.1, 200), 0.03 * np.pi),
    "ball": (primitives.ball(100, 200), 4 / 3 * np.pi),
    "larger ball": (primitives.ball(100, 200, radius=2.0), 32 / 3 * np.pi),
}
OPEN = {
    "tube": (primitives.tube(0.0, 2.0, 1.0, 1.0, 200), 4 * np.pi),
    "cone": (primitives.tube(0.0, 4.0, 3.0, 0.0, 200), 15 * np.pi),
    "disc": (primitives.disc(0.0, 1.0, 200), np.pi),
    "ring": (primitives.disc(0.5, 1.0, 200), 0.75 * np.pi),
    "cap": (primitives.cap(np.pi / 3, 100, 200), np.pi),
    "zone": (primitives.cap(np.pi / 2, 100, 200, inner=np.pi / 3), np.pi),
    "band": (primitives.band(np.linspace(0, np.pi, 200), [1.0, 2.0]), 1.5 * np.pi),
}


@pytest.mark.parametrize("name", CLOSED)
def test_a_closed_shape_has_the_volume_of_its_formula_and_faces_outwards(name):
    mesh, expected = CLOSED[name]
    assert mesh.volume == pytest.approx(expected, rel=2e-3)  # the facets of a circle cut off 1/5000 and less
    merged = mesh.copy()
    merged.merge_vertices(merge_norm=True, merge_tex=True)
    assert merged.is_watertight


@pytest.mark.parametrize("name", OPEN)
def test_an_open_shape_has_the_area_of_its_formula(name):
    mesh, expected = OPEN[name]
    assert mesh.area == pytest.approx(expected, rel=1e-3)


@pytest.mark.parametrize("name", [*CLOSED, *OPEN])
def test_normals_are_of_length_one_on_the_side_of_their_faces(name):
    mesh, _ = (CLOSED | OPEN)[name]
    normals = primitives.vertex_normals(mesh)
    facing = np.sum(mesh.face_normals * normals[mesh.faces[:, 0]], axis=1)
    used = np.unique(mesh.faces)
    assert facing.min() > 0
    assert np.allclose(np.linalg.norm(normals[used], axis=1), 1)
    assert np.array_equal(normals, mesh.vertex_normals)  # trimesh's own


def test_the_sides_of_a_box_are_shaded_as_planes():
    box = primitives.box([1, 2, 3])
    normals = primitives.vertex_normals(box)
    assert np.allclose(normals[box.faces[:, 0]], box.face_normals)
    assert np.allclose(np.abs(normals).max(axis=1), 1)


def test_the_lid_of_a_cylinder_is_flat_and_its_side_is_round():
    can = primitives.cylinder(1.0, 0.0, 2.0, 24)
    along = np.abs(primitives.vertex_normals(can)[:, 2])
    assert np.all((along < 1e-9) | (along > 1 - 1e-9))


def test_discs_and_bands_are_seen_from_above():
    for mesh in (primitives.disc(0.2, 1.0), primitives.band([0.0, 1.0, 2.0], [1.0, 2.0])):
        assert np.allclose(mesh.face_normals, [0, 0, 1])


def test_the_vertices_of_a_band_run_through_its_distances_first():
    band = primitives.band([0.0, np.pi / 2], [1.0, 2.0, 3.0])
    assert np.allclose(band.vertices[:3], [[1, 0, 0], [2, 0, 0], [3, 0, 0]])
    assert np.allclose(band.vertices[3:], [[0, 1, 0], [0, 2, 0], [0, 3, 0]])


def test_a_rod_reaches_from_end_to_end():
    rod = primitives.rod([1, 1, 1], [1, 1, -4], 0.5)
    assert np.allclose(rod.bounds, [[0.5, 0.5, -4], [1.5, 1.5, 1]], atol=0.03)  # ten facets round it


def test_what_is_moved_or_turned_leaves_the_first_where_it_was():
    box = primitives.box([1, 2, 3])
    before = box.vertices.copy()
    assert np.allclose(primitives.moved(box, [1, 0, 0]).vertices, before + np.array([1, 0, 0]))
    assert np.allclose(primitives.turned(box, np.pi / 2).extents, [2, 1, 3])
    assert np.array_equal(box.vertices, before)
