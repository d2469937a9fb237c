"""How active the Sun is, as F10.7, the radio flux at 10.7 cm in sfu (1e-22 W/m2/Hz): constant, an 11-year cycle, or
day by day."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from sailviz.compiled import inlined
from sailviz.constants import DAY, YEAR

NOON_REACHED = 1e-3  # s before a noon at which a step has ended there
LOWEST_FLUX, HALF_SWING, MINIMUM, PERIOD = 70.0, 61.5, 2019.96, 11.0  # sfu, sfu, decimal year, years


class Parameters(NamedTuple):
    """mean - swing cos(phase + rate t); or values of days in the tables, linear in time between their noons."""

    mean: float  # sfu
    swing: float  # sfu
    rate: float  # rad/s
    phase: float  # rad
    days: int = 0  # how many values there are in the tables; 0 for none
    first: float = 0.0  # s, the noon of the first of them after the start


def constant(f107: float) -> Parameters:
    """Parameters of `flux` for an unchanging Sun, f107 in sfu."""
    return Parameters(float(f107), 0.0, 0.0, 0.0)


def cycle(year: float) -> Parameters:
    """Parameters of `flux` for F10.7 = 70 + 61.5 (1 - cos(2 pi (year - 2019.96) / 11)), where a run begins in a decimal
    year (`ephemeris.decimal_year`). A smooth stand-in for cycle 24 and its like: 70 in December 2019, 193 at maximum;
    real maxima range from 120 to 230."""
    rate = 2 * np.pi / PERIOD
    phase = np.remainder(rate * (year - MINIMUM), 2 * np.pi)
    return Parameters(LOWEST_FLUX + HALF_SWING, HALF_SWING, rate / YEAR, float(phase))


def daily(count: int, first: float) -> Parameters:
    """Parameters of `flux_of_days` for count values, the first at first s after the start."""
    return Parameters(0.0, 0.0, 0.0, 0.0, count, first)


@inlined
def flux_of_days(t, p, tables, at):
    """F10.7, sfu, at t s after the start, of days that begin at tables[at], held at the first and the last. p :
    Parameters, of `daily`."""
    place = (t - p.first) / DAY
    day = int(np.floor(place)) if place > 0.0 else 0
    day = min(day, p.days - 2)
    weight = min(max(place - day, 0.0), 1.0)
    return tables[at + day] + weight * (tables[at + day + 1] - tables[at + day])


@inlined
def next_day(t, p):
    """Time, s after t, of the next noon, where the slope of `flux_of_days` changes. p : Parameters, of `daily`."""
    place = (t - p.first) / DAY
    wait = (np.floor(place) + 1.0 - place) * DAY
    return wait if wait > NOON_REACHED else wait + DAY


@inlined
def flux(t, p):
    """F10.7, sfu, at t s after the start. p : Parameters, of `constant` or `cycle`."""
    if p.swing == 0.0:
        return p.mean
    return p.mean - p.swing * np.cos(p.phase + p.rate * t)
