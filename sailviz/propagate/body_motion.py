"""A craft that turns: the right-hand side of position, velocity, attitude and body rate, and what acts on it.

State y (SIZE,): position m, velocity m/s, mass kg, as everywhere; then the quaternion (body to inertial, x y z w), the
body rate rad/s, the momentum of wheels N m s (body axes), the place of a sliding mass m (body x and y), and one number
that fills up the vector. Averaged over a spin, the quaternion's first three places hold the axis, and the third of the
body rate the spin.

All that does not push the sail (gravity, bodies, air) is the right-hand side of `dynamics`, whose steering is told the
normal of the moment; light, by the table of the sail's shape, pushes and turns it here. Air on facets is a force of
that right-hand side which is told the attitude beside it, and tells its torque (`body_air`).
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from sailviz.compiled import called, inlined, layout
from sailviz.environment import sky
from sailviz.propagate.callbacks import call
from sailviz.propagate.parameters import array_at, record_at
from sailviz.propagate.shape_callback import PUSH, TABLE, UNDER_SKY
from sailviz.propagate.sky_callback import sunlit_share
from sailviz.propulsion import shaped_sail
from sailviz.propulsion.rigid_body import axes_of, cross, gravity_gradient, quaternion_rate, symmetric

SIZE = 20
Q, RATE, WHEELS, SLIDE = 7, 11, 14, 17  # where they begin in the state
FREE, CONTROLLED, AVERAGED = 0.0, 1.0, 2.0
AZIMUTHS = 16  # of a turn over which a spin is averaged: exact for what has no harmonics beyond the fifteenth


class Body(NamedTuple):
    """A craft that turns, in body axes."""

    motion: float = FREE
    xx: float = 1.0  # inertia about the centre of mass, kg m2
    yy: float = 1.0
    zz: float = 1.0
    xy: float = 0.0
    xz: float = 0.0
    yz: float = 0.0
    inverse_xx: float = 1.0  # 1/(kg m2)
    inverse_yy: float = 1.0
    inverse_zz: float = 1.0
    inverse_xy: float = 0.0
    inverse_xz: float = 0.0
    inverse_yz: float = 0.0
    centre_x: float = 0.0  # of mass, m
    centre_y: float = 0.0
    centre_z: float = 0.0
    lit: float = 0.0  # 1: light pushes a shape, whose table stands with the device's numbers
    mass: float = 0.0  # kg, of a craft whose film ages, whose dose stands in the state in its place; 0: it does not age
    gradient: float = 0.0  # 1: gravity differs across the craft
    air: float = 0.0  # 1: air pushes a shape, by `body_air`
    cos_roll: float = 1.0  # of the attitude that a controller follows
    sin_roll: float = 0.0
    law: float = 0.0  # of steering.attitude, that it follows
    law_x: float = 0.0  # the direction of a law that is fixed in space
    law_y: float = 0.0
    law_z: float = 0.0
    stiffness: float = 0.0  # 1/s2, torque of a controller over inertia and angle
    damping: float = 0.0  # 1/s, the same over inertia and rate
    fastest: float = 0.0  # rad/s, beyond which a law that turns is not followed in its rate
    wheel_torque: float = 0.0  # N m a wheel has at most; 0: there are no wheels
    wheel_storage: float = 0.0  # N m s
    slide_share: float = 0.0  # of the craft's mass that slides; 0: none does
    slide_travel: float = 0.0  # m to either side
    slide_speed: float = 0.0  # m/s
    slide_rate: float = 0.0  # 1/s, by which it follows what is wanted
    vanes: float = 0.0  # how many; their rows follow
    devices: float = 0.0  # of switched reflectivity, how many; their rows follow those
    calm: float = 0.0  # rad off the wanted axis, within which devices switch a part of themselves


BODY = layout(Body)
WORK = len(Body._fields)  # where what goes to and fro between the right-hand side and a controller stands, then rows:
Y, ACCELERATION, LOADS, DONE, RATES = 0, SIZE, SIZE + 3, SIZE + 13, SIZE + 19  # state; m/s2; see `asked`; force, torque
AIR = SIZE + 24  # what `body_air` says of the moment
AGED = AIR + 8  # what `aged_shape_callback` says of it
HEAD = WORK + AGED + 11  # floats before the rows of vanes and devices


def packed(body: Body, rows: Sequence[Sequence[float]] = ()) -> list[float]:
    """The numbers of a body, for `dynamics.model`. rows : of its vanes, then of its devices (`body_control`)."""
    return [*body, *[0.0] * (HEAD - WORK), *(value for row in rows for value in row)]


@inlined
def body_of(p):
    """The record of the body."""
    return record_at(p.places.address + 8 * p.places.body, BODY)


@inlined
def light_at(t, x, y, z, number, p, tables):
    """(unit vector along the light, 2 P times the share that is lit, N/m2) at a place, m."""
    mine = p.places.device
    near = 1.0 / np.sqrt(x * x + y * y + z * z)
    ux, uy, uz, share = x * near, y * near, z * near, number
    if tables[mine + UNDER_SKY] != 0.0:
        sky.set_to(t, p.places.sky, p.sky, tables)
        ux, uy, uz, near = sky.from_light(x, y, z, p.places.sky, tables)
        share = number * sunlit_share(x, y, z, p, tables)
    return ux, uy, uz, share * tables[mine + PUSH] * near * near


@inlined
def flow_loads(ux, uy, uz, strength, cx, cy, cz, tables, at):
    """(force N, torque N m about the centre of mass c) of light or air along u, all in body axes; strength : N/m2,
    where the table has 1. at : where the table begins."""
    fx, fy, fz, tx, ty, tz = shaped_sail.push(ux, uy, uz, tables, at)
    ox, oy, oz = cross(cx, cy, cz, fx, fy, fz)
    return strength * fx, strength * fy, strength * fz, strength * (tx - ox), strength * (ty - oy), strength * (tz - oz)


@inlined
def gradient_torque(b, x, y, z, mu, ex, ey, ez, fx, fy, fz, gx, gy, gz):
    """Torque, N m, of the central body's gravity, in body axes whose inertial components are e, f, g."""
    inverse = 1.0 / np.sqrt(x * x + y * y + z * z)
    k = 3.0 * mu * inverse * inverse * inverse
    x, y, z = x * inverse, y * inverse, z * inverse
    rx, ry, rz = x * ex + y * ey + z * ez, x * fx + y * fy + z * fz, x * gx + y * gy + z * gz
    return gravity_gradient(k, rx, ry, rz, b.xx, b.yy, b.zz, b.xy, b.xz, b.yz)


@inlined
def aged_light(t, y, factor, p):
    """What the device's callback says of the light on a film that ages: (force N, torque N m about the centre of mass,
    the light's direction, its 2 P N/m2), along body axes, of an averaged spin inertial. It leaves the rate of the dose
    too, see `dose_rate`."""
    call(p.callbacks.device, p.places.device, t, y[0], y[1], y[2], y[3], y[4], y[5], y[6], 0.0, 0.0, 0.0, p, factor)
    tables = array_at(p.places.address, p.places.end)
    w = p.places.body + WORK + AGED
    return (
        tables[w], tables[w + 1], tables[w + 2], tables[w + 3], tables[w + 4],
        tables[w + 5], tables[w + 6], tables[w + 7], tables[w + 8], tables[w + 9],
    )  # fmt: skip


@inlined
def dose_rate(p):
    """s of full sunlight at 1 au for each s, as `aged_light` has left it."""
    return array_at(p.places.address, p.places.end)[p.places.body + WORK + AGED + 10]


@inlined
def mass_of(y, b):
    """kg."""
    return y[6] if b.mass == 0.0 else b.mass


@inlined
def passive_loads(t, y, factor, p, b):
    """(force of the light N, its torque N m about the centre of mass, the torque of gravity N m, the light's direction,
    its 2 P N/m2), all along body axes, at rest of the actuators but for a mass that has slid."""
    tables = array_at(p.places.address, p.places.end)
    ex, ey, ez, fx, fy, fz, gx, gy, gz = axes_of(y[Q], y[Q + 1], y[Q + 2], y[Q + 3])
    px, py, pz, tx, ty, tz = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    bx, by, bz, strength = 0.0, 0.0, 1.0, 0.0
    if b.mass != 0.0:
        px, py, pz, tx, ty, tz, bx, by, bz, strength = aged_light(t, y, factor, p)
    elif b.lit != 0.0:
        ux, uy, uz, strength = light_at(t, y[0], y[1], y[2], factor, p, tables)
        bx, by, bz = ux * ex + uy * ey + uz * ez, ux * fx + uy * fy + uz * fz, ux * gx + uy * gy + uz * gz
        if strength != 0.0:
            cx, cy = b.centre_x + b.slide_share * y[SLIDE], b.centre_y + b.slide_share * y[SLIDE + 1]
            at = p.places.device + TABLE
            px, py, pz, tx, ty, tz = flow_loads(bx, by, bz, strength, cx, cy, b.centre_z, tables, at)
    dx, dy, dz = 0.0, 0.0, 0.0
    if b.gradient != 0.0:
        dx, dy, dz = gradient_torque(b, y[0], y[1], y[2], p.gravity.mu, ex, ey, ez, fx, fy, fz, gx, gy, gz)
    return px, py, pz, tx, ty, tz, dx, dy, dz, bx, by, bz, strength


@inlined
def accelerated(y, px, py, pz, b, out):
    """Add a force, N in body axes, to the acceleration in out."""
    ex, ey, ez, fx, fy, fz, gx, gy, gz = axes_of(y[Q], y[Q + 1], y[Q + 2], y[Q + 3])
    inverse = 1.0 / mass_of(y, b)
    out[3] += inverse * (px * ex + py * fx + pz * gx)
    out[4] += inverse * (px * ey + py * fy + pz * gy)
    out[5] += inverse * (px * ez + py * fz + pz * gz)


@inlined
def turned(y, tx, ty, tz, b, out):
    """The derivative of quaternion and body rate under a torque, N m, of all but the momentum of the wheels."""
    wx, wy, wz = y[RATE], y[RATE + 1], y[RATE + 2]
    out[Q], out[Q + 1], out[Q + 2], out[Q + 3] = quaternion_rate(y[Q], y[Q + 1], y[Q + 2], y[Q + 3], wx, wy, wz)
    hx, hy, hz = symmetric(b.xx, b.yy, b.zz, b.xy, b.xz, b.yz, wx, wy, wz)
    gx, gy, gz = cross(wx, wy, wz, hx + y[WHEELS], hy + y[WHEELS + 1], hz + y[WHEELS + 2])
    out[RATE], out[RATE + 1], out[RATE + 2] = symmetric(
        b.inverse_xx, b.inverse_yy, b.inverse_zz, b.inverse_xy, b.inverse_xz, b.inverse_yz, tx - gx, ty - gy, tz - gz
    )


@called
def turn_average(ux, uy, uz, strength, zx, zy, zz, b, tables, at):
    """(force N, torque N m), inertial components, of light or air along u, over a turn about the axis z."""
    ax, ay, az = (0.0, zz, -zy) if abs(zx) < 0.7 else (-zz, 0.0, zx)
    size = 1.0 / np.sqrt(ax * ax + ay * ay + az * az)
    ax, ay, az = ax * size, ay * size, az * size
    bx, by, bz = cross(zx, zy, zz, ax, ay, az)
    px, py, pz, tx, ty, tz = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    strength = strength / AZIMUTHS
    along, across, axial = ux * ax + uy * ay + uz * az, ux * bx + uy * by + uz * bz, ux * zx + uy * zy + uz * zz
    for i in range(AZIMUTHS):
        c, s = np.cos(2.0 * np.pi * i / AZIMUTHS), np.sin(2.0 * np.pi * i / AZIMUTHS)
        qx, qy, qz, mx, my, mz = flow_loads(
            c * along + s * across, c * across - s * along, axial, strength,
            b.centre_x, b.centre_y, b.centre_z, tables, at,
        )  # fmt: skip
        q1, q2, m1, m2 = c * qx - s * qy, s * qx + c * qy, c * mx - s * my, s * mx + c * my
        px, py, pz = (
            px + q1 * ax + q2 * bx + qz * zx,
            py + q1 * ay + q2 * by + qz * zy,
            pz + q1 * az + q2 * bz + qz * zz,
        )
        tx, ty, tz = (
            tx + m1 * ax + m2 * bx + mz * zx,
            ty + m1 * ay + m2 * by + mz * zy,
            tz + m1 * az + m2 * bz + mz * zz,
        )
    return px, py, pz, tx, ty, tz


@inlined
def spin_axis(y):
    """The axis, a unit vector, of an averaged spin."""
    size = 1.0 / np.sqrt(y[Q] * y[Q] + y[Q + 1] * y[Q + 1] + y[Q + 2] * y[Q + 2])
    return y[Q] * size, y[Q + 1] * size, y[Q + 2] * size


@called
def spin_average(t, y, factor, p, b):
    """(force of the light N, its torque N m, torque of gravity N m), inertial components, over a turn about the axis in
    the quaternion's first three places."""
    tables = array_at(p.places.address, p.places.end)
    zx, zy, zz = spin_axis(y)
    px, py, pz, tx, ty, tz, dx, dy, dz = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    if b.mass != 0.0:
        px, py, pz, tx, ty, tz, _, _, _, _ = aged_light(t, y, factor, p)
    elif b.lit != 0.0:
        ux, uy, uz, strength = light_at(t, y[0], y[1], y[2], factor, p, tables)
        if strength != 0.0:
            at = p.places.device + TABLE
            px, py, pz, tx, ty, tz = turn_average(ux, uy, uz, strength, zx, zy, zz, b, tables, at)
    if b.gradient != 0.0:
        inverse = 1.0 / np.sqrt(y[0] * y[0] + y[1] * y[1] + y[2] * y[2])
        rx, ry, rz = y[0] * inverse, y[1] * inverse, y[2] * inverse
        k = (
            3.0
            * p.gravity.mu
            * inverse
            * inverse
            * inverse
            * (b.zz - 0.5 * (b.xx + b.yy))
            * (rx * zx + ry * zy + rz * zz)
        )
        dx, dy, dz = cross(rx, ry, rz, zx, zy, zz)
        dx, dy, dz = k * dx, k * dy, k * dz
    return px, py, pz, tx, ty, tz, dx, dy, dz


@inlined
def air_loads(p):
    """(force N, torque N m about the centre of mass) of the air, as `body_air` left them when it was last asked: along
    body axes, of an averaged spin inertial."""
    tables = array_at(p.places.address, p.places.end)
    w = p.places.body + WORK + AIR
    return tables[w], tables[w + 1], tables[w + 2], tables[w + 3], tables[w + 4], tables[w + 5]


@called
def averaged_derivative(t, y, factor, p, b, out):
    """Of a fast spinner: its axis follows its momentum Ia s, m' = torque across / (Ia s), s' = torque along / Ia."""
    px, py, pz, tx, ty, tz, dx, dy, dz = spin_average(t, y, factor, p, b)
    tx, ty, tz = tx + dx, ty + dy, tz + dz
    if b.air != 0.0:
        _, _, _, dx, dy, dz = air_loads(p)
        tx, ty, tz = tx + dx, ty + dy, tz + dz
    zx, zy, zz = spin_axis(y)
    along = tx * zx + ty * zy + tz * zz
    inverse = 1.0 / (b.zz * y[RATE + 2])
    out[Q], out[Q + 1], out[Q + 2] = (
        (tx - along * zx) * inverse,
        (ty - along * zy) * inverse,
        (tz - along * zz) * inverse,
    )
    out[RATE + 2] = along / b.zz
    if b.mass != 0.0:
        out[6] = dose_rate(p)
    inverse = 1.0 / mass_of(y, b)
    out[3], out[4], out[5] = out[3] + px * inverse, out[4] + py * inverse, out[5] + pz * inverse


@inlined
def asked(t, y, p, px, py, pz, dx, dy, dz, ux, uy, uz, strength, out):
    """(force N, torque N m) of the actuators, body axes, by the callback of `body_control`, and the rates of wheels and
    sliding mass into out, whose acceleration is known. p: N, of light and air; d: N m, of all that turns the craft
    without them; u, strength: the light."""
    tables = array_at(p.places.address, p.places.end)
    at = p.places.body + WORK
    for j in range(SIZE):
        tables[at + Y + j] = y[j]
    for j in range(3):
        tables[at + ACCELERATION + j] = out[3 + j]
    w = at + LOADS
    tables[w], tables[w + 1], tables[w + 2], tables[w + 3], tables[w + 4] = px, py, pz, dx, dy
    tables[w + 5], tables[w + 6], tables[w + 7], tables[w + 8], tables[w + 9] = dz, ux, uy, uz, strength
    call(p.callbacks.body, at, t, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, p, 0.0)
    for j in range(5):
        out[WHEELS + j] = tables[at + RATES + j]
    w = at + DONE
    return tables[w], tables[w + 1], tables[w + 2], tables[w + 3], tables[w + 4], tables[w + 5]


@inlined
def point_normal(y, p, b):
    """Tell the model's steering where the craft stands, and what callbacks push how it is turned."""
    if b.air != 0.0 or b.mass != 0.0 or p.places.heat != 0:
        tables = array_at(p.places.address, p.places.end)
        at = p.places.body + WORK + Y
        for j in range(Q, SIZE):
            tables[at + j] = y[j]
    if b.motion == AVERAGED:
        p.inertial.x, p.inertial.y, p.inertial.z = spin_axis(y)
        return
    _, _, _, _, _, _, gx, gy, gz = axes_of(y[Q], y[Q + 1], y[Q + 2], y[Q + 3])
    p.inertial.x, p.inertial.y, p.inertial.z = gx, gy, gz
