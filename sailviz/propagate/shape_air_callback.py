"""Air on a sail of any shape, whose axes its steering gives as in `shape_callback`; what is recorded and watched of it.

Callbacks, compiled when the first scene needs them. The numbers stand in the tables of the model, for all three to
read: the places named below, then a table of the air's law over the directions of the flow, on which 2 rho V^2 stands
where light has 2 P.
"""

from __future__ import annotations

import numpy as np

from sailviz.compiled import STATE, called, entry
from sailviz.propagate.callbacks import Callback, callback
from sailviz.propagate.dynamics import direction
from sailviz.propagate.low_orbit_callback import air_density, surroundings
from sailviz.propagate.parameters import PARAMETERS, array_at, record_at
from sailviz.propagate.quantity_callback import AIR_DRAG
from sailviz.propagate.shape_callback import pushed_along, rolled_axes
from sailviz.propagate.sky_quantities import under_a_sky

COS, SIN, TABLE = 0, 1, 2  # of the roll; where the table begins
FORCE, TORQUE, DRAG, DENSITY, COLUMNS = 0, 3, 6, 7, 8  # of `observe_air`


@called
def flow(t, x, y, z, vx, vy, vz, p, tables):
    """(unit vector along the air that is met, 2 rho V^2 N/m2, density kg/m3); the air turns with the body below."""
    r = np.sqrt(x * x + y * y + z * z)
    latitude, local_time, altitude, f107, _ = surroundings(t, x, y, z, r, p)
    density = air_density(t, r, latitude, local_time, altitude, f107, p, tables)
    w = p.surface.rotation
    qx, qy, qz = vx + w * y, vy - w * x, vz
    speed = np.sqrt(qx * qx + qy * qy + qz * qz)
    return -qx / speed, -qy / speed, -qz / speed, 2.0 * density * speed * speed, density


@called
def air_on_shape(t, x, y, z, vx, vy, vz, nx, ny, nz, p, tables):
    """(force N in space, torque N m in body axes, drag N against the flow, density kg/m3) of the air that is met."""
    ux, uy, uz, k, density = flow(t, x, y, z, vx, vy, vz, p, tables)
    at = p.places.shape_air
    ex, ey, ez, gx, gy, gz = rolled_axes(x, y, z, vx, vy, vz, nx, ny, nz, tables[at + COS], tables[at + SIN])
    fx, fy, fz, tx, ty, tz = pushed_along(ux, uy, uz, ex, ey, ez, gx, gy, gz, nx, ny, nz, tables, at + TABLE)
    return k * fx, k * fy, k * fz, k * tx, k * ty, k * tz, k * (fx * ux + fy * uy + fz * uz), density


def _air(time, state, parameters, own, number, out):
    """Acceleration, m/s2, of the air, at the attitude that the law asks for."""
    p = record_at(parameters, PARAMETERS)
    y, tables, a = array_at(state, STATE), array_at(p.places.address, p.places.end), array_at(out, 4)
    inverse = 1.0 / np.sqrt(y[0] * y[0] + y[1] * y[1] + y[2] * y[2])
    ux, uy, uz = y[0] * inverse, y[1] * inverse, y[2] * inverse
    nx, ny, nz, _, _ = direction(time, y[0], y[1], y[2], y[3], y[4], y[5], y[6], ux, uy, uz, p)
    fx, fy, fz, _, _, _, _, _ = air_on_shape(time, y[0], y[1], y[2], y[3], y[4], y[5], nx, ny, nz, p, tables)
    a[0], a[1], a[2], a[3] = fx / y[6], fy / y[6], fz / y[6], 0.0


def _of_scene(time, state, parameters, own, number, out):
    """A watched quantity, that of the air among them."""
    p, y, found = record_at(parameters, PARAMETERS), array_at(state, STATE), array_at(out, 4)
    tables = array_at(p.places.address, p.places.end)
    x, yy, z, vx, vy, vz, m, factor = y[0], y[1], y[2], y[3], y[4], y[5], y[6], y[7]
    if number != AIR_DRAG:
        value, size = under_a_sky(number, time, x, yy, z, vx, vy, vz, m, factor, p, tables)
    else:
        held = p.held.active
        p.held.active = 0
        inverse = 1.0 / np.sqrt(x * x + yy * yy + z * z)
        nx, ny, nz, _, _ = direction(time, x, yy, z, vx, vy, vz, m, x * inverse, yy * inverse, z * inverse, p)
        _, _, _, _, _, _, value, _ = air_on_shape(time, x, yy, z, vx, vy, vz, nx, ny, nz, p, tables)
        size = value
        p.held.active = held
    found[0], found[1], found[2], found[3] = value, size, 0.0, 0.0


def numbers(roll: float, table: np.ndarray) -> list[float]:
    """What stands in the tables of a model. roll : rad about the normal; table : of `shapes.light_table`, by the law of
    the air."""
    return [float(np.cos(roll)), float(np.sin(roll)), *table.tolist()]


def shape_air() -> Callback:
    """Air on a shape, for `dynamics.model`."""
    return callback(_air)


def shape_quantities() -> Callback:
    """Whatever is watched where air pushes a shape, for `dynamics.model`."""
    return callback(_of_scene)


def observe_air(time: np.ndarray, states: np.ndarray, normals: np.ndarray, parameters: np.ndarray) -> np.ndarray:
    """What the air does at given states: (COLUMNS, n) SI, as named above: the force in space and the torque in body
    axes are vectors. time (n,), states (7, n), normals (n, 3)."""
    out = np.zeros((COLUMNS, len(time)))
    _observe(time, states, normals, parameters, out)
    return out


@entry("d1 d2 d2 r1 D2", PARAMETERS)
def _observe(time, states, normals, parameters, out):
    """`observe_air` into zeros."""
    p = parameters[0]
    tables = array_at(p.places.address, p.places.end)
    for i in range(len(time)):
        y = states[:, i]
        nx, ny, nz = normals[i, 0], normals[i, 1], normals[i, 2]
        fx, fy, fz, tx, ty, tz, drag, density = air_on_shape(
            time[i], y[0], y[1], y[2], y[3], y[4], y[5], nx, ny, nz, p, tables
        )
        out[FORCE, i], out[FORCE + 1, i], out[FORCE + 2, i] = fx, fy, fz
        out[TORQUE, i], out[TORQUE + 1, i], out[TORQUE + 2, i] = tx, ty, tz
        out[DRAG, i], out[DENSITY, i] = drag, density
    return 0
