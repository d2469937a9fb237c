"""The forces at the eight nodes of a step: at once where they can be, one by one by the right-hand side where not."""

from __future__ import annotations

import numpy as np

from sailviz.compiled import apart, inlined
from sailviz.constants import AU
from sailviz.environment import atmosphere
from sailviz.environment.atmosphere import exponential_air_drag
from sailviz.environment.gravity import gravity
from sailviz.propagate.collocation_memory import (
    FORCE,
    MASS,
    NODE,
    PARTS,
    PLACE,
    load,
    store,
    velocity_sum,
)
from sailviz.propagate.dynamics import derivative
from sailviz.propagate.parameters import array_at
from sailviz.propagate.stepping import W, Y
from sailviz.propulsion.devices import ELECTRIC_SAIL, NO_DEVICE, SOLAR_SAIL
from sailviz.propulsion.electric_sail import ORIGINAL, esail_parts
from sailviz.propulsion.solar_sail import sail_parts
from sailviz.steering import attitude


@inlined
def fits_lanes(p):
    """Whether the forces of a record of PARAMETERS can be evaluated at eight nodes at once."""
    device, steering, callbacks = p.kinds.device, p.kinds.steering, p.callbacks
    if callbacks.forces != 0 or callbacks.user_force != 0:
        return False
    if p.third_body.mu != 0.0 or p.air.kind > atmosphere.EXPONENTIAL:
        return False
    if device == NO_DEVICE:
        return True
    if device != SOLAR_SAIL and device != ELECTRIC_SAIL:
        return False
    return (
        steering == attitude.RADIAL
        or steering == attitude.ORBITAL
        or steering == attitude.MERIDIAN
        or steering == attitude.TRANSVERSE
        or steering == attitude.TABLE_ORBITAL
        or steering == attitude.TABLE_MERIDIAN
    )


@inlined
def is_table(steering):
    return steering == attitude.TABLE_ORBITAL or steering == attitude.TABLE_MERIDIAN


@apart
def prepare(nodes, t, h, factor, p):
    """The parts of the thrust at the nodes of [t, t + h], and the normal's components in its frame: they depend on
    time alone."""
    n_r, n_t, n_h = 1.0, 0.0, 0.0
    kind, device, throttle = p.kinds.steering, p.kinds.device, 1.0
    if kind == attitude.ORBITAL or kind == attitude.MERIDIAN:
        n_r, n_t, n_h = p.components.radial, p.components.transverse, p.components.normal
    elif kind == attitude.TRANSVERSE:
        n_r, n_t = 0.0, 1.0
    along, across, changes = 0.0, 0.0, is_table(kind)
    for i in range(8):
        if changes:
            alpha, delta, throttle = attitude.table_row(
                t + h * nodes[NODE + i], array_at(p.places.address, p.places.end), p.places.steering, p.table.rows,
                p.table.interpolation,
            )  # fmt: skip
            n_r, n_t, n_h = np.cos(alpha), np.sin(alpha) * np.sin(delta), np.sin(alpha) * np.cos(delta)
        if i == 0 or changes:
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
def forces_at_once(nodes, x, y, z, r, inverse, vx, vy, vz, mass, factor, p):
    """Accelerations at the nodes, of the forces that `fits_lanes` allows, besides the attraction by a point. r, inverse
    : the distance from the centre and its inverse."""
    g = p.gravity
    ax, ay, az = gravity(x, y, z, inverse, 0.0, g.j2_strength, g.j3_strength, g.j4_strength)
    if p.air.kind == atmosphere.EXPONENTIAL:
        bx, by, bz = exponential_air_drag(x, y, z, vx, vy, vz, mass, r, p.surface.rotation, p.air)
        ax, ay, az = ax + bx, ay + by, az + bz
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
