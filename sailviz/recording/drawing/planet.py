"""A planet in the centre: its map, which turns, its air, its night side and the light from the Sun. Of radius 1."""

from __future__ import annotations

from collections.abc import Iterable
from itertools import pairwise

import numpy as np
import rerun as rr

from sailviz.frames import body_axes, quaternion, unit
from sailviz.recording.drawing import style
from sailviz.recording.drawing.log import Picture
from sailviz.recording.drawing.samples import Samples
from sailviz.recording.drawing.style import points
from sailviz.run.arrays import Setting
from sailviz.shapes.planets import globe
from sailviz.shapes.primitives import Trimesh, ball, cap, scaled, tube
from sailviz.shipped import shipped_folder

NIGHT_EDGES = np.radians(np.linspace(100, 78, 16))  # half-angles of what darkens: together a soft terminator
NIGHT_RADIUS = 1.0022  # so that it lies on the ground and not in it
NIGHT_ALPHA, DARKEST = 38 / 255, 0.60  # of each of them, one over the other, so that the ground stays readable
MERIDIANS, RINGS = 12, 5  # lines of a magnetopause
HALO = ((1.004, 74), (1.009, 54), (1.015, 38), (1.022, 25), (1.031, 15), (1.042, 8), (1.055, 4))  # radius, alpha


class Planet:
    """Writes /world/center, /world/night and /world/season, a frame that turns about the axis with the Sun."""

    def __init__(self, picture: Picture, setting: Setting, day_and_night: bool, named: bool = True):
        """named : whether the arrow of sunlight has its word on it."""
        self._picture = picture
        log_planet(picture, "/world/center/globe", setting.body.name)
        log_air(picture, "/world/center/air", ball(30, 60))
        if day_and_night:
            log_night(picture, named)
            if setting.magnetopause is not None:
                log_magnetopause(picture, setting.magnetopause, setting.body.radius)

    def add(self, samples: Samples) -> None:
        """Turn the globe about its axis, and the night away from the Sun."""
        if samples.earth_rotation is not None:
            self._picture.log_pose("/world/center/globe", samples.index, quaternion=about_axis(samples.earth_rotation))
        if "Sun" in samples.run.bodies:
            sun = samples.run.bodies["Sun"]
            axes = body_axes(-unit(sun), np.tile([0.0, 0.0, 1.0], (len(samples), 1)))
            self._picture.log_pose("/world/night", samples.index, quaternion=quaternion(axes))
            self._picture.log_pose(
                "/world/season", samples.index, quaternion=about_axis(np.arctan2(sun[:, 1], sun[:, 0]))
            )


def about_axis(angle: np.ndarray) -> np.ndarray:
    """Quaternions (n, 4) xyzw of turns about z by angles (n,) rad."""
    half = 0.5 * np.mod(angle, 2 * np.pi)
    return np.stack([0 * half, 0 * half, np.sin(half), np.cos(half)], 1)


def log_planet(picture: Picture, path: str, name: str) -> None:
    """A planet of radius 1: the Earth with its map, longitude 0 at x, others plain."""
    world_map = shipped_folder("assets") / "earth_4096.jpg"
    if name != "Earth" or not world_map.is_file():
        color = style.OCEAN if name == "Earth" else style.dim(style.PLANETS.get(name, style.ROCK), 0.8)
        picture.log_mesh(f"{path}/ball", ball(72, 144), color, shaded=False)
        return
    picture.log_static(
        f"{path}/ball", rr.Asset3D(contents=globe(world_map.read_bytes(), 72, 144), media_type="model/gltf-binary")
    )


def log_air(picture: Picture, path: str, sphere: Trimesh, halo: Iterable[tuple[float, int]] = HALO) -> None:
    """A halo: the far sides of nested shells. halo : pairs of radius and alpha."""
    for k, (radius, alpha) in enumerate(halo):
        picture.log_mesh(f"{path}/shell{k}", scaled(sphere, radius), [*style.AIR, alpha], shaded=False, side="back")


def log_magnetopause(picture: Picture, sheet: np.ndarray, radius: float) -> None:
    """The surface inside which the wind does not blow, as a net of lines about the Sun's direction. sheet : (k, 2)
    angle rad and distance m, radius m of the planet."""
    angle, distance = sheet.T
    height, width = -distance / radius * np.cos(angle), distance / radius * np.sin(angle)
    turn = np.linspace(0, 2 * np.pi, MERIDIANS, endpoint=False)
    around = np.linspace(0, 2 * np.pi, 73)
    lines = [np.stack([width * np.cos(a), width * np.sin(a), height], 1) for a in turn]
    for k in range(len(angle) // RINGS, len(angle), len(angle) // RINGS):
        ring = [width[k] * np.cos(around), width[k] * np.sin(around), np.full(len(around), height[k])]
        lines.append(np.stack(ring, 1))
    color = style.dim(style.WIND, 0.4)
    picture.log_lines("/world/night/magnetopause", lines, color, style.WIDTH["helper"])
    picture.log_label(
        "/world/night/magnetopause/name", "magnetopause", style.dim(style.WIND, 0.8), (0, 0, float(height[0]) * 1.05)
    )


def log_night(picture: Picture, named: bool = True) -> None:
    """Zones over the night side, darker and darker, and the umbra, +z away from the Sun, and an arrow of sunlight."""
    edges = [*NIGHT_EDGES, 0.0]
    for k, (outer, inner) in enumerate(pairwise(edges)):
        zone = cap(outer, 18 if inner == 0 else 1, 96, inner, radius=NIGHT_RADIUS)
        alpha = round(255 * min(1 - (1 - NIGHT_ALPHA) ** (k + 1), DARKEST))
        picture.log_mesh(f"/world/night/zone{k}", zone, [*style.NIGHT, alpha], shaded=False)
    picture.log_mesh("/world/night/umbra", tube(0.0, 2.6, 1.0, 1.0, 96), style.UMBRA, shaded=False)
    picture.log_static(
        "/world/night/sunlight",
        rr.Arrows3D(origins=[[0, 0, -1.32]], vectors=[[0, 0, 0.20]], colors=[style.SUN], radii=points(2.0)),
    )
    if named:
        picture.log_label("/world/night/sunlight/name", "sunlight", style.SUN, (0, 0, -1.36))
