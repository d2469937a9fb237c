"""The curves of ensembles: percentiles as bands, the median, one flight, limits, and the column in which they stand."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import rerun as rr
from numpy.typing import ArrayLike

from sailviz.recording import timelines
from sailviz.recording.contract import word
from sailviz.recording.drawing import style
from sailviz.recording.drawing.arrival_plane import MILLI_AU
from sailviz.recording.drawing.log import Color, Index, Picture
from sailviz.recording.drawing.plot_column import PlotView, nice_range
from sailviz.run.arrays import EnsembleStatistics, Setting


@dataclass(frozen=True)
class Band:
    """Percentiles of one quantity as a plot. offset : whether the nominal flight's value is taken off."""

    key: str
    title: str
    factor: float
    column: int | None  # of the nominal state that is taken off, None for none


BANDS = {
    "radius_m": Band("radius_m", "Distance from the Sun, less the calm flight's [0.001 au]", 1 / MILLI_AU, 0),
    "axis_distance_m": Band(
        "axis_distance_m", "Distance from the axis, less the calm flight's [0.001 au]", 1 / MILLI_AU, 0
    ),
    "height_m": Band("height_m", "Height, less the calm flight's [0.001 au]", 1 / MILLI_AU, 2),
    "azimuth_rad": Band("azimuth_rad", "Azimuth, less the calm flight's [deg]", 180 / np.pi, 1),
    "transverse_speed_m_s": Band("transverse_speed_m_s", "Transverse speed, less the calm flight's [km/s]", 1e-3, 4),
    "radial_speed_m_s": Band("radial_speed_m_s", "Radial speed, less the calm flight's [km/s]", 1e-3, 3),
    "thrust_factor": Band("thrust_factor", "Push over that in the calm wind", 1.0, None),
    "thrust_voltage_V": Band("thrust_voltage_V", "Voltage of the tethers [kV]", 1e-3, None),
    "solar_wind_pressure_Pa": Band("solar_wind_pressure_Pa", "Pressure of the solar wind at 1 au [nPa]", 1e9, None),
    "irradiance_W_m2": Band("irradiance_W_m2", "Sunshine at 1 au [W/m²]", 1.0, None),
    "electrochromic_state": Band("electrochromic_state", "Mirror share of the film's edge", 1.0, None),
}
PLACES = ("radius_m", "axis_distance_m", "azimuth_rad", "height_m")
DRIVERS = ("solar_wind_pressure_Pa", "irradiance_W_m2")
SPEEDS = ("transverse_speed_m_s", "radial_speed_m_s")
SET = ("thrust_voltage_V", "electrochromic_state", "thrust_factor")
BINS, BAR_ROWS = 16, 160


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
    if ensemble.control in ("pressure", "distance") and any(np.any(e.saturated) for e in setting.ensembles):
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


def log_bars(picture: Picture, setting: Setting, words: dict[str, str]) -> None:
    """How many of the flights, %, are how far from the calm one: the ensembles' bars side by side, so that where they
    overlap nothing is hidden."""
    ensembles = [e for e in setting.ensembles if e.method == "monte-carlo"]
    if not ensembles:
        return
    ensembles.sort(key=lambda e: -e.end_deviation[0])
    farthest = max(far_edge(e) for e in ensembles)
    edges = np.linspace(0.0, farthest, BINS + 1)
    wide = edges[1] / len(ensembles)
    middle = 0.5 * (edges[1:] + edges[:-1])
    for k, ensemble in enumerate(ensembles):
        some = np.unique(np.linspace(0, len(ensemble.time) - 1, BAR_ROWS).astype(int))
        heights = 100 * rebinned(ensemble, edges)[some]
        centers = (middle + (k - 0.5 * (len(ensembles) - 1)) * 0.9 * wide) / MILLI_AU
        color = [*style.ensemble_color(words[ensemble.name]), 255]
        index = timelines.time_columns(setting, ensemble.step[some], ensemble.time[some])
        path = f"/flights/{word(ensemble.name)}"
        picture.log_bars(path, index, heights, centers, color, 0.82 * wide / MILLI_AU)


def far_edge(ensemble: EnsembleStatistics) -> float:
    """The distance from the calm flight, m, within which all but a few flights end."""
    filled = np.flatnonzero(ensemble.histogram[-1] > 0.002)
    last = int(filled[-1]) + 1 if len(filled) else 1
    return float(ensemble.histogram_edges[min(last, len(ensemble.histogram_edges) - 1)])


def rebinned(ensemble: EnsembleStatistics, edges: np.ndarray) -> np.ndarray:
    """Shares (n, b) between coarser edges (b + 1,) m: a flight counts where the middle of its own bin lies, and in the
    last where it is farther."""
    own = 0.5 * (ensemble.histogram_edges[1:] + ensemble.histogram_edges[:-1])
    place = np.clip(np.floor(own / edges[1] + 1e-9).astype(int), 0, len(edges) - 2)
    found = np.zeros((len(ensemble.histogram), len(edges) - 1))
    for b in range(found.shape[1]):
        found[:, b] = ensemble.histogram[:, place == b].sum(1)
    return found


def plots_of_ensembles(setting: Setting) -> list[PlotView]:
    """The curves of a run with ensembles, most telling first: where they are, how fast, what drives them."""
    keys = [key for key in BANDS if any(key in ensemble.percentiles for ensemble in setting.ensembles)]
    wanted = [key for group in (PLACES, SPEEDS, DRIVERS, SET) for key in group if key in keys]
    views = [view for key in wanted if (view := band_view(setting, key)) is not None]
    if any(ensemble.control in ("pressure", "distance") for ensemble in setting.ensembles):
        top = 100 * max(float(ensemble.saturated.max()) for ensemble in setting.ensembles)
        if top > 0:
            low, high = nice_range(0.0, top)
            views.append(PlotView("Flights at the largest voltage [%]", ("/plots/ensemble/saturated/**",), low, high))
    return views


def band_view(setting: Setting, key: str) -> PlotView | None:
    """A quantity of all ensembles; None where nothing of it varies."""
    values = np.concatenate([band_values(c, BANDS[key]).ravel() for c in setting.ensembles if key in c.percentiles])
    low, high = float(values.min()), float(values.max())
    if key == "thrust_voltage_V":
        limits = [c.limits.get("maximum_voltage_V", 0.0) for c in setting.ensembles]
        low, high = min(low, 0.0), max(high, 1.08e-3 * max(limits))
    if key in DRIVERS:
        driven = [c for c in setting.ensembles if key in c.one]
        one = np.concatenate([BANDS[key].factor * ensemble.one[key] for ensemble in driven])
        low, high = min(low, one.min()), max(high, one.max())
    if high - low <= 1e-9 * max(abs(low), abs(high)):
        return None
    low, high = nice_range(low, high)
    return PlotView(BANDS[key].title, (f"/plots/ensemble/{key}/**",), low, high)
