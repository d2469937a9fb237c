"""About which body a table's rows are: the one that is said, the one that its header names, or the only one whose
gravity the rows follow."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from sailviz.calendar import DateError
from sailviz.errors import RecordingError
from sailviz.recording.flights.columns import Columns
from sailviz.run import dates, unit_guard
from sailviz.sky.bodies import BODIES, SkyBody
from sailviz.words import nearest, shown

MEASURED = ("sun", "mercury", "venus", "earth", "moon", "mars", "jupiter", "saturn", "uranus", "neptune")
STAR_FAR = 1e10  # m, from which a flight that follows no body's gravity has the units of one round the Sun


def body_of(word: str) -> SkyBody:
    """The body of a word or a name, in whatever case. RecordingError, with the nearest, for none."""
    found = next((one for key, one in BODIES.items() if word.strip().lower() in (key, one.name.lower())), None)
    if found is None:
        raise RecordingError(f"{shown(word)} is no body whose gravity is known here. {nearest(word, BODIES)}")
    return found


def check_named(said: str, own: str, path: str | Path) -> None:
    """Whether what is said is what a file says of itself. RecordingError where it is not."""
    if said and body_of(said) != body_of(own):
        raise RecordingError(f"{path} says itself that it is about {own}: leave the body out")


def centre_of(given: Columns, path: str | Path, said: str = "") -> SkyBody:
    """The body about which a table's rows are. said : its word, "" for none. RecordingError, in a sentence, where it
    is neither said nor told by the header, and the rows follow no one body's gravity."""
    if given.centre:
        check_named(said, given.centre, path)
    word = said or given.centre
    rows = _rows(given, path)
    if word:
        return body_of(word)
    far = float(np.median(np.linalg.norm(rows[1], axis=1))) > STAR_FAR
    likely = BODIES["sun" if far else "earth"]
    if np.any(np.diff(rows[0]) < 0):
        return likely  # the rows are refused for that
    misses = sorted((unit_guard.miss(*rows, BODIES[key].mu), key) for key in MEASURED)
    (best, key), (second, _) = misses[:2]
    if best < unit_guard.RIGHT and unit_guard.CLEARER * best < second:
        return BODIES[key]
    wrong = unit_guard.fault(*rows, likely.mu)[0]
    if wrong:
        raise RecordingError(f"{path}: {wrong}")
    raise RecordingError(
        f"{path} does not say about which body it is, and its rows follow no one body's gravity alone: "
        f"say it, by --body, one of {', '.join(BODIES)}"
    )


def _rows(given: Columns, path: str | Path) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Times s, places m and velocities m/s of the rows that hold numbers."""
    usable = np.isfinite(given.position).all(axis=1) & np.isfinite(given.velocity).all(axis=1)
    try:
        time, _ = dates.seconds_of(given.time, None)
    except DateError as error:
        raise RecordingError(f"{path}: time {error}") from None
    if np.count_nonzero(usable) < 2:
        raise RecordingError(f"{path} has fewer than two rows of numbers")
    return time[usable], given.position[usable], given.velocity[usable]
