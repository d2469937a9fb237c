"""Nutation against the whole theory, and TEME against an independent chain of rotations."""

import erfa
import numpy as np
import pytest

from sailviz import frames
from sailviz.sky import nutation

ARCSECOND = np.pi / 180 / 3600


def test_nutation_is_that_of_the_whole_theory_to_a_hundredth_of_an_arcsecond():
    for year in np.linspace(1960, 2060, 500):
        day = 2_451_545.0 + (year - 2000) * 365.25
        centuries = (day - 2_451_545.0) / 36_525
        longitude, obliquity = nutation.angles(centuries)
        whole = erfa.nut80(day, 0.0)
        assert longitude == pytest.approx(whole[0], abs=0.01 * ARCSECOND)
        assert obliquity == pytest.approx(whole[1], abs=0.01 * ARCSECOND)
        matrix = erfa.numat(erfa.obl80(day, 0.0), *whole)
        np.testing.assert_allclose(nutation.mean_to_true(centuries), matrix, atol=0.01 * ARCSECOND)


def test_the_first_row_of_sgp4_in_the_mean_equator_of_date_and_of_j2000():
    """Own chain of IAU 1976/1980 rotations, which an astronomy library meets to 0.8 m."""
    centuries = frames.centuries_since_j2000(np.datetime64("2000-06-27T18:50:19.733568", "ns"))
    position, velocity = (
        np.array([7022465.29266, -1400082.96755, 39.95155]),
        np.array([1893.841015, 6405.893759, 4534.807250]),
    )
    turn = nutation.teme_to_mean(centuries)
    assert np.linalg.norm(turn @ position - [7022465.289, -1400082.968, 221.526]) < 1.0
    assert np.linalg.norm(turn @ velocity - [1893.704243, 6405.795883, 4535.002622]) < 1e-3
    home = frames.precession(centuries).T @ turn
    assert np.linalg.norm(home @ position - [7022312.43, -1400849.48, -111.56]) < 1.0
    assert np.linalg.norm(home @ velocity - [1894.618537, 6405.589132, 4534.912779]) < 1e-3


def test_teme_is_the_true_equator():
    centuries = 0.26
    true_pole = nutation.mean_to_true(centuries).T @ [0.0, 0.0, 1.0]
    np.testing.assert_allclose(nutation.teme_to_mean(centuries) @ [0.0, 0.0, 1.0], true_pole, atol=1e-15)
