"""How active the Sun is, as F10.7, the radio flux at 10.7 cm in sfu (1e-22 W/m2/Hz): constant, or an 11-year cycle."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from sailviz.compiled import inlined
from sailviz.constants import YEAR

LOWEST_FLUX, HALF_SWING, MINIMUM, PERIOD = 70.0, 61.5, 2019.96, 11.0  # sfu, sfu, decimal year, years


class Parameters(NamedTuple):
    """mean - swing cos(phase + rate t)."""

    mean: float  # sfu
    swing: float  # sfu
    rate: float  # rad/s
    phase: float  # rad


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


@inlined
def flux(t, p):
    """F10.7, sfu, at t s after the start. p : Parameters, of `constant` or `cycle`."""
    if p.swing == 0.0:
        return p.mean
    return p.mean - p.swing * np.cos(p.phase + p.rate * t)
