"""The wheel of an electric sail as a body: N tethers, bent downwind, that spin about the axis n of their wheel.

A piece of tether along the unit vector s feels sigma (u - (u . s) s) in a wind along u. Three tethers or more, alike
and evenly apart, make a wheel whose force and torque follow from five means over the length of one: of the squares of
cosine and sine of its slope over the plane of the rim, of their product, and two arms of the torque. Bent downwind the
torque turns n towards the wind. What holds n at an angle to it is a voltage that follows the turn of each tether,
1 + E . e_r, with e_r the tether's way out; the share E is the smallest that does, and since no tether may have more
than the full voltage, the whole wheel pushes less.

Of straight tethers, coned by b at a pitch a, the torque is (N sigma L^2 / 2) sin b (n x u) and the share 2 tan b tan a;
in one plane the force is the final model's (3.39). The axis follows the Sun line by a torque that tethers give with a
part along n alone: the spin grows with d ln s = - (u . dn) / (u . n), which at a steady pitch in the plane of the orbit
is tan a for each radian. That effect is Toivanen and Janhunen's (arXiv 1603.05563, abstract read); all formulas are
re-derived.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from sailviz.compiled import inlined

POINTS = 64  # of the quadrature over a bent tether


class Bend(NamedTuple):
    """Means over the length of a tether; psi is its slope, x and z are its places out and downwind, over its length."""

    cosine: float  # of cos^2 psi
    sine: float  # of sin^2 psi
    both: float  # of sin psi cos psi
    torque: float  # of z - cos psi (z cos psi - x sin psi) / 2
    arm: float  # of x + sin psi (z cos psi - x sin psi)


class Numbers(NamedTuple):
    """A wheel in compiled code; without tethers there is none."""

    strength: float = 0.0  # a_c r_E of the flat wheel, m2/s2
    cosine: float = 0.5  # the next five: Bend
    sine: float = 0.0
    both: float = 0.0
    torque: float = 0.0
    arm: float = 0.5
    lever: float = 0.0  # N sigma L^2 r_E, of a torque: N m times m
    inertia: float = 0.0  # of the spin, kg m2, at which it spins at `spin`; 0 where the spin is not told
    spin: float = 0.0  # at the start, rad/s, times the cosine of the pitch there
    held: float = 0.0  # 1: the voltage holds the axis; 0: nothing does, and the torque is told


def straight(cone: float) -> Bend:
    """Tethers that stand downwind of their plane by an angle, rad."""
    c, s = float(np.cos(cone)), float(np.sin(cone))
    return Bend(c * c, s * s, s * c, s / 2, c / 2)


def parabola(rise: float) -> Bend:
    """Tethers that bend as z = z_tip (x / x_tip)^2. rise : z_tip over x_tip."""
    nodes, weights = np.polynomial.legendre.leggauss(POINTS)
    x = 0.5 * (nodes + 1)
    z, slope = rise * x * x, np.arctan(2 * rise * x)
    piece = 0.5 * weights / np.cos(slope)
    length = piece.sum()
    c, s = np.cos(slope), np.sin(slope)
    across = z * c - x * s
    means = (c * c, s * s, s * c, (z - 0.5 * c * across) / length, (x + s * across) / length)
    return Bend(*(float((piece * value).sum() / length) for value in means))


@inlined
def wheel_parts(ux, uy, uz, nx, ny, nz, turn_x, turn_y, turn_z, blows, spin, wheel):
    """(force over N sigma L, three; torque that the bend makes over N sigma L^2; size of E) of a wheel of Numbers.
    u : way of the wind; n : axis, with u . n >= 0; turn : rate of the axis, 1/s; blows : share of the thrust at 1 au
    over the distance, 1/m; spin : rad/s."""
    c = ux * nx + uy * ny + uz * nz
    # n x u
    qx, qy, qz = ny * uz - nz * uy, nz * ux - nx * uz, nx * uy - ny * ux
    tx, ty, tz = wheel.torque * qx, wheel.torque * qy, wheel.torque * qz
    ex, ey, ez, e = 0.0, 0.0, 0.0, 0.0
    if wheel.held != 0.0:
        k = 0.0
        if wheel.inertia > 0.0:
            k = wheel.inertia * spin / (wheel.lever * blows)
        wx, wy, wz = tx - k * turn_x, ty - k * turn_y, tz - k * turn_z
        f = 2.0 / (max(c, 1e-12) * wheel.arm)
        wx, wy, wz = f * wx, f * wy, f * wz
        ex, ey, ez = wy * nz - wz * ny, wz * nx - wx * nz, wx * ny - wy * nx  # - n x w
        e = np.sqrt(ex * ex + ey * ey + ez * ez)
    along = ex * ux + ey * uy + ez * uz
    a, b, h = 1.0 - 0.5 * wheel.cosine, (0.5 * wheel.cosine - wheel.sine) * c, 0.5 * wheel.both
    k = 1.0 / (1.0 + e)
    fx = k * (a * ux + (b - h * along) * nx - h * c * ex)
    fy = k * (a * uy + (b - h * along) * ny - h * c * ey)
    fz = k * (a * uz + (b - h * along) * nz - h * c * ez)
    return fx, fy, fz, np.sqrt(tx * tx + ty * ty + tz * tz), e


def wheel_force(
    bend: float | Bend, pitch: npt.ArrayLike, held: bool = True
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """(force along the wind and across it (..., 2) over N sigma L, torque over N sigma L^2, share of the voltage that
    holds the axis), each like pitch, rad. bend : cone angle, rad, or a Bend. held : whether the voltage holds the axis,
    every tether at the full voltage at most."""
    means = bend if isinstance(bend, Bend) else straight(bend)
    numbers = Numbers(1.0, *means, held=float(held))
    a = np.asarray(pitch, float)
    rows = [
        wheel_parts.py_func(1.0, 0.0, 0.0, np.cos(p), np.sin(p), 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, numbers)
        for p in a.ravel().tolist()
    ]
    force, torque, share = (np.array([row[part] for row in rows]) for part in (slice(2), 3, 4))
    return force.reshape(*a.shape, 2), torque.reshape(a.shape), share.reshape(a.shape)


def spin_up(pitch: npt.ArrayLike, way: npt.ArrayLike) -> np.ndarray:
    """Spin over that at the start after a way round the Sun, rad, at a steady pitch, rad, in the plane of the orbit,
    positive for a thrust forward: exp(tan(pitch) way)."""
    return np.asarray(np.exp(np.tan(pitch) * np.asarray(way, float)))
