"""Places of bodies as Chebyshev polynomials, for compiled code: seconds of a run -> place relative to the central body.

Equal granules of days, a polynomial of one degree on each. Errors against DE421 over a year, measured: the Moon 2 mm, a
planet or the Sun from the Earth 2 to 6 cm, Jupiter and Saturn from the Sun 2 mm; with the Earth, whose monthly
swing about the barycentre forces short granules, 2 cm from the Sun.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import NamedTuple

import numpy as np

from sailviz.constants import DAY
from sailviz.sky.places import Sky

Array = np.ndarray
SLOW = {"jupiter", "saturn", "uranus", "neptune"}


class Table(NamedTuple):
    """A body's places over a span of time."""

    begin: float  # s
    granule: float  # s
    coefficients: Array  # (granules, degree + 1, 3) m


def granule_and_degree(name: str, centre: str) -> tuple[float, int]:
    """(length in s, degree) with which places of a body as seen from another are written down."""
    if "moon" in (name, centre):
        return 4 * DAY, 11
    if centre == "sun" and name in SLOW:
        return 16 * DAY, 9
    return 8 * DAY, 11


def table(sky: Sky, name: str, centre: str, duration: float) -> Table:
    """A body of `sailviz.sky.BODIES` as seen from another over a run of a sky. duration : s. Errors as `Sky.position`
    raises them; a kernel is asked for no moment beyond the run."""
    granule, degree = granule_and_degree(name, centre)
    return fitted(lambda time: sky.position(name, centre, time), duration, granule, degree)


def fitted(position: Callable[[Array], Array], duration: float, granule: float, degree: int) -> Table:
    """A Table of any motion from 0 to the duration. position : times (n,) s -> (n, 3) m."""
    granules = max(1, int(np.ceil(duration / granule)))
    granule = min(granule, duration / granules)  # the last one ends with the run
    nodes, transform = _cosines(degree)
    middle = granule * (np.arange(granules) + 0.5)
    time = (middle[:, None] + 0.5 * granule * nodes).ravel()
    values = position(time).reshape(granules, degree + 1, 3)
    return Table(0.0, granule, np.einsum("kj,gjx->gkx", transform, values))


@cache
def _cosines(degree: int) -> tuple[Array, Array]:
    """The nodes (degree + 1,) in -1 to 1, and the matrix that makes coefficients of values there."""
    count = degree + 1
    angle = np.pi * (np.arange(count) + 0.5) / count
    transform = 2.0 / count * np.cos(np.outer(np.arange(count), angle))
    transform[0] /= 2.0
    return np.cos(angle), transform


def evaluate(found: Table, time: Array) -> Array:
    """Places (n, 3) m at times (n,) s, in numpy: what compiled code is held to."""
    t = np.atleast_1d(np.asarray(time, float)) - found.begin
    last = len(found.coefficients) - 1
    index = np.clip((t / found.granule).astype(int), 0, last)
    x = 2.0 * (t / found.granule - index) - 1.0
    polynomials = np.polynomial.chebyshev.chebvander(x, found.coefficients.shape[1] - 1)
    seen: Array = np.einsum("nk,nkx->nx", polynomials, found.coefficients[index])
    return seen
