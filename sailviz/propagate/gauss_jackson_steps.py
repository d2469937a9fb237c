"""Equal steps of the summed Gauss-Jackson method: its sums, its step rule, and steps with nothing in between.

What is here knows nothing of rows, events and kinks; gauss_jackson.py makes a run of it.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from sailviz.compiled import called, inlined, late
from sailviz.propagate import gauss_jackson_coefficients as c
from sailviz.propagate.dynamics import SIZE, derivative
from sailviz.propagate.events import off_level
from sailviz.propagate.gauss_jackson_coefficients import LAGS
from sailviz.propagate.stepping import NEW, W, Y

ANGLE = 0.067  # rad that the craft turns at periapsis in one step
LONGEST, SHORTEST = 1.025, 0.8  # bounds of a step over what the rule says now; outside them it is chosen anew
ERROR = 4e-12  # of the distance, at steps of ANGLE: that of the quintic between them, and so with the sixth power
LOOSEST, TIGHTEST = 0.6, 1.7  # refinement: beyond, eccentric orbits lose stability within a month, and rounding rules
SMALLEST_TOLERANCE = 1e-13  # that TIGHTEST is good for
CHECK = 32  # steps between two looks at the rule
LARGEST_ECCENTRICITY = 0.15  # beyond, and where other forces exceed STRONG of gravity, DOP853 makes the steps
STRONG = 0.02
DISTRUST = 1e-7  # a jump of the acceleration, over the acceleration, that is left to DOP853
SEAM_TOLERANCE = 1e-14  # at most, of the DOP853 steps
SUBSTEPS = 4  # of DOP853 between two points of a start, at least; a power of two, see quantum_of

# places in Integration.counter after those that all integrators have
NEWEST, POINTS, SINCE = 9, 10, 11  # row of history, accelerations in it, steps since ANCHOR
# places in the row of numbers `grid`
ANCHOR, GRID_STEP, REFINEMENT = 0, 1, 2
FIRST_SUM, SECOND_SUM = 3, 9  # x, y, z and what rounding left of them
MIDDLE_STATE = 15  # position and velocity at the middle of the points
HISTORY = 512  # rows, of which the last LAGS count


class Multistep(NamedTuple):
    """Everything that an integration remembers between calls."""

    work: np.ndarray  # the first four as in stepping.Integration
    counter: np.ndarray
    sign: np.ndarray
    event: np.ndarray
    history: np.ndarray  # (HISTORY, 4) m/s2, accelerations at equal steps, oldest first, the fourth column 0
    grid: np.ndarray  # (21,) see the places above


weighted_sums = late("sailviz.propagate.intrinsics", "weighted_sums")
product_left = late("sailviz.propagate.intrinsics", "product_left")


@inlined
def two_sum(a, b):
    """a + b and what rounding left of it (Knuth)."""
    s = a + b
    d = s - a
    return s, (a - (s - d)) + (b - d)


@inlined
def angular_rate(y, mu):
    """(angular rate at the periapsis of the osculating orbit in rad/s, its eccentricity)."""
    r = np.sqrt(y[0] * y[0] + y[1] * y[1] + y[2] * y[2])
    hx, hy, hz = y[1] * y[5] - y[2] * y[4], y[2] * y[3] - y[0] * y[5], y[0] * y[4] - y[1] * y[3]
    p = (hx * hx + hy * hy + hz * hz) / mu
    v2 = y[3] * y[3] + y[4] * y[4] + y[5] * y[5]
    e = np.sqrt(max(0.0, 1.0 + p * (v2 / mu - 2.0 / r)))
    return np.sqrt(mu / (p * p * p)) * (1.0 + e) ** 2, e


def refinement_for(tolerance: float) -> float:
    """By what to divide the step ANGLE so that positions are within a tolerance of the distance for twenty revolutions
    and, but for rounding, a thousand. The longest steps make 1e-10; a wider tolerance gets that too."""
    return float(min(max((ERROR / tolerance) ** (1 / 6), LOOSEST), TIGHTEST))


@called
def step_rule(y, f, mu, refinement, largest_step):
    """(whether the multistep method suits the orbit, the step it should take in s). f = derivative at y."""
    rate, e = angular_rate(y, mu)
    r2 = y[0] * y[0] + y[1] * y[1] + y[2] * y[2]
    k = mu / (r2 * np.sqrt(r2))
    bx, by, bz = f[3] + k * y[0], f[4] + k * y[1], f[5] + k * y[2]
    other = (bx * bx + by * by + bz * bz) * r2 * r2 / (mu * mu)  # of all forces but the central one, squared
    suits = e < LARGEST_ECCENTRICITY and other < STRONG * STRONG
    return suits, min(ANGLE / refinement / rate, largest_step)


@inlined
def quantum_of(h):
    """The power of two of which a step of about h, and the time it starts from, are made multiples: then all times of
    the method are exact, and so is the square of the step. Rounding the points of a start by 1e-9 s, what a time of a
    year resolves, would cost 1e-7 of the radius."""
    return 2.0 ** (np.floor(np.log2(h)) - 19.0)


@inlined
def keep_acceleration(history, count, f):
    """Put the acceleration in f (7,) behind the others."""
    newest = count[NEWEST] + 1
    if count[POINTS] == 0:
        newest = 0
    elif newest == HISTORY:
        for i in range(LAGS):
            for j in range(3):
                history[i, j] = history[HISTORY - LAGS + i, j]
        newest = LAGS
    for j in range(3):
        history[newest, j] = f[3 + j]
    count[NEWEST] = newest
    count[POINTS] += 1


@called
def begin_sums(history, newest, grid):
    """The two sums that make the correctors give the state kept at the middle of the points, carried to the newest."""
    h = grid[GRID_STEP]
    for j in range(3):
        p = v = 0.0
        for i in range(LAGS):
            p += c.POSITION_START[i] * history[newest - i, j]
            v += c.VELOCITY_START[i] * history[newest - i, j]
        first, first_left = two_sum(grid[MIDDLE_STATE + 3 + j] / h, -v)
        second, second_left = two_sum(grid[MIDDLE_STATE + j] / (h * h), -p)  # still of the point before the middle
        for i in range(c.MIDDLE, -1, -1):
            if i < c.MIDDLE:
                first, left = two_sum(first, history[newest - i, j])
                first_left += left
            second, left = two_sum(second, first)
            second_left += left + first_left
        grid[FIRST_SUM + j], grid[FIRST_SUM + 3 + j] = first, first_left
        grid[SECOND_SUM + j], grid[SECOND_SUM + 3 + j] = second, second_left


@inlined
def quintic(y, f, new, g, h, m):
    """m (8, SIZE): the polynomial of the step from state y with derivative f to new with g."""
    for j in range(3):
        v0, v1 = h * y[3 + j], h * new[3 + j]
        a0, a1 = h * h * f[3 + j], h * h * g[3 + j]
        d, dv, da = new[j] - y[j] - v0 - 0.5 * a0, v1 - v0 - a0, a1 - a0
        c3, c4, c5 = 10.0 * d - 4.0 * dv + 0.5 * da, 7.0 * dv - 15.0 * d - da, 6.0 * d - 3.0 * dv + 0.5 * da
        m[0, j], m[1, j], m[2, j], m[3, j], m[4, j], m[5, j] = y[j], v0, 0.5 * a0, c3, c4, c5
        m[0, 3 + j], m[1, 3 + j], m[2, 3 + j] = y[3 + j], h * f[3 + j], 3.0 * c3 / h
        m[3, 3 + j], m[4, 3 + j], m[5, 3 + j] = 4.0 * c4 / h, 5.0 * c5 / h, 0.0
    for j in range(SIZE):
        m[6, j] = m[7, j] = 0.0
    for i in range(1, 6):
        m[i, 6] = 0.0
    m[0, 6] = y[6]


@inlined
def coast(s, history, grid, watch, row_time, limit, factor, perturbations, near, p):
    """Steps up to the one that contains row_time, in which something watched may happen, after which the rule is due,
    or that would come too near to limit. Leaves in s.work: Y and k[0], state and derivative at the start of the last
    step, NEW and k[12] at its end. Returns the steps made; none where the acceleration jumps at the first."""
    k, count, mu = s.work, s.counter, p.gravity.mu
    w, f = k[W], k[12]
    newest, since = count[NEWEST], count[SINCE]
    anchor, h = grid[ANCHOR], grid[GRID_STEP]
    h2 = h * h
    new = h2 * (c.POSITION_NEW + c.POSITION_NEW_LEFT)
    s1x, s1y, s1z = grid[FIRST_SUM], grid[FIRST_SUM + 1], grid[FIRST_SUM + 2]
    l1x, l1y, l1z = grid[FIRST_SUM + 3], grid[FIRST_SUM + 4], grid[FIRST_SUM + 5]
    s2x, s2y, s2z = grid[SECOND_SUM], grid[SECOND_SUM + 1], grid[SECOND_SUM + 2]
    l2x, l2y, l2z = grid[SECOND_SUM + 3], grid[SECOND_SUM + 4], grid[SECOND_SUM + 5]
    if since % CHECK == 0:  # what the small parts have gathered
        s1x, l1x = two_sum(s1x, l1x)
        s1y, l1y = two_sum(s1y, l1y)
        s1z, l1z = two_sum(s1z, l1z)
        s2x, l2x = two_sum(s2x, l2x)
        s2y, l2y = two_sum(s2y, l2y)
        s2z, l2z = two_sum(s2z, l2z)
    x0, y0, z0, u0, v0, w0 = k[Y, 0], k[Y, 1], k[Y, 2], k[Y, 3], k[Y, 4], k[Y, 5]
    x, y, z, u, v, ww = x0, y0, z0, u0, v0, w0
    ax, ay, az = k[0, 3], k[0, 4], k[0, 5]
    bx, by, bz = ax, ay, az
    w[6] = k[Y, 6]
    made = 0
    watched = len(watch.kind)
    first = since
    while True:
        t = anchor + (since + 1) * h
        if t > limit:
            break
        px, py, pz, qx, qy, qz, ex, ey, ez, ox, oy, oz = weighted_sums(history, newest)
        # position, and what rounding leaves of it
        mx, rx = two_sum(s2x, l2x + px)
        my, ry = two_sum(s2y, l2y + py)
        mz, rz = two_sum(s2z, l2z + pz)
        ox += c.POSITION_SECOND_LEFT * history[newest, 0] - px
        oy += c.POSITION_SECOND_LEFT * history[newest, 1] - py
        oz += c.POSITION_SECOND_LEFT * history[newest, 2] - pz
        px, py, pz = h2 * mx, h2 * my, h2 * mz
        ox, oy, oz = h2 * (ox + rx), h2 * (oy + ry), h2 * (oz + rz)
        ox += product_left(h2, mx, px)
        oy += product_left(h2, my, py)
        oz += product_left(h2, mz, pz)
        qx, qy, qz = h * (s1x + (l1x + qx)), h * (s1y + (l1y + qy)), h * (s1z + (l1z + qz))
        w[0], w[1], w[2], w[3], w[4], w[5] = px, py, pz, qx, qy, qz
        inverse2 = 1.0 / (px * px + py * py + pz * pz)
        attraction = mu * inverse2 * np.sqrt(inverse2)
        derivative(t, w, factor, perturbations, f)
        tx, ty, tz = attraction * px, attraction * py, attraction * pz
        cx, cy, cz = f[3] - tx, f[4] - ty, f[5] - tz
        dx, dy, dz = cx - ex, cy - ey, cz - ez
        if not (dx * dx + dy * dy + dz * dz <= DISTRUST * DISTRUST * (cx * cx + cy * cy + cz * cz)):
            break
        x0, y0, z0, u0, v0, w0, ax, ay, az = x, y, z, u, v, ww, bx, by, bz
        gx, gy, gz = ox + new * cx, oy + new * cy, oz + new * cz
        x, y, z = px + gx, py + gy, pz + gz
        u = qx + h * c.VELOCITY_CORRECTION * dx
        v = qy + h * c.VELOCITY_CORRECTION * dy
        ww = qz + h * c.VELOCITY_CORRECTION * dz
        along = 3.0 * (px * gx + py * gy + pz * gz) * inverse2
        fx, fy, fz = attraction * (gx - along * px), attraction * (gy - along * py), attraction * (gz - along * pz)
        bx, by, bz = cx - fx, cy - fy, cz - fz
        # everything beside the attraction rounded to a double, for the sums
        fx = f[3] - product_left(attraction, px, tx) - fx
        fy = f[4] - product_left(attraction, py, ty) - fy
        fz = f[5] - product_left(attraction, pz, tz) - fz
        newest += 1
        if newest == HISTORY:
            for i in range(LAGS):
                for j in range(3):
                    history[i, j] = history[HISTORY - LAGS + i, j]
            newest = LAGS
        history[newest, 0], history[newest, 1], history[newest, 2] = bx, by, bz
        s1x, e1 = two_sum(s1x, -tx)
        s1y, e2 = two_sum(s1y, -ty)
        s1z, e3 = two_sum(s1z, -tz)
        l1x, l1y, l1z = l1x + (e1 + fx), l1y + (e2 + fy), l1z + (e3 + fz)
        s2x, e1 = two_sum(s2x, s1x)
        s2y, e2 = two_sum(s2y, s1y)
        s2z, e3 = two_sum(s2z, s1z)
        l2x, l2y, l2z = l2x + (e1 + l1x), l2y + (e2 + l1y), l2z + (e3 + l1z)
        since += 1
        made += 1
        stop = t >= row_time or since % CHECK == 0 or x * x + y * y + z * z < near
        if watched > 0:
            w[0], w[1], w[2], w[3], w[4], w[5] = x, y, z, u, v, ww
            for e in range(watched):
                now = off_level(watch.kind[e], watch.level[e], t, w, factor, p)
                stop = stop or s.sign[e] == 0.0 or (now < 0.0) != (s.sign[e] < 0.0)
        if stop:
            break
    if since > first:
        k[Y, 0], k[Y, 1], k[Y, 2], k[Y, 3], k[Y, 4], k[Y, 5] = x0, y0, z0, u0, v0, w0
        k[0, 0], k[0, 1], k[0, 2], k[0, 3], k[0, 4], k[0, 5], k[0, 6] = u0, v0, w0, ax, ay, az, 0.0
        k[NEW, 0], k[NEW, 1], k[NEW, 2], k[NEW, 3], k[NEW, 4], k[NEW, 5], k[NEW, 6] = x, y, z, u, v, ww, k[Y, 6]
        f[0], f[1], f[2], f[3], f[4], f[5], f[6] = u, v, ww, bx, by, bz, 0.0
        grid[FIRST_SUM], grid[FIRST_SUM + 1], grid[FIRST_SUM + 2] = s1x, s1y, s1z
        grid[FIRST_SUM + 3], grid[FIRST_SUM + 4], grid[FIRST_SUM + 5] = l1x, l1y, l1z
        grid[SECOND_SUM], grid[SECOND_SUM + 1], grid[SECOND_SUM + 2] = s2x, s2y, s2z
        grid[SECOND_SUM + 3], grid[SECOND_SUM + 4], grid[SECOND_SUM + 5] = l2x, l2y, l2z
        count[NEWEST], count[SINCE] = newest, since
    return made
