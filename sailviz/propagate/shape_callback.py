"""Light on a sail of any shape, whose axes its steering gives: +z the normal, x as near to the direction of flight
across the radius as can be, both turned about z by the roll, as `frames.body_axes` has it and recordings show it.

A device's callback: compiled when the first scene needs it. Its numbers: the places named below, then the table.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from sailviz.compiled import STATE, called
from sailviz.environment import sky
from sailviz.propagate.callbacks import Callback, callback
from sailviz.propagate.parameters import PARAMETERS, array_at, record_at
from sailviz.propagate.sky_callback import sunlit_share
from sailviz.propulsion import shaped_sail

# 2 P r_E^2 in N; whether there is a sky; cosine and sine of the roll; where the table begins
PUSH, UNDER_SKY, COS, SIN, TABLE = 0, 1, 2, 3, 4
WEAK = 1e-9  # of a hint across the normal below which x is laid otherwise, as in `frames.body_axes`


@called
def axes_x(rx, ry, rz, vx, vy, vz, nx, ny, nz):
    """The body's x axis without a roll, for a place (m), a velocity (m/s) and a normal."""
    hx, hy, hz = ry * vz - rz * vy, rz * vx - rx * vz, rx * vy - ry * vx
    tx, ty, tz = hy * rz - hz * ry, hz * rx - hx * rz, hx * ry - hy * rx
    inverse = 1.0 / np.sqrt(tx * tx + ty * ty + tz * tz)
    tx, ty, tz = tx * inverse, ty * inverse, tz * inverse
    along = tx * nx + ty * ny + tz * nz
    x, y, z = tx - along * nx, ty - along * ny, tz - along * nz
    size = np.sqrt(x * x + y * y + z * z)
    if size < WEAK:
        if abs(nz) < 0.9:  # the z axis of space across the normal
            x, y, z = -ny, nx, 0.0
        else:
            x, y, z = 0.0, -nz, ny
        size = np.sqrt(x * x + y * y + z * z)
    return x / size, y / size, z / size


@called
def rolled_axes(rx, ry, rz, vx, vy, vz, nx, ny, nz, c, s):
    """The body's x and y axes, turned about the normal by an angle of cosine c and sine s."""
    ex, ey, ez = axes_x(rx, ry, rz, vx, vy, vz, nx, ny, nz)
    gx, gy, gz = ny * ez - nz * ey, nz * ex - nx * ez, nx * ey - ny * ex
    return (
        c * ex + s * gx,
        c * ey + s * gy,
        c * ez + s * gz,
        c * gx - s * ex,
        c * gy - s * ey,
        c * gz - s * ez,
    )


@called
def pushed_along(ux, uy, uz, ex, ey, ez, gx, gy, gz, nx, ny, nz, own, at):
    """(force m2 in space, torque m3 in body axes) over 2 P of a flow along u on a body with the axes e, g, n. own : an
    array in which the table begins at place `at`."""
    bx, by, bz = ux * ex + uy * ey + uz * ez, ux * gx + uy * gy + uz * gz, ux * nx + uy * ny + uz * nz
    fx, fy, fz, tx, ty, tz = shaped_sail.push(bx, by, bz, own, at)
    return (
        fx * ex + fy * gx + fz * nx,
        fx * ey + fy * gy + fz * ny,
        fx * ez + fy * gz + fz * nz,
        tx,
        ty,
        tz,
    )


def _thrust(time, state, parameters, own, number, out):
    """Acceleration, m/s2, of the light."""
    p = record_at(parameters, PARAMETERS)
    y, tables, a = array_at(state, STATE), array_at(p.places.address, p.places.end), array_at(out, 4)
    mine = array_at(own, p.places.end)
    a[0], a[1], a[2], a[3] = 0.0, 0.0, 0.0, 0.0
    x, yy, z, m, nx, ny, nz = y[0], y[1], y[2], y[6], y[7], y[8], y[9]
    near = 1.0 / np.sqrt(x * x + yy * yy + z * z)
    ux, uy, uz, share = x * near, yy * near, z * near, number
    if mine[UNDER_SKY] != 0.0:
        sky.set_to(time, p.places.sky, p.sky, tables)
        ux, uy, uz, near = sky.from_light(x, yy, z, p.places.sky, tables)
        share = number * sunlit_share(x, yy, z, p, tables)
    if share > 0.0 and nx * nx + ny * ny + nz * nz > 0.0:
        ex, ey, ez, gx, gy, gz = rolled_axes(x, yy, z, y[3], y[4], y[5], nx, ny, nz, mine[COS], mine[SIN])
        fx, fy, fz, _, _, _ = pushed_along(ux, uy, uz, ex, ey, ez, gx, gy, gz, nx, ny, nz, mine, TABLE)
        k = share * mine[PUSH] * near * near / m
        a[0], a[1], a[2] = k * fx, k * fy, k * fz


def shape_thrust(push: float, under_sky: bool, roll: float, table: Sequence[float]) -> Callback:
    """A sail of a shape. push : 2 P r_E^2, N; roll : rad about the normal; table : of `shapes.light_table`."""
    head = [push, float(under_sky), float(np.cos(roll)), float(np.sin(roll))]
    return callback(_thrust, [*head, *table])
