"""The table over the sphere of directions: errors over 2 P A and 2 P A times the side, at the sizes of the source."""

from dataclasses import replace

import numpy as np
import pytest

from sailviz.propulsion.shaped_sail import force_and_torque
from sailviz.shapes import light_table, membranes, shadows, structures
from sailviz.shapes.air_law import Air
from sailviz.shapes.facets import Coefficients, Shape, Surface
from sailviz.shapes.light_force import tensors
from sailviz.shapes.light_table import TableError, build, directions, exact

FRONT, BACK, BLACK = Coefficients(0.0723, 0.8554, -0.0030), Coefficients(0.35, 0.3, 0.02), Coefficients(0.5, 0.0, 0.0)
FILM = Surface(FRONT, BACK)
with_embree = pytest.mark.skipif(shadows.ray_caster() != "embreex", reason="embreex is not installed")


def random_directions(count: int = 800) -> np.ndarray:
    u = np.random.default_rng(1).normal(size=(count, 3))
    return u / np.linalg.norm(u, axis=1)[:, None]


def flat_sail() -> Shape:
    """9 m square, a bus on the Sun's side, four thin booms behind."""
    booms = structures.booms(structures.boom_tips(9.0), 0.01, BLACK, 0.02)
    return Shape((membranes.square(9.0, FILM), structures.bus([0.6, 0.6, 1.0], [0, 0, -0.6], BLACK), booms))


def billowed_sail() -> Shape:
    """40 m, cone 3 deg, sag 0.03, a bus of 2 m."""
    film = replace(membranes.square(40.0, FILM, np.radians(3), 0.03), smooth=None)
    return Shape((film, structures.bus([2.0, 2.0, 2.0], [0, 0, -1.1], BLACK)))


@pytest.mark.parametrize(("cells", "most"), [(8, 3.0e-4), (16, 9.4e-5), (32, 2.3e-5)])
def test_a_flat_sail_with_bus_and_booms_is_read_within_the_sources_error(cells, most):
    shape, u = flat_sail(), random_directions()
    force, torque = force_and_torque(u, build(shape, cells, shadow=False).numbers)
    force_then, torque_then = exact(shape, u, None)
    assert np.abs(force - force_then).max() / 81 < most
    assert np.abs(torque - torque_then).max() / 729 < most


@pytest.mark.parametrize(
    ("interpolation", "cells", "most", "most_near"),
    [
        ("bilinear", 16, 5.6e-3, 1e-4),
        ("bicubic", 16, 3.0e-3, 1e-4),
        ("bilinear", 32, 1.4e-3, 2.0e-5),
        ("bicubic", 32, 2.9e-4, 1.6e-5),
    ],
)
def test_a_billowed_sail_is_read_within_the_sources_error(interpolation, cells, most, most_near):
    """Within 60 deg of the Sun a hundred times better than all round."""
    shape, u = billowed_sail(), random_directions()
    table = build(shape, cells, shadow=False, interpolation=interpolation)
    wrong = np.abs(force_and_torque(u, table.numbers)[0] - exact(shape, u, None)[0]).max(axis=1) / 1600
    assert wrong.max() < most
    assert wrong[u[:, 2] > 0.5].max() < most_near


def test_a_table_for_bicubic_reading_holds_the_bilinear_one():
    both = {word: build(billowed_sail(), 8, shadow=False, interpolation=word) for word in ("bilinear", "bicubic")}
    found = light_table.without_ring(both["bicubic"])
    np.testing.assert_allclose(found.numbers, both["bilinear"].numbers, rtol=0, atol=1e-12 * 1600 * 40)


def test_a_bare_sail_inside_its_cone_is_exact():
    shape = Shape((membranes.square(40.0, FILM, np.radians(3), 0.03),))
    u = random_directions()
    u = u[u[:, 2] > 0.5]  # a cell inside the width in which the tensors fade
    table, found = build(shape, 32, shadow=False), tensors(shape, "front")
    force, torque = force_and_torque(u, table.numbers)
    np.testing.assert_allclose(force, found.force(u), rtol=0, atol=1e-12 * 1600)
    np.testing.assert_allclose(torque, found.torque(u), rtol=0, atol=1e-12 * 1600 * 40)


@pytest.mark.parametrize("interpolation", ["bilinear", "bicubic"])
def test_at_its_nodes_the_table_is_exact(interpolation):
    shape = flat_sail()
    u = directions(8).reshape(-1, 3)
    force, torque = force_and_torque(u, build(shape, 8, shadow=False, interpolation=interpolation).numbers)
    force_then, torque_then = exact(shape, u, None)
    np.testing.assert_allclose(force, force_then, rtol=0, atol=1e-12 * 81)
    np.testing.assert_allclose(torque, torque_then, rtol=0, atol=1e-12 * 729)


@pytest.mark.parametrize("interpolation", ["bilinear", "bicubic"])
def test_the_force_does_not_jump_across_the_edges_of_the_cube_nor_at_the_terminator(interpolation):
    """Within 1e-6 of a radian on both sides."""
    table = build(billowed_sail(), 8, shadow=False, interpolation=interpolation)
    random = np.random.default_rng(2)
    for low, high in (((1, 1 - 1e-6), (1, 1 + 1e-6)), ((1, -1e-6), (1, 1e-6))):
        for axes in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
            if low[1] < 0 and axes[1] != 2:
                continue
            third = random.uniform(-0.9, 0.9, 50)
            sides = [
                np.stack([np.full(50, a), np.full(50, b), third], axis=1)[:, np.argsort(axes)] for a, b in (low, high)
            ]
            pair = [force_and_torque(u / np.linalg.norm(u, axis=1)[:, None], table.numbers)[0] for u in sides]
            bound = 1e-4 if interpolation == "bilinear" else 2e-2  # cubics of two faces meet in their nodes only
            assert np.abs(pair[0] - pair[1]).max() / 1600 < bound


@with_embree
def test_a_shaded_sail_is_read_within_the_sources_error():
    """Edges of shadows: largest error 1.7e-3, rms 2e-4, torque 5e-5 of 2 P A times the side."""
    bus = structures.bus([0.6, 0.6, 1.0], [0, 0, -0.6], BLACK)
    shape, u = Shape((membranes.square(9.0, FILM, rows=26), bus)), random_directions(600)
    table = build(shape, 16)
    assert table.backend == "embreex"
    force, torque = force_and_torque(u, table.numbers)
    force_then, torque_then = exact(shape, u, shadows.Shadows(shape))
    wrong = np.abs(force - force_then).max(axis=1) / 81
    assert wrong.max() < 1.7e-3
    assert np.sqrt(np.mean((force - force_then) ** 2)) / 81 < 2e-4
    near = u[:, 2] > 0.5
    assert wrong[near].max() < 1.0e-3
    assert np.abs(torque - torque_then)[near].max() / 729 < 5e-5


@with_embree
def test_the_same_shape_gives_the_same_table():
    """Fixed rays, no random ones."""
    one, other = build(flat_sail(), 4), build(flat_sail(), 4)
    assert np.array_equal(one.numbers, other.numbers)
    assert flat_sail().digest() == flat_sail().digest() != billowed_sail().digest()


def test_air_has_the_same_table():
    air, u = Air(6.0, 0.9, 0.8, 0.5), random_directions(300)
    limit = air.hyperthermal
    shape = Shape((membranes.square(9.0, Surface(limit, limit)),))
    table = build(shape, 32, shadow=False, law=air)
    force, _ = force_and_torque(u, table.numbers)
    then, _ = exact(shape, u, None, air)
    assert np.abs(force - then).max() / 81 < 2e-3
    assert np.abs(force - then)[np.abs(u[:, 2]) > 0.5].max() / 81 < 1e-4


def test_progress_is_told_and_ends_at_all():
    heard: list[float] = []
    build(billowed_sail(), 8, shadow=False, progress=heard.append)
    assert heard == sorted(heard)
    assert heard[-1] == 1.0


@pytest.mark.parametrize("cells", [0, 1, 7, 300])
def test_a_cube_of_odd_or_too_many_cells_is_refused(cells):
    with pytest.raises(TableError, match="an even number of cells, 2 to 256"):
        light_table.check(flat_sail(), cells)


def test_too_many_facets_are_refused():
    shape = Shape((membranes.square(9.0, FILM, rows=160),))
    with pytest.raises(TableError, match="more than the 200000"):
        build(shape, 4, shadow=False)
