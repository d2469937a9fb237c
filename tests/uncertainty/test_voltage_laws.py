"""The compiled voltage laws: what they set, where bounds and dead band act, and what they hold."""

from __future__ import annotations

import numpy as np
import pytest
from numba import njit
from scipy.integrate import solve_ivp

from sailviz.constants import AU, GRAVITY_AT_1_AU
from sailviz.propagate import dynamics
from sailviz.propulsion import voltage_control
from sailviz.steering import attitude
from sailviz.uncertainty import wind

NAN = float("nan")


@njit
def set_voltage(held, pressure, density, r, u, r_ref, u_ref, c):
    return voltage_control.voltage(held, pressure, density, r, u, r_ref, u_ref, c)


@njit
def factor(volts, pressure, wind_potential, c):
    return voltage_control.thrust_factor(volts, pressure, wind_potential, c)


def under(c, pressure, held=NAN, density=5e6):
    return set_voltage(held, pressure, density, 1.0, 0.0, 1.0, 0.0, c)


@pytest.mark.parametrize("pressure", [0.1e-9, 1.0e-9, 2.0e-9, 40e-9])
def test_unsaturated_pressure_law_makes_the_thrust_nominal(pressure):
    c = voltage_control.row("pressure", maximum_voltage=np.inf, reference_pressure=1.7e-9)
    assert factor(under(c, pressure), pressure, 1000.0, c) == pytest.approx(1, abs=1e-14)


def test_unsaturated_pressure_law_flies_the_nominal_trajectory(fly):
    # a_c = 1 mm/s2 at pitch 45 deg for half a year, pressure redrawn and voltage set every six hours; canonical units
    steps, end = 730, np.pi
    pressure = wind.generate("gamma", np.arange(float(steps)), 4, shape=2.593, scale=0.7793e-9)
    c = voltage_control.row("pressure", maximum_voltage=np.inf, reference_pressure=2.0207e-9, interval=1.0)
    volts, factors = voltage_control.histories(1.0, pressure, np.full(steps, 5e6), np.full(steps, 1e3), c)
    assert np.ptp(volts) > 50e3
    model = dynamics.model(
        1.0,
        device=dynamics.ELECTRIC_SAIL,
        device_parameters=(1e-3 / GRAVITY_AT_1_AU / AU, 0, 1.0),
        steering=attitude.ORBITAL,
        steering_parameters=(np.sqrt(0.5), np.sqrt(0.5), 0.0),
    )
    breaks = end / steps * np.arange(steps)
    nominal, controlled, free = (
        fly(model, times=[end], breaks=breaks, factors=f).states[:, -1]
        for f in (np.ones(steps), factors, np.sqrt(pressure / 2.0207e-9))
    )
    assert np.hypot(*nominal[:2]) > 1.4
    np.testing.assert_allclose(controlled, nominal, atol=1e-12)
    assert np.abs(free - nominal).max() > 1e-3


def test_pressure_law_saturates_at_the_maximum_below_the_critical_pressure():
    c = voltage_control.row("pressure", maximum_voltage=40e3, reference_pressure=2.020725e-9)
    critical = 2.020725e-9 / (39 / 19) ** 2  # 0.4796 nPa
    assert under(c, 0.999 * critical) == 40e3
    assert 39e3 < under(c, 1.001 * critical) < 40e3
    assert factor(40e3, 2.020725e-9, 1000.0, c) == pytest.approx(39 / 19)


def test_thrust_ends_where_the_ions_climb_the_potential_and_never_pulls():
    c = voltage_control.row()
    assert factor(900.0, 2e-9, 1000.0, c) == 0
    assert factor(20e3, 2e-9, 1000.0, c) == 1
    assert factor(20e3, 2e-9, 2000.0, c) == pytest.approx(18 / 19)


def test_dead_band_holds_what_is_near_enough():
    c = voltage_control.row("pressure", dead_band=1e3)
    wish = under(c, 1.5e-9)
    assert under(c, 1.5e-9, held=wish + 990) == wish + 990
    assert under(c, 1.5e-9, held=wish - 1010) == wish
    assert under(c, 1e-12, held=39.5e3) == 39.5e3  # the wish counts as bounded, 40 kV


def test_distance_law_pushes_back_to_the_reference():
    c = voltage_control.row("distance", position_gain=100, speed_gain=50, mu=1.0)
    assert set_voltage(NAN, 2e-9, 5e6, 1.5, 0.0, 1.5, 0.0, c) == 20e3
    low = set_voltage(NAN, 2e-9, 5e6, 1.5015, 0.0, 1.5, 0.0, c)
    assert low == pytest.approx(1000 + 19e3 * 0.9)
    slow = set_voltage(NAN, 2e-9, 5e6, 1.5, -0.001, 1.5, 0.0, c)
    assert slow == pytest.approx(1000 + 19e3 * (1 + 0.05 * np.sqrt(1.5)))
    assert set_voltage(NAN, 2e-9, 5e6, 1.0, 0.0, 1.5, 0.0, c) == 40e3
    assert set_voltage(NAN, 2e-9, 5e6, 2.0, 0.0, 1.5, 0.0, c) == 0


def test_power_limit_stands_over_law_and_dead_band():
    nominal = 4.8e6 * 20e3**1.5
    c = voltage_control.row("pressure", power=nominal, dead_band=5e3)
    assert under(c, 0.5e-9, density=4.8e6) == pytest.approx(20e3)
    assert under(c, 0.5e-9, density=9.6e6, held=19e3) == pytest.approx(20e3 / 2 ** (2 / 3))
    reefing = voltage_control.row("constant-power", power=nominal, maximum_voltage=30e3)
    assert under(reefing, 2e-9, density=4.8e6) == pytest.approx(20e3)
    assert under(reefing, 2e-9, density=1e6) == 30e3


@pytest.mark.parametrize(("gain", "end"), [(0.9, 0.02415), (1.1, 0.00068)])
def test_resting_point_is_held_only_with_a_gain_above_one(gain, end):
    # Moved out by 1e-3 au, 4 pi time units (2 yr), Sun-facing sail whose thrust balances gravity at 1 au
    c = voltage_control.row("distance", maximum_voltage=1e9, position_gain=gain, mu=1.0)

    def rates(t, y):
        volts = set_voltage(NAN, 2e-9, 5e6, y[0], y[1], 1.0, 0.0, c)
        return [y[1], -1 / y[0] ** 2 + factor(volts, 2e-9, 1000.0, c) / y[0]]

    path = solve_ivp(rates, (0, 4 * np.pi), [1.001, 0.0], rtol=1e-10, atol=1e-12)
    assert abs(path.y[0, -1] - 1) == pytest.approx(end, abs=0.5e-5)
    assert (np.abs(path.y[0] - 1).max() < 0.0011) == (gain > 1)


def test_histories_hold_between_updates_and_see_the_wind_of_their_own_step():
    c = voltage_control.row("pressure", interval=3 * 3600.0)
    pressure = np.array([1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0]) * 1e-9
    volts, factors = voltage_control.histories(3600.0, pressure, np.full(7, 5e6), np.full(7, 1000.0), c)
    law = 1000 + 19e3 * np.sqrt(2e-9 / pressure)
    np.testing.assert_allclose(volts, law[[0, 0, 0, 3, 3, 3, 6]], rtol=1e-15)
    np.testing.assert_allclose(factors, (volts - 1000) / 19e3 * np.sqrt(pressure / 2e-9), rtol=1e-14)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({"kind": "thermal"}, "one of constant, pressure"),
        ({"nominal_voltage": 500.0}, "must rise"),
        ({"maximum_voltage": 10e3}, "must rise"),
        ({"minimum_voltage": 25e3}, "minimum voltage"),
        ({"kind": "constant-power"}, "power above 0"),
        ({"interval": 0.0}, "interval must be positive"),
        ({"dead_band": -1.0}, "must not be negative"),
    ],
)
def test_impossible_laws_are_refused_in_a_sentence(arguments, words):
    with pytest.raises(ValueError, match=words):
        voltage_control.row(**arguments)
