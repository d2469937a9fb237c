"""The square sail: which side is dark, how it billows, how large it is."""

import numpy as np
import pytest

from sailviz.shapes import sails


def test_the_front_of_a_film_is_its_dark_side_and_it_billows_away_from_the_sun():
    film = sails.film()
    assert film.vertex_normals[:, 2].min() > 0
    assert film.face_normals[:, 2].min() > 0
    assert film.vertices[:, 2].min() >= 0
    assert film.vertices[:, 2].max() > 0.03


def test_a_square_sail_of_side_one_reaches_to_its_corners():
    film = sails.film()
    assert np.abs(film.vertices[:, :2]).max() == pytest.approx(np.sqrt(0.5))
    assert 0.85 < film.area < 1.0  # the edges are drawn in


def test_the_seams_lie_on_the_film():
    film = sails.film()
    edge = sails.seams()[4]  # the outermost of the first quadrant, whose points are vertices
    gaps = np.linalg.norm(film.vertices[None] - edge[:, None], axis=-1).min(axis=1)
    assert gaps.max() < 1e-12


def test_the_booms_end_at_the_corners_of_the_film():
    booms = sails.booms()
    assert np.abs(booms.vertices[:, :2]).max() == pytest.approx(np.sqrt(0.5))
    assert np.abs(booms.vertices[:, 2]).max() == pytest.approx(sails.BOOM_RADIUS, rel=1e-6)
    assert booms.volume == pytest.approx(4 * np.sqrt(0.5) * np.pi * sails.BOOM_RADIUS**2, rel=0.08)  # ten facets


def test_vanes_are_seen_from_both_sides():
    vanes = sails.vanes()
    assert np.allclose(np.sum(vanes.face_normals, axis=0), 0, atol=1e-12)
    assert len(vanes.faces) == 8


def test_the_bus_stands_on_the_dark_side():
    assert sails.bus().vertices[:, 2].min() == pytest.approx(0.0)
