"""Names in space that do not lie on each other: of two that would meet on the screen of their view, the one that
matters less is left out while they do, or stands elsewhere if it has a choice.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from sailviz.recording import timelines
from sailviz.recording.drawing.cameras import Camera, on_screen
from sailviz.recording.drawing.log import Color, Picture
from sailviz.recording.drawing.story import Story

Size = tuple[float, float]
MAIN: Size = (1005.0, 576.0)  # pixels of the main view in a window of 1600 x 900
MAIN_OVER_TABLE: Size = (1005.0, 546.0)  # where the words below it are a table
LETTER, ROOM, TALL, BELOW = 6.4, 14.0, 22.0, 3.0  # of a name: width of a letter, margins, height, gap below its point
LATE = 300  # times after the end of a flight at which its names are looked at, where others go on


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
    story: Story  # in whose rows
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
        story: Story | None = None,
    ) -> None:
        """places : (n, 3) of each drawn row, or (3,) of what stays. story : whose rows, if of another flight."""
        story = story or self._story
        every = np.broadcast_to(np.asarray(places, float), (len(story.time), 3))
        self._names.append(Name(path, words, color, every, rank, story, tuple(choices)))

    def write(self, picture: Picture, camera: Camera, turn: np.ndarray | None = None) -> None:
        """Write the names as a camera sees them whose frame has turned about z by `turn` (n,) rad."""
        turn = np.zeros(len(self._story.time)) if turn is None else turn
        taken: list[tuple[np.ndarray, np.ndarray]] = []
        for given in sorted(self._names, key=lambda name: name.rank):
            late = self._later(given.story)
            time = np.concatenate([given.story.time, late])
            own_turn = turn if len(time) == len(turn) else np.interp(time, self._story.time, turn)
            name, places, box = self._best(given, camera, own_turn, time, taken)
            for times, other in taken:
                box[meeting(box, seen_at(time, times, other))] = np.nan
            shown = np.isfinite(box[:, 0])
            if np.any(shown):
                taken.append((time, box))
                self._write(picture, name, np.where(shown[:, None], places, np.nan), late)

    def _best(
        self,
        name: Name,
        camera: Camera,
        turn: np.ndarray,
        time: np.ndarray,
        taken: list[tuple[np.ndarray, np.ndarray]],
    ) -> tuple[Name, np.ndarray, np.ndarray]:
        """A name at the first of its places where it meets the fewest others and the edge of the view, its places
        (m, 3) and boxes (m, 4) at times (m,) s."""
        best, least = None, np.inf
        for spot in (name.places, *name.choices):
            stood = replace(name, places=np.broadcast_to(spot, name.places.shape))
            later = len(time) - len(stood.places)
            places = np.concatenate([stood.places, np.repeat(stood.places[-1:], later, axis=0)])
            box = boxes(name.words, places, camera, turn, self._size)
            met = sum(int(meeting(box, seen_at(time, times, other)).sum()) for times, other in taken)
            met += int(np.sum(np.isfinite(places[:, 0]) & np.isnan(box[:, 0])))  # cut by the edge of the view
            if met < least:
                best, least = (stood, places, box), met
        assert best is not None  # there is one place at least
        return best

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
        if not name.path:
            return
        shown = np.isfinite(places[:, 0])
        count = len(name.story.time)
        texts = None if isinstance(name.words, str) else name.words
        still = texts is None and bool(np.all(name.places == name.places[0]))
        if still and np.all(shown):
            picture.log_label(name.path, str(name.words), name.color, name.places[0])
            return
        changed = np.flatnonzero(np.diff(shown, prepend=not shown[0]))
        rows = changed[changed < count] if still else np.arange(count)
        picture.log_label_style(name.path, name.color, None if texts else str(name.words))
        picture.log_labels(name.path, name.story.samples.index_of(rows), places[rows], texts)
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


def boxes(
    words: str | list[str], places: np.ndarray, camera: Camera, turn: np.ndarray, size: Size = MAIN
) -> np.ndarray:
    """Left, right, top and bottom (n, 4) of words, or of those of each row, at places (n, 3) on the screen, pixels; NaN
    where they are not."""
    across, high = size
    c, s = np.cos(turn), np.sin(turn)
    x, y, z = places.T
    local = np.stack([c * x + s * y, c * y - s * x, z], 1)
    flat = on_screen(local, camera, across / high) * [0.5 * across, -0.5 * high]
    half = 0.5 * (wide(words) if isinstance(words, str) else lengths(words, len(places)))
    top = flat[:, 1] + BELOW
    box = np.stack([flat[:, 0] - half, flat[:, 0] + half, top, top + TALL], 1)
    box[cut(box, size)] = np.nan
    return box


def cut(box: np.ndarray, size: Size) -> np.ndarray:
    """Which of boxes (n, 4) lie across the left or the right edge of their view, where words would be cut. (n,)"""
    edge = 0.5 * size[0]
    with np.errstate(invalid="ignore"):
        left = (box[:, 0] < -edge) & (box[:, 1] > -edge)
        return np.asarray(left | ((box[:, 0] < edge) & (box[:, 1] > edge)))


def lengths(words: list[str], count: int) -> np.ndarray:
    """(count,) how wide the words of each row are, pixels; those of the last row hold on."""
    own = np.array([wide(text) for text in words])
    return np.concatenate([own, np.repeat(own[-1:], count - len(own))])


def wide(words: str) -> float:
    """How wide words are on the screen, pixels."""
    return LETTER * len(words) + ROOM


def meeting(one: np.ndarray, other: np.ndarray) -> np.ndarray:
    """In which rows two boxes (n, 4) lie on each other. (n,)"""
    with np.errstate(invalid="ignore"):
        across = (one[:, 0] < other[:, 1]) & (other[:, 0] < one[:, 1])
        return np.asarray(across & (one[:, 2] < other[:, 3]) & (other[:, 2] < one[:, 3]))
