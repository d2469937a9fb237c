"""Coulomb drag of a charged tether: numbers re-derived from the force law, and the one that was published."""

from __future__ import annotations

import numpy as np
import pytest

from sailviz.constants import ATOMIC_MASS, MU_EARTH, RADIUS_EARTH
from sailviz.propulsion.plasma_brake import (
    PHOTOELECTRONS,
    REASONS,
    current,
    electron_flux,
    force_per_length,
    magnetic_factor,
    negative_force_per_length,
    positive_force_per_length,
    power,
    power_limited_voltage,
    species_force_per_length,
    spin_factor,
    tether_mass,
    tether_tilt,
    tilt,
    tip_tension,
    validity,
    wire_mass,
)

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


# P Pa, Vi V, lambda m, Vt V where tabled, and the force nN/m that follows
@pytest.mark.parametrize(
    ("change", "p", "v_i", "sheath", "v_t", "expected"),
    [
        ({}, 4.48318e-8, 4.66363, 1.35725, 138.6345, 84.64620),
        ({"density": 1e11}, 4.48318e-8 / 0.3, 4.66363, 0.74339, 151.2579, 161.87860),
        ({"ion_mass": 1.00784 * ATOMIC_MASS}, 2.82413e-9, 0.29378, 1.35725, 138.6345, 5.50295),
        ({"voltage": 2000.0}, 4.48318e-8, 4.66363, 1.35725 * np.sqrt(2), 264.5577, 118.81899),
    ],
)
def test_the_steps_of_the_force_law_by_hand(change, p, v_i, sheath, v_t, expected):
    """f = 3.864 P lambda sqrt(Vt / V) exp(-Vi / Vt) and Vt = V / ln(lambda / 1 mm), digits as tabled."""
    voltage = change.get("voltage", 1000.0)
    assert voltage / np.log(sheath / 1e-3) == pytest.approx(v_t, rel=2e-6)
    by_hand = 3.864 * p * sheath * np.sqrt(v_t / voltage) * np.exp(-v_i / v_t)
    assert by_hand * 1e9 == pytest.approx(expected, rel=1e-5)
    assert force_per_length(**TYPICAL | change) == pytest.approx(by_hand, rel=1e-5)


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


def test_secondary_and_photo_electrons_add_to_a_negative_tethers_current():
    at = TYPICAL | {"length": 5e3, "wire_diameter": 50e-6}
    assert current(**at, secondary_yield=0.5) == pytest.approx(1.5 * current(**at))
    lit = current(**at, photoemission=PHOTOELECTRONS) - current(**at)
    assert lit == pytest.approx(40e-6 * 50e-6 * 5e3)
    assert power(**at, photoemission=PHOTOELECTRONS) == pytest.approx(power(**at) + 1000 * lit)
    positive = at | {"polarity": "positive"}
    assert current(**positive, secondary_yield=0.5, photoemission=1.0) == current(**positive)


def test_electrons_close_the_circuit_through_the_body():
    """e n sqrt(T / (2 pi m_e)) at 0.15 eV and 3e10 / m3: 3.1146e-4 A/m2; 0.132 mA takes 0.42 m2."""
    assert electron_flux(3e10, 0.15) == pytest.approx(3.1146e-4, rel=2e-5)
    assert 1.31969e-4 / electron_flux(3e10, 0.15) == pytest.approx(0.42, abs=0.005)


def test_voltage_follows_the_two_thirds_power_of_the_available_power():
    """And drawing that power at that voltage: P ~ V^1.5 without the ram speed."""
    at = TYPICAL | {"speed": 0.0, "length": 5e3, "wire_diameter": 50e-6}
    nominal = power(**at)
    for share in (0.05, 0.5, 1.0):
        voltage = power_limited_voltage(1000.0, nominal, share * nominal)
        assert power(**at | {"voltage": voltage}) == pytest.approx(share * nominal, rel=1e-12)
    assert power_limited_voltage(1000.0, nominal, np.array([-1.0, 2 * nominal])).tolist() == [0.0, 1000.0]


# ---------------------------------------------------------------- composition, field
def test_one_species_is_the_force_law_itself():
    assert species_force_per_length([3e10], [OXYGEN], 7500.0, 1000.0) * 1e9 == pytest.approx(84.64620, abs=6e-6)


def test_mean_ion_mass_stands_for_the_mixture():
    """Within 2.1 % from pure oxygen to mostly hydrogen, 1 kV."""
    hydrogen = 1.008 * ATOMIC_MASS
    share = np.linspace(0, 1, 21)
    mixture = 3e10 * np.stack([share, 1 - share], axis=-1)
    each = species_force_per_length(mixture, [OXYGEN, hydrogen], 7500.0, 1000.0)
    mean = force_per_length(3e10, share * OXYGEN + (1 - share) * hydrogen, 7500.0, 1000.0)
    assert each == pytest.approx(mean, rel=0.021)
    assert each[[0, -1]] == pytest.approx(mean[[0, -1]], rel=1e-14)
    assert np.isnan(species_force_per_length([1e16], [OXYGEN], 7500.0, 1000.0))


def test_field_along_the_tether_weakens_it_only_if_asked():
    assert magnetic_factor(0.0) == 1
    assert magnetic_factor(np.array([0, np.pi / 3, np.pi / 2]), 0.3) == pytest.approx([0.7, 0.925, 1.0])


def test_propagator_and_public_function_have_one_positive_law():
    for voltage in (2.0, 500.0, 1000.0):
        inside = positive_force_per_length.py_func(3e10, OXYGEN, 7500.0, voltage)
        outside = float(force_per_length(3e10, OXYGEN, 7500.0, voltage, polarity="positive"))
        assert inside == pytest.approx(outside, rel=1e-14)


# ---------------------------------------------------------------- mass, attitude
def test_masses_of_published_tethers():
    """Janhunen 2014, abstract: 55 g on 5 km. One 50 um aluminium wire 5.301 g/km, 25 um 1.325 g/km."""
    assert tether_mass(5e3) == pytest.approx(0.0550)
    assert wire_mass(50e-6) * 1e6 == pytest.approx(5.301, abs=6e-4)
    assert wire_mass(25e-6) * 1e6 == pytest.approx(1.325, abs=6e-4)
    assert tether_mass(300, wire_mass(50e-6, wires=2)) == pytest.approx(2 * 5.301e-6 * 300, rel=1e-4)


def test_drag_tilts_a_hanging_tether():
    """5 km, 1 kg tip, 55 g of tether, 0.43 mN, 800 km: 0.7483 deg, 16.17 mN. A 300 m CubeSat tether with a 5 g tip at
    solar minimum hangs at 43 deg."""
    rate = np.sqrt(MU_EARTH / (RADIUS_EARTH + 800e3) ** 3)
    assert np.degrees(tilt(0.43e-3, rate, 1.0, 0.055, 5e3)) == pytest.approx(0.7483, abs=6e-5)
    assert tip_tension(rate, 1.0, 5e3) * 1e3 == pytest.approx(16.17, abs=6e-3)
    assert tether_tilt.py_func(0.43e-3, rate, 1.0, 0.055, 5e3) == pytest.approx(tilt(0.43e-3, rate, 1.0, 0.055, 5e3))
    low = np.sqrt(MU_EARTH / (RADIUS_EARTH + 700e3) ** 3)
    assert np.degrees(tilt(300 * 34.916e-9, low, 5e-3, 300 * 5.301e-6, 300)) == pytest.approx(43, abs=0.5)


def test_tilt_balances_the_moments_of_drag_and_gravity_gradient():
    """About the hinge: F cos^2 (L / 2) = 3 n^2 sin cos (m_tip L^2 + m L^2 / 3); the drag is across the tether and goes
    with the square of the speed across."""
    force, rate, tip, mass, length = 2e-3, 1.04e-3, 0.4, 0.3, 2e3
    angle = tilt(force, rate, tip, mass, length)
    restoring = 3 * rate**2 * np.sin(angle) * np.cos(angle) * (tip + mass / 3) * length**2
    assert force * np.cos(angle) ** 2 * length / 2 == pytest.approx(restoring, rel=1e-12)


def test_spinning_tether_brakes_less():
    """<|sin|^3> = 4 / (3 pi) edge-on to the flow, all of it face-on; between, against a fine sum over the turn."""
    assert spin_factor() == pytest.approx(4 / (3 * np.pi), rel=1e-12)
    assert spin_factor(np.pi / 2) == pytest.approx(1.0, rel=1e-15)
    phase = np.linspace(0, 2 * np.pi, 20000, endpoint=False)
    angles = np.array([0.2, 0.7, 1.2])
    summed = [np.mean(np.linalg.norm(np.cross(
        np.stack([np.cos(a) * np.cos(phase), np.sin(phase), np.sin(a) * np.cos(phase)], axis=-1), [1.0, 0, 0]
    ), axis=-1) ** 3) for a in angles]  # fmt: skip
    assert spin_factor(angles) == pytest.approx(summed, rel=1e-6)


# ---------------------------------------------------------------- validity
def test_reference_point_keeps_every_assumption():
    found = validity(**TYPICAL, length=5e3, altitude=800e3)
    assert found.all
    assert found.broken() == []


@pytest.mark.parametrize(
    ("change", "flag"),
    [
        ({"voltage": 50.0}, "energetic"),
        ({"density": 1e16}, "wide_sheath"),
        ({"ion_mass": 1.008 * ATOMIC_MASS}, "supersonic"),
        ({"length": 10.0}, "slender"),
        ({"altitude": 220e3}, "high"),
        ({"altitude": 1600e3}, "tabled"),
    ],
)
def test_each_broken_assumption_is_named(change, flag):
    found = validity(**{"length": 300.0, "altitude": 700e3} | TYPICAL | change)
    assert found.broken() == [REASONS[flag]]
    assert not found.all


def test_validity_is_an_array_where_its_arguments_are():
    """Mean ion mass at solar minimum 12.64 u at 600 km, 1.97 u at 1500 km."""
    found = validity(3e10, np.array([12.64, 1.97]) * ATOMIC_MASS, 7500.0, 1000.0, altitude=[600e3, 1500e3])
    assert found.supersonic.tolist() == [True, False]
    assert found.all.tolist() == [True, False]


def test_without_plasma_there_is_no_force():
    assert force_per_length(0.0, 16 * ATOMIC_MASS, 7.5e3, 1e3) == 0
    assert species_force_per_length([0.0, 0.0], [ATOMIC_MASS, 16 * ATOMIC_MASS], 7.5e3, 1e3) == 0
    assert negative_force_per_length(0.0, 16 * ATOMIC_MASS, 7.5e3, 1e3, 1e-3) == 0
    thinner = force_per_length(np.logspace(-20, 10, 31), 16 * ATOMIC_MASS, 7.5e3, 1e3)
    assert np.all(np.diff(thinner) > 0)  # and it is where ever thinner plasma leads
    assert thinner[0] < 1e-15
