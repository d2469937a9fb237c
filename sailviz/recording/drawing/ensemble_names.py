"""What stands beside many flights in space: the names of the calm one and of the widest ensemble."""

from __future__ import annotations

import numpy as np

from sailviz.recording.drawing import style
from sailviz.recording.drawing.landmarks import ENSEMBLE
from sailviz.recording.drawing.names import Names
from sailviz.recording.drawing.story import Story
from sailviz.run.arrays import EnsembleStatistics

AWAY, INSIDE = 0.05, 0.86  # of the reach, from where an ensemble has a name of its own, and where that stands
OUTSIDE = 0.10  # of the reach that the calm flight's name stands farther out


def add_ensemble_names(story: Story, names: Names) -> None:
    """Say which flight is the calm one, and which is the widest ensemble once it has left that."""
    ensembles = story.setting.ensembles
    calm = drawn(story, ensembles[0], ensembles[0].nominal)
    reach = float(np.linalg.norm(calm, axis=1).max())
    out = 1 + OUTSIDE * np.abs(calm).max() / np.maximum(np.linalg.norm(calm, axis=1), 1e-9)
    names.add("/world/nominal/name", "calm flight", style.NOMINAL, calm * out[:, None], ENSEMBLE)
    widest = max(ensembles, key=lambda ensemble: ensemble.end_deviation[0])
    mean = drawn(story, widest, widest.mean)
    away = np.linalg.norm(mean - drawn(story, widest, widest.nominal), axis=1) > AWAY * reach
    color = style.ensemble_color(style.ensemble_words(ensembles)[widest.name])
    place = np.where(away[:, None], INSIDE * mean, np.nan)
    names.add("/world/cloud_name", f"flights with {widest.name}", color, place, ENSEMBLE)


def drawn(story: Story, ensemble: EnsembleStatistics, states: np.ndarray) -> np.ndarray:
    """Where states (m, 6) of an ensemble's times are at the drawn rows, (n, 3) view units."""
    between = np.stack([np.interp(story.time, ensemble.time, states[:, k]) for k in range(3)], 1)
    return np.asarray(ensemble.places(between) / story.frame.unit)
