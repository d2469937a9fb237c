"""A generic thruster: constant acceleration or constant thrust along the steering's direction, with mass loss.

Source: thesis, (2.3): m_dot = -m a / (g0 Isp).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from sailviz.compiled import inlined
from sailviz.constants import STANDARD_GRAVITY


class Parameters(NamedTuple):
    """A thruster in compiled code."""

    size: float  # m/s2, or N
    is_force: float  # 1 where size is a force, 0 where it is an acceleration
    inverse_exhaust: float  # 1 / (g0 Isp), s/m; 0 for no loss of mass


@inlined
def thruster_force(dx, dy, dz, m, size, is_force, inverse_exhaust):
    """Acceleration along the unit vector d, and m_dot in kg/s. size: m/s2, or N if is_force. inverse_exhaust: 1/(g0
    Isp), s/m."""
    a = size / m if is_force > 0.5 else size
    return a * dx, a * dy, a * dz, -m * a * inverse_exhaust  # (2.3)


def propellant(delta_v: npt.ArrayLike, specific_impulse: npt.ArrayLike, initial_mass: npt.ArrayLike) -> np.ndarray:
    """Propellant in kg for a velocity change in m/s at a specific impulse in s: the rocket equation, (2.3)
    integrated."""
    exhaust_speed = np.multiply(specific_impulse, STANDARD_GRAVITY)
    return np.multiply(initial_mass, -np.expm1(-np.divide(delta_v, exhaust_speed)))
