"""Solar-wind dynamic pressure as a random history, and what it does to an E-sail's thrust.

The thrust goes with the square root of the pressure at 1 au, (3.41); a = factor * nominal, factor = sqrt(p / p_ref).
Redrawing an independent gamma value every interval is the thesis' statistical law (paper J.8's abstract: "a random
variable with a gamma distribution"); interval, shape and scale are choices of the scene.
"""

from __future__ import annotations

import numpy as np


def gamma_pressure(shape, scale, interval, duration, seed):
    """Independent gamma-distributed pressure, redrawn every interval.

    shape : -, scale : Pa, interval and duration : s, seed : int. Returns (times (k,) s at which each value begins,
    pressure (k,) Pa). The same seed gives the same history whatever the duration, as far as both reach.
    """
    count = int(np.ceil(duration / interval))
    times = interval * np.arange(count)
    return times, np.random.Generator(np.random.PCG64(seed)).gamma(shape, scale, size=count)


def reference_pressure(shape, scale, unbiased=False):
    """Pressure, Pa, at which the nominal thrust is defined: the mean k theta, or (E sqrt p)^2, which leaves the mean
    thrust nominal. With the mean the average thrust falls short of nominal, since E sqrt p < sqrt E p (5 % for shape
    2.6)."""
    if not unbiased:
        return shape * scale
    from math import exp, lgamma

    return scale * exp(2 * (lgamma(shape + 0.5) - lgamma(shape)))


def thrust_factor(pressure, reference):
    """Thrust over nominal thrust at constant voltage: sqrt(p / p_ref). Pressures in Pa, any shape."""
    return np.sqrt(np.asarray(pressure, dtype=float) / reference)
