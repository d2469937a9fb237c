"""Names in space that do not lie on each other: of two that would meet on the screen of the main view, the one that
matters less is left out while they do.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sailviz.recording.drawing.cameras import Camera, on_screen
from sailviz.recording.drawing.log import Color, Picture
from sailviz.recording.drawing.story import Story

WIDE, HIGH = 1005.0, 576.0  # pixels of the main view in a window of 1600 x 900
LETTER, ROOM, TALL, BELOW = 6.4, 14.0, 22.0, 3.0  # of a name: width of a letter, margins, height, gap below its point


@dataclass(frozen=True)
class Name:
    """Words at places (n, 3), NaN where there are none; the lower its rank the more it matters."""

    path: str
    words: str
    color: Color
    places: np.ndarray
    rank: int


class Names:
    """Gathers the names of a view, and writes those that find room."""

    def __init__(self, story: Story):
        self._story = story
        self._names: list[Name] = []

    def add(self, path: str, words: str, color: Color, places: np.ndarray, rank: int) -> None:
        """places : (n, 3) of each drawn row, or (3,) of what stays."""
        count = len(self._story.time)
        self._names.append(Name(path, words, color, np.broadcast_to(np.asarray(places, float), (count, 3)), rank))

    def write(self, picture: Picture, camera: Camera, turn: np.ndarray) -> None:
        """Write the names as a camera sees them whose frame has turned about z by `turn` (n,) rad."""
        taken: list[np.ndarray] = []
        for name in sorted(self._names, key=lambda name: name.rank):
            box = boxes(name, camera, turn)
            for other in taken:
                box[meeting(box, other)] = np.nan
            shown = np.isfinite(box[:, 0])
            if np.any(shown):
                taken.append(box)
                self._write(picture, name, shown)

    def _write(self, picture: Picture, name: Name, shown: np.ndarray) -> None:
        """One name in the rows in which it is shown (n,): every row of what moves, only changes of what stays."""
        still = bool(np.all(name.places == name.places[0]))
        if still and np.all(shown):
            picture.log_label(name.path, name.words, name.color, name.places[0])
            return
        rows = np.flatnonzero(np.diff(shown, prepend=not shown[0])) if still else np.arange(len(shown))
        places = np.where(shown[:, None], name.places, np.nan)
        picture.log_label_style(name.path, name.color, name.words)
        picture.log_labels(name.path, self._story.samples.index_of(rows), places[rows])


def boxes(name: Name, camera: Camera, turn: np.ndarray) -> np.ndarray:
    """Left, right, top and bottom (n, 4) of a name on the screen, pixels; NaN where it is not there."""
    c, s = np.cos(turn), np.sin(turn)
    x, y, z = name.places.T
    local = np.stack([c * x + s * y, c * y - s * x, z], 1)
    flat = on_screen(local, camera, WIDE / HIGH) * [0.5 * WIDE, -0.5 * HIGH]
    half = 0.5 * (LETTER * len(name.words) + ROOM)
    top = flat[:, 1] + BELOW
    return np.stack([flat[:, 0] - half, flat[:, 0] + half, top, top + TALL], 1)


def meeting(one: np.ndarray, other: np.ndarray) -> np.ndarray:
    """In which rows two boxes (n, 4) lie on each other. (n,)"""
    with np.errstate(invalid="ignore"):
        across = (one[:, 0] < other[:, 1]) & (other[:, 0] < one[:, 1])
        return np.asarray(across & (one[:, 2] < other[:, 3]) & (other[:, 2] < one[:, 3]))
