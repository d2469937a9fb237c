"""Units that a scene file may write into its keys, by dimension: value in SI = factor * value in the file."""

from __future__ import annotations

from math import pi

from sailviz.constants import ATOMIC_MASS, AU, DAY, RADIUS_EARTH, RADIUS_SUN, YEAR

UNITS: dict[str, dict[str, float]] = {
    "length": {"m": 1.0, "km": 1e3, "au": AU, "earth_radii": RADIUS_EARTH, "solar_radii": RADIUS_SUN},
    "thickness": {"m": 1.0, "mm": 1e-3, "um": 1e-6},
    "time": {"s": 1.0, "min": 60.0, "h": 3600.0, "d": DAY, "yr": YEAR},
    "angle": {"deg": pi / 180, "rad": 1.0},
    "angular_rate": {"rad_s": 1.0, "deg_s": pi / 180, "deg_d": pi / 180 / DAY, "rpm": pi / 30},
    "torque": {"N_m": 1.0, "mN_m": 1e-3, "uN_m": 1e-6},
    "angular_momentum": {"N_m_s": 1.0, "mN_m_s": 1e-3},
    "inertia": {"kg_m2": 1.0},
    "speed": {"m_s": 1.0, "km_s": 1e3},
    "acceleration": {"m_s2": 1.0, "mm_s2": 1e-3, "um_s2": 1e-6},
    "mass": {"kg": 1.0, "g": 1e-3, "t": 1e3},
    "ion_mass": {"u": ATOMIC_MASS, "kg": 1.0},
    "area": {"m2": 1.0, "km2": 1e6},
    "voltage": {"V": 1.0, "kV": 1e3},
    "current": {"A": 1.0, "mA": 1e-3},
    "pressure": {"Pa": 1.0, "nPa": 1e-9, "uN_m2": 1e-6},
    "irradiance": {"W_m2": 1.0},
    "temperature": {"K": 1.0},
    "power": {"W": 1.0, "mW": 1e-3, "kW": 1e3},
    "force": {"N": 1.0, "mN": 1e-3, "uN": 1e-6},
    "force_per_length": {"N_m": 1.0, "nN_m": 1e-9, "mN_km": 1e-6},
    "number_density": {"per_m3": 1.0, "per_cm3": 1e6},
    "mass_density": {"kg_m3": 1.0, "g_cm3": 1e3},
    "solar_flux": {"sfu": 1.0},  # 1e-22 W/m2/Hz at 10.7 cm; the models of the upper atmosphere count in it
    "mu": {"m3_s2": 1.0, "km3_s2": 1e9},
    "specific_energy": {"J_kg": 1.0, "MJ_kg": 1e6, "km2_s2": 1e6},
    "specific_angular_momentum": {"m2_s": 1.0, "km2_s": 1e6},
    "none": {"": 1.0},
}


def spelled(name: str, dimension: str) -> list[str]:
    """Every way to write a quantity in a scene file, e.g. radius_m, radius_km, radius_au."""
    return [f"{name}_{unit}" if unit else name for unit in UNITS[dimension]]
