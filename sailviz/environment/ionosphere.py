"""Plasma around the Earth as a plasma brake meets it: the IRI-2020 table, and exponential profiles of drag or density.

The table holds electron density and mean ion mass m_i = sum(n_k m_k) / sum(n_k), averaged over longitude and two
seasons. A tether in a plasma of several ion species feels the sum of their drags; the mean mass instead is off by at
most 2.1 % anywhere in the table (200-1500 km). The density itself is uncertain by a factor of two at solar minimum and
of four at maximum above 500 km, since the models of the topside disagree: whoever predicts a decay time multiplies the
density by 0.5, 1 and 2.
"""

from __future__ import annotations

from functools import cache
from typing import NamedTuple

import numpy as np

from sailviz.compiled import entry, inlined
from sailviz.constants import ATOMIC_MASS
from sailviz.environment.grid import cell, flat, places, quantity
from sailviz.shipped import shipped_folder

FORCE_PROFILE, DENSITY_PROFILE, TABLE_PROFILE = range(3)
PROFILES = {"exponential-force": FORCE_PROFILE, "exponential-density": DENSITY_PROFILE}

LEVELS = {"min2019": 70.0, "mid2014": 145.0, "max2001": 193.0}  # F10.7 of the table's three epochs
LOWEST, HIGHEST = 200e3, 1500e3  # m, between which the table stands; its edges hold outside


class Parameters(NamedTuple):
    """The plasma that a tether meets."""

    kind: int = FORCE_PROFILE
    reference_altitude: float = 0.0  # m, this and the next four of an exponential profile
    value: float = 0.0  # N/m of a force profile, 1/m3 of a density profile
    scale_height: float = 0.0  # m
    ion_mass: float = 0.0  # kg
    surface_radius: float = 0.0  # m, from which altitudes count
    density_factor: float = 1.0  # by which the plasma is denser than its model


@inlined
def exponential(altitude, reference_altitude, value, scale_height):
    """value exp(-(h - h0) / H); all lengths in m."""
    return value * np.exp((reference_altitude - altitude) * (1.0 / scale_height))


@cache
def _nodes():
    """ln of the density, 1/m3, and ion mass, kg, at the nodes: (levels, latitudes, local times, altitudes, 2)."""
    with np.load(shipped_folder("assets") / "ionosphere_iri2020.npz") as file:
        density = np.stack([file[f"{name}_electron_density_m3"] for name in LEVELS]).astype(float)
        mass = np.stack([file[f"{name}_mean_ion_mass_u"] for name in LEVELS]).astype(float)
        altitudes = 1e3 * file["altitude_km"]
    nodes = np.stack([np.log(density), ATOMIC_MASS * mass], axis=-1)
    nodes.flags.writeable = False
    return nodes, altitudes


def table(f107=None):
    """The packaged ionosphere as a flat row (n,) for `lookup`.

    f107 : a constant solar level in sfu, which makes the table three times as short and the lookup faster; without it
    the row holds the three levels of LEVELS. Outside 70-193 the nearest level holds: see `in_table`.
    Source: IRI-2020 (D. Bilitza et al., Rev. Geophys. 60, e2022RG000792, 2022), computed as assets/README.md says;
    the density is the electrons', equal to the ions' in a quasi-neutral plasma.
    """
    nodes, altitudes = _nodes()
    levels = np.array(list(LEVELS.values()))
    if f107 is None:
        return flat(nodes, altitudes, levels)
    level = np.clip(f107, levels[0], levels[-1])
    low = min(int(np.searchsorted(levels, level, side="right")) - 1, len(levels) - 2)
    weight = (level - levels[low]) / (levels[low + 1] - levels[low])
    return flat((nodes[low] + weight * (nodes[low + 1] - nodes[low]))[None], altitudes, [level])


@inlined
def lookup(p, at, latitude, local_time, altitude, f107):
    """Density of electrons and ions, 1/m3, and mean ion mass, kg, from the row of `table` that begins at p[at].

    latitude : geocentric, rad; local_time : rad, 0 at midnight, any number of turns; altitude : m; f107 : sfu.
    Linear in all four, the density in its logarithm; held at the edges. A brake below 200 km is the caller's to
    switch off.
    """
    return plasma_in(p, cell(p, at, latitude, local_time, altitude, f107, 2))


@inlined
def plasma_in(p, place):
    """As `lookup`, at a place that `cell` or `held_cell` found."""
    return np.exp(quantity(p, place, 0, 2)), quantity(p, place, 1, 2)


@entry("d1 d2 D2")
def _lookups(p, where, result):
    for i in range(where.shape[1]):
        n, m = lookup(p, 0, where[0, i], where[1, i], where[2, i], where[3, i])
        result[0, i], result[1, i] = n, m
    return 0


@cache
def _whole_table():
    return table()


def density(latitude, local_time, altitude, f107):
    """Density, 1/m3, and mean ion mass, kg, of the packaged ionosphere; arguments as in `lookup`, scalars or arrays
    that broadcast, and the results have their shape."""
    where, shape = places(latitude, local_time, altitude, f107)
    result = np.empty((2, where.shape[1]))
    _lookups(_whole_table(), where, result)
    return result[0].reshape(shape)[()], result[1].reshape(shape)[()]


def in_table(altitude, f107):
    """Whether the table itself answers, and not its edge: altitude (m) within 200-1500 km and F10.7 within 70-193.
    Scalars or arrays -> bool of their common shape."""
    lowest, highest = min(LEVELS.values()), max(LEVELS.values())
    altitude, f107 = np.asarray(altitude), np.asarray(f107)
    return ((altitude >= LOWEST) & (altitude <= HIGHEST) & (f107 >= lowest) & (f107 <= highest))[()]
