"""Air on the facets of a shape, free molecular: Maxwell's law, and its hyperthermal limit, which is the law of light.

Speed ratio s = V / sqrt(2 k T / m) of a gas of temperature T; on a facet whose inward normal is c = cos from the flow,
with a = s c, t = s sin, its wall at Tw, over the dynamic pressure rho V^2 / 2:

    p = {[(2 - sn) a / sqrt(pi) + (sn / 2) sqrt(Tw / T)] e^(-a^2)
         + [(2 - sn)(a^2 + 1/2) + (sn / 2) sqrt(pi Tw / T) a] (1 + erf a)} / s^2
    tau = st t [e^(-a^2) + sqrt(pi) a (1 + erf a)] / (sqrt(pi) s^2)

Re-derived by quadrature of the Maxwellian flux. sn, st : accommodation of normal and tangential momentum. Where light
has 2 P, air has 2 rho V^2; the flow takes the place of the light.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import pi, sqrt

import numpy as np

from sailviz.shapes.facets import Coefficients


@dataclass(frozen=True)
class Air:
    """A gas against a wall: speed ratio, accommodations 0 to 1, ratio of wall and gas temperatures."""

    speed_ratio: float
    normal_accommodation: float = 1.0
    tangential_accommodation: float = 1.0
    temperature_ratio: float = 1.0

    @property
    def all_round(self) -> bool:
        """Warm gas also reaches what is turned away from the flow."""
        return True

    def pressure_and_shear(self, cosine: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """(p, tau) over rho V^2 / 2 on one side of a facet; cosine < 0: the lee side."""
        from scipy.special import erf

        s, sn, st = self.speed_ratio, self.normal_accommodation, self.tangential_accommodation
        root = sqrt(self.temperature_ratio)
        a = s * np.asarray(cosine, float)
        t = s * np.sqrt(np.maximum(0.0, 1 - np.asarray(cosine, float) ** 2))
        e, both = np.exp(-a * a), 1 + erf(a)
        p = ((2 - sn) * a / sqrt(pi) + sn / 2 * root) * e
        p = (p + ((2 - sn) * (a * a + 0.5) + sn / 2 * sqrt(pi) * root * a) * both) / s**2
        return p, st * t * (e + sqrt(pi) * a * both) / (sqrt(pi) * s**2)

    @property
    def hyperthermal(self) -> Coefficients:
        """b1, b2, b3 of the limit s >> 1, for 2 rho V^2. It fails near grazing, where |a| is not large."""
        sn, st = self.normal_accommodation, self.tangential_accommodation
        return Coefficients(st / 2, (2 - sn - st) / 2, sn * sqrt(pi * self.temperature_ratio) / (4 * self.speed_ratio))

    def tractions(self, d: np.ndarray, front: np.ndarray, back: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """As `light_force.Law` says it, over 2 rho V^2: both sides of a film feel the gas, the outside alone of a
        closed body. Of `back` only whether there is one counts."""
        p, tau = self.pressure_and_shear(-d)
        lee, drawn = self.pressure_and_shear(d)
        film = np.any(back != 0.0, axis=1)
        lee, drawn = np.where(film, lee, 0.0), np.where(film, drawn, 0.0)
        sine = np.sqrt(np.maximum(1e-300, 1 - d * d))
        # the shear points along u - (u . N) N, whatever the side
        along = (tau + drawn) / (4 * sine)
        return along, -(p - lee) / 4 - along * d
