"""Free molecular air on facets: against quadrature of the Maxwellian flux, and the hyperthermal limit."""

import numpy as np
import pytest

from sailviz.shapes import membranes, structures
from sailviz.shapes.air_law import Air
from sailviz.shapes.facets import Coefficients, Shape, Surface
from sailviz.shapes.light_force import force_and_torque

ROWS = [
    (8, 30, 1.0, 1.0, 0.3, 1.620718585307, 0.866025403784, 1.6051, 0.8660),
    (5, 75, 0.9, 0.8, 0.5, 0.249768911612, 0.402891230569, 0.2058, 0.4000),
]


@pytest.mark.parametrize(("s", "angle", "sn", "st", "ratio", "p", "tau", "fast_p", "fast_tau"), ROWS)
def test_pressure_and_shear_are_those_of_the_quadrature(s, angle, sn, st, ratio, p, tau, fast_p, fast_tau):
    """Over rho V^2 / 2; the limit to its printed digits."""
    air, c = Air(s, sn, st, ratio), np.cos(np.radians(angle))
    found = air.pressure_and_shear(np.array([c]))
    np.testing.assert_allclose([found[0][0], found[1][0]], [p, tau], rtol=0, atol=1e-12)
    b1, b2, b3 = air.hyperthermal
    sine = np.sin(np.radians(angle))
    np.testing.assert_allclose(
        [4 * c * ((b1 + b2) * c + b3), 4 * c * b1 * sine], [fast_p, fast_tau], rtol=0, atol=5.1e-5
    )


@pytest.mark.parametrize(("s", "sn", "st", "ratio"), [(3.0, 0.7, 0.9, 0.4), (7.0, 1.0, 1.0, 1.0)])
@pytest.mark.parametrize("angle", [0, 40, 85, 120])
def test_pressure_is_what_a_maxwellian_gas_brings_and_takes_away(s, sn, st, ratio, angle):
    """Own quadrature: incoming normal momentum of the drifting gas; a share sn leaves diffusely, the rest is thrown
    back. Lengths of velocity in units of the most probable speed."""
    from scipy.integrate import quad

    a, t = s * np.cos(np.radians(angle)), s * np.sin(np.radians(angle))

    def density(w: float) -> float:
        return float(np.exp(-((w - a) ** 2)) / np.sqrt(np.pi))

    reach = max(a, 0.0) + 12
    flux = quad(lambda w: w * density(w), 0, reach, epsabs=1e-14, limit=200)[0]
    incoming = quad(lambda w: w * w * density(w), 0, reach, epsabs=1e-14, limit=200)[0]
    diffuse = 0.5 * np.sqrt(np.pi * ratio) * flux
    expected = 2 * ((2 - sn) * incoming + sn * diffuse) / s**2
    found = Air(s, sn, st, ratio).pressure_and_shear(np.array([np.cos(np.radians(angle))]))
    assert found[0][0] == pytest.approx(expected, abs=1e-11)
    assert found[1][0] == pytest.approx(2 * st * t * flux / s**2, abs=1e-11)


def test_fast_gas_pushes_a_box_as_light_of_the_limit_does():
    air = Air(300.0, 0.9, 0.8, 0.5)
    shape = Shape((structures.bus([1.0, 2.0, 3.0], [0.1, 0.2, 0.3], air.hyperthermal),))
    u = np.array([[0.48, 0.6, 0.64]])
    light, air_force = force_and_torque(shape, u), force_and_torque(shape, u, law=air)
    np.testing.assert_allclose(air_force, light, rtol=1e-4)


def test_a_film_across_the_flow_feels_both_of_its_sides():
    """Full law, over 2 rho V^2: the front's pressure less that of the lee."""
    air, b = Air(4.0, 1.0, 1.0, 1.0), Coefficients(0.5, 0.0, 0.0)
    shape = Shape((membranes.square(2.0, Surface(b, b)),))
    front, lee = air.pressure_and_shear(np.array([1.0, -1.0]))[0]
    force, _ = force_and_torque(shape, np.array([[0.0, 0.0, 1.0]]), law=air)
    np.testing.assert_allclose(force[0], [0, 0, 4 * (front - lee) / 4], rtol=0, atol=1e-12)
    edge_on, _ = force_and_torque(shape, np.array([[1.0, 0.0, 0.0]]), law=air)
    shear = air.pressure_and_shear(np.array([0.0]))[1][0]
    np.testing.assert_allclose(edge_on[0], [4 * 2 * shear / 4, 0, 0], rtol=0, atol=1e-12)
