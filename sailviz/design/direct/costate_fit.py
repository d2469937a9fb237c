"""Costates from any flight: those under which its steering comes nearest to being the fastest.

Along a given flight, its steering frozen, the adjoint equations are linear, lam(t) = Phi(t) lam(0). That the primer
points at every moment where the steering says it must is a homogeneous least-squares problem for lam(0), solved by the
singular vector of the smallest singular value. A first shot with them misses by 1e-4 or so where the flight is nearly
the fastest, which is what shooting needs to converge. Re-derived; checked on flights of the indirect method.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from sailviz.constants import AU, GRAVITY_AT_1_AU
from sailviz.design.minimum_time.state_costate import TIME_UNIT
from sailviz.propulsion.devices import ELECTRIC_SAILS
from sailviz.propulsion.solar_sail import FILMS, Film

STEP = 1e-5  # au, of positions that are differenced: neglected terms 1e-10 of the gradient
THRUSTING = 0.05  # throttle from which on the primer's direction is known


class Fit(NamedTuple):
    """Costates (6,) of position and velocity at departure in units of mu = 1 and one au, |lam| = 1; miss, root mean
    square of the sine between the primer and where the steering wants it."""

    costates: np.ndarray
    miss: float


def primer_direction(outward: np.ndarray, normal: np.ndarray, device: Film | str) -> np.ndarray:
    """Unit vectors (n, 3) of the primers for which normals (n, 3) are the best, r_hat (n, 3); a film's are where
    c f_r + s f_t is stationary in the pitch. Of the electric sail the final model's."""
    c = np.sum(outward * normal, axis=1)
    if isinstance(device, str) and device in ELECTRIC_SAILS:
        return np.asarray(2 * c[:, None] * normal - outward)
    film = FILMS[device] if isinstance(device, str) else device
    side = normal - c[:, None] * outward
    s = np.linalg.norm(side, axis=1)
    side = side / np.maximum(s, 1e-300)[:, None]
    b1, b2, b3 = film.b1, film.b2, film.b3
    slope_r = -s * (b1 + 3 * b2 * c**2 + 2 * b3 * c)  # of the factors of (3.21) over the pitch
    slope_t = b2 * (c**3 - 2 * c * s**2) + b3 * (c**2 - s**2)
    angle = np.arctan2(-slope_r, slope_t)
    return np.asarray(np.cos(angle)[:, None] * outward + np.sin(angle)[:, None] * side)


def _acceleration(
    place: np.ndarray, held: np.ndarray, throttle: np.ndarray, device: Film | str, strength: float
) -> np.ndarray:
    """(n, 3) of gravity and thrust at places (n, 3), canonical; held (n, 3): the film's normal, or where the electric
    sail's primer points."""
    r = np.linalg.norm(place, axis=1)[:, None]
    u = place / r
    pull = -u / r**2
    if isinstance(device, str) and device in ELECTRIC_SAILS:
        return pull + throttle[:, None] * strength / (4 * r) * (3 * u + held)  # (3.39)
    film = FILMS[device] if isinstance(device, str) else device
    c = np.sum(u * held, axis=1)[:, None]
    size = np.where(c > 0, strength / film.total * c / r**2, 0.0)
    return pull + size * (film.b1 * u + (film.b2 * c + film.b3) * held)  # (3.17), (3.23)


def fit(
    time: npt.ArrayLike,
    position: npt.ArrayLike,
    normal: npt.ArrayLike,
    throttle: npt.ArrayLike,
    device: Film | str,
    characteristic_acceleration: float,
) -> Fit:
    """Costates of a flight. time (n,) s, increasing, n odd; position (n, 3) m from the Sun; normal (n, 3) unit vectors
    of the sail in space; throttle (n,), 1 at full thrust; device : a film or "electric-sail"; m/s2."""
    if isinstance(device, str) and device in ELECTRIC_SAILS and device != "electric-sail":
        raise ValueError(f'the electric sail\'s final model is known here only, not "{device}"')
    t, place = np.asarray(time, float) / TIME_UNIT, np.asarray(position, float) / AU
    n, tau = np.asarray(normal, float), np.asarray(throttle, float)
    strength = characteristic_acceleration / GRAVITY_AT_1_AU
    outward = place / np.linalg.norm(place, axis=1)[:, None]
    primer = primer_direction(outward, n, device)
    held = primer if isinstance(device, str) and device in ELECTRIC_SAILS else n
    gradient = np.empty((len(t), 3, 3))
    for j in range(3):
        ahead, behind = (
            _acceleration(place + way * STEP * np.eye(3)[j], held, tau, device, strength) for way in (1, -1)
        )
        gradient[:, :, j] = (ahead - behind) / (2 * STEP)
    phi = _transition(t, gradient)
    known = tau[::2] > THRUSTING
    towards, ours = primer[::2][known], phi[known, 3:]
    across = np.eye(3) - towards[:, :, None] * towards[:, None, :]
    weight = np.sqrt(np.gradient(t[::2])[known] / t[-1])
    size = np.linalg.norm(ours, axis=(1, 2))
    rows = (weight / size)[:, None, None] * (across @ ours)
    _, _, vt = np.linalg.svd(rows.reshape(-1, 6), full_matrices=False)
    lam = vt[-1]
    p = ours @ lam
    if np.sum(p * towards) < 0:
        lam, p = -lam, -p
    sine = np.linalg.norm(np.cross(p, towards), axis=1) / np.linalg.norm(p, axis=1)
    return Fit(lam, float(np.sqrt(np.mean(sine**2))))


def _transition(t: np.ndarray, gradient: np.ndarray) -> np.ndarray:
    """(m, 6, 6) of lam(t) = Phi lam(0) at every second of times (n,): lam_r' = -G^T lam_v, lam_v' = -lam_r, by Runge
    and Kutta's fourth order over two intervals, the middle one's gradient given."""
    rates = np.zeros((len(t), 6, 6))
    rates[:, :3, 3:] = -np.swapaxes(gradient, 1, 2)
    rates[:, 3:, :3] = -np.eye(3)
    found = [np.eye(6)]
    for i in range(0, len(t) - 2, 2):
        h, y = t[i + 2] - t[i], found[-1]
        a = rates[i] @ y
        b = rates[i + 1] @ (y + 0.5 * h * a)
        c = rates[i + 1] @ (y + 0.5 * h * b)
        d = rates[i + 2] @ (y + h * c)
        found.append(y + h / 6 * (a + 2 * b + 2 * c + d))
    return np.array(found)
