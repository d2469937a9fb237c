"""A square sail of side 1: billowed film, booms, steering vanes, bus. +z is its normal, away from the Sun."""

from __future__ import annotations

import numpy as np

from sailviz.shapes.primitives import Trimesh, box, joined, moved, rod, turned

BILLOW = 0.06  # depth of the pillows as a fraction of the side
SCALLOP = 0.05  # how far the edges are drawn in
HALVINGS = 4  # of a quadrant's edges: 16 pieces
BOOM_RADIUS = 0.006
TIP = np.sqrt(0.5)  # distance of a boom's end


def film_points(u: np.ndarray, v: np.ndarray, a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Points (n, 3) of one quadrant between the booms' ends a and b, for shares u, v (n,) >= 0 of them, u + v <= 1.

    A pillow (27 u v w is 1 in the middle) that pushes along +z, and an outer edge that hangs between the boom tips.
    """
    w = np.maximum(1 - u - v, 0)
    reach = np.maximum(u + v, 1e-9)
    drawn_in = 1 - SCALLOP * 4 * u * v / reach
    flat = (np.multiply.outer(u, a) + np.multiply.outer(v, b)) * drawn_in[..., None]
    depth = BILLOW * (27 * u * v * w * 0.9 + 4 * u * v * 0.35)
    points: np.ndarray = flat + np.multiply.outer(depth, [0.0, 0.0, 1.0])
    return points


def quadrants() -> list[tuple[np.ndarray, np.ndarray]]:
    """The boom ends, (3,) each, in neighbouring pairs."""
    angle = 0.5 * np.pi * np.arange(4)
    ends = TIP * np.stack([np.cos(angle), np.sin(angle), 0 * angle], 1)
    return [(ends[quarter], ends[(quarter + 1) % 4]) for quarter in range(4)]


def film() -> Trimesh:
    """Four billowed quadrants between diagonal booms; the front of its faces is the dark side."""
    triangle = Trimesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]], process=False)
    for _ in range(HALVINGS):
        triangle = triangle.subdivide()
    u, v, _ = triangle.vertices.T
    return joined([Trimesh(film_points(u, v, a, b), triangle.faces, process=False) for a, b in quadrants()])


def seams(rows: int = 5) -> list[np.ndarray]:
    """Lines across the film, (2^HALVINGS + 1, 3) each."""
    share = np.linspace(0, 1, 2**HALVINGS + 1)
    return [
        film_points(reach * (1 - share), reach * share, a, b)
        for a, b in quadrants()
        for reach in np.linspace(1 / rows, 1, rows)
    ]


def booms() -> Trimesh:
    """Four rods from the middle to the corners."""
    return joined([rod([0, 0, 0], end, BOOM_RADIUS) for end, _ in quadrants()])


def vanes() -> Trimesh:
    """Steering vanes on the boom tips, seen from both sides."""
    corners = [[TIP, 0, 0], [TIP * 1.055, TIP * 0.028, TIP * 0.016], [TIP * 1.055, -TIP * 0.028, -TIP * 0.016]]
    front = Trimesh(corners, [[0, 1, 2]], process=False)
    back = front.copy()
    back.invert()
    return joined([turned(joined([front, back]), quarter * np.pi / 2) for quarter in range(4)])


def bus() -> Trimesh:
    """The craft's body on the dark side."""
    return moved(box([0.07, 0.07, 0.09]), [0.0, 0.0, 0.045])
