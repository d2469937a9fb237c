"""Numbers that a scene may expect of its run, by name: one table, read by the scene file's check and by the run's.

Each is a function of a Run giving one value per row, in SI.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np

from sailviz.run import Cloud, Run
from sailviz.units import UNITS, spelled


def _distance(run: Run):
    return np.linalg.norm(run.position, axis=1)


def _energy(run: Run):
    return np.sum(run.velocity**2, axis=1) / 2 - run.setting.body.mu / _distance(run)


def _momentum(run: Run):
    return np.linalg.norm(np.cross(run.position, run.velocity), axis=1)


def _flight_path(run: Run):
    radial = np.sum(run.position * run.velocity, axis=1) / _distance(run)
    return np.arctan2(radial, _momentum(run) / _distance(run))


def _longitude(run: Run):
    """Unwrapped, so that it counts revolutions; from the first row of the run or block."""
    return np.unwrap(np.arctan2(run.position[:, 1], run.position[:, 0]))


def _closed_form_error(run: Run):
    raise TypeError("the error against a closed form takes the closed form too: expectations.py knows it")


def _above_surface(distance):
    """Of a length from the centre as a function of the elements, its height over the central body's radius."""
    return lambda run: distance(run.elements) - run.setting.body.radius


def _acted(name: str):
    """A column of the environment; NaN, which no expectation accepts, where the run has none."""
    return lambda run: np.asarray(run.environment.get(name, np.full(len(run), np.nan)), float)


def _mean_altitude(run: Run):
    """Without the swing that an oblate planet gives it, where the run knows that; else of the semi-major axis."""
    return run.environment.get("mean_altitude_m", run.elements.semi_major_axis - run.setting.body.radius)


def _radial_speed(run: Run):
    return np.sum(run.position * run.velocity, axis=1) / _distance(run)


# name -> (dimension, values of a run)
QUANTITIES = {
    "time": ("time", lambda run: run.time),
    "radius": ("length", _distance),
    "altitude": ("length", lambda run: _distance(run) - run.setting.body.radius),
    "elevation": (
        "angle",
        lambda run: np.arctan2(run.position[:, 2], np.hypot(run.position[:, 0], run.position[:, 1])),
    ),
    "height": ("length", lambda run: run.position[:, 2]),
    "longitude": ("angle", _longitude),
    "speed": ("speed", lambda run: np.linalg.norm(run.velocity, axis=1)),
    "radial_speed": ("speed", _radial_speed),
    "transverse_speed": ("speed", lambda run: _momentum(run) / _distance(run)),
    "flight_path_angle": ("angle", _flight_path),
    "energy": ("specific_energy", _energy),
    "angular_momentum": ("specific_angular_momentum", _momentum),
    "angular_momentum_z": ("specific_angular_momentum", lambda run: np.cross(run.position, run.velocity)[:, 2]),
    "mass": ("mass", lambda run: run.mass),
    "semi_major_axis": ("length", lambda run: run.elements.semi_major_axis),
    "eccentricity": ("none", lambda run: run.elements.eccentricity),
    "inclination": ("angle", lambda run: run.elements.inclination),
    "raan": ("angle", lambda run: run.elements.raan),
    "true_anomaly": ("angle", lambda run: run.elements.true_anomaly),
    "periapsis": ("length", lambda run: run.elements.semi_major_axis * (1 - run.elements.eccentricity)),
    "apoapsis": ("length", lambda run: run.elements.semi_major_axis * (1 + run.elements.eccentricity)),
    "pitch": ("angle", lambda run: run.attitude.pitch),
    "cone": ("angle", lambda run: run.attitude.cone),
    "clock": ("angle", lambda run: run.attitude.clock),
    "thrust_acceleration": ("acceleration", lambda run: run.thrust.magnitude),
    "closed_form_error": ("none", _closed_form_error),
    "perigee_altitude": ("length", _above_surface(lambda e: e.semi_major_axis * (1 - e.eccentricity))),
    "mean_altitude": ("length", _mean_altitude),
    "apogee_altitude": ("length", _above_surface(lambda e: e.semi_major_axis * (1 + e.eccentricity))),
    "quasi_circular_altitude": ("length", _acted("quasi_circular_altitude_m")),
    "sunlit": ("none", _acted("sunlit")),  # its mean is the share of the time
    "force_law_valid": ("none", _acted("force_law_valid")),
    "plasma_force": ("force_per_length", _acted("plasma_force_N_m")),
    "plasma_density": ("number_density", _acted("plasma_density_per_m3")),
    "tether_current": ("current", _acted("tether_current_A")),
    "tether_voltage": ("voltage", _acted("tether_voltage_V")),
    "tether_power": ("power", _acted("tether_power_W")),
    "tether_tilt": ("angle", _acted("tether_tilt_rad")),
    "air_drag": ("force", _acted("air_drag_N")),
    "thrust_factor": ("none", lambda run: run.environment.get("thrust_factor", np.ones(len(run)))),
    "thrust_voltage": ("voltage", _acted("thrust_voltage_V")),
    "wind_pressure": ("pressure", _acted("solar_wind_pressure_Pa")),
    "electrochromic_state": ("none", _acted("electrochromic_state")),
    "saturated": ("none", _acted("saturated")),  # of an ensemble: the share of time at the largest voltage
}


@dataclass(frozen=True)
class Quantity:
    """A quantity in the unit in which a scene writes it."""

    name: str  # as written, e.g. "radius_au"
    stem: str  # e.g. "radius"
    unit: str
    factor: float  # SI per unit

    def of(self, run: Run) -> np.ndarray:
        """One value per row, in this unit. (n,)"""
        return QUANTITIES[self.stem][1](run) / self.factor


@cache
def spellings() -> dict[str, Quantity]:
    """Every name that [[expect]] accepts."""
    return {
        name: Quantity(name, stem, unit, factor)
        for stem, (dimension, _) in QUANTITIES.items()
        for name, (unit, factor) in zip(spelled(stem, dimension), UNITS[dimension].items(), strict=True)
    }


PLACES = {"radius": 0, "longitude": 1, "radial_speed": 3, "transverse_speed": 4}  # of a planar flight's states
MEANS = {"thrust_factor": "mean_factor", "thrust_voltage": "mean_voltage", "saturated": "mean_saturated"}


def of_cloud(cloud: Cloud, quantity: Quantity, statistic: str) -> float:
    """A statistic of the ends of an ensemble's flights, in the quantity's unit: "mean", "miss" (mean less nominal) or
    "deviation"; of thrust factor, voltage and saturation the mean over flights and time. NaN where there is none."""
    if quantity.stem in MEANS and statistic == "mean":
        return getattr(cloud, MEANS[quantity.stem]) / quantity.factor
    if quantity.stem not in PLACES or not cloud.planar:
        return float("nan")
    k = PLACES[quantity.stem]
    value = {
        "mean": cloud.end_mean[k],
        "miss": cloud.end_mean[k] - cloud.nominal[-1, k],
        "deviation": cloud.end_deviation[k],
    }[statistic]
    return float(value / quantity.factor)
