"""Coulomb drag of a charged tether: numbers re-derived from the force law, and the one that was published."""

from __future__ import annotations

import numpy as np
import pytest

from sailviz.constants import ATOMIC_MASS, MU_EARTH, RADIUS_EARTH
from sailviz.propulsion.plasma_brake import current, force_per_length, negative_force_per_length, power

OXYGEN = 15.999 * ATOMIC_MASS
TYPICAL = {"density": 3e10, "ion_mass": OXYGEN, "speed": 7500.0, "voltage": 1000.0}


# f = 3.864 P sqrt(eps0 Vt / (e n)) exp(-Vi / Vt), Vt = V / ln(lambda / r_w), evaluated independently; nN/m
@pytest.mark.parametrize(
    ("change", "expected"),
    [
        ({}, 84.64620),
        ({"density": 1e11}, 161.87860),
        ({"ion_mass": 1.00784 * ATOMIC_MASS}, 5.50295),
        ({"voltage": 2000.0}, 118.81899),
        ({"ion_mass": 8 * ATOMIC_MASS}, 43.04363),
        ({"density": 1e12, "speed": 7700.0}, 596.11471),
        ({"speed": np.sqrt(MU_EARTH / (RADIUS_EARTH + 600e3))}, 85.91261),
    ],
)
def test_drag_per_length_by_hand(change, expected):
    assert force_per_length(**TYPICAL | change) * 1e9 == pytest.approx(expected, abs=6e-6)


def test_the_steps_of_the_force_law_by_hand():
    """P = 4.48318e-8 Pa, Vi = 4.66363 V, lambda = 1.35725 m, Vt = 138.6345 V."""
    p, v_i, width, v_t = 4.48318e-8, 4.66363, 1.35725, 138.6345
    assert force_per_length(**TYPICAL) == pytest.approx(
        3.864 * p * width * np.sqrt(v_t / 1000) * np.exp(-v_i / v_t), rel=1e-5
    )


def test_five_kilometres_brake_with_the_published_0_43_millinewton():
    """Janhunen 2014, abstract: 5 km of tether, 0.43 mN; oxygen, 3e10 / m3, 1 kV, circular orbit at 600 km."""
    speed = np.sqrt(MU_EARTH / (RADIUS_EARTH + 600e3))
    assert 5e3 * force_per_length(**TYPICAL | {"speed": speed}) == pytest.approx(0.43e-3, abs=0.005e-3)


def test_local_exponents_of_the_drag():
    """Re-derived at the reference point: f ~ n^0.537 V^0.497 v^1.933 m^0.966, and hardly on the wire's radius."""
    for name, exponent in (("density", 0.537), ("voltage", 0.497), ("speed", 1.933), ("ion_mass", 0.966)):
        up, down = (force_per_length(**TYPICAL | {name: TYPICAL[name] * x}) for x in (1.001, 0.999))
        assert np.log(up / down) / np.log(1.001 / 0.999) == pytest.approx(exponent, abs=1e-3)
    thick = force_per_length(**TYPICAL, wire_radius=2e-3)
    assert np.log2(thick / force_per_length(**TYPICAL)) == pytest.approx(0.077, abs=0.003)


def test_positive_tether_follows_the_electric_sails_law():
    assert force_per_length(**TYPICAL, polarity="positive") * 1e9 == pytest.approx(112.878, abs=5e-4)


def test_an_unknown_polarity_is_refused():
    with pytest.raises(ValueError, match="negative"):
        force_per_length(**TYPICAL, polarity="neutral")


def test_where_the_sheath_is_no_wider_than_the_tether_there_is_no_law():
    """ln(lambda / r_w) <= 1: 1 kV at 1e16 / m3 has a sheath of 2.4 mm."""
    assert np.isnan(force_per_length(**TYPICAL | {"density": 1e16}))
    assert np.isnan(negative_force_per_length.py_func(1e16, OXYGEN, 7500.0, 1000.0, 1e-3))


def test_arrays_broadcast():
    found = force_per_length(np.array([3e10, 1e11]), OXYGEN, 7500.0, np.array([[1000.0], [2000.0]]))
    assert found.shape == (2, 2)
    assert found[0] * 1e9 == pytest.approx([84.64620, 161.87860], abs=6e-6)


def test_propagator_and_public_function_have_one_law():
    for density in (1e9, 3e10, 1e12):
        inside = negative_force_per_length.py_func(density, OXYGEN, 7400.0, 800.0, 5e-4)
        assert inside == pytest.approx(float(force_per_length(density, OXYGEN, 7400.0, 800.0, 5e-4)), rel=1e-14)


# ---------------------------------------------------------------- current and power
def test_ion_current_of_five_kilometres_by_hand():
    """OML cylinder, 50 um: I = e n D L sqrt(2 e V / m) = 1.31969e-4 A, 0.13197 W; the ram adds 0.2 %."""
    at_rest = TYPICAL | {"speed": 0.0, "length": 5e3, "wire_diameter": 50e-6}
    assert current(**at_rest) == pytest.approx(1.31969e-4, rel=4e-6)
    assert power(**at_rest) == pytest.approx(0.13197, rel=4e-5)
    assert current(**at_rest | {"length": 300.0}) == pytest.approx(7.91812e-6, rel=4e-6)
    assert current(**at_rest | {"speed": 7500.0}) == pytest.approx(1.32276e-4, rel=4e-6)


def test_a_positive_tether_collects_171_times_the_current():
    """Electrons instead of oxygen ions: sqrt(m_i / m_e), 22.537 W."""
    at = TYPICAL | {"length": 5e3, "wire_diameter": 50e-6, "polarity": "positive"}
    assert current(**at) == pytest.approx(2.25371e-2, rel=4e-6)
    assert power(**at) == pytest.approx(22.537, rel=3e-5)


def test_losses_of_the_supply_cost_power():
    at = TYPICAL | {"length": 5e3, "wire_diameter": 50e-6}
    assert power(**at, efficiency=0.5) == pytest.approx(2 * power(**at), rel=1e-15)
