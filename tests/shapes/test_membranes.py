"""Curved and twisted films against closed forms and quadratures made elsewhere. Forces over 2 P A, torques over 2 P A
times a length; u = (sin a cos d, sin a sin d, cos a)."""

import numpy as np
import pytest

from sailviz.constants import RADIATION_PRESSURE
from sailviz.shapes import membranes
from sailviz.shapes.facets import Coefficients, Part, Shape, Surface, film_inertia
from sailviz.shapes.light_force import Tensors, force_and_torque, tensors

IDEAL = Coefficients(0.0, 1.0, 0.0)
JPL_2015 = Coefficients(0.0723, 0.8554, -0.0030)


def film(b: Coefficients) -> Surface:
    return Surface(b, b)


def light(a: float, d: float = 0.0) -> np.ndarray:
    a, d = np.radians([a, d])
    return np.array([[np.sin(a) * np.cos(d), np.sin(a) * np.sin(d), np.cos(a)]])


def from_front(part: Part, smooth: bool = True) -> Tensors:
    return tensors(Shape((part,)), "front", smooth)


@pytest.mark.parametrize(
    ("b", "psi", "a", "force_z", "force_x", "torque"),
    [
        (IDEAL, 10, 35, 0.663373421997, 0.007083799903, 0.0),
        (JPL_2015, 10, 0, 0.911825997183, 0.0, 0.0),
        (JPL_2015, 20, 35, 0.594770262910, 0.057424530906, 0.093331500885),
    ],
)
def test_a_cap_is_pushed_as_the_closed_form_says(b, psi, a, force_z, force_x, torque):
    """Torque about the sphere's centre, over 2 P A a_m."""
    part = membranes.cap(2.0, film(b), np.radians(psi))
    found = from_front(part)
    force = found.force(light(a))[0]
    centre = np.array([0.0, 0.0, -1 / np.tan(np.radians(psi))])
    about_it = found.torque(light(a))[0] - np.cross(centre, force)
    np.testing.assert_allclose(force / np.pi, [force_x, 0, force_z], rtol=0, atol=2e-12)
    np.testing.assert_allclose(about_it / np.pi, [0, torque, 0], rtol=0, atol=2e-12)


@pytest.mark.parametrize(
    ("b", "diameter", "psi", "a"),
    [
        (JPL_2015, 2.0, 1.0, 80.0),
        (Coefficients(0.2, 0.5, 0.1), 31.0, 12.5, 64.0),
        (Coefficients(0.5, 0.0, 0.0), 400.0, 30.0, 59.0),
        (IDEAL, 0.3, 44.0, 44.0),
    ],
)
def test_any_cap_is_pushed_as_the_closed_form_says(b, diameter, psi, a):
    """Other films, sizes, slopes and incidences up to the last at which its front alone is lit."""
    s, k = np.sin(np.radians(psi)), np.cos(np.radians(psi))
    sin, cos = np.sin(np.radians(a)), np.cos(np.radians(a))
    lifted = 2 / 3 - k + k**3 / 3
    force_z = b.b2 * ((1 + k * k) / 2 * cos**2 + s * s / 4 * sin**2) + b.b1 * cos**2
    force_z += b.b3 * (2 / 3) * (1 - k**3) / s**2 * cos
    force_x = b.b2 * s * s / 2 * sin * cos + b.b3 * lifted / s**2 * sin + b.b1 * sin * cos
    about_centre = b.b1 * ((2 / 3) * (1 - k**3) - lifted) / s**3 * sin * cos
    found = from_front(membranes.cap(diameter, film(b), np.radians(psi)))
    area, mouth = np.pi * diameter**2 / 4, diameter / 2
    force, torque = found.force(light(a))[0], found.torque(light(a))[0]
    centre = np.array([0.0, 0.0, -mouth / np.tan(np.radians(psi))])
    np.testing.assert_allclose(force / area, [force_x, 0, force_z], rtol=0, atol=2e-12)
    # rounding of the arm to a centre that lies far off
    near = 2e-12 * max(1.0, 1 / np.tan(np.radians(psi)))
    about_it = (torque - np.cross(centre, force)) / (area * mouth)
    np.testing.assert_allclose(about_it, [0, about_centre, 0], rtol=0, atol=near)


@pytest.mark.parametrize("psi", [5, 25, 45])
def test_an_ideal_cap_facing_the_sun_has_half_of_one_and_the_cosine_squared(psi):
    found = from_front(membranes.cap(3.0, film(IDEAL), np.radians(psi)))
    expected = np.pi * 1.5**2 * (1 + np.cos(np.radians(psi)) ** 2) / 2
    np.testing.assert_allclose(found.force(light(0))[0, 2], expected, rtol=1e-13)


@pytest.mark.parametrize("a", [0, 20, 50])
def test_the_force_of_an_ideal_cap_passes_through_its_spheres_centre(a):
    found = from_front(membranes.cap(2.0, film(IDEAL), np.radians(30)))
    force, torque = found.force(light(a))[0], found.torque(light(a))[0]
    np.testing.assert_allclose(torque, np.cross([0, 0, -1 / np.tan(np.radians(30))], force), rtol=0, atol=1e-13)


ROWS = [
    (0, 0, 35, 0, (0.033969888200, 0, 0.620038587300), (0, 0)),
    (5, 0, 35, 0, (0.037016259506, 0, 0.616756743322), (0, 0.013181558672)),
    (3, 0.03, 35, 0, (0.042821038477, 0, 0.610503212319), (0, 0.013922528120)),
    (3, 0.03, 60, 20, (0.037073473149, 0.013493640707, 0.232801577665), (-0.004383097514, 0.012042461446)),
    (0, 0.05, 60, 20, (0.040042441472, 0.014574256803, 0.233723568536), (-0.003162132216, 0.008687886862)),
]


@pytest.mark.parametrize(("cone", "sag", "a", "d", "force", "torque"), ROWS)
def test_a_square_sail_is_pushed_as_the_line_integrals_say(cone, sag, a, d, force, torque):
    found = from_front(membranes.square(3.0, film(JPL_2015), np.radians(cone), sag))
    # the flat row is printed with ten digits
    np.testing.assert_allclose(found.force(light(a, d))[0] / 9, force, rtol=0, atol=1e-10 if cone + sag == 0 else 1e-12)
    np.testing.assert_allclose(found.torque(light(a, d))[0] / 27, [*torque, 0], rtol=0, atol=1e-12)


@pytest.mark.parametrize(
    ("b", "side", "cone", "sag", "a", "d"),
    [
        (JPL_2015, 40.0, 7.0, 0.02, 70.0, 45.0),
        (JPL_2015, 1.0, -4.0, 0.06, 25.0, 200.0),
        (Coefficients(0.3, 0.4, 0.05), 9.27, 2.0, -0.04, 50.0, 310.0),
    ],
)
def test_any_square_sail_is_pushed_as_an_integral_over_its_quadrants_says(b, side, cone, sag, a, d):
    """Each quadrant by adaptive quadrature over its strips t from boom to boom, x from the hub to the edge."""
    from scipy.integrate import quad_vec

    u, slope = light(a, d)[0], np.tan(np.radians(cone))

    def strip(t: float, turn: int) -> np.ndarray:
        """Force over x dx dt, and torque about the hub over x^2 dx dt."""
        c, s = ((1, 0), (0, 1), (-1, 0), (0, -1))[turn]
        m = np.array([-(slope + 2 * sag * (1 + t * t)), 4 * sag * t, 1.0])
        r = np.array([1.0, t, slope + 2 * sag * (1 - t * t)])
        m, r = (np.array([c * v[0] - s * v[1], s * v[0] + c * v[1], v[2]]) for v in (m, r))
        w = np.linalg.norm(m)
        cosine = m @ u / w
        push = w * cosine * (b.b1 * u + (b.b2 * cosine + b.b3) * m / w)
        return np.concatenate([push / 8, np.cross(r, push) / 24])

    whole = sum(quad_vec(lambda t, turn=turn: strip(t, turn), -1, 1, epsabs=1e-14)[0] for turn in range(4))
    found = from_front(membranes.square(side, film(b), np.radians(cone), sag))
    np.testing.assert_allclose(found.force(light(a, d))[0] / side**2, whole[:3], rtol=0, atol=1e-12)
    np.testing.assert_allclose(found.torque(light(a, d))[0] / side**3, whole[3:], rtol=0, atol=1e-12)


@pytest.mark.parametrize(("cone", "sag", "a", "d", "force", "torque"), ROWS)
def test_its_facets_come_nearer_with_the_square_of_their_size(cone, sag, a, d, force, torque):
    """Within 1e-6 at 8 x 128 facets a quadrant, and exact, to the row's ten digits, where the quadrants are plane."""
    found = [
        from_front(membranes.square(3.0, film(JPL_2015), np.radians(cone), sag, rows), smooth=False)
        for rows in (16, 32)
    ]
    wrong = [np.abs(each.force(light(a, d))[0] / 9 - force).max() for each in found]
    if sag == 0:
        assert wrong[1] < 1e-10
    else:
        assert wrong[1] == pytest.approx(wrong[0] / 4, rel=0.02)
        assert wrong[1] < 1e-5


def test_a_twisted_blade_is_pushed_and_turned_as_the_closed_form_says():
    """Length 100 m, chord 0.75 m, pitch 10 deg, twist 15 deg, ideal, facing the Sun at 1 au: N, N, N m."""
    blade = membranes.heliogyro(1, 100.0, 0.75, film(IDEAL), np.radians(10), np.radians(15))
    found = from_front(blade)
    force, torque = (2 * RADIATION_PRESSURE * each(light(0))[0] for each in (found.force, found.torque))
    assert force[2] == pytest.approx(5.896916954161e-4, rel=1e-12)
    assert force[1] == pytest.approx(1.835980538969e-4, rel=1e-12)
    assert torque[2] == pytest.approx(1.020663806830e-2, rel=1e-12)
    of_facets = 2 * RADIATION_PRESSURE * from_front(blade, smooth=False).force(light(0))[0]
    np.testing.assert_allclose(of_facets, force, rtol=0, atol=1e-5 * force[2])


@pytest.mark.parametrize(
    ("length", "chord", "t0", "tw"), [(30.0, 2.0, -20.0, 50.0), (750.0, 0.3, 35.0, -10.0), (10.0, 1.0, 5.0, 3.0)]
)
def test_any_twisted_blade_is_pushed_and_turned_as_the_closed_form_says(length, chord, t0, tw):
    """Ideal, facing the Sun; the brackets from t0 to t0 + tw."""
    t = np.radians([t0, t0 + tw])
    twist = t[1] - t[0]

    def bracket(values: np.ndarray) -> float:
        return float(values[1] - values[0])

    turned = bracket(-(np.cos(t) ** 3) / 3)
    g = bracket(-t * np.cos(t) ** 3 / 3 + (np.sin(t) - np.sin(t) ** 3 / 3) / 3)
    found = from_front(membranes.heliogyro(1, length, chord, film(IDEAL), t[0], twist))
    force, torque = found.force(light(0))[0], found.torque(light(0))[0]
    strip = chord * length / twist
    assert force[2] == pytest.approx(strip * bracket(np.sin(t) - np.sin(t) ** 3 / 3), rel=1e-12)
    assert force[1] == pytest.approx(strip * turned, rel=1e-11)
    assert torque[2] == pytest.approx(strip * length / twist * (g - t[0] * turned), rel=1e-11)


FLAT = [
    membranes.disc(6.0, film(JPL_2015)),
    membranes.ring(9.0, 2.0, film(JPL_2015)),
    membranes.cap(4.0, film(JPL_2015), 0.0),
    membranes.square(200.0, film(JPL_2015)),
    membranes.pyramid(3.0, film(JPL_2015), 0.0, 1.1),
    membranes.heliogyro(6, 50.0, 1.0, film(JPL_2015)),
]


@pytest.mark.parametrize("part", FLAT, ids=["disc", "ring", "cap", "square", "pyramid", "heliogyro"])
@pytest.mark.parametrize("a", [0, 35, 89, 91, 150])
def test_every_flat_shape_is_the_flat_film(part, a):
    """Of the same area, from the front and from behind, and without a torque about its middle: within 1e-12."""
    u = light(a, 30)
    force, torque = force_and_torque(Shape((part,)), u)
    c, m = abs(u[0, 2]), np.array([0, 0, np.sign(u[0, 2])])
    flat = c * (JPL_2015.b1 * u[0] + (JPL_2015.b2 * c + JPL_2015.b3) * m)
    of_facets = part.elements.area.sum()  # a round edge has chords
    np.testing.assert_allclose(force[0] / of_facets, flat, rtol=0, atol=1e-12)
    np.testing.assert_allclose(torque[0] / part.area**1.5, 0, rtol=0, atol=1e-12)
    found = tensors(Shape((part,)), "front" if a < 90 else "back")
    np.testing.assert_allclose(found.force(u)[0] / part.area, flat, rtol=0, atol=1e-12)


def test_blades_all_round_push_along_the_axis_alone_and_turn_about_it():
    found = from_front(membranes.heliogyro(4, 100.0, 0.75, film(IDEAL), np.radians(10), np.radians(15)))
    force, torque = (2 * RADIATION_PRESSURE * each(light(0))[0] for each in (found.force, found.torque))
    np.testing.assert_allclose(force, [0, 0, 4 * 5.896916954161e-4], rtol=0, atol=1e-15)
    np.testing.assert_allclose(torque, [0, 0, 4 * 1.020663806830e-2], rtol=0, atol=1e-13)


@pytest.mark.parametrize(
    ("part", "area"),
    [
        (membranes.disc(4.0, film(IDEAL)), 4 * np.pi),
        (membranes.ring(4.0, 2.0, film(IDEAL)), 3 * np.pi),
        (membranes.square(5.0, film(IDEAL)), 25.0),
        (membranes.cap(2.0, film(IDEAL), np.radians(60)), 2 * np.pi * (2 / np.sqrt(3)) ** 2 * 0.5),
        (membranes.pyramid(2.0, film(IDEAL), 0.0), 8.0),
    ],
)
def test_areas_are_those_of_the_figures(part, area):
    assert part.area == pytest.approx(area, rel=1e-12)


@pytest.mark.parametrize("opening", [60, 90, 110])
def test_a_pyramid_has_its_apex_towards_the_sun_and_rights_itself(opening):
    """Edges downwind: light from the side turns it back, so that the torque about y has the sign of the tilt in x."""
    part = membranes.pyramid(5.0, film(IDEAL), np.radians(20), np.radians(opening))
    assert part.mesh.vertices[:, 2].min() == pytest.approx(0.0, abs=1e-15)
    assert part.mesh.vertices[:, 2].max() == pytest.approx(5 * np.sin(np.radians(20)))
    found = from_front(part)
    assert found.torque(light(10))[0, 1] > 0
    assert found.torque(light(-10))[0, 1] < 0


@pytest.mark.parametrize(
    "part",
    [
        membranes.square(3.0, film(IDEAL), 0.1, 0.03),
        membranes.cap(3.0, film(IDEAL), 0.4),
        membranes.heliogyro(3, 10.0, 0.5, film(IDEAL), 0.2, 0.1),
        membranes.pyramid(3.0, film(IDEAL), 0.3, 1.2),
    ],
    ids=["square", "cap", "heliogyro", "pyramid"],
)
def test_every_facet_has_its_front_towards_the_sun(part):
    assert np.all(part.elements.normal[:, 2] < 0)
    assert part.smooth is None or np.all(part.smooth.normal[:, 2] < 0)


def test_the_inertia_of_a_film_is_that_of_a_plate():
    """10 x 10 m of 1 kg/m2: 2500 / 3, 2500 / 3, 5000 / 3 m4; and of any part, whatever its facets."""
    for rows in (1, 7):
        found = film_inertia(membranes.square(10.0, film(IDEAL), rows=rows).mesh.triangles)
        np.testing.assert_allclose(found, np.diag([2500 / 3, 2500 / 3, 5000 / 3]), rtol=0, atol=1e-9)
