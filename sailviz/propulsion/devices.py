"""Which devices there are, by number for compiled code and by name for people."""

from __future__ import annotations

from sailviz.constants import AU
from sailviz.propulsion import electric_sail, solar_sail
from sailviz.propulsion.electric_sail import MODELS, PITCH_LIMIT
from sailviz.propulsion.solar_sail import FILMS, Film

# CALLED: a device of one's own, whose force is a C function called by its address
NO_DEVICE, SOLAR_SAIL, ELECTRIC_SAIL, PLASMA_BRAKE, THRUSTER, CALLED = range(6)

ELECTRIC_SAILS = {
    "electric-sail": MODELS["final"],
    "electric-sail-original": MODELS["original"],
    "electric-sail-updated": MODELS["updated"],
    "electric-sail-polynomial": MODELS["polynomial"],
}


def sail(
    device: Film | str, characteristic_acceleration: float, length: float = AU
) -> tuple[int, solar_sail.Parameters | electric_sail.Parameters]:
    """(id, parameters) of a sail as compiled code reads them.

    device : a film's name, a Film or one of ELECTRIC_SAILS; ValueError for anything else.
    characteristic_acceleration : at one au, in the units of the caller (m/s2 with length in m); length : of one au.
    """
    if isinstance(device, str) and device in ELECTRIC_SAILS:
        return ELECTRIC_SAIL, electric_sail.Parameters(
            float(characteristic_acceleration), float(ELECTRIC_SAILS[device]), PITCH_LIMIT
        )
    if isinstance(device, str) and device in FILMS:
        device = FILMS[device]
    if not isinstance(device, Film):
        known = ", ".join([*FILMS, *ELECTRIC_SAILS])
        raise ValueError(f"{device!r} is no sail; there are {known}, or a Film of your own")
    strength = characteristic_acceleration * length**2 / device.total
    return SOLAR_SAIL, solar_sail.Parameters(strength, device.b1, device.b2, device.b3)
