"""What a sail must keep to on the way: a distance from the Sun, a temperature, a cone about the sunlight, a turn rate.

The temperature is that of `propulsion.film_ageing`: of a thin film in balance,
T^4 = (1 - cr) W (r_E / r)^2 cos(alpha) / (sigma (ef + eb)), so that cos(alpha) <= K r^2 bounds it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sailviz.constants import SOLAR_IRRADIANCE, STEFAN_BOLTZMANN
from sailviz.propulsion.solar_sail import OPTICS, Film


@dataclass(frozen=True)
class Limits:
    """What a flight keeps to; None where it is free. closest : from the Sun, au. hottest : of the film, K. cone :
    largest pitch angle, rad. turn_rate : of the sail's normal in space, rad in units of time of mu = 1 and one au."""

    closest: float | None = None
    hottest: float | None = None
    cone: float | None = None
    turn_rate: float | None = None

    def __post_init__(self) -> None:
        for name, unit in (("closest", "au"), ("hottest", "K"), ("cone", "rad"), ("turn_rate", "rad")):
            value = getattr(self, name)
            if value is not None and not (np.isfinite(value) and value > 0):
                raise ValueError(f"the limit {name} must be a positive number of {unit}, not {value!r}")
        if self.cone is not None and self.cone > np.pi / 2:
            raise ValueError("a cone wider than 90 deg limits nothing: a sail that shows its back feels no thrust")

    @property
    def any(self) -> bool:
        """Whether there is one."""
        return any(x is not None for x in (self.closest, self.hottest, self.cone, self.turn_rate))


def heat_factor(hottest: float, device: Film | str) -> float:
    """K of cos(alpha) <= K r^2, r in au, that keeps a film at a temperature, K, at most. ValueError for a sail whose
    optics are not known, and for one that takes up no heat."""
    if not isinstance(device, str) or device not in OPTICS:
        known = ", ".join(name for name, optics in OPTICS.items() if optics[0] < 1)
        raise ValueError(f"a temperature needs a film whose optics are known: {known}")
    cr, _, _, _, ef, eb = OPTICS[device]
    taken = (1 - cr) * SOLAR_IRRADIANCE
    if taken == 0:
        raise ValueError("an ideal film mirrors all light and has no temperature to limit")
    return float(STEFAN_BOLTZMANN * (ef + eb) * hottest**4 / taken)
