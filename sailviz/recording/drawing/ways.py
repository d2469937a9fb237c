"""The way from row to row where these lie so far apart that a chord or a cubic through them would miss it: Kepler's
motion from the row before and, what thrust has added until the next row, as a cubic on top (Hermite's).

Nothing of it is a row or a number: it is only drawn.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sailviz import two_body
from sailviz.elements import state
from sailviz.frames import rtn
from sailviz.recording.drawing.samples import SMOOTH, SPARSE, Frame, Samples
from sailviz.run.arrays import Run

COARSE = 2 / SMOOTH  # revolutions
MEETS = 0.5  # of the distance: what a cubic may still add to Kepler's motion
SCAN, LOOKS = 65, 3  # times at which the swept angle is looked up, and how often for an orbit that turns sharply
BENT = 1e-4  # of the distance: what is added is the thrust's
MOST = 4 * SMOOTH  # points between two rows


@dataclass(frozen=True)
class Ways:
    """lines : row k -> places (p, 3) from row k to row k + 1, view units, and shares (p,) of the time between.
    far : how many of them span more than SPARSE revolutions; bent : how many Kepler's motion alone would miss.
    open : rows from which it does not lead to the next row at all -> the next row's orbit of the moment, if closed.
    """

    lines: dict[int, tuple[np.ndarray, np.ndarray]]
    far: int
    bent: int
    open: dict[int, np.ndarray]


def ways_of(samples: Samples, frame: Frame, breaks: np.ndarray) -> Ways:
    """Of all stretches of more than SPARSE revolutions, or in which a piece of the cubic would be longer than COARSE;
    those without data left out."""
    run = samples.run
    if frame.sparse or len(run) < 2:
        return Ways({}, 0, 0, {})
    swept = revolutions(run, frame.mu)
    rows = np.setdiff1d(np.flatnonzero(swept > min(SPARSE, COARSE * frame.smooth)), breaks)
    if not len(rows):
        return Ways({}, 0, 0, {})
    step = run.time[rows + 1] - run.time[rows]
    reached, pace = two_body.advance(run.position[rows], run.velocity[rows], step, frame.mu)
    off, turned = run.position[rows + 1] - reached, run.velocity[rows + 1] - pace
    share = np.linalg.norm(off, axis=1) / np.linalg.norm(run.position[rows + 1], axis=1)
    meets = share < MEETS  # false for NaN
    lines = {}
    for row, h, d, w in zip(rows[meets].tolist(), step[meets], off[meets], turned[meets], strict=True):
        s = even_shares(run, row, float(h), float(swept[row]), frame.mu)
        places = fly(run, row, s * h, frame.mu)
        places += (3 * s**2 - 2 * s**3)[:, None] * d + (s**3 - s**2)[:, None] * h * w
        places[[0, -1]] = run.position[[row, row + 1]]
        lines[row] = places / frame.unit, s
    lost = zip(rows[~meets].tolist(), step[~meets].tolist(), strict=True)
    orbits = {row: arc(run, row + 1, run.position[row], h, frame) for row, h in lost}
    far = int(np.count_nonzero(swept[rows[meets]] > SPARSE))
    return Ways(lines, far, int(np.count_nonzero(share[meets] > BENT)), orbits)


def revolutions(run: Run, mu: float) -> np.ndarray:
    """(n - 1,) from row to row: by the faster of the two rows' pace, or by the mean one of their orbit."""
    r2 = np.sum(run.position**2, axis=1)
    rate = np.linalg.norm(np.cross(run.position, run.velocity), axis=1) / r2 / (2 * np.pi)
    a = run.elements.semi_major_axis
    with np.errstate(invalid="ignore", divide="ignore"):
        mean = np.where((a > 0) & np.isfinite(a), np.sqrt(mu / np.abs(a) ** 3), 0.0) / (2 * np.pi)
    rate = np.maximum(rate, mean)
    return np.asarray(np.maximum(rate[1:], rate[:-1]) * np.diff(run.time))


def fly(run: Run, row: int, times: np.ndarray, mu: float) -> np.ndarray:
    """Places (p, 3) m on the orbit of a row, times (p,) s after it."""
    count = len(times)
    places, _ = two_body.advance(
        np.tile(run.position[row], (count, 1)), np.tile(run.velocity[row], (count, 1)), times, mu
    )
    return places


def even_shares(run: Run, row: int, step: float, swept: float, mu: float) -> np.ndarray:
    """Shares of the time (p,), 0 to 1, at which the angle swept from the centre is nearly even."""
    s = np.linspace(0, 1, SCAN)
    for _ in range(LOOKS):
        out = fly(run, row, s * step, mu)
        out /= np.linalg.norm(out, axis=1, keepdims=True)
        angle = np.arctan2(np.linalg.norm(np.cross(out[1:], out[:-1]), axis=1), np.sum(out[1:] * out[:-1], axis=1))
        along = np.concatenate([[0.0], np.cumsum(angle)]) + 1e-3 * s  # a fall straight down sweeps nothing
        if angle.max() < COARSE * 2 * np.pi:
            break
        s = np.interp(np.linspace(0, along[-1], SCAN), along, s)  # closer where it turns fast
    count = int(np.clip(np.ceil(SMOOTH * along[-1] / (2 * np.pi)), 4, MOST)) + 1
    return np.asarray(np.interp(np.linspace(0, along[-1], count), along, s))


def arc(run: Run, row: int, start: np.ndarray, gap: float, frame: Frame) -> np.ndarray:
    """The way to a row on its osculating orbit: from the place nearest to `start` (3,) m, or once round where the gap
    of so many s is longer than that. (k, 3) view units; of an open orbit none.
    """
    e = run.elements
    a, eccentricity = float(e.semi_major_axis[row]), float(e.eccentricity[row])
    if not (eccentricity < 1 and a > 0):
        return np.zeros((0, 3))
    radial, ahead = rtn(run.position[row], run.velocity[row])[:, :2].T
    behind = np.mod(np.arctan2(-start @ ahead, start @ radial), 2 * np.pi)
    if gap > 2 * np.pi * np.sqrt(a**3 / frame.mu):
        behind = 2 * np.pi
    anomaly = e.true_anomaly[row] - behind * np.linspace(1, 0, int(np.ceil(SMOOTH * behind / (2 * np.pi))) + 1)
    line, _ = state(a, eccentricity, e.inclination[row], e.raan[row], e.argument[row], anomaly, frame.mu)
    return np.asarray(line / frame.unit)
