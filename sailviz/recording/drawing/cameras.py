"""Where to look from: directions are tried, so that the lit side of a film is seen, the push is not hidden behind it,
names are apart, and everything fits.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from sailviz.frames import unit

FIELD = 0.50  # half the height of a view, of the distance to what it looks at
WELL, WANTED = 0.3, 0.75  # cosine of a lit side that is well seen, and for how much of the time it should be
SLOW, FAST = 200, 440  # deg, the most that a sweep turns, and where that does not suffice
OPEN = np.radians(42.0)  # between an eye and the normal of a plane that is seen open
FITTING = 12  # rounds in which target and distance are found


@dataclass(frozen=True)
class Camera:
    """Where a view looks from. `origin` is the entity whose frame position, target and up are given in."""

    name: str
    origin: str
    position: tuple[float, ...]
    target: tuple[float, ...] = (0.0, 0.0, 0.0)
    up: tuple[float, ...] = (0.0, 0.0, 1.0)


@dataclass(frozen=True)
class Sweep:
    """An eye that goes round the z axis at an even rate: its first direction (3,), and rad until the end."""

    eye: np.ndarray
    turn: float


def directions(elevations: ArrayLike, step: float = 6.0) -> np.ndarray:
    """Unit vectors on a grid of azimuths every `step` degrees and the given elevations, deg, (n, 3)."""
    azimuth, elevation = np.meshgrid(np.radians(np.arange(0, 360, step)), np.radians(elevations))
    return direction(azimuth, elevation).reshape(-1, 3)


def direction(azimuth: ArrayLike, elevation: ArrayLike) -> np.ndarray:
    """Unit vectors (..., 3) of azimuths and elevations in rad."""
    azimuth, elevation = np.broadcast_arrays(azimuth, elevation)
    across = np.cos(elevation)
    return np.stack([across * np.cos(azimuth), across * np.sin(azimuth), np.sin(elevation)], -1)


def seen(cosine: np.ndarray, film: bool, open: bool = False) -> np.ndarray:
    """How well a sail is seen whose lit side has this cosine to the eye: a film best at a slant and from its lit side,
    a wheel from both. open : there is something to be seen on its surface."""
    if open:
        lit = cosine if film else np.abs(cosine)
        found = np.interp(lit, [-1, -0.2, 0, 0.2, 0.35, 0.5, 0.7, 1], [-0.5, -0.5, -0.3, 0.4, 1, 1, 0.7, 0.3])
    elif film:
        found = np.interp(cosine, [-1, -0.2, 0, 0.12, 0.3, 0.75, 1], [-0.25, -0.3, -0.1, 0.75, 1, 1, 0.7])
    else:
        found = np.interp(np.abs(cosine), [0, 0.25, 0.8, 1], [-0.3, 1, 1, 0.7])
    return np.asarray(found)


def across(eyes: np.ndarray, arrows: np.ndarray, enough: float) -> np.ndarray:
    """How much of each arrow is seen from each eye, 0 to 1; `enough` of it counts as all. (eyes, k)"""
    sine = np.sqrt(np.clip(1 - (eyes @ arrows.T) ** 2, 0, 1))
    return np.asarray(np.minimum(sine, enough) / enough)


def fixed_eye(
    normals: np.ndarray,
    thrusts: np.ndarray,
    weights: np.ndarray,
    film: bool,
    elevations: ArrayLike,
    *,
    push: float = 0.5,
    near: np.ndarray | None = None,
    spots: np.ndarray | None = None,
    others: np.ndarray | None = None,
    open: bool = False,
) -> np.ndarray:
    """Direction (3,) from which a sail is seen best over some moments.

    normals, thrusts : (n, 3) unit vectors; weights (n,) of the moments; push : what seeing the thrust is worth
    near : (3,) where the craft should be in the near half, as long as that is worth; spots : (k, 3) things whose names
    should be apart, of the size of the scene; others : (n, 3) a second arrow; open : whether something is to be seen
    on the sail's surface
    """
    eyes = directions(elevations)
    share = weights / weights.sum()
    score = seen(-(eyes @ normals.T), film, open) @ share + push * across(eyes, thrusts, 0.85) @ share
    if near is not None:
        score = score + eyes @ near
    if others is not None:
        score = score + 0.5 * across(eyes, others, 0.7) @ share
    if spots is not None and len(spots) > 1:
        right = unit(np.cross([0.0, 0.0, 1.0], eyes))
        flat = np.stack([right @ spots.T, np.cross(eyes, right) @ spots.T], -1)
        gaps = np.linalg.norm(flat[:, :, None] - flat[:, None], axis=-1) + 9 * np.eye(len(spots))
        score = score + 0.6 * np.minimum(gaps.min((1, 2)), 0.25) / 0.25
    best: np.ndarray = eyes[np.argmax(score)]
    return best


@dataclass(frozen=True)
class Moments:
    """A sail at n moments: its normals, thrusts and places (n, 3), unit vectors, at shares (n,) of the time, and what
    each moment counts, (n,)."""

    normals: np.ndarray
    thrusts: np.ndarray
    places: np.ndarray
    shares: np.ndarray
    weights: np.ndarray


def sweep(moments: Moments, film: bool, elevation: float) -> Sweep:
    """The slow sweep that sees a sail best, at an elevation in degrees. It turns by at most 200 degrees, unless a film
    would then be well seen for less than three quarters of the time."""
    going = best_sweep(moments, film, elevation, SLOW)
    if film and well_seen(going, moments) < WANTED:
        faster = best_sweep(moments, film, elevation, FAST)
        if well_seen(faster, moments) > well_seen(going, moments):
            return faster
    return going


def best_sweep(moments: Moments, film: bool, elevation: float, most: int) -> Sweep:
    """The best of all sweeps that turn by at most so many degrees."""
    share = moments.weights / moments.weights.sum()
    start = np.radians(np.arange(0, 360, 10))[:, None, None]
    turn = np.radians(np.arange(-most, most + 1, 20))[None, :, None]
    eyes = direction(start + turn * moments.shares, np.radians(elevation))  # (starts, turns, n, 3)
    lit = -np.sum(eyes * moments.normals, -1)
    sine = np.sqrt(np.clip(1 - np.sum(eyes * moments.thrusts, -1) ** 2, 0, 1))
    near = np.sum(eyes * moments.places, -1)
    worth = seen(lit, film) + 0.5 * np.minimum(sine, 0.85) / 0.85 + (0.45 if film else 1.0) * near
    score = worth @ share - 0.12 * np.abs(turn[..., 0]) / np.pi
    if most > SLOW:  # what the faster one is for
        score = score + 2.0 * np.minimum((lit > WELL) @ share, 0.85)
    first, pace = np.unravel_index(np.argmax(score), score.shape)
    return Sweep(eyes[first, pace, 0], float(turn[0, pace, 0]))


def well_seen(going: Sweep, moments: Moments) -> float:
    """Share of the time in which a film's lit side is well seen."""
    azimuth = np.arctan2(going.eye[1], going.eye[0]) + going.turn * moments.shares
    eyes = direction(azimuth, np.arcsin(np.clip(going.eye[2], -1, 1)))
    time = np.gradient(moments.shares)
    return float((-np.sum(eyes * moments.normals, -1) > WELL) @ (time / time.sum()))


def fit(
    places: np.ndarray, eye: np.ndarray, aspect: float, fill: float = 0.90, up: ArrayLike = (0.0, 0.0, 1.0)
) -> tuple[np.ndarray, np.ndarray]:
    """Eye and target (3,) from which places (n, 3) fill a view, as wide as `aspect` times its height, seen along the
    direction `eye` (3,)."""
    toward = unit(np.asarray(eye, float))
    right = unit(np.cross(np.asarray(up, float), toward))
    top = np.cross(toward, right)
    target, half, distance = places.mean(0), FIELD * fill, 1.0
    for _ in range(FITTING):
        off = places - target
        x, y, z = off @ right, off @ top, off @ toward
        distance = float(max(np.max(np.abs(y) / half + z), np.max(np.abs(x) / (half * aspect) + z)))
        flat_x, flat_y = x / (distance - z), y / (distance - z)
        aside = 0.4 * distance * (flat_x.max() + flat_x.min())
        above = 0.4 * distance * (flat_y.max() + flat_y.min())
        target = target + aside * right + above * top
    off = places - target
    x, y, z = off @ right, off @ top, off @ toward
    distance = float(max(np.max(np.abs(y) / half + z), np.max(np.abs(x) / (half * aspect) + z)))
    return target + distance * toward, target


def on_screen(places: np.ndarray, camera: Camera, aspect: float) -> np.ndarray:
    """Where places (n, 3) of a camera's frame are seen: (n, 2), -1 to 1 across the view and up; NaN behind the eye."""
    eye, target = np.array(camera.position), np.array(camera.target)
    toward = unit(eye - target)
    right = unit(np.cross(camera.up, toward))
    off = places - eye
    depth = -(off @ toward)
    with np.errstate(divide="ignore", invalid="ignore"):
        flat = np.stack([off @ right / aspect, off @ np.cross(toward, right)], -1) / (FIELD * depth[:, None])
    return np.where((depth > 0)[:, None], flat, np.nan)


def over_planet(orbit_normal: np.ndarray, sun: np.ndarray | None) -> np.ndarray:
    """Direction that sees an orbit as an open ellipse, from the day side, and some north."""
    eyes = directions(np.arange(0, 60, 5), 5.0)
    cost = np.abs(np.abs(eyes @ orbit_normal) - 0.5) + 0.3 * np.abs(eyes[:, 2] - 0.35)
    if sun is not None:
        cost = cost + 0.9 * np.abs(eyes @ sun - 0.72)
    best: np.ndarray = eyes[np.argmin(cost)]
    return best


def over_plane(normal: np.ndarray, line: np.ndarray) -> np.ndarray:
    """Direction that sees a plane with a normal (3,) as open as `OPEN`, a line (3,) in it at its full length, with z
    up."""
    toward = unit(normal) if normal[2] >= 0 else -unit(normal)
    aside = unit(np.cross(toward, line))
    eyes = np.cos(OPEN) * toward + np.sin(OPEN) * aside * np.array([[1.0], [-1.0]])
    best: np.ndarray = eyes[np.argmax(eyes[:, 2] - np.maximum(eyes[:, 2] - 0.9, 0.0) * 9.0)]
    return best
