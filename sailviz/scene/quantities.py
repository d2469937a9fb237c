"""Numbers that a scene may expect of its run, by name: one table, read by the scene file's check and by the run's.

What their values are stands in quantity_values.py, apart, so that a scene is checked without numpy.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from math import inf, pi
from typing import TYPE_CHECKING

from sailviz.units import UNITS, spelled

if TYPE_CHECKING:
    import numpy as np

    from sailviz.run.arrays import EnsembleStatistics, Run

DIMENSIONS = {
    "time": "time",
    "radius": "length",
    "altitude": "length",
    "elevation": "angle",
    "height": "length",
    "longitude": "angle",
    "speed": "speed",
    "radial_speed": "speed",
    "transverse_speed": "speed",
    "flight_path_angle": "angle",
    "energy": "specific_energy",
    "angular_momentum": "specific_angular_momentum",
    "angular_momentum_z": "specific_angular_momentum",
    "mass": "mass",
    "semi_major_axis": "length",
    "eccentricity": "none",
    "inclination": "angle",
    "raan": "angle",
    "true_anomaly": "angle",
    "periapsis": "length",
    "apoapsis": "length",
    "pitch": "angle",
    "cone": "angle",
    "clock": "angle",
    "thrust_acceleration": "acceleration",
    "closed_form_error": "none",
    "perigee_altitude": "length",
    "mean_altitude": "length",
    "apogee_altitude": "length",
    "quasi_circular_altitude": "length",
    "sunlit": "none",
    "sunlit_fraction": "none",
    "sun_distance": "length",
    "moon_distance": "length",
    "in_solar_wind": "none",
    "force_law_valid": "none",
    "plasma_force": "force_per_length",
    "plasma_density": "number_density",
    "tether_current": "current",
    "tether_voltage": "voltage",
    "tether_power": "power",
    "tether_tilt": "angle",
    "air_drag": "force",
    "thrust_factor": "none",
    "thrust_voltage": "voltage",
    "wind_pressure": "pressure",
    "electrochromic_state": "none",
    "saturated": "none",
    "dose": "time",
    "film_temperature": "temperature",
    "spin_rate": "angular_rate",
    "modulation": "none",
    "thrust_lost": "none",
    "wheel_torque": "torque",
    "body_rate": "angular_rate",
    "nutation": "angle",
    "wheel_momentum": "angular_momentum",
    "light_torque": "torque",
    "air_torque": "torque",
    "control_torque": "torque",
    "share": "none",
}

ON_A_CIRCLE = ("raan", "true_anomaly", "clock")  # equal modulo a turn; longitude is not: it counts revolutions


@dataclass(frozen=True)
class Quantity:
    """A quantity in the unit in which a scene writes it."""

    name: str  # as written, e.g. "radius_au"
    stem: str  # e.g. "radius"
    unit: str
    factor: float  # SI per unit

    @property
    def turn(self) -> float:
        """A whole turn, in this unit, after which the quantity is the same again; infinite where there is none."""
        return 2 * pi / self.factor if self.stem in ON_A_CIRCLE else inf

    def of(self, run: Run) -> np.ndarray:
        """One value per row, in this unit. (n,)"""
        from sailviz.run.quantities import VALUES

        return VALUES[self.stem](run) / self.factor


@cache
def spellings() -> dict[str, Quantity]:
    """Every name that [[expect]] accepts."""
    return {
        name: Quantity(name, stem, unit, factor)
        for stem, dimension in DIMENSIONS.items()
        for name, (unit, factor) in zip(spelled(stem, dimension), UNITS[dimension].items(), strict=True)
    }


OF_EACH_DEVICE = ("thrust_acceleration",)  # what can be asked of one device in a list of them
PLACES = {"radius": 0, "longitude": 1, "radial_speed": 3, "transverse_speed": 4}  # of a planar flight's states
MEANS = {"thrust_factor": "mean_factor", "thrust_voltage": "mean_voltage", "saturated": "mean_saturated"}


def of_ensemble(ensemble: EnsembleStatistics, quantity: Quantity, statistic: str) -> float:
    """A statistic of the ends of an ensemble's flights, in the quantity's unit: "mean", "miss" (mean less nominal) or
    "deviation"; of thrust factor, voltage and saturation the mean over flights and time. NaN where there is none."""
    if quantity.stem in MEANS and statistic == "mean":
        return float(getattr(ensemble, MEANS[quantity.stem]) / quantity.factor)
    if quantity.stem not in PLACES or not ensemble.planar:
        return float("nan")
    k = PLACES[quantity.stem]
    value = {
        "mean": ensemble.end_mean[k],
        "miss": ensemble.end_mean[k] - ensemble.nominal[-1, k],
        "deviation": ensemble.end_deviation[k],
    }[statistic]
    return float(value / quantity.factor)
