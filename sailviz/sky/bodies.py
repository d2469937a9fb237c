"""The bodies whose places are known, by the words of a scene file. No numpy: `sailviz check` reads this."""

from __future__ import annotations

from typing import NamedTuple

from sailviz.constants import MU_EARTH, MU_SUN, RADIUS_EARTH, RADIUS_SUN


class SkyBody(NamedTuple):
    """What pulls, shades or shines."""

    name: str
    mu: float  # m3/s2
    radius: float  # m, equatorial; 0 of a barycentre
    number: int  # NAIF's


# mu of planets with moons are those of the whole system; from the comments of JPL's DE440 (R. S. Park et al.,
# Astron. J. 161, 105, 2021). Those of the Sun and of the Earth are the ones of constants.py, 2e-10 and 2e-9 off.
# Radii: IAU 2015 (B. A. Archinal et al., Celest. Mech. Dyn. Astron. 130, 22, 2018).
BODIES = {
    "sun": SkyBody("Sun", MU_SUN, RADIUS_SUN, 10),
    "mercury": SkyBody("Mercury", 22_031.868_551e9, 2_439.7e3, 1),
    "venus": SkyBody("Venus", 324_858.592e9, 6_051.8e3, 2),
    "earth": SkyBody("Earth", MU_EARTH, RADIUS_EARTH, 399),
    "moon": SkyBody("Moon", 4_902.800_118_457_5e9, 1_737.4e3, 301),
    "mars": SkyBody("Mars", 42_828.375_816e9, 3_396.19e3, 4),
    "jupiter": SkyBody("Jupiter", 126_712_764.1e9, 71_492e3, 5),
    "saturn": SkyBody("Saturn", 37_940_584.841_8e9, 60_268e3, 6),
    "uranus": SkyBody("Uranus", 5_794_556.4e9, 25_559e3, 7),
    "neptune": SkyBody("Neptune", 6_836_527.100_58e9, 24_764e3, 8),
    "earth-moon": SkyBody("Earth and Moon", 403_503.235_6e9, 0.0, 3),
}
MOON_SHARE = BODIES["moon"].mu / (BODIES["earth"].mu + BODIES["moon"].mu)  # of the way from the Earth to the barycentre


def sphere_of_influence(mu: float, mu_larger: float, distance: float) -> float:
    """Radius, m, about a body within which its own pull is disturbed less than that of a larger one so far away:
    Laplace's, d (mu/mu_larger)^(2/5) (R. H. Battin, An Introduction to ... Astrodynamics, section 8.5)."""
    share: float = (mu / mu_larger) ** 0.4
    return distance * share
