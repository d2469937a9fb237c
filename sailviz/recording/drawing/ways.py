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
from sailviz.run.filling import bent, even_shares, revolutions

COARSE = 2 / SMOOTH  # revolutions
MEETS = 0.5  # of the distance: what a cubic may still add to Kepler's motion
BENT = 1e-4  # of the distance: what is added is the thrust's


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


def ways_of(samples: Samples, frame: Frame, breaks: np.ndarray, fine: bool = False) -> Ways:
    """Of all stretches of more than SPARSE revolutions, or in which a piece of the cubic would be longer than COARSE,
    or fine : half of that; those without data left out."""
    run = samples.run
    if frame.sparse or len(run) < 2:
        return Ways({}, 0, 0, {})
    swept = revolutions(run, frame.mu)
    rows = np.setdiff1d(np.flatnonzero(swept > min(SPARSE, COARSE * (0.5 if fine else frame.smooth))), breaks)
    if not len(rows):
        return Ways({}, 0, 0, {})
    step = run.time[rows + 1] - run.time[rows]
    reached, pace = two_body.advance(run.position[rows], run.velocity[rows], step, frame.mu)
    off, turned = run.position[rows + 1] - reached, run.velocity[rows + 1] - pace
    share = np.linalg.norm(off, axis=1) / np.linalg.norm(run.position[rows + 1], axis=1)
    meets = share < MEETS  # false for NaN
    lines = {}
    for row, h, d, w in zip(rows[meets].tolist(), step[meets], off[meets], turned[meets], strict=True):
        s = even_shares(run, row, float(h), frame.mu)
        places, _ = bent(run, row, s, d, w, frame.mu)
        places[[0, -1]] = run.position[[row, row + 1]]
        lines[row] = places / frame.unit, s
    lost = zip(rows[~meets].tolist(), step[~meets].tolist(), strict=True)
    orbits = {row: arc(run, row + 1, run.position[row], h, frame) for row, h in lost}
    far = int(np.count_nonzero(swept[rows[meets]] > SPARSE))
    return Ways(lines, far, int(np.count_nonzero(share[meets] > BENT)), orbits)


def arc(run: Run, row: int, start: np.ndarray, gap: float, frame: Frame) -> np.ndarray:
    """The way to a row on its osculating orbit: from the place nearest to `start` (3,) m, or once round where the gap
    of so many s is longer than that. (k, 3) view units; of an open orbit none.
    """
    e = run.elements
    a, eccentricity = float(e.semi_major_axis[row]), float(e.eccentricity[row])
    if not (eccentricity < 1 and 0 < a < np.inf):
        return np.zeros((0, 3))
    radial, ahead = rtn(run.position[row], run.velocity[row])[:, :2].T
    behind = np.mod(np.arctan2(-start @ ahead, start @ radial), 2 * np.pi)
    if gap > 2 * np.pi * np.sqrt(a**3 / frame.mu):
        behind = 2 * np.pi
    anomaly = e.true_anomaly[row] - behind * np.linspace(1, 0, int(np.ceil(SMOOTH * behind / (2 * np.pi))) + 1)
    line, _ = state(a, eccentricity, e.inclination[row], e.raan[row], e.argument[row], anomaly, frame.mu)
    return np.asarray(line / frame.unit)
