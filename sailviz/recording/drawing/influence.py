"""Spheres of influence that a flight crosses or comes near: three rings each, and a name; the passage from close by.

Within one the body's own pull bends the way more than what is left of the other's; nothing changes at its edge, which
is a hint where to look.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from sailviz.recording.contract import word
from sailviz.recording.drawing import style
from sailviz.recording.drawing.cameras import Camera
from sailviz.recording.drawing.landmarks import RING
from sailviz.recording.drawing.layout import Space
from sailviz.recording.drawing.log import Color, Picture
from sailviz.recording.drawing.names import Names
from sailviz.recording.drawing.phrases import body_words
from sailviz.recording.drawing.story import Story
from sailviz.shapes.primitives import ball
from sailviz.sky.bodies import BODIES, sphere_of_influence
from sailviz.words import length

NEARS = 2.0  # radii of a sphere: a flight that comes closer to its centre has it drawn
SEEN = 0.012  # of S: a smaller sphere would be a dot
WITHIN = 1.0  # of S, outside of which a sphere would only be lines through the picture
FARTHER = 2.6  # radii of a sphere from which a body that is passed is seen
MASSES = {body.name: body.mu for body in BODIES.values()}
SIZES = {body.name: body.radius for body in BODIES.values()}


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


def log_influence(picture: Picture, story: Story, names: Names, spheres: list[Sphere]) -> None:
    """Write /world/influence, and the names while the flight is near; of a body that moves also itself, to scale, and
    the way past it as it is seen from there."""
    around = np.linspace(0.0, 2 * np.pi, 97)
    c, s, zero = np.cos(around), np.sin(around), np.zeros(97)
    rings = np.array([np.stack(ring, 1) for ring in ((c, s, zero), (c, zero, s), (zero, c, s))])
    for sphere in spheres:
        color: Color = style.dim(style.planet_color(sphere.name), 0.45)
        path, radius = f"/world/influence/{word(sphere.name)}", sphere.radius / story.frame.unit
        picture.log_lines(path, radius * rings, color, style.WIDTH["helper"])
        top = np.tile([0.0, 0.0, 1.06 * radius], (len(story.time), 1))
        if sphere.places is not None:
            places = sphere.places / story.frame.unit
            picture.log_pose(path, story.index, translation=places)
            top = top + places
            log_passage(picture, story, sphere, path)
        words = f"sphere of influence of {body_words(sphere.name)}, {length(float(f'{sphere.radius:.2g}'))}"
        top = np.where(sphere.near[:, None], top, np.nan)
        bright = style.dim(style.planet_color(sphere.name), 0.8)
        names.add(f"/world/names/influence/{word(sphere.name)}", words, bright, top, RING)


def log_passage(picture: Picture, story: Story, sphere: Sphere, path: str) -> None:
    """A body of its true size, and the way past it in a frame that moves with it."""
    assert sphere.places is not None  # it moves
    size = SIZES[sphere.name] / story.frame.unit
    color = style.dim(style.planet_color(sphere.name), 0.9)
    picture.log_mesh(f"{path}/globe", ball(24, 48, size), color)
    way = (story.samples.run.position - sphere.places) / story.frame.unit
    near = np.linalg.norm(way, axis=1) < NEARS * sphere.radius / story.frame.unit
    cuts = np.flatnonzero(np.diff(near.astype(int))) + 1
    parts = [part for part, there in zip(np.split(way, cuts), np.split(near, cuts), strict=True) if there[0]]
    lines = [part for part in parts if len(part) > 1]
    picture.log_lines(f"{path}/way", lines, style.dim(style.TRAIL_RECENT, 0.75), style.WIDTH["past"])


def paths_of_passages(spheres: list[Sphere]) -> list[str]:
    """What only makes sense where the body stands still."""
    return [f"/world/influence/{word(sphere.name)}/way" for sphere in spheres if sphere.places is not None]


def at_the_bodies(story: Story, spheres: list[Sphere], eye: np.ndarray) -> list[Space]:
    """A view of each body that is passed, in whose frame it stands still, from the direction `eye` (3,)."""
    found = []
    for sphere in spheres:
        if sphere.places is not None:
            place = tuple((FARTHER * sphere.radius / story.frame.unit * eye).tolist())
            path = f"/world/influence/{word(sphere.name)}"
            trails = ("- /world/trail/**", "- /world/fence/**", "- /world/ghosts/**", "- /world/marks/**")
            camera = Camera(f"Past {body_words(sphere.name)}", path, place)
            found.append(Space(camera, ("+ /world/**", *trails, "- /world/names/**", "- /world/planets/**")))
    return found


def passages_of(story: Story) -> list[np.ndarray]:
    """Where bodies that move are when the flight is nearest to them, (3,) view units."""
    found = []
    for sphere in spheres_of(story):
        if sphere.places is not None:
            row = int(np.argmin(np.linalg.norm(story.samples.run.position - sphere.places, axis=1)))
            found.append(sphere.places[row] / story.frame.unit)
    return found


def spheres_in_sight(story: Story) -> list[np.ndarray]:
    """Corners (6, 3) of the spheres of bodies that move, where the flight is nearest to them, view units."""
    sizes = [sphere.radius / story.frame.unit for sphere in spheres_of(story) if sphere.places is not None]
    ways = np.concatenate([np.eye(3), -np.eye(3)])
    return [place + size * ways for place, size in zip(passages_of(story), sizes, strict=True)]
