"""Ways down compared: velocities, propellant, time and power to the digits of an independent table."""

from __future__ import annotations

import numpy as np
import pytest

from sailviz.constants import DAY, RADIUS_EARTH, STANDARD_GRAVITY
from sailviz.design import decay
from sailviz.design.decay import disposal

# h km: circular speed; burn to a perigee of 0, 60, 120 km; spiral to 120, 300, 500 km; m/s
VELOCITIES = {
    500: (7612.608, 144.946, 126.825, 108.910, 219.424, 113.152, 0.0),
    600: (7557.865, 171.710, 153.663, 135.819, 274.167, 167.895, 54.743),
    700: (7504.286, 197.794, 179.820, 162.047, 327.746, 221.474, 108.322),
    800: (7451.831, 223.222, 205.320, 187.619, 380.201, 273.929, 160.777),
    900: (7400.461, 248.015, 230.186, 212.556, 431.571, 325.299, 212.147),
    1000: (7350.139, 272.196, 254.440, 236.881, 481.893, 375.622, 262.470),
    1200: (7252.499, 318.802, 301.192, 283.775, 579.533, 473.261, 360.109),
}
# h km: propellant of 260 kg to a perigee of 60 km at 70, 220, 300 s; spiral to 300 km at 800, 1500, 3000 s; kg
PROPELLANT = {
    500: (43.859, 14.843, 10.970, 3.723, 1.992, 0.998),
    600: (52.146, 17.874, 13.231, 5.505, 2.951, 1.480),
    700: (59.917, 20.792, 15.416, 7.237, 3.885, 1.950),
    800: (67.213, 23.603, 17.527, 8.922, 4.797, 2.410),
    900: (74.072, 26.312, 19.567, 10.560, 5.687, 2.859),
    1000: (80.526, 28.924, 21.541, 12.155, 6.555, 3.298),
    1200: (92.342, 33.877, 25.301, 15.221, 8.232, 4.149),
}


@pytest.mark.parametrize("km", VELOCITIES)
def test_velocities_have_the_tabled_digits(km):
    h = km * 1e3
    found = [disposal.circular_speed(h)]
    found += [disposal.perigee_lowering(h, p) for p in (0.0, 60e3, 120e3)]
    found += [disposal.spiral(h, end) for end in (120e3, 300e3, 500e3)]
    assert found == pytest.approx(VELOCITIES[km], abs=5.1e-4)


@pytest.mark.parametrize("km", PROPELLANT)
def test_propellant_has_the_tabled_digits(km):
    found = [disposal.chemical(260, km * 1e3, isp).propellant for isp in (70, 220, 300)]
    found += [disposal.electric(260, km * 1e3, isp, 0.01).propellant for isp in (800, 1500, 3000)]
    assert found == pytest.approx(PROPELLANT[km], abs=5.1e-4)


def test_perigee_burn_leaves_an_ellipse_that_touches_its_perigee():
    """Vis-viva and angular momentum: r v at apogee over r at perigee is the speed there, energies equal."""
    a, p = RADIUS_EARTH + 800e3, RADIUS_EARTH + 60e3
    slow = disposal.circular_speed(800e3) - disposal.perigee_lowering(800e3)
    fast = slow * a / p
    mu = disposal.circular_speed(0.0) ** 2 * RADIUS_EARTH
    assert fast**2 / 2 - mu / p == pytest.approx(slow**2 / 2 - mu / a, rel=1e-12)


def test_thrust_time_is_momentum_over_force():
    """At an enormous specific impulse the mass hardly changes: t = m dv / T; P = T c / (2 eta)."""
    way = disposal.electric(260, 800e3, 1e6, 0.01, 0.5)
    assert way.time == pytest.approx(260 * way.delta_v / 0.01, rel=1e-4)
    assert way.power == pytest.approx(0.01 * 1e6 * STANDARD_GRAVITY)
    assert disposal.electric(260, 800e3, 1500, 0.02).time == pytest.approx(
        disposal.electric(260, 800e3, 1500, 0.01).time / 2
    )


def test_brake_spends_nothing_and_its_impulse_is_the_spirals():
    """Constant 0.43 mN on 260 kg from 800 to 700 km, 367.0957 d: F T = m dv, over 2 kg a specific impulse of 696 s."""
    way = disposal.brake(260, 5e3, 800e3, 0.43e-3 / 5e3, 2.0, end_altitude=700e3)
    assert way.time / DAY == pytest.approx(367.0957, abs=5e-5)
    assert way.propellant == 0
    assert way.specific_impulse == pytest.approx(0.43e-3 * 367.0957 * DAY / (2 * STANDARD_GRAVITY), rel=1e-6)
    assert np.isnan(way.power)


def test_brakes_power_is_that_of_the_densest_plasma_on_its_way():
    """P ~ n L: at solar maximum 7.4e11 / m3 at 400 km instead of 3e10 and 0.132 W on 5 km of 50 um wire, 3.3 W."""
    profile = decay.shipped_profile("max2001")
    way = disposal.brake(260, 5e3, np.array([500e3, 800e3]), profile, 2.0, end_altitude=400e3)
    assert way.power == pytest.approx(0.13197 * 7.416e11 / 3e10, rel=0.01)
    assert way.time[0] < way.time[1]
    alone = disposal.brake(260, 5e3, 800e3, profile, 2.0, end_altitude=700e3)
    assert alone.power == pytest.approx(0.13197 * 3.357e11 / 3e10, rel=0.01)


def test_one_burn_is_down_in_half_a_revolution():
    """From 800 km to 60 km: half the period of a = R + 430 km, 93.1 min."""
    way = disposal.chemical(260, 800e3, 220)
    assert way.time / 60 == pytest.approx(93.1 / 2, abs=0.05)
    assert way.controlled
    assert not disposal.electric(260, 800e3, 1500, 0.01).controlled


def test_periods_of_circular_orbits():
    """2 pi a / v: 5926.379 s at 700 km, 5676.978 s at 500 km."""
    altitude = np.array([700e3, 500e3])
    period = 2 * np.pi * (RADIUS_EARTH + altitude) / disposal.circular_speed(altitude)
    assert period == pytest.approx([5926.379, 5676.978], abs=5.1e-4)
