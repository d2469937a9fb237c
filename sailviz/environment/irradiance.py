"""Total solar irradiance: its cycle, its flicker, a measured series; the factor S / S0 on a solar sail's thrust.

Numbers are our own fits to the PMOD/WRC merged composite, 1980-2023 (15 968 days): cycle and flicker are 3e-4 of the
mean, three orders below what the solar wind does to an electric sail. A sail's characteristic acceleration keeps the
radiation pressure of the thesis (constants.RADIATION_PRESSURE); only the ratio S / S0 acts here.
"""

from __future__ import annotations

import numpy as np

from sailviz.constants import DAY, SOLAR_IRRADIANCE, YEAR
from sailviz.environment.solar_wind.pressure import generator, relaxing_normals

PERIOD = 11.15 * YEAR  # s, of the best sinusoid
AMPLITUDE = 3.6e-4  # of S0, of the best sinusoid; annual means swing by 0.1 %, half of which is 5e-4
MAXIMUM = np.datetime64("1991-01-27T16", "s")  # 10.945 yr after 1980-02-17
FLICKER = 0.334 / SOLAR_IRRADIANCE  # standard deviation of what the cycle leaves, 0.334 W/m2
MEMORY = 0.80  # correlation after a day: the e-fold of the flicker. Sunspots' dips are deeper than such noise: replay

USUAL = (1300.0, 1420.0)  # W/m2, of a median at 1 au


def since_maximum(epoch) -> float:
    """Time, s, from the fitted maximum of January 1991 to a UTC epoch, datetime64 or ISO text."""
    return float((np.datetime64(epoch, "s") - MAXIMUM) / np.timedelta64(1, "s"))


def cycle(times, since_maximum=0.0, amplitude=AMPLITUDE, period=PERIOD):
    """S / S0 of the smooth cycle. times : s, any shape. since_maximum : s from a maximum to time 0."""
    return 1 + amplitude * np.cos(2 * np.pi * (np.asarray(times, dtype=float) + since_maximum) / period)


def flicker(times, seed, deviation=FLICKER, memory=MEMORY, flight=None):
    """Gaussian noise on S / S0 around 0, first-order autoregressive: `memory` is its correlation after a day.

    times : (n,) s, rising. The flight's stream as in `solar_wind.generator`.
    """
    if not 0 <= memory < 1:
        raise ValueError(f"the correlation after a day must lie in [0, 1), not at {memory:g}")
    correlation_time = -DAY / np.log(memory) if memory > 0 else np.finfo(float).tiny
    random = generator(seed, flight, purpose=3)
    return deviation * relaxing_normals(np.asarray(times, dtype=float), random, correlation_time)


def replay(irradiance, step, times, *, start=None, seed=None, flight=None):
    """S / S0 (n,) from a measured series. irradiance : (m,) W/m2 at 1 au in steps of `step` s, S0 its own constant.

    times : (n,) s, rising, counted from times[0]; start : index, or drawn with the seed. Never wraps. ValueError for
    missing values, a wrong unit or a series that ends before the flight.
    """
    s = np.asarray(irradiance, dtype=float)
    missing = int(np.sum(~np.isfinite(s)))
    if missing:
        raise ValueError(f"{missing} of {len(s)} irradiances are missing: fill or cut them first")
    if not len(s) or not USUAL[0] <= np.median(s) <= USUAL[1]:
        middle = f"{np.median(s):.5g} W/m2" if len(s) else "not there"
        raise ValueError(f"the median irradiance is {middle}, usual at 1 au are {USUAL[0]:g} to {USUAL[1]:g}")
    times = np.asarray(times, dtype=float)
    offset = np.floor((times - times[0]) / step * (1 + 1e-12)).astype(int)
    room = len(s) - int(offset[-1]) - 1
    if start is None:
        if seed is None:
            raise ValueError("a replay needs a start or a seed to draw one")
        start = int(generator(seed, flight, purpose=4).integers(0, room + 1)) if room >= 0 else 0
    if not 0 <= start <= room:
        raise ValueError(f"the series has {len(s)} values, the flight needs {offset[-1] + 1} from {start} on")
    return s[start + offset] / SOLAR_IRRADIANCE
