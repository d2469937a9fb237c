"""Many flights at once: their paths up to now, where they are, ellipses about their mean, histograms.

All of it is known when the run begins and written at once. Colours tell ensembles apart everywhere; white is nominal.
/arrival shows the distance of the flights from the nominal one, each axis with a scale of its own.
"""

from __future__ import annotations

import numpy as np
import rerun as rr

from sailviz.recording import contract, timelines
from sailviz.recording.contract import word
from sailviz.recording.drawing import style
from sailviz.recording.drawing.arrival_plane import SIGMAS, arrivals_of, ellipses, log_arrival, log_arrival_axes
from sailviz.recording.drawing.ensemble_plots import log_bars, log_ensemble_plots
from sailviz.recording.drawing.layout import SO_FAR, Span
from sailviz.recording.drawing.log import Color, Index, Picture, f4
from sailviz.recording.drawing.samples import Frame
from sailviz.recording.drawing.style import points
from sailviz.run.arrays import EnsembleStatistics, Setting

PIECE = 3  # rows of an ensemble in one piece of its paths
BENT = 0.8  # rad that an ellipse may reach along the orbit to be drawn in space
PATHS = 40  # of an ensemble that are drawn


def log_ensembles(picture: Picture, setting: Setting, frame: Frame) -> dict[str, Span]:
    """Everything about the ensembles of a run: their numbers, their flights in space, their curves, their arrival ->
    the spans that views show."""
    arrivals, words = arrivals_of(setting), style.ensemble_words(setting.ensembles)
    for arrival in arrivals:
        log_arrival_axes(picture, arrival)
    for k, ensemble in enumerate(setting.ensembles):
        color, index = style.ensemble_color(words[ensemble.name]), index_of(setting, ensemble)
        table = contract.columns("/ensemble", contract.ensemble_table(ensemble))
        picture.log_columns(contract.ensemble_path(ensemble), index, table)
        picture.log_static(f"{contract.ensemble_path(ensemble)}/facts", contract.ensemble_facts(ensemble))
        log_flights(picture, setting, ensemble, color, frame.unit)
        log_ellipses(picture, ensemble, index, color, frame.unit)
        log_ensemble_plots(picture, setting, ensemble, index, color, first=k == 0)
        for arrival in arrivals:
            log_arrival(picture, arrival, ensemble, index, color)
    log_bars(picture, setting, words)
    log_nominal(picture, setting, frame.unit)
    paths = [f"/world/cloud/{word(ensemble.name)}/flights" for ensemble in setting.ensembles]
    return dict.fromkeys([*paths, "/world/nominal/path"], SO_FAR)


def index_of(setting: Setting, ensemble: EnsembleStatistics, some: slice | np.ndarray = slice(None)) -> Index:
    """The timelines of some of the rows of an ensemble."""
    return timelines.time_columns(setting, ensemble.step[some], ensemble.time[some])


def pieces(rows: int) -> tuple[np.ndarray, np.ndarray]:
    """First and last rows of the pieces in which lines are drawn; they join on."""
    starts = np.arange(0, rows - 1, PIECE)
    return starts, np.minimum(starts + PIECE, rows - 1)


def log_flights(picture: Picture, setting: Setting, ensemble: EnsembleStatistics, color: Color, length: float) -> None:
    """The paths of the flights that are drawn, and where they are. length : m of one view unit."""
    path = f"/world/cloud/{word(ensemble.name)}"
    places = ensemble.places(ensemble.kept) / length  # (k, n, 3)
    picture.log_strip_style(f"{path}/flights", style.dim(color, 0.42), style.WIDTH["flight"])
    starts, ends = pieces(len(ensemble.time))
    groups = [list(places[:PATHS, a : b + 1]) for a, b in zip(starts, ends, strict=True)]
    picture.log_broken_strips(f"{path}/flights", index_of(setting, ensemble, ends), groups)
    picture.log_static(
        f"{path}/now",
        rr.Points3D.from_fields(radii=points(style.FLIGHT_DOT), colors=[list(color)], point_shading="flat"),
    )
    now = rr.Points3D.columns(positions=f4(places.transpose(1, 0, 2).reshape(-1, 3)))
    columns = [*now.partition([len(places)] * len(ensemble.time))]
    picture.log_columns(f"{path}/now", index_of(setting, ensemble), columns)


def log_ellipses(picture: Picture, ensemble: EnsembleStatistics, index: Index, color: Color, length: float) -> None:
    """Ellipses about the mean, bent along the orbit, where they do not reach too far along it."""
    path = f"/world/cloud/{word(ensemble.name)}/ellipse"
    rings = np.stack([ensemble.places(ring) for ring in ellipses(ensemble)], axis=1) / length  # (n, sigmas, RING, 3)
    reach = np.sqrt(np.maximum(ensemble.covariance[:, 1, 1], 0.0))[:, None] * SIGMAS
    picture.log_strip_style(path, color, style.WIDTH["orbit"])
    picture.log_broken_strips(path, index, [list(g[far < BENT]) for g, far in zip(rings, reach, strict=True)])


def log_nominal(picture: Picture, setting: Setting, length: float) -> None:
    """The flight without wind, which all ensembles share: its path so far and its place."""
    ensemble = setting.ensembles[0]
    line, index = ensemble.places(ensemble.nominal) / length, index_of(setting, ensemble)
    picture.log_strip_style("/world/nominal/path", style.NOMINAL, style.WIDTH["nominal"])
    starts, ends = pieces(len(line))
    beside = 1.004 * line  # a line on the craft's own trail would tear
    strips = [[beside[a : b + 1]] for a, b in zip(starts, ends, strict=True)]
    picture.log_broken_strips("/world/nominal/path", index_of(setting, ensemble, ends), strips)
    picture.log_static("/world/nominal/place", rr.Points3D.from_fields(radii=points(3.4), colors=[style.NOMINAL]))
    picture.log_columns("/world/nominal/place", index, rr.Points3D.columns(positions=f4(line)))
