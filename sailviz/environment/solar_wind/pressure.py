"""Solar-wind dynamic pressure at 1 au as a history in steps, and what it does to an E-sail's thrust.

The thrust goes with the square root of the pressure at 1 au, (3.41); a = factor * nominal, factor = sqrt(p / p_ref) at
constant voltage. A history is one random value for the whole flight, independent values redrawn every interval (the
thesis' law in paper J.8's abstract: "a random variable with a gamma distribution"), values that forget slowly, or a
measured series. Intervals and parameters are choices of the scene; the numbers below are our own fits to the hourly
measurements of NASA's OMNI2, 1998-2018.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from sailviz.compiled import entry
from sailviz.constants import ELEMENTARY_CHARGE, MASS_PROTON, WIND_POTENTIAL, YEAR
from sailviz.environment.solar_wind.laws import Gamma, Law
from sailviz.environment.solar_wind.series import Series

KINDS = ("constant", "redrawn", "correlated")
CORRELATION_TIME = 17 * 3600.0  # s, of the normal number behind the pressure; hourly sqrt p falls to 1/e in 16 h
YEARLY_DEVIATION = 0.175  # of ln p between annual means: 1.33 nPa in 2009, 2.75 nPa in 2003
MEAN_PRESSURE = 2.0206e-9  # Pa, of 1998-2018
ALPHA_SHARE = 1.139  # pressure over m_p n v^2 of the protons, median: alpha particles push as well

PHASES = {  # gamma law of the hourly pressures in a stretch of the solar cycle
    "2000-2002": Gamma(2.174, 1.031e-9),  # maximum of cycle 23
    "2003-2005": Gamma(2.454, 0.988e-9),  # declining: the windiest years
    "2008-2009": Gamma(3.996, 0.368e-9),  # deep minimum
    "2010-2011": Gamma(3.048, 0.524e-9),
    "2012-2014": Gamma(2.466, 0.701e-9),  # maximum of cycle 24
    "2015-2017": Gamma(3.232, 0.725e-9),
}


def gamma_pressure(shape, scale, interval, duration, seed):
    """Independent gamma-distributed pressure, redrawn every interval.

    shape : -, scale : Pa, interval and duration : s, seed : int. Returns (times (k,) s at which each value begins,
    pressure (k,) Pa). The same seed gives the same history whatever the duration, as far as both reach.
    """
    count = int(np.ceil(duration / interval))
    times = interval * np.arange(count)
    return times, np.random.Generator(np.random.PCG64(seed)).gamma(shape, scale, size=count)


def reference_pressure(shape, scale, unbiased=False):
    """`Law.reference_pressure` of a gamma law, Pa: the mean k theta, or (E sqrt p)^2, which leaves the mean thrust
    nominal."""
    return Gamma(shape, scale).reference_pressure(unbiased)


def thrust_factor(pressure, reference):
    """Thrust over nominal thrust at constant voltage: sqrt(p / p_ref). Pressures in Pa, any shape."""
    return np.sqrt(np.asarray(pressure, dtype=float) / reference)


def wind_potential(speed=None):
    """Potential Vw of the wind's protons, V: m_p v^2 / (2 e) for a speed in m/s, any shape; without a speed the
    thesis' 1 kV. Thrust needs a tether voltage above it."""
    if speed is None:
        return WIND_POTENTIAL
    return MASS_PROTON * np.square(speed) / (2 * ELEMENTARY_CHARGE)


def proton_density(pressure, speed):
    """Proton density, 1/m3, behind a pressure in Pa at a speed in m/s, with the usual share of alpha particles."""
    return np.asarray(pressure) / (ALPHA_SHARE * MASS_PROTON * np.square(speed))


def generator(seed, flight=None, purpose=0) -> np.random.Generator:
    """PCG64 stream of a flight. It depends on seed, flight number and purpose alone, so that neither the number of
    flights nor of threads changes what a flight meets; without a flight number, the stream of a single run."""
    if flight is None and not purpose:
        return np.random.Generator(np.random.PCG64(seed))
    key = (purpose,) if flight is None else (purpose, flight)
    return np.random.Generator(np.random.PCG64(np.random.SeedSequence(seed, spawn_key=key)))


def history(law: Law, times, seed, kind="redrawn", *, interval=None, correlation_time=None, flight=None):
    """Pressures (n,) Pa of one flight, each from its time on until the next.

    times : (n,) s, rising. seed : int. kind : "constant", one value for all; "redrawn", an independent value for every
    `interval` s counted from times[0] (None: for every time); "correlated", p = F^-1(Phi(z)) with z a stationary
    Ornstein-Uhlenbeck process, corr(z(t), z(t + d)) = exp(-d / correlation_time), s (None: CORRELATION_TIME, 17 h).
    A longer history begins like a shorter one. ValueError for what a kind does not take.
    """
    if kind not in KINDS:
        raise ValueError(f"a pressure history is {', '.join(KINDS)}, not {kind!r}")
    for name, value, user in (("interval", interval, "redrawn"), ("correlation_time", correlation_time, "correlated")):
        if value is not None and kind != user:
            raise ValueError(f"a {kind} history takes no {name}, only a {user} one does")
        if value is not None and not value > 0:
            raise ValueError(f"{name} must be positive, not {value:g} s")
    times = np.asarray(times, dtype=float)
    if times.ndim != 1 or not len(times) or np.any(np.diff(times) <= 0):
        raise ValueError("the times of a history must be (n,) and rise")
    random = generator(seed, flight)
    if kind == "constant":
        return np.full(len(times), law.sample(random, 1)[0])
    if kind == "redrawn":
        if interval is None:
            return law.sample(random, len(times))
        turn = np.floor((times - times[0]) / interval * (1 + 1e-12)).astype(int)
        return law.sample(random, turn[-1] + 1)[turn]
    return law.from_normal(relaxing_normals(times, random, correlation_time or CORRELATION_TIME))


def relaxing_normals(times, random, correlation_time):
    """Stationary Ornstein-Uhlenbeck process (n,) of unit variance at times (n,) s."""
    z = random.standard_normal(len(times))
    memory = np.exp(-np.diff(times, prepend=times[:1]) / correlation_time)
    memory[:1] = 0.0
    _relax(z, memory)
    return z


@entry("D1 d1")
def _relax(z, memory):
    """z in place, from independent normal numbers to z_i = rho_i z_(i-1) + sqrt(1 - rho_i^2) N."""
    for i in range(1, len(z)):
        z[i] = memory[i] * z[i - 1] + np.sqrt(1.0 - memory[i] * memory[i]) * z[i]
    return 0


def phase_factor(phase):
    """Mean pressure of a phase of the solar cycle over that of 1998-2018; phase : a key of PHASES."""
    if phase not in PHASES:
        raise ValueError(f"there is no phase {phase!r}, only {', '.join(PHASES)}")
    return PHASES[phase].mean / MEAN_PRESSURE


def yearly_factor(times, seed, deviation=YEARLY_DEVIATION, flight=None):
    """Factor (n,) on the pressure that is drawn anew every year, exp(N(0, deviation)), for the solar cycle that no
    hourly law remembers. times (n,) s from the start. Its mean is exp(deviation^2 / 2), 1.015."""
    year = np.floor(np.asarray(times) / YEAR).astype(int)
    return np.exp(deviation * generator(seed, flight, purpose=1).standard_normal(year[-1] + 1))[year]


class Replay(NamedTuple):
    """What a flight meets of a measured series; speed and density are None if the series has none."""

    pressure: np.ndarray  # (n,) Pa
    speed: np.ndarray | None  # (n,) m/s
    density: np.ndarray | None  # (n,) 1/m3
    first: int  # index in the series


def replay(series: Series, times, *, start=None, seed=None, flight=None) -> Replay:
    """A measured series from a start on, at times (n,) s, rising, counted from times[0].

    start : an index or a UTC time (numpy datetime64 or ISO text); without one, drawn with `seed`, uniform over all
    starts from which the series lasts. Never wraps: ValueError where the series ends before the flight does.
    """
    times = np.asarray(times, dtype=float)
    offset = np.floor((times - times[0]) / series.step * (1 + 1e-12)).astype(int)
    room = len(series.pressure) - (int(offset[-1]) + 1)
    if room < 0:
        raise ValueError(
            f"the series lasts {series.duration / 86400:.6g} d, the flight "
            f"{(offset[-1] + 1) * series.step / 86400:.6g} d: a replay does not begin again at its end"
        )
    if start is not None:
        first = series.index(start)
        if first > room:
            raise ValueError(
                f"from {start} on the series lasts only {(len(series.pressure) - first) * series.step / 86400:.6g} d"
            )
    elif seed is not None:
        first = int(generator(seed, flight, purpose=2).integers(0, room + 1))
    else:
        raise ValueError("a replay needs a start or a seed to draw one")
    take = first + offset
    return Replay(
        series.pressure[take],
        None if series.speed is None else series.speed[take],
        None if series.density is None else series.density[take],
        first,
    )
