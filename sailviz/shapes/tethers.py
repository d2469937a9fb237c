"""Craft with tethers or a thruster: the wheel of an E-sail of radius 1, a satellite of height 0.3, a thruster's bus.

+z is the wheel's normal, away from the Sun; of a satellite, away from its tether; of a thruster, the thrust.
"""

from __future__ import annotations

import numpy as np

from sailviz.shapes.primitives import Trimesh, box, cylinder, joined, moved, tube


def spokes(count: int) -> np.ndarray:
    """Directions of `count` tethers in the plane of an E-sail, (count, 3)."""
    angle = np.linspace(0, 2 * np.pi, count, endpoint=False)
    return np.stack([np.cos(angle), np.sin(angle), 0 * angle], 1)


def spoke_quaternions(count: int, slope: float = 0.0) -> np.ndarray:
    """Rotations that lay the x axis along the tethers, xyzw (count, 4). slope : rad, of the tethers over the plane."""
    half, up = np.linspace(0, np.pi, count, endpoint=False), -0.5 * slope
    turn = [-np.sin(half) * np.sin(up), np.cos(half) * np.sin(up), np.sin(half) * np.cos(up), np.cos(half) * np.cos(up)]
    return np.stack(turn, 1)


def bent(cone: float, rise: float, start: float = 0.0) -> np.ndarray:
    """A tether of length 1 in its own plane, outwards and downwind from the hub, or from a share `start` of its reach
    on: straight at a cone angle, rad, or a parabola of a rise over its reach. (k, 2)"""
    if rise == 0:
        return np.outer([start, 1.0], [np.cos(cone), np.sin(cone)])
    slope = 2 * rise  # at the tip
    length = 0.5 * np.hypot(1, slope) + 0.5 * np.arcsinh(slope) / slope  # of an arc of reach 1
    out = np.linspace(start, 1, 13)
    arc: np.ndarray = np.stack([out, rise * out**2], 1) / length
    return arc


def round_hub(profile: np.ndarray, out: np.ndarray) -> np.ndarray:
    """Points (n, k, 3) of tethers like a profile (k, 2) in directions (n, 3) of the plane."""
    points: np.ndarray = profile[:, :1] * out[:, None] + profile[:, 1:] * np.array([0.0, 0.0, 1.0])
    return points


def wheel_hub() -> Trimesh:
    """The middle of an E-sail."""
    return cylinder(0.035, -0.025, 0.025)


def remote_unit() -> Trimesh:
    """What sits at the tip of one tether of an E-sail, about the origin, x outwards."""
    return box([0.025, 0.018, 0.018])


def satellite_bus() -> Trimesh:
    """The body of a small satellite."""
    return box([0.10, 0.10, 0.30])


def satellite_panels() -> Trimesh:
    """Its two solar panels."""
    return joined([moved(box([0.012, 0.34, 0.26]), [0.0, side * 0.24, 0.0]) for side in (-1, 1)])


def thruster_bus() -> Trimesh:
    """The body of a spacecraft with a thruster."""
    return box([0.34, 0.34, 0.46])


def thruster_panels() -> Trimesh:
    """Its two solar panels."""
    return joined([moved(box([0.62, 0.30, 0.014]), [side * 0.52, 0.0, 0.0]) for side in (-1, 1)])


def thruster_nozzle() -> Trimesh:
    """An open cone against the thrust."""
    return tube(-0.36, -0.23, 0.11, 0.05)
