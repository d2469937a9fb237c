"""Which curves a run has, for people and in people's units, and the ranges in which they are shown."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from sailviz.recording.drawing import style
from sailviz.recording.drawing.craft import CraftDrawing
from sailviz.recording.drawing.samples import Frame
from sailviz.run.arrays import Run


@dataclass(frozen=True)
class Plot:
    """One view of curves. `values` gives (n, k) of a run, one column a name."""

    path: str
    title: str
    names: tuple[str, ...]
    colors: tuple[list[int], ...]
    values: Callable[[Run], np.ndarray]
    from_zero: bool = False
    noise: float = 0.0  # a change below it is rounding, and is not shown as a change


UNITS = {  # ending of a name -> factor and unit on the plot; the longest that fits counts
    "_rad": (180 / np.pi, "deg"),
    "_deg": (1.0, "deg"),
    "_N_m": (1e9, "nN/m"),
    "_N": (1e3, "mN"),
    "_Pa": (1e9, "nPa"),
    "_V": (1.0, "V"),
    "_kV": (1.0, "kV"),
    "_A": (1e3, "mA"),
    "_W": (1.0, "W"),
    "_W_m2": (1.0, "W/m²"),
    "_K": (1.0, "K"),
    "_eV": (1.0, "eV"),
    "_m": (1e-3, "km"),
    "_km": (1.0, "km"),
    "_m_s": (1e-3, "km/s"),
    "_m_s2": (1e3, "mm/s²"),
    "_T": (1e9, "nT"),
    "_s": (1.0, "s"),
    "_u": (1.0, "u"),
    "_sfu": (1.0, "sfu"),
}
LOGARITHMIC = {"_m3": "1/m³", "_1_m3": "1/m³", "_m_3": "1/m³", "_kg_m3": "kg/m³", "_per_m3": "1/m³"}
LOGARITHMIC_COLUMNS = {"air_drag_N": "N"}  # over many powers of ten although of another unit
DRAWN_OTHERWISE = ("earth_rotation_rad", "mean_altitude_m", "quasi_circular_altitude_m", "primer_direction")
COLORS = {"plasma_density_per_m3": style.SERIES[4], "plasma_force_N_m": style.THRUST, "air_drag_N": style.SERIES[1]}


def degrees(*columns: np.ndarray) -> np.ndarray:
    """Angles (n,) in rad side by side in degrees."""
    return np.asarray(np.degrees(np.stack(columns, 1)))


def bound(semi_major_axis: np.ndarray) -> np.ndarray:
    """Semi-major axes of closed orbits; NaN, which is not drawn, for open ones, whose axes are negative."""
    return np.where(semi_major_axis > 0, semi_major_axis, np.nan)


def pitch_and_cone(run: Run) -> np.ndarray:
    """Without thrust there is no cone angle."""
    return degrees(run.attitude.pitch, np.where(run.thrust.magnitude > 0, run.attitude.cone, np.nan))


def clock_about(start: float) -> Callable[[Run], np.ndarray]:
    """The clock angle in the turn about 0 or in that about 180 deg, whichever its first value is nearer to: an angle
    that sways about 0 must not jump by 360."""
    low = 0.0 if np.cos(start) < 0 else -np.pi
    return lambda run: degrees(np.mod(run.attitude.clock - low, 2 * np.pi) + low)


def plots_of(first: Run, frame: Frame, craft: CraftDrawing) -> list[Plot]:
    """All curves that are written of a run; the layout shows those that say something."""
    unit, name = thrust_units(first)
    environment = [
        name
        for name, values in first.environment.items()
        if values.dtype != bool and values.ndim == 1 and name not in DRAWN_OTHERWISE
    ]
    return [
        distance_plot(first, frame, craft),
        Plot(
            "/plots/inclination",
            "Inclination [deg]",
            ("i",),
            style.SERIES[2:3],
            lambda run: degrees(run.elements.inclination),
            noise=1e-3,
        ),
        Plot(
            "/plots/eccentricity",
            "Eccentricity",
            ("e",),
            style.SERIES[3:4],
            lambda run: run.elements.eccentricity[:, None],
        ),
        *(angle_plots(first) if craft.has_angles else []),
        Plot(
            "/plots/thrust",
            f"{craft.force} acceleration [{name}]",
            (craft.force.lower(),),
            (style.THRUST,),
            lambda run: unit * run.thrust.magnitude[:, None],
            from_zero=True,
        ),
        *([approximation_plot(first)] if first.approximations else []),
        *(environment_plot(name, COLORS.get(name, style.SERIES[(4 + k) % 5])) for k, name in enumerate(environment)),
    ]


def angle_plots(first: Run) -> list[Plot]:
    """Pitch, cone and clock angle."""
    return [
        Plot(
            "/plots/angles",
            "Pitch and cone angle [deg]",
            ("pitch", "cone"),
            (style.PITCH, style.CONE),
            pitch_and_cone,
            noise=1e-3,
        ),
        Plot(
            "/plots/clock",
            "Clock angle [deg]",
            ("clock",),
            (style.CLOCK,),
            clock_about(first.attitude.clock[0]),
            noise=1e-3,
        ),
    ]


def distance_plot(first: Run, frame: Frame, craft: CraftDrawing) -> Plot:
    """Distance and semi-major axis: over a planet from its surface, in km, elsewhere from the centre, in view units."""
    comes_down = craft.descends or "air_drag_N" in first.environment
    if comes_down and first.setting.body.radius:
        return descent_plot(first)
    radius = 0.0 if frame.sun else first.setting.body.radius
    unit = 1e3 if radius else frame.unit

    def values(run: Run) -> np.ndarray:
        r, a = np.linalg.norm(run.position, axis=1), bound(run.elements.semi_major_axis)
        return (np.stack([r, a], 1) - radius) / unit

    if radius:
        return Plot("/plots/altitude", "Altitude [km]", ("h", "a - R"), style.SERIES[:2], values)
    title = f"Distance r and semi-major axis a [{frame.unit_name}]"
    return Plot("/plots/distance", title, ("r", "a"), style.SERIES[:2], values)


def descent_plot(first: Run) -> Plot:
    """Altitudes over the equator's radius: of perigee and apogee, the mean one without the swing of an oblate planet
    where the run knows it, else of the semi-major axis, and of the analytic decay.
    """
    radius = first.setting.body.radius
    analytic = "quasi_circular_altitude_m" in first.environment

    def values(run: Run) -> np.ndarray:
        a, e = bound(run.elements.semi_major_axis), run.elements.eccentricity
        mean = run.environment.get("mean_altitude_m", a - radius)
        columns = [a * (1 - e) - radius, a * (1 + e) - radius, mean]
        if analytic:
            columns.append(run.environment["quasi_circular_altitude_m"])
        return np.stack(columns, 1) / 1e3

    names: tuple[str, ...] = ("perigee", "apogee", "mean")
    colors: tuple[list[int], ...] = (style.SERIES[2], style.SERIES[3], style.SERIES[0])
    if analytic:
        names, colors = (*names, "analytic decay"), (*colors, style.SERIES[1])
    return Plot("/plots/altitude", "Altitude [km]", names, colors, values)


def thrust_units(first: Run) -> tuple[float, str]:
    """The unit in which the first row's thrust is a handy number: the factor from m/s2, and its name."""
    size = float(first.thrust.magnitude[0])
    if size == 0 or size >= 0.0995e-3:
        return 1e3, "mm/s²"
    return (1e6, "µm/s²") if size >= 0.0995e-6 else (1e9, "nm/s²")


def approximation_plot(first: Run) -> Plot:
    """How far off other answers are, in per cent of the distance from the centre."""
    names = tuple(first.approximations)

    def values(run: Run) -> np.ndarray:
        off = [np.linalg.norm(run.approximations[name] - run.position, axis=1) for name in names]
        return np.asarray(100 * np.stack(off, 1) / np.linalg.norm(run.position, axis=1)[:, None])

    colors = tuple(style.SERIES[(1 + k) % 5] for k in range(len(names)))
    return Plot("/plots/approximation", "Approximation off by [% of r]", names, colors, values, from_zero=True)


def environment_plot(name: str, color: list[int]) -> Plot:
    """A column of the environment: title from its name, unit from the name's ending, densities as logarithms."""
    ending = max((u for u in (*UNITS, *LOGARITHMIC) if name.endswith(u)), key=len, default="")
    words = name.removesuffix(ending).replace("_", " ")
    words = words[:1].upper() + words[1:]
    if ending in LOGARITHMIC or name in LOGARITHMIC_COLUMNS:

        def values(run: Run) -> np.ndarray:
            with np.errstate(divide="ignore", invalid="ignore"):
                return np.asarray(np.log10(run.environment[name])[:, None])

        unit = LOGARITHMIC_COLUMNS[name] if name in LOGARITHMIC_COLUMNS else LOGARITHMIC[ending]
        title = f"{words} [log10 {unit}]"
        return Plot(f"/plots/{name}", title, (words.lower(),), (color,), values)
    factor, unit = (1e-3, "kV") if name == "thrust_voltage_V" else UNITS.get(ending, (1.0, ""))
    title = f"{words} [{unit}]" if unit else words
    return Plot(
        f"/plots/{name}", title, (words.lower(),), (color,), lambda run: factor * run.environment[name][:, None]
    )


def nice_range(low: float, high: float, numbers: float = 4.0) -> tuple[float, float]:
    """A range between round numbers and a margin, such that the viewer finds room for two numbers on the axis.

    It writes multiples of a power of ten where there is room for them: `numbers` is how many fit. A constant stands in
    the middle of a fifth of its size.
    """
    if high - low <= 1e-3 * max(abs(low), abs(high)):
        half = 0.1 * max(abs(low), abs(high)) or 0.5
        low, high = low - half, high + half
    span = high - low
    fine = 10.0 ** np.floor(np.log10(span))
    coarse = fine if span <= numbers * fine else 10 * fine
    for step in (coarse, fine):
        bottom, top = np.floor(low / step + 1e-9) * step, np.ceil(high / step - 1e-9) * step
        if span >= 0.45 * (top - bottom):
            break  # not too much empty room
    margin = 0.05 * (top - bottom)
    return float(bottom - margin), float(top + margin)
