"""Linear stability of circular displaced orbits, for two ways of holding the attitude.

Source: thesis, section 4.2.4, not read; re-derived and checked against a numerical Jacobian and propagation. Its paper
J.1 calls orbits above "about 20 deg" unstable: the first law gives exactly the largest cone angle, 19.4712 deg.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from sailviz.constants import AU
from sailviz.design.displaced.force_shape import force_shape
from sailviz.design.displaced.holding import attitude
from sailviz.propulsion.solar_sail import Film

CLOCKS = ("orbital", "meridian")


@dataclass(frozen=True)
class Stability:
    """lambda_squared (..., 2) : squared eigenvalues over Omega_K^2, negative for a motion that stays; the larger first.
    stable : bool, both negative, the free drift along the track not counted. growth_rate : 1/rad of Omega_K t, 0 where
    nothing grows. feasible : bool, whether the device can hold the orbit at all; NaN and not stable where it cannot."""

    lambda_squared: np.ndarray
    stable: np.ndarray
    growth_rate: np.ndarray
    feasible: np.ndarray
    reason: str = ""


def stability(
    elevation: npt.ArrayLike,
    rate_ratio: npt.ArrayLike,
    device: Film | str = "electric-sail",
    clock: str = "orbital",
    cone_limit: float | None = None,
) -> Stability:
    """Linear stability of a circular displaced orbit whose pitch and clock angle stay as designed; broadcast.

    elevation : rad. rate_ratio : Omega / Omega_K. clock : "orbital" keeps the clock angle against the osculating
    angular momentum (what fixed pitch and clock fly), "meridian" keeps the thrust in the plane of Sun line and ecliptic
    pole.
    cone_limit : rad, a smaller limit than the device's. Thrust falls as r^-k, k = 1 electric sail, 2 solar sail, w =
    ratio^2: "orbital": |h| is conserved, lambda^2 = (2 - k) - (3 - k) w cos^2(psi) and -w.
    "meridian": h_z is conserved, lambda^2 the eigenvalues of a 2 x 2 matrix in (rho, z).
    With k = 2 the largest eigenvalue of "orbital" is -w cos^2(psi), of "meridian" negative too: solar sails are stable.
    """
    if clock not in CLOCKS:
        raise ValueError(f"clock is {' or '.join(map(repr, CLOCKS))}, not {clock!r}")
    psi, ratio = np.broadcast_arrays(np.asarray(elevation, dtype=float), np.asarray(rate_ratio, dtype=float))
    k = force_shape(device).exponent
    w, c, s = ratio**2, np.cos(psi), np.abs(np.sin(psi))
    _, _, _, feasible = attitude(np.full(psi.shape, AU), 1 - w * c * c, w * s * c, device, cone_limit)
    if clock == "orbital":
        first, second = (2 - k) - (3 - k) * w * c * c, -w
    else:
        m11, m12 = k * c * c * (w - 1) + 2 * c * c - 3 * w, c * s * (k * w - k + 2)
        m21, m22 = c * s * (w - k + 2), k * (c * c - 1) - c * c * w - 2 * c * c + 2
        trace, root = m11 + m22, np.sqrt(np.maximum((m11 - m22) ** 2 + 4 * m12 * m21, 0.0))
        first, second = (trace + root) / 2, (trace - root) / 2
        # the smaller eigenvalue from the determinant: no cancellation where it passes through zero
        determinant = m11 * m22 - m12 * m21
        first = np.where((trace < 0) & (second != 0), determinant / np.where(second == 0, 1.0, second), first)
    squared = np.stack([np.maximum(first, second), np.minimum(first, second)], axis=-1)
    stable = feasible & (squared[..., 0] < 0)
    squared = np.where(feasible[..., None], squared, np.nan)
    growth = np.sqrt(np.maximum(squared[..., 0], 0.0))
    reason = ""
    if psi.ndim == 0 and not feasible:
        limit = force_shape(device).cone_limit() if cone_limit is None else cone_limit
        t = np.tan(min(limit, np.pi / 2))
        most = float(np.sqrt(t / (s * c + t * c * c)))
        reason = f"no device with this largest cone angle holds the orbit; a rate ratio up to {most:.6g} is possible"
    return Stability(squared, stable[()], growth[()], feasible[()], reason)


def smallest_stable_rate(elevation: npt.ArrayLike, clock: str = "orbital") -> np.ndarray:
    """Rate ratio above which an electric sail's orbit is stable, over elevation in rad, same shape; it may be
    infeasible.

    "orbital": w cos^2(psi) > 1/2. "meridian": w > (3 - 2 cos^2(psi)) / (2 cos^2(psi)).
    """
    if clock not in CLOCKS:
        raise ValueError(f"clock is {' or '.join(map(repr, CLOCKS))}, not {clock!r}")
    square = np.cos(elevation) ** 2
    return np.sqrt(1 / (2 * square) if clock == "orbital" else (3 - 2 * square) / (2 * square))


def largest_stable_elevation(clock: str = "orbital", cone_limit: float | None = None) -> tuple[float, float]:
    """(elevation rad, rate ratio) where the wedge of stable and feasible orbits of an electric sail closes.

    cone_limit : rad, the electric sail's own by default. Feasible is w <= T / (s c + T c^2), T = tan(cone_limit). Under
    the law "orbital" the wedge closes exactly at the largest cone angle.
    """
    from scipy.optimize import brentq  # half a second to import, seldom needed

    t = force_shape("electric-sail").slope_limit() if cone_limit is None else np.tan(cone_limit)

    def largest(psi):
        c, s = np.cos(psi), np.sin(psi)
        return np.sqrt(t / (s * c + t * c * c))

    if clock == "orbital":
        psi = np.arctan(t)
    else:
        psi = brentq(lambda x: largest(x) - smallest_stable_rate(x, clock), 1e-9, np.pi / 2 - 1e-9, xtol=1e-15)
    return float(psi), float(largest(psi))
