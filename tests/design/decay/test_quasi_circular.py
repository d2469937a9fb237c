"""Plasma-brake decay: closed forms, the tabled ionosphere's times, and what was published of such descents."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.interpolate import CubicSpline

from sailviz.constants import DAY, MU_EARTH, RADIUS_EARTH, YEAR
from sailviz.design import decay
from sailviz.design.decay import neutral_drag
from sailviz.environment import atmosphere

POLAR, STATION = np.radians(97.8), np.radians(51.6)
CUBESAT = (4.5, 300.0, 700e3, 500e3)  # kg, m, m, m
DEBRIS = (260.0, 5e3, 800e3, 700e3)


def days(seconds):
    return seconds / DAY


# ---------------------------------------------------------------- closed forms
def test_constant_force_by_hand():
    """T = m sqrt(mu) / F (a2^-1/2 - a1^-1/2): 0.43 mN on 260 kg from 800 to 700 km, 367.0957 d."""
    assert days(decay.decay_time(260, 1, 800e3, 700e3, decay.constant(0.43e-3))) == pytest.approx(367.0957, abs=5e-5)
    assert days(decay.decay_time(260, 5e3, 800e3, 700e3, 0.43e-3 / 5e3)) == pytest.approx(367.0957, abs=5e-5)


@pytest.mark.parametrize(
    ("f700", "scale", "craft", "exact", "simple"),
    [
        (38.0556, 238.80, CUBESAT, 333.6874, 334.6362),
        (292.2708, 488.25, CUBESAT, 52.71748, 52.78793),
        (38.0556, 238.80, (100.0, 5e3, 1000e3, 400e3), 2428.382, 2485.281),
        (292.2708, 488.25, DEBRIS, 119.8312, 119.8705),
    ],
)
def test_exponential_profile_in_closed_form_and_by_quadrature(f700, scale, craft, exact, simple):
    """Digits as tabled: half of the last one."""
    f700, scale = f700 * 1e-9, scale * 1e3
    found = decay.exponential_decay_time(*craft, f700, scale)
    assert days(found) == pytest.approx(exact, rel=3e-7)
    assert days(decay.exponential_decay_time(*craft, f700, scale, exact=False)) == pytest.approx(simple, rel=3e-7)
    assert decay.decay_time(*craft, decay.exponential(f700, scale)) == pytest.approx(found, rel=1e-11)


def test_arrays_go_in_and_come_out():
    length, start = np.array([100.0, 300.0, 1000.0]), np.array([[600e3], [700e3]])
    profile = decay.exponential(38e-9, 238.8e3)
    found = decay.decay_time(4.5, length, start, 500e3, profile)
    assert found.shape == (2, 3)
    assert found == pytest.approx(decay.exponential_decay_time(4.5, length, start, 500e3, 38e-9, 238.8e3), rel=1e-10)
    assert isinstance(decay.decay_time(*CUBESAT, profile), float)


# ---------------------------------------------------------------- profiles
# level, inclination; exponential f700 nN/m, H km, error %; power f700, p, error; q0, q1, q2 of km and nN/m, error
FITS = [
    ("min2019", 97.8, 38.0556, 238.80, 13.7, 34.4683, -2.8008, 6.6, 3.557272, -4.187558e-3, 2.516153e-6, 2.5),
    ("mid2014", 97.8, 133.6517, 326.01, 5.9, 124.3544, -2.0397, 9.3, 4.865160, -3.067375e-3, 9.254623e-7, 1.7),
    ("mid2014", 51.6, 122.8806, 270.73, 5.1, 112.6920, -2.4485, 14.6, 4.793691, -3.693701e-3, 5.391404e-7, 2.1),
    ("max2001", 97.8, 292.2708, 488.25, 8.0, 278.7832, -1.3365, 17.7, 5.720583, -2.048120e-3, -1.320063e-6, 3.5),
    ("max2001", 51.6, 269.3592, 367.14, 12.6, 252.9973, -1.7728, 26.0, 5.664713, -2.723723e-3, -2.112829e-6, 5.8),
]


@pytest.mark.parametrize("row", FITS, ids=lambda row: f"{row[0]}-{row[1]}")
def test_fits_have_the_tabled_coefficients_and_errors(row):
    level, inclination, f_e, scale, error_e, f_p, power, error_p, q0, q1, q2, error_q = row
    profile = decay.shipped_profile(level, np.radians(inclination))
    e, p, q = (decay.fit(profile, shape) for shape in ("exponential", "power", "log-quadratic"))
    assert e.coefficients == pytest.approx((f_e * 1e-9, scale * 1e3), rel=4e-5)
    assert p.coefficients == pytest.approx((f_p * 1e-9, power), rel=4e-5)
    assert q.coefficients == pytest.approx((q0 - 9 * np.log(10), q1 * 1e-3, q2 * 1e-6), rel=2e-7)
    for found, error in ((e, error_e), (p, error_p), (q, error_q)):
        assert 100 * found.largest_error == pytest.approx(error, abs=0.051)


# h km: force nN/m at 97.8 deg, solar minimum, middle, maximum
TABLE = {
    250: (243.830, 367.123, 408.562), 300: (232.471, 413.890, 476.392), 400: (154.966, 356.378, 500.371),
    500: (90.342, 247.608, 434.683), 600: (53.367, 175.140, 368.204), 700: (34.916, 130.654, 309.443),
    800: (24.101, 97.743, 245.734), 900: (16.943, 72.098, 187.320), 1000: (12.214, 56.427, 151.821),
    1200: (6.948, 36.612, 109.146), 1500: (3.604, 19.276, 72.014),
}  # fmt: skip


@pytest.mark.parametrize("place", range(3))
def test_shipped_profile_is_the_tabled_one(place):
    profile = decay.shipped_profile(list(decay.LEVELS)[place])
    found = profile(1e3 * np.array(list(TABLE))) * 1e9
    assert found == pytest.approx([row[place] for row in TABLE.values()], abs=6e-4)


def test_effective_density_and_mean_mass_give_the_averaged_force():
    for level in decay.LEVELS:
        for inclination in (POLAR, STATION):
            profile = decay.shipped_profile(level, inclination)
            assert profile.plasma.force() == pytest.approx(profile(profile.plasma.altitude), rel=2e-5)


def test_voltage_and_density_scale_the_table_by_the_force_law():
    """f ~ V^0.497 n^0.537 at 3e10 / m3; in plasma 20 times denser the ram energy weighs more, 0.02 of the exponent."""
    profile = decay.shipped_profile("mid2014")
    for altitude in (300e3, 700e3, 1200e3):
        near = profile(altitude)
        assert np.log2(profile.with_voltage(2000.0)(altitude) / near) == pytest.approx(0.497, abs=0.025)
        assert np.log2(profile.with_density(2.0)(altitude) / near) == pytest.approx(0.537, abs=0.025)
    shape = decay.exponential(38e-9, 238.8e3)
    assert shape.with_voltage(2000.0)(700e3) == pytest.approx(38e-9 * 2**0.497)
    assert shape.with_density(0.5)(700e3) == pytest.approx(38e-9 / 2**0.537)


# ---------------------------------------------------------------- the tabled ionosphere
@pytest.mark.parametrize(
    ("craft", "expected"), [(CUBESAT, (357.455, 107.829, 51.270)), (DEBRIS, (1096.22, 279.746, 113.958))]
)
def test_decay_through_the_tabled_ionosphere(craft, expected):
    """ln f linear between the 25 km nodes; digits as tabled."""
    for level, value in zip(decay.LEVELS, expected, strict=True):
        found = days(decay.decay_time(*craft, decay.shipped_profile(level)))
        assert found == pytest.approx(value, rel=1e-5)


def test_published_times_lie_between_the_solar_levels():
    """Consistency, not validation: Iakubivskyi et al., Acta Astronautica (2020), abstract, 9-13 months for ESTCube-2
    from 700 to 500 km at no stated solar level; Janhunen, Ann. Geophys. 32, 1207 (2014), abstract, 260 kg lowered by
    100 km in one year."""
    cubesat, debris = (
        [days(decay.decay_time(*craft, decay.shipped_profile(level))) for level in decay.LEVELS]
        for craft in (CUBESAT, DEBRIS)
    )
    assert 274 < cubesat[0] < 396
    assert debris[1] < 365.25 < debris[0]


def test_published_force_lowers_the_published_mass_by_100_km_a_year():
    """Janhunen 2014, abstract: 0.43 mN, 260 kg. Rates re-derived: 96.38 km a year at 600 km, 100.55 at 800; the drop in
    the first 365.25 d from 800 km is 99.50 km."""
    for altitude, rate in ((600e3, 96.38), (700e3, 98.46), (800e3, 100.55), (1000e3, 104.78)):
        time = decay.decay_time(260, 1, altitude + 10, altitude - 10, 0.43e-3)
        assert 0.020 / time * YEAR == pytest.approx(rate, abs=0.006)
    lower = decay.altitude_history(YEAR, 260, 1, 800e3, 600e3, 0.43e-3)
    assert (800e3 - lower) / 1e3 == pytest.approx(99.50, abs=0.006)


def test_density_band_goes_with_the_root():
    """Time ~ n^-0.54: twice the plasma, 0.69 of the time."""
    band = decay.decay_band(*CUBESAT, decay.shipped_profile("min2019"))
    assert days(band.time[1]) == pytest.approx(357.455, rel=1e-5)
    assert band.time / band.time[1] == pytest.approx(band.density_factor**-0.537, rel=0.01)


def test_decay_through_the_ionosphere_averaged_here():
    """The table's density, averaged over longitude and season, interpolated, and then the force averaged over local
    time and latitude: 347.890, 105.698, 50.805 d by independent averages over many points."""
    for (name, level), value in zip(decay.LEVELS.items(), (347.890, 105.698, 50.805), strict=True):
        found = decay.averaged_profile(POLAR, level)
        assert days(decay.decay_time(*CUBESAT, found)) == pytest.approx(value, rel=2e-5)
        assert found.plasma.force() == pytest.approx(found(found.plasma.altitude), rel=1e-12)
        assert found(700e3) / decay.shipped_profile(name)(700e3) == pytest.approx(1.03, abs=0.025)  # 1 to 5 % more
    assert decay.averaged_profile(np.pi - POLAR, 100.0)(700e3) == decay.averaged_profile(POLAR, 100.0)(700e3)
    assert decay.averaged_profile(0.0, 70.0)(700e3) > decay.averaged_profile(STATION, 70.0)(700e3)  # denser there
    with pytest.raises(ValueError, match="70 to 193"):
        decay.averaged_profile(POLAR, 250.0)


# ---------------------------------------------------------------- corrections
def test_mean_radius_of_an_oblate_earths_orbit():
    """Averages of propagated orbits: +4.395 km at 97.8 deg, -0.754 km at 51.6 deg, -9.35 km at the equator; second
    order in J2 is 20 m."""
    a = RADIUS_EARTH + 700e3
    for inclination, offset in ((POLAR, 4.395), (STATION, -0.754), (0.0, -9.35)):
        assert decay.mean_radius_offset(a, inclination) / 1e3 == pytest.approx(offset, abs=0.03)


def test_corrections_lengthen_and_shorten_as_propagation_says():
    """Propagated: J2's mean radius about +2 % and -0.3 %, the offset over the profile's scale height of 200 to 240 km;
    co-rotation 341.426 / 347.883 at 97.8 deg and +9 % at 51.6 deg."""
    for inclination, radius, wind in ((POLAR, 0.020, 341.426 / 347.883 - 1), (STATION, -0.003, 0.09)):
        profile = decay.shipped_profile("min2019", inclination)
        plain = decay.decay_time(*CUBESAT, profile)
        high = decay.decay_time(*CUBESAT, profile, inclination=inclination, mean_radius=True)
        turning = decay.decay_time(*CUBESAT, profile, inclination=inclination, corotation=True)
        assert high / plain - 1 == pytest.approx(radius, abs=0.002)
        assert turning / plain - 1 == pytest.approx(wind, abs=0.005)
    west = decay.corotation_factor(RADIUS_EARTH + 700e3, np.pi)
    assert west > 1 > decay.corotation_factor(RADIUS_EARTH + 700e3, 0.0)


# ---------------------------------------------------------------- with neutral drag
# mean density kg/m3, polar mean over local time, pymsis 2.1 at F10.7, ap of (70, 5), (145, 10), (200, 15)
AIR_KM = [120, 200, 300, 400, 500, 600, 700, 800, 1000]
AIR = {
    "min2019": [1.5787e-08, 1.5324e-10, 6.9672e-12, 6.3313e-13, 8.2254e-14, 1.6724e-14, 5.9713e-15, 3.0960e-15,
                1.2098e-15],
    "mid2014": [1.6421e-08, 2.4060e-10, 2.1462e-11, 3.3684e-12, 6.7471e-13, 1.5838e-13, 4.3866e-14, 1.5113e-14,
                3.7243e-15],
    "max2001": [1.6870e-08, 3.0386e-10, 3.5158e-11, 6.7678e-12, 1.6232e-12, 4.4423e-13, 1.3535e-13, 4.6322e-14,
                8.5803e-15],
}  # fmt: skip


def air_of(level):
    """Cubic spline of ln rho through the table above."""
    spline = CubicSpline(1e3 * np.array(AIR_KM), np.log(AIR[level]))
    return lambda altitude: np.exp(spline(altitude))


def own_air(level):
    """What sailviz tabulates, for the solar flux and ap of the table above."""
    return atmosphere.mean_profile(*{"min2019": (70, 5), "mid2014": (145, 10), "max2001": (200, 15)}[level])


# Cd A m2, start, then per level: drag alone and brake with drag in years, altitude in km where both are equal
LIFETIMES = [
    (4.5, 300.0, 0.066, 700e3, ((597.8, 1.401, 242), (70.79, 0.479, 255), (24.76, 0.268, 267))),
    (100.0, 5e3, 2.2, 800e3, ((1050.0, 2.976, 265), (159.0, 0.900, 283), (52.6, 0.449, 299))),
]


@pytest.mark.parametrize("air", [air_of, own_air])
@pytest.mark.parametrize(("mass", "length", "drag_area", "start", "rows"), LIFETIMES)
def test_lifetimes_to_re_entry(mass, length, drag_area, start, rows, air):
    """To 120 km at constant solar level, brake off below 200 km: drag alone to 1 %, with the brake to 0.3 %."""
    for level, (drifting, braking, _) in zip(decay.LEVELS, rows, strict=True):
        more = {"drag_area": drag_area, "air": air(level)}
        alone = decay.decay_time(mass, 0.0, start, decay.REENTRY, None, **more)
        both = decay.decay_time(mass, length, start, decay.REENTRY, decay.shipped_profile(level), **more)
        assert alone / YEAR == pytest.approx(drifting, rel=0.01)
        assert both / YEAR == pytest.approx(braking, rel=0.003)


@pytest.mark.parametrize(("mass", "length", "drag_area", "start", "rows"), LIFETIMES)
def test_air_takes_over_from_the_brake_where_tabled(mass, length, drag_area, start, rows):
    """To a kilometre; the forces are equal there and the brake leads above."""
    for level, (_, _, km) in zip(decay.LEVELS, rows, strict=True):
        profile, air = decay.shipped_profile(level), own_air(level)
        found = neutral_drag.crossover_altitude(length, profile, drag_area, air)
        assert found / 1e3 == pytest.approx(km, abs=1)
        way = decay.descend(mass, length, found + 4e3, found - 4e3, profile, drag_area=drag_area, air=air)
        assert way.brake[0] > way.drag[0]
        assert way.brake[-1] < way.drag[-1]
        assert np.interp(-found, -way.altitude, way.brake / way.drag) == pytest.approx(1, abs=2e-3)
    assert np.isnan(neutral_drag.crossover_altitude(1e6, profile, 1e-6, air))


def test_steady_sun_by_integration_is_the_quadrature():
    air = atmosphere.mean_profile(70.0, 5.0, POLAR)
    alone = decay.decay_time(4.5, 0.0, 700e3, decay.REENTRY, None, drag_area=0.066, air=air)
    assert neutral_drag.cycle_descent(4.5, 700e3, 2020, drag_area=0.066, f107=70.0).duration == pytest.approx(
        alone, rel=5e-5
    )
    profile = decay.averaged_profile(POLAR, 70.0)
    both = decay.decay_time(100.0, 5e3, 800e3, decay.REENTRY, profile, drag_area=2.2, air=air)
    way = neutral_drag.cycle_descent(100.0, 800e3, 2020, drag_area=2.2, length=5e3, f107=70.0)
    assert way.duration == pytest.approx(both, rel=5e-5)
    assert np.all((way.brake > 0) == (way.altitude >= 200e3))


def test_decades_of_drag_see_the_cycles_mean_air():
    """A descent of many cycles from any phase is within half a cycle of that through the density averaged over one."""
    flux = 70 + 61.5 * (1 - np.cos(2 * np.pi * (np.arange(64) + 0.5) / 64))
    known = [(level, *atmosphere.mean_profile(level, ap, POLAR)) for level, ap in
             zip(atmosphere.LEVELS, atmosphere.GEOMAGNETIC, strict=True)]  # fmt: skip
    log = np.log([density for *_, density in known])
    mean = np.mean(np.exp([[np.interp(f, atmosphere.LEVELS, column) for column in log.T] for f in flux]), axis=0)
    steady = decay.decay_time(4.5, 0.0, 700e3, decay.REENTRY, None, drag_area=0.066, air=(known[0][1], mean))
    for year in (2020.0, 2025.5):
        way = neutral_drag.cycle_descent(4.5, 700e3, year, drag_area=0.066)
        assert abs(way.duration - steady) < 5.5 * YEAR
        assert way.duration > 5 * 11 * YEAR


def test_short_descent_ends_sooner_when_it_starts_into_a_maximum():
    rising, falling = (neutral_drag.cycle_descent(4.5, 500e3, year, drag_area=0.066).duration for year in (2023, 2028))
    assert rising < falling / 2
    with pytest.raises(ValueError, match="70 to 200"):
        neutral_drag.cycle_descent(4.5, 500e3, 2023, drag_area=0.066, f107=300)


def test_order_of_the_drag_path_by_a_flown_sail():
    """CanX-7, 3.5 kg, 4 m2 drag sail: 688 km on 2017-05-04, re-entered 2022-04-21 after 1813 d. At solar minimum Cd 2.2
    gives 1107 d face-on; tumbling shows half the area: 2214 d."""
    air = air_of("min2019")
    face_on, tumbling = (
        decay.decay_time(3.5, 0.0, 688e3, decay.REENTRY, None, drag_area=2.2 * area, air=air) / DAY
        for area in (4.0, 2.0)
    )
    assert face_on == pytest.approx(1107, rel=0.01)
    assert face_on < 1813 < tumbling


# ---------------------------------------------------------------- the descent itself
def test_descent_solves_the_equation_of_motion():
    """Against an independent integration of da/dt; the altitude between nodes 2 km apart is good to metres."""
    profile, air = decay.shipped_profile("mid2014"), air_of("mid2014")
    descent = decay.descend(4.5, 300.0, 700e3, 150e3, profile, drag_area=0.066, air=air)

    def rate(t, h):
        a = RADIUS_EARTH + h[0]
        force = 300.0 * float(profile(h[0])) * (h[0] >= 200e3) + 0.5 * air(h[0]) * MU_EARTH / a * 0.066
        return [-2 * a**1.5 / np.sqrt(MU_EARTH) * force / 4.5]

    times = np.linspace(0, descent.duration * 0.98, 40)
    truth = solve_ivp(rate, (0, times[-1]), [700e3], "DOP853", times, rtol=1e-10, atol=1e-3, max_step=DAY).y[0]
    assert truth[-1] > 200e3
    assert descent.altitude_at(times) == pytest.approx(truth, abs=10)
    assert np.isnan(descent.altitude_at([-1.0, descent.duration + 1])).all()
    assert descent.time_above(descent.altitude_at(times)) == pytest.approx(times, abs=60)
    assert descent.duration == pytest.approx(
        decay.decay_time(4.5, 300.0, 700e3, 150e3, profile, drag_area=0.066, air=air), rel=1e-9
    )
    assert np.all(descent.brake[descent.altitude < 200e3] == 0)
    assert descent.area_time(0.06) == pytest.approx(0.06 * descent.duration)
    assert descent.time_above([800e3, 100e3]) == pytest.approx([0, descent.duration], abs=1e-6)


def test_rules_of_5_and_25_years():
    found = decay.compliance(YEAR * np.array([4.9, 5.1, 24.9, 25.1]))
    assert found.within_5_years.tolist() == [True, False, False, False]
    assert found.within_25_years.tolist() == [True, True, True, False]


@pytest.mark.parametrize(
    ("arguments", "options", "sentence"),
    [
        ((4.5, 300, 500e3, 700e3, 1e-7), {}, "only lowers"),
        ((-1, 300, 700e3, 500e3, 1e-7), {}, "mass must be positive"),
        ((4.5, 300, 700e3, 120e3, 1e-7), {}, "brake is off"),
        ((4.5, 0, 700e3, 500e3, None), {}, "nothing lowers"),
        ((4.5, 300, 700e3, 500e3, 1e-7), {"drag_area": 1.0}, "takes an atmosphere"),
        ((4.5, 300, 700e3, 500e3, 1e-7), {"corotation": True}, "inclination"),
        ((4.5, 300, 1600e3, 500e3, decay.shipped_profile()), {}, "extended"),
    ],
)
def test_impossible_descents_are_refused_with_the_reason(arguments, options, sentence):
    with pytest.raises(ValueError, match=sentence):
        decay.decay_time(*arguments, **options)


def test_unknown_profiles_are_refused():
    for wrong, sentence in (
        (lambda: decay.shipped_profile("max1989"), "min2019"),
        (lambda: decay.shipped_profile("min2019", np.radians(28)), "averaged_profile"),
        (lambda: decay.fit(decay.shipped_profile(), "cubic"), "log-quadratic"),
        (lambda: decay.tabulated([1, 0], [1, 1]), "rising"),
        (lambda: decay.tabulated([0, 1], [1, 0]), "positive"),
    ):
        with pytest.raises(ValueError, match=sentence):
            wrong()
    assert decay.shipped_profile("min2019", np.radians(82.2)).label == decay.shipped_profile("min2019").label
    high = decay.decay_time(4.5, 300, 1600e3, 1500e3, decay.shipped_profile().extended())
    assert np.isfinite(high)


def test_a_descent_with_too_many_nodes_is_counted_and_refused():
    with pytest.raises(ValueError, match=r"nodes of quadrature \(some .* GB at a time\), more than the 10,000,000"):
        decay.decay_time(100.0, 5e3, 1e15, 2e5, 1e-8)
    with pytest.raises(ValueError, match="more than the 10 that most_nodes"):
        decay.descend(100.0, 5e3, 8e5, 2e5, 1e-8, most_nodes=10)
