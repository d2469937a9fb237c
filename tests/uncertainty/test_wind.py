"""Fits of the pressure: what is put in comes out, and the measured wind has its published numbers."""

from __future__ import annotations

import numpy as np
import pytest

from sailviz.environment.solar_wind.pressure import wind_potential
from sailviz.uncertainty import wind

HOUR = 3600.0
nPa = 1e-9
MEASURED = {  # parameters in nPa, KS, AIC of OMNI2 1998-2018
    "burr": ({"c": 3.290, "d": 0.764, "scale": 1.4245}, 0.0097, 514_322),
    "lognormal": ({"sigma": 0.6144, "scale": np.exp(0.4984)}, 0.0293, 521_595),
    "inverse-gaussian": ({"centre": 2.0206, "scale": 4.1405}, 0.0387, 531_025),
    "inverse-gamma": ({"shape": 2.754, "scale": 3.740}, 0.0481, 536_376),
    "gamma": ({"shape": 2.5929, "scale": 0.7793}, 0.0770, 548_718),
    "weibull": ({"shape": 1.428, "scale": 2.249}, 0.1115, 579_063),
}


def test_measured_wind_has_its_moments_fits_and_gaps(omni):
    fits = wind.fit(omni)
    assert (fits.count, fits.left_out) == (182_348, 1_732)
    assert omni.repairs.filled == 1_732
    assert fits.mean / nPa == pytest.approx(2.0206, abs=1e-4)
    assert fits.standard_deviation / nPa == pytest.approx(1.7705, abs=1e-4)
    assert list(fits) == list(MEASURED)
    for name, (parameters, ks, aic) in MEASURED.items():
        found = fits[name]
        for key, value in parameters.items():
            unit = nPa if key in ("scale", "centre") else 1.0
            assert found.parameters[key] / unit == pytest.approx(value, abs=6e-4), (name, key)
        assert found.ks == pytest.approx(ks, abs=6e-5)
        assert found.aic == pytest.approx(aic, abs=0.6)
    assert omni.reference_pressure(unbiased=True) / nPa == pytest.approx(1.814, abs=6e-4)
    volts = wind_potential(omni.speed)
    # 1034 and 527 V without the speeds filled here, many of which were lost in the storms of 2003
    assert volts.mean() == pytest.approx(1034, rel=0.012)
    assert volts.std() == pytest.approx(527, rel=0.012)


def test_measured_wind_forgets_within_a_day_and_remembers_a_rotation_of_the_sun(omni):
    root = np.sqrt(np.where(omni.measured, omni.pressure, np.nan))
    found = wind.autocorrelation(root, [1, 3, 6, 12, 24, 48, 72, 27 * 24])
    assert found == pytest.approx([0.938, 0.807, 0.660, 0.455, 0.244, 0.073, 0.036, 0.205], abs=6e-4)


@pytest.mark.parametrize("name", ["gamma", "lognormal", "burr", "weibull", "inverse-gamma"])
def test_a_fit_finds_the_law_that_was_drawn_from(name):
    parameters = {key: value * (nPa if key in ("scale", "centre") else 1.0) for key, value in MEASURED[name][0].items()}
    fits = wind.fit(wind.generate(name, HOUR * np.arange(40_000), 6, **parameters))
    assert fits.best == name
    for key, value in parameters.items():
        assert fits[name].parameters[key] == pytest.approx(value, rel=0.04)  # about 3 standard errors of the worst
    assert fits[name].ks < 1.95 / np.sqrt(40_000)  # passed once in a thousand


def test_fits_are_the_most_likely_ones():
    p = wind.generate("lognormal", HOUR * np.arange(5_000), 2, sigma=0.6, scale=1.6e-9)
    for name, fit in wind.fit(p).items():
        best = fit.law.log_density(p).sum()
        assert fit.aic == pytest.approx(2 * len(fit.parameters) - 2 * (best + 5_000 * np.log(nPa)), rel=1e-9)
        for key, value in fit.parameters.items():
            for change in (0.998, 1.002):
                other = wind.named(name, **(fit.parameters | {key: change * value}))
                assert other.log_density(p).sum() < best, (name, key)


def test_flights_do_not_depend_on_how_many_are_drawn():
    times = HOUR * np.arange(50)
    law = wind.named("burr", c=3.29, d=0.764, scale=1.4245e-9)
    many = wind.generate(law, times, 7, "correlated", flights=6, yearly=0.175)
    few = wind.generate(law, times, 7, "correlated", flights=2, first_flight=3, yearly=0.175)
    assert many.shape == (6, 50)
    np.testing.assert_array_equal(few, many[3:5])
    calm = wind.generate(law, times, 7, "correlated", flights=6, yearly=0.175, factor=0.5)
    np.testing.assert_allclose(calm, 0.5 * many, rtol=1e-15)


@pytest.mark.parametrize(
    ("pressure", "words"),
    [
        (2.0 + np.arange(100) / 100, "look like nPa taken for Pa"),
        (np.append(np.full(99, 2e-9), -2e-9), "1 values of pressure are zero, negative"),
        (np.full(20, 2e-9), "20 pressures; 48 are needed"),
        (np.full(100, 2e-9), "only 1 different"),
    ],
)
def test_bad_pressures_are_refused_in_a_sentence(pressure, words):
    with pytest.raises(ValueError, match=words):
        wind.fit(pressure)
    with pytest.raises(ValueError, match="no law cauchy to fit"):
        wind.fit(pressure, ["cauchy"])


def test_missing_pressures_are_left_out_and_counted():
    p = wind.generate("gamma", HOUR * np.arange(1000), 1, shape=2.6, scale=0.77e-9)
    with_gaps = np.insert(p, [10, 20, 30], np.nan)
    assert wind.fit(with_gaps).left_out == 3
    assert wind.fit(with_gaps).laws == wind.fit(p).laws
