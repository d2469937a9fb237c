"""Ensembles of a recording on paper: the calm flight, the mean of the others with bands of one, two and three standard
deviations, percentiles of what drives them, and how far they are from the calm flight at the end."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from sailviz.constants import AU
from sailviz.recording.drawing import style as colors
from sailviz.recording.reader import Recording

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from sailviz.figures.page import Pen

SIGMAS = (3, 2, 1)
ALPHA = {3: 0.12, 2: 0.16, 1: 0.24}  # of the bands, one over the other
MILLI_AU = 1e-3 * AU
FLAT = 1e-9  # a spread of that share of the distance, or in rad, is rounding
FEW = 0.002  # share of the flights in a bin from which it is worth room
DRIVERS = {"thrust_factor": 1.0, "thrust_voltage_V": 1.0, "solar_wind_pressure_Pa": 1e9, "irradiance_W_m2": 1.0}


@dataclass(frozen=True)
class Ensemble:
    """An ensemble as recorded. time (n,) s; nominal, mean, deviation (n, 3): distance from the axis m, azimuth rad,
    height m; edges (b + 1,) m and shares (b,) of the flights at the end; percentiles name -> (n, m) at levels (m,)."""

    name: str
    color: Sequence[int]
    planar: bool  # whether its distance from the axis is that from the Sun
    time: np.ndarray
    nominal: np.ndarray
    mean: np.ndarray
    deviation: np.ndarray
    edges: np.ndarray
    shares: np.ndarray
    levels: np.ndarray
    percentiles: dict[str, np.ndarray]


@dataclass(frozen=True)
class Offset:
    """One coordinate less that of the calm flight, for a panel of its own."""

    gid: str
    words: str
    column: int
    size: float  # of the unit


OFFSETS = (
    Offset("distance", "Distance from {centre}, less the calm flight's [0.001 au]", 0, MILLI_AU),
    Offset("azimuth", "Azimuth, less the calm flight's [°]", 1, np.pi / 180),
    Offset("height", "Height, less the calm flight's [0.001 au]", 2, MILLI_AU),
)


def ensembles_of(recording: Recording) -> list[Ensemble]:
    """All ensembles of a recording, in the order of their names; [] where there is none."""
    paths = [name for name in recording.entities if name.startswith("/ensemble/") and name.count("/") == 2]
    return [ensemble_of(recording, path) for path in paths]


def color_of(recording: Recording, path: str) -> Sequence[int]:
    """The colour that an ensemble has in the recording's picture, which tells it from all others."""
    drawn = f"/world/cloud/{path.rsplit('/', 1)[-1]}/now"
    if drawn not in recording:
        return colors.REFERENCE
    packed = int(recording[drawn]["colors"].ravel()[0])
    return packed >> 24, packed >> 16 & 255, packed >> 8 & 255


def ensemble_of(recording: Recording, path: str) -> Ensemble:
    """One ensemble."""
    table, facts = recording[path], recording[f"{path}/facts"]
    levels = facts["levels"].ravel()
    percentiles = {name: table[name] for name in table if table[name].shape == (len(table["time_s"]), len(levels))}
    planar = "radius_m" in percentiles
    nominal, mean = table["nominal_position_m"], table["mean_position_m"]
    axes = axes_of(nominal, table["kept_position_m"].reshape(-1, 3) if planar else nominal - nominal.mean(0))
    places = [cylindrical(at, axes) for at in (nominal, mean)]
    spread = np.sqrt(np.maximum(table["covariance_m2"][:, [0, 4, 8]], 0))
    spread[:, 1] /= places[1][:, 0]
    return Ensemble(
        str(facts["name"][0]),
        color_of(recording, path),
        planar,
        table["time_s"],
        places[0],
        places[1],
        spread,
        facts["histogram_edges_m"].ravel(),
        np.atleast_2d(table["histogram"])[-1] if table["histogram"].ndim > 1 else np.zeros(0),
        levels,
        percentiles,
    )


def axes_of(nominal: np.ndarray, spanning: np.ndarray) -> np.ndarray:
    """Rows (3, 3): azimuth 0 at the first of the calm flight's positions (n, 3), azimuth 90 degrees, and the axis about
    which it goes round; spanning (m, 3) : vectors in the plane across the axis."""
    axis = np.linalg.svd(spanning, full_matrices=False)[2][2]
    turned = float(np.cross(nominal[:-1], nominal[1:]).sum(0) @ axis)
    axis = axis if (turned or axis[2]) >= 0 else -axis
    first = nominal[0] - (nominal[0] @ axis) * axis
    first = first / np.linalg.norm(first)
    return np.stack([first, np.cross(axis, first), axis])


def cylindrical(positions: np.ndarray, axes: np.ndarray) -> np.ndarray:
    """Positions (n, 3) m -> distance from the axis m, azimuth rad without jumps, height m."""
    x, y, z = (positions @ axes.T).T
    return np.stack([np.hypot(x, y), np.unwrap(np.arctan2(y, x)), z], 1)


def offsets_of(ensembles: list[Ensemble]) -> list[Offset]:
    """The coordinates in which the ensembles spread at all."""
    scale = np.array([AU, 1.0, AU])
    found = []
    for offset in OFFSETS:
        away = [np.abs(e.mean - e.nominal)[:, offset.column].max() for e in ensembles]
        wide = [e.deviation[:, offset.column].max() for e in ensembles]
        if max(away + wide) > FLAT * scale[offset.column]:
            found.append(offset)
    return found


def draw_offset(pen: Pen, panel: Axes, ensembles: list[Ensemble], offset: Offset, day: float) -> None:
    """One coordinate of all ensembles over time; day : seconds of the axis' unit."""
    for ensemble in ensembles:
        away = (ensemble.mean - ensemble.nominal)[:, offset.column] / offset.size
        spread = ensemble.deviation[:, offset.column] / offset.size
        draw_sigmas(pen, panel, ensemble, ensemble.time / day, away, spread, offset.gid)
    panel.axhline(0, color=pen.style.ink, linewidth=1.1, linestyle=(0, (5, 3)), gid=f"{offset.gid}, calm flight")
    centre = "the Sun" if all(ensemble.planar for ensemble in ensembles) else "the axis"
    panel.set_title(offset.words.format(centre=centre), loc="left", fontsize=10.5)
    panel.set_title("mean, and 1, 2 and 3 standard deviations", loc="right", fontsize=8.5, color=pen.style.quiet)
    ends = ensembles[0].time
    panel.set_xlim(ends[0] / day, ends[-1] / day)


def draw_sigmas(
    pen: Pen, panel: Axes, ensemble: Ensemble, time: np.ndarray, mean: np.ndarray, spread: np.ndarray, gid: str
) -> None:
    """The mean in bands of one, two and three standard deviations."""
    color = pen.readable(ensemble.color)
    for count in SIGMAS:
        low, high = mean - count * spread, mean + count * spread
        name = f"{gid}, {ensemble.name}, {count} sigma"
        panel.fill_between(time, low, high, color=color, alpha=ALPHA[count], linewidth=0, gid=name)
    panel.plot(time, mean, color=color, label=f"{ensemble.name}, mean", gid=f"{gid}, {ensemble.name}, mean")


def draw_drivers(pen: Pen, panel: Axes, ensembles: list[Ensemble], name: str, day: float) -> None:
    """Percentiles and median of what drives the flights, over the run's own curve, in its unit."""
    driven = [one for one in ensembles if name in one.percentiles]
    alike = all(np.array_equal(one.percentiles[name], driven[0].percentiles[name]) for one in driven)
    for ensemble in driven[:1] if alike else driven:
        values = DRIVERS[name] * ensemble.percentiles[name]
        color = pen.readable(colors.REFERENCE if alike else ensemble.color)
        whose = "all flights" if alike else ensemble.name
        label = f"{whose}, {ensemble.levels[0]:g}-{ensemble.levels[-1]:g} %"
        time, middle = ensemble.time / day, values[:, values.shape[1] // 2]
        panel.fill_between(
            time, values[:, 0], values[:, -1], color=color, alpha=0.25, linewidth=0, label=label, gid=label, zorder=2.5
        )
        panel.plot(time, middle, color=color, linewidth=1.3, gid=f"{name}, {ensemble.name}, median", zorder=3)


def draw_histogram(pen: Pen, panel: Axes, ensembles: list[Ensemble]) -> None:
    """How many of the flights are how far from the calm one at the end; outlines, so that nothing hides another."""
    farthest = 0.0
    for ensemble in ensembles:
        if not has_histogram(ensemble):
            continue
        edges, shares, color = ensemble.edges / MILLI_AU, 100 * ensemble.shares, pen.readable(ensemble.color)
        name = f"end, {ensemble.name}"
        panel.stairs(shares, edges, fill=True, color=color, alpha=0.25, gid=f"{name}, filled")
        panel.stairs(shares, edges, color=color, linewidth=1.5, label=ensemble.name, gid=name)
        filled = np.flatnonzero(ensemble.shares > FEW)
        farthest = max(farthest, float(edges[min(filled[-1] + 2, len(edges) - 1)]))
    panel.set_xlim(0, farthest)
    panel.set_title("Flights [%] by distance from the calm flight at the end", loc="left", fontsize=10.5)
    panel.set_xlabel("distance from the calm flight [0.001 au]")


def has_histogram(ensemble: Ensemble) -> bool:
    """Whether flights were counted."""
    return len(ensemble.shares) > 1 and float(ensemble.shares.sum()) > 0
