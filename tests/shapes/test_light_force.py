"""Force and torque of light on facets: the tensors against the sum, the flat limit, moved origins, pressures."""

from dataclasses import replace

import numpy as np
import pytest

from sailviz.constants import AU, RADIATION_PRESSURE
from sailviz.propulsion import solar_sail
from sailviz.shapes import membranes, structures
from sailviz.shapes.facets import Coefficients, Elements, Part, Shape, Surface, elements_of
from sailviz.shapes.light_force import force_and_torque, pressure, pushed, tensors
from sailviz.shapes.primitives import moved

JPL_2015 = Coefficients(0.0723, 0.8554, -0.0030)
BACK = Coefficients(0.35, 0.3, 0.02)
TWO_SIDED = Surface(JPL_2015, BACK)


def near(axis: float, count: int, widest: float) -> np.ndarray:
    """Directions within an angle of +z or -z."""
    random = np.random.default_rng(5)
    c, d = random.uniform(np.cos(widest), 1, count), random.uniform(0, 2 * np.pi, count)
    s = np.sqrt(1 - c * c)
    return np.stack([s * np.cos(d), s * np.sin(d), axis * c], axis=1)


@pytest.mark.parametrize(("side", "axis"), [("front", 1.0), ("back", -1.0)])
@pytest.mark.parametrize(
    "part",
    [
        membranes.square(7.0, TWO_SIDED, np.radians(4), 0.03),
        membranes.cap(7.0, TWO_SIDED, np.radians(15)),
        membranes.heliogyro(3, 20.0, 1.0, TWO_SIDED, 0.2, 0.1),
        membranes.pyramid(5.0, TWO_SIDED, 0.3, 1.2),
    ],
    ids=["square", "cap", "heliogyro", "pyramid"],
)
def test_tensors_are_the_sum_over_facets_where_one_side_is_lit(part, side, axis):
    shape = Shape((replace(part, smooth=None),))
    u = near(axis, 40, np.radians(60))
    force, torque = force_and_torque(shape, u)
    found = tensors(shape, side)
    np.testing.assert_allclose(found.force(u), force, rtol=0, atol=1e-12 * part.area)
    np.testing.assert_allclose(found.torque(u), torque, rtol=0, atol=1e-12 * part.area * shape.size)


def test_there_are_fifty_five_numbers():
    assert len(tensors(Shape((membranes.cap(2.0, TWO_SIDED, 0.2),)), "front").numbers()) == 55


@pytest.mark.parametrize("name", ["ideal", "jpl-1978", "jpl-2015"])
@pytest.mark.parametrize("pitch", [0.0, 35.0, 60.0, 89.0])
def test_a_flat_shape_is_the_flat_sail(name, pitch):
    """In 1e-12 of the characteristic acceleration: ac = 2 P (A / m)(b1 + b2 + b3)."""
    film = solar_sail.film(name)
    b = Coefficients(film.b1, film.b2, film.b3)
    shape = Shape((membranes.square(9.27, Surface(b, b)),))
    a, mass = np.radians(pitch), 14.0
    strength = film.characteristic_acceleration(area=9.27**2, mass=mass)
    n = np.array([np.cos(a), np.sin(a), 0.0])
    flat = solar_sail.acceleration([AU, 0, 0], n, strength, film)
    force, _ = force_and_torque(shape, np.array([[np.sin(a), 0.0, np.cos(a)]]))
    # x_b is where the light leans to: u = cos a z_b + sin a x_b
    z, x = n, np.array([np.sin(a), -np.cos(a), 0.0])
    found = 2 * RADIATION_PRESSURE / mass * (force[0, 0] * x + force[0, 2] * z)
    np.testing.assert_allclose(found, flat, rtol=0, atol=1e-12 * strength)


def test_the_back_of_a_film_is_pushed_by_its_own_coefficients():
    """Light from behind on one triangle, by hand: 2 P A c [b1 u + (b2 c + b3) m], m = +N."""
    triangle = np.array([[[0, 0, 0], [0, 1, 0], [1, 0, 0.0]]])  # front along -z
    elements = elements_of(triangle)
    np.testing.assert_allclose(elements.normal, [[0, 0, -1]])
    a = np.radians(25)
    u = np.array([[np.sin(a), 0, -np.cos(a)]])
    force, torque = pushed(elements, np.array([JPL_2015]), np.array([BACK]), u)
    c, m = np.cos(a), np.array([0, 0, -1.0])
    by_hand = 0.5 * c * (BACK.b1 * u[0] + (BACK.b2 * c + BACK.b3) * m)
    np.testing.assert_allclose(force[0], by_hand, rtol=0, atol=1e-16)
    np.testing.assert_allclose(torque[0], np.cross([1 / 3, 1 / 3, 0], by_hand), rtol=0, atol=1e-16)


def test_the_back_of_a_closed_body_is_never_lit():
    """A black box: the light that falls on its shadow, 2 P b1 A u with b1 = 1/2, whatever the direction."""
    shape = Shape((structures.bus([1.0, 2.0, 3.0], [0, 0, 0], Coefficients(0.5, 0.0, 0.0)),))
    for u in np.concatenate([near(1.0, 10, np.pi / 2), near(-1.0, 10, np.pi / 2)]):
        shadow = abs(u) @ [6.0, 3.0, 2.0]
        force, torque = force_and_torque(shape, u[None])
        np.testing.assert_allclose(force[0], 0.5 * shadow * u, rtol=0, atol=1e-14)
        np.testing.assert_allclose(torque[0], 0, rtol=0, atol=1e-14)


def test_a_moved_shape_turns_by_its_arm_and_no_more():
    part = membranes.square(7.0, TWO_SIDED, np.radians(4), 0.03)
    arm, u = np.array([0.3, -0.2, 1.5]), near(1.0, 10, 1.0)
    force, torque = force_and_torque(Shape((part,)), u)
    away = Part("film", moved(part.mesh, arm), TWO_SIDED)
    force_away, torque_away = force_and_torque(Shape((away,)), u)
    np.testing.assert_allclose(force_away, force, rtol=0, atol=1e-12)
    np.testing.assert_allclose(torque_away, torque + np.cross(arm, force), rtol=0, atol=1e-11)


def test_pressures_sum_to_the_force_along_a_facets_normal():
    """p = 2 P c [(b1 + b2) c + b3] along m, of both sides."""
    shape = Shape((membranes.square(7.0, TWO_SIDED, np.radians(4), 0.03),))
    for axis in (1.0, -1.0):
        u = near(axis, 3, 0.8)
        for one in u:
            d = shape.elements.normal @ one
            m = shape.elements.normal * np.sign(d)[:, None]
            found = pressure(shape, one)
            b = JPL_2015 if axis > 0 else BACK
            np.testing.assert_allclose(found, abs(d) * ((b.b1 + b.b2) * abs(d) + b.b3), rtol=0, atol=1e-15)
            across = one - d[:, None] * shape.elements.normal
            shear = b.b1 * np.abs(d)[:, None] * across
            force, _ = force_and_torque(shape, one[None])
            np.testing.assert_allclose(
                (shape.elements.area[:, None] * (found[:, None] * m + shear)).sum(axis=0), force[0], atol=1e-12
            )


def test_quadratures_are_elements_too():
    assert isinstance(membranes.cap(2.0, TWO_SIDED, 0.2).smooth, Elements)
