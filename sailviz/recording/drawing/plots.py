"""Which curves a run has, for people and in people's units: each with the size at which a change of it is worth
showing."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from sailviz.recording.drawing import style
from sailviz.recording.drawing.craft import CraftDrawing
from sailviz.recording.drawing.log import Color
from sailviz.recording.drawing.samples import Frame
from sailviz.recording.drawing.shares import device_colors
from sailviz.run.arrays import Run

Values = Callable[[Run], np.ndarray]


@dataclass(frozen=True)
class Plot:
    """One view of curves. `values` gives (n, k) of a run, one column a name.

    natural : the change, in the plot's unit, that is worth as much as another's; a negative one is that share of the
    largest value. bonus : what the quantity counts beside others.
    """

    key: str  # a word, by which a scene may ask for it
    title: str
    names: tuple[str, ...]
    colors: tuple[Color, ...]
    values: Values
    natural: float
    bonus: float = 1.0
    from_zero: bool = False
    steady: str = ""  # how a constant one is told, with {} for the number; "" where it is not worth telling
    rare: bool = False  # shown only where the scene asks for it
    handy: bool = False  # in m/s2; its unit is chosen when the largest value of the run is known
    swings: str = "band"  # how a swing within a revolution is shown: "band", its "mean" alone, or as it is, ""
    noise: float = 0.0  # a change below it is rounding, and is not shown as a change

    def is_called(self, word: str) -> bool:
        """Whether a scene means it by a word: its key, with or without the unit at its end."""
        return self.key == word or (self.key.startswith(f"{word}_"))

    @property
    def path(self) -> str:
        """Where its curves are written."""
        return f"/plots/{self.key}"


UNITS = {  # ending of a name -> factor and unit on the plot; the longest that fits counts
    "_rad": (180 / np.pi, "deg"),
    "_rad_s": (30 / np.pi, "rpm"),
    "_deg": (1.0, "deg"),
    "_N_m": (1e9, "nN"),
    "_torque_N_m": (1.0, "N m"),
    "_x_m": (1e3, "mm"),
    "_y_m": (1e3, "mm"),
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
DECADE = 1.0  # natural size of a logarithm
DRAWN_OTHERWISE = (
    "earth_rotation_rad",
    "mean_altitude_m",
    "quasi_circular_altitude_m",
    "primer_direction",
    "thrust_factor",
)
WORDS = {  # columns of the environment whose title is not their name
    "plasma_force_N_m": "Drag on each metre of tether",
    "solar_flux_sfu": "Solar activity, F10.7",
    "plasma_density_per_m3": "Plasma density",
    "air_density_kg_m3": "Air density",
    "solar_wind_pressure_Pa": "Pressure of the solar wind",
    "irradiance_W_m2": "Sunshine at 1 au",
    "electrochromic_state": "Mirror share of the film's edge",
    "altitude_over_ellipsoid_m": "Height over the ellipsoid",
    "modulation": "Swing of the voltage about its mean",
    "thrust_lost": "Thrust that the swing costs",
    "wheel_torque_N_m": "Torque of the wind on the wheel",
    "slide_x_m": "Place of the sliding mass along x",
    "slide_y_m": "Place of the sliding mass along y",
    "switching_function": "Switching function: pushes where positive",
}
COLOR_OF = (  # part of a column's name -> the quantity whose colour it has
    ("plasma_force", "drag"),
    ("sunlit", "sunlight"),
    ("air", "air"),
    ("plasma", "plasma"),
    ("ion", "plasma"),
    ("wind", "wind"),
    ("voltage", "voltage"),
    ("current", "current"),
    ("power", "power"),
    ("flux", "sunlight"),
    ("irradiance", "sunlight"),
    ("tilt", "sail angle"),
    ("altitude", "altitude"),
    ("switching", "switch"),
)
BONUS = {"plasma_force_N_m": 1.2, "throttle": 2.0}  # of columns of the environment that say much
RARE = ("switching_function",)  # only where the scene is about it


def degrees(*columns: np.ndarray) -> np.ndarray:
    """Angles (n,) in rad side by side in degrees."""
    return np.asarray(np.degrees(np.stack(columns, 1)))


def bound(semi_major_axis: np.ndarray) -> np.ndarray:
    """Semi-major axes of closed orbits; NaN, which is not drawn, for open ones, whose axes are negative."""
    return np.where(semi_major_axis > 0, semi_major_axis, np.nan)


def angles_of_sail(run: Run) -> np.ndarray:
    """The sail's and the thrust's angle from the radial line; without thrust there is none."""
    return degrees(run.attitude.pitch, np.where(run.thrust.magnitude > 0, run.attitude.cone, np.nan))


def clock_about(start: float) -> Values:
    """The clock angle in the turn about 0 or in that about 180 deg, whichever its first value is nearer to: an angle
    that sways about 0 must not jump by 360."""
    low = 0.0 if np.cos(start) < 0 else -np.pi
    return lambda run: degrees(np.mod(run.attitude.clock - low, 2 * np.pi) + low)


def plots_of(first: Run, frame: Frame, craft: CraftDrawing) -> list[Plot]:
    """All curves that are gathered of a run; those that say something are written."""
    low = frame.low
    found = [altitude_plot(first)] if low else open_space_plots(first, frame, craft)
    if craft.pushes and not (low and "plasma_force_N_m" in first.environment):
        found.append(push_plot(craft, first))
    found += [replace(plot, rare=low) for plot in orbit_plots()]
    if first.approximations:
        found.append(approximation_plot(first))
    for name, values in first.environment.items():
        if values.dtype != bool and values.ndim == 1 and name not in DRAWN_OTHERWISE:
            found.append(environment_plot(name))
    return found


def open_space_plots(first: Run, frame: Frame, craft: CraftDrawing) -> list[Plot]:
    """Distances, speed and the sail's angles."""
    q, unit = style.QUANTITY, frame.unit
    from_body = "the Sun" if frame.sun else first.setting.body.name if frame.unit_name == "au" else "the centre"
    found = [
        Plot(
            "distance",
            f"Distance from {from_body} [{frame.unit_name}]",
            ("distance", "semi-major axis"),
            (q["distance"], q["semi-major axis"]),
            lambda run: np.stack([np.linalg.norm(run.position, axis=1), bound(run.elements.semi_major_axis)], 1) / unit,
            natural=-0.5,
            bonus=1.3,
            steady=f"distance {{:.3g}} {frame.unit_name}",
        ),
        Plot(
            "speed",
            "Speed [km/s]",
            ("speed",),
            (q["speed"],),
            lambda run: 1e-3 * np.linalg.norm(run.velocity, axis=1)[:, None],
            natural=-0.6,
            bonus=0.8,
        ),
        Plot(
            "height",
            f"Height above the {'ecliptic' if frame.sun else 'plane x, y'} [{frame.unit_name}]",
            ("height",),
            (q["height"],),
            lambda run: run.position[:, 2:] / unit,
            natural=0.5 * frame.origin_radius,
            noise=1e-9 * frame.origin_radius,
        ),
    ]
    if craft.has_angles and craft.flow_word:
        found.append(
            Plot(
                "angle",
                f"{craft.sail_word[:1].upper()}{craft.sail_word[1:]} off the {craft.flow_word} [deg]",
                ("sail", "push"),
                (q["sail angle"], q["cone angle"]),
                angles_of_sail,
                natural=40.0,
                bonus=1.1,
                steady=f"{craft.sail_word} {{:.0f}}° off the {craft.flow_word}",
                noise=1e-3,
            )
        )
        found.append(
            Plot(
                "clock",
                "Clock angle [deg]",
                ("clock",),
                (q["clock angle"],),
                clock_about(first.attitude.clock[0]),
                natural=90.0,
                bonus=0.6,
                noise=1e-3,
            )
        )
    if frame.sun and "Earth" in first.bodies:
        found.append(
            Plot(
                "earth",
                "Distance from the Earth [au]",
                ("distance from the Earth",),
                (q["distance from the Earth"],),
                lambda run: np.linalg.norm(run.position - run.bodies["Earth"], axis=1)[:, None] / unit,
                natural=frame.origin_radius,
                bonus=0.5,
                from_zero=True,
                swings="",
            )
        )
    return found


def orbit_plots() -> list[Plot]:
    """How the orbit lies and how round it is."""
    q = style.QUANTITY
    return [
        Plot(
            "inclination",
            "Inclination [deg]",
            ("inclination",),
            (q["inclination"],),
            lambda run: degrees(run.elements.inclination),
            natural=40.0,
            noise=1e-3,
        ),
        Plot(
            "eccentricity",
            "Eccentricity",
            ("eccentricity",),
            (q["eccentricity"],),
            lambda run: run.elements.eccentricity[:, None],
            natural=0.5,
            from_zero=True,
        ),
    ]


def altitude_plot(first: Run) -> Plot:
    """Altitudes over the equator's radius: the mean one without the swing of an oblate planet where the run knows it,
    else of the semi-major axis; of the lowest and the highest point of the orbit; and of the analytic decay.
    """
    radius = first.setting.body.radius
    analytic = "quasi_circular_altitude_m" in first.environment

    def values(run: Run) -> np.ndarray:
        a, e = bound(run.elements.semi_major_axis), run.elements.eccentricity
        mean = run.environment.get("mean_altitude_m", a - radius)
        columns = [mean, a * (1 - e) - radius, a * (1 + e) - radius]
        if analytic:
            columns.append(run.environment["quasi_circular_altitude_m"])
        return np.stack(columns, 1) / 1e3

    names: tuple[str, ...] = ("altitude", "lowest", "highest")
    if analytic:
        names = (*names, "closed form")
    colors = tuple(style.QUANTITY["analytic" if name == "closed form" else name] for name in names)
    return Plot(
        "altitude",
        "Altitude [km]",
        names,
        colors,
        values,
        natural=-0.3,
        bonus=1.5,
        steady="{:.0f} km up",
        swings="mean",
    )


def push_plot(craft: CraftDrawing, first: Run) -> Plot:
    """The size of what pushes or brakes, and of several devices what each does."""
    word, colors = craft.force, device_colors(first) if len(first.devices) > 1 else {}

    def values(run: Run) -> np.ndarray:
        return np.stack([run.thrust.magnitude, *(run.devices[name].magnitude for name in colors)], 1)

    return Plot(
        "push",
        f"{word[:1].upper()}{word[1:]}",
        (word, *colors),
        (style.QUANTITY[word], *colors.values()),
        values,
        natural=-0.6,
        bonus=1.2,
        from_zero=True,
        steady=word,
        handy=True,
    )


def approximation_plot(first: Run) -> Plot:
    """How far off other answers are, in per cent of the distance from the centre."""
    names = tuple(first.approximations)

    def values(run: Run) -> np.ndarray:
        off = [np.linalg.norm(run.approximations[name] - run.position, axis=1) for name in names]
        return np.asarray(100 * np.stack(off, 1) / np.linalg.norm(run.position, axis=1)[:, None])

    colors = tuple(style.family(style.APPROXIMATION, len(names)))
    return Plot(
        "approximation",
        "Approximation off by [% of the distance]",
        names,
        colors,
        values,
        natural=1.0,
        bonus=1.6,
        from_zero=True,
    )


def scale_of(name: str, ending: str) -> tuple[float, str]:
    """Factor and unit on the plot of a column with an ending of UNITS: that of a torque is no force per length."""
    return (1e6, "µN m") if "_torque_" in name else UNITS.get(ending, (1.0, ""))


def environment_plot(name: str) -> Plot:
    """A column of the environment: title from its name, unit from the name's ending, densities as logarithms."""
    ending = max((u for u in (*UNITS, *LOGARITHMIC) if name.endswith(u)), key=len, default="")
    words = name.removesuffix(ending).replace("_", " ")
    title = WORDS.get(name, words[:1].upper() + words[1:])
    color = style.QUANTITY[next((quantity for part, quantity in COLOR_OF if part in name), "switch")]
    if ending in LOGARITHMIC or name == "air_drag_N":
        unit = LOGARITHMIC.get(ending, "N")

        def values(run: Run) -> np.ndarray:
            with np.errstate(divide="ignore", invalid="ignore"):
                found = np.log10(run.environment[name])[:, None]
            return np.asarray(np.where(np.isfinite(found), found, np.nan))

        return Plot(name, f"{title} [log10 of {unit}]", (words.lower(),), (color,), values, natural=DECADE)
    turns = "_torque_" in name
    factor, unit = (1e-3, "kV") if name == "thrust_voltage_V" else scale_of(name, ending)
    return Plot(
        name,
        f"{title} [{unit}]" if unit else title,
        (words.lower(),),
        (color,),
        lambda run: factor * run.environment[name][:, None],
        natural=1.0 if turns else -0.6,  # less than 1 µN m is of no weight, and may be rounding
        bonus=BONUS.get(name, 0.6 if turns else 0.9),
    )
