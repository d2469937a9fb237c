"""What an event watches beside the kinds that are built in: any quantity that is a function of time and state.

A callback, one number at a time: the quantity by its place in QUANTITIES, and how large it is, against which rounding
counts. Four of them, so that a scene compiles no more than it watches: what the state alone says (its formulas stand
in run/formulas.py), how a craft that turns stands, what steering and device do, and what surrounds a craft in low
orbit. Values are those of the rows
of a run, but for two, watched by their inverses, which go on where they are infinite: `INVERSE`.
"""

from __future__ import annotations

from collections.abc import Collection

import numpy as np

from sailviz.compiled import STATE, called, inlined
from sailviz.constants import J2_EARTH, RADIUS_EARTH
from sailviz.propagate.callbacks import Callback, callback
from sailviz.propagate.dynamics import device_acceleration, direction
from sailviz.propagate.low_orbit_callback import observe_at
from sailviz.propagate.parameters import PARAMETERS, array_at, record_at
from sailviz.propulsion.devices import NO_DEVICE, PLASMA_BRAKE
from sailviz.propulsion.plasma_brake import NEGATIVE
from sailviz.run import formulas

OF_STATE = (
    "time", "radius", "altitude", "elevation", "height", "longitude", "speed", "radial_speed", "transverse_speed",
    "flight_path_angle", "energy", "angular_momentum", "angular_momentum_z", "mass", "semi_major_axis", "eccentricity",
    "inclination", "raan", "true_anomaly", "periapsis", "apoapsis", "perigee_altitude", "apogee_altitude",
    "mean_altitude", "thrust_factor",
)  # fmt: skip
OF_CRAFT = ("pitch", "cone", "clock", "thrust_acceleration")
OF_ATTITUDE = ("pitch", "clock")  # of OF_CRAFT, those that the normal tells
OF_LOW_ORBIT = (
    "sunlit_fraction", "air_drag", "plasma_density", "plasma_force", "tether_voltage", "tether_current", "tether_power",
    "tether_tilt",
)  # fmt: skip
OF_SKY = ("sun_distance", "moon_distance")  # known to sky_quantities
OF_FILM = ("dose", "film_temperature")  # known to film_quantities
OF_WHEEL = ("spin_rate", "modulation", "thrust_lost", "wheel_torque")  # known to wheel_callback
OF_BODY = ("body_rate", "nutation", "wheel_momentum")  # of a craft that turns, known to body_quantities
QUANTITIES = (*OF_STATE, *OF_CRAFT, *OF_LOW_ORBIT, *OF_SKY, *OF_FILM, *OF_WHEEL, *OF_BODY)
(
    TIME, RADIUS, ALTITUDE, ELEVATION, HEIGHT, LONGITUDE, SPEED, RADIAL_SPEED, TRANSVERSE_SPEED, FLIGHT_PATH_ANGLE,
    ENERGY, ANGULAR_MOMENTUM, ANGULAR_MOMENTUM_Z, MASS, SEMI_MAJOR_AXIS, ECCENTRICITY, INCLINATION, RAAN, TRUE_ANOMALY,
    PERIAPSIS, APOAPSIS, PERIGEE_ALTITUDE, APOGEE_ALTITUDE, MEAN_ALTITUDE, THRUST_FACTOR,
    PITCH, CONE, CLOCK, THRUST_ACCELERATION,
    SUNLIT_FRACTION, AIR_DRAG, PLASMA_DENSITY, PLASMA_FORCE, TETHER_VOLTAGE, TETHER_CURRENT, TETHER_POWER, TETHER_TILT,
    SUN_DISTANCE, MOON_DISTANCE, DOSE, FILM_TEMPERATURE,
    SPIN_RATE, MODULATION, THRUST_LOST, WHEEL_TORQUE,
) = range(len(QUANTITIES) - len(OF_BODY))  # fmt: skip
MAGNETOPAUSE = len(QUANTITIES)  # how far outside it the craft is, m: no quantity of a scene, but of "wind on"
INVERSE = ("semi_major_axis", "apoapsis", "apogee_altitude")  # watched as -1 / (distance from the centre, m)
OBLATENESS_EARTH = J2_EARTH * RADIUS_EARTH**2  # m2


@called
def of_state(number, t, x, y, z, vx, vy, vz, m, factor, p):
    """(value, its size) of a quantity of OF_STATE."""
    mu, surface = p.gravity.mu, p.surface.radius
    r = formulas.radius(x, y, z)
    if number == TIME:
        return t, abs(t)
    if number == RADIUS:
        return r, r
    if number == ALTITUDE:
        return r - surface, r
    if number == ELEVATION:
        return formulas.elevation(x, y, z), 1.0
    if number == HEIGHT:
        return z, r
    if number == LONGITUDE:
        return formulas.longitude(x, y), 1.0
    speed = np.sqrt(vx * vx + vy * vy + vz * vz)
    if number == SPEED:
        return speed, speed
    if number == RADIAL_SPEED:
        return formulas.radial_speed(x, y, z, vx, vy, vz), speed
    if number == TRANSVERSE_SPEED:
        return formulas.transverse_speed(x, y, z, vx, vy, vz), speed
    if number == FLIGHT_PATH_ANGLE:
        return formulas.flight_path_angle(x, y, z, vx, vy, vz), 1.0
    if number == ENERGY:
        return formulas.energy(x, y, z, vx, vy, vz, mu), mu / r
    if number == ANGULAR_MOMENTUM:
        return formulas.angular_momentum(x, y, z, vx, vy, vz), r * speed
    if number == ANGULAR_MOMENTUM_Z:
        return formulas.angular_momentum_z(x, y, vx, vy), r * speed
    if number == MASS:
        return m, m
    if number == THRUST_FACTOR:
        return factor, 1.0
    return of_orbit(number, x, y, z, vx, vy, vz, mu, surface, p.gravity.j2_strength != 0.0)


@called
def of_orbit(number, x, y, z, vx, vy, vz, mu, surface, oblate):
    """(value, its size) of a quantity of the osculating orbit."""
    r = formulas.radius(x, y, z)
    if number == SEMI_MAJOR_AXIS:
        return -formulas.inverse_axis(x, y, z, vx, vy, vz, mu), 1.0 / r
    if number == ECCENTRICITY:
        return formulas.eccentricity(x, y, z, vx, vy, vz, mu), 1.0
    if number == INCLINATION:
        return formulas.inclination(x, y, z, vx, vy, vz), 1.0
    if number == RAAN:
        return formulas.raan(x, y, z, vx, vy, vz), 1.0
    if number == TRUE_ANOMALY:
        return formulas.true_anomaly(x, y, z, vx, vy, vz, mu), 1.0
    if number == PERIAPSIS:
        return formulas.periapsis(x, y, z, vx, vy, vz, mu), r
    if number == PERIGEE_ALTITUDE:
        return formulas.periapsis(x, y, z, vx, vy, vz, mu) - surface, r
    if number in (APOAPSIS, APOGEE_ALTITUDE):
        return -formulas.inverse_apoapsis(x, y, z, vx, vy, vz, mu), 1.0 / r
    inverse = formulas.inverse_axis(x, y, z, vx, vy, vz, mu)
    if not inverse > 0.0:
        return np.nan, r  # an open orbit has no mean
    swing = formulas.oblate_swing(x, y, z, vx, vy, vz, mu, OBLATENESS_EARTH) if oblate else 0.0
    return 1.0 / inverse - swing - surface, r


@inlined
def angles(number, x, y, z, vx, vy, vz, nx, ny, nz):
    """(pitch or cone of a vector, or its clock, rad; 1): as `frames.pitch_cone_clock`."""
    r = formulas.radius(x, y, z)
    hx, hy, hz = y * vz - z * vy, z * vx - x * vz, x * vy - y * vx
    h = np.sqrt(hx * hx + hy * hy + hz * hz)
    along = (x * nx + y * ny + z * nz) / r
    up = (hx * nx + hy * ny + hz * nz) / h
    ahead = ((hy * z - hz * y) * nx + (hz * x - hx * z) * ny + (hx * y - hy * x) * nz) / (h * r)
    if number == CLOCK:
        return (np.arctan2(ahead, up) if np.hypot(ahead, up) > 1e-12 else 0.0), 1.0
    return np.arctan2(np.hypot(ahead, up), along), 1.0


@called
def of_craft(number, t, x, y, z, vx, vy, vz, m, factor, p):
    """(value, its size) of a quantity of OF_CRAFT; not of a plasma brake."""
    inverse = 1.0 / formulas.radius(x, y, z)
    if number in (PITCH, CLOCK):
        nx, ny, nz, _, _ = direction(t, x, y, z, vx, vy, vz, m, x * inverse, y * inverse, z * inverse, p)
        return angles(number, x, y, z, vx, vy, vz, nx, ny, nz)
    ax, ay, az = 0.0, 0.0, 0.0
    if factor != 0.0 and p.kinds.device != NO_DEVICE and p.kinds.device != PLASMA_BRAKE:
        ax, ay, az, _ = device_acceleration(t, x, y, z, vx, vy, vz, m, inverse, factor, p)
    size = np.sqrt(ax * ax + ay * ay + az * az)
    if number == THRUST_ACCELERATION:
        return size, size
    return angles(CONE, x, y, z, vx, vy, vz, ax, ay, az)


@called
def of_low_orbit(number, t, x, y, z, vx, vy, vz, m, factor, p):
    """(value, its size) of a quantity of OF_LOW_ORBIT, or of OF_CRAFT of a plasma brake."""
    tables = array_at(p.places.address, p.places.end)
    held = p.held.active
    p.held.active = 0  # a row is looked up where it is, whatever cell the step keeps to
    (
        _, _, _, _, light, _, drag, plasma, _, force, voltage, current, power, tilt, fx, fy, fz, sx, sy, sz,
    ) = observe_at(t, x, y, z, vx, vy, vz, m, factor, p, tables)  # fmt: skip
    p.held.active = held
    if number == SUNLIT_FRACTION:
        return light, 1.0
    if number == AIR_DRAG:
        return drag, drag
    if number == PLASMA_DENSITY:
        return plasma, plasma
    if number == PLASMA_FORCE:
        return force, force
    if number == TETHER_VOLTAGE:
        return (voltage if p.brake.polarity != NEGATIVE else -voltage), voltage
    if number == TETHER_CURRENT:
        return current, current
    if number == TETHER_POWER:
        return power, power
    if number == TETHER_TILT:
        return tilt, 1.0
    if number in (PITCH, CLOCK):
        return angles(number, x, y, z, vx, vy, vz, sx, sy, sz)
    k = factor / m
    if number == CONE:
        return angles(CONE, x, y, z, vx, vy, vz, k * fx, k * fy, k * fz)
    size = k * np.sqrt(fx * fx + fy * fy + fz * fz)
    return size, size


def _of_state(time, state, parameters, own, number, out):
    p, y, found = record_at(parameters, PARAMETERS), array_at(state, STATE), array_at(out, 4)
    value, size = of_state(number, time, y[0], y[1], y[2], y[3], y[4], y[5], y[6], y[7], p)
    found[0], found[1], found[2], found[3] = value, size, 0.0, 0.0


def _of_craft(time, state, parameters, own, number, out):
    p, y, found = record_at(parameters, PARAMETERS), array_at(state, STATE), array_at(out, 4)
    if number < PITCH:
        value, size = of_state(number, time, y[0], y[1], y[2], y[3], y[4], y[5], y[6], y[7], p)
    else:
        value, size = of_craft(number, time, y[0], y[1], y[2], y[3], y[4], y[5], y[6], y[7], p)
    found[0], found[1], found[2], found[3] = value, size, 0.0, 0.0


def _of_attitude(time, state, parameters, own, number, out):
    p, y, found = record_at(parameters, PARAMETERS), array_at(state, STATE), array_at(out, 4)
    nx, ny, nz = p.inertial.x, p.inertial.y, p.inertial.z  # where the motion of the body has it
    value, size = angles(number, y[0], y[1], y[2], y[3], y[4], y[5], nx, ny, nz)
    found[0], found[1], found[2], found[3] = value, size, 0.0, 0.0


def _of_low_orbit(time, state, parameters, own, number, out):
    p, y, found = record_at(parameters, PARAMETERS), array_at(state, STATE), array_at(out, 4)
    if number < PITCH:
        value, size = of_state(number, time, y[0], y[1], y[2], y[3], y[4], y[5], y[6], y[7], p)
    elif number < SUNLIT_FRACTION and p.brake.present == 0:
        value, size = of_craft(number, time, y[0], y[1], y[2], y[3], y[4], y[5], y[6], y[7], p)
    else:
        value, size = of_low_orbit(number, time, y[0], y[1], y[2], y[3], y[4], y[5], y[6], y[7], p)
    found[0], found[1], found[2], found[3] = value, size, 0.0, 0.0


def quantity_callback(watched: Collection[str], low_orbit: bool, turns: bool = False) -> Callback:
    """Whatever is watched, for `dynamics.model`. low_orbit : whether a tether or air tell the attitude and the rest;
    turns : whether the craft has a motion of its own about its centre of mass."""
    if turns and all(name in OF_ATTITUDE for name in watched):
        return callback(_of_attitude)
    if any(name in OF_LOW_ORBIT for name in watched) or (low_orbit and any(name in OF_CRAFT for name in watched)):
        return callback(_of_low_orbit)
    return callback(_of_craft if any(name in OF_CRAFT for name in watched) else _of_state)
