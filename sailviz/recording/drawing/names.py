"""Names in space that do not lie on each other: of two that would meet on the screen of the main view, the one that
matters less is left out while they do.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sailviz.recording import timelines
from sailviz.recording.drawing.cameras import Camera, on_screen
from sailviz.recording.drawing.log import Color, Picture
from sailviz.recording.drawing.story import Story

WIDE, HIGH = 1005.0, 576.0  # pixels of the main view in a window of 1600 x 900
LETTER, ROOM, TALL, BELOW = 6.4, 14.0, 22.0, 3.0  # of a name: width of a letter, margins, height, gap below its point
LATE = 300  # times after the end of a flight at which its names are looked at, where others go on


@dataclass(frozen=True)
class Name:
    """Words at places (n, 3), NaN where there are none; the lower its rank the more it matters."""

    path: str
    words: str
    color: Color
    places: np.ndarray
    rank: int
    story: Story  # in whose rows


class Names:
    """Gathers the names of a view, and writes those that find room."""

    def __init__(self, story: Story):
        self._story = story
        self._names: list[Name] = []

    def add(
        self, path: str, words: str, color: Color, places: np.ndarray, rank: int, story: Story | None = None
    ) -> None:
        """places : (n, 3) of each drawn row, or (3,) of what stays. story : whose rows, if of another flight."""
        story = story or self._story
        every = np.broadcast_to(np.asarray(places, float), (len(story.time), 3))
        self._names.append(Name(path, words, color, every, rank, story))

    def write(self, picture: Picture, camera: Camera, turn: np.ndarray) -> None:
        """Write the names as a camera sees them whose frame has turned about z by `turn` (n,) rad."""
        taken: list[tuple[np.ndarray, np.ndarray]] = []
        for name in sorted(self._names, key=lambda name: name.rank):
            late = self._later(name.story)
            time = np.concatenate([name.story.time, late])
            places = np.concatenate([name.places, np.repeat(name.places[-1:], len(late), axis=0)])
            own_turn = turn if len(time) == len(turn) else np.interp(time, self._story.time, turn)
            box = boxes(name.words, places, camera, own_turn)
            for times, other in taken:
                box[meeting(box, seen_at(time, times, other))] = np.nan
            shown = np.isfinite(box[:, 0])
            if np.any(shown):
                taken.append((time, box))
                self._write(picture, name, np.where(shown[:, None], places, np.nan), late)

    def _later(self, story: Story) -> np.ndarray:
        """s, times at which other flights go on when one has ended: names of these may move on to its own."""
        times = [name.story.time for name in self._names if name.story.time[-1] > story.time[-1]]
        if not times:
            return np.zeros(0)
        late = np.unique(np.concatenate(times))
        late = late[late > story.time[-1]]
        return np.asarray(late[:: -(-len(late) // LATE)])

    def _write(self, picture: Picture, name: Name, places: np.ndarray, late: np.ndarray) -> None:
        """One name at its places (n + m, 3), NaN where it is left out: every row of what moves, only changes of what
        stays, as everything does at the m times when its flight has ended. These stand between rows, without a step."""
        shown = np.isfinite(places[:, 0])
        count = len(name.story.time)
        still = bool(np.all(name.places == name.places[0]))
        if still and np.all(shown):
            picture.log_label(name.path, name.words, name.color, name.places[0])
            return
        changed = np.flatnonzero(np.diff(shown, prepend=not shown[0]))
        rows = changed[changed < count] if still else np.arange(count)
        picture.log_label_style(name.path, name.color, name.words)
        picture.log_labels(name.path, name.story.samples.index_of(rows), places[rows])
        after = changed[changed >= count]
        if len(after):
            index = timelines.between_rows(name.story.setting, late[after - count])
            picture.log_labels(name.path, index, places[after])


def seen_at(times: np.ndarray, own: np.ndarray, box: np.ndarray) -> np.ndarray:
    """Boxes (n, 4) of times (n,) as they are seen at other times (m,): those of the last row before, as in a viewer;
    NaN before the first."""
    if times is own:
        return box
    row = np.searchsorted(own, times, side="right") - 1
    return np.where((row >= 0)[:, None], box[np.maximum(row, 0)], np.nan)


def boxes(words: str, places: np.ndarray, camera: Camera, turn: np.ndarray) -> np.ndarray:
    """Left, right, top and bottom (n, 4) of words at places (n, 3) on the screen, pixels; NaN where they are not."""
    c, s = np.cos(turn), np.sin(turn)
    x, y, z = places.T
    local = np.stack([c * x + s * y, c * y - s * x, z], 1)
    flat = on_screen(local, camera, WIDE / HIGH) * [0.5 * WIDE, -0.5 * HIGH]
    half = 0.5 * wide(words)
    top = flat[:, 1] + BELOW
    return np.stack([flat[:, 0] - half, flat[:, 0] + half, top, top + TALL], 1)


def wide(words: str) -> float:
    """How wide words are on the screen, pixels."""
    return LETTER * len(words) + ROOM


def meeting(one: np.ndarray, other: np.ndarray) -> np.ndarray:
    """In which rows two boxes (n, 4) lie on each other. (n,)"""
    with np.errstate(invalid="ignore"):
        across = (one[:, 0] < other[:, 1]) & (other[:, 0] < one[:, 1])
        return np.asarray(across & (one[:, 2] < other[:, 3]) & (other[:, 2] < one[:, 3]))
