"""Where the solar wind does not blow: inside the magnetopause of the Earth, or a sphere round another planet."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from sailviz.compiled import inlined
from sailviz.constants import RADIUS_GEOMAGNETIC, WIND_PRESSURE

NONE, SHUE, SPHERE = range(3)


class Parameters(NamedTuple):
    """A magnetosphere."""

    kind: int = NONE
    body: int = -1  # round which: one of the sky's, or the central body
    radius: float = 0.0  # m, towards the Sun
    flare: float = 0.0  # alpha of Shue


def shue(pressure: float = WIND_PRESSURE, southward: float = 0.0, body: int = -1) -> Parameters:
    """The Earth's magnetopause for a dynamic pressure (Pa) at the Earth and the field's B_z (T).

    Source: J.-H. Shue et al., J. Geophys. Res. 103, 17691 (1998), (10), (11). The wind's aberration of 4 deg and its
    slowing behind the bow shock are left out.
    """
    d, b = pressure * 1e9, southward * 1e9
    radius = (10.22 + 1.29 * np.tanh(0.184 * (b + 8.14))) * d ** (-1.0 / 6.6)
    flare = (0.58 - 0.007 * b) * (1.0 + 0.024 * np.log(d))
    return Parameters(SHUE, body, float(radius * RADIUS_GEOMAGNETIC), float(flare))


@inlined
def outside(x, y, z, lx, ly, lz, p):
    """Distance, m, of a place from the magnetopause along the radius, positive in the wind; place and light relative to
    the planet, m. p : Parameters."""
    r = np.sqrt(x * x + y * y + z * z)
    if p.kind == SPHERE:
        return r - p.radius
    cosine = (x * lx + y * ly + z * lz) / (r * np.sqrt(lx * lx + ly * ly + lz * lz))
    if cosine <= -1.0 + 1e-12:
        return -r  # the tail is open
    return r - p.radius * (2.0 / (1.0 + cosine)) ** p.flare
