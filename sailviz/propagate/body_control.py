"""What turns a craft on purpose: a controller that follows a steering law, and the actuators that do what it wants.

The controller wants I (-2 stiffness sign(q4) qv - damping (w - w_law)), qv and q4 of the quaternion from the law's
axes to the body's. Wheels give it, as far as their torque and their storage go; a sliding mass and vanes, beside
wheels, take off what light and gravity do and what the wheels hold, and without wheels do all of it. Devices of
switched reflectivity turn the momentum of a spinning craft towards the law's normal: each is on while its push tilts it
there.

What an actuator is wanted to do is a function of the state: servos are as fast as that, but for the sliding mass.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from sailviz.compiled import called, inlined
from sailviz.propagate.body_motion import (
    ACCELERATION,
    DONE,
    HEAD,
    LOADS,
    RATE,
    RATES,
    SIZE,
    SLIDE,
    WHEELS,
    WORK,
    Q,
    Y,
    body_of,
)
from sailviz.propagate.callbacks import Callback, callback
from sailviz.propagate.dynamics import direction
from sailviz.propagate.parameters import PARAMETERS, array_at, record_at
from sailviz.propagate.shape_callback import axes_x
from sailviz.propulsion.rigid_body import axes_of, cross, flat_plate, symmetric
from sailviz.steering.attitude import INERTIAL

AHEAD = 1.0  # s, over which the turning of a law is told
UNLOADING = 0.1  # of the root of the stiffness: how fast other actuators take off what the wheels hold
TRIALS = 6  # of Newton's method for the angles of vanes
SOFT = 0.1  # of the cosine, over which a device turns over
LITTLE = 1e-6  # of the vanes' authority squared, that keeps a singular step small


class Vane(NamedTuple):
    """A plate on a hinge that points outwards from the z axis: at angle 0 it lies in the plane of the film, at angle d
    its normal is cos d z + sin d (e x z), e outwards. Both sides as the film's."""

    x: float  # m
    y: float
    z: float
    area: float  # m2
    limit: float  # rad, to either side
    rest: float  # rad
    f1: float  # coefficients of its front, and of its back
    f2: float
    f3: float
    g1: float
    g2: float
    g3: float
    angle: float = 0.0  # rad, of the moment: written here by the controller


class ReflectivityDevice(NamedTuple):
    """A patch in the plane of the film, whose front is the film's while it is on, and another, `off`, while it is not;
    what is off stays as it is where the film ages."""

    x: float  # m
    y: float
    z: float
    area: float  # m2
    d1: float  # coefficients on less off
    d2: float
    d3: float
    share: float = 1.0  # on, of the moment: written here by the controller
    off1: float = 0.0  # coefficients off
    off2: float = 0.0
    off3: float = 0.0


AREA, LIMIT, REST, FRONT_OF_VANE, ANGLE, VANE = 3, 4, 5, 6, 12, 13
CHANGE, SHARE, OFF, DEVICE = 4, 7, 8, 11


@called
def wanted_axes(t, x, y, z, vx, vy, vz, m, p, b):
    """The law's axes for the body, nine inertial numbers; all zero where it wants none."""
    inverse = 1.0 / np.sqrt(x * x + y * y + z * z)
    kx, ky, kz = p.inertial.x, p.inertial.y, p.inertial.z
    p.kinds.steering = int(b.law)
    p.inertial.x, p.inertial.y, p.inertial.z = b.law_x, b.law_y, b.law_z
    nx, ny, nz, _, _ = direction(t, x, y, z, vx, vy, vz, m, x * inverse, y * inverse, z * inverse, p)
    p.kinds.steering = INERTIAL
    p.inertial.x, p.inertial.y, p.inertial.z = kx, ky, kz
    if nx * nx + ny * ny + nz * nz == 0.0:
        return 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    ax, ay, az = axes_x(x, y, z, vx, vy, vz, nx, ny, nz)
    bx, by, bz = cross(nx, ny, nz, ax, ay, az)
    c, s = b.cos_roll, b.sin_roll
    return (
        c * ax + s * bx, c * ay + s * by, c * az + s * bz,
        c * bx - s * ax, c * by - s * ay, c * bz - s * az,
        nx, ny, nz,
    )  # fmt: skip


@inlined
def quaternion_from(xx, xy, xz, yx, yy, yz, zx, zy, zz):
    """The quaternion, w >= 0, of the rotation whose columns are x (xx, xy, xz), y and z."""
    trace = xx + yy + zz
    if trace > 0.0:
        w = 0.5 * np.sqrt(1.0 + trace)
        k = 0.25 / w
        return k * (yz - zy), k * (zx - xz), k * (xy - yx), w
    if xx >= max(yy, zz):
        x = 0.5 * np.sqrt(1.0 + xx - yy - zz)
        k, w = 0.25 / x, (yz - zy) * 0.25 / x
        a, c, d = x, k * (xy + yx), k * (xz + zx)
    elif yy >= zz:
        y = 0.5 * np.sqrt(1.0 - xx + yy - zz)
        k, w = 0.25 / y, (zx - xz) * 0.25 / y
        a, c, d = k * (xy + yx), y, k * (yz + zy)
    else:
        z = 0.5 * np.sqrt(1.0 - xx - yy + zz)
        k, w = 0.25 / z, (xy - yx) * 0.25 / z
        a, c, d = k * (xz + zx), k * (yz + zy), z
    sign = -1.0 if w < 0.0 else 1.0
    return sign * a, sign * c, sign * d, sign * w


@inlined
def along(x, y, z, ax, ay, az, bx, by, bz, cx, cy, cz):
    """Components of a vector along three axes."""
    return x * ax + y * ay + z * az, x * bx + y * by + z * bz, x * cx + y * cy + z * cz


@called
def wanted_torque(t, y, ax, ay, az, p, b):
    """Torque, N m in body axes, that the controller wants of a craft at the acceleration a, m/s2."""
    ex, ey, ez, fx, fy, fz, gx, gy, gz = axes_of(y[Q], y[Q + 1], y[Q + 2], y[Q + 3])
    px, py, pz, qx, qy, qz, nx, ny, nz = wanted_axes(t, y[0], y[1], y[2], y[3], y[4], y[5], y[6], p, b)
    if nx * nx + ny * ny + nz * nz == 0.0:
        return 0.0, 0.0, 0.0
    # the body's axes seen from the law's
    xx, xy, xz = along(ex, ey, ez, px, py, pz, qx, qy, qz, nx, ny, nz)
    yx, yy, yz = along(fx, fy, fz, px, py, pz, qx, qy, qz, nx, ny, nz)
    zx, zy, zz = along(gx, gy, gz, px, py, pz, qx, qy, qz, nx, ny, nz)
    ux, uy, uz, _ = quaternion_from(xx, xy, xz, yx, yy, yz, zx, zy, zz)
    # how the law's own axes turn
    h = AHEAD
    px2, py2, pz2, qx2, qy2, qz2, nx2, ny2, nz2 = wanted_axes(
        t + h,
        y[0] + h * (y[3] + 0.5 * h * ax), y[1] + h * (y[4] + 0.5 * h * ay), y[2] + h * (y[5] + 0.5 * h * az),
        y[3] + h * ax, y[4] + h * ay, y[5] + h * az, y[6], p, b,
    )  # fmt: skip
    k = 0.5 / h
    rx = k * ((qx2 * nx + qy2 * ny + qz2 * nz) - (nx2 * qx + ny2 * qy + nz2 * qz))
    ry = k * ((nx2 * px + ny2 * py + nz2 * pz) - (px2 * nx + py2 * ny + pz2 * nz))
    rz = k * ((px2 * qx + py2 * qy + pz2 * qz) - (qx2 * px + qy2 * py + qz2 * pz))
    if rx * rx + ry * ry + rz * rz > b.fastest * b.fastest:  # it jumps
        rx, ry, rz = 0.0, 0.0, 0.0
    sx, sy, sz = xx * rx + xy * ry + xz * rz, yx * rx + yy * ry + yz * rz, zx * rx + zy * ry + zz * rz
    dx, dy, dz = y[RATE] - sx, y[RATE + 1] - sy, y[RATE + 2] - sz
    k, d = -2.0 * b.stiffness, -b.damping
    return symmetric(b.xx, b.yy, b.zz, b.xy, b.xz, b.yz, k * ux + d * dx, k * uy + d * dy, k * uz + d * dz)


@called
def wanted_tilt(t, y, p, b):
    """(direction in body axes in which the momentum should be pushed, sine of its angle off the law's normal)."""
    ex, ey, ez, fx, fy, fz, gx, gy, gz = axes_of(y[Q], y[Q + 1], y[Q + 2], y[Q + 3])
    _, _, _, _, _, _, nx, ny, nz = wanted_axes(t, y[0], y[1], y[2], y[3], y[4], y[5], y[6], p, b)
    hx, hy, hz = symmetric(b.xx, b.yy, b.zz, b.xy, b.xz, b.yz, y[RATE], y[RATE + 1], y[RATE + 2])
    hx, hy, hz = hx + y[WHEELS], hy + y[WHEELS + 1], hz + y[WHEELS + 2]
    size = np.sqrt(hx * hx + hy * hy + hz * hz)
    if size == 0.0:
        return 0.0, 0.0, 0.0, 0.0
    hx, hy, hz = hx / size, hy / size, hz / size
    if hz < 0.0:  # a left-handed spin points its momentum the other way
        nx, ny, nz = -nx, -ny, -nz
    nx, ny, nz = along(nx, ny, nz, ex, ey, ez, fx, fy, fz, gx, gy, gz)
    c = nx * hx + ny * hy + nz * hz
    dx, dy, dz = nx - c * hx, ny - c * hy, nz - c * hz
    off = np.sqrt(dx * dx + dy * dy + dz * dz)
    if off < 1e-12:
        return 0.0, 0.0, 0.0, 0.0
    return dx / off, dy / off, dz / off, off


@inlined
def vane_loads(angle, ux, uy, uz, strength, cx, cy, cz, tables, row):
    """(force N, torque N m about c) of the light on a vane."""
    x, y = tables[row], tables[row + 1]
    inverse = 1.0 / np.sqrt(x * x + y * y)
    c, s = np.cos(angle), np.sin(angle)
    nx, ny = s * y * inverse, -s * x * inverse
    f = row + FRONT_OF_VANE
    k = strength * tables[row + AREA]
    fx, fy, fz = flat_plate(
        ux, uy, uz, nx, ny, c, tables[f], tables[f + 1], tables[f + 2], tables[f + 3], tables[f + 4], tables[f + 5]
    )
    fx, fy, fz = k * fx, k * fy, k * fz
    tx, ty, tz = cross(x - cx, y - cy, tables[row + 2] - cz, fx, fy, fz)
    return fx, fy, fz, tx, ty, tz


@inlined
def all_vanes(first, count, ux, uy, uz, strength, cx, cy, cz, tables):
    """(force N, torque N m) of all vanes at their angles."""
    px, py, pz, tx, ty, tz = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for i in range(count):
        row = first + VANE * i
        fx, fy, fz, mx, my, mz = vane_loads(tables[row + ANGLE], ux, uy, uz, strength, cx, cy, cz, tables, row)
        px, py, pz, tx, ty, tz = px + fx, py + fy, pz + fz, tx + mx, ty + my, tz + mz
    return px, py, pz, tx, ty, tz


@inlined
def vane_slope(first, i, ux, uy, uz, strength, cx, cy, cz, tables):
    """Torque, N m/rad, that a vane gains with its angle."""
    row, h = first + VANE * i, 1e-4
    angle = tables[row + ANGLE]
    _, _, _, ax, ay, az = vane_loads(angle + h, ux, uy, uz, strength, cx, cy, cz, tables, row)
    _, _, _, bx, by, bz = vane_loads(angle - h, ux, uy, uz, strength, cx, cy, cz, tables, row)
    k = 0.5 / h
    return k * (ax - bx), k * (ay - by), k * (az - bz)


@called
def set_vanes(first, count, wx, wy, wz, ux, uy, uz, strength, cx, cy, cz, tables):
    """Turn the vanes from their rest so that their torque comes to w, N m, as near as their limits let it: Newton's
    method, the shortest step each time."""
    for i in range(count):
        tables[first + VANE * i + ANGLE] = tables[first + VANE * i + REST]
    for _ in range(TRIALS):
        _, _, _, tx, ty, tz = all_vanes(first, count, ux, uy, uz, strength, cx, cy, cz, tables)
        rx, ry, rz = wx - tx, wy - ty, wz - tz
        xx, yy, zz, xy, xz, yz = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
        for i in range(count):
            jx, jy, jz = vane_slope(first, i, ux, uy, uz, strength, cx, cy, cz, tables)
            xx, yy, zz = xx + jx * jx, yy + jy * jy, zz + jz * jz
            xy, xz, yz = xy + jx * jy, xz + jx * jz, yz + jy * jz
        soft = LITTLE * (xx + yy + zz) + 1e-300
        xx, yy, zz = xx + soft, yy + soft, zz + soft
        mx, my, mz = yy * zz - yz * yz, xz * yz - xy * zz, xy * yz - xz * yy
        k = 1.0 / (xx * mx + xy * my + xz * mz)
        sx, sy, sz = symmetric(
            k * mx, k * (xx * zz - xz * xz), k * (xx * yy - xy * xy), k * my, k * mz, k * (xy * xz - xx * yz),
            rx, ry, rz,
        )  # fmt: skip
        for i in range(count):
            row = first + VANE * i
            jx, jy, jz = vane_slope(first, i, ux, uy, uz, strength, cx, cy, cz, tables)
            angle = tables[row + ANGLE] + min(0.5, max(-0.5, jx * sx + jy * sy + jz * sz))
            tables[row + ANGLE] = min(tables[row + LIMIT], max(-tables[row + LIMIT], angle))


@called
def switch_devices(first, count, wx, wy, wz, part, ux, uy, uz, strength, cx, cy, cz, tables):
    """(force N, torque N m) by which devices differ from a film that is all on: on where their push has a part along w,
    a unit vector; `part` of their area switches, the rest is half on."""
    px, py, pz, tx, ty, tz = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for i in range(count):
        row = first + DEVICE * i
        d = row + CHANGE
        k = strength * tables[row + AREA] if uz > 0.0 else 0.0  # the back does not switch
        fx, fy, fz = flat_plate(ux, uy, uz, 0.0, 0.0, 1.0, tables[d], tables[d + 1], tables[d + 2], 0.0, 0.0, 0.0)
        fx, fy, fz = k * fx, k * fy, k * fz
        mx, my, mz = cross(tables[row] - cx, tables[row + 1] - cy, tables[row + 2] - cz, fx, fy, fz)
        size = np.sqrt(mx * mx + my * my + mz * mz)
        c = (mx * wx + my * wy + mz * wz) / size if size > 0.0 else 0.0
        share = 0.5 + 0.5 * part * min(1.0, max(-1.0, c / SOFT))
        tables[row + SHARE] = share
        k = share - 1.0
        px, py, pz, tx, ty, tz = px + k * fx, py + k * fy, pz + k * fz, tx + k * mx, ty + k * my, tz + k * mz
    return px, py, pz, tx, ty, tz


@inlined
def wheel(wanted, momentum, most, storage):
    """Torque, N m, that a wheel gives: what it can, and none that would load it beyond its storage."""
    given = min(most, max(-most, wanted))
    return 0.0 if (momentum >= storage and given < 0.0) or (momentum <= -storage and given > 0.0) else given


@called
def slid(y, wx, wy, wz, fx, fy, fz, b, out):
    """Move the sliding mass towards where it turns the craft by w, N m, more than at its place; f, N, of the light."""
    if fz <= 0.0:
        out[SLIDE], out[SLIDE + 1] = -b.slide_rate * y[SLIDE], -b.slide_rate * y[SLIDE + 1]
    else:
        k = 1.0 / (b.slide_share * fz)
        out[SLIDE], out[SLIDE + 1] = b.slide_rate * k * wy, -b.slide_rate * k * wx
    for i in (SLIDE, SLIDE + 1):
        aim = min(b.slide_travel, max(-b.slide_travel, y[i] + out[i] / b.slide_rate))
        out[i] = min(b.slide_speed, max(-b.slide_speed, b.slide_rate * (aim - y[i])))


@called
def act(t, y, p, b, px, py, pz, dx, dy, dz, ux, uy, uz, strength, ax, ay, az, out):
    """(force N, torque N m) of the actuators, body axes; the rates of wheels and sliding mass into out. p: N, of the
    light; d: N m, of all that turns the craft without them; u, strength: the light; a: m/s2, of the craft."""
    tables = array_at(p.places.address, p.places.end)
    wx, wy, wz = wanted_torque(t, y, ax, ay, az, p, b)
    rx, ry, rz = wx - dx, wy - dy, wz - dz
    if b.wheel_torque > 0.0:
        k = -UNLOADING * np.sqrt(b.stiffness)
        rx, ry, rz = k * y[WHEELS] - dx, k * y[WHEELS + 1] - dy, k * y[WHEELS + 2] - dz
    fx, fy, fz, tx, ty, tz = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    if b.slide_share > 0.0:
        slid(y, rx, ry, rz, px, py, pz, b, out)
    cx, cy = b.centre_x + b.slide_share * y[SLIDE], b.centre_y + b.slide_share * y[SLIDE + 1]
    vanes, devices = int(b.vanes), int(b.devices)
    first = p.places.body + HEAD
    if vanes > 0:
        set_vanes(first, vanes, rx, ry, rz, ux, uy, uz, strength, cx, cy, b.centre_z, tables)
        fx, fy, fz, tx, ty, tz = all_vanes(first, vanes, ux, uy, uz, strength, cx, cy, b.centre_z, tables)
    if devices > 0:
        sx, sy, sz, off = wanted_tilt(t, y, p, b)
        part = min(1.0, off / b.calm)
        qx, qy, qz, mx, my, mz = switch_devices(
            first + VANE * vanes, devices, sx, sy, sz, part, ux, uy, uz, strength, cx, cy, b.centre_z, tables
        )
        fx, fy, fz, tx, ty, tz = fx + qx, fy + qy, fz + qz, tx + mx, ty + my, tz + mz
    if b.wheel_torque > 0.0:
        mx = wheel(wx, y[WHEELS], b.wheel_torque, b.wheel_storage)
        my = wheel(wy, y[WHEELS + 1], b.wheel_torque, b.wheel_storage)
        mz = wheel(wz, y[WHEELS + 2], b.wheel_torque, b.wheel_storage)
        out[WHEELS], out[WHEELS + 1], out[WHEELS + 2] = -mx, -my, -mz
        tx, ty, tz = tx + mx, ty + my, tz + mz
    return fx, fy, fz, tx, ty, tz


def _act(time, state, parameters, own, number, out):
    """`act` for `body_motion.asked`, by way of the numbers of the body."""
    p = record_at(parameters, PARAMETERS)
    b = body_of(p)
    work, a = array_at(own, HEAD - WORK), array_at(out, 4)
    y, rates, w = work[Y : Y + SIZE], work[RATES - WHEELS : RATES - WHEELS + SIZE], LOADS
    moved = work[ACCELERATION - 3 : ACCELERATION - 3 + SIZE]
    a[0], a[1], a[2], a[3] = 0.0, 0.0, 0.0, 0.0
    for j in range(RATES, RATES + 5):
        work[j] = 0.0
    fx, fy, fz, tx, ty, tz = act(
        time, y, p, b, work[w], work[w + 1], work[w + 2], work[w + 3], work[w + 4], work[w + 5],
        work[w + 6], work[w + 7], work[w + 8], work[w + 9], moved[3], moved[4], moved[5], rates,
    )  # fmt: skip
    w = DONE
    work[w], work[w + 1], work[w + 2], work[w + 3], work[w + 4], work[w + 5] = fx, fy, fz, tx, ty, tz


def body_control() -> Callback:
    """The controller, for `dynamics.model`."""
    return callback(_act)
