"""The packaged ionosphere: its nodes, what lies between them, its edges, and the decay times computed from it."""

from __future__ import annotations

import numpy as np
import pytest

from sailviz.compiled import compiled
from sailviz.constants import ATOMIC_MASS, DAY, MU_EARTH, RADIUS_EARTH
from sailviz.environment import ionosphere
from sailviz.environment.ionosphere import LEVELS, density, in_table, lookup, table
from sailviz.propulsion.plasma_brake import force_per_length
from sailviz.shipped import shipped_folder

HOUR = 2 * np.pi / 24


@pytest.fixture(scope="module")
def data():
    with np.load(shipped_folder("assets") / "ionosphere_iri2020.npz") as file:
        return {name: file[name] for name in file.files}


@compiled
def at_place(p, at, latitude, local_time, altitude, f107):
    return lookup(p, at, latitude, local_time, altitude, f107)


def test_every_node_of_the_file_is_reproduced(data):
    axes = np.radians(data["latitude_deg"]), HOUR * data["local_time_h"], 1e3 * data["altitude_km"]
    latitude, local_time, altitude = np.meshgrid(*axes, indexing="ij")
    for name, f107 in LEVELS.items():
        n, m = density(latitude, local_time, altitude, f107)
        assert n == pytest.approx(data[f"{name}_electron_density_m3"], rel=1e-12)  # rounding of exp(ln n)
        assert m / ATOMIC_MASS == pytest.approx(data[f"{name}_mean_ion_mass_u"], rel=1e-12)


def test_the_middle_of_a_cell_is_the_geometric_mean_of_its_corners_density_and_the_mean_of_their_masses(data):
    """At -45 deg, 22:30 h (the last interval of the day, back to midnight), 712.5 km, between F10.7 = 70 and 145."""
    corners = np.ix_([4, 5], [7, 0], [20, 21])
    assert (data["latitude_deg"][4], data["local_time_h"][7], data["altitude_km"][20]) == (-50, 21, 700)
    n, m = density(np.radians(-45), 22.5 * HOUR, 712.5e3, 107.5)
    levels = "min2019", "mid2014"
    logs = [np.log(data[f"{name}_electron_density_m3"][corners].astype(float)) for name in levels]
    assert n == pytest.approx(np.exp(np.mean(logs)), rel=1e-12)
    masses = [data[f"{name}_mean_ion_mass_u"][corners].astype(float) for name in levels]
    assert m == pytest.approx(ATOMIC_MASS * np.mean(masses), rel=1e-12)


def test_between_nodes_it_is_linear_in_each_argument_alone():
    """A quarter of the way: three quarters of one node's value and a quarter of the other's."""
    base = np.array([np.radians(20), 6 * HOUR, 900e3, 145.0])
    step = np.array([np.radians(10), 3 * HOUR, 25e3, 48.0])
    for k in range(4):
        ends = [density(*(base + f * step * (np.arange(4) == k))) for f in (0, 0.25, 1)]
        (n0, m0), (n, m), (n1, m1) = ends
        assert np.log(n) == pytest.approx(0.75 * np.log(n0) + 0.25 * np.log(n1), rel=1e-12)
        assert m == pytest.approx(0.75 * m0 + 0.25 * m1, rel=1e-12)


def test_local_time_is_a_circle():
    local_time = HOUR * np.linspace(0.1, 23.9, 47)
    here = density(0.4, local_time, 640e3, 110.0)
    for turns in (-2, -1, 1, 3):
        assert density(0.4, local_time + 2 * np.pi * turns, 640e3, 110.0)[0] == pytest.approx(here[0], rel=1e-10)
    before, after = density(0.4, np.array([-1e-9, 1e-9]), 640e3, 110.0)[0]
    assert before == pytest.approx(after, rel=1e-8)


def test_noon_is_denser_than_night_and_the_active_sun_than_the_quiet_one():
    """Force ratio of day and night 44.2 / 8.8 nN/m at 800 km, solar minimum: a density ratio of order 10."""
    night, noon = density(0.0, HOUR * np.array([3, 12]), 800e3, 70.0)[0]
    assert 5 < noon / night < 30
    assert density(0.0, np.pi, 800e3, 193.0)[0] > 5 * noon


def test_the_edges_hold_outside():
    top, bottom = density(0.3, 1.0, 1500e3, 100.0), density(0.3, 1.0, 200e3, 100.0)
    assert density(0.3, 1.0, 5000e3, 100.0) == pytest.approx(top)
    assert density(0.3, 1.0, 90e3, 100.0) == pytest.approx(bottom)
    assert density(0.3, 1.0, 700e3, 300.0) == pytest.approx(density(0.3, 1.0, 700e3, 193.0))
    assert density(0.3, 1.0, 700e3, 50.0) == pytest.approx(density(0.3, 1.0, 700e3, 70.0))
    assert density(np.pi / 2, 1.0, 700e3, 100.0) == pytest.approx(density(np.pi / 2 + 1e-9, 1.0, 700e3, 100.0))


def test_what_the_table_cannot_know_is_said():
    assert in_table(700e3, 100.0)
    assert in_table(np.array([199e3, 200e3, 1500e3, 1501e3]), 100.0).tolist() == [False, True, True, False]
    assert in_table(700e3, np.array([69.0, 70.0, 193.0, 194.0])).tolist() == [False, True, True, False]


def test_a_place_that_is_no_number_reads_no_foreign_memory():
    assert np.isfinite(density(np.nan, np.nan, np.nan, np.nan)).all()
    assert np.isfinite(density(0.1, 1.0, np.array([-np.inf, np.inf]), 100.0)).all()


@pytest.mark.parametrize("f107", [60.0, 70.0, 110.0, 145.0, 170.0, 193.0, 220.0])
def test_a_table_for_one_solar_level_says_the_same_in_a_third_of_the_length(f107):
    """Blending nodes and blending what lies between them commute, both being linear."""
    whole, one = table(), table(f107)
    assert len(one) < 0.34 * len(whole)
    rng = np.random.default_rng(5)
    row = np.concatenate([np.full(7, np.nan), one])
    for _ in range(20):
        place = rng.uniform(-1.5, 1.5), rng.uniform(-9, 9), rng.uniform(2e5, 15e5)
        assert at_place(row, 7, *place, 999.0) == pytest.approx(at_place(whole, 0, *place, f107), rel=1e-12)


@pytest.mark.parametrize(("f107", "days"), [(70.0, 347.890), (145.0, 105.698), (193.0, 50.805)])
def test_a_cubesat_comes_down_from_700_to_500_km_in_the_days_of_the_reference_quadrature(f107, days):
    """4.5 kg, 300 m at -1 kV, 97.8 deg, circular speed, no rotation of the plasma; the force averaged along the orbit
    and over 24 local times after interpolation. The reference's own sums are unknown: 0.1 %."""
    altitude = np.linspace(500e3, 700e3, 81)
    along, local_time = np.meshgrid(np.radians(np.arange(0.5, 360)), HOUR * np.arange(0.5, 24), indexing="ij")
    latitude = np.arcsin(np.sin(np.radians(97.8)) * np.sin(along))
    force = []
    for h in altitude:
        n, m = density(latitude, local_time, h, f107)
        force.append(300 * force_per_length(n, m, np.sqrt(MU_EARTH / (RADIUS_EARTH + h)), 1000.0).mean())
    a = RADIUS_EARTH + altitude
    time = np.trapezoid(4.5 * np.sqrt(MU_EARTH) / (2 * a**1.5 * np.array(force)), a)
    assert time / DAY == pytest.approx(days, rel=1e-3)


def test_scalars_and_arrays_keep_their_shapes():
    assert np.shape(density(0.1, 1.0, 700e3, 70.0)[0]) == ()
    n, m = density(np.zeros((3, 1)), np.zeros(4), 700e3, 70.0)
    assert n.shape == m.shape == (3, 4)
    assert density(np.zeros(0), 0.0, 700e3, 70.0)[0].shape == (0,)


def test_an_exponential_profile_falls_by_e_in_a_scale_height():
    assert ionosphere.exponential.py_func(850e3, 700e3, 3.0, 150e3) == pytest.approx(3 / np.e, rel=1e-15)
