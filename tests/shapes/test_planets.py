"""The globe: a glTF file with its map the right way up, kept byte for byte, and unlit."""

import io

import numpy as np
import pytest
import trimesh
from PIL import Image

from sailviz.shapes import planets


@pytest.fixture(scope="module")
def jpeg():
    file = io.BytesIO()
    Image.new("RGB", (8, 4), (10, 90, 200)).save(file, "JPEG")
    return file.getvalue()


@pytest.fixture(scope="module")
def loaded(jpeg):
    scene = trimesh.load(io.BytesIO(planets.globe(jpeg, 8, 16)), file_type="glb")
    (mesh,) = scene.geometry.values()
    return mesh


def test_north_is_up_on_the_map_of_the_globe(loaded):
    north = loaded.vertices[:, 2] > 1 - 1e-6
    assert np.allclose(loaded.visual.uv[north, 1], 1.0)
    assert np.allclose(loaded.visual.uv[~north, 1] < 1.0, True)


def test_longitude_runs_eastwards_and_its_zero_lies_at_x(loaded):
    equator = np.abs(loaded.vertices[:, 2]) < 1e-6
    longitude = np.arctan2(loaded.vertices[equator, 1], loaded.vertices[equator, 0])
    u = loaded.visual.uv[equator, 0]
    inside = (u > 0.01) & (u < 0.99)  # at the seam both longitudes are right
    assert np.allclose(2 * np.pi * (u[inside] - 0.5), longitude[inside], atol=1e-6)


def test_the_globe_faces_outwards(loaded):
    large = loaded.area_faces > 1e-6  # at the poles faces have no area
    outwards = np.sum(loaded.face_normals * loaded.triangles_center, axis=1)
    assert outwards[large].min() > 0


def test_the_map_is_kept_byte_for_byte(jpeg):
    assert jpeg in planets.globe(jpeg, 8, 16)


def test_no_lamp_shades_the_globe(loaded):
    assert not np.any(loaded.vertex_normals)  # as they stand in the file


def test_the_same_map_gives_the_same_file(jpeg):
    assert planets.globe(jpeg) == planets.globe(jpeg)


def test_a_stored_jpeg_becomes_no_other_picture(jpeg):
    with pytest.raises(ValueError, match="cannot become png"):
        planets.StoredJpeg(jpeg).save(io.BytesIO(), "png")
