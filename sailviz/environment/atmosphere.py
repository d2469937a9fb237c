"""Neutral air around the Earth: NRLMSIS 2.1 tabulated when a scene is loaded, and its mean over a day as a profile.

The solar flux F10.7 and the geomagnetic index ap are always given, the mean of 81 days equal to the day's value, so
that pymsis never asks the network. What depends on longitude and universal time is switched off (it changes the density
by 5 % rms at solar minimum and by 3 % at maximum), and the season is the mean of an equinox and a solstice, as for the
ionosphere: the table is the Earth's air as a function of latitude, local time, altitude and solar level alone.
"""

from __future__ import annotations

from functools import cache
from typing import NamedTuple

import numpy as np

from sailviz.compiled import compiled, inlined
from sailviz.environment.grid import cell, flat, places, quantity
from sailviz.environment.ionosphere import exponential

NONE, EXPONENTIAL, TABLED = range(3)  # kinds of air

LEVELS = (70.0, 100.0, 145.0, 200.0)  # F10.7, sfu
GEOMAGNETIC = (5.0, 7.0, 10.0, 15.0)  # ap, nT, that goes with each of them
SEASONS = ("2019-03-21", "2019-06-21")
LOWEST, HIGHEST, STEP = 100e3, 1500e3, 10e3  # m
LATITUDES, TIMES = 19, 24

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


@cache
def _nodes(f107, ap, seasons):
    """ln of the density at the nodes of one solar level: (latitudes, local times, altitudes)."""
    log_density = np.log(_msis(np.linspace(-90, 90, LATITUDES), f107, ap, seasons))
    tides = np.fft.rfft(log_density, axis=0)
    tides[-1] /= 2  # the highest one, which eight values cannot tell from its mirror image
    return np.moveaxis(np.fft.irfft(tides, TIMES, axis=0) * (TIMES / _HARMONICS), 0, 1)


def table(levels=LEVELS, ap=GEOMAGNETIC, seasons=SEASONS):
    """The atmosphere as a flat row (n,) for `lookup`, made in 0.07 s per solar level.

    levels : F10.7 in sfu, increasing, or one number for a constant Sun; ap : nT, one number or one per level; seasons :
    days (ISO) whose densities are averaged. Against pymsis itself, without longitude and universal time, at random
    places: 0.9 % rms and 4.5 % at most from 150 to 1500 km, 3.3 % and 12 % between 100 and 150 km, where ln rho bends
    within a step of 10 km; between the default solar levels 3.4 % rms and 9 % at most.
    Source: NRLMSIS 2.1 (J. T. Emmert et al., J. Geophys. Res. Space Phys. 127, e2022JA030896, 2022) by pymsis.
    """
    levels = np.atleast_1d(np.asarray(levels, dtype=float))
    ap = np.asarray(ap, dtype=float)
    if ap.ndim and ap.shape != levels.shape:
        raise ValueError(f"ap must be one number or one for each of the {levels.size} solar levels, not {ap.size}")
    pairs = zip(levels.tolist(), np.broadcast_to(ap, levels.shape).tolist(), strict=True)
    nodes = np.stack([_nodes(level, index, tuple(seasons)) for level, index in pairs])
    return flat(nodes[..., None], _altitudes(), levels)


@inlined
def lookup(p, at, latitude, local_time, altitude, f107):
    """Density, kg/m3, from the row of `table` that begins at p[at]: ln rho linear in all four arguments, held at the
    edges. latitude : rad; local_time : rad, 0 at midnight, any number of turns; altitude : m, 100-1500 km; f107 : sfu.
    """
    return np.exp(quantity(p, cell(p, at, latitude, local_time, altitude, f107, 1), 0, 1))


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
    return air_drag(x, y, z, vx, vy, vz, rotation, density * p.drag_area / m)


@compiled
def _lookups(p, where, result):
    for i in range(where.shape[1]):
        result[i] = lookup(p, 0, where[0, i], where[1, i], where[2, i], where[3, i])


def density(latitude, local_time, altitude, f107, row=None):
    """Density, kg/m3, from a row of `table` (the default one, if none is given); arguments as in `lookup`, scalars or
    arrays that broadcast, and the result has their shape."""
    where, shape = places(latitude, local_time, altitude, f107)
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
