"""What surrounds a low orbit: the Earth, its Sun and shadow, its air and plasma."""

from __future__ import annotations

from datetime import datetime, timedelta
from functools import cache
from pathlib import Path

import numpy as np
from independent.constants import AU, J2, J3, J4, MU_EARTH, RADIUS_EARTH, ROTATION, body
from numpy.polynomial.legendre import Legendre
from scipy.interpolate import RegularGridInterpolator

from sailviz.shipped import shipped_folder


def spin_of_earth(scene):
    return np.array([0, 0, ROTATION if scene.environment.corotation else 0.0])


def days_since_j2000(scene, t):
    epoch = scene.epoch if isinstance(scene.epoch, datetime) else datetime(*scene.epoch.timetuple()[:3])
    return (epoch.replace(tzinfo=None) - datetime(2000, 1, 1, 12)).total_seconds() / 86400 + t / 86400


def mean_longitude(scene, t):
    """Of the Sun, rad: the right ascension of the mean Sun, by which local time goes."""
    if scene.epoch is None:
        return (scene.environment.sun_right_ascension or 0.0) + 2 * np.pi * t / (365.25 * 86400)
    return np.radians(280.460 + 0.9856474 * days_since_j2000(scene, t))


def sun(scene, t):
    """Unit vector to the Sun, equator of date: Astronomical Almanac, low precision."""
    longitude, tilt = mean_longitude(scene, t), np.radians(23.439)
    if scene.epoch is not None:
        n = days_since_j2000(scene, t)
        g = np.radians(357.528 + 0.9856003 * n)
        longitude += np.radians(1.915 * np.sin(g) + 0.020 * np.sin(2 * g))
        tilt -= np.radians(4e-7 * n)
    return np.array([np.cos(longitude), np.cos(tilt) * np.sin(longitude), np.sin(tilt) * np.sin(longitude)])


def sunlit(scene, t, r):
    """Whether at least half of the Sun is seen. In the cone, the Sun's centre at the limb stands for that: 5 ms."""
    to_sun, radius = sun(scene, t), body(scene)[1]
    if scene.environment.shadow != "cone":
        return r @ to_sun > 0 or np.linalg.norm(r - (r @ to_sun) * to_sun) > radius
    to_sun = AU * to_sun - r
    apart = np.arccos(-(to_sun @ r) / np.linalg.norm(to_sun) / np.linalg.norm(r))
    return apart > np.arcsin(radius / np.linalg.norm(r))


def altitude(scene, r):
    """Above the sphere, or above the ellipsoid by Bowring's iteration."""
    if scene.environment.height_above == "sphere":
        return np.linalg.norm(r) - body(scene)[1]
    flattening = 1 / 298.257223563
    squash = flattening * (2 - flattening)
    out = np.hypot(r[0], r[1])
    tangent = r[2] / (out * (1 - squash))
    for _ in range(4):
        latitude = np.arctan(tangent)
        curvature = RADIUS_EARTH / np.sqrt(1 - squash * np.sin(latitude) ** 2)
        tangent = (r[2] + squash * curvature * np.sin(latitude)) / out
    return out * np.cos(latitude) + r[2] * np.sin(latitude) - RADIUS_EARTH**2 / curvature


def place(scene, t, r):
    """(latitude deg, local time h, altitude km) as the tables count them."""
    hour = np.degrees(np.arctan2(r[1], r[0]) - mean_longitude(scene, t)) / 15 + 12
    return np.degrees(np.arcsin(r[2] / np.linalg.norm(r))), hour % 24, altitude(scene, r) / 1e3


def solar_flux(scene, t):
    if scene.environment.solar_flux != "cycle":
        return scene.environment.solar_flux
    year = 2000 + days_since_j2000(scene, t) / 365.25
    return 70 + 61.5 * (1 - np.cos(2 * np.pi * (year - 2019.96) / 11))


def gridded(latitude, hour, height, values):
    """Straight lines between the nodes, round the clock, held at the top and the bottom."""
    hour, values = [*hour, 24.0], np.concatenate([values, values[:, :1]], axis=1)
    inside = RegularGridInterpolator((latitude, hour, height), values)
    return lambda where: inside((where[0], where[1], min(max(where[2], height[0]), height[-1])))


@cache
def plasma_table():
    """ln of the density (1/m3) at three solar levels, then the mean ion masses (kg)."""
    with np.load(shipped_folder("assets") / "ionosphere_iri2020.npz") as file:
        levels = ("min2019", "mid2014", "max2001")
        values = [np.log(file[f"{name}_electron_density_m3"].astype(float)) for name in levels]
        values += [1.66053906660e-27 * file[f"{name}_mean_ion_mass_u"].astype(float) for name in levels]
        axes = file["latitude_deg"], file["local_time_h"], file["altitude_km"]
    return gridded(*axes, np.stack(values, axis=-1))


@cache
def days_of(file):
    """Date -> (F10.7 observed, its centred mean of 81 days, daily Ap) of a file of CelesTrak's, by columns."""
    rows = [line.split(",") for line in file.read_text().splitlines()[1:]]
    return {row[0]: (float(row[24]), float(row[27]), float(row[20])) for row in rows if row[20]}


def air_of_day(scene, day):
    """The same for a noon of real weather: the flux of the day before, its mean and the Ap of the day."""
    days = days_of(Path(scene.source).parent / scene.environment.space_weather.file)
    _, mean, ap = days[str(day)]
    return air_table((days[str(day - timedelta(days=1))][0],), ap, day, mean)


@cache
def air_table(levels, ap, day, mean=None):
    """ln of the density (kg/m3) at solar levels, from NRLMSIS 2.1, at noon of a day: what depends on longitude and UT
    off, eight local times made 24 by their Fourier sum."""
    from pymsis import calculate

    off = {"all_ut_effects": 0, "longitudinal": 0, "mixed_ut_long": 0, "mixed_ap_ut_long": 0}
    latitude, height = np.linspace(-90, 90, 19), np.arange(100.0, 1500.1, 10)
    if mean is not None:  # of real weather, a table for each day
        height = np.array([*np.arange(100.0, 250, 10), *np.arange(250.0, 1500.1, 25)])
    values = []
    for level in levels:
        drivers = {
            "f107s": [level],
            "f107as": [level if mean is None else mean],
            "aps": [[ap] * 7],
            "version": 2.1,
        } | off
        noon = [f"{day}T12:00"]  # longitude -180 deg has midnight at noon UT
        seen = calculate(noon, np.arange(-180.0, 180, 45), latitude, height, **drivers)[0, ..., 0]
        log, angle = np.log(seen.astype(float)), np.radians(np.arange(0, 360, 45))
        fine, total = np.radians(np.arange(0, 360, 15)), log.mean(axis=0)[None]
        for k in range(1, 5):
            weight = 1 / 8 if k == 4 else 1 / 4
            total = total + np.tensordot(np.cos(k * (fine[:, None] - angle)), weight * log, 1)
        values.append(np.swapaxes(total, 0, 1))
    return gridded(latitude, np.arange(0.0, 24), height, np.stack(values, axis=-1))


def air_drag(scene):
    """(t, r, v, mass) -> acceleration; None without air."""
    air, craft = scene.environment.atmosphere, scene.device
    if air is None:
        return None
    if air.kind == "nrlmsis-2.1":
        level = scene.environment.solar_flux
        levels = (70.0, 100.0, 145.0, 200.0) if level == "cycle" else (level,)
        # the noons before and after a run of hours, or those about one through real weather; straight lines between
        begin = datetime(2000, 1, 1, 12) + timedelta(days=days_since_j2000(scene, 0.0))
        before = (begin - timedelta(hours=12)).replace(hour=12, minute=0, second=0, microsecond=0)
        last = int((begin + timedelta(seconds=scene.propagation.duration) - before) / timedelta(days=1)) + 1
        assert last == 1 or scene.environment.space_weather is not None
        days = [(before + timedelta(days=i)).date() for i in range(last + 1)]
        noons = 86400.0 * np.arange(last + 1) + (before - begin).total_seconds()
        if scene.environment.space_weather is not None:
            levels, tables = (70.0,), [air_of_day(scene, day) for day in days]
        else:
            tables = [air_table(levels, air.ap, day) for day in days]

    def flux(t):
        return levels[0] if len(levels) == 1 else solar_flux(scene, t)

    def drag(t, r, v, mass, area):
        if air.kind == "exponential":
            density = air.density * np.exp(
                (air.reference_altitude - np.linalg.norm(r) + body(scene)[1]) / air.scale_height
            )
        else:
            where = place(scene, t, r)
            i = min(max(int(np.searchsorted(noons, t, side="right")) - 1, 0), len(noons) - 2)
            log = [np.interp(flux(t), levels, table(where).ravel()) for table in tables[i : i + 2]]
            density = np.exp(np.interp(t, noons[i : i + 2], log))
        u = v - np.cross(spin_of_earth(scene), r)
        return -0.5 * density * craft.drag_coefficient * area / mass * np.linalg.norm(u) * u

    return drag


ZONAL = {n: (Legendre.basis(n), Legendre.basis(n).deriv()) for n in (2, 3, 4)}


def oblate(environment, r):
    """Pull of the zonal harmonics: gradient of -(mu / r) J_n (R / r)^n P_n(z / r)."""
    size = np.linalg.norm(r)
    s, up, a = r[2] / size, r / size, np.zeros(3)
    for n, j in ((2, J2 * environment.j2), (3, J3 * environment.j3), (4, J4 * environment.j4)):
        if not j:
            continue
        p, slope = ZONAL[n]
        k = MU_EARTH * j * (RADIUS_EARTH / size) ** n / size**2
        a = a + k * ((n + 1) * p(s) * up - slope(s) * (np.array([0, 0, 1.0]) - s * up))
    return a
