"""Where the forces of a low orbit have kinks and jumps: the faces of the cells of tables, and the edge of the shadow.

Straight lines between the nodes of a table make a kink at every face of its cells, some fifty in a revolution; steps
that run across them lose up to 1e-5 of the distance in twenty revolutions, whatever the tolerance. Here every step
keeps to one cell, whose values are continued a little beyond its faces, and to sunlight or shadow; and it ends where
the craft leaves them. When that will be is foreseen from position, velocity and acceleration, as a Kepler arc, within a
hundredth of a second, and as the force itself does not jump at a face that is near enough. At the edge of the shadow it
may jump: a step ends NEAR before it, and one more brings the craft there exactly.

A callback of the integrator: compiled when the first scene needs it.
"""

from __future__ import annotations

import numpy as np

from sailviz.compiled import STATE, called, inlined
from sailviz.environment import atmosphere, ionosphere, sun
from sailviz.environment.eclipse import sunlit
from sailviz.environment.gravity import geodetic_altitude
from sailviz.environment.grid import beyond, cell_at
from sailviz.environment.solar_level import next_day
from sailviz.propagate.callbacks import Callback, callback
from sailviz.propagate.low_orbit_callback import plasma_at, power_available, power_drawn, solar_flux
from sailviz.propagate.parameters import PARAMETERS, array_at, record_at

LONGEST_ARC = 0.3  # rad that a Kepler arc may span; as J2's pull turns, 70 m are missed there, a hundredth of a second
LOOKS = 4  # at most along a step, so that a cell that is left and entered again is seen
AHEAD = 0.05  # s after the start of a step at which its cell is looked for: more than a foreseen time is wrong
NEAR = 0.1  # s before the edge of the shadow at which a step ends, to foresee the rest exactly
FACE, EDGE = 1e-4, 1e-7  # s to which the time at a face and at the edge is found
LIGHT_AHEAD = 1e-6  # s after the start of a step at which its light is looked for: more than EDGE


@inlined
def arc(dt, y):
    """Position (m) dt s after the state in y (STATE,), whose last three are the acceleration: series of f and g to the
    fifth order about the central attraction, and the other forces to the second."""
    x, yy, z, vx, vy, vz = y[0], y[1], y[2], y[3], y[4], y[5]
    r2 = x * x + yy * yy + z * z
    # the central attraction as if it were the whole radial acceleration, J2's 1e-3 within
    u = -(y[7] * x + y[8] * yy + y[9] * z) / r2
    p = (x * vx + yy * vy + z * vz) / r2
    q = (vx * vx + vy * vy + vz * vz) / r2 - u
    t2 = dt * dt
    f = 1.0 - u * t2 * (
        0.5 - dt * p * 0.5 - t2 * (3.0 * q - 15.0 * p * p + u) / 24.0
        - t2 * dt * p * (7.0 * p * p - 3.0 * q - u) / 8.0
    )  # fmt: skip
    g = dt - u * t2 * dt * (1.0 / 6.0 - dt * p * 0.25 - t2 * (9.0 * q - 45.0 * p * p + u) / 120.0)
    h = 0.5 * t2
    return (
        f * x + g * vx + h * (y[7] + u * x),
        f * yy + g * vy + h * (y[8] + u * yy),
        f * z + g * vz + h * (y[9] + u * z),
    )


@inlined
def place(t, x, y, z, p):
    """(latitude rad, local time rad, altitude m), by which tables are read."""
    r = np.sqrt(x * x + y * y + z * z)
    altitude = geodetic_altitude(z, r) if p.surface.ellipsoid != 0 else r - p.surface.radius
    return np.arcsin(z / r), sun.local_time(t, x, y, p.sun), altitude


@inlined
def reads_air(p):
    return p.air.kind == atmosphere.TABLED


@inlined
def reads_plasma(p):
    return p.plasma.kind == ionosphere.TABLE_PROFILE and p.brake.present != 0


@inlined
def is_limited(p):
    """Whether the power of a tether in the held light may or may not suffice."""
    return p.brake.present != 0 and 0.0 < power_available(float(p.held.lit), p) < np.inf


@called
def lack_of_power(t, x, yy, z, latitude, local_time, altitude, y, p, tables):
    """Power that the tether would draw at its full voltage over what there is, less 1, at a place at t; the speed,
    which counts little, is that of the state y."""
    w = p.surface.rotation
    qx, qy, qz = y[3] + w * y[1], y[4] - w * y[0], y[5]
    speed = np.sqrt(qx * qx + qy * qy + qz * qz)
    r = np.sqrt(x * x + yy * yy + z * z)
    density, ion_mass = plasma_at(r, latitude, local_time, altitude, solar_flux(t, p), p, tables)
    drawn = power_drawn(density, ion_mass, speed, p.brake.voltage, p)
    return drawn / power_available(float(p.held.lit), p) - 1.0


@called
def outside(t, dt, y, p, tables):
    """How far the arc from y at t is outside the held cells dt s later, in widths of them; negative inside. Likewise
    where the power begins or ceases to suffice, in shares of it."""
    x, yy, z = arc(dt, y)
    latitude, local_time, altitude = place(t + dt, x, yy, z, p)
    far = -1.0
    held = p.held
    if reads_air(p):
        i, j, k = held.air_latitude, held.air_time, held.air_altitude
        far = max(far, beyond(tables, atmosphere.grid_at(p.places.air), latitude, local_time, altitude, i, j, k))
    if reads_plasma(p):
        i, j, k = held.plasma_latitude, held.plasma_time, held.plasma_altitude
        far = max(far, beyond(tables, p.places.plasma, latitude, local_time, altitude, i, j, k))
    if is_limited(p):
        lack = lack_of_power(t + dt, x, yy, z, latitude, local_time, altitude, y, p, tables)
        far = max(far, lack if held.limited == 0 else -lack)
    return far


@called
def light(t, dt, y, p):
    """1 where the arc from y at t is in sunlight dt s later, 0 where more than half of the Sun is hidden."""
    x, yy, z = arc(dt, y)
    sx, sy, sz = sun.direction(t + dt, p.sun)
    return int(sunlit(p.surface.shadow, x, yy, z, sx, sy, sz, p.surface.radius) > 0.5)


@inlined
def enter(t, y, p, tables):
    """Hold the cells in which the craft is a moment later, its light, and whether its power suffices. Returns whether
    the light has changed."""
    held = p.held
    held.active = 1
    before = held.lit
    held.lit = light(t, LIGHT_AHEAD, y, p) if p.brake.power != p.brake.eclipse_power else 1
    x, yy, z = arc(AHEAD, y)
    latitude, local_time, altitude = place(t + AHEAD, x, yy, z, p)
    if reads_air(p):
        i, j, k = cell_at(tables, atmosphere.grid_at(p.places.air), latitude, local_time, altitude)
        held.air_latitude, held.air_time, held.air_altitude = i, j, k
    if reads_plasma(p):
        i, j, k = cell_at(tables, p.places.plasma, latitude, local_time, altitude)
        held.plasma_latitude, held.plasma_time, held.plasma_altitude = i, j, k
    held.limited = 0
    if is_limited(p):
        lack = lack_of_power(t + AHEAD, x, yy, z, latitude, local_time, altitude, y, p, tables)
        held.limited = 1 if lack > 0.0 else 0
    return held.lit != before


@inlined
def face_between(t, low, high, outside_low, outside_high, y, p, tables):
    """Time between low and high (s after t) at which the held cells are left: regula falsi, Illinois' way."""
    side = 0
    for _ in range(30):
        if high - low < FACE:
            break
        middle = low - outside_low * (high - low) / (outside_high - outside_low)
        middle = min(max(middle, low + 0.1 * FACE), high - 0.1 * FACE)
        far = outside(t, middle, y, p, tables)
        if far > 0.0:
            high, outside_high = middle, far
            outside_low *= 0.5 if side > 0 else 1.0
            side = 1
        else:
            low, outside_low = middle, far
            outside_high *= 0.5 if side < 0 else 1.0
            side = -1
    return high


@inlined
def edge_between(t, low, high, y, p):
    """Time between low and high (s after t) at which the light changes, by bisection."""
    while high - low > EDGE:
        middle = 0.5 * (low + high)
        if light(t, middle, y, p) != p.held.lit:
            high = middle
        else:
            low = middle
    return high


@inlined
def next_face(t, span, y, p, tables):
    """Time after t, at most span s, at which the craft leaves the held cells."""
    low, outside_low = AHEAD, outside(t, AHEAD, y, p, tables)
    for look in range(1, LOOKS + 1):
        high = span * look / LOOKS
        if high <= AHEAD:
            continue
        far = outside(t, high, y, p, tables)
        if far > 0.0:
            return face_between(t, low, high, outside_low, far, y, p, tables)
        low, outside_low = high, far
    return span


@inlined
def next_kink(t, span, y, p, tables):
    """Time after t, at most span s, of the next kink of what is read from tables: a face of a cell, or a moment between
    two of which the air or the Sun's level is a straight line in time."""
    if reads_air(p):
        span = min(span, atmosphere.next_season(tables, p.places.air, t))
    if p.solar_level.days > 0:
        span = min(span, next_day(t, p.solar_level))
    if reads_air(p) or reads_plasma(p) or is_limited(p):
        span = next_face(t, span, y, p, tables)
    return span


@inlined
def arc_ahead(y, number):
    """The span, s, of a step of at most `number` s along which a Kepler arc holds."""
    r2 = y[0] * y[0] + y[1] * y[1] + y[2] * y[2]
    v2 = y[3] * y[3] + y[4] * y[4] + y[5] * y[5]
    return min(number, LONGEST_ARC * np.sqrt(r2 / v2))


@inlined
def next_edge(t, span, y, p):
    """Time after t, at most span s, at which a step has to end for the edge of the shadow."""
    low = LIGHT_AHEAD
    for look in range(1, LOOKS + 1):
        high = span * look / LOOKS
        if high > low and light(t, high, y, p) != p.held.lit:
            edge = edge_between(t, low, high, y, p)
            return edge - NEAR if edge > 2.0 * NEAR else edge
        low = high
    return span


def _ahead(time, state, parameters, own, number, out):
    """Before a step of at most `number` s: hold what it keeps to. state : its last three the acceleration, m/s2.
    out : s after which the step has to end, and 1 where the acceleration has jumped here."""
    p = record_at(parameters, PARAMETERS)
    y, tables, found = array_at(state, STATE), array_at(p.places.address, p.places.end), array_at(out, 4)
    jumps = enter(time, y, p, tables)
    span = next_kink(time, arc_ahead(y, number), y, p, tables)
    if p.brake.power != p.brake.eclipse_power:
        span = next_edge(time, span, y, p)
    found[0], found[1], found[2], found[3] = span, 1.0 if jumps else 0.0, 0.0, 0.0


def low_orbit_edges() -> Callback:
    """Where steps in a low orbit end, for `dynamics.model`."""
    return callback(_ahead)
