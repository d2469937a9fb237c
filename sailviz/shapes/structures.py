"""What a sail has beside its film, in m: bus, booms, tethers, an E-sail's wheel. Closed bodies, fronts outwards."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from sailviz.shapes.facets import Coefficients, Part, Surface
from sailviz.shapes.primitives import Trimesh, box, joined, moved, rod

SIDES = 6  # of a boom or a tether


def bus(size: Sequence[float], centre: Sequence[float], outside: Coefficients, name: str = "bus") -> Part:
    """A box with sides along the axes. size, centre (3,) m."""
    return Part(name, moved(box(size), centre), Surface(outside))


def booms(tips: np.ndarray, radius: float, outside: Coefficients, behind: float = 0.0, name: str = "booms") -> Part:
    """Rods from the hub to tips (k, 3), so far behind the film, along +z, that they do not cut it."""
    lift = np.array([0.0, 0.0, behind])
    rods = [rod(lift, np.asarray(tip) + lift, radius, SIDES) for tip in tips]
    return Part(name, joined(rods), Surface(outside))


def tether(start: Sequence[float], end: Sequence[float], radius: float, outside: Coefficients) -> Part:
    """A straight wire between two points (3,)."""
    return Part("tether", rod(start, end, radius, SIDES), Surface(outside))


def electric_sail_wheel(
    tethers: int,
    length: float,
    radius: float,
    outside: Coefficients,
    cone: float = 0.0,
    shape: str = "cone",
    pieces: int = 12,
) -> Part:
    """The tethers of an E-sail, coned downwind by an angle at the hub, rad: straight ("cone"), or a parabola whose tips
    are where the cone's are ("parabola")."""
    share = np.linspace(0, 1, pieces + 1 if shape == "parabola" else 2)
    reach, tip = length * np.cos(cone) * share, length * np.sin(cone)
    height = tip * (share**2 if shape == "parabola" else share)
    rods: list[Trimesh] = []
    for angle in 2 * np.pi / tethers * np.arange(tethers):
        line = np.stack([reach * np.cos(angle), reach * np.sin(angle), height], axis=-1)
        rods += [rod(start, end, radius, SIDES) for start, end in pairwise(line)]
    return Part("tethers", joined(rods), Surface(outside))


def boom_tips(side: float, cone: float = 0.0) -> np.ndarray:
    """Corners of a square sail, (4, 3) m, where its diagonal booms end."""
    rise = side / 2 * np.tan(cone)
    return np.array([[x * side / 2, y * side / 2, rise] for x, y in ((1, 1), (-1, 1), (-1, -1), (1, -1))])
