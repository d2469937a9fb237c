"""One step of the collocation: accelerations at eight Gauss nodes that fit the path which they make.

A step [t, t + h] keeps the accelerations at the eight Gauss-Legendre nodes. A sweep integrates the polynomial through
them twice, two products with constant tables, which gives position and velocity at the nodes; there the force is
evaluated, all eight at once where it can be (`lanes`), one by one by `derivative` where it cannot. The first guess is
the polynomial of the step before, continued. The state at the end is of order 16; the polynomial, of degree 9 in the
position, is the dense output and costs no evaluation of the force.

What is here knows nothing of rows, events and kinks; collocation.py makes a run of it.
"""

from __future__ import annotations

import numpy as np

from sailviz.compiled import apart, inlined
from sailviz.propagate.collocation_forces import forces_at_once, forces_one_by_one
from sailviz.propagate.collocation_memory import (
    BEFORE,
    CHANGE,
    CLOSEST,
    DENSE,
    FORCE,
    FOUND,
    HALF,
    HELD,
    MASS,
    MIDDLE,
    PAST,
    PLACE,
    POWERS,
    REST,
    aligned_stack,
    end_position,
    end_velocity,
    following,
    lane,
    load,
    monomials,
    monomials_of_three,
    node,
    once,
    once_left,
    position_sums,
    position_sums_left,
    product_left,
    smallest,
    spread,
    store,
    total,
    twice,
    twice_left,
    velocity_sums,
)
from sailviz.propagate.collocation_rounding import exact_end, rounded_away
from sailviz.propagate.dynamics import SIZE
from sailviz.propagate.stepping import NEW, Y

MOST_SWEEPS = 25
SEVENTH, SIXTH = 16 / 429, 16 / 231  # what P_7 and P_6 have of s^7 and s^6, inverse
ROUNDING = 1e-28  # of accelerations, squared, over themselves: no sweep makes it smaller
NOISE = 1e-15  # of a coefficient over the whole, by rounding
FAR = 20.0  # halves of a step: beyond, its polynomial of degree seven continues rounding and nothing else
FARTHEST = 3.0  # rad that a first guess continues a circle
EQUAL = 1e-9  # of a step: the lengths of steps that differ by less are one
CORRECTIONS = 1  # to first order, after each evaluation of the forces


@inlined
def continued(nodes, s, component):
    """The accelerations of the last step's polynomial at s, of it."""
    m = BEFORE + 8 * component
    value = spread(nodes[m + 7])
    for k in range(6, -1, -1):
        value = value * s + nodes[m + k]
    return value


@inlined
def first_guess(nodes, t, h, y, mu, careful):
    """Accelerations at the nodes of [t, t + h]: those of the last one, continued; on long flights those of the last
    two, if they are as long; at first those of a circle. What two steps disagree by grows eighty million times."""
    if careful and nodes[HELD] == 2.0 and abs(h - 2.0 * nodes[HALF]) < EQUAL * h and t > nodes[MIDDLE]:
        return following(nodes, PAST)
    if nodes[HELD] != 0.0 and abs(h) < FAR * nodes[HALF]:
        s = (t - nodes[MIDDLE] + h * node()) / nodes[HALF]
        return continued(nodes, s, 0), continued(nodes, s, 1), continued(nodes, s, 2)
    r2 = y[0] * y[0] + y[1] * y[1] + y[2] * y[2]
    rate = np.sqrt(mu / (r2 * np.sqrt(r2)))
    angle = max(-FARTHEST, min(FARTHEST, rate * h)) * node()
    c, s = circular(angle)
    c, s = -rate * rate * c, -rate * s
    return c * y[0] + s * y[3], c * y[1] + s * y[4], c * y[2] + s * y[5]


@inlined
def circular(angle):
    """Cosine and sine of angles below three, to 6e-5: the first terms of their series, enough for a guess."""
    q = angle * angle
    c, s = spread(1.0), spread(1.0)
    for k in range(12, 0, -2):
        c, s = 1.0 - c * q * (1.0 / (k * (k - 1))), 1.0 - s * q * (1.0 / (k * (k + 1)))
    return c, angle * s


@inlined
def steeper(x, y, z, k, inverse2, dx, dy, dz):
    """The change of the central attraction k (x, y, z) over dx, dy, dz, to first order. inverse2 : 1 / r^2."""
    along = 3.0 * inverse2 * (x * dx + y * dy + z * dz)
    return k * (dx - along * x), k * (dy - along * y), k * (dz - along * z)


@inlined
def corrected(nodes, x, y, z, k, inverse2, rx, ry, rz, h2):
    """The change of the accelerations that makes them fit the path, from what they lack now, to first order in the
    central attraction: everything else changes a hundred times less. It costs a third of a sweep and spares four in
    ten (on the sail of tests/bench 117 are left of 184)."""
    cx, cy, cz = rx, ry, rz
    for _ in range(CORRECTIONS):
        store(nodes, CHANGE, cx)
        store(nodes, CHANGE + 8, cy)
        store(nodes, CHANGE + 16, cz)
        dx, dy, dz = position_sums(nodes, CHANGE)
        jx, jy, jz = steeper(x, y, z, k, inverse2, h2 * dx, h2 * dy, h2 * dz)
        cx, cy, cz = rx + jx, ry + jy, rz + jz
    return cx, cy, cz


@apart
def sweep(nodes, work, t, h, enough, at_once, burns, careful, factor, p):
    """Fit accelerations and path over [t, t + h]. enough : m2/s4, of the change of all accelerations together, squared.
    careful : keep what rounding takes. Returns whether they agree, and the number of sweeps."""
    aligned_stack()
    y = work[Y]
    x0, y0, z0, u0, v0, w0 = y[0], y[1], y[2], y[3], y[4], y[5]
    fx, fy, fz = first_guess(nodes, t, h, y, p.gravity.mu, careful)
    if burns:  # as in the last step, not as in one that came to nothing, which may be no number
        store(nodes, FORCE + 24, load(nodes, BEFORE + 24))
    before, sweeps = 0.0, 0
    h2, hc = h * h, h * node()
    while True:
        store(nodes, FORCE, fx)
        store(nodes, FORCE + 8, fy)
        store(nodes, FORCE + 16, fz)
        sx, sy, sz = position_sums(nodes, FORCE)
        x, yy, z = x0 + (hc * u0 + h2 * sx), y0 + (hc * v0 + h2 * sy), z0 + (hc * w0 + h2 * sz)
        vx, vy, vz = velocity_sums(nodes, FORCE)
        vx, vy, vz = u0 + h * vx, v0 + h * vy, w0 + h * vz
        r2 = x * x + yy * yy + z * z
        inverse = 1.0 / np.sqrt(r2)
        inverse2 = inverse * inverse
        pull = -p.gravity.mu * inverse2 * inverse
        if at_once:
            qx, qy, qz = forces_at_once(nodes, x, yy, z, r2 * inverse, inverse, vx, vy, vz, y[6], factor, p)
            px, py, pz = pull * x, pull * yy, pull * z
            gx, gy, gz = px + qx, py + qy, pz + qz
        else:
            gx, gy, gz = forces_one_by_one(nodes, work, t, h, x, yy, z, vx, vy, vz, factor, p, burns)
            px, py, pz = gx, gy, gz
            qx, qy, qz = spread(0.0), spread(0.0), spread(0.0)
        cx, cy, cz = corrected(nodes, x, yy, z, pull, inverse2, gx - fx, gy - fy, gz - fz, h2)
        change = total((gx - fx) * (gx - fx) + (gy - fy) * (gy - fy) + (gz - fz) * (gz - fz))
        if burns:  # the mass rate counts as the accelerations do: its share of the mass like theirs of the distance
            share = load(nodes, MASS) - load(nodes, FORCE + 24)
            weight = np.sqrt(x0 * x0 + y0 * y0 + z0 * z0) / (h * y[6])
            change += weight * weight * total(share * share)
            store(nodes, FORCE + 24, load(nodes, MASS))
            if not y[6] + h * total(end_velocity() * load(nodes, FORCE + 24)) > 0.0:
                return False, sweeps
        fx, fy, fz = fx + cx, fy + cy, fz + cz
        sweeps += 1
        # the next change would be smaller by as much as this one is
        if change < enough or (sweeps > 1 and change < before and change * change < enough * before):
            break
        if sweeps > 2 and not change < before:
            if change < ROUNDING * total(fx * fx + fy * fy + fz * fz):
                break
            return False, sweeps
        if sweeps >= MOST_SWEEPS or not change < 1e300:
            return False, sweeps
        before = change
    if careful:
        lx, ly, lz = position_sums_left(nodes, FORCE)
        lx = rounded_away(nodes, work, h, 0, x, sx, lx)
        ly = rounded_away(nodes, work, h, 1, yy, sy, ly)
        lz = rounded_away(nodes, work, h, 2, z, sz, lz)
        jx, jy, jz = steeper(x, yy, z, pull, inverse2, lx, ly, lz)
        store(nodes, CHANGE, cx + jx)
        store(nodes, CHANGE + 8, cy + jy)
        store(nodes, CHANGE + 16, cz + jz)
        dx, dy, dz = position_sums(nodes, CHANGE)
        jx, jy, jz = steeper(x, yy, z, pull, inverse2, h2 * dx + lx, h2 * dy + ly, h2 * dz + lz)
        if at_once:
            qx, qy = product_left(pull, x, px) + (qx + jx), product_left(pull, yy, py) + (qy + jy)
            qz = product_left(pull, z, pz) + (qz + jz)
        else:
            qx, qy, qz = jx, jy, jz
        store(nodes, CHANGE, qx)
        store(nodes, CHANGE + 8, qy)
        store(nodes, CHANGE + 16, qz)
        store(nodes, PLACE, px)
        store(nodes, PLACE + 8, py)
        store(nodes, PLACE + 16, pz)
        fx, fy, fz = gx + jx, gy + jy, gz + jz
    store(nodes, FORCE, fx)
    store(nodes, FORCE + 8, fy)
    store(nodes, FORCE + 16, fz)
    ax, ay, az = monomials_of_three(nodes, FORCE)
    store(nodes, FOUND, ax)
    store(nodes, FOUND + 8, ay)
    store(nodes, FOUND + 16, az)
    if burns:
        store(nodes, FOUND + 24, monomials(nodes, FORCE + 24))
    nodes[CLOSEST] = np.sqrt(smallest(r2))
    return True, sweeps


@inlined
def missing(nodes, h, r, mass, burns):
    """How far the position strays between the nodes, m: the first Legendre coefficient of the accelerations that eight
    nodes do not see, as the last two have it in geometric sequence, integrated twice. A mass that strays by a share of
    itself counts like a position that strays by this share of the distance r."""
    a7 = a6 = 0.0
    for c in range(3):
        last, one_before = nodes[FOUND + 8 * c + 7] * SEVENTH, nodes[FOUND + 8 * c + 6] * SIXTH
        a7, a6 = a7 + last * last, a6 + one_before * one_before
    strays = 0.0 if a7 == 0.0 else a7 / np.sqrt(max(a6, a7)) * h * h / 1020.0  # 15 17 4
    if burns:
        last, one_before = abs(nodes[FOUND + 31] * SEVENTH), abs(nodes[FOUND + 30] * SIXTH)
        last -= NOISE * abs(nodes[FOUND + 24])  # which counts much where little of the mass is left
        if last > 0.0:
            strays += last / max(one_before, last) * last * h / 34.0 * (r / mass)  # 17 2
    return strays


@inlined
def keep_polynomial(nodes, work, t, h, burns):
    """The step's polynomial in s, and that of the accelerations for the next step."""
    half = 0.5 * h
    y = work[Y]
    for c in range(3):
        a = load(nodes, FOUND + 8 * c)
        store(nodes, BEFORE + 8 * c, a)
        store(nodes, PAST + 16 * c, load(nodes, PAST + 16 * c + 8))
        store(nodes, PAST + 16 * c + 8, load(nodes, FORCE + 8 * c))
        place, speed = DENSE + POWERS * c, DENSE + POWERS * (3 + c)
        store(nodes, speed + 1, half * (a * once()))
        store(nodes, place + 2, half * half * (a * twice()))
        nodes[speed] = y[3 + c] + half * total(a * once_left())
        nodes[place + 1] = half * nodes[speed]
        nodes[place] = y[c] + nodes[place + 1] - half * half * total(a * twice_left())
    mass = DENSE + POWERS * 6
    nodes[mass] = y[6]
    if burns:
        a = load(nodes, FOUND + 24)
        store(nodes, BEFORE + 24, load(nodes, FORCE + 24))
        store(nodes, mass + 1, half * (a * once()))
        nodes[mass] = y[6] + half * total(a * once_left())
    nodes[HELD] = 2.0 if nodes[HELD] >= 1.0 and abs(half - nodes[HALF]) < EQUAL * half else 1.0
    nodes[MIDDLE], nodes[HALF] = t + half, half


@inlined
def by_powers(nodes, polynomial):
    """The polynomial as `step_events.evaluate` wants it: (POWERS, SIZE)."""
    for k in range(POWERS):
        for j in range(SIZE):
            polynomial[k, j] = nodes[DENSE + POWERS * j + k]


@inlined
def keep_end(nodes, work, h, burns, careful, fits):
    """The state at the end of the step, in the row NEW, with what rounding leaves of it; where nothing fits it stays as
    it is."""
    y, new = work[Y], work[NEW]
    if not fits:
        for c in range(6):
            nodes[REST + c] = 0.0
        return
    if careful:
        end, left = exact_end(nodes, h, y)
        store(nodes, REST, left)
        store(nodes, PLACE, end)
        for c in range(6):
            new[c] = nodes[PLACE + c]
    else:
        for c in range(3):
            rest, more_rest = nodes[REST + c], nodes[REST + 3 + c]
            f = load(nodes, FORCE + 8 * c)
            step = h * (y[3 + c] + h * total(end_position() * f)) + (rest + h * more_rest)
            new[c] = y[c] + step
            nodes[REST + c] = (y[c] - new[c]) + step
            step = h * total(end_velocity() * f) + more_rest
            new[3 + c] = y[3 + c] + step
            nodes[REST + 3 + c] = (y[3 + c] - new[3 + c]) + step
    new[6] = y[6]
    if burns:
        new[6] = y[6] + h * total(end_velocity() * load(nodes, FORCE + 24))


@inlined
def fill_rows(nodes, t_out, out, first, last):
    """Rows first..last of out (components, n) at the times t_out (n,) from the polynomial of the last step, sixteen or
    eight at once as far as there is room for them: what is filled beyond the step is overwritten by the next."""
    middle, inverse = nodes[MIDDLE], 1.0 / nodes[HALF]
    i, n = first, len(t_out)
    while last - i > 8 and i + 16 <= n:
        a, b = (load(t_out, i) - middle) * inverse, (load(t_out, i + 8) - middle) * inverse
        for j in range(out.shape[0]):
            m = DENSE + POWERS * j
            c = nodes[m + POWERS - 2]
            if j < 3:  # the others are of one degree less
                p, q = c + a * nodes[m + POWERS - 1], c + b * nodes[m + POWERS - 1]
            else:
                p, q = spread(c), spread(c)
            for k in range(POWERS - 3, -1, -1):
                c = nodes[m + k]
                p, q = c + a * p, c + b * q
            row = out[j]
            store(row, i, p)
            store(row, i + 8, q)
        i += 16
    while i < last:
        several = i + 8 <= n
        a = ((load(t_out, i) if several else spread(t_out[i])) - middle) * inverse
        for j in range(out.shape[0]):
            m = DENSE + POWERS * j + POWERS - 1
            p = nodes[m - 1] + a * nodes[m]
            for k in range(2, POWERS):
                p = nodes[m - k] + a * p
            if several:
                store(out[j], i, p)
            else:
                out[j, i] = lane(p)
        i += 8 if several else 1


@inlined
def rows_before(t_out, row, t):
    """The first row from this one on whose time is not before t: by doubling, then by halving."""
    n, stride, low = len(t_out), 16, row
    while low + stride < n and t_out[low + stride] < t:
        low += stride
        stride *= 2
    high = min(n, low + stride)
    while low < high:
        between = (low + high) // 2
        if t_out[between] < t:
            low = between + 1
        else:
            high = between
    return low
