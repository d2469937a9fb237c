"""Where to look from. Found by trying directions, so that arrows are apart, nothing is edge-on and the Sun is where it
helps.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from sailviz.frames import unit


@dataclass(frozen=True)
class Camera:
    """Where a view looks from. `origin` is the entity whose frame position, target and up are given in."""

    name: str
    origin: str
    position: tuple[float, ...]
    target: tuple[float, ...] = (0.0, 0.0, 0.0)
    up: tuple[float, ...] = (0.0, 0.0, 1.0)


def directions(elevations: ArrayLike, step: float = 10.0) -> np.ndarray:
    """Unit vectors on a grid of azimuths every `step` degrees and the given elevations, deg, (n, 3)."""
    azimuth, elevation = np.meshgrid(np.radians(np.arange(0, 360, step)), np.radians(elevations))
    return np.stack(
        [np.cos(elevation) * np.cos(azimuth), np.cos(elevation) * np.sin(azimuth), np.sin(elevation)], -1
    ).reshape(-1, 3)


def apart(
    arrows: ArrayLike,
    facing: np.ndarray | None = None,
    slanted: np.ndarray | None = None,
    open_to: np.ndarray | None = None,
    elevations: ArrayLike = (12, 20, 28, 36, 44),
) -> np.ndarray:
    """Direction from which arrows from the origin look long and well separated. arrows (k, 3) -> (3,) unit.

    facing : the normal of a film whose sunward side should be seen at a slant of about 70 degrees; slanted : the
    normal of a wheel, and open_to : that of a plane, neither of which should be seen edge-on.
    """
    pointing = unit(np.asarray(arrows, float))
    eyes = directions(elevations)
    right = unit(np.cross([0.0, 0.0, 1.0], eyes))
    up = np.cross(eyes, right)
    flat = np.stack([right @ pointing.T, up @ pointing.T], -1)  # (eyes, arrows, 2)
    length = np.linalg.norm(flat, axis=-1)
    gaps = [np.linalg.norm(flat[:, i] - flat[:, j], axis=-1) for i in range(len(pointing)) for j in range(i)]
    closest = np.min(gaps, axis=0) if gaps else 0.45
    score = 1.8 * np.minimum(closest, 0.45) + 0.6 * length.min(1) + 0.25 * length.mean(1)
    if facing is not None:
        score = score + 1.2 * (1 - np.abs(-(eyes @ facing) - 0.36) / 0.36)
    if slanted is not None:
        score = score + 1.2 * np.minimum(np.abs(eyes @ slanted), 0.4) / 0.4
    if open_to is not None:
        score = score + 0.9 * np.abs(eyes @ open_to)
    best: np.ndarray = eyes[np.argmax(score)]
    return best


def over_planet(orbit_normal: np.ndarray, sun: np.ndarray | None = None) -> np.ndarray:
    """Direction that sees an orbit as an open ellipse, the line between day and night, and some north."""
    eyes = directions(np.arange(5, 50, 5), 5.0)
    cost = np.abs(np.abs(eyes @ orbit_normal) - 0.45) + 0.6 * np.abs(eyes[:, 2] - 0.40)
    if sun is not None:
        cost = cost + np.abs(eyes @ sun - 0.40)
    best: np.ndarray = eyes[np.argmin(cost)]
    return best
