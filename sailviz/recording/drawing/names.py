"""Names in space that do not lie on each other: of two that would meet on the screen of their view, the one that
matters less is left out while they do, or stands elsewhere if it has a choice.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from sailviz.recording.drawing.cameras import Camera, on_screen
from sailviz.recording.drawing.log import Color, Picture
from sailviz.recording.drawing.story import Story

Size = tuple[float, float]
MAIN: Size = (1005.0, 576.0)  # pixels of the main view in a window of 1600 x 900
MAIN_OVER_TABLE: Size = (1005.0, 546.0)  # where the words below it are a table
LETTER, ROOM, TALL, BELOW = 6.4, 14.0, 22.0, 3.0  # of a name: width of a letter, margins, height, gap below its point


@dataclass(frozen=True)
class Name:
    """Words, or those of each row, at places (n, 3), NaN where there are none; the lower its rank the more it matters.
    path : where it is written, "" where something else has written it and it is only in the way.
    choices : other places (3,) of one that stays, of which the one is taken that meets the fewest names."""

    path: str
    words: str | list[str]
    color: Color
    places: np.ndarray
    rank: int
    choices: tuple[np.ndarray, ...] = ()


class Names:
    """Gathers the names of a view of that size, and writes those that find room."""

    def __init__(self, story: Story, size: Size = MAIN):
        self._story, self._size = story, size
        self._names: list[Name] = []

    def add(
        self,
        path: str,
        words: str | list[str],
        color: Color,
        places: np.ndarray,
        rank: int,
        choices: Sequence[np.ndarray] = (),
    ) -> None:
        """places : (n, 3) of each drawn row, or (3,) of what stays."""
        count = len(self._story.time)
        spots = np.broadcast_to(np.asarray(places, float), (count, 3))
        self._names.append(Name(path, words, color, spots, rank, tuple(choices)))

    def write(self, picture: Picture, camera: Camera, turn: np.ndarray | None = None) -> None:
        """Write the names as a camera sees them whose frame has turned about z by `turn` (n,) rad."""
        turn = np.zeros(len(self._story.time)) if turn is None else turn
        taken: list[np.ndarray] = []
        for given in sorted(self._names, key=lambda name: name.rank):
            name = self._best(given, camera, turn, taken)
            box = boxes(name, camera, turn, self._size)
            for other in taken:
                box[meeting(box, other)] = np.nan
            shown = np.isfinite(box[:, 0])
            if np.any(shown):
                taken.append(box)
                self._write(picture, name, shown)

    def _best(self, name: Name, camera: Camera, turn: np.ndarray, taken: list[np.ndarray]) -> Name:
        """A name at the first of its places where it meets the fewest others."""
        if not name.choices:
            return name
        spots = [name.places, *(np.broadcast_to(place, name.places.shape) for place in name.choices)]
        stood = [replace(name, places=spot) for spot in spots]
        met = [sum(int(meeting(boxes(one, camera, turn, self._size), other).sum()) for other in taken) for one in stood]
        return stood[int(np.argmin(met))]

    def _write(self, picture: Picture, name: Name, shown: np.ndarray) -> None:
        """One name in the rows in which it is shown (n,): every row of what moves, only changes of what stays."""
        if not name.path:
            return
        texts = None if isinstance(name.words, str) else name.words
        still = texts is None and bool(np.all(name.places == name.places[0]))
        if still and np.all(shown):
            picture.log_label(name.path, str(name.words), name.color, name.places[0])
            return
        rows = np.flatnonzero(np.diff(shown, prepend=not shown[0])) if still else np.arange(len(shown))
        places = np.where(shown[:, None], name.places, np.nan)
        picture.log_label_style(name.path, name.color, None if texts else str(name.words))
        picture.log_labels(name.path, self._story.samples.index_of(rows), places[rows], texts)


def boxes(name: Name, camera: Camera, turn: np.ndarray, size: Size) -> np.ndarray:
    """Left, right, top and bottom (n, 4) of a name on the screen, pixels; NaN where it is not there."""
    wide, high = size
    c, s = np.cos(turn), np.sin(turn)
    x, y, z = name.places.T
    local = np.stack([c * x + s * y, c * y - s * x, z], 1)
    flat = on_screen(local, camera, wide / high) * [0.5 * wide, -0.5 * high]
    letters = len(name.words) if isinstance(name.words, str) else np.array([len(text) for text in name.words])
    half = 0.5 * (LETTER * letters + ROOM)
    top = flat[:, 1] + BELOW
    return np.stack([flat[:, 0] - half, flat[:, 0] + half, top, top + TALL], 1)


def meeting(one: np.ndarray, other: np.ndarray) -> np.ndarray:
    """In which rows two boxes (n, 4) lie on each other. (n,)"""
    with np.errstate(invalid="ignore"):
        across = (one[:, 0] < other[:, 1]) & (other[:, 0] < one[:, 1])
        return np.asarray(across & (one[:, 2] < other[:, 3]) & (other[:, 2] < one[:, 3]))
