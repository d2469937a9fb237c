"""A planet in the centre: its map, which turns, its air, its night side and the light from the Sun. Of radius 1."""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path

import numpy as np
import rerun as rr

import sailviz
from sailviz.frames import body_axes, quaternion, unit
from sailviz.recording.drawing import meshes
from sailviz.recording.drawing import style as look
from sailviz.recording.drawing.log import Pen
from sailviz.recording.drawing.samples import Samples
from sailviz.recording.drawing.style import points
from sailviz.run.arrays import Run

NIGHT_EDGES = np.radians(np.linspace(100, 78, 16))  # half-angles of what darkens: together a soft terminator
NIGHT_ALPHA = 55 / 255  # of each of them, one over the other
HALO = ((1.012, 80), (1.025, 48), (1.042, 28), (1.065, 14))  # radius, alpha


class Planet:
    """Writes /world/center, /world/night and /world/season, a frame that turns about the axis with the Sun."""

    def __init__(self, pen: Pen, first: Run):
        self._pen = pen
        draw_planet(pen, "/world/center/globe", first.setting.body.name)
        draw_air(pen, "/world/center/air", meshes.sphere(32, 64)[0])
        if "Sun" in first.bodies:
            draw_night(pen)

    def add(self, samples: Samples) -> None:
        """Turn the globe about its axis, and the night away from the Sun."""
        if samples.earth_rotation is not None:
            self._pen.move("/world/center/globe", samples.index, quaternion=about_axis(samples.earth_rotation))
        if "Sun" in samples.run.bodies:
            sun = samples.run.bodies["Sun"]
            axes = body_axes(-unit(sun), np.tile([0.0, 0.0, 1.0], (len(samples), 1)))
            self._pen.move("/world/night", samples.index, quaternion=quaternion(axes))
            self._pen.move("/world/season", samples.index, quaternion=about_axis(np.arctan2(sun[:, 1], sun[:, 0])))


def about_axis(angle) -> np.ndarray:
    """Quaternions (n, 4) xyzw of turns about z by angles (n,) rad."""
    half = 0.5 * np.mod(angle, 2 * np.pi)
    return np.stack([0 * half, 0 * half, np.sin(half), np.cos(half)], 1)


def draw_planet(pen: Pen, path: str, name: str) -> None:
    """A planet of radius 1: the Earth with its map, longitude 0 at x, others plain."""
    ball, uv = meshes.sphere(48, 96)
    picture = asset("earth_2048.jpg") if name == "Earth" else None
    if picture is None:
        color = look.OCEAN if name == "Earth" else look.dim(look.PLANETS.get(name, look.ROCK), 0.8)
        pen.mesh(f"{path}/ball", ball, color, shaded=False)
        return
    glb = meshes.textured_glb(ball, uv, picture.read_bytes())
    pen.static(f"{path}/ball", rr.Asset3D(contents=glb, media_type="model/gltf-binary"))


def draw_air(pen: Pen, path: str, ball: meshes.Mesh, halo=HALO) -> None:
    """A halo: the far sides of nested shells. halo : pairs of radius and alpha."""
    for k, (radius, alpha) in enumerate(halo):
        shell = meshes.Mesh(radius * ball.vertices, ball.faces, ball.normals)
        pen.mesh(f"{path}/shell{k}", shell, [*look.AIR, alpha], shaded=False, side="back")


def draw_night(pen: Pen) -> None:
    """Zones over the night side, darker and darker, and the umbra, +z away from the Sun, and an arrow of sunlight."""
    edges = [*NIGHT_EDGES, 0.0]
    for k, (outer, inner) in enumerate(pairwise(edges)):
        zone = meshes.cap(outer, 16 if inner == 0 else 1, 64, inner)
        lifted = meshes.Mesh(1.0035 * zone.vertices, zone.faces, zone.normals)
        alpha = round(255 * (1 - (1 - NIGHT_ALPHA) ** (k + 1)))
        pen.mesh(f"/world/night/zone{k}", lifted, [*look.NIGHT, alpha], shaded=False)
    pen.mesh("/world/night/umbra", meshes.tube(0.0, 2.6, 1.0, 1.0, 96), look.UMBRA, shaded=False)
    pen.static(
        "/world/night/sunlight",
        rr.Arrows3D(origins=[[0, 0, -1.32]], vectors=[[0, 0, 0.20]], colors=[look.SUN], radii=points(2.0)),
    )
    pen.label("/world/night/sunlight/name", "sunlight", look.SUN, (0, 0, -1.36))


def asset(name: str) -> Path | None:
    """A file that travels with sailviz, None where it is missing: inside the package, or beside it in a checkout."""
    package = Path(sailviz.__file__).parent
    homes = (package / "assets", package.parent / "assets")
    return next((home / name for home in homes if (home / name).is_file()), None)
