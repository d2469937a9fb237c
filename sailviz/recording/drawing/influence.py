"""Spheres of influence that a flight crosses or comes near: three rings each, and a name.

Within one the body's own pull bends the way more than what is left of the other's; nothing changes at its edge, which
is a hint where to look.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from sailviz.recording.contract import word
from sailviz.recording.drawing import style
from sailviz.recording.drawing.landmarks import RING
from sailviz.recording.drawing.log import Color, Picture
from sailviz.recording.drawing.names import Names
from sailviz.recording.drawing.story import Story
from sailviz.sky.bodies import BODIES, sphere_of_influence
from sailviz.words import length

NEARS = 2.0  # radii of a sphere: a flight that comes closer to its centre has it drawn
SEEN = 0.012  # of S: a smaller sphere would be a dot
WITHIN = 1.0  # of S, outside of which a sphere would only be lines through the picture
MASSES = {body.name: body.mu for body in BODIES.values()}


class Sphere(NamedTuple):
    """radius m; places (n, 3) m of the centre, or None where that is the centre of the picture; near (n,) bool."""

    name: str
    radius: float
    places: np.ndarray | None
    near: np.ndarray


def spheres_of(story: Story) -> list[Sphere]:
    """Those that the flight crosses or nears: of bodies lighter than the central one, and of that one within the pull
    of a heavier one."""
    run, body = story.samples.run, story.setting.body
    found = []
    for name, places in run.bodies.items():
        mass = MASSES.get(name, 0.0)
        if not mass or not body.mu:
            continue
        apart = float(np.linalg.norm(places, axis=1).mean())
        own = mass > body.mu
        radius = sphere_of_influence(min(mass, body.mu), max(mass, body.mu), apart)
        off = np.linalg.norm(run.position if own else run.position - places, axis=1)
        reach = story.reach * story.frame.unit
        if SEEN * reach < radius < WITHIN * reach and np.any(off < NEARS * radius) and np.any(off > radius):
            found.append(Sphere(body.name if own else name, radius, None if own else places, off < NEARS * radius))
    return found


def log_influence(picture: Picture, story: Story, names: Names) -> None:
    """Write /world/influence, and the names while the flight is near."""
    around = np.linspace(0.0, 2 * np.pi, 97)
    c, s, zero = np.cos(around), np.sin(around), np.zeros(97)
    rings = np.array([np.stack(ring, 1) for ring in ((c, s, zero), (c, zero, s), (zero, c, s))])
    for sphere in spheres_of(story):
        color: Color = style.dim(style.planet_color(sphere.name), 0.45)
        path, radius = f"/world/influence/{word(sphere.name)}", sphere.radius / story.frame.unit
        picture.log_lines(path, radius * rings, color, style.WIDTH["helper"])
        top = np.tile([0.0, 0.0, 1.06 * radius], (len(story.time), 1))
        if sphere.places is not None:
            places = sphere.places / story.frame.unit
            picture.log_pose(path, story.index, translation=places)
            top = top + places
        whose = f"the {sphere.name}" if sphere.name in ("Sun", "Earth", "Moon") else sphere.name
        words = f"sphere of influence of {whose}, {length(float(f'{sphere.radius:.2g}'))}"
        top = np.where(sphere.near[:, None], top, np.nan)
        bright = style.dim(style.planet_color(sphere.name), 0.8)
        names.add(f"/world/names/influence/{word(sphere.name)}", words, bright, top, RING)
