"""What events watch under a sky: the quantities of quantity_callback, with angles counted from the light, how far light
and Moon are, how much light comes through, and where the solar wind begins.

A callback: compiled when the first scene needs it.
"""

from __future__ import annotations

import numpy as np

from sailviz.compiled import STATE, called
from sailviz.environment import sky
from sailviz.environment.eclipse import NO_SHADOW
from sailviz.propagate.callbacks import Callback, callback
from sailviz.propagate.dynamics import device_acceleration, direction
from sailviz.propagate.parameters import PARAMETERS, array_at, record_at
from sailviz.propagate.quantity_callback import (
    AIR_DRAG,
    CLOCK,
    MAGNETOPAUSE,
    MOON_DISTANCE,
    PITCH,
    SUN_DISTANCE,
    SUNLIT_FRACTION,
    THRUST_ACCELERATION,
    of_craft,
    of_low_orbit,
    of_state,
)
from sailviz.propagate.sky_callback import attitude_drag, outside_magnetosphere, sunlit_share
from sailviz.propulsion.devices import NO_DEVICE, PLASMA_BRAKE
from sailviz.steering import by_light


@called
def from_the_light(number, t, x, y, z, vx, vy, vz, m, factor, p, tables):
    """(pitch, cone or clock counted from the light, or the size of the thrust; its size)."""
    at, inverse = p.places.sky, 1.0 / np.sqrt(x * x + y * y + z * z)
    nx, ny, nz, _, _ = direction(t, x, y, z, vx, vy, vz, m, x * inverse, y * inverse, z * inverse, p)
    if number not in (PITCH, CLOCK):
        nx, ny, nz = 0.0, 0.0, 0.0
        if factor != 0.0 and p.kinds.device != NO_DEVICE and p.kinds.device != PLASMA_BRAKE:
            nx, ny, nz, _ = device_acceleration(t, x, y, z, vx, vy, vz, m, inverse, factor, p)
    if number == THRUST_ACCELERATION:
        size = np.sqrt(nx * nx + ny * ny + nz * nz)
        return size, size
    sky.set_to(t, at, p.sky, tables)
    ux, uy, uz, _ = sky.from_light(x, y, z, at, tables)
    ex, ey, ez, wx, wy, wz = by_light.light_axes(ux, uy, uz, x, y, z, vx, vy, vz, p.by_light)
    along = ux * nx + uy * ny + uz * nz
    east, north = ex * nx + ey * ny + ez * nz, wx * nx + wy * ny + wz * nz
    if number == CLOCK:
        return (np.arctan2(east, north) if np.hypot(east, north) > 1e-12 else 0.0), 1.0
    return np.arctan2(np.hypot(east, north), along), 1.0


@called
def of_sky(number, t, x, y, z, vx, vy, vz, m, factor, p, tables):
    """(value, its size) of a quantity that depends on the sky."""
    at = p.places.sky
    sky.set_to(t, at, p.sky, tables)
    if number == SUN_DISTANCE:
        _, _, _, inverse = sky.from_light(x, y, z, at, tables)
        return 1.0 / inverse, 1.0 / inverse
    if number == MOON_DISTANCE:
        row = at + sky.HEAD + sky.BODY * p.sky.moon + sky.X
        dx, dy, dz = x - tables[row], y - tables[row + 1], z - tables[row + 2]
        d = np.sqrt(dx * dx + dy * dy + dz * dz)
        return d, d
    if number == MAGNETOPAUSE:
        return outside_magnetosphere(x, y, z, p, tables), np.sqrt(x * x + y * y + z * z)
    if number == SUNLIT_FRACTION:
        return sunlit_share(x, y, z, p, tables), 1.0
    inverse = 1.0 / np.sqrt(x * x + y * y + z * z)
    nx, ny, nz, _, _ = direction(t, x, y, z, vx, vy, vz, m, x * inverse, y * inverse, z * inverse, p)
    ax, ay, az, _ = attitude_drag(t, x, y, z, vx, vy, vz, m, nx, ny, nz, p, tables)
    drag = m * np.sqrt(ax * ax + ay * ay + az * az)
    return drag, drag


@called
def under_a_sky(number, time, x, yy, z, vx, vy, vz, m, factor, p, tables):
    """(value, its size) of any quantity but those of a film."""
    held = p.held.active
    p.held.active = 0  # a row is looked up where it is, whatever side the step keeps to
    shaded = number == SUNLIT_FRACTION and p.sky.shadow != NO_SHADOW
    dragged = number == AIR_DRAG and p.pushed.drag_area > 0.0
    if number < PITCH:
        value, size = of_state(number, time, x, yy, z, vx, vy, vz, m, factor, p)
    elif number < SUNLIT_FRACTION and p.brake.present == 0 and p.sky.light != sky.CENTRE:
        value, size = from_the_light(number, time, x, yy, z, vx, vy, vz, m, factor, p, tables)
    elif number < SUNLIT_FRACTION and p.brake.present == 0:
        value, size = of_craft(number, time, x, yy, z, vx, vy, vz, m, factor, p)
    elif number >= SUN_DISTANCE or shaded or dragged:
        value, size = of_sky(number, time, x, yy, z, vx, vy, vz, m, factor, p, tables)
    else:
        value, size = of_low_orbit(number, time, x, yy, z, vx, vy, vz, m, factor, p)
    p.held.active = held
    return value, size


def _of_sky(time, state, parameters, own, number, out):
    p, y, found = record_at(parameters, PARAMETERS), array_at(state, STATE), array_at(out, 4)
    tables = array_at(p.places.address, p.places.end)
    value, size = under_a_sky(number, time, y[0], y[1], y[2], y[3], y[4], y[5], y[6], y[7], p, tables)
    found[0], found[1], found[2], found[3] = value, size, 0.0, 0.0


def sky_quantities() -> Callback:
    """Whatever is watched under a sky, for `dynamics.model`."""
    return callback(_of_sky)
