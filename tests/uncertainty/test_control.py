"""Closed forms of voltage control and electrochromic area, and the laws on the measured wind."""

from __future__ import annotations

import numpy as np
import pytest

from sailviz.environment.solar_wind.pressure import wind_potential
from sailviz.propulsion import electric_sail, voltage_control
from sailviz.uncertainty import control, wind

K, THETA = 2.593, 0.7793e-9
HOUR = 3600.0
NOMINAL_POWER = 4.8e6 * 20e3**1.5  # of the row: 20 kV at the median density


def test_tether_force_of_the_reference_wind():
    # sigma = a_c m / (N L)
    for volts, force in ((20e3, 4.5511e-7), (40e3, 9.3417e-7)):
        found = electric_sail.characteristic_acceleration(1, 1.0, volts, 1.0, 2e-9, 1e3)
        assert found == pytest.approx(force, rel=1e-4)
    sail = electric_sail.characteristic_acceleration(100, 20e3, 20e3, 910.0, 2e-9, 1e3)
    assert sail == pytest.approx(1e-3, rel=1e-3)


def test_saturation_has_its_closed_form_numbers():
    found = control.saturation(K, THETA, 20e3, 40e3, 1e3, K * THETA)
    assert found.critical_pressure / 1e-9 == pytest.approx(0.4796, abs=1e-4)
    assert found.probability == pytest.approx(0.04982, abs=1e-5)
    assert found.mean_thrust == pytest.approx(0.991022, abs=1e-6)
    assert found.thrust_deviation == pytest.approx(0.051026, abs=1e-6)
    assert found.mean_voltage == pytest.approx(22_901.2, abs=0.1)
    assert found.uncontrolled_thrust == pytest.approx(0.953210, abs=1e-6)
    assert found.uncontrolled_deviation == pytest.approx(0.302309, abs=1e-6)


def test_saturation_is_that_of_the_compiled_law():
    p = wind.generate("gamma", np.arange(1_000_000.0), 5, shape=K, scale=THETA)
    for most in (30e3, 40e3):
        c = voltage_control.row("pressure", maximum_voltage=most, reference_pressure=K * THETA, interval=1.0)
        volts, factors = voltage_control.histories(1.0, p, np.full_like(p, 5e6), np.full_like(p, 1e3), c)
        found = control.saturation(K, THETA, 20e3, most, 1e3, K * THETA)
        n = np.sqrt(len(p))
        assert np.mean(volts == most) == pytest.approx(found.probability, abs=3 * 0.4 / n)
        assert factors.mean() == pytest.approx(found.mean_thrust, abs=3 * factors.std() / n)
        assert factors.std() == pytest.approx(found.thrust_deviation, rel=0.01)
        assert volts.mean() == pytest.approx(found.mean_voltage, abs=3 * volts.std() / n)


def test_saturation_vanishes_with_the_bound_and_takes_arrays():
    found = control.saturation(K, THETA, 20e3, np.array([20e3, 40e3, 1e9]), 1e3, K * THETA)
    assert found.mean_thrust[0] < found.mean_thrust[1] < found.mean_thrust[2]
    assert found.mean_thrust[2] == pytest.approx(1, abs=1e-9)
    assert found.thrust_deviation[2] == pytest.approx(0, abs=1e-6)
    assert found.uncontrolled_thrust.shape == (3,)
    for arguments, words in (((0.4, THETA, 20e3, 40e3), "exceed 1/2"), ((K, THETA, 40e3, 20e3), "voltages must rise")):
        with pytest.raises(ValueError, match=words):
            control.saturation(*arguments)


def test_electron_gun_of_the_reference_sail_takes_376_watts():
    assert control.gun_current_per_length(20e3, 7e6, 12.5e-6) == pytest.approx(2.352e-9, rel=3e-4)
    assert control.gun_power(20e3, 7e6, 12.5e-6, 4 * 2e6) == pytest.approx(376, abs=0.5)
    assert control.largest_voltage(376.0, 7e6, 12.5e-6, 8e6) == pytest.approx(20e3, rel=1e-3)
    strength = control.gun_strength(376.0, 12.5e-6, 8e6)
    assert (strength / 7e6) ** (2 / 3) == pytest.approx(control.largest_voltage(376.0, 7e6, 12.5e-6, 8e6), rel=1e-12)


def test_seven_thousandths_of_a_sail_even_out_the_irradiance():
    fraction = control.electrochromic_fraction(1358.18, 1362.93)
    assert fraction == pytest.approx(0.0070, abs=5e-5)
    s = np.linspace(1358.18, 1362.93, 50)
    state = control.electrochromic_state(s, fraction, 1358.18)
    assert state[[0, -1]] == pytest.approx([1, 0], abs=1e-12)
    np.testing.assert_allclose(s * control.electrochromic_factor(state, fraction), 1358.18, rtol=1e-14)
    assert control.electrochromic_state(1350.0, fraction, 1358.18) == 1


def flown(omni, c, potential=None):
    """Voltages and thrust factors over the measured hours."""
    known = omni.measured
    vw = np.full(known.sum(), 1e3) if potential is None else potential[known]
    return voltage_control.histories(HOUR, omni.pressure[known], omni.density[known], vw, c)


def test_measured_wind_at_constant_voltage(omni):
    c = voltage_control.row(reference_pressure=omni.reference_pressure())
    _, eta = flown(omni, c)
    assert (eta.mean(), eta.std() / eta.mean()) == pytest.approx((0.9475, 0.3373), abs=1e-4)
    _, eta = flown(omni, c, wind_potential(omni.speed))
    assert (eta.mean(), eta.std() / eta.mean()) == pytest.approx((0.9436, 0.3291), abs=3e-4)
    unbiased = voltage_control.row(reference_pressure=omni.reference_pressure(unbiased=True))
    assert flown(omni, unbiased)[1].mean() == pytest.approx(1, abs=1e-12)


@pytest.mark.parametrize(
    ("most", "mean", "cv", "volts"), [(30e3, 0.8957, 0.3019, 20.46), (40e3, 0.9280, 0.3251, 21.42)]
)
def test_measured_wind_at_constant_power(omni, most, mean, cv, volts):
    p_ref = omni.reference_pressure()
    c = voltage_control.row(
        "constant-power", power=NOMINAL_POWER, maximum_voltage=most, interval=HOUR, reference_pressure=p_ref
    )
    found, eta = flown(omni, c)
    assert (eta.mean(), eta.std() / eta.mean()) == pytest.approx((mean, cv), abs=1e-4)
    assert found.mean() / 1e3 == pytest.approx(volts, abs=0.006)


@pytest.mark.parametrize(
    ("times", "mean", "deviation", "limited"),
    [
        (1.5, 0.9443, 0.1018, 0.318),
        (2.0, 0.9826, 0.0556, 0.130),
        (3.0, 0.9965, 0.0312, 0.008),
        (5.0, 0.9970, 0.0305, 0.0),
    ],
)
def test_pressure_law_under_a_power_limit_in_the_measured_wind(omni, times, mean, deviation, limited):
    common = {"reference_pressure": omni.reference_pressure(), "interval": HOUR}
    volts, eta = flown(omni, voltage_control.row("pressure", power=times * NOMINAL_POWER, **common))
    free, _ = flown(omni, voltage_control.row("pressure", **common))
    assert (eta.mean(), eta.std()) == pytest.approx((mean, deviation), abs=1e-4)
    assert np.mean(volts < free) == pytest.approx(limited, abs=6e-4)
    ratio = omni.density[omni.measured] * free**1.5 / NOMINAL_POWER
    assert ratio.mean() == pytest.approx(1.293, abs=1e-3)
    assert np.percentile(ratio, 95) == pytest.approx(2.407, abs=1e-3)
    assert ratio.max() == pytest.approx(5.90, abs=0.006)


@pytest.mark.parametrize(("hours", "surplus"), [(6, (0.005, 0.008)), (24, (0.036, 0.039))])
def test_holding_the_voltage_as_long_as_the_wind_remembers_pushes_too_much(omni, hours, surplus):
    # Held over d, the factor has the mean E sqrt(p(t + d) / p(t)) > 1
    c = voltage_control.row("pressure", reference_pressure=omni.reference_pressure(), interval=hours * HOUR)
    n = len(omni.pressure)
    _, eta = voltage_control.histories(HOUR, omni.pressure, np.full(n, 5e6), np.full(n, 1e3), c)
    prompt = voltage_control.row("pressure", reference_pressure=omni.reference_pressure(), interval=HOUR)
    _, at_once = voltage_control.histories(HOUR, omni.pressure, np.full(n, 5e6), np.full(n, 1e3), prompt)
    assert surplus[0] - 0.003 < eta.mean() - at_once.mean() < surplus[1] + 0.003
