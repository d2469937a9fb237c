"""What stands round everything: the stars, and the Sun in the centre."""

from __future__ import annotations

import numpy as np
import rerun as rr

from sailviz.frames import unit
from sailviz.recording.drawing import style
from sailviz.recording.drawing.log import Picture, f4
from sailviz.recording.drawing.style import points
from sailviz.shapes.primitives import ball


def log_stars(picture: Picture, path: str, radius: float, count: int = 1100) -> None:
    """The same stars in every recording, on a sphere."""
    random = np.random.default_rng(7)
    direction = unit(random.normal(size=(count, 3)))
    magnitude = random.random(count) ** 4
    tints = np.array([[200, 215, 255], [255, 255, 255], [255, 236, 205]])[random.integers(0, 3, count)]
    colors = (tints * (0.30 + 0.55 * magnitude)[:, None]).astype(np.uint8)
    sizes = points(0.3 + 0.6 * magnitude)
    picture.log_static(path, rr.Points3D(f4(radius * direction), colors=colors, radii=sizes, point_shading="flat"))


def log_sun(picture: Picture) -> None:
    """Of radius 1: an unlit ball in a glow of three splats."""
    picture.log_mesh("/world/sun/ball", ball(), style.SUN_DISC, shaded=False)
    glow = ((1.15, (255, 214, 120, 230)), (2.4, (255, 160, 60, 70)), (5.5, (255, 120, 40, 22)))
    picture.log_static(
        "/world/sun/glow",
        rr.GaussianSplats3D([[0, 0, 0]] * 3, scales=[[r] * 3 for r, _ in glow], colors=[c for _, c in glow]),
    )
