"""The curves of ensembles: percentiles as bands, the median, one flight, limits, and the column in which they stand."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import rerun as rr
from numpy.typing import ArrayLike

from sailviz.recording import timelines
from sailviz.recording.contract import word
from sailviz.recording.drawing import style
from sailviz.recording.drawing.arrival_plane import MILLI_AU
from sailviz.recording.drawing.log import Color, Index, Picture
from sailviz.recording.drawing.plot_column import PlotView, Slot
from sailviz.recording.drawing.plots import nice_range
from sailviz.run.arrays import EnsembleStatistics, Setting


@dataclass(frozen=True)
class Band:
    """Percentiles of one quantity as a plot. offset : whether the nominal flight's value is taken off."""

    key: str
    title: str
    factor: float
    column: int | None  # of the nominal state that is taken off, None for none


BANDS = {
    "radius_m": Band("radius_m", "Distance from the Sun less nominal [10⁻³ au]", 1 / MILLI_AU, 0),
    "axis_distance_m": Band("axis_distance_m", "Distance from the axis less nominal [10⁻³ au]", 1 / MILLI_AU, 0),
    "height_m": Band("height_m", "Height less nominal [10⁻³ au]", 1 / MILLI_AU, 2),
    "azimuth_rad": Band("azimuth_rad", "Azimuth less nominal [deg]", 180 / np.pi, 1),
    "transverse_speed_m_s": Band("transverse_speed_m_s", "Transverse speed less nominal [km/s]", 1e-3, 4),
    "radial_speed_m_s": Band("radial_speed_m_s", "Radial speed less nominal [km/s]", 1e-3, 3),
    "thrust_factor": Band("thrust_factor", "Thrust over nominal", 1.0, None),
    "thrust_voltage_V": Band("thrust_voltage_V", "Tether voltage [kV]", 1e-3, None),
    "solar_wind_pressure_Pa": Band("solar_wind_pressure_Pa", "Solar-wind dynamic pressure at 1 au [nPa]", 1e9, None),
    "irradiance_W_m2": Band("irradiance_W_m2", "Irradiance at 1 au [W/m²]", 1.0, None),
    "electrochromic_state": Band("electrochromic_state", "Electrochromic area: 0 black, 1 mirror", 1.0, None),
}
PLACES = ("radius_m", "axis_distance_m", "azimuth_rad", "height_m")
OWN = ("solar_wind_pressure_Pa", "irradiance_W_m2", "thrust_voltage_V", "thrust", "angles")  # the craft's own curves
DRIVERS = ("solar_wind_pressure_Pa", "irradiance_W_m2")
SPEEDS = ("transverse_speed_m_s", "radial_speed_m_s")


def band_values(ensemble: EnsembleStatistics, band: Band) -> np.ndarray:
    """Percentiles (m, n) as plotted."""
    values = ensemble.percentiles[band.key]
    if band.column is not None:
        values = values - ensemble.nominal[:, band.column]
    return band.factor * values


def log_ensemble_plots(
    picture: Picture, setting: Setting, ensemble: EnsembleStatistics, index: Index, color: Color, first: bool
) -> None:
    """The curves of one ensemble. first : whether it is the first of its run, which shows the wind that all share."""
    same_wind = len({(other.wind, other.seed) for other in setting.ensembles}) == 1
    for key in ensemble.percentiles:
        band = BANDS.get(key)
        if band is None or (key in DRIVERS and same_wind and not first):
            continue
        shown = style.WIND if key == "solar_wind_pressure_Pa" and same_wind else color
        log_band(picture, f"/plots/ensemble/{key}/{word(ensemble.name)}", band, ensemble, index, shown)
    if ensemble.control in ("pressure", "distance"):
        path = f"/plots/ensemble/saturated/{word(ensemble.name)}"
        log_curve(picture, path, index, 100 * ensemble.saturated, ensemble.name, color, style.WIDTH["plot"])
    ends = [0, -1]
    log_limits(picture, ensemble, timelines.time_columns(setting, ensemble.step[ends], ensemble.time[ends]))


def log_curve(
    picture: Picture, path: str, index: Index, values: ArrayLike, name: str, color: Color, width: float
) -> None:
    """One line of a plot. values : (n,)"""
    picture.log_static(path, rr.SeriesLines(names=[name], colors=[list(color)], widths=[width]))
    picture.log_columns(path, index, rr.Scalars.columns(scalars=values))


def log_filled(
    picture: Picture, path: str, index: Index, middle: np.ndarray, half: np.ndarray, name: str, color: Color
) -> None:
    """The room between two lines of a plot, by its middle and half its height, (n,) each."""
    picture.log_static(path, rr.Measurements.from_fields(colors=[list(color)], widths=[0.0], names=[name]))
    picture.log_columns(path, index, rr.Measurements.columns(values=middle, variances=half**2))


def log_band(picture: Picture, path: str, band: Band, ensemble: EnsembleStatistics, index: Index, color: Color) -> None:
    """Percentiles of one quantity round their median, and of what drives the flights the first of them."""
    names = [f"{level:g}" for level in ensemble.levels]
    values = band_values(ensemble, band)
    inner = len(names) // 2 if band.column is not None else 1  # what jumps has its outermost band alone
    for k in range(inner):
        low, high = values[k], values[-1 - k]
        if np.max(high - low, initial=0.0) <= 1e-9 * np.max(np.abs(values), initial=0.0):
            continue  # constant: a line says it
        label = f"{ensemble.name}, {names[k]}-{names[-1 - k]} %"
        middle, half = (low + high) / 2, (high - low) / 2
        log_filled(picture, f"{path}/band{k}", index, middle, half, label, style.dim(color, 0.9))
    median = values[len(values) // 2]
    log_curve(picture, f"{path}/median", index, median, f"{ensemble.name}, median", color, style.WIDTH["plot"])
    if band.key in (*DRIVERS, "thrust_voltage_V") and np.ptp(ensemble.one[band.key]) > 0:
        one = band.factor * ensemble.one[band.key]
        log_curve(picture, f"{path}/one", index, one, f"{ensemble.name}, one flight", color, 0.9)


def log_limits(picture: Picture, ensemble: EnsembleStatistics, index: Index) -> None:
    """Horizontal lines: where the voltage ends, and the pressure below which it does. index : of two rows."""
    lines = (
        ("thrust_voltage_V", "maximum_voltage_V", 1e-3, "largest voltage", style.FAULT),
        ("thrust_voltage_V", "nominal_voltage_V", 1e-3, "nominal voltage", style.REFERENCE),
        ("solar_wind_pressure_Pa", "saturation_pressure_Pa", 1e9, "saturates below", style.FAULT),
        ("solar_wind_pressure_Pa", "reference_pressure_Pa", 1e9, "nominal pressure", style.REFERENCE),
    )
    for key, limit, factor, name, color in lines:
        value = ensemble.limits.get(limit)
        if value is None or (ensemble.control != "pressure" and limit == "saturation_pressure_Pa"):
            continue
        path, shown = f"/plots/ensemble/{key}/limits", factor * value
        line = f"{path}/{limit.rsplit('_', 1)[0]}_{value:.6g}"
        log_curve(picture, line, index, [shown] * 2, f"{name}, {shown:.4g}", color, 1.0)
        if limit == "maximum_voltage_V":  # above it lies what cannot be
            top, beyond = 1.2 * value, f"{path}/beyond_{value:.6g}"
            middle, half = np.full(2, 0.5 * factor * (value + top)), np.full(2, 0.5 * factor * (top - value))
            log_filled(picture, beyond, index, middle, half, "saturated", style.FAULT)


def log_histogram(picture: Picture, ensemble: EnsembleStatistics, index: Index, color: Color) -> None:
    """How many of the flights, %, are how far from the nominal one."""
    edges = ensemble.histogram_edges / MILLI_AU
    middle = 0.5 * (edges[1:] + edges[:-1])
    picture.log_bars(f"/histogram/{word(ensemble.name)}", index, 100 * ensemble.histogram, middle, [*color, 255])


def slots_of(
    setting: Setting, shown: Sequence[PlotView], environment: Sequence[Sequence[PlotView]]
) -> tuple[Slot, ...]:
    """The column of curves of a run with ensembles; what the craft itself did stands behind, as tabs."""
    keys = [key for key in BANDS if any(key in ensemble.percentiles for ensemble in setting.ensembles)]
    own = {plot.paths[0]: plot for plot in (*shown, *(plot for group in environment for plot in group))}

    def view(key: str) -> PlotView:
        values = np.concatenate([band_values(c, BANDS[key]).ravel() for c in setting.ensembles if key in c.percentiles])
        paths = [f"/plots/ensemble/{key}/**"]
        low, high = float(values.min()), float(values.max())
        if key == "thrust_voltage_V":
            limits = [c.limits.get("maximum_voltage_V", 0.0) for c in setting.ensembles]
            low, high = min(low, 0.0), max(high, 1.08e-3 * max(limits))
        if key in DRIVERS:
            driven = [c for c in setting.ensembles if key in c.one]
            one = np.concatenate([BANDS[key].factor * ensemble.one[key] for ensemble in driven])
            low, high = min(low, one.min()), max(high, one.max())
        low, high = nice_range(low, high)
        return PlotView(BANDS[key].title, tuple(paths), low, high)

    def group(*names: str) -> list[PlotView]:
        return [view(key) for key in names if key in keys]

    places, speeds = group(*PLACES), group(*SPEEDS)
    acting = group(*DRIVERS)
    setting_it = group("thrust_voltage_V", "electrochromic_state")
    if any(ensemble.control in ("pressure", "distance") for ensemble in setting.ensembles):
        top = 100 * max(float(ensemble.saturated.max()) for ensemble in setting.ensembles)
        low, high = nice_range(0.0, max(top, 1.0))
        setting_it.append(PlotView("Flights at the largest voltage [%]", ("/plots/ensemble/saturated/**",), low, high))
    pushing = group("thrust_factor")
    rest = list(own.values())
    flown = [plot for plot in rest if plot.paths[0] == "/plots/distance"]
    own_curves = {path: [plot for plot in rest if plot.paths[0] == f"/plots/{path}"] for path in OWN}
    columns = [
        (places[:2] + speeds[:1] + flown, 3.0),
        (acting + own_curves["solar_wind_pressure_Pa"] + own_curves["irradiance_W_m2"], 2.2),
        (setting_it + own_curves["thrust_voltage_V"], 2.4),
        (pushing + own_curves["thrust"] + own_curves["angles"], 2.2),
    ]
    return tuple(Slot(tuple(plots), share) for plots, share in columns if plots)
