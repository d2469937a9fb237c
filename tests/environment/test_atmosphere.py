"""The tabulated atmosphere against pymsis itself, its averages, and the drag-only lifetimes computed from them."""

from __future__ import annotations

import numpy as np
import pytest

import sailviz
from sailviz.constants import DAY, MU_EARTH, RADIUS_EARTH, YEAR
from sailviz.environment.atmosphere import (
    GEOMAGNETIC,
    LEVELS,
    SEASONS,
    days_over,
    density,
    mean_profile,
    table,
    table_over,
)
from sailviz.environment.sun import date_of, sun_parameters

HOUR = 2 * np.pi / 24
EVEN = {"all_ut_effects": 0, "longitudinal": 0, "mixed_ut_long": 0, "mixed_ap_ut_long": 0}


def msis(latitude, local_time, altitude, f107, ap, seasons=SEASONS, **options):
    """pymsis itself at n places (rad, rad, m), its densities averaged over the seasons. kg/m3, (n,)."""
    from pymsis import calculate

    n = len(latitude)
    longitude = np.degrees(local_time) - 180  # at noon UT
    places = longitude, np.degrees(latitude), altitude / 1e3, [f107] * n, [f107] * n, [[ap] * 7] * n
    days = [np.repeat(np.datetime64(f"{day}T12:00"), n) for day in seasons]
    return np.mean([calculate(day, *places, version=2.1, **options)[:, 0] for day in days], axis=0)


def random_places(n, lowest, highest):
    rng = np.random.default_rng(7)
    latitude = np.arcsin(rng.uniform(-1, 1, n))
    return latitude, rng.uniform(0, 2 * np.pi, n), rng.uniform(lowest, highest, n)


@pytest.mark.parametrize(
    ("lowest", "highest", "rms", "largest"), [(100e3, 150e3, 0.033, 0.12), (150e3, 1500e3, 0.009, 0.045)]
)
@pytest.mark.parametrize(("f107", "ap"), [(70.0, 5.0), (200.0, 15.0)])
def test_the_table_is_as_close_to_pymsis_as_its_docstring_says(f107, ap, lowest, highest, rms, largest):
    places = random_places(2000, lowest, highest)
    error = np.log(density(*places, f107, table(f107, ap)) / msis(*places, f107, ap, **EVEN))
    assert np.sqrt(np.mean(error**2)) < rms
    assert np.abs(error).max() < largest


@pytest.mark.parametrize(("f107", "ap"), [(85.0, 6.0), (120.0, 25 / 3), (172.5, 12.5)])
def test_between_solar_levels_the_density_is_as_right_as_the_docstring_says(f107, ap):
    places = random_places(1000, 150e3, 1500e3)
    error = np.log(density(*places, f107) / msis(*places, f107, ap, **EVEN))
    assert np.sqrt(np.mean(error**2)) < 0.034
    assert np.abs(error).max() < 0.09


def test_leaving_out_longitude_and_universal_time_costs_five_per_cent():
    places = random_places(2000, 150e3, 1500e3)
    error = np.log(msis(*places, 70.0, 5.0) / msis(*places, 70.0, 5.0, **EVEN))
    assert np.sqrt(np.mean(error**2)) == pytest.approx(0.05, abs=0.01)


def test_nodes_are_pymsis_itself():
    """At the eight local times that pymsis was asked for; those between come from its tides."""
    places = np.radians([-90.0, -20.0, 0.0, 70.0]), HOUR * np.array([0, 6, 12, 21]), np.array([1e5, 2e5, 7e5, 15e5])
    assert density(*places, 145.0) == pytest.approx(msis(*places, 145.0, 10.0, **EVEN), rel=1e-5)  # float32 in pymsis


def test_the_middle_between_nodes_is_their_geometric_mean():
    base = np.array([np.radians(20), 6 * HOUR, 900e3, 145.0])
    step = np.array([np.radians(10), HOUR, 10e3, 55.0])
    row = table()
    for k in range(4):
        low, middle, high = (density(*(base + f * step * (np.arange(4) == k)), row) for f in (0, 0.5, 1))
        assert middle == pytest.approx(np.sqrt(low * high), rel=1e-12)
        assert low != high


def test_the_day_closes_and_the_edges_hold():
    row = table(70.0, 5.0)
    assert density(0.3, 2 * np.pi + 1.0, 4e5, 70.0, row) == pytest.approx(density(0.3, 1.0, 4e5, 70.0, row), rel=1e-12)
    assert density(0.3, -1e-9, 4e5, 70.0, row) == pytest.approx(density(0.3, 1e-9, 4e5, 70.0, row), rel=1e-8)
    assert density(0.3, 1.0, 9e6, 70.0, row) == density(0.3, 1.0, 15e5, 70.0, row)
    assert density(0.3, 1.0, 0.0, 70.0, row) == density(0.3, 1.0, 1e5, 70.0, row)


# pymsis 2.1 at 0 N 0 E, 2020-03-15, 12 UT, published digits: longitude and universal time are worth a per cent or two
@pytest.mark.parametrize(
    ("f107", "ap", "expected"),
    [
        (140.0, 15.0, (2.8914e-10, 5.5499e-12, 2.9635e-13, 2.6730e-14, 5.9748e-15)),
        (70.0, 4.0, (1.8119e-10, 1.0977e-12, 2.7437e-14, 4.1281e-15, 1.6383e-15)),
    ],
)
def test_density_over_the_equator_at_noon(f107, ap, expected):
    row = table(f107, ap, seasons=("2020-03-15",))
    found = density(0.0, np.pi, 1e3 * np.array([200, 400, 600, 800, 1000]), f107, row)
    assert found == pytest.approx(expected, rel=0.015)


LEVEL_MEANS = {  # kg/m3, mean over local time, from pole to pole, March and June
    (70, 5): (
        1.5787e-08,
        1.5324e-10,
        6.9672e-12,
        6.3313e-13,
        8.2254e-14,
        1.6724e-14,
        5.9713e-15,
        3.0960e-15,
        1.2098e-15,
    ),
    (145, 10): (
        1.6421e-08,
        2.406e-10,
        2.1462e-11,
        3.3684e-12,
        6.7471e-13,
        1.5838e-13,
        4.3866e-14,
        1.5113e-14,
        3.7243e-15,
    ),
    (200, 15): (
        1.687e-08,
        3.0386e-10,
        3.5158e-11,
        6.7678e-12,
        1.6232e-12,
        4.4423e-13,
        1.3535e-13,
        4.6322e-14,
        8.5803e-15,
    ),
}


@pytest.mark.parametrize("level", LEVEL_MEANS)
def test_mean_profile_is_the_reference_profile(level):
    """The reference averaged few longitudes and hours, so that 2 % of its values come from where it looked."""
    altitude, profile = mean_profile(*level)
    kilometres = [120, 200, 300, 400, 500, 600, 700, 800, 1000]
    found = np.exp(np.interp(1e3 * np.array(kilometres), altitude, np.log(profile)))
    assert found == pytest.approx(LEVEL_MEANS[level], rel=0.02)


@pytest.mark.parametrize(
    ("level", "cubesat", "satellite"), [((70, 5), 597.8, 1050), ((145, 10), 70.79, 159), ((200, 15), 24.76, 52.6)]
)
def test_drag_alone_takes_the_reference_years(level, cubesat, satellite):
    """To 120 km over a sphere; 4.5 kg with 0.066 m2 from 700 km, 100 kg with 2.2 m2 from 800 km; within 1 %."""
    altitude, profile = mean_profile(*level)
    for mass, area, start, years in ((4.5, 0.066, 700e3, cubesat), (100.0, 2.2, 800e3, satellite)):
        h = np.linspace(120e3, start, 20_001)
        rho = np.exp(np.interp(h, altitude, np.log(profile)))
        time = np.trapezoid(mass / (np.sqrt(MU_EARTH * (RADIUS_EARTH + h)) * rho * area), h)
        assert time / YEAR == pytest.approx(years, rel=0.01)


def test_a_profile_is_the_mean_of_the_table_and_knows_the_orbits_inclination():
    altitude, profile = mean_profile(145.0, 10.0, inclination=np.radians(51.6))
    along = np.radians(np.arange(0.5, 360, 3))
    latitude = np.arcsin(np.sin(np.radians(51.6)) * np.sin(along))[:, None]
    mean = [density(latitude, HOUR * np.arange(24), h, 145.0).mean() for h in altitude[::20]]
    assert profile[::20] == pytest.approx(mean, rel=0.02)  # 19 steps along half the orbit
    assert profile[40] > mean_profile(145.0, 10.0)[1][40] * 1.005  # low latitudes are denser


def test_pymsis_is_given_every_index_and_asks_no_network(monkeypatch):
    import urllib.request

    def refuse(*arguments, **options):
        raise AssertionError("the network was asked")

    monkeypatch.setattr(urllib.request, "urlopen", refuse)
    monkeypatch.setattr("pymsis.utils.get_f107_ap", refuse)
    monkeypatch.setattr("pymsis.msis.get_f107_ap", refuse, raising=False)
    assert np.isfinite(table(123.0, 9.0)).all()


def test_the_solar_levels_may_have_one_ap_or_one_each():
    assert len(LEVELS) == len(GEOMAGNETIC)
    calm, stormy = (density(0.0, 0.0, 5e5, 70.0, table((70.0, 100.0), ap)) for ap in (5.0, (50.0, 50.0)))
    assert stormy > 1.1 * calm
    with pytest.raises(ValueError, match="one for each of the 2 solar levels"):
        table((70.0, 100.0), (5.0, 5.0, 5.0))
    with pytest.raises(ValueError, match="must increase"):
        table((100.0, 70.0), 5.0)


# ---------------------------------------------------------------- seasons
def on_dates(places, dates, f107, ap):
    """pymsis itself, each place on a date of its own. kg/m3, (n,)."""
    days = dates.astype("datetime64[D]")
    found = np.empty(len(days))
    for day in np.unique(days):
        here = days == day
        found[here] = msis(*(axis[here] for axis in places), f107, ap, (str(day),), **EVEN)
    return found


@pytest.mark.parametrize(
    ("start", "days"), [("2026-03-20T05:00", 0.2), ("2026-12-20", 40), ("2024-02-01", 104), ("2026-05-03T20:00", 1500)]
)
@pytest.mark.parametrize(("f107", "ap"), [(70.0, 5.0), (200.0, 15.0)])
def test_the_table_over_dates_is_as_close_to_pymsis_on_each_of_them_as_its_docstring_says(start, days, f107, ap):
    places = random_places(400, 150e3, 1500e3)
    time = np.random.default_rng(3).choice(np.linspace(0, days * DAY, 20), 400)
    dates = np.datetime64(start, "s") + time.astype("timedelta64[s]")
    found = density(*places, f107, table_over(start, days * DAY, f107, ap), time)
    error = np.log(found / on_dates(places, dates, f107, ap))
    assert np.sqrt(np.mean(error**2)) < 0.014  # 0.9 % of the table in space, 0.7 % of the year, half a day
    assert np.abs(error).max() < 0.07


def test_a_year_comes_round_and_its_levels_are_the_suns():
    row = table_over("2026-03-20", 3000 * DAY)
    here = 1.1, 2.0, 6e5
    year = 365.25 * DAY
    first, again = (density(*here, 120.0, row, 1e7 + k * year) for k in (0, 7))
    assert first == pytest.approx(again, rel=1e-10)
    edge = density(*here, 120.0, row, np.array([-1, 1]) + year * (1 - 78.0 / 365.25))  # New Year
    assert edge[0] == pytest.approx(edge[1], rel=1e-5)
    alone = density(*here, 145.0, table_over("2026-03-20", 3000 * DAY, 145.0, 10.0), 1e7)
    assert density(*here, 145.0, row, 1e7) == pytest.approx(alone, rel=1e-12)


def test_the_air_of_the_north_is_five_times_as_dense_in_one_season_as_in_another():
    spread = [
        density(np.radians(70), 0.0, 7e5, 70.0, table_over(f"2026-{month:02}-15", 0, 70.0, 5.0))
        for month in range(1, 13)
    ]
    assert max(spread) / min(spread) == pytest.approx(4.8, abs=0.2)


@pytest.mark.parametrize("given", [{"epoch": "2026-03-20T12:00:00"}, {"epoch": "2026-06-20T12:00:00"}])
def test_a_run_meets_the_air_of_its_own_date(given):
    run = sailviz.simulate(low_flight(**given))
    columns = run.environment
    flux = np.full(len(run), 145.0)
    latitude = np.arcsin(run.position[:, 2] / np.linalg.norm(run.position, axis=1))
    epoch = np.datetime64(given["epoch"])
    hour = local_hour(run, sun_parameters(epoch).mean_longitude)
    height = np.linalg.norm(run.position, axis=1) - RADIUS_EARTH
    dates = epoch.astype("datetime64[s]") + run.time.astype("timedelta64[s]")
    truth = on_dates((latitude, hour % (2 * np.pi), height), dates, flux[0], 10.0)
    assert columns["air_density_kg_m3"] == pytest.approx(truth, rel=0.05)


def local_hour(run, longitude):
    """Mean local time, rad from midnight, where the mean Sun begins at a longitude (rad)."""
    return np.arctan2(run.position[:, 1], run.position[:, 0]) - longitude - 2 * np.pi * run.time / YEAR + np.pi


def low_flight(**values):
    return {
        "title": "through the air",
        "body": "earth",
        "start": {"kind": "circular", "altitude_km": 400, "inclination_deg": 98},
        "device": {"kind": "none", "mass_kg": 5, "drag_area_m2": 0.1},
        "environment": {"solar_flux_sfu": 145, "atmosphere": {"kind": "nrlmsis-2.1", "ap": 10}},
        "propagation": {"duration_h": 3, "outputs": 100},
    } | values


def test_without_a_date_the_sun_says_which_season_it_is():
    """A Sun at 90 deg of right ascension stands in June."""
    around = low_flight()["environment"] | {"sun_right_ascension_deg": 90}
    sun = sailviz.simulate(low_flight(environment=around)).environment["air_density_kg_m3"]
    june = table_over("2026-06-21T12:00", 1e4, 145.0, 10.0)
    march = table_over("2026-03-20T12:00", 1e4, 145.0, 10.0)
    run = sailviz.simulate(low_flight(environment=around))
    r = np.linalg.norm(run.position, axis=1)
    hour = local_hour(run, np.pi / 2)
    place = np.arcsin(run.position[:, 2] / r), hour, r - RADIUS_EARTH, 145.0
    assert sun == pytest.approx(density(*place, june), rel=0.01)
    assert np.abs(sun / density(*place, march) - 1).max() > 0.2
    assert abs((date_of(np.pi / 2) - np.datetime64("2000-06-21")) / np.timedelta64(1, "D")) < 2


def test_the_days_that_stand_for_a_run_lie_within_it():
    assert days_over("2026-03-20T06:00", 3600.0) == ("2026-03-20",)
    assert days_over("2026-03-20", 30 * DAY) == ("2026-03-27", "2026-04-11")
    year = days_over("2026-03-20", 9000 * DAY)
    assert len(year) == 8
    assert np.all(np.diff(np.array(year, dtype="datetime64[D]")).astype(int) >= 45)
    assert year[-1] < "2027-03-20"
