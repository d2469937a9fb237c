"""Neutral air around the Earth: NRLMSIS 2.1 tabulated when a scene is loaded, and its mean over a day as a profile.

The solar flux F10.7 and the geomagnetic index ap are always given, the mean of 81 days equal to the day's value, so
that pymsis never asks the network. What depends on longitude and universal time is switched off (it changes the density
by 5 % rms at solar minimum and by 3 % at maximum): the table is the Earth's air as a function of latitude, local time,
altitude, solar level and, for a run, the season of its dates, worth a factor of 5 over a year at 70 N and 700 km.
What knows no dates, profiles of design and tables without them, takes the mean of an equinox and a solstice.
"""

from __future__ import annotations

from functools import lru_cache
from typing import NamedTuple

import numpy as np

from sailviz.compiled import entry, inlined
from sailviz.constants import DAY
from sailviz.environment.grid import cell, flat, fraction, places, quantity
from sailviz.environment.ionosphere import exponential

NONE, EXPONENTIAL, TABLED = range(3)  # kinds of air

LEVELS = (70.0, 100.0, 145.0, 200.0)  # F10.7, sfu
GEOMAGNETIC = (5.0, 7.0, 10.0, 15.0)  # ap, nT, that goes with each of them
SEASONS = ("2019-03-21", "2019-06-21")
SEASON_STEP = 15  # d, at most, between the days of a table over dates
YEAR_NODES = 24  # of a table that holds for every year
YEAR_DAYS = 365.25
LOWEST, HIGHEST, STEP = 100e3, 1500e3, 10e3  # m
BEND, STEP_ABOVE = 250e3, 25e3  # m, of tables of real space weather, which has many
SEASON_REACHED = 1e-3  # s before a season at which a step has ended there
LATITUDES, TIMES = 19, 24

# header of a row: how many seasons it has, the place of t = 0 among them, places per second, the places of a whole year
# (0: it has none), the length of each season's table, whether steps of an integrator end at the seasons (1) or not
_SEASONS, _FIRST, _RATE, _ROUND, _LENGTH, _STEPS_END, _HEADER = range(7)
_YEAR_SAMPLES = 8  # days that pymsis is asked for, which fix the year's first four harmonics
_HARMONICS = 8  # local times that pymsis is asked for; they fix the model's three tides, and these the table
_WITHOUT = {"all_ut_effects": 0, "longitudinal": 0, "mixed_ut_long": 0, "mixed_ap_ut_long": 0}


class Parameters(NamedTuple):
    """The air that a craft meets, and what it offers to it."""

    kind: int = NONE
    drag_area: float = 0.0  # m2, drag coefficient times area
    reference_radius: float = 0.0  # m, these three of an exponential atmosphere
    density: float = 0.0  # kg/m3
    scale_height: float = 0.0  # m


def _altitudes():
    return np.arange(LOWEST, HIGHEST + STEP / 2, STEP)


def _msis(latitudes, f107, ap, seasons):
    """Density, kg/m3, at latitudes (l,) deg: (local times, l, altitudes), averaged over the seasons."""
    from pymsis import calculate  # 0.1 s to import, needed only where air is

    longitudes = 360.0 / _HARMONICS * np.arange(_HARMONICS) - 180.0  # at noon UT: local time from midnight on
    given = {"f107s": [f107], "f107as": [f107], "aps": [[ap] * 7], "version": 2.1, **_WITHOUT}
    height = 1e-3 * _altitudes()
    days = [np.datetime64(day, "m") + np.timedelta64(12, "h") for day in seasons]
    density = [calculate([day], longitudes, latitudes, height, **given)[0, ..., 0] for day in days]
    return np.mean(density, axis=0, dtype=float)


@lru_cache(64)  # half a megabyte each
def _nodes(f107, ap, seasons):
    """ln of the density at the nodes of one solar level: (latitudes, local times, altitudes)."""
    return _tides(np.log(_msis(np.linspace(-90, 90, LATITUDES), f107, ap, seasons)))


def _tides(log_density):
    """Of (local times asked, latitudes, altitudes): all local times, (latitudes, local times, altitudes)."""
    tides = np.fft.rfft(log_density, axis=0)
    tides[-1] /= 2  # the highest one, which eight values cannot tell from its mirror image
    return np.moveaxis(np.fft.irfft(tides, TIMES, axis=0) * (TIMES / _HARMONICS), 0, 1)


def _levels(levels, ap):
    """Solar levels (k,) and pairs of level and ap."""
    levels = np.atleast_1d(np.asarray(levels, dtype=float))
    ap = np.asarray(ap, dtype=float)
    if ap.ndim and ap.shape != levels.shape:
        raise ValueError(f"ap must be one number or one for each of the {levels.size} solar levels, not {ap.size}")
    return levels, list(zip(levels.tolist(), np.broadcast_to(ap, levels.shape).tolist(), strict=True))


def _row(levels, tables, first=0.0, rate=0.0, around=0, altitudes=None, steps_end=0):
    """A row of one table per season, each (levels, latitudes, local times, altitudes)."""
    rows = [flat(nodes[..., None], _altitudes() if altitudes is None else altitudes, levels) for nodes in tables]
    return np.concatenate([[len(rows), first, rate, around, len(rows[0]), steps_end], *rows])


def table(levels=LEVELS, ap=GEOMAGNETIC, seasons=SEASONS):
    """The atmosphere without dates as a flat row (n,) for `lookup`, made in 0.07 s per solar level.

    levels : F10.7 in sfu, increasing, or one number for a constant Sun; ap : nT, one number or one per level; seasons :
    days (ISO) whose densities are averaged. Against pymsis itself, without longitude and universal time, at random
    places: 0.9 % rms and 4.5 % at most from 150 to 1500 km, 3.3 % and 12 % between 100 and 150 km, where ln rho bends
    within a step of 10 km; between the default solar levels 3.4 % rms and 9 % at most.
    Source: NRLMSIS 2.1 (J. T. Emmert et al., J. Geophys. Res. Space Phys. 127, e2022JA030896, 2022) by pymsis.
    """
    levels, pairs = _levels(levels, ap)
    return _row(levels, [np.stack([_nodes(level, index, tuple(seasons)) for level, index in pairs])])


def _own_days(start, duration):
    """Noons (datetime64[D]) at even steps of SEASON_STEP days at most, the first before the start and the last after
    the end."""
    noon = np.timedelta64(12, "h")
    first, end = (start - noon).astype("datetime64[D]"), start + np.timedelta64(round(duration), "s") - noon
    span = max(1, int(np.ceil((end - first) / np.timedelta64(1, "D"))))
    steps = -(-span // SEASON_STEP)
    return first + -(-span // steps) * np.arange(steps + 1)


def _day_of_year(moment):
    """Days since the year began, with fractions."""
    return float((moment - moment.astype("datetime64[Y]")) / np.timedelta64(1, "s")) / DAY


@lru_cache(len(LEVELS))  # twelve megabytes each
def _year(f107, ap):
    """ln of the density of one solar level at YEAR_NODES evenly spaced moments of any year, from a sum of harmonics."""
    days = np.round(YEAR_DAYS / _YEAR_SAMPLES * np.arange(_YEAR_SAMPLES)).astype(int)
    seen = np.stack([_nodes(f107, ap, (str(np.datetime64("2019-01-01") + day),)) for day in days])

    def harmonics(day):
        angle = 2 * np.pi / YEAR_DAYS * np.asarray(day)[:, None] * np.arange(1, _YEAR_SAMPLES // 2 + 1)
        return np.hstack([np.ones((len(angle), 1)), np.cos(angle), np.sin(angle[:, :-1])])

    wanted = harmonics(YEAR_DAYS / YEAR_NODES * np.arange(YEAR_NODES))
    weights = wanted @ np.linalg.inv(harmonics(days + 0.5))  # seen at noon
    return np.tensordot(weights, seen, 1)


def table_over(start, duration, levels=LEVELS, ap=GEOMAGNETIC):
    """The atmosphere over the dates of a run as a flat row for `lookup`; levels, ap and source as in `table`.

    start : np.datetime64, UTC, of t = 0; duration : s. Up to 105 days, days of the run itself stand at most 15 days
    apart; for longer runs 24 moments of the year, which comes round again. ln rho is linear between them. That costs
    0.03 s for each day and solar level, and 0.25 s for a year; it adds 0.7 % rms to the errors of `table`, 3 % at most.
    """
    start = np.datetime64(start, "s")
    levels, pairs = _levels(levels, ap)
    days = _own_days(start, duration)
    if len(days) <= _YEAR_SAMPLES:
        tables = [np.stack([_nodes(level, index, (str(day),)) for level, index in pairs]) for day in days]
        step = (days[1] - days[0]) / np.timedelta64(1, "s")
        first = (start - days[0] - np.timedelta64(12, "h")) / np.timedelta64(1, "s")
        return _row(levels, tables, first / step, 1 / step)
    rate = YEAR_NODES / YEAR_DAYS
    years = np.stack([_year(level, index) for level, index in pairs], axis=1)
    return _row(levels, years, _day_of_year(start) * rate, rate / DAY, YEAR_NODES)


def moments_of_weather(start, duration, storms=False):
    """Moments (k,) datetime64[s], from before the start to after the end, at which the air of real space weather is
    tabulated: noons, or with storms the middles of the three hours of each value of ap."""
    step = np.timedelta64(3 if storms else 24, "h")
    half = step.astype("timedelta64[s]") / 2
    start = np.datetime64(start, "s")
    day = start.astype("datetime64[D]").astype("datetime64[s]")
    before = (start - half - day) // step  # of the moments of this day, may be -1
    end = start + np.timedelta64(int(np.ceil(duration)), "s")
    after = -((day + half - end) // step)
    return day + half + step * np.arange(before, max(after, before + 1) + 1)


def table_of_weather(start, duration, given, storms=False, version=2.1):
    """The atmosphere of real space weather over a run as a flat row for `lookup`, which gives the same for any f107.

    start : np.datetime64, UTC, of t = 0; duration : s; given : function of dates (k,) that returns what NRLMSIS takes
    (`space_weather.SpaceWeather.given`); storms : by ap every three hours instead of its daily mean. ln rho is linear
    in time between the noons, or the middles of three hours. Against pymsis itself at random places from 200 to 900 km,
    without longitude and universal time: 1 % rms and 6 % at most. Source as in `table`. It takes 0.02 s and 0.25 MB a
    day, with storms eight times as much.
    """
    from pymsis import calculate

    moments = moments_of_weather(start, duration, storms)
    altitudes = np.concatenate([np.arange(LOWEST, BEND, STEP), np.arange(BEND, HIGHEST + STEP_ABOVE / 2, STEP_ABOVE)])
    flux, mean_flux, ap = given(moments)
    mode = {"geomagnetic_activity": -1.0} if storms else {}
    latitudes = np.linspace(-90, 90, LATITUDES)
    tables = []
    for moment, *today in zip(moments, flux, mean_flux, ap, strict=True):
        hours = (moment - moment.astype("datetime64[D]")) / np.timedelta64(1, "h")
        longitudes = 360.0 / _HARMONICS * np.arange(_HARMONICS) - 15.0 * hours  # local time from midnight on
        arguments = {"f107s": [today[0]], "f107as": [today[1]], "aps": [today[2]]}
        longitudes = np.remainder(longitudes + 180.0, 360.0) - 180.0
        density = calculate(
            [moment], longitudes, latitudes, 1e-3 * altitudes, **arguments, version=version, **_WITHOUT, **mode
        )[0, ..., 0]
        tables.append(_tides(np.log(density.astype(float)))[None])
    step = (moments[1] - moments[0]) / np.timedelta64(1, "s")
    first = (np.datetime64(start, "ns") - moments[0]) / np.timedelta64(1, "ns") * 1e-9
    return _row([0.0], tables, first / step, 1 / step, altitudes=altitudes, steps_end=1)


@inlined
def next_season(p, at, t):
    """Time, s after t, of the next season of the row that begins at p[at], where steps of an integrator end; infinite
    where they need not."""
    if p[at + _STEPS_END] == 0.0:
        return np.inf
    rate = p[at + _RATE]
    moment = p[at + _FIRST] + rate * t
    wait = (np.floor(moment) + 1.0 - moment) / rate
    return wait if wait > SEASON_REACHED else wait + 1.0 / rate


def days_over(start, duration):
    """Days (ISO) that stand for the dates of a run where its mean air is asked for: as many as `table_over` asks pymsis
    for, but in the middle of equal parts of the run, or of its first year."""
    start = np.datetime64(start, "s")
    span = min(duration, YEAR_DAYS * DAY)
    count = min(_YEAR_SAMPLES, int(np.ceil(span / (SEASON_STEP * DAY))))
    middles = span / count * (np.arange(count) + 0.5)
    return tuple(str((start + np.timedelta64(round(middle), "s")).astype("datetime64[D]")) for middle in middles)


@inlined
def lookup(p, at, t, latitude, local_time, altitude, f107):
    """Density, kg/m3, from the row of `table` or `table_over` that begins at p[at]: ln rho linear in all arguments,
    held at the edges. t : s since the start; latitude : rad; local_time : rad, 0 at midnight, any number of turns;
    altitude : m, 100-1500 km; f107 : sfu.
    """
    return density_in(p, at, t, cell(p, grid_at(at), latitude, local_time, altitude, f107, 1))


@inlined
def grid_at(at):
    """Where the grid of the first season begins in a row that begins at `at`; the others' cells are the same."""
    return at + _HEADER


@inlined
def density_in(p, at, t, place):
    """As `lookup`, at a place in the grid of the first season that `cell` or `held_cell` found."""
    seasons, around, length = p[at + _SEASONS], p[at + _ROUND], int(p[at + _LENGTH])
    if seasons == 1.0:
        return np.exp(quantity(p, place, 0, 1))
    moment = p[at + _FIRST] + p[at + _RATE] * t
    count = seasons
    if around > 0.0:
        moment -= np.floor(moment / around) * around
        count = around + 1.0
    season, weight = fraction(moment, count)
    following = season + 1 if season + 1 < int(seasons) else 0
    n, row, column, step, wi, wj, wk, wl = place
    now = quantity(p, (n + np.uint64(season * length), row, column, step, wi, wj, wk, wl), 0, 1)
    then = quantity(p, (n + np.uint64(following * length), row, column, step, wi, wj, wk, wl), 0, 1)
    return np.exp(now + weight * (then - now))


@inlined
def air_drag(x, y, z, vx, vy, vz, rotation, k):
    """Acceleration, m/s2, by drag against the velocity through air that turns with the body at `rotation`, rad/s about
    +z; k = density Cd A / mass, 1/m."""
    qx, qy, qz = vx + rotation * y, vy - rotation * x, vz
    k = -0.5 * k * np.sqrt(qx * qx + qy * qy + qz * qz)
    return k * qx, k * qy, k * qz


@inlined
def exponential_air_drag(x, y, z, vx, vy, vz, m, r, rotation, p):
    """Drag of an exponential atmosphere, m/s2. p : Parameters."""
    density = exponential(r, p.reference_radius, p.density, p.scale_height)
    return air_drag(x, y, z, vx, vy, vz, rotation, density * (p.drag_area / m))


@entry("d1 d2 D1")
def _lookups(p, where, result):
    for i in range(where.shape[1]):
        result[i] = lookup(p, 0, where[0, i], where[1, i], where[2, i], where[3, i], where[4, i])
    return 0


def density(latitude, local_time, altitude, f107, row=None, time=0.0):
    """Density, kg/m3, from a row of `table` or `table_over` (the default `table`, if none is given) at a time, s, since
    its start; arguments as in `lookup`, scalars or arrays that broadcast, and the result has their shape."""
    where, shape = places(time, latitude, local_time, altitude, f107)
    result = np.empty(where.shape[1])
    _lookups(table() if row is None else row, where, result)
    return result.reshape(shape)[()]


def mean_profile(f107, ap, inclination=np.pi / 2, seasons=SEASONS):
    """Density that a circular orbit meets on average, over local time and the latitudes it visits.

    f107 : sfu, ap : nT, inclination : rad. Returns (altitude (141,) m, density (141,) kg/m3), to be interpolated
    linearly in ln rho. Source as in `table`, straight from pymsis at 8 local times and 19 even steps of the argument
    of latitude from the southernmost to the northernmost point (uniform in latitude for a polar orbit).
    """
    along = np.radians(np.linspace(-90.0, 90.0, LATITUDES))
    latitudes = np.degrees(np.arcsin(np.sin(inclination) * np.sin(along)))
    return _altitudes(), _msis(latitudes, float(f107), float(ap), seasons).mean(axis=(0, 1))
