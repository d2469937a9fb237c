"""Meshes, ranges and cameras: the geometry behind the picture."""

import io

import numpy as np
import pytest
import trimesh
from hypothesis import given
from hypothesis import strategies as st

from sailviz.recording.drawing import cameras, meshes
from sailviz.recording.drawing.plots import nice_range
from sailviz.recording.drawing.samples import smooth_lines

SHAPES = {
    "box": (meshes.box([1, 2, 3]), 6.0),
    "cylinder": (meshes.cylinder(1.0, 0.0, 2.0, 200), 2 * np.pi),
    "rod": (meshes.rod([0, 0, 0], [1, 2, 2], 0.1, 200), 0.03 * np.pi),
    "sphere": (meshes.sphere(100, 200)[0], 4 / 3 * np.pi),
}


def volume(mesh):
    """By the divergence theorem: positive where every face is seen counter-clockwise from outside."""
    a, b, c = (mesh.vertices[mesh.faces[:, k]] for k in range(3))
    return np.sum(np.cross(a, b) * c) / 6


@pytest.mark.parametrize("name", SHAPES)
def test_a_closed_shape_has_the_volume_of_its_formula(name):
    mesh, expected = SHAPES[name]
    assert volume(mesh) == pytest.approx(expected, rel=2e-3)  # the facets of a circle cut off 1/5000 and less


@pytest.mark.parametrize(
    "mesh", [*(mesh for mesh, _ in SHAPES.values()), meshes.film(), meshes.vanes(), meshes.booms()]
)
def test_normals_are_of_length_one_on_the_side_of_their_faces(mesh):
    a, b, c = (mesh.vertices[mesh.faces[:, k]] for k in range(3))
    facing = np.sum(np.cross(b - a, c - a) * mesh.normals[mesh.faces[:, 0]], axis=1)
    assert facing.min() > -1e-12
    assert np.allclose(np.linalg.norm(mesh.normals, axis=1), 1)


def test_the_front_of_a_film_is_its_dark_side_and_it_billows_away_from_the_sun():
    film = meshes.film()
    assert film.normals[:, 2].min() > 0
    assert film.vertices[:, 2].min() >= 0
    assert film.vertices[:, 2].max() > 0.03


def test_a_square_sail_of_side_one_reaches_to_its_corners():
    film = meshes.film()
    assert np.abs(film.vertices[:, :2]).max() == pytest.approx(np.sqrt(0.5))
    area = trimesh.Trimesh(film.vertices, film.faces).area
    assert 0.85 < area < 1.0  # the edges are drawn in


def test_the_textured_sphere_is_a_valid_gltf_file():
    ball, uv = meshes.sphere(8, 16)
    from PIL import Image

    jpeg = io.BytesIO()
    Image.new("RGB", (8, 4), (10, 90, 200)).save(jpeg, "JPEG")
    scene = trimesh.load(io.BytesIO(meshes.textured_glb(ball, uv, jpeg.getvalue())), file_type="glb")
    (loaded,) = scene.geometry.values()
    assert loaded.faces.shape == ball.faces.shape
    assert loaded.visual.material.baseColorTexture.size == (8, 4)
    # north up: v runs down in glTF, and trimesh turns it round
    assert loaded.visual.uv[0, 1] == pytest.approx(1.0)
    assert loaded.vertices[0, 2] == pytest.approx(1.0)


@given(st.floats(-1e6, 1e6), st.floats(1e-9, 1e6), st.floats(2, 12))
def test_a_range_holds_its_data_and_leaves_no_more_than_half_empty(low, span, numbers):
    bottom, top = nice_range(low, low + span, numbers)
    assert bottom < low
    assert low + span < top
    if span > 1e-2 * max(abs(low), abs(low + span)):
        assert top - bottom < 5 * span


def test_smooth_lines_follow_a_circle_to_a_thousandth_of_its_radius():
    angle = np.linspace(0, 2 * np.pi, 13)
    place, pace = (
        np.stack([np.cos(angle), np.sin(angle), 0 * angle], 1),
        np.stack([-np.sin(angle), np.cos(angle), 0 * angle], 1),
    )
    line = smooth_lines(angle, place, pace, 6)
    assert np.abs(np.linalg.norm(line, axis=1) - 1).max() < 1e-3
    assert np.array_equal(line[::6], place)


def test_the_close_up_sees_the_sunlit_side_of_a_film():
    normal = np.array([np.cos(0.6), np.sin(0.6), 0.0])
    eye = cameras.apart([[1.0, 0, 0], [0, 1.0, 0], normal], facing=normal)
    assert eye @ normal < -0.1
    assert np.linalg.norm(eye) == pytest.approx(1)
