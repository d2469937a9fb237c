"""The plane of arrival: the flights' distance from the nominal one in azimuth and distance from the Sun, each axis with
a scale of its own.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import rerun as rr
from numpy.typing import ArrayLike

from sailviz.constants import AU
from sailviz.recording.contract import word
from sailviz.recording.drawing import style
from sailviz.recording.drawing.log import Color, Index, Picture, f4
from sailviz.recording.drawing.style import points
from sailviz.run.arrays import EnsembleStatistics, Setting

RING = 33  # points of an ellipse
SIGMAS = (1.0, 2.0, 3.0)
BOX = 1.0, 0.5  # half width and half height of the plane of arrival, in which its axes are stretched to fit
NARROW = 1e-6  # rad: the least that a plane of arrival is wide
ROOM = 0.08  # of the range, round what must be seen in the plane of arrival
MILLI_AU = AU / 1000
WIDER = 2.5  # times the spread of the narrowest ensemble that the widest must have to give it a plane of its own


@dataclass(frozen=True)
class Arrival:
    """A plane of azimuth and distance, both from the nominal flight's, stretched to fit: the ranges, rad and m, that
    fill its width and height."""

    name: str
    path: str
    ahead: tuple[float, float]
    out: tuple[float, float]

    def place(self, azimuth: ArrayLike, distance: ArrayLike) -> np.ndarray:
        """(..., 2) in the plane of distances from the nominal flight, rad and m."""
        across = (np.asarray(azimuth) - self.ahead[0]) / (self.ahead[1] - self.ahead[0])
        up = (np.asarray(distance) - self.out[0]) / (self.out[1] - self.out[0])
        return np.stack(np.broadcast_arrays(BOX[0] * (2 * across - 1), BOX[1] * (1 - 2 * up)), -1)


def log_arrival_axes(picture: Picture, arrival: Arrival) -> None:
    """Axes through the nominal flight, with numbers and names."""
    path, reference = f"{arrival.path}/axes", [style.REFERENCE]
    origin = arrival.place(0.0, 0.0)
    lines = [arrival.place(np.array(arrival.ahead), 0.0), arrival.place(0.0, np.array(arrival.out))]
    places: list[Any] = []
    names: list[str] = []
    spread_out = arrival.ahead[1] - arrival.ahead[0] > 2 * NARROW  # flights that stand still have one azimuth
    for number in ticks(np.degrees(arrival.ahead)) if spread_out else ():
        at = arrival.place(np.radians(number), 0.0)
        lines.append(np.array([[0.0, -0.012], [0.0, 0.012]]) + at)
        places.append(np.array([0.0, 0.02]) + at)
        names.append(f"{number:+.4g}°")
    for number in ticks(np.array(arrival.out) / MILLI_AU):
        at = arrival.place(0.0, number * MILLI_AU)
        lines.append(np.array([[-0.012, 0.0], [0.012, 0.0]]) + at)
        places.append(np.array([-0.09, -0.03]) + at)
        names.append(f"{number:+.4g}")
    picture.log_static(path, rr.LineStrips2D([f4(line) for line in lines], colors=[style.AXES], radii=points(0.7)))
    top = arrival.place(0.0, arrival.out[1])
    words: list[Any] = [[max(top[0], 0.3 - BOX[0]), top[1] - 0.09], [BOX[0] - 0.22, origin[1] - 0.10]]
    written = (("numbers", places, names), ("names", words, ["farther out [10⁻³ au]", "ahead"]))
    for name, spots, texts in written:
        labels = rr.Points2D(f4(spots), radii=points(style.ANCHOR), colors=reference, labels=texts, show_labels=True)
        picture.log_static(f"{path}/{name}", labels)
    picture.log_static(f"{path}/nominal", rr.Points2D([f4(origin)], radii=points(3.0), colors=[style.NOMINAL]))


def log_arrival(picture: Picture, arrival: Arrival, ensemble: EnsembleStatistics, index: Index, color: Color) -> None:
    """The flights of one ensemble as dots, and the ellipses of one, two and three sigma about their mean."""
    path = f"{arrival.path}/{word(ensemble.name)}"

    def plane(states: np.ndarray) -> np.ndarray:
        """(..., n, 2) of states (..., n, 3+)."""
        off = states[..., :2] - ensemble.nominal[:, :2]
        return arrival.place(off[..., 1], off[..., 0])

    dots = plane(ensemble.kept).transpose(1, 0, 2)
    picture.log_static(
        f"{path}/flights", rr.Points2D.from_fields(radii=points(style.FLIGHT_DOT + 0.5), colors=[list(color)])
    )
    places = rr.Points2D.columns(positions=f4(dots.reshape(-1, 2))).partition([dots.shape[1]] * len(dots))
    picture.log_columns(f"{path}/flights", index, [*places])
    rings = [plane(ring.transpose(1, 0, 2)).transpose(1, 0, 2) for ring in ellipses(ensemble)]
    for k, (ring, shade) in enumerate(zip(rings, (1.0, 0.75, 0.5), strict=True)):
        picture.log_static(
            f"{path}/sigma{k + 1}", rr.LineStrips2D.from_fields(colors=[style.dim(color, shade)], radii=points(1.1))
        )
        picture.log_columns(f"{path}/sigma{k + 1}", index, rr.LineStrips2D.columns(strips=f4(ring)))


def ellipses(ensemble: EnsembleStatistics) -> list[np.ndarray]:
    """For each sigma the ring (n, RING, 3) of distance and azimuth about their mean, at the mean height: an ellipse in
    these coordinates, bent along the orbit in space."""
    block = ensemble.covariance[:, :2, :2]
    scale = np.sqrt(np.maximum(np.diagonal(block, axis1=1, axis2=2), 1e-300))
    size, axes = np.linalg.eigh(block / (scale[:, :, None] * scale[:, None, :]))
    turn = np.linspace(0, 2 * np.pi, RING)
    circle = np.stack([np.cos(turn), np.sin(turn)])  # (2, RING)
    off = np.einsum("nij,nj,jk->nki", axes, np.sqrt(np.maximum(size, 0.0)), circle) * scale[:, None, :]
    rings = []
    for sigma in SIGMAS:
        ring = np.repeat(ensemble.mean[:, None, :3], RING, axis=1)
        ring[..., :2] += sigma * off
        rings.append(ring)
    return rings


def arrivals_of(setting: Setting) -> tuple[Arrival, ...]:
    """A plane for all ensembles, and one for the narrowest where it would be lost in that."""
    ends = []  # of each ensemble: lowest and highest distance and azimuth within three sigma, whenever
    for ensemble in setting.ensembles:
        off = ensemble.mean[:, :2] - ensemble.nominal[:, :2]
        wide = 3.0 * np.sqrt(np.maximum(np.diagonal(ensemble.covariance, axis1=1, axis2=2)[:, :2], 0.0))
        ends.append([np.minimum((off - wide).min(axis=0), 0.0), np.maximum((off + wide).max(axis=0), 0.0)])
    reach = np.array(ends)  # (ensembles, 2, 2)
    least = np.array([1.0, NARROW])  # m, rad: ensembles may have no spread at all
    size = np.maximum(reach[:, 1] - reach[:, 0], least)
    narrow = int(np.argmin(size[:, 0]))

    def plane(name: str, path: str, low: np.ndarray, high: np.ndarray) -> Arrival:
        margin = ROOM * np.maximum(high - low, least) + 0.5 * least
        low, high = low - margin, high + margin
        out, ahead = ((float(low[k]), float(high[k])) for k in (0, 1))
        return Arrival(name, path, ahead, out)

    planes = [plane("Off nominal", "/arrival/all", reach[:, 0].min(axis=0), reach[:, 1].max(axis=0))]
    if np.all(size[narrow] > 2 * least) and size[:, 0].max() > WIDER * size[narrow, 0]:
        planes.append(plane(f"Near: {setting.ensembles[narrow].name}", "/arrival/near", *reach[narrow]))
    return tuple(planes)


def ticks(ends: np.ndarray) -> np.ndarray:
    """Round numbers between two ends, about four of them, 0 and the very ends left out."""
    low, high = ends
    rough = (high - low) / 4
    power = 10.0 ** np.floor(np.log10(rough))
    step = power * max(k for k in (1, 2, 5) if k * power <= rough)
    found = step * np.arange(np.ceil(low / step), np.floor(high / step) + 1)
    inside = (found > low + 0.05 * (high - low)) & (found < high - 0.05 * (high - low))
    shown: np.ndarray = found[inside & (np.abs(found) > 0.5 * step)]
    return shown
