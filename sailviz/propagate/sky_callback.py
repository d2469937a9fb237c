"""What a sky adds to the right-hand side: bodies that pull, a light that is not at the centre, shadow, magnetosphere.

Callbacks: compiled when the first scene needs them. They share the places of one moment (`environment.sky.set_to`).
"""

from __future__ import annotations

import numpy as np

from sailviz.compiled import STATE, called, entry, inlined
from sailviz.environment import atmosphere, magnetosphere, sky
from sailviz.environment.eclipse import CYLINDER, NO_SHADOW, cylindrical
from sailviz.environment.shadow import lit_share
from sailviz.propagate.callbacks import Callback, callback
from sailviz.propagate.dynamics import direction
from sailviz.propagate.force_callback import growth
from sailviz.propagate.low_orbit_callback import air_density, surroundings
from sailviz.propagate.parameters import PARAMETERS, array_at, record_at
from sailviz.propagate.primer_callback import primer, throttle
from sailviz.propulsion.devices import ELECTRIC_SAIL, SOLAR_SAIL
from sailviz.propulsion.electric_sail import esail_force
from sailviz.propulsion.solar_sail import sail_force
from sailviz.steering import by_light
from sailviz.steering.optimal import B1, B3, steer, towards_primer
from sailviz.steering.primers import PERIAPSIS, locally_optimal_primer


@inlined
def seen_from(body, x, y, z, p, tables):
    """A place and the light, m, relative to a body of the sky (-1: the central one), and the radius, m, that shades."""
    at = p.places.sky
    lx, ly, lz = tables[at + sky.LIGHT], tables[at + sky.LIGHT + 1], tables[at + sky.LIGHT + 2]
    radius = p.sky.centre_radius
    if body >= 0:
        row = at + sky.HEAD + sky.BODY * body
        radius = tables[row + sky.RADIUS]
        bx, by, bz = tables[row + sky.X], tables[row + sky.X + 1], tables[row + sky.X + 2]
        x, y, z, lx, ly, lz = x - bx, y - by, z - bz, lx - bx, ly - by, lz - bz
    return x, y, z, lx, ly, lz, radius


@called
def _share_past(body, x, y, z, p, tables):
    """Lit share of the light that passes one body of the sky (-1: the central one)."""
    x, y, z, lx, ly, lz, radius = seen_from(body, x, y, z, p, tables)
    if radius == 0.0:
        return 1.0
    if p.sky.shadow == CYLINDER:
        inverse = 1.0 / np.sqrt(lx * lx + ly * ly + lz * lz)
        return cylindrical(x, y, z, lx * inverse, ly * inverse, lz * inverse, radius)
    return lit_share(x, y, z, lx, ly, lz, radius, p.sky.light_radius)


@called
def sunlit_share(x, y, z, p, tables):
    """Lit share of the light's disc, 0 to 1, at a place (m): the product over all bodies that cast a shadow."""
    if p.sky.shadow == NO_SHADOW:
        return 1.0
    if p.held.active != 0 and p.sky.shadow == CYLINDER:
        return float(p.sides.lit)
    share = 1.0
    for body in range(-1, p.sky.bodies):
        share *= _share_past(body, x, y, z, p, tables)
    return share


@called
def outside_magnetosphere(x, y, z, p, tables):
    """Distance, m, from the magnetopause, positive in the wind."""
    x, y, z, lx, ly, lz, _ = seen_from(p.magnetosphere.body, x, y, z, p, tables)
    return magnetosphere.outside(x, y, z, lx, ly, lz, p.magnetosphere)


@inlined
def in_wind(x, y, z, p, tables):
    """1 in the solar wind, 0 inside the magnetosphere."""
    if p.magnetosphere.kind == magnetosphere.NONE:
        return 1.0
    if p.held.active != 0:
        return float(p.sides.windy)
    return 1.0 if outside_magnetosphere(x, y, z, p, tables) > 0.0 else 0.0


@inlined
def _periapsis(x, y, z, vx, vy, vz, mu):
    """Distance of the osculating periapsis, m."""
    hx, hy, hz = y * vz - z * vy, z * vx - x * vz, x * vy - y * vx
    p = (hx * hx + hy * hy + hz * hz) / mu
    energy = 0.5 * (vx * vx + vy * vy + vz * vz) - mu / np.sqrt(x * x + y * y + z * z)
    return p / (1.0 + np.sqrt(max(0.0, 1.0 + 2.0 * energy * p / mu)))


@called
def guarded_primer(t, x, y, z, vx, vy, vz, p, tables):
    """The primer of the law and its readiness. Where the periapsis is near the lowest that is allowed, the primer that
    raises it gains weight, and it stands alone from there down."""
    lx, ly, lz, ready = primer(t, x, y, z, vx, vy, vz, p, tables)
    guard = p.by_light
    if guard.lowest == 0.0:
        return lx, ly, lz, ready
    room = (_periapsis(x, y, z, vx, vy, vz, p.primer.mu) - guard.lowest) / guard.margin
    if room >= 1.0:
        return lx, ly, lz, ready
    gx, gy, gz = locally_optimal_primer(PERIAPSIS, x, y, z, vx, vy, vz, p.primer.mu)
    if room <= 0.0:
        return gx, gy, gz, 1.0
    size, other = np.sqrt(lx * lx + ly * ly + lz * lz), np.sqrt(gx * gx + gy * gy + gz * gz)
    if size == 0.0:
        return gx, gy, gz, 1.0
    k = (1.0 - room) / room * size / other
    return lx + k * gx, ly + k * gy, lz + k * gz, max(ready, 1.0 - room)


@inlined
def share_wanted(h, ready, p, tables):
    """Throttle of a law that finds h along its primer. A film that only mirrors turns its thrust off by itself, evenly;
    for others it fades out where h vanishes, as round the Sun."""
    at = p.places.sail
    if p.primer.sail == SOLAR_SAIL and tables[at + B1] == 0.0 and tables[at + B3] == 0.0:
        return ready if h > 0.0 else 0.0
    return throttle(h, ready, p)


@called
def normal(t, x, y, z, vx, vy, vz, p, tables):
    """(unit sail normal, throttle) of a law that counts from the light."""
    at = p.places.sky
    sky.set_to(t, at, p.sky, tables)
    ux, uy, uz, near = sky.from_light(x, y, z, at, tables)
    law = p.by_light.law
    if p.by_light.edge_on != 0 and sunlit_share(x, y, z, p, tables) == 0.0:
        nx, ny, nz = by_light.edge_on(ux, uy, uz, vx, vy, vz)
        return nx, ny, nz, 1.0
    if law == by_light.FRAME:
        nx, ny, nz = by_light.frame_direction(ux, uy, uz, x, y, z, vx, vy, vz, p.by_light)
        return nx, ny, nz, 1.0
    if law == by_light.ON_OFF:
        receding = p.sides.receding != 0 if p.held.active != 0 else vx * ux + vy * uy + vz * uz > 0.0
        if receding:
            return ux, uy, uz, 1.0
        nx, ny, nz = by_light.edge_on(ux, uy, uz, vx, vy, vz)
        return nx, ny, nz, 1.0
    if law == by_light.PRIMER:
        lx, ly, lz, ready = guarded_primer(t, x, y, z, vx, vy, vz, p, tables)
        nx, ny, nz, h = towards_primer(
            p.primer.sail, tables, p.places.sail, 1.0 / (near * near), ux, uy, uz, lx, ly, lz
        )
        return nx, ny, nz, share_wanted(h, ready, p, tables)
    return ux, uy, uz, 1.0


def _gravity(time, state, parameters, own, number, out):
    """Acceleration, m/s2, by all bodies of the sky that pull."""
    p = record_at(parameters, PARAMETERS)
    y, tables, a = array_at(state, STATE), array_at(p.places.address, p.places.end), array_at(out, 4)
    sky.set_to(time, p.places.sky, p.sky, tables)
    a[0], a[1], a[2] = sky.pulls(y[0], y[1], y[2], p.places.sky, p.sky.bodies, tables)
    a[3] = 0.0


def _normal(time, state, parameters, own, number, out):
    """The normal and the throttle."""
    p = record_at(parameters, PARAMETERS)
    y, tables, n = array_at(state, STATE), array_at(p.places.address, p.places.end), array_at(out, 4)
    n[0], n[1], n[2], n[3] = normal(time, y[0], y[1], y[2], y[3], y[4], y[5], p, tables)


def _thrust(time, state, parameters, own, number, out):
    """Acceleration, m/s2, of a sail in the light or in the wind."""
    p = record_at(parameters, PARAMETERS)
    y, tables, a = array_at(state, STATE), array_at(p.places.address, p.places.end), array_at(out, 4)
    at = p.places.sky
    sky.set_to(time, at, p.sky, tables)
    x, yy, z, nx, ny, nz = y[0], y[1], y[2], y[7], y[8], y[9]
    ux, uy, uz, inverse = sky.from_light(x, yy, z, at, tables)
    c = ux * nx + uy * ny + uz * nz
    a[0], a[1], a[2], a[3] = 0.0, 0.0, 0.0, 0.0
    if p.pushed.device == SOLAR_SAIL:
        share = sunlit_share(x, yy, z, p, tables)
        if share > 0.0:
            sail = p.solar_sail
            k = number * share * growth(p.pushed.mass, y[6]) * sail.strength
            a[0], a[1], a[2] = sail_force(ux, uy, uz, inverse, nx, ny, nz, c, k, sail.b1, sail.b2, sail.b3)
    elif p.pushed.device == ELECTRIC_SAIL:
        blows = in_wind(x, yy, z, p, tables)
        if blows > 0.0:
            esail = p.electric_sail
            k = number * growth(p.pushed.mass, y[6]) * esail.characteristic_acceleration
            model = int(esail.model)
            a[0], a[1], a[2] = esail_force(ux, uy, uz, inverse, nx, ny, nz, c, k, model, esail.pitch_limit)


@called
def attitude_drag(t, x, yy, z, vx, vy, vz, m, nx, ny, nz, p, tables):
    """(acceleration m/s2, density kg/m3) of the air on a sail that stands as its normal says."""
    r = np.sqrt(x * x + yy * yy + z * z)
    latitude, local_time, altitude, f107, _ = surroundings(t, x, yy, z, r, p)
    density = air_density(t, r, latitude, local_time, altitude, f107, p, tables)
    w = p.surface.rotation
    qx, qy, qz = vx + w * yy, vy - w * x, vz
    across = (nx * qx + ny * qy + nz * qz) / np.sqrt(qx * qx + qy * qy + qz * qz)
    across = across * p.sides.facing if p.held.active != 0 else abs(across)
    area = p.pushed.drag_area * across + p.pushed.edge_area
    ax, ay, az = atmosphere.air_drag(x, yy, z, vx, vy, vz, w, density * area / m)
    return ax, ay, az, density


def _drag(time, state, parameters, own, number, out):
    """Acceleration, m/s2, of the air, by the attitude that the law asks for."""
    p = record_at(parameters, PARAMETERS)
    y, tables, a = array_at(state, STATE), array_at(p.places.address, p.places.end), array_at(out, 4)
    inverse = 1.0 / np.sqrt(y[0] * y[0] + y[1] * y[1] + y[2] * y[2])
    ux, uy, uz = y[0] * inverse, y[1] * inverse, y[2] * inverse
    nx, ny, nz, _, _ = direction(time, y[0], y[1], y[2], y[3], y[4], y[5], y[6], ux, uy, uz, p)
    ax, ay, az, _ = attitude_drag(time, y[0], y[1], y[2], y[3], y[4], y[5], y[6], nx, ny, nz, p, tables)
    a[0], a[1], a[2], a[3] = ax, ay, az, 0.0


def sky_gravity() -> Callback:
    """Bodies that pull, for `dynamics.model`."""
    return callback(_gravity)


def sky_steering() -> Callback:
    """Laws that count from the light."""
    return callback(_normal)


def sky_thrust() -> Callback:
    """A sail in the light or in the wind."""
    return callback(_thrust)


def sky_drag() -> Callback:
    """Air on a sail by its attitude."""
    return callback(_drag)


# Columns of `observe_sky`
FROM_LIGHT, DISTANCE, SHARE, WIND, EAST, NORTH, AIR_DENSITY, AIR_DRAG = 0, 3, 4, 5, 6, 9, 12, 13
COLUMNS = 14  # vectors: from the light to the craft, east and north of its frame


def observe_sky(time, states, normals, parameters):
    """What a sky does at given states: (COLUMNS, n), SI, as named above. time (n,), states (7, n), normals (n, 3)."""
    out = np.zeros((COLUMNS, len(time)))
    _observe(time, states, normals, parameters, out)
    return out


@entry("d1 d2 d2 r1 D2", PARAMETERS)
def _observe(time, states, normals, parameters, out):
    """`observe_sky` into zeros."""
    p = parameters[0]
    tables, at = array_at(p.places.address, p.places.end), p.places.sky
    for i in range(len(time)):
        x, y, z = states[0, i], states[1, i], states[2, i]
        vx, vy, vz, m = states[3, i], states[4, i], states[5, i], states[6, i]
        sky.set_to(time[i], at, p.sky, tables)
        ux, uy, uz, inverse = sky.from_light(x, y, z, at, tables)
        out[FROM_LIGHT, i], out[FROM_LIGHT + 1, i], out[FROM_LIGHT + 2, i] = ux, uy, uz
        out[DISTANCE, i] = 1.0 / inverse
        out[SHARE, i] = sunlit_share(x, y, z, p, tables)
        out[WIND, i] = in_wind(x, y, z, p, tables)
        ex, ey, ez, wx, wy, wz = by_light.light_axes(ux, uy, uz, x, y, z, vx, vy, vz, p.by_light)
        out[EAST, i], out[EAST + 1, i], out[EAST + 2, i] = ex, ey, ez
        out[NORTH, i], out[NORTH + 1, i], out[NORTH + 2, i] = wx, wy, wz
        if p.pushed.drag_area > 0.0 and p.air.kind != atmosphere.NONE:
            nx, ny, nz = normals[i, 0], normals[i, 1], normals[i, 2]
            ax, ay, az, density = attitude_drag(time[i], x, y, z, vx, vy, vz, m, nx, ny, nz, p, tables)
            out[AIR_DENSITY, i], out[AIR_DRAG, i] = density, m * np.sqrt(ax * ax + ay * ay + az * az)
    return 0


def observe_sky_primer(time, states, parameters):
    """`primer_callback.observe_primer` of a law that counts from the light."""
    out, support = np.empty((len(time), 3)), np.empty(len(time))
    _observe_primer(time, states, parameters, out, support)
    return out, support


@entry("d1 d2 r1 D2 D1", PARAMETERS)
def _observe_primer(time, states, parameters, out, support):
    """`observe_sky_primer` without its arrays made."""
    p = parameters[0]
    tables, at = array_at(p.places.address, p.places.end), p.places.sky
    for i in range(len(time)):
        y = states[:, i]
        lx, ly, lz, ready = guarded_primer(time[i], y[0], y[1], y[2], y[3], y[4], y[5], p, tables)
        size = np.sqrt(lx * lx + ly * ly + lz * lz)
        if size == 0.0:
            out[i, :], support[i] = 0.0, 0.0
            continue
        lx, ly, lz = lx / size, ly / size, lz / size
        out[i, 0], out[i, 1], out[i, 2] = lx, ly, lz
        sky.set_to(time[i], at, p.sky, tables)
        ux, uy, uz, _ = sky.from_light(y[0], y[1], y[2], at, tables)
        c = min(max(lx * ux + ly * uy + lz * uz, -1.0), 1.0)
        h = steer(p.primer.sail, tables, p.places.sail, c, np.sqrt(1.0 - c * c), 0.0)[2]
        support[i] = h * share_wanted(h, ready, p, tables)
    return 0
