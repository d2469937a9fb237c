"""Light on a shape whose film ages: the force of what it has become, and its dose, which the state carries in its
seventh place, where other crafts have their mass.

A film is linear in its coefficients, so that tables of one coefficient each, times what that has changed by, say all of
it (`shapes.light_table.with_age`); the dose is that of the whole film, by the share of it that its light falls on.

A device's callback: compiled when the first scene needs it. Its numbers: those of `shape_callback`, the table with
those of one coefficient behind it, then mass and fresh coefficients.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from sailviz.compiled import STATE, called, inlined
from sailviz.compiled.rebound import rebound
from sailviz.constants import AU
from sailviz.propagate import body_motion
from sailviz.propagate.body_control import CHANGE, DEVICE, FRONT_OF_VANE, OFF, VANE
from sailviz.propagate.body_motion import AGED, AVERAGED, HEAD, SIZE, SLIDE, WORK, Q, Y, body_of, cross, spin_axis
from sailviz.propagate.callbacks import Callback, callback
from sailviz.propagate.film_callback import light_at as sunlight_at
from sailviz.propagate.parameters import PARAMETERS, array_at, record_at
from sailviz.propagate.shape_callback import COS, PUSH, SIN, TABLE, rolled_axes
from sailviz.propulsion import shaped_sail
from sailviz.propulsion.film_ageing import aged_coefficients, coefficients, worn
from sailviz.propulsion.rigid_body import axes_of
from sailviz.propulsion.shaped_sail import CHANGES, GROUPS, aged_push, exposure

AU2 = AU * AU
MASS, FRESH = 0, 1  # behind the tables: kg; b1, b2, b3 of the fresh film's front, b3 of its back


@called
def set_age(dose, p, mine):
    """What the tables of one coefficient count for at a dose, s."""
    film, at = p.film, TABLE + CHANGES
    groups = int(mine[TABLE + GROUPS])
    fresh = TABLE + (groups + 1) * shaped_sail.stride(mine, TABLE) + FRESH
    b1, b2, b3 = aged_coefficients(dose, film)
    mine[at], mine[at + 1], mine[at + 2] = b1 - mine[fresh], b2 - mine[fresh + 1], b3 - mine[fresh + 2]
    if groups > 3:  # a black back radiates less where the front does more
        _, gained = worn(dose, film.factor, film.rate)
        _, _, b3 = coefficients(0.0, 0.0, film.Bb, film.Bf, film.eb, gained * film.ef)
        mine[at + 3] = b3 - mine[fresh + 3]


@called
def age_actuators(first, vanes, devices, dose, p, tables, mine):
    """Vanes, whose two sides are the film's, and devices of switched reflectivity, which are the film while they are
    on, at its dose; after `set_age`. first : where their rows begin."""
    b1, b2, b3 = aged_coefficients(dose, p.film)
    groups = int(mine[TABLE + GROUPS])
    fresh = TABLE + (groups + 1) * shaped_sail.stride(mine, TABLE) + FRESH
    for i in range(vanes):
        f = first + VANE * i + FRONT_OF_VANE
        tables[f], tables[f + 1], tables[f + 2] = b1, b2, b3
        if groups > 3:
            tables[f + 5] = mine[fresh + 3] + mine[TABLE + CHANGES + 3]
    for i in range(devices):
        row = first + VANE * vanes + DEVICE * i
        d, off = row + CHANGE, row + OFF
        tables[d], tables[d + 1], tables[d + 2] = b1 - tables[off], b2 - tables[off + 1], b3 - tables[off + 2]


@inlined
def mass_in(mine):
    """kg."""
    return mine[TABLE + (int(mine[TABLE + GROUPS]) + 1) * shaped_sail.stride(mine, TABLE) + MASS]


def _thrust(time, state, parameters, own, number, out):
    """Acceleration, m/s2, of the light, and the rate of the dose, s of full sunlight at 1 au for each s."""
    p = record_at(parameters, PARAMETERS)
    y, tables, a = array_at(state, STATE), array_at(p.places.address, p.places.end), array_at(out, 4)
    mine = array_at(own, p.places.end)
    a[0], a[1], a[2], a[3] = 0.0, 0.0, 0.0, 0.0
    x, yy, z, nx, ny, nz = y[0], y[1], y[2], y[7], y[8], y[9]
    ux, uy, uz, near, share = sunlight_at(time, x, yy, z, p, tables)
    share = number * share
    if share > 0.0 and nx * nx + ny * ny + nz * nz > 0.0:
        set_age(y[6], p, mine)
        ex, ey, ez, gx, gy, gz = rolled_axes(x, yy, z, y[3], y[4], y[5], nx, ny, nz, mine[COS], mine[SIN])
        bx, by, bz = ux * ex + uy * ey + uz * ez, ux * gx + uy * gy + uz * gz, ux * nx + uy * ny + uz * nz
        fx, fy, fz, _, _, _ = aged_push(bx, by, bz, mine, TABLE)
        k = share * mine[PUSH] * near * near / mass_in(mine)
        a[0] = k * (fx * ex + fy * gx + fz * nx)
        a[1] = k * (fx * ey + fy * gy + fz * ny)
        a[2] = k * (fx * ez + fy * gz + fz * nz)
        film = p.film
        a[3] = share / film.level * film.brightness * AU2 * near * near * exposure(bx, by, bz, mine, TABLE)


@inlined
def flow_loads(ux, uy, uz, strength, cx, cy, cz, tables, at):
    """As `body_motion.flow_loads`, of a film that ages."""
    fx, fy, fz, tx, ty, tz = aged_push(ux, uy, uz, tables, at)
    ox, oy, oz = cross(cx, cy, cz, fx, fy, fz)
    return strength * fx, strength * fy, strength * fz, strength * (tx - ox), strength * (ty - oy), strength * (tz - oz)


turn_average = rebound([(called, body_motion.turn_average)], __name__, {"flow_loads": flow_loads})["turn_average"]


@called
def exposure_of_a_turn(axial, tables, at):
    """`exposure` over a turn about the z axis, along which the light has a component."""
    found, across, n = 0.0, np.sqrt(max(0.0, 1.0 - axial * axial)), body_motion.AZIMUTHS
    for i in range(n):
        found += exposure(across * np.cos(2.0 * np.pi * i / n), across * np.sin(2.0 * np.pi * i / n), axial, tables, at)
    return found / n


def _on_body(time, state, parameters, own, number, out):
    """What `body_motion.aged_light` reads, for a craft that turns as `point_normal` has left it."""
    p = record_at(parameters, PARAMETERS)
    y, tables, a = array_at(state, STATE), array_at(p.places.address, p.places.end), array_at(out, 4)
    mine, b = array_at(own, p.places.end), body_of(p)
    a[0], a[1], a[2], a[3] = 0.0, 0.0, 0.0, 0.0
    done, at = p.places.body + WORK + AGED, p.places.device + TABLE
    turned = tables[p.places.body + WORK + Y : p.places.body + WORK + Y + SIZE]
    ux, uy, uz, near, share = sunlight_at(time, y[0], y[1], y[2], p, tables)
    strength = number * share * mine[PUSH] * near * near
    rate = number * share / p.film.level * p.film.brightness * AU2 * near * near
    px, py, pz, tx, ty, tz = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    bx, by, bz = ux, uy, uz
    if strength != 0.0:
        set_age(y[6], p, mine)
        age_actuators(p.places.body + HEAD, int(b.vanes), int(b.devices), y[6], p, tables, mine)
    if b.motion == AVERAGED:
        zx, zy, zz = spin_axis(turned)
        if strength != 0.0:
            px, py, pz, tx, ty, tz = turn_average(ux, uy, uz, strength, zx, zy, zz, b, tables, at)
            rate = rate * exposure_of_a_turn(ux * zx + uy * zy + uz * zz, tables, at)
    else:
        ex, ey, ez, fx, fy, fz, gx, gy, gz = axes_of(turned[Q], turned[Q + 1], turned[Q + 2], turned[Q + 3])
        bx, by, bz = ux * ex + uy * ey + uz * ez, ux * fx + uy * fy + uz * fz, ux * gx + uy * gy + uz * gz
        if strength != 0.0:
            cx, cy = b.centre_x + b.slide_share * turned[SLIDE], b.centre_y + b.slide_share * turned[SLIDE + 1]
            px, py, pz, tx, ty, tz = flow_loads(bx, by, bz, strength, cx, cy, b.centre_z, tables, at)
            rate = rate * exposure(bx, by, bz, tables, at)
    tables[done], tables[done + 1], tables[done + 2] = px, py, pz
    tables[done + 3], tables[done + 4], tables[done + 5] = tx, ty, tz
    tables[done + 6], tables[done + 7], tables[done + 8], tables[done + 9] = bx, by, bz, strength
    tables[done + 10] = rate


def aged_shape_thrust(
    turns: bool, push: float, under_sky: bool, roll: float, table: Sequence[float], mass: float, fresh: Sequence[float]
) -> Callback:
    """A sail of a shape whose film ages. turns : whether its attitude has a motion of its own; push : 2 P r_E^2, N;
    roll : rad about the normal; table : of `light_table.with_age`; mass : kg; fresh : see FRESH."""
    head = [push, float(under_sky), float(np.cos(roll)), float(np.sin(roll))]
    return callback(_on_body if turns else _thrust, [*head, *table, mass, *fresh])
