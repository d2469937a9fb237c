"""Bodies that a flight passes and rules that it breaks, which its events tell: a dot and a name at each of them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import rerun as rr

from sailviz.recording.drawing import style
from sailviz.recording.drawing.landmarks import FLYBY, MARK, RING, VIOLATION, place_of
from sailviz.recording.drawing.log import Color, Picture, f4
from sailviz.recording.drawing.names import Names
from sailviz.recording.drawing.story import Story
from sailviz.recording.drawing.style import points

KINDS: tuple[tuple[str, str, Color, int], ...] = (  # how the event begins, where it is drawn, colour, rank of its name
    (VIOLATION, "/world/violations", style.FAULT, MARK),
    (FLYBY, "/world/flybys", style.FLYBY, RING),
)
HIGHER = (1.2, 1.8, 2.6, 3.4)  # of the rise at which other names stand over their marks
MOST_NAMES = 40  # of one kind: more would lie on each other anyway


def log_passages(picture: Picture, story: Story, eye: np.ndarray, names: Names) -> None:
    """Write /world/flybys and /world/violations with their names, seen from the direction `eye` (3,)."""
    rise = np.array([0.0, 0.0, style.RAISED * story.reach / max(np.sqrt(1 - eye[2] ** 2), 0.3)])
    for begin, path, color, rank in KINDS:
        events = [event for event in story.events if event.name.startswith(begin)]
        if not events:
            continue
        places = np.array([place_of(story, event) for event in events])
        picture.log_static(path, rr.Points3D(f4(places), radii=points(style.MARK_DOT), colors=[color]))
        for number in named(places, 0.05 * story.reach):
            words = events[number].name.removeprefix(FLYBY)
            higher = [places[number] + times * rise for times in HIGHER]  # where it starts or ends other words stand
            names.add(f"{path}/{number}", words, color, places[number] + 0.6 * rise, rank, higher)


def named(places: np.ndarray, apart: float) -> Sequence[int]:
    """Numbers of the places (n, 3) whose names find room: the first ones, so far apart from each other."""
    found: list[int] = []
    for number, place in enumerate(places):
        if all(np.linalg.norm(place - places[other]) > apart for other in found):
            found.append(number)
        if len(found) == MOST_NAMES:
            break
    return found
