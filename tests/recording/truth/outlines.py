"""What the shape of a sail must look like, from what its scene tells: surfaces by their formulas, in m in body axes."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

FILM, BLACK = (0.0723, 0.8554, -0.0030), (0.5, 0.0, 0.0)  # b1, b2, b3 of jpl-2015, and of a bus
# (3.20) of jpl-2015 with the roles of front and back swapped and nothing mirrored
BLACK_BACK = (0.5, 0.0, 0.5 * (0.27 * 0.67 - 0.025 * 0.79) / (0.27 + 0.025))
YEAR = 365.25 * 86400.0  # s
NEAR = 2e-6  # of the size: what is drawn is float32


@dataclass(frozen=True)
class Outline:
    """A film z = height(|x|, |y|) over |x| <= half[0], |y| <= half[1] about a place, m, or over the disc in it; beside
    it a box, or none."""

    height: Callable
    half: np.ndarray
    about: np.ndarray
    middle: np.ndarray | None
    size: np.ndarray | None
    back: tuple[float, float, float]
    shadow: bool
    disc: bool = False

    @property
    def box(self):
        """Its lowest and highest corner (3,)."""
        corner = (0.0, 0.0) if self.disc else self.half
        top = self.about[2] + self.height(*corner) if self.half.any() else 0.0
        deep = self.about[2] + self.height(self.half[0], 0.0)
        low = np.array([*(self.about[:2] - self.half), min(self.about[2], top, deep)])
        high = np.array([*(self.about[:2] + self.half), max(self.about[2], top, deep)])
        if self.middle is None:
            return low, high
        return np.minimum(low, self.middle - self.size / 2), np.maximum(high, self.middle + self.size / 2)

    @property
    def length(self) -> float:
        """Its longest side, drawn as 1."""
        low, high = self.box
        return float((high - low).max())

    def on_box(self, points) -> np.ndarray:
        """(n,) whether points (n, 3) lie on the box."""
        if self.middle is None:
            return np.zeros(len(points), bool)
        off = np.abs(np.asarray(points) - self.middle) - self.size / 2
        return np.abs(off.max(axis=1)) < NEAR * self.length

    def on_film(self, points) -> np.ndarray:
        """(n,) whether points (n, 3) lie on the film."""
        x, y, z = np.abs(np.asarray(points)[:, 0] - self.about[0]), np.abs(points[:, 1] - self.about[1]), points[:, 2]
        near = NEAR * self.length
        inside = (x < self.half[0] + near) & (y < self.half[1] + near)
        if self.disc:
            inside = np.hypot(x, y) < self.half[0] + near
        return inside & (np.abs(z - self.about[2] - self.height(x, y)) < near)


def outline(f) -> Outline | None:
    """Of a flight whose scene tells a shape that is drawn; None of a craft that is drawn as its kind is."""
    told = (f.truth.resolved.get("device") or {}).get("shape") if "craft_shape" in f.truth.scene else None
    if told is None:
        return None
    middle = size = None
    if told["bus"]:
        middle, size = np.array(told["bus"]["centre"]), np.array(told["bus"]["size"])
    back = {"same": FILM, "black": BLACK_BACK}[f.truth.resolved["device"]["back"]]
    about = np.zeros(3)
    if told["kind"] == "square":
        half = np.full(2, told["side"] / 2)

        def height(x, y):
            d, e = np.maximum(x, y), np.minimum(x, y)
            return d * (np.tan(told["cone"]) + 2 * told["sag"] * (1 - (e / np.maximum(d, 1e-300)) ** 2))
    elif told["kind"] == "pyramid":  # of a square, its booms along the diagonals
        assert abs(told["opening"] - np.pi / 2) < 1e-12
        half = np.full(2, told["boom"] * np.cos(told["cone"]) / np.sqrt(2))

        def height(x, y):
            return np.sqrt(2) * np.tan(told["cone"]) * np.maximum(x, y)
    elif told["kind"] == "cap":  # of a sphere, through the rim of its mouth at z = 0
        half, slope = np.full(2, told["diameter"] / 2), told["edge_slope"]

        def height(x, y):
            ball = half[0] / np.sin(slope)
            return np.sqrt(np.maximum(ball**2 - x**2 - y**2, 0.0)) - ball * np.cos(slope)
    else:
        assert told["kind"] == "file"
        # `flights.lopsided` in mm, its front +x laid along -z, so that the next axis, y, becomes x and z becomes -y
        assert told["front"] == "+x"
        half, about = np.array([1.2, 0.45]), np.array([0.3, -0.25, 0.0])
        middle, size = np.array([0.1, -0.05, 0.25]), np.array([0.4, 0.5, 0.3])

        def height(x, y):
            return 0 * x * y

    return Outline(height, half, about, middle, size, back, bool(told["shadow"]), told["kind"] == "cap")


def film_of(f, row) -> tuple[float, float, float]:
    """b1, b2, b3 of the lit side at a row: of jpl-2015, or of what its dose has made of it."""
    told = f.truth.resolved["device"].get("ageing")
    if not told:
        return FILM
    gone = 1 - 0.5 ** (f.truth.film["dose_yr"][row] / (told["half_dose"] / YEAR))
    front, back = 0.025 * (1 + told["factor"] * gone), 0.27
    r, mirrored = (fresh * (1 - told["factor"] * gone / (1 + told["factor"])) for fresh in (0.91, 0.94))
    heat = (1 - r) * (front * 0.79 - back * 0.67) / (front + back)
    return (1 - mirrored * r) / 2, mirrored * r, (0.79 * r * (1 - mirrored) + heat) / 2  # (3.18)-(3.20)


def same_surface(own: Outline, points, film: bool) -> None:
    """Points (n, 3) m lie on the film alone or on the box alone, and reach to its edges."""
    points = np.asarray(points, float)
    there = own.on_film(points) if film else own.on_box(points)
    assert there.all(), f"{(~there).sum()} of {len(points)} corners lie off the {'film' if film else 'bus'}"
    if film:
        low, high = own.about[:2] - own.half, own.about[:2] + own.half
        found = points[:, :2].min(0), points[:, :2].max(0)
    else:
        low, high = own.middle - own.size / 2, own.middle + own.size / 2
        found = points.min(0), points.max(0)
    for drawn, true in zip(found, (low, high), strict=True):
        assert np.abs(drawn - true).max() < NEAR * own.length, "it does not reach its edges"
