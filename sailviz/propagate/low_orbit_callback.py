"""What a low orbit adds to the right-hand side: the Sun and the shadow, tabled air, plasma, and the brake that uses it.

A callback: compiled when the first scene needs it.
"""

from __future__ import annotations

import numpy as np

from sailviz.compiled import STATE, called, entry, inlined
from sailviz.constants import ELEMENTARY_CHARGE, MU_EARTH, ROTATION_EARTH
from sailviz.environment import atmosphere, ionosphere, magnetic, sun
from sailviz.environment.eclipse import NO_SHADOW, sunlit
from sailviz.environment.gravity import geodetic_altitude
from sailviz.environment.grid import held_cell
from sailviz.environment.solar_level import flux, flux_of_days
from sailviz.propagate.callbacks import Callback, callback
from sailviz.propagate.parameters import PARAMETERS, array_at, record_at
from sailviz.propulsion.plasma_brake import (
    NEGATIVE,
    SPINNING,
    TILTED,
    negative_force_per_length,
    positive_force_per_length,
    tether_current,
)


@inlined
def solar_flux(t, p):
    """F10.7, sfu, by which the tables of plasma and air are read."""
    if p.solar_level.days > 0:
        return flux_of_days(t, p.solar_level, array_at(p.places.address, p.places.end), p.places.solar_level)
    return flux(t, p.solar_level)


@called
def surroundings(t, x, y, z, r, p):
    """(latitude rad, local time rad from midnight, altitude m, solar flux sfu, sunlit share) of a place, for what
    depends on them."""
    altitude = r - p.surface.radius
    if p.surface.ellipsoid != 0:
        altitude = geodetic_altitude(z, r)
    latitude, local_time, f107, light = 0.0, 0.0, 0.0, 1.0
    if p.plasma.kind == ionosphere.TABLE_PROFILE or p.air.kind == atmosphere.TABLED:
        latitude = np.arcsin(z / r)
        local_time = sun.local_time(t, x, y, p.sun)
        f107 = solar_flux(t, p)
    if p.held.active != 0:
        light = float(p.held.lit)
    elif p.surface.shadow != NO_SHADOW:
        sx, sy, sz = sun.direction(t, p.sun)
        light = sunlit(p.surface.shadow, x, y, z, sx, sy, sz, p.surface.radius)
    return latitude, local_time, altitude, f107, light


@called
def air_density(t, r, latitude, local_time, altitude, f107, p, tables):
    """Mass density of the air, kg/m3."""
    if p.air.kind == atmosphere.TABLED:
        if p.held.active != 0:
            i, j, k = p.held.air_latitude, p.held.air_time, p.held.air_altitude
            grid = atmosphere.grid_at(p.places.air)
            place = held_cell(tables, grid, latitude, local_time, altitude, f107, 1, i, j, k)
            return atmosphere.density_in(tables, p.places.air, t, place)
        return atmosphere.lookup(tables, p.places.air, t, latitude, local_time, altitude, f107)
    return ionosphere.exponential(r, p.air.reference_radius, p.air.density, p.air.scale_height)


@called
def plasma_at(r, latitude, local_time, altitude, f107, p, tables):
    """(density 1/m3, mean ion mass kg) of the plasma; of a given force profile (force per length N/m, 0)."""
    plasma = p.plasma
    if plasma.kind == ionosphere.TABLE_PROFILE:
        if p.held.active != 0:
            i, j, k = p.held.plasma_latitude, p.held.plasma_time, p.held.plasma_altitude
            place = held_cell(tables, p.places.plasma, latitude, local_time, altitude, f107, 2, i, j, k)
            n, mass = ionosphere.plasma_in(tables, place)
            return n * plasma.density_factor, mass
        n, mass = ionosphere.lookup(tables, p.places.plasma, latitude, local_time, altitude, f107)
        return n * plasma.density_factor, mass
    height = r - plasma.surface_radius
    value = ionosphere.exponential(height, plasma.reference_altitude, plasma.value, plasma.scale_height)
    return value * plasma.density_factor, plasma.ion_mass


@called
def power_drawn(density, ion_mass, speed, voltage, p):
    """Power, W, that the supply needs to hold the tether at |V|."""
    current = tether_current(density, ion_mass, speed, voltage, p.brake.length, p.brake.wire_diameter, p.brake.polarity)
    return voltage * current / p.brake.efficiency


@inlined
def power_available(light, p):
    """Power for the tether, W, in sunlight or in the shadow."""
    return p.brake.power if light > 0.5 else p.brake.eclipse_power


@called
def applied_voltage(density, ion_mass, speed, light, p):
    """|V| that the power allows, V: full, or what the power in sunlight or in the shadow supports."""
    power = power_available(light, p)
    if power == np.inf:
        return p.brake.voltage
    if power == 0.0:
        return 0.0
    voltage = p.brake.voltage
    drawn = power_drawn(density, ion_mass, speed, voltage, p)
    if p.held.limited == 0 if p.held.active != 0 else drawn <= power:
        return voltage
    for _ in range(3):  # from above, as the power grows less than with V^1.5: the ram speed is 1 % of it at 100 V
        voltage *= (power / drawn) ** (2.0 / 3.0)
        drawn = power_drawn(density, ion_mass, speed, voltage, p)
    return voltage * (power / drawn)  # never above: the power grows faster than the voltage


@called
def per_length(density, ion_mass, speed, voltage, p):
    """Force on a metre of tether across the flow, N/m; density is that force itself for a given force profile."""
    if p.plasma.kind == ionosphere.FORCE_PROFILE:
        return density * (voltage > 0.0)
    if voltage * 2.0 * ELEMENTARY_CHARGE <= ion_mass * speed * speed:
        return 0.0  # below the ram energy hardly an ion is turned back, and a weak sheath has no width
    if p.brake.polarity != NEGATIVE:
        return positive_force_per_length(density, ion_mass, speed, voltage)
    return negative_force_per_length(density, ion_mass, speed, voltage, p.brake.wire_radius)


@called
def brake_force(t, x, y, z, vx, vy, vz, r, density, ion_mass, light, p):
    """Drag on a plasma-brake tether, N inertial; its size per length N/m; the unit vector from tip to satellite; |V|.

    Drag opposes the component of the plasma-relative velocity across the tether; the plasma turns with the body. A
    tilted tether leans as far as the drag on a vertical one would push it.
    """
    w = p.surface.rotation
    qx, qy, qz = vx + w * y, vy - w * x, vz
    sx, sy, sz = x / r, y / r, z / r
    speed = np.sqrt(qx * qx + qy * qy + qz * qz)
    voltage = applied_voltage(density, ion_mass, speed, light, p)
    factor = 1.0
    if p.brake.attitude == SPINNING:
        factor = p.brake.spin_factor  # the mean over a turn acts against the whole flow
        along = 0.0
    else:
        along = qx * sx + qy * sy + qz * sz
    if p.brake.attitude == TILTED:
        hx, hy, hz = qx - along * sx, qy - along * sy, qz - along * sz
        across = np.sqrt(hx * hx + hy * hy + hz * hz)
        push = per_length(density, ion_mass, across, voltage, p)
        tangent = push * r * r * r / (6.0 * MU_EARTH * p.brake.tip_mass)
        c = 1.0 / np.sqrt(1.0 + tangent * tangent)
        k = c * tangent / across
        sx, sy, sz = c * sx + k * hx, c * sy + k * hy, c * sz + k * hz
        along = qx * sx + qy * sy + qz * sz
    qx, qy, qz = qx - along * sx, qy - along * sy, qz - along * sz
    across = np.sqrt(qx * qx + qy * qy + qz * qz)
    force = factor * per_length(density, ion_mass, across, voltage, p)
    if p.brake.magnetic_sensitivity != 0.0:
        angle = p.brake.earth_angle + ROTATION_EARTH * t
        force *= 1.0 - p.brake.magnetic_sensitivity * magnetic.alignment(x, y, z, 1.0 / r, angle, sx, sy, sz)
    k = -force * p.brake.length / across
    return k * qx, k * qy, k * qz, force, sx, sy, sz, voltage


def _acceleration(t, state, parameters, own, factor, out):
    """Acceleration, m/s2, of tabled air and of the brake. They share what they need to know of the place."""
    p = record_at(parameters, PARAMETERS)
    y, tables, a = array_at(state, STATE), array_at(p.places.address, p.places.end), array_at(out, 4)
    x, yy, z, vx, vy, vz, m = y[0], y[1], y[2], y[3], y[4], y[5], y[6]
    r = np.sqrt(x * x + yy * yy + z * z)
    latitude, local_time, altitude, f107, light = surroundings(t, x, yy, z, r, p)
    ax, ay, az = 0.0, 0.0, 0.0
    if p.air.kind == atmosphere.TABLED:
        k = air_density(t, r, latitude, local_time, altitude, f107, p, tables) * p.air.drag_area / m
        ax, ay, az = atmosphere.air_drag(x, yy, z, vx, vy, vz, p.surface.rotation, k)
    if factor != 0.0 and p.brake.present != 0:
        n, ion_mass = plasma_at(r, latitude, local_time, altitude, f107, p, tables)
        fx, fy, fz, _, _, _, _, _ = brake_force(t, x, yy, z, vx, vy, vz, r, n, ion_mass, light, p)
        k = factor / m
        ax, ay, az = ax + k * fx, ay + k * fy, az + k * fz
    a[0], a[1], a[2], a[3] = ax, ay, az, 0.0


def low_orbit_forces() -> Callback:
    """The forces of a low orbit, for `dynamics.model`."""
    return callback(_acceleration)


# Columns of `observe_low_orbit`
(LATITUDE, LOCAL_TIME, ALTITUDE, SOLAR_FLUX, LIGHT, AIR_DENSITY, AIR_DRAG, PLASMA_DENSITY, ION_MASS, FORCE, VOLTAGE,
 CURRENT, POWER, TILT, FORCE_X, TETHER_X) = (*range(15), 17)  # fmt: skip
COLUMNS = 20  # the last two are vectors


def observe_low_orbit(time, states, factor, parameters):
    """What surrounds the craft and what its brake does, at given states. time (n,), states (7, n), factor (n,) ->
    (COLUMNS, n), SI, as named above: the force on the tether, N, and the unit vector from its tip to
    the satellite are vectors. What a brake does is 0 where it is off."""
    out = np.zeros((COLUMNS, len(time)))
    _observe(time, states, factor, parameters, out)
    return out


@called
def observe_at(t, x, y, z, vx, vy, vz, m, factor, p, tables):
    """The columns of `observe_low_orbit` at one state, in their order."""
    r = np.sqrt(x * x + y * y + z * z)
    latitude, local_time, altitude, f107, light = surroundings(t, x, y, z, r, p)
    air, drag, plasma, ion_mass, force, voltage, current, power, tilt = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    fx, fy, fz, sx, sy, sz = 0.0, 0.0, 0.0, x / r, y / r, z / r
    if p.air.kind != atmosphere.NONE:
        air = air_density(t, r, latitude, local_time, altitude, f107, p, tables)
        k = air * p.air.drag_area / m
        ax, ay, az = atmosphere.air_drag(x, y, z, vx, vy, vz, p.surface.rotation, k)
        drag = m * np.sqrt(ax * ax + ay * ay + az * az)
    if p.brake.present != 0:
        density, mass = plasma_at(r, latitude, local_time, altitude, f107, p, tables)
        if p.plasma.kind != ionosphere.FORCE_PROFILE:
            plasma, ion_mass = density, mass
        if factor != 0.0:
            fx, fy, fz, force, sx, sy, sz, voltage = brake_force(t, x, y, z, vx, vy, vz, r, density, mass, light, p)
            w = p.surface.rotation
            qx, qy, qz = vx + w * y, vy - w * x, vz
            speed = np.sqrt(qx * qx + qy * qy + qz * qz)
            force *= factor
            tilt = np.arccos(min(1.0, (x * sx + y * sy + z * sz) / r))
            if p.plasma.kind != ionosphere.FORCE_PROFILE and voltage > 0.0:
                current = tether_current(
                    density, mass, speed, voltage, p.brake.length, p.brake.wire_diameter, p.brake.polarity
                )
                power = voltage * current / p.brake.efficiency
    return (
        latitude, local_time % (2.0 * np.pi), altitude, f107, light, air, drag, plasma, ion_mass, force, voltage,
        current, power, tilt, fx, fy, fz, sx, sy, sz,
    )  # fmt: skip


@entry("d1 d2 d1 r1 D2", PARAMETERS)
def _observe(time, states, factor, parameters, out):
    """`observe_low_orbit` into zeros."""
    p = parameters[0]
    tables = array_at(p.places.address, p.places.end)
    for i in range(len(time)):
        y = states[:, i]
        row = observe_at(time[i], y[0], y[1], y[2], y[3], y[4], y[5], y[6], factor[i], p, tables)
        for j in range(COLUMNS):
            out[j, i] = row[j]
    return 0
