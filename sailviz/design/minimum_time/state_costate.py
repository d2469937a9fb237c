"""State and costates of a minimum-time flight: twelve numbers, what stands where among them, and how they move.

Units: mu = 1, one au = 1. The Hamiltonian H = lam_r . v + lam_v . (a - r / r^3) is maximised and constant along the
flight. With h(c) the support function of the thrust, c and s cosine and sine of the angle between the primer lam_v and
r_hat, and q = a_c r^-k |lam_v|, the envelope theorem gives the adjoint without a derivative of the steering law:

    d(q h)/dr = -k q h / r r_hat - q (c f_t - s f_r) / r t_hat.

Re-derived, checked against differences of H.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from sailviz.compiled import called
from sailviz.constants import AU, GRAVITY_AT_1_AU, MU_SUN
from sailviz.propulsion.devices import ELECTRIC_SAIL, SOLAR_SAIL, sail
from sailviz.propulsion.solar_sail import Film
from sailviz.steering.optimal import COOL, cooled, full_thrust, optimal_pitch, steer
from sailviz.steering.singular import switching_rates

TIME_UNIT = np.sqrt(AU**3 / MU_SUN)  # s, 58.13 d
SPEED_UNIT = AU / TIME_UNIT  # m/s, 29.78 km/s

# places of position, velocity, lam_r and lam_v among the twelve
X, Y, Z, VX, VY, VZ, LRX, LRY, LRZ, LVX, LVY, LVZ = range(12)
SIZE = 12
STATE, COSTATES = slice(X, LRX), slice(LRX, SIZE)
POSITION, VELOCITY, LAM_R, LAM_V = slice(X, VX), slice(VX, LRX), slice(LRX, LVX), slice(LVX, SIZE)

THRUST, COAST, SINGULAR = -1.0, -2.0, -3.0  # in the place of eps: an E-sail's arc, inside which nothing switches
SWITCH, OWN = 0, 1  # places in the parameters of a Sail: of the cosine at which it switches, of the sail's own numbers
NEVER = -2.0  # a cosine beyond reach


class Sail(NamedTuple):
    """A sail as the propagator reads it: kind, and parameters: the cosine of the primer angle at which it switches
    off, then the numbers of `devices.sail` in units of one au and the Sun's pull there; of a film also what its heat
    allows, at steering.optimal.COOL."""

    kind: int
    parameters: np.ndarray

    @property
    def switches(self) -> bool:
        return bool(self.parameters[SWITCH] > NEVER)

    @property
    def rounds_off(self) -> bool:
        """Whether smoothing makes sense: an E-sail's thrust set, continued, does not have a film's edge-on corner."""
        return self.kind == ELECTRIC_SAIL


def canonical_sail(device: Film | str, characteristic_acceleration: float, coolness: float = 0.0) -> Sail:
    """The Sail of a device (name or Film) and its characteristic acceleration in m/s2; ValueError for no sail.
    coolness : largest cosine of a film's pitch at one au that its heat allows, which grows with r^2; 0: any."""
    kind, numbers = sail(device, characteristic_acceleration / GRAVITY_AT_1_AU, 1.0)
    low, high = 0.5 * np.pi, np.pi  # on at a transverse primer, every one of them
    off = NEVER
    if not optimal_pitch(np.pi * (1.0 - 1e-9), device).on:
        while high - low > 2e-16 * np.pi:
            middle = 0.5 * (low + high)
            if middle in (low, high):
                break
            low, high = (middle, high) if optimal_pitch(middle, device).on else (low, middle)
        off = float(np.cos(low))
    return Sail(kind, np.array([off, *numbers, *([coolness] if kind == SOLAR_SAIL else [])]))


@called
def right_hand_side(y, kind, p, eps, out):
    """out (12,) = dy/dt of state and costates y (12,). Returns (switching function, H).

    kind, p : of a Sail. The switching function is positive where the sail thrusts; eps rounds the switch off, or is the
    arc that an E-sail flies: at full thrust, without, or with the share of it that keeps the switching function at 0.
    """
    x, yy, z = y[X], y[Y], y[Z]
    lx, ly, lz = y[LVX], y[LVY], y[LVZ]
    r = np.sqrt(x * x + yy * yy + z * z)
    inverse = 1.0 / r
    inverse3 = inverse * inverse * inverse
    ux, uy, uz = x * inverse, yy * inverse, z * inverse
    size = np.sqrt(lx * lx + ly * ly + lz * lz)
    along = lx * ux + ly * uy + lz * uz
    wx, wy, wz = lx - along * ux, ly - along * uy, lz - along * uz
    across = np.sqrt(wx * wx + wy * wy + wz * wz)
    c, s = 1.0, 0.0  # of a primer that vanishes: any
    if size > 0.0:
        c, s = along / size, across / size
    tx = ty = tz = 0.0
    if across > 0.0:
        tx, ty, tz = wx / across, wy / across, wz / across
    along_light, _, h, fr, ft = steer(kind, p, OWN, c, s, eps)
    strength, exponent = full_thrust(kind, p, OWN, r, 1.0)
    switching, warmer = c - p[SWITCH], 0.0
    if kind == SOLAR_SAIL and p[OWN + COOL] > 0.0:
        most = p[OWN + COOL] * r * r
        if h > 0.0 and along_light > most:
            _, _, h, fr, ft, rise = cooled(p, OWN, most, c, s)
            switching = min(switching, h)
            if h > 0.0:
                warmer = 2.0 * rise * most  # r dh/dr: farther out the film may face the Sun more
            else:
                h = fr = ft = 0.0
    if eps < 0.0:
        share = 1.0
        if eps == COAST:
            share = 0.0
        elif eps == SINGULAR:
            _, drift, gain = switching_rates(
                x, yy, z, y[VX], y[VY], y[VZ], lx, ly, lz, y[LRX], y[LRY], y[LRZ],
                r, size, 1.0, p[SWITCH], strength, exponent, c, s, fr, ft,
            )  # fmt: skip
            share = -drift / gain
        strength *= share
    ar, at = strength * fr, strength * ft
    out[X], out[Y], out[Z] = y[VX], y[VY], y[VZ]
    out[VX] = ar * ux + at * tx - x * inverse3
    out[VY] = ar * uy + at * ty - yy * inverse3
    out[VZ] = ar * uz + at * tz - z * inverse3
    q = strength * size * inverse
    radial = q * (exponent * h - warmer) - 3.0 * along * inverse3
    sideways = q * (c * ft - s * fr)
    out[LRX] = lx * inverse3 + radial * ux + sideways * tx
    out[LRY] = ly * inverse3 + radial * uy + sideways * ty
    out[LRZ] = lz * inverse3 + radial * uz + sideways * tz
    out[LVX], out[LVY], out[LVZ] = -y[LRX], -y[LRY], -y[LRZ]
    hamiltonian = y[LRX] * y[VX] + y[LRY] * y[VY] + y[LRZ] * y[VZ] + lx * out[VX] + ly * out[VY] + lz * out[VZ]
    return switching, hamiltonian


@called
def scales(y):
    """What errors of position, velocity, lam_r and lam_v are measured with, on the orbit at hand."""
    r = np.sqrt(y[X] * y[X] + y[Y] * y[Y] + y[Z] * y[Z])
    v = np.sqrt(y[VX] * y[VX] + y[VY] * y[VY] + y[VZ] * y[VZ])
    lr = np.sqrt(y[LRX] * y[LRX] + y[LRY] * y[LRY] + y[LRZ] * y[LRZ])
    lv = np.sqrt(y[LVX] * y[LVX] + y[LVY] * y[LVY] + y[LVZ] * y[LVZ])
    pace = r * np.sqrt(r)
    return r, max(v, 1.0 / np.sqrt(r)), max(lr, lv / pace), max(lv, lr * pace)


def kepler_rates(y: np.ndarray) -> np.ndarray:
    """(n, 6) v and -r / r^3 of states y (n, >= 6): the motion along the osculating orbit."""
    r = y[:, POSITION]
    square = (r * r).sum(axis=1)[:, None]
    rates = np.empty((len(y), 6))
    rates[:, POSITION], rates[:, VELOCITY] = y[:, VELOCITY], -r / (square * np.sqrt(square))
    return rates


def revolutions(rows: np.ndarray) -> float:
    """Swept about the Sun along dense states (n, >= 3)."""
    u = rows[:, POSITION] / np.linalg.norm(rows[:, POSITION], axis=1)[:, None]
    before, after = u[:-1], u[1:]
    across = np.linalg.norm(np.cross(before, after), axis=1)
    return float(np.sum(np.arctan2(across, np.sum(before * after, axis=1))) / (2 * np.pi))
