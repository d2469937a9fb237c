"""A planet in the centre: its map, which turns, its air, its night side, its shadow and the light from the Sun. Of
radius 1.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import rerun as rr

from sailviz.constants import RADIUS_SUN
from sailviz.frames import body_axes, quaternion, unit
from sailviz.recording.drawing import style
from sailviz.recording.drawing.log import Picture, f4
from sailviz.recording.drawing.samples import Samples
from sailviz.recording.drawing.style import points
from sailviz.run.arrays import Setting
from sailviz.shapes.planets import globe
from sailviz.shapes.primitives import Trimesh, ball, cap, circle, scaled, tube
from sailviz.shipped import shipped_folder

NIGHT_EDGES = np.radians(np.linspace(100, 78, 16))  # half-angles of what darkens: together a soft terminator
NIGHT_RADIUS = 1.0022  # so that it lies on the ground and not in it
NIGHT_ALPHA, DARKEST = 38 / 255, 0.60  # of each of them, one over the other, so that the ground stays readable
MERIDIANS, RINGS = 12, 5  # lines of a magnetopause
MAGNETOPAUSE_NAME = 1.05  # distances of its nose at which its word is
NEAR_AIR = (1.004, 74)  # radius and alpha of the innermost shell of air
AIR_TOP = ((1.009, 0.46), (1.015, 0.31), (1.022, 0.19), (1.031, 0.10), (1.042, 0.045), (1.055, 0.0))  # and opacity
SHELLS, SHELL_ALPHA = 16, 9 / 255  # further ones, each of them
SHADOW_FROM = 2.6  # radii: a shadow is drawn at least that far
SHADOW_TO = 1.15  # and so many times as far as the flight
SUNLIGHT_FROM, SUNLIGHT_LONG = 1.32, 0.20  # radii of the arrow of sunlight
SUNLIGHT_NAME = 1.36  # where its word is
SUNLIGHT_REACH = 0.15  # of S, of that word at least, so that it is clear of a planet seen from afar
FAR_MAP = 4.0  # S, radii, from which a planet is small enough on the screen for a coarse map


class Planet:
    """Writes /world/center, /world/night and /world/season, a frame that turns about the axis with the Sun."""

    def __init__(self, picture: Picture, setting: Setting, day_and_night: bool, reach: float, named: bool = True):
        """reach : the largest distance that is drawn, radii; named : whether the arrow of sunlight has its word."""
        self._picture, self._reach, self._radius = picture, reach, setting.body.radius
        log_planet(picture, "/world/center/globe", setting.body.name, reach > FAR_MAP)
        log_air(picture, "/world/center/air", ball(30, 60))
        if day_and_night:
            log_night(picture)
            log_sunlight(picture, sunlight_scale(reach), named)
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
            away = float(np.linalg.norm(sun, axis=1).mean()) / self._radius
            log_shadow(self._picture, away, self._radius, self._reach)


def sunlight_scale(reach: float) -> float:
    """How much larger the arrow of sunlight is drawn in a view of that reach, radii."""
    return max(1.0, SUNLIGHT_REACH * reach / SUNLIGHT_NAME)


def about_axis(angle: np.ndarray) -> np.ndarray:
    """Quaternions (n, 4) xyzw of turns about z by angles (n,) rad."""
    half = 0.5 * np.mod(angle, 2 * np.pi)
    return np.stack([0 * half, 0 * half, np.sin(half), np.cos(half)], 1)


def log_planet(picture: Picture, path: str, name: str, far: bool = False) -> None:
    """A planet of radius 1: the Earth with its map, longitude 0 at x, others plain. far : it is small on the screen."""
    world_map = shipped_folder("assets") / ("earth_1024.jpg" if far else "earth_4096.jpg")
    if name != "Earth" or not world_map.is_file():
        color = style.OCEAN if name == "Earth" else style.dim(style.PLANETS.get(name, style.ROCK), 0.8)
        picture.log_mesh(f"{path}/ball", ball(48, 96), color, shaded=False)
        return
    fine = (48, 96) if far else (72, 144)
    picture.log_static(
        f"{path}/ball", rr.Asset3D(contents=globe(world_map.read_bytes(), *fine), media_type="model/gltf-binary")
    )


def log_air(picture: Picture, path: str, sphere: Trimesh) -> None:
    """A halo: the far sides of nested shells, of which all but the innermost are one mesh at several sizes."""
    radius, alpha = NEAR_AIR
    picture.log_mesh(f"{path}/shell0", scaled(sphere, radius), [*style.AIR, alpha], shaded=False, side="back")
    picture.log_mesh(f"{path}/halo", sphere, [*style.AIR, round(255 * SHELL_ALPHA)], shaded=False, side="back")
    sizes = np.repeat(shell_radii()[:, None], 3, axis=1)
    picture.log_static(f"{path}/halo", rr.InstancePoses3D(scales=f4(sizes)))


def shell_radii() -> np.ndarray:
    """(k,) of shells of one opacity that lie over each other as densely as the air's asks for."""
    height, opacity = np.array(AIR_TOP[::-1]).T
    through = 1 - (1 - SHELL_ALPHA) ** (np.arange(SHELLS) + 0.5)
    return np.asarray(np.interp(through, opacity, height))


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


def log_night(picture: Picture) -> None:
    """Zones over the night side, darker and darker, +z away from the Sun, and the line between day and night."""
    edges = [*NIGHT_EDGES, 0.0]
    for k, (outer, inner) in enumerate(pairwise(edges)):
        zone = cap(outer, 18 if inner == 0 else 1, 96, inner, radius=NIGHT_RADIUS)
        alpha = round(255 * min(1 - (1 - NIGHT_ALPHA) ** (k + 1), DARKEST))
        picture.log_mesh(f"/world/night/zone{k}", zone, [*style.NIGHT, alpha], shaded=False)
    line = NIGHT_RADIUS * circle(181)
    picture.log_lines("/world/night/terminator", [line], style.TERMINATOR, style.WIDTH["helper"])


def log_sunlight(picture: Picture, scale: float, named: bool) -> None:
    """An arrow of the Sun's light, larger by a scale."""
    picture.log_static(
        "/world/night/sunlight",
        rr.Arrows3D(
            origins=[[0, 0, -SUNLIGHT_FROM * scale]],
            vectors=[[0, 0, SUNLIGHT_LONG * scale]],
            colors=[style.SUN],
            radii=points(2.0),
        ),
    )
    if named:
        place = (0, 0, -SUNLIGHT_NAME * scale)
        picture.log_label("/world/night/sunlight/name", "sunlight", style.SUN, place)


def log_shadow(picture: Picture, distance: float, radius: float, reach: float) -> None:
    """Umbra and penumbra, the cones that touch planet and Sun from outside and from inside, as far as the flight goes
    or to the umbra's tip. distance : of the Sun, radii of the planet, each `radius` m; reach : radii."""
    sun = RADIUS_SUN / radius
    far = max(SHADOW_FROM, SHADOW_TO * reach)
    narrows, widens = (sun - 1) / distance, (sun + 1) / distance  # sines of the half-angles at the tips
    tip = min(far, 1 / narrows)
    umbra = (np.array([0.0, tip]) * -narrows + 1) / np.sqrt(1 - narrows**2)
    penumbra = (np.array([0.0, far]) * widens + 1) / np.sqrt(1 - widens**2)
    cone = tube(0.0, tip, float(umbra[0]), max(float(umbra[1]), 0.0), 96)
    picture.log_mesh("/world/night/umbra", cone, style.UMBRA, shaded=False)
    cone = tube(0.0, far, float(penumbra[0]), float(penumbra[1]), 96)
    picture.log_mesh("/world/night/penumbra", cone, style.PENUMBRA, shaded=False)
