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

from sailviz.compiled import inlined, late
from sailviz.constants import AU
from sailviz.environment.gravity import gravity
from sailviz.propagate.dynamics import SIZE, derivative
from sailviz.propagate.gauss_legendre import tables
from sailviz.propagate.parameters import array_at
from sailviz.propagate.stepping import NEW, W, Y
from sailviz.propulsion.devices import ELECTRIC_SAIL, NO_DEVICE, SOLAR_SAIL
from sailviz.propulsion.electric_sail import ORIGINAL, esail_parts
from sailviz.propulsion.solar_sail import sail_parts
from sailviz.steering import attitude

POWERS = 10  # of s = 2 x - 1 in the polynomial of a step, x its share that is over

# places in the row of numbers `nodes`, eight numbers each
FORCE = 0  # accelerations x, y, z at the nodes and the mass rate
BEFORE = 32  # of the last step: monomial coefficients in s of the same
PLACE = 64  # positions and velocities at the nodes, where the force is evaluated one by one
PARTS = 112  # of the thrust at the nodes: along r_hat and along the normal, as at unit distance; the normal's direction
REST = 152  # what rounding left of position, velocity and mass at the start of the step
MIDDLE, HALF, HELD = 160, 161, 162  # of the last step: its middle, s, half of its length, s; whether there is one
CLOSEST = 163  # m, least distance from the centre of the last step's nodes
LAST_STEP, LAST_ERROR = 164, 165  # of the last step that was not cut: its length, s, its error over what is bearable
SPAN = 166  # s, of the whole run
NODE = 168  # x of the nodes
MASS = 176  # mass and its rate at the nodes
CHANGE = 192  # of the accelerations at the nodes
DENSE = 216  # (SIZE, POWERS) monomial coefficients in s of the last step's polynomial
LENGTH = 288

MOST_SWEEPS = 25
ROUNDING = 1e-28  # of accelerations, squared, over themselves: no sweep makes it smaller
CORRECTIONS = 1  # to first order, after each evaluation of the forces

LANES = "sailviz.propagate.lanes"
load, store, spread, lane = (late(LANES, name) for name in ("load", "store", "spread", "first"))
total, smallest = late(LANES, "total"), late(LANES, "smallest")

node = late(LANES, "constant", lambda: tables().node)
end_velocity = late(LANES, "constant", lambda: tables().end_velocity)
end_position = late(LANES, "constant", lambda: tables().end_position)
second, highest = (late(LANES, "constant", lambda k=k: tables().highest[k]) for k in (0, 1))
velocity_sum = late(LANES, "product_with", lambda: tables().velocity)
position_sum = late(LANES, "product_with", lambda: tables().position)
monomials = late(LANES, "product_with", lambda: tables().monomial)
# integrals of s^k, and what makes them begin at s = -1
once = late(LANES, "constant", lambda: 1 / np.arange(1.0, 9.0))
twice = late(LANES, "constant", lambda: 1 / (np.arange(1.0, 9.0) * np.arange(2.0, 10.0)))
once_left = late(LANES, "constant", lambda: (-1.0) ** np.arange(8) / np.arange(1.0, 9.0))
twice_left = late(LANES, "constant", lambda: (-1.0) ** np.arange(8) / (np.arange(1.0, 9.0) * np.arange(2.0, 10.0)))


@inlined
def fits_lanes(p):
    """Whether the forces of a record of PARAMETERS can be evaluated at eight nodes at once."""
    device, steering, callbacks = p.kinds.device, p.kinds.steering, p.callbacks
    if p.third_body.mu != 0.0 or p.air.kind != 0 or callbacks.forces != 0 or callbacks.user_force != 0:
        return False
    if device == NO_DEVICE:
        return True
    if device != SOLAR_SAIL and device != ELECTRIC_SAIL:
        return False
    return is_table(steering) or (
        steering == attitude.RADIAL
        or steering == attitude.ORBITAL
        or steering == attitude.MERIDIAN
        or steering == attitude.TRANSVERSE
    )


@inlined
def is_table(steering):
    return steering == attitude.TABLE_ORBITAL or steering == attitude.TABLE_MERIDIAN


@inlined
def prepare(nodes, t, h, factor, p):
    """The parts of the thrust at the nodes of [t, t + h], and the normal's components in its frame: they depend on
    time alone."""
    n_r, n_t, n_h = 1.0, 0.0, 0.0
    kind, device, throttle = p.kinds.steering, p.kinds.device, 1.0
    if kind == attitude.ORBITAL or kind == attitude.MERIDIAN:
        n_r, n_t, n_h = p.components.radial, p.components.transverse, p.components.normal
    elif kind == attitude.TRANSVERSE:
        n_r, n_t = 0.0, 1.0
    for i in range(8):
        if is_table(kind):
            alpha, delta, throttle = attitude.table_row(
                t + h * nodes[NODE + i], array_at(p.places.address, p.places.end), p.places.steering, p.table.rows,
                p.table.interpolation,
            )  # fmt: skip
            n_r, n_t, n_h = np.cos(alpha), np.sin(alpha) * np.sin(delta), np.sin(alpha) * np.cos(delta)
        along, across = 0.0, 0.0
        if device == SOLAR_SAIL:
            sail = p.solar_sail
            along, across = sail_parts(n_r, factor * throttle * sail.strength, sail.b1, sail.b2, sail.b3)
        elif device == ELECTRIC_SAIL:
            esail = p.electric_sail
            ac = factor * throttle * esail.characteristic_acceleration
            along, across = esail_parts(n_r, ac, int(esail.model), esail.pitch_limit)
        if kind == attitude.RADIAL:
            along, across = along + across, 0.0
        nodes[PARTS + i], nodes[PARTS + 8 + i] = along, across
        nodes[PARTS + 16 + i], nodes[PARTS + 24 + i], nodes[PARTS + 32 + i] = n_r, n_t, n_h


@inlined
def forces_at_once(nodes, x, y, z, vx, vy, vz, factor, p):
    """Accelerations at the nodes, of the forces that `fits_lanes` allows."""
    inverse = 1.0 / np.sqrt(x * x + y * y + z * z)
    g = p.gravity
    ax, ay, az = gravity(x, y, z, inverse, g.mu, g.j2_strength, g.j3_strength, g.j4_strength)
    if p.kinds.device == NO_DEVICE or factor == 0.0:
        return ax, ay, az
    if p.kinds.device == SOLAR_SAIL:
        fall = inverse * inverse
    elif p.electric_sail.model == ORIGINAL:
        fall = (AU * inverse) ** (7.0 / 6.0)
    else:
        fall = AU * inverse
    ux, uy, uz = x * inverse, y * inverse, z * inverse
    along, across = fall * load(nodes, PARTS), fall * load(nodes, PARTS + 8)
    ax, ay, az = ax + along * ux, ay + along * uy, az + along * uz
    kind = p.kinds.steering
    if kind == attitude.RADIAL:
        return ax, ay, az
    n_r, n_t, n_h = load(nodes, PARTS + 16), load(nodes, PARTS + 24), load(nodes, PARTS + 32)
    if kind == attitude.MERIDIAN or kind == attitude.TABLE_MERIDIAN:
        nx, ny, nz = attitude.meridian_direction(ux, uy, uz, n_r, n_t, n_h)
    else:
        nx, ny, nz = attitude.orbital_direction(ux, uy, uz, x, y, z, vx, vy, vz, n_r, n_t, n_h)
    return ax + across * nx, ay + across * ny, az + across * nz


@inlined
def forces_one_by_one(nodes, work, t, h, x, y, z, vx, vy, vz, factor, p, burns):
    """The same for every model, and the mass rates."""
    store(nodes, PLACE, x)
    store(nodes, PLACE + 8, y)
    store(nodes, PLACE + 16, z)
    store(nodes, PLACE + 24, vx)
    store(nodes, PLACE + 32, vy)
    store(nodes, PLACE + 40, vz)
    state, rate = work[W], work[0]
    mass = work[Y, 6]
    if burns:
        store(nodes, MASS, mass + h * velocity_sum(nodes, FORCE + 24))
    for i in range(8):
        for j in range(6):
            state[j] = nodes[PLACE + 8 * j + i]
        state[6] = nodes[MASS + i] if burns else mass
        derivative(t + h * nodes[NODE + i], state, factor, p, rate)
        for j in range(3):
            nodes[PLACE + 8 * j + i] = rate[3 + j]
        nodes[MASS + i] = rate[6]
    return load(nodes, PLACE), load(nodes, PLACE + 8), load(nodes, PLACE + 16)


@inlined
def continued(nodes, s, component):
    """The accelerations of the last step's polynomial at s, of it."""
    m = BEFORE + 8 * component
    value = spread(nodes[m + 7])
    for k in range(6, -1, -1):
        value = value * s + nodes[m + k]
    return value


@inlined
def first_guess(nodes, t, h, y, mu):
    """Accelerations at the nodes of [t, t + h]: those of the last step, continued, or at first of a circle."""
    if nodes[HELD] != 0.0:
        s = (t - nodes[MIDDLE] + h * node()) / nodes[HALF]
        return continued(nodes, s, 0), continued(nodes, s, 1), continued(nodes, s, 2)
    r2 = y[0] * y[0] + y[1] * y[1] + y[2] * y[2]
    rate = np.sqrt(mu / (r2 * np.sqrt(r2)))
    for i in range(8):
        angle = rate * h * nodes[NODE + i]
        c, s = -rate * rate * np.cos(angle), -rate * np.sin(angle)
        for j in range(3):
            nodes[FORCE + 8 * j + i] = c * y[j] + s * y[3 + j]
    return load(nodes, FORCE), load(nodes, FORCE + 8), load(nodes, FORCE + 16)


@inlined
def corrected(nodes, x, y, z, rx, ry, rz, h2, mu):
    """The change of the accelerations that makes them fit the path, from what they lack now, to first order in the
    central attraction: everything else changes a hundred times less. It costs a third of a sweep and spares four in
    ten (on the sail of tests/bench 117 are left of 184)."""
    cx, cy, cz = rx, ry, rz
    inverse = 1.0 / np.sqrt(x * x + y * y + z * z)
    inverse2 = inverse * inverse
    k = -mu * h2 * inverse2 * inverse
    for _ in range(CORRECTIONS):
        store(nodes, CHANGE, cx)
        store(nodes, CHANGE + 8, cy)
        store(nodes, CHANGE + 16, cz)
        dx, dy, dz = position_sum(nodes, CHANGE), position_sum(nodes, CHANGE + 8), position_sum(nodes, CHANGE + 16)
        along = 3.0 * inverse2 * (x * dx + y * dy + z * dz)
        cx, cy, cz = rx + k * (dx - along * x), ry + k * (dy - along * y), rz + k * (dz - along * z)
    return cx, cy, cz


@inlined
def sweep(nodes, work, t, h, enough, at_once, burns, factor, p):
    """Fit accelerations and path over [t, t + h]. enough : m2/s4, of the change of all accelerations together, squared.
    Returns whether they agree, and the number of sweeps."""
    y = work[Y]
    x0, y0, z0, u0, v0, w0 = y[0], y[1], y[2], y[3], y[4], y[5]
    fx, fy, fz = first_guess(nodes, t, h, y, p.gravity.mu)
    if burns and nodes[HELD] == 0.0:
        store(nodes, FORCE + 24, spread(0.0))
    before, sweeps = 0.0, 0
    h2, hc = h * h, h * node()
    while True:
        store(nodes, FORCE, fx)
        store(nodes, FORCE + 8, fy)
        store(nodes, FORCE + 16, fz)
        x = x0 + (hc * u0 + h2 * position_sum(nodes, FORCE))
        yy = y0 + (hc * v0 + h2 * position_sum(nodes, FORCE + 8))
        z = z0 + (hc * w0 + h2 * position_sum(nodes, FORCE + 16))
        vx = u0 + h * velocity_sum(nodes, FORCE)
        vy = v0 + h * velocity_sum(nodes, FORCE + 8)
        vz = w0 + h * velocity_sum(nodes, FORCE + 16)
        if at_once:
            gx, gy, gz = forces_at_once(nodes, x, yy, z, vx, vy, vz, factor, p)
        else:
            gx, gy, gz = forces_one_by_one(nodes, work, t, h, x, yy, z, vx, vy, vz, factor, p, burns)
        cx, cy, cz = corrected(nodes, x, yy, z, gx - fx, gy - fy, gz - fz, h2, p.gravity.mu)
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
    store(nodes, FORCE, fx)
    store(nodes, FORCE + 8, fy)
    store(nodes, FORCE + 16, fz)
    nodes[CLOSEST] = np.sqrt(smallest(x * x + yy * yy + z * z))
    return True, sweeps


@inlined
def missing(nodes, h, r, mass, burns):
    """How far the position strays between the nodes, m: the first Legendre coefficient of the accelerations that eight
    nodes do not see, as the last two have it in geometric sequence, integrated twice. A mass that strays by a share of
    itself counts like a position that strays by this share of the distance r."""
    a7 = a6 = 0.0
    for c in range(3):
        f = load(nodes, FORCE + 8 * c)
        last, one_before = total(highest() * f), total(second() * f)
        a7, a6 = a7 + last * last, a6 + one_before * one_before
    strays = 0.0 if a7 == 0.0 else a7 / np.sqrt(max(a6, a7)) * h * h / 1020.0  # 15 17 4
    if burns:
        f = load(nodes, FORCE + 24)
        last, one_before = abs(total(highest() * f)), abs(total(second() * f))
        if last > 0.0:
            strays += last / max(one_before, last) * last * h / 34.0 * (r / mass)  # 17 2
    return strays


@inlined
def keep_polynomial(nodes, work, t, h, burns):
    """The step's polynomial in s, and that of the accelerations for the next step."""
    half = 0.5 * h
    y = work[Y]
    for c in range(3):
        a = monomials(nodes, FORCE + 8 * c)
        store(nodes, BEFORE + 8 * c, a)
        place, speed = DENSE + POWERS * c, DENSE + POWERS * (3 + c)
        store(nodes, speed + 1, half * (a * once()))
        store(nodes, place + 2, half * half * (a * twice()))
        nodes[speed] = y[3 + c] + half * total(a * once_left())
        nodes[place + 1] = half * nodes[speed]
        nodes[place] = y[c] + nodes[place + 1] - half * half * total(a * twice_left())
    mass = DENSE + POWERS * 6
    nodes[mass] = y[6]
    if burns:
        a = monomials(nodes, FORCE + 24)
        store(nodes, mass + 1, half * (a * once()))
        nodes[mass] = y[6] + half * total(a * once_left())
    nodes[MIDDLE], nodes[HALF], nodes[HELD] = t + half, half, 1.0


@inlined
def by_powers(nodes, polynomial):
    """The polynomial as `stepping.evaluate` wants it: (POWERS, SIZE)."""
    for k in range(POWERS):
        for j in range(SIZE):
            polynomial[k, j] = nodes[DENSE + POWERS * j + k]


@inlined
def keep_end(nodes, work, h, burns, fits):
    """The state at the end of the step, in the row NEW, with what rounding leaves of it; where nothing fits it stays as
    it is."""
    y, new = work[Y], work[NEW]
    if not fits:
        for c in range(6):
            nodes[REST + c] = 0.0
        return
    for c in range(3):
        f = load(nodes, FORCE + 8 * c)
        rest = nodes[REST + 3 + c]
        step = h * (y[3 + c] + h * total(end_position() * f)) + (nodes[REST + c] + h * rest)
        new[c] = y[c] + step
        nodes[REST + c] = (y[c] - new[c]) + step
        step = h * total(end_velocity() * f) + rest
        new[3 + c] = y[3 + c] + step
        nodes[REST + 3 + c] = (y[3 + c] - new[3 + c]) + step
    new[6] = y[6]
    if burns:
        new[6] = y[6] + h * total(end_velocity() * load(nodes, FORCE + 24))


@inlined
def fill_rows(nodes, t_out, out, first, last):
    """Rows first..last of out (components, n) at the times t_out (n,) from the polynomial of the last step, sixteen at
    once as far as there is room for them: what is filled beyond the step is overwritten by the next."""
    middle, inverse = nodes[MIDDLE], 1.0 / nodes[HALF]
    i = first
    while i < last:
        several = i + 16 <= len(t_out)
        a = ((load(t_out, i) if several else spread(t_out[i])) - middle) * inverse
        b = ((load(t_out, i + 8) if several else spread(t_out[i])) - middle) * inverse
        for j in range(out.shape[0]):
            m = DENSE + POWERS * j + POWERS - 1
            p, q = nodes[m - 1] + a * nodes[m], nodes[m - 1] + b * nodes[m]
            for k in range(2, POWERS):
                c = nodes[m - k]
                p, q = c + a * p, c + b * q
            if several:
                row = out[j]
                store(row, i, p)
                store(row, i + 8, q)
            else:
                out[j, i] = lane(p)
        i += 16 if several else 1


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
