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


def spoke_quaternions(count: int) -> np.ndarray:
    """Rotations about z that lay the x axis along the tethers, xyzw (count, 4)."""
    half = np.linspace(0, np.pi, count, endpoint=False)
    return np.stack([0 * half, 0 * half, np.sin(half), np.cos(half)], 1)


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
