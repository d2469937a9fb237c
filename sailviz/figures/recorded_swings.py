"""What swings within a revolution, on paper: the mean of each stretch of time in a band from the least to the largest
value, as the plots of recordings have it, instead of a solid block."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sailviz.recording.drawing.curves import BAND_TURNS, MOST_BINS, ROWS_IN_BIN, SWING, Swing
from sailviz.run.arrays import Run


@dataclass(frozen=True)
class Bands:
    """Middles of even stretches of time s, and least, mean and largest value within, (m,) each. width s : of one."""

    time: np.ndarray
    low: np.ndarray
    mean: np.ndarray
    high: np.ndarray
    width: float


def revolutions(run: Run) -> float:
    """How often a run goes round, by the periods of its osculating orbits; open ones do not go round."""
    a = run.elements.semi_major_axis
    rate = np.sqrt(run.setting.body.mu / np.where(a > 0, a, np.inf) ** 3)
    steps = np.diff(run.time)
    return float(np.sum(0.5 * (rate[1:] + rate[:-1]) * steps) / (2 * np.pi))


def bands_of(run: Run, values: np.ndarray, turn: float = np.inf) -> Bands | None:
    """The bands of values (n,); None where a line tells them. turn : after which an angle is the same again, which has
    a mean only where it never begins anew."""
    turns = revolutions(run)
    bins = int(min(MOST_BINS, max(len(values) // ROWS_IN_BIN, 1), turns))
    known = np.isfinite(values)
    if turns <= BAND_TURNS or bins < 2 or not known.any():
        return None
    span = float(run.time[-1] - run.time[0])
    bin_of = np.clip((run.time - run.time[0]) / span * bins, 0, bins - 1).astype(int)
    swing = Swing.of(bins, 1)
    swing.add(bin_of, values[:, None])
    filled = np.flatnonzero(swing.count[:, 0] > 0)
    low, high = swing.low[filled, 0], swing.high[filled, 0]
    if not float(np.median(high - low)) > SWING * float(np.ptp(values[known])) > 0:
        return None
    mean = swing.total[filled, 0] / swing.count[filled, 0]
    if np.isfinite(turn) and np.nanmax(np.abs(np.diff(values)), initial=0.0) > turn / 2:
        mean = np.full(len(mean), np.nan)
    return Bands(run.time[0] + (filled + 0.5) / bins * span, low, mean, high, span / bins)
