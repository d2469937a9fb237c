"""Ensembles of a craft that turns: the axes of their flights on the sphere of directions, percentiles as bands, and the
share of the flights that have met an event.

Colours tell ensembles apart everywhere; white is the scene's own flight.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import rerun as rr

from sailviz.recording import contract, timelines
from sailviz.recording.attitude_ensembles import (
    attitude_ensemble_facts,
    attitude_ensemble_path,
    attitude_ensemble_table,
)
from sailviz.recording.contract import word
from sailviz.recording.drawing import style
from sailviz.recording.drawing.ensemble_plots import log_curve, log_filled
from sailviz.recording.drawing.log import Color, Index, Picture, f4
from sailviz.recording.drawing.plot_column import PlotView, nice_range
from sailviz.recording.drawing.style import points
from sailviz.run.arrays import AttitudeEnsemble, Setting

TAIL = 12  # rows of an ensemble over which an axis has a tail
NEAR = np.cos(np.radians(40.0))  # between two rows, beyond which a line would be made up
OFF = 1.004  # radius of the sphere on which axes stand, over that of the trace
PLOTS = "/plots/attitude_ensemble"
COLORS = ("orange", "violet", "green", "blue", "pink")  # of ensembles in their order


@dataclass(frozen=True)
class Curve:
    """A quantity as a plot: title, and the unit's factor."""

    title: str
    factor: float


CURVES = {
    "pitch_rad": Curve("Pitch angle of the flights [deg]", 180 / np.pi),
    "body_rate_rad_s": Curve("Body rate of the flights [deg/s]", 180 / np.pi),
    "wheel_momentum_N_m_s": Curve("Fullest wheel of the flights [mN m s]", 1e3),
    "control_torque_N_m": Curve("Torque of the flights' actuators [mN m]", 1e3),
    "nutation_rad": Curve("Nutation of the flights [deg]", 180 / np.pi),
    "light_torque_N_m": Curve("Torque of the light on the flights [mN m]", 1e3),
    "air_torque_N_m": Curve("Torque of the air on the flights [mN m]", 1e3),
}


def color_words(ensembles: Sequence[AttitudeEnsemble]) -> dict[str, str]:
    """The colour of each ensemble by its name, in a word."""
    return {one.name: COLORS[k] if k < len(COLORS) else "grey" for k, one in enumerate(ensembles)}


def log_attitude_ensembles(picture: Picture, setting: Setting) -> list[PlotView]:
    """Numbers and curves of the ensembles of a craft that turns -> views of them, most telling first."""
    words = color_words(setting.attitude_ensembles)
    for ensemble in setting.attitude_ensembles:
        path, index = attitude_ensemble_path(ensemble), index_of(setting, ensemble)
        picture.log_columns(path, index, contract.columns(path, attitude_ensemble_table(ensemble)))
        picture.log_static(f"{path}/facts", attitude_ensemble_facts(ensemble))
        color = style.ensemble_color(words[ensemble.name])
        for key in (key for key in CURVES if key in ensemble.percentiles):
            log_band(picture, setting, key, ensemble, color)
        for event in ensemble.met:
            share = 100 * ensemble.share(event)
            curve = f"{PLOTS}/share/{word(ensemble.name)}/{word(event)}"
            log_curve(picture, curve, index, share, f"{ensemble.name}, {event}", color, style.WIDTH["plot"])
    views = [share_view(setting), *(view_of(setting, key) for key in CURVES)]
    return [view for view in views if view is not None]


def index_of(setting: Setting, ensemble: AttitudeEnsemble, some: slice | np.ndarray = slice(None)) -> Index:
    """The timelines of some of the rows of an ensemble."""
    return timelines.time_columns(setting, ensemble.step[some], ensemble.time[some])


def log_band(picture: Picture, setting: Setting, key: str, ensemble: AttitudeEnsemble, color: Color) -> None:
    """Percentiles of one quantity round their median, and the scene's own flight."""
    curve, path = CURVES[key], f"{PLOTS}/{key}/{word(ensemble.name)}"
    levels = [f"{level:g}" for level in ensemble.levels]
    values = curve.factor * ensemble.percentiles[key]
    known = ~np.isnan(values[0])
    index, values = index_of(setting, ensemble, np.flatnonzero(known)), values[:, known]
    for k in range(1 if len(setting.attitude_ensembles) > 1 else len(levels) // 2):  # of several the widest alone
        low, high = values[k], values[-1 - k]
        label = f"{ensemble.name}, {levels[k]}-{levels[-1 - k]} %"
        log_filled(picture, f"{path}/band{k}", index, (low + high) / 2, (high - low) / 2, label, style.dim(color, 0.9))
    middle = values[len(levels) // 2]
    log_curve(picture, f"{path}/median", index, middle, f"{ensemble.name}, median", color, style.WIDTH["plot"])
    if ensemble is setting.attitude_ensembles[0]:
        own, whole = curve.factor * ensemble.nominal[key], index_of(setting, ensemble)
        log_curve(picture, f"{PLOTS}/{key}/nominal", whole, own, "nominal flight", style.NOMINAL, 0.9)


def view_of(setting: Setting, key: str) -> PlotView | None:
    """A quantity of all ensembles; None where none has it, or it is one number."""
    having = [one for one in setting.attitude_ensembles if key in one.percentiles]
    if not having:
        return None
    parts = [values[key].ravel() for one in having for values in (one.percentiles, one.nominal)]
    values = CURVES[key].factor * np.concatenate(parts)
    values = values[np.isfinite(values)]
    if not len(values) or np.ptp(values) <= 1e-9 * np.abs(values).max():
        return None
    low, high = nice_range(float(values.min()), float(values.max()))
    return PlotView(CURVES[key].title, (f"{PLOTS}/{key}/**",), low, high)


def share_view(setting: Setting) -> PlotView | None:
    """How many of the flights have met an event."""
    if not any(one.met for one in setting.attitude_ensembles):
        return None
    low, high = nice_range(0.0, 100.0)
    return PlotView("Flights that have met an event [%]", (f"{PLOTS}/share/**",), low, high)


def log_axes(picture: Picture, setting: Setting) -> None:
    """On the sphere of directions where the axes of the flights point that are kept, each with its way over the last
    rows of the ensemble, where it is known."""
    words = color_words(setting.attitude_ensembles)
    for ensemble in setting.attitude_ensembles:
        path, color = f"/axis/ensemble/{word(ensemble.name)}", style.ensemble_color(words[ensemble.name])
        axes, index = OFF * ensemble.kept_axis, index_of(setting, ensemble)  # (k, n, 3)
        picture.log_static(
            f"{path}/now", rr.Points3D.from_fields(radii=points(2.2), colors=[list(color)], point_shading="flat")
        )
        picture.log_strip_style(f"{path}/tail", style.dim(color, 0.5), style.WIDTH["flight"])
        there = [axes[~np.isnan(axes[:, row, 0]), row] for row in range(axes.shape[1])]
        spots = rr.Points3D.columns(positions=f4(np.concatenate(there)))
        picture.log_columns(f"{path}/now", index, spots.partition([len(spot) for spot in there]))
        tails = [[line for flight in axes for line in tail(flight[: row + 1])] for row in range(axes.shape[1])]
        picture.log_broken_strips(f"{path}/tail", index, tails)


def tail(axis: np.ndarray) -> list[np.ndarray]:
    """The end of a way (n, 3), broken where it turns too far between two rows."""
    axis = axis[-TAIL:]
    axis = axis[~np.isnan(axis[:, 0])]
    near = np.sum(axis[1:] * axis[:-1], axis=1) > NEAR * OFF**2
    pieces = np.split(axis, np.flatnonzero(~near) + 1)
    return [piece for piece in pieces if len(piece) > 1]


def table_of(setting: Setting) -> list[str]:
    """A table: what was drawn, in how many flights the craft tumbled, and how fast it turns in the end."""
    words = color_words(setting.attitude_ensembles)
    events = list(dict.fromkeys(name for one in setting.attitude_ensembles for name in one.met))[:2]
    heads = ["colour", "flights", *events, "turns in the end, deg/s, median and 99 %", "ensemble"]
    lines = [f"| {' | '.join(heads)} |", "|" + "---|" * len(heads)]
    for one in setting.attitude_ensembles:
        shares = [f"{100 * one.share(event)[-1]:.3g} %" for event in events]
        rates = np.degrees(one.percentiles["body_rate_rad_s"][:, -1])
        ends = f"{rates[len(rates) // 2]:.3g}, {rates[-1]:.3g}"
        cells = [f"**{words[one.name]}**", f"{one.flights:,}", *shares, ends, one.name]
        lines.append(f"| {' | '.join(cells)} |")
    return lines
