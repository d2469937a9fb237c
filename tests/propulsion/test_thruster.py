"""The rocket equation. Its integration along a flight is tested with the propagator."""

from __future__ import annotations

import numpy as np
import pytest

from sailviz.propulsion.thruster import propellant, thruster_force

FORCE = thruster_force.py_func


def test_propellant_by_the_rocket_equation():
    """260 kg, 205.320 m/s: 23.603 kg at 220 s of specific impulse, 17.527 kg at 300 s."""
    assert propellant(205.320, np.array([70, 220, 300]), 260) == pytest.approx([67.213, 23.603, 17.527], abs=6e-4)


def test_a_small_velocity_change_costs_its_share_of_the_exhaust_speed():
    assert propellant(1e-9, 100.0, 1.0) == pytest.approx(1e-9 / 980.665, rel=1e-12)
    assert propellant(0.0, 100.0, 1.0) == 0


def test_mass_flow_is_thrust_over_exhaust_speed():
    """(2.3): 0.2 N at an exhaust speed of 4 km/s burn 50 mg/s, whatever the mass."""
    for mass in (10.0, 100.0):
        ax, ay, az, flow = FORCE(0.6, 0.0, 0.8, mass, 0.2, 1.0, 1 / 4000)
        assert (ax, ay, az) == pytest.approx((0.12 / mass, 0, 0.16 / mass), rel=1e-15)
        assert flow == pytest.approx(-5e-5, rel=1e-15)


def test_constant_acceleration_burns_in_proportion_to_the_mass():
    assert FORCE(1.0, 0.0, 0.0, 50.0, 0.2, 0.0, 1 / 4000) == pytest.approx((0.2, 0, 0, -2.5e-3), rel=1e-15)
    assert FORCE(1.0, 0.0, 0.0, 50.0, 0.2, 0.0, 0.0)[3] == 0
