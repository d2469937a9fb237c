"""What each quantity of scene/quantities.py is: a function of a Run giving one value per row, in SI."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from sailviz.compiled import Late
from sailviz.constants import YEAR
from sailviz.elements import apoapsis
from sailviz.run import formulas
from sailviz.run.arrays import Run

FULL_CIRCLE = 1e-6  # length of the mean of unit vectors below which angles go all round and have no mean

Value = Callable[[Run], np.ndarray]  # one number per row, SI


def arc(value: np.ndarray | float, origin: np.ndarray | float, turn: float = np.inf) -> np.ndarray:
    """The way from an origin to a value, (...,): along the shortest arc, -turn / 2 to turn / 2, of what is the same
    after a turn; the plain difference where the turn is infinite."""
    difference = np.asarray(value, float) - origin
    if not np.isfinite(turn):
        return difference
    found: np.ndarray = difference - turn * np.round(difference / turn)
    return found


def unwrapped(values: np.ndarray, turn: float) -> np.ndarray:
    """Values (n,) without the jumps by whole turns, for interpolation; as they are where the turn is infinite."""
    return np.unwrap(values, period=turn) if np.isfinite(turn) else values


def circular_mean(cosine: float, sine: float, turn: float) -> float:
    """The direction of the mean of unit vectors, 0 to a turn; NaN where the angles go all round and have none."""
    if not np.hypot(cosine, sine) > FULL_CIRCLE:
        return float("nan")
    return float(np.arctan2(sine, cosine) / (2 * np.pi) % 1 * turn)


def _of_state(formula: Late) -> Value:
    """A formula of the state, for every row."""
    takes = formula.py_func.__code__.co_varnames[: formula.py_func.__code__.co_argcount]

    def value(run: Run) -> np.ndarray:
        columns = dict(zip(("x", "y", "z", "vx", "vy", "vz"), (*run.position.T, *run.velocity.T), strict=True))
        columns["mu"] = run.setting.body.mu
        found: np.ndarray = formula.py_func(*(columns[name] for name in takes))
        return found

    return value


def _longitude(run: Run) -> np.ndarray:
    """Unwrapped, so that it counts revolutions; from the first row of the run or block."""
    return np.unwrap(formulas.longitude.py_func(run.position[:, 0], run.position[:, 1]))


def _closed_form_error(run: Run) -> np.ndarray:
    raise TypeError("the error against a closed form takes the closed form too: expectations.py knows it")


def _above_surface(distance: Value) -> Value:
    """Of a length from the centre, its height over the central body's radius."""
    return lambda run: distance(run) - run.setting.body.radius


def _periapsis(run: Run) -> np.ndarray:
    """Not a (1 - e), which has no digits left where a craft escapes."""
    h = _of_state(formulas.angular_momentum)(run)
    found: np.ndarray = h**2 / run.setting.body.mu / (1 + run.elements.eccentricity)
    return found


def _apoapsis(run: Run) -> np.ndarray:
    return apoapsis(run.elements)


def _acted(name: str) -> Value:
    """A column of the environment; NaN, which no expectation accepts, where the run has none."""
    return lambda run: np.asarray(run.environment.get(name, np.full(len(run), np.nan)), float)


def _of_film(name: str, unit: float = 1.0) -> Value:
    """A column of the sail's film; NaN where the run has none."""
    return lambda run: unit * np.asarray(run.film.get(name, np.full(len(run), np.nan)), float)


def _turning(name: str) -> Callable[[Run], np.ndarray]:
    """A column (n, 3) of an attitude that moves; NaN where it does not."""
    return lambda run: np.asarray(run.attitude.motion.get(name, np.full((len(run), 3), np.nan)), float)


_rate, _momentum, _wheels = (_turning(name) for name in ("rate_rad_s", "angular_momentum_N_m_s", "wheels_N_m_s"))


def _nutation(run: Run) -> np.ndarray:
    """Angle between the normal and the angular momentum."""
    along, across = run.attitude.normal, _momentum(run)
    found: np.ndarray = np.arctan2(np.linalg.norm(np.cross(along, across), axis=1), np.sum(along * across, axis=1))
    return found


def _torque(name: str) -> Value:
    """Size of a torque whose three columns the environment has, about the body's axes; NaN where it has none."""
    parts = [_acted(f"{name}_{axis}_N_m") for axis in "xyz"]
    return lambda run: np.linalg.norm([part(run) for part in parts], axis=0)


def _mean_altitude(run: Run) -> np.ndarray:
    """Without the swing that an oblate planet gives it, where the run knows that; else of the semi-major axis. NaN on
    an open orbit, which has no mean."""
    axis = run.elements.semi_major_axis
    osculating: np.ndarray = np.where((axis > 0) & np.isfinite(axis), axis, np.nan) - run.setting.body.radius
    return run.environment.get("mean_altitude_m", osculating)


_distance = _of_state(formulas.radius)

VALUES: dict[str, Value] = {
    "time": lambda run: run.time,
    "radius": _distance,
    "altitude": lambda run: _distance(run) - run.setting.body.radius,
    "elevation": _of_state(formulas.elevation),
    "height": lambda run: run.position[:, 2],
    "longitude": _longitude,
    "speed": lambda run: np.linalg.norm(run.velocity, axis=1),
    "radial_speed": _of_state(formulas.radial_speed),
    "transverse_speed": _of_state(formulas.transverse_speed),
    "flight_path_angle": _of_state(formulas.flight_path_angle),
    "energy": _of_state(formulas.energy),
    "angular_momentum": _of_state(formulas.angular_momentum),
    "angular_momentum_z": _of_state(formulas.angular_momentum_z),
    "mass": lambda run: run.mass,
    "semi_major_axis": lambda run: run.elements.semi_major_axis,
    "eccentricity": lambda run: run.elements.eccentricity,
    "inclination": lambda run: run.elements.inclination,
    "raan": lambda run: run.elements.raan,
    "true_anomaly": lambda run: run.elements.true_anomaly,
    "periapsis": _periapsis,
    "apoapsis": _apoapsis,
    "pitch": lambda run: run.attitude.pitch,
    "cone": lambda run: run.attitude.cone,
    "clock": lambda run: run.attitude.clock,
    "thrust_acceleration": lambda run: run.thrust.magnitude,
    "closed_form_error": _closed_form_error,
    "perigee_altitude": _above_surface(_periapsis),
    "mean_altitude": _mean_altitude,
    "apogee_altitude": _above_surface(_apoapsis),
    "quasi_circular_altitude": _acted("quasi_circular_altitude_m"),
    "sunlit": _acted("sunlit"),  # its mean is the share of the time
    "sunlit_fraction": _acted("sunlit_fraction"),  # of the Sun's disc
    "sun_distance": _acted("sun_distance_m"),  # from whatever shines
    "moon_distance": _acted("moon_distance_m"),
    "in_solar_wind": _acted("in_solar_wind"),  # its mean is the share of the time
    "force_law_valid": _acted("force_law_valid"),
    "plasma_force": _acted("plasma_force_N_m"),
    "plasma_density": _acted("plasma_density_per_m3"),
    "tether_current": _acted("tether_current_A"),
    "tether_voltage": _acted("tether_voltage_V"),
    "tether_power": _acted("tether_power_W"),
    "tether_tilt": _acted("tether_tilt_rad"),
    "air_drag": _acted("air_drag_N"),
    "thrust_factor": lambda run: run.environment.get("thrust_factor", np.ones(len(run))),
    "thrust_voltage": _acted("thrust_voltage_V"),
    "wind_pressure": _acted("solar_wind_pressure_Pa"),
    "electrochromic_state": _acted("electrochromic_state"),
    "saturated": _acted("saturated"),  # of an ensemble: the share of time at the largest voltage
    "dose": _of_film("dose_yr", YEAR),
    "film_temperature": _of_film("temperature_K"),
    "spin_rate": _acted("spin_rate_rad_s"),
    "modulation": _acted("modulation"),
    "thrust_lost": _acted("thrust_lost"),
    "wheel_torque": _acted("wheel_torque_N_m"),
    "body_rate": lambda run: np.linalg.norm(_rate(run), axis=1),
    "nutation": _nutation,
    "wheel_momentum": lambda run: np.abs(_wheels(run)).max(axis=1),  # of the wheel that holds most
    "light_torque": _torque("light_torque"),
    "air_torque": _torque("air_torque"),
    "control_torque": _torque("control_torque"),
    "share": _acted("share"),  # of an ensemble: of the flights that meet an event
}
