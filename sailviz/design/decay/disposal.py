"""What a plasma brake replaces: chemical perigee lowering and electric spirals, by propellant, time and power.

Impulsive burn from a circular orbit, low-thrust spiral between circles, rocket equation; textbook forms, re-derived.
Altitudes are above a sphere of the equatorial radius.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from sailviz.constants import MU_EARTH, RADIUS_EARTH, STANDARD_GRAVITY
from sailviz.design.decay.orbit import Force
from sailviz.design.decay.quasi_circular import BRAKE_FLOOR, decay_time
from sailviz.propulsion import plasma_brake


def circular_speed(altitude: npt.ArrayLike) -> np.ndarray:
    """m/s at an altitude in m, same shape."""
    return np.sqrt(MU_EARTH / (RADIUS_EARTH + np.asarray(altitude, dtype=float)))


def perigee_lowering(altitude: npt.ArrayLike, perigee_altitude: npt.ArrayLike = 60e3) -> np.ndarray:
    """Velocity in m/s of the one burn that lowers the perigee of a circular orbit; altitudes in m, arrays broadcast.
    With a perigee of 60 km or less the entry is on the next half revolution and where one wants it."""
    a, p = (RADIUS_EARTH + np.asarray(h, dtype=float) for h in (altitude, perigee_altitude))
    return np.sqrt(MU_EARTH / a) - np.sqrt(2 * MU_EARTH / a - 2 * MU_EARTH / (a + p))


def spiral(altitude: npt.ArrayLike, end_altitude: npt.ArrayLike = 300e3) -> np.ndarray:
    """Velocity in m/s of a low-thrust spiral down between circles, the difference of the circular speeds; altitudes in
    m, arrays broadcast; zero where the orbit is already below its end."""
    return np.maximum(circular_speed(end_altitude) - circular_speed(altitude), 0.0)


def propellant(mass: npt.ArrayLike, delta_v: npt.ArrayLike, specific_impulse: npt.ArrayLike) -> np.ndarray:
    """Propellant in kg for a velocity in m/s: m (1 - exp(-dv / (Isp g0))), initial mass in kg, Isp in s; arrays
    broadcast."""
    exhaust_speed = np.multiply(specific_impulse, STANDARD_GRAVITY)
    return np.multiply(mass, -np.expm1(-np.divide(delta_v, exhaust_speed)))


def thrust_time(
    mass: npt.ArrayLike, delta_v: npt.ArrayLike, specific_impulse: npt.ArrayLike, thrust: npt.ArrayLike
) -> np.ndarray:
    """Time in s that a thrust in N takes for it, propellant over mass flow; the other arguments as in `propellant`."""
    impulse = propellant(mass, delta_v, specific_impulse) * np.asarray(specific_impulse, dtype=float) * STANDARD_GRAVITY
    return np.divide(impulse, thrust)


def electric_power(thrust: npt.ArrayLike, specific_impulse: npt.ArrayLike, efficiency: npt.ArrayLike) -> np.ndarray:
    """Power in W of an electric thruster: T Isp g0 / (2 eta), N and s."""
    return np.multiply(thrust, specific_impulse) * STANDARD_GRAVITY / np.multiply(2.0, efficiency)


def equivalent_specific_impulse(impulse: npt.ArrayLike, system_mass: npt.ArrayLike) -> np.ndarray:
    """Isp in s at which a thruster would spend the whole mass of the system, kg, on the impulse in N s that the brake
    gives; system_mass : tether, reel, tip mass and high-voltage unit."""
    return np.divide(impulse, np.multiply(system_mass, STANDARD_GRAVITY))


@dataclass(frozen=True)
class Disposal:
    """One way down, scalars or arrays of one shape. delta_v : m/s. propellant : kg. time : s of thrust, for one burn
    until the perigee. power : W, the most it draws. specific_impulse : s, for a brake the equivalent one. controlled :
    whether it chooses where the craft comes down."""

    delta_v: np.ndarray
    propellant: np.ndarray
    time: np.ndarray
    power: np.ndarray
    specific_impulse: np.ndarray
    controlled: bool


def chemical(
    mass: npt.ArrayLike,
    altitude: npt.ArrayLike,
    specific_impulse: npt.ArrayLike,
    perigee_altitude: npt.ArrayLike = 60e3,
) -> Disposal:
    """One burn into the atmosphere; mass kg, altitudes m, specific impulse s (cold gas 70, monopropellant 220,
    bipropellant 300)."""
    dv = perigee_lowering(altitude, perigee_altitude)
    isp = np.asarray(specific_impulse, dtype=float)[()]
    half = np.pi * np.sqrt((RADIUS_EARTH + 0.5 * np.add(altitude, perigee_altitude)) ** 3 / MU_EARTH)
    return Disposal(dv, propellant(mass, dv, specific_impulse), half, 0.0 * dv, isp, True)


def electric(
    mass: npt.ArrayLike,
    altitude: npt.ArrayLike,
    specific_impulse: npt.ArrayLike,
    thrust: npt.ArrayLike,
    efficiency: npt.ArrayLike = 0.5,
    end_altitude: npt.ArrayLike = 300e3,
) -> Disposal:
    """A spiral to an altitude from which drag does the rest within weeks; mass kg, altitudes m, specific impulse s,
    thrust N, efficiency from electric to jet power."""
    dv = spiral(altitude, end_altitude)
    return Disposal(
        dv,
        propellant(mass, dv, specific_impulse),
        thrust_time(mass, dv, specific_impulse, thrust),
        electric_power(thrust, specific_impulse, efficiency) + 0.0 * dv,
        np.asarray(specific_impulse, dtype=float)[()],
        False,
    )


def brake(
    mass: npt.ArrayLike,
    length: float,
    altitude: npt.ArrayLike,
    force_profile: Force | None,
    system_mass: float,
    wire_diameter: float = 50e-6,
    supply_efficiency: float = 1.0,
    end_altitude: float = 300e3,
    **options,
) -> Disposal:
    """A plasma brake from a circular orbit down to end_altitude.

    mass : kg, length : m, altitudes : m. force_profile, options : as in `decay.decay_time`. system_mass : kg of tether,
    reel, tip mass and high-voltage unit. wire_diameter : m, summed over the wires. power : the most the tether draws on
    the way, in the orbit's mean plasma; NaN where the profile does not know its plasma.
    """
    time = decay_time(mass, length, altitude, end_altitude, force_profile, **options)
    dv = spiral(altitude, end_altitude)
    most = np.full(np.shape(dv), np.nan)
    plasma = getattr(force_profile, "plasma", None)
    if plasma is not None:
        drawn = plasma_brake.power(
            plasma.density,
            plasma.ion_mass,
            circular_speed(plasma.altitude),
            plasma.voltage,
            length,
            wire_diameter,
            supply_efficiency,
        )
        inside = (plasma.altitude >= max(end_altitude, options.get("brake_floor", BRAKE_FLOOR))) & (
            plasma.altitude <= np.asarray(altitude, dtype=float)[..., None]
        )
        most = np.max(np.where(inside, drawn, -np.inf), axis=-1)
        most = np.where(np.isfinite(most), most, np.nan)
    impulse_isp = equivalent_specific_impulse(np.asarray(mass) * dv, system_mass)
    return Disposal(dv, 0.0 * dv, time, most[()], impulse_isp, False)
