"""Rays from facets towards the Sun: against the arithmetic of polygons, and what may shade what."""

import numpy as np
import pytest

from sailviz.shapes import membranes, shadows, structures
from sailviz.shapes.facets import Coefficients, Part, Shape, Surface, subdivided
from sailviz.shapes.light_force import force_and_torque
from sailviz.shapes.light_table import exact
from sailviz.shapes.primitives import inverted, sheet
from sailviz.shapes.shadows import NoRaysError, Shadows, may_shade, why_no_rays

JPL_2015 = Coefficients(0.0723, 0.8554, -0.0030)
FILM = Surface(JPL_2015, JPL_2015)
GREY = Coefficients(0.5, 0.0, 0.0)
with_rays = pytest.mark.skipif(not shadows.ray_caster(), reason="nothing that casts rays is installed")
with_embree = pytest.mark.skipif(shadows.ray_caster() != "embreex", reason="embreex is not installed")


def plate(side: float, height: float, surface: Surface, cells: int, name: str) -> Part:
    """A flat square of cells x cells x 2 facets, its front along -z."""
    line = np.linspace(-side / 2, side / 2, cells + 1)
    x, y = np.meshgrid(line, line, indexing="ij")
    mesh = sheet(np.stack([x, y, np.full_like(x, height)], axis=-1))
    if mesh.face_normals[0, 2] > 0:
        mesh = inverted(mesh)
    return Part(name, mesh, surface)


def tilted(a: float) -> np.ndarray:
    return np.array([[np.sin(np.radians(a)), 0.0, np.cos(np.radians(a))]])


@with_embree
@pytest.mark.parametrize(
    ("a", "force", "torque"),
    [
        (30, (3.871479965078, 0, 68.044984683710), 0.734798130397),
        (50, (4.402484579066, 0, 37.438345098506), 0.833212018609),
    ],
)
def test_a_plate_before_a_film_takes_its_light(a, force, torque):
    """Film 10 x 10 m, plate 2 x 2 m a metre before it on the Sun's side, a lattice along the shadow's edges: as many
    facets are shaded as there should be, which are up to a facet's width away, so that the torque errs with that."""
    for cells, near in ((40, 0.22), (160, 0.042)):
        shape = Shape((plate(10, 0, FILM, cells, "film"), plate(2, -1, Surface(GREY, GREY), 8, "plate")))
        found, turn = exact(shape, tilted(a), Shadows(shape))
        np.testing.assert_allclose(found[0], force, rtol=0, atol=1e-10)
        assert turn[0, 1] == pytest.approx(torque, abs=near)


def clipped(a: float, side: float, size: float, gap: float) -> tuple[float, float]:
    """(area m2, middle x m) of the shadow that a plate of this size, so far before a film, throws on it in the x-z
    plane; both square, centred and along the axes."""
    middle = gap * np.tan(np.radians(a))
    low, high = max(middle - size / 2, -side / 2), min(middle + size / 2, side / 2)
    return (high - low) * size, (high + low) / 2


@with_embree
@pytest.mark.parametrize(
    ("a", "size", "gap"), [(30, 2.0, 1.0), (50, 2.0, 1.0), (15, 3.0, 2.0), (-40, 4.0, 2.5), (65, 5.0, 2.0)]
)
def test_a_shadow_takes_what_polygons_say(a, size, gap):
    """Force and torque of film and plate by the area and the middle of the shadow, which at 65 deg leaves the film's
    edge; 64 rays a facet see its area within a thousandth of the film's."""
    shape = Shape((plate(10, 0, FILM, 20, "film"), plate(size, -gap, Surface(GREY, GREY), 8, "plate")))
    shaded, middle = clipped(a, 10, size, gap)
    u, z = tilted(a)[0], np.array([0.0, 0.0, 1.0])
    c = u[2]
    push = c * (JPL_2015.b1 * u + (JPL_2015.b2 * c + JPL_2015.b3) * z)
    on_plate = size**2 * GREY.b1 * c * u
    force = (100 - shaded) * push + on_plate
    torque = np.cross([-shaded * middle, 0, 0], push) + np.cross([0, 0, -gap], on_plate)
    found, turn = exact(shape, tilted(a), Shadows(shape, 8))
    np.testing.assert_allclose(found[0], force, rtol=0, atol=0.1)
    np.testing.assert_allclose(turn[0], torque, rtol=0, atol=0.1 * (abs(middle) + size / 2))


@with_embree
def test_shares_of_facets_make_the_edge_of_a_shadow_sharper():
    force = np.array([3.871479965078, 0, 68.044984683710])
    shape = Shape((plate(10, 0, FILM, 17, "film"), plate(2, -1, Surface(GREY, GREY), 8, "plate")))
    wrong = [np.abs(exact(shape, tilted(30), Shadows(shape, n))[0][0] - force).max() for n in (1, 8)]
    assert wrong[1] < 0.25 * wrong[0]
    assert wrong[1] < 0.05


@with_rays
def test_light_from_where_nothing_is_in_its_way_meets_all():
    shape = Shape((plate(10, 0, FILM, 12, "film"), plate(2, -1, Surface(GREY, GREY), 4, "plate")))
    seen = Shadows(shape).visible(np.array([[0.0, 0.0, -1.0]]))  # from behind, where the plate casts on nothing
    assert np.all(seen[0, shape.part_of == 0] == 1)
    assert np.all(seen[0, shape.part_of == 1] == 0)  # but is itself behind the film
    facing = Shadows(shape).visible(np.array([[0.0, 0.0, 1.0]]))
    covered = np.abs(shape.elements.centre[:, :2]).max(axis=1) < 1
    assert np.all(facing[0, (shape.part_of == 0) & covered] == 0)
    assert np.all(facing[0, (shape.part_of == 0) & ~covered] == 1)


@with_rays
def test_a_billowed_film_does_not_shade_itself_inside_its_cone():
    shape = Shape((membranes.square(7.0, FILM, np.radians(5), 0.05),))
    u = np.concatenate([tilted(a) for a in (0, 30, 60, 70)])
    free, shaded = exact(shape, u, None), exact(shape, u, Shadows(shape))
    np.testing.assert_allclose(shaded[0], free[0], rtol=0, atol=1e-12)


@pytest.mark.skipif(shadows.find_spec("rtree") is None, reason="rtree is not installed")
@with_embree
def test_both_casters_see_the_same(monkeypatch):
    """They may differ on grazing rays."""
    shape = Shape((plate(10, 0, FILM, 10, "film"), structures.bus([2, 2, 1], [0.3, 0, -1.2], GREY)))
    u = np.concatenate([tilted(a) for a in (0, 20, 50, 130)])
    by_embree = Shadows(shape).visible(u)
    monkeypatch.setattr(shadows, "ray_caster", lambda: "rtree")
    by_rtree = Shadows(shape)
    assert by_rtree.backend == "rtree"
    assert np.mean(by_rtree.visible(u) != by_embree) < 0.005


def test_what_cannot_shade_itself_needs_no_rays(monkeypatch):
    monkeypatch.setattr(shadows, "ray_caster", lambda: "")
    for part in (membranes.disc(3.0, FILM), membranes.square(3.0, FILM), structures.bus([1, 1, 1], [0, 0, 0], GREY)):
        shape = Shape((part,))
        assert not may_shade(shape)
        assert Shadows(shape).backend == "none"
        force, _ = force_and_torque(shape, tilted(20))
        np.testing.assert_allclose(exact(shape, tilted(20), Shadows(shape))[0], force, rtol=0, atol=1e-14)


def test_without_anything_that_casts_rays_shadows_are_refused_in_a_sentence(monkeypatch):
    shape = Shape((membranes.square(3.0, FILM), structures.bus([1, 1, 1], [0, 0, -1], GREY)))
    monkeypatch.setattr(shadows, "ray_caster", lambda: "")
    with pytest.raises(NoRaysError, match="pip install 'sailviz\\[shapes\\]'"):
        Shadows(shape)
    monkeypatch.setattr(shadows, "ray_caster", lambda: "rtree")
    assert why_no_rays(shape) == ""
    assert "more than 2000 take hours" in why_no_rays(subdivided(shape, 2e-4))


def test_facets_are_cut_until_each_is_a_small_share_of_the_films():
    shape = Shape((membranes.square(3.0, FILM, rows=2), structures.bus([1, 1, 1], [0, 0, -1], GREY)))
    fine = subdivided(shape, 1e-3)
    assert fine.parts[0].mesh.area_faces.max() <= 1e-3 * 9
    assert fine.parts[0].area == pytest.approx(9, rel=1e-12)
    assert len(fine.parts[1].mesh.faces) == 12
    np.testing.assert_allclose(
        force_and_torque(fine, tilted(30)), force_and_torque(shape, tilted(30)), rtol=0, atol=1e-12
    )
    assert len(subdivided(shape, 1e-9, 5000).elements) <= 5000


def test_points_in_a_triangle_are_the_middles_of_equal_ones():
    for samples in (1, 2, 5):
        points = shadows.points_in(samples)
        assert len(points) == samples**2
        np.testing.assert_allclose(points.sum(axis=1), 1, rtol=0, atol=1e-15)
        np.testing.assert_allclose(points.mean(axis=0), 1 / 3, rtol=0, atol=1e-15)
        assert points.min() > 0
