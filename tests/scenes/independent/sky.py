"""Other bodies and a light that is not at the centre: what they pull, shine, shade and keep away.

Where bodies stand is asked of `sailviz.sky`, which has tests of its own, body by body and not through tables.
"""

from __future__ import annotations

from functools import cache

import numpy as np
from independent.constants import AU, MASSES, MU_SUN, RADIUS_SUN, body
from independent.low_orbit import spin_of_earth

from sailviz.sky import Sky

YEAR, TILT = 365.25 * 86400, np.radians(23.439)


@cache
def places(epoch, frame, source):
    return Sky(np.datetime64(epoch, "ns"), frame, source)


def sky_of(scene):
    return places(scene.epoch_utc, frame_of(scene), scene.ephemeris)


def frame_of(scene):
    return scene.frame or ("equator-of-date" if scene.body == "earth" else "ecliptic-j2000")


def place_of(scene, name, t):
    """From the central body."""
    return sky_of(scene).position(name, scene.body, np.array([t]))[0]


def light(scene, t):
    """Place of what shines: zero where that is the central body."""
    said = scene.light
    if scene.body == "sun" or not isinstance(scene.body, str):
        assert said is None or said.kind == "centre"
        return np.zeros(3)
    if said is None and scene.epoch is not None:
        return place_of(scene, "sun", t)
    assert said is None or said.kind == "circular"
    distance, tilt, turn = AU, 0.0 if frame_of(scene) == "ecliptic-j2000" else TILT, YEAR
    if said is not None and said.distance is not None:
        distance, turn = said.distance, 2 * np.pi * np.sqrt(said.distance**3 / MU_SUN)
    if said is not None and said.obliquity is not None:
        tilt = said.obliquity
    begin = (said and said.longitude) or scene.environment.sun_right_ascension or 0.0
    angle = begin + 2 * np.pi * t / turn
    return distance * np.array([np.cos(angle), np.cos(tilt) * np.sin(angle), np.sin(tilt) * np.sin(angle)])


def north(scene):
    """Pole of the circle of the light."""
    if scene.epoch is not None:
        return sky_of(scene).axes @ np.array([0.0, -np.sin(TILT_J2000), np.cos(TILT_J2000)])
    tilt = TILT if frame_of(scene) != "ecliptic-j2000" else 0.0
    if scene.light is not None and scene.light.obliquity is not None:
        tilt = scene.light.obliquity
    return np.array([0.0, -np.sin(tilt), np.cos(tilt)])


TILT_J2000 = np.radians(84381.448 / 3600)


def bodies_pull(scene, t, r):
    """On the craft, less on the central body."""
    a = np.zeros(3)
    for name in scene.environment.gravity_of_bodies:
        d = place_of(scene, name, t)
        a += MASSES[name] * ((d - r) / np.linalg.norm(d - r) ** 3 - d / np.linalg.norm(d) ** 3)
    return a


def sunlight(scene, t, r):
    """Lit share of the light's disc: the two discs overlap in a lens."""
    named = scene.environment.shadow_of
    if scene.device.kind != "solar-sail" or (named is None and not light(scene, t).any()):
        return 1.0
    share = 1.0
    for name in [scene.body] if named is None else named:
        centre, radius = (np.zeros(3), body(scene)[1]) if name == scene.body else (place_of(scene, name, t), 1737.4e3)
        share *= lit(r - centre, light(scene, t) - centre, radius, scene.environment.shadow)
    return share


def lit(r, source, radius, kind):
    to_light = source - r
    if kind == "cylinder":
        s = source / np.linalg.norm(source)
        return float(r @ s > 0 or np.linalg.norm(r - (r @ s) * s) > radius)
    far, near = np.linalg.norm(to_light), np.linalg.norm(r)
    if near > far:
        return 1.0
    a, b = np.arcsin(RADIUS_SUN / far), np.arcsin(min(radius / near, 1.0))
    g = np.arctan2(np.linalg.norm(np.cross(-r, to_light)), -r @ to_light)
    if g >= a + b:
        return 1.0
    if g <= abs(a - b):
        return 1 - min(b / a, 1.0) ** 2
    x = (g * g + a * a - b * b) / (2 * g)
    y = np.sqrt(a * a - x * x)
    return 1 - (a * a * np.arccos(x / a) + b * b * np.arccos((g - x) / b) - g * y) / (np.pi * a * a)


def wind_blows(scene, t, r):
    """Whether the solar wind reaches an electric sail: outside of the magnetopause of Shue et al., 2 nPa."""
    if scene.body != "earth" or scene.environment.magnetosphere == "none":
        return True
    cosine = r @ light(scene, t) / np.linalg.norm(r) / np.linalg.norm(light(scene, t))
    nose = (10.22 + 1.29 * np.tanh(0.184 * 8.14)) * 2 ** (-1 / 6.6)
    return np.linalg.norm(r) > 6371.2e3 * nose * (2 / (1 + cosine)) ** (0.58 * (1 + 0.024 * np.log(2)))


def from_light(scene, t, r):
    """Vector from the light to a sail, from the central body to what no light pushes."""
    return r - light(scene, t) if scene.device.kind in ("solar-sail", "electric-sail") else r


def shown_area(scene, r, v, normal):
    """What a sail shows to the flow, m2."""
    craft, flow = scene.device, v - np.cross(spin_of_earth(scene), r)
    return craft.area * abs(normal @ flow) / np.linalg.norm(flow) + (craft.edge_area or 0.0)
