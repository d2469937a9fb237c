"""Quantities of a recording over time, on paper: what [[expect]] knows by name, and columns of /environment."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from sailviz.figures.drawing import FigureError
from sailviz.recording.contract import word
from sailviz.recording.drawing import style as colors
from sailviz.recording.drawing.plots import COLOR_OF, LOGARITHMIC, UNITS, WORDS, scale_of
from sailviz.recording.drawing.shares import device_colors
from sailviz.run.arrays import Run
from sailviz.scene.quantities import DIMENSIONS, Quantity, spellings
from sailviz.words import nearest

UNIT_WORDS = {  # as keys spell units -> as people do; others are the same
    "km_s": "km/s",
    "m_s": "m/s",
    "mm_s2": "mm/s²",
    "um_s2": "µm/s²",
    "m_s2": "m/s²",
    "deg": "°",
    "earth_radii": "radii of the Earth",
    "solar_radii": "radii of the Sun",
    "min": "min",
    "um": "µm",
    "uN": "µN",
    "uN_m2": "µN/m²",
    "N_m": "N/m",
    "nN_m": "nN/m",
    "mN_km": "mN/km",
    "per_m3": "1/m³",
    "per_cm3": "1/cm³",
    "J_kg": "J/kg",
    "MJ_kg": "MJ/kg",
    "km2_s2": "km²/s²",
    "m2_s": "m²/s",
    "km2_s": "km²/s",
}
UNITS_OF_TURNING = {  # of torques and momenta, of which N_m is no force per length
    "N_m": "N m",
    "mN_m": "mN m",
    "uN_m": "µN m",
    "N_m_s": "N m s",
    "mN_m_s": "mN m s",
}
USUAL = {  # the unit that is taken where a name comes without one, by dimension
    "time": "d",
    "length": "km",
    "angle": "deg",
    "speed": "km_s",
    "acceleration": "mm_s2",
    "mass": "kg",
    "voltage": "V",
    "current": "mA",
    "pressure": "nPa",
    "power": "W",
    "force": "mN",
    "force_per_length": "nN_m",
    "number_density": "per_m3",
    "specific_energy": "km2_s2",
    "specific_angular_momentum": "km2_s",
    "temperature": "K",
    "angular_rate": "rpm",
    "torque": "N_m",
    "angular_momentum": "N_m_s",
    "none": "",
}
NAMED = {  # of stems whose words or colours are not those of their names
    "radius": ("Distance from the centre", "distance"),
    "height": ("Height above the plane x, y", "height"),
    "longitude": ("Longitude, counted on", "sail angle"),
    "raan": ("Longitude of the ascending node", "inclination"),
    "pitch": ("Pitch angle", "sail angle"),
    "cone": ("Cone angle of the push", "cone angle"),
    "clock": ("Clock angle", "clock angle"),
    "thrust_acceleration": ("Push on the craft", "push"),
    "plasma_force": ("Drag on each metre of tether", "drag"),
    "air_drag": ("Drag of the air", "air"),
    "wind_pressure": ("Pressure of the solar wind", "wind"),
    "speed": ("Speed", "speed"),
    "radial_speed": ("Speed away from the centre", "speed"),
    "transverse_speed": ("Speed across the radius", "speed"),
    "altitude": ("Altitude", "altitude"),
    "mean_altitude": ("Mean altitude", "altitude"),
    "perigee_altitude": ("Lowest altitude of the orbit", "lowest"),
    "apogee_altitude": ("Highest altitude of the orbit", "highest"),
    "periapsis": ("Periapsis", "lowest"),
    "apoapsis": ("Apoapsis", "highest"),
    "quasi_circular_altitude": ("Altitude, closed form", "analytic"),
    "semi_major_axis": ("Semi-major axis", "semi-major axis"),
    "eccentricity": ("Eccentricity", "eccentricity"),
    "inclination": ("Inclination", "inclination"),
    "dose": ("Dose of sunlight on the film", "dose"),
    "film_temperature": ("Temperature of the film", "heat"),
    "sunlit": ("Sunlit", "sunlight"),
    "sunlit_fraction": ("Lit share of the Sun's disc", "sunlight"),
}
FROM_THE_SUN = {"radius": "Distance from the Sun", "height": "Height above the ecliptic"}
OWN_UNIT = {"dose": "yr"}  # of stems that are not told in what others of their dimension are
IN_AU = ("radius", "height", "semi_major_axis", "periapsis", "apoapsis")
MOST = 12  # panels of a page
BINS = 1500  # stretches of time of which the least and the largest value are drawn where there are more rows
DAY, YEAR = 86400.0, 365.25 * 86400.0
TIMES = ((3 * 3600.0, 60.0, "min"), (3 * DAY, 3600.0, "h"), (1000 * DAY, DAY, "d"), (np.inf, YEAR, "yr"))


@dataclass(frozen=True)
class Curve:
    """A quantity over time. words : with the unit; color : of the recordings; values (n,); turn : after which an angle
    is the same again, in the unit of the values. stem : its name without the unit; size : SI per unit."""

    name: str
    words: str
    color: Sequence[int]
    values: np.ndarray
    turn: float = np.inf
    logarithmic: bool = False
    stem: str = ""
    size: float = 1.0


SHARE = "thrust/"  # before the name of a device


def curve_of(run: Run, name: str) -> Curve:
    """What a name means: `radius_au` as [[expect]] writes it, `radius` in the usual unit, a column of /environment, or
    `thrust/NAME`, what one of several devices adds to the push, in the usual unit or in `thrust/NAME_um_s2`.
    FigureError, with the nearest name, where it means nothing, and where this run has none of it."""
    if name in run.environment and run.environment[name].ndim == 1:
        return column(run, name)
    if name.startswith(SHARE):
        return share(run, name)
    quantity = spellings().get(name) or spellings().get(usual(run, name))
    if quantity is None:
        known = [*DIMENSIONS, *spellings(), *run.environment]
        raise FigureError(f"there is no quantity {name!r}. {nearest(name, known)}".rstrip())
    if quantity.stem == "closed_form_error":
        raise FigureError("closed_form_error is a verdict on a whole run, not a quantity over time")
    values = np.asarray(quantity.of(run), float)
    if not np.isfinite(values).any():
        raise FigureError(f"{name} is never a number in this recording")
    words, color = named(quantity.stem, run.setting.body.name == "Sun")
    turning = DIMENSIONS[quantity.stem] in ("torque", "angular_momentum")
    unit = (UNITS_OF_TURNING if turning else UNIT_WORDS).get(quantity.unit, quantity.unit)
    words = f"{words} [{unit}]" if unit else words
    return Curve(name, words, color, values, quantity.turn, is_dense(quantity), quantity.stem, quantity.factor)


def share(run: Run, name: str) -> Curve:
    """The push of one device, called by its own name or by that of its entity."""
    asked = name.removeprefix(SHARE)
    for device, thrust in run.devices.items():
        for called in (device, word(device)):
            unit = asked.removeprefix(called).removeprefix("_") or "mm_s2"
            quantity = spellings().get(f"thrust_acceleration_{unit}")
            if quantity is None or asked not in (called, f"{called}_{unit}"):
                continue
            words = f"Push of the {device} [{UNIT_WORDS.get(unit, unit)}]"
            values = thrust.magnitude / quantity.factor
            return Curve(name, words, device_colors(run)[device], values, stem=f"{SHARE}{device}", size=quantity.factor)
    if not run.devices:
        raise FigureError(f"there is no {name!r}: this craft has one device, whose push is thrust_acceleration")
    known = [f"{SHARE}{word(device)}" for device in run.devices]
    raise FigureError(f"there is no quantity {name!r}. {nearest(name, known)}".rstrip())


def usual(run: Run, stem: str) -> str:
    """A name in the unit that people take for it."""
    dimension = DIMENSIONS.get(stem)
    if dimension is None:
        return stem
    unit = "au" if stem in IN_AU and run.setting.body.name == "Sun" else OWN_UNIT.get(stem, USUAL[dimension])
    return f"{stem}_{unit}" if unit else stem


def is_dense(quantity: Quantity) -> bool:
    """Whether it spans so many powers of ten that its axis is logarithmic."""
    return DIMENSIONS[quantity.stem] == "number_density"


def named(stem: str, sun: bool) -> tuple[str, Sequence[int]]:
    """Words and colour of a quantity."""
    words, key = NAMED.get(stem, (stem.replace("_", " ").capitalize(), ""))
    if sun:
        words = FROM_THE_SUN.get(stem, words)
    if not key:
        key = next((quantity for part, quantity in COLOR_OF if part in stem), "switch")
    return words, colors.QUANTITY[key]


def column(run: Run, name: str) -> Curve:
    """A column of /environment in the unit that plots have."""
    ending = max((u for u in (*UNITS, *LOGARITHMIC) if name.endswith(u)), key=len, default="")
    words = WORDS.get(name, name.removesuffix(ending).replace("_", " ").capitalize())
    dense = ending in LOGARITHMIC
    factor, unit = (1.0, LOGARITHMIC[ending]) if dense else scale_of(name, ending)
    values = factor * np.asarray(run.environment[name], float)
    if not np.isfinite(values).any():
        raise FigureError(f"{name} is never a number in this recording")
    color = colors.QUANTITY[next((quantity for part, quantity in COLOR_OF if part in name), "switch")]
    unit = "°" if unit == "deg" else unit
    return Curve(name, f"{words} [{unit}]" if unit else words, color, values, logarithmic=dense)


NOISE = 1e-9  # of an angle or an eccentricity: what changes by less is rounding


def telling(run: Run) -> list[str]:
    """What is drawn where nobody says: of the usual quantities those that change by more than 2 %."""
    low = "mean_altitude" if run.setting.body.name != "Sun" and run.setting.body.radius > 0 else "radius"
    wanted = (low, "speed", "thrust_acceleration", "pitch", "inclination", "eccentricity")
    found = []
    for name in wanted:
        values = curve_of(run, name).values if name != "pitch" or np.isfinite(run.attitude.pitch).any() else np.zeros(1)
        least = NOISE if name in ("pitch", "inclination", "eccentricity") else 0.0
        if np.nanmax(values) - np.nanmin(values) > max(0.02 * np.nanmax(np.abs(values)), least):
            found.append(name)
    return found[:4] or [low]


def time_unit(span: float) -> tuple[float, str]:
    """Seconds of the unit in which a span of time is read at ease, and its name."""
    return next((size, word) for most, size, word in TIMES if span <= most)


def thinned(time: np.ndarray, values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The same line of fewer points (m,): the least and the largest value of each of BINS stretches, in their order,
    and both ends."""
    if len(time) <= 4 * BINS:
        return time, values
    edges = np.linspace(0, len(time), BINS + 1).astype(int)
    chosen = [0, len(time) - 1]
    for start, stop in pairwise(edges.tolist()):
        part = values[start:stop]
        if np.isfinite(part).any():
            chosen += [start + int(np.nanargmin(part)), start + int(np.nanargmax(part))]
        else:
            chosen.append(start)
    kept = np.unique(chosen)
    return time[kept], values[kept]


def broken(values: np.ndarray, turn: float) -> np.ndarray:
    """Values (n,) with NaN where an angle begins a turn anew: a line must not run across the page there."""
    if not np.isfinite(turn):
        return values
    out = values.copy()
    out[1:][np.abs(np.diff(values)) > turn / 2] = np.nan
    return out
