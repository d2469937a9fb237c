"""Constants of the independent physics, written down once more, and the central bodies."""

from __future__ import annotations

AU, MU_SUN, MU_EARTH, RADIUS_EARTH = 149_597_870_700.0, 1.32712440018e20, 3.986004418e14, 6_378_137.0
J2, J3, J4, ROTATION = 1.08262668e-3, -2.53265649e-6, -1.61962159e-6, 7.2921159e-5
RADIUS_SUN = 695_700e3
MASSES = {"sun": 1.32712440041279e20, "earth": 3.98600435507e14, "moon": 4.902800118e12, "jupiter": 1.267127641e17}
CHARGE, EPSILON = 1.602176634e-19, 8.8541878128e-12
FILMS = {  # b1, b2, b3, efficiency
    "ideal": (0, 1, 0, 1),
    "eta-perfect": (0, 1, 0, 0.85),
    "jpl-1978": (0.0864, 0.8272, -0.0055, 1),
    "jpl-2015": (0.0723, 0.8554, -0.0030, 1),
}


def body(scene):
    """(mu, radius) of the central body."""
    known = {"sun": (MU_SUN, RADIUS_SUN), "earth": (MU_EARTH, RADIUS_EARTH), "mars": (4.2828375816e13, 3396.19e3)}
    return known[scene.body] if isinstance(scene.body, str) else (scene.body.mu, scene.body.radius)
