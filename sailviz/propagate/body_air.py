"""Air on the facets of a craft that turns: a force of the environment that is told the attitude and tells its torque.

A callback, compiled when the first scene needs it. `body_motion.point_normal` leaves the state for it among the numbers
of the body, and finds there, at AIR: the force N and the torque N m about the centre of mass, along body axes, of an
averaged spin inertial; the drag N against the flow; the density kg/m3.
"""

from __future__ import annotations

from sailviz.compiled import STATE, called
from sailviz.propagate.body_motion import (
    AIR,
    AVERAGED,
    SIZE,
    SLIDE,
    WORK,
    Q,
    Y,
    body_of,
    flow_loads,
    spin_axis,
    turn_average,
)
from sailviz.propagate.callbacks import Callback, callback
from sailviz.propagate.parameters import PARAMETERS, array_at, record_at
from sailviz.propagate.quantity_callback import AIR_DRAG
from sailviz.propagate.shape_air_callback import TABLE, flow
from sailviz.propagate.sky_quantities import under_a_sky
from sailviz.propulsion.rigid_body import axes_of

DRAG, DENSITY = 6, 7  # at AIR, after force and torque


@called
def air_on_body(t, x, y, z, vx, vy, vz, p, tables):
    """Force, N in space, of the air; what else it does is left among the numbers of the body."""
    b = body_of(p)
    own, at = p.places.body + WORK, p.places.shape_air + TABLE
    turned, done = tables[own + Y : own + Y + SIZE], own + AIR
    ux, uy, uz, k, density = flow(t, x, y, z, vx, vy, vz, p, tables)
    if b.motion == AVERAGED:
        zx, zy, zz = spin_axis(turned)
        px, py, pz, tx, ty, tz = turn_average(ux, uy, uz, k, zx, zy, zz, b, tables, at)
        fx, fy, fz = px, py, pz
    else:
        ax, ay, az, bx, by, bz, cx, cy, cz = axes_of(turned[Q], turned[Q + 1], turned[Q + 2], turned[Q + 3])
        sx, sy = b.centre_x + b.slide_share * turned[SLIDE], b.centre_y + b.slide_share * turned[SLIDE + 1]
        px, py, pz, tx, ty, tz = flow_loads(
            ux * ax + uy * ay + uz * az, ux * bx + uy * by + uz * bz, ux * cx + uy * cy + uz * cz, k,
            sx, sy, b.centre_z, tables, at,
        )  # fmt: skip
        fx, fy, fz = px * ax + py * bx + pz * cx, px * ay + py * by + pz * cy, px * az + py * bz + pz * cz
    tables[done], tables[done + 1], tables[done + 2] = px, py, pz
    tables[done + 3], tables[done + 4], tables[done + 5] = tx, ty, tz
    tables[done + DRAG], tables[done + DENSITY] = fx * ux + fy * uy + fz * uz, density
    return fx, fy, fz


def _air(time, state, parameters, own, number, out):
    """Acceleration, m/s2, of the air."""
    p = record_at(parameters, PARAMETERS)
    y, tables, a = array_at(state, STATE), array_at(p.places.address, p.places.end), array_at(out, 4)
    fx, fy, fz = air_on_body(time, y[0], y[1], y[2], y[3], y[4], y[5], p, tables)
    a[0], a[1], a[2], a[3] = fx / y[6], fy / y[6], fz / y[6], 0.0


def _of_scene(time, state, parameters, own, number, out):
    """A watched quantity, that of the air among them."""
    p, y, found = record_at(parameters, PARAMETERS), array_at(state, STATE), array_at(out, 4)
    tables = array_at(p.places.address, p.places.end)
    if number != AIR_DRAG:
        value, size = under_a_sky(number, time, y[0], y[1], y[2], y[3], y[4], y[5], y[6], y[7], p, tables)
    else:
        held = p.held.active
        p.held.active = 0
        air_on_body(time, y[0], y[1], y[2], y[3], y[4], y[5], p, tables)
        value = tables[p.places.body + WORK + AIR + DRAG]
        size = value
        p.held.active = held
    found[0], found[1], found[2], found[3] = value, size, 0.0, 0.0


def body_air() -> Callback:
    """Air on a craft that turns, for `dynamics.model`."""
    return callback(_air)


def body_air_quantities() -> Callback:
    """Whatever is watched where air turns a craft, for `dynamics.model`."""
    return callback(_of_scene)
