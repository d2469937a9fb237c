"""The files of GTOC13, the 13th Global Trajectory Optimisation Competition: solutions, and the catalogue of its bodies.

A solution is text: lines that begin with # or ! and empty ones are passed over; every other line is a row of 12 numbers
parted by commas or blanks: body, flag, time s, position km, velocity km/s, control. Rows make arcs:

    body 0, flag 0    a conic, two rows
    body 0, flag 1    a sail arc, two rows or more; the control is the sail's normal, towards the star
    body > 0          a flyby, before and after; the control is v_inf km/s; flag 1 where it counts as science

The last flyby may have one row. The catalogue is the competition's own and not part of sailviz: its user names the
folder. Source: JPL, GTOC13 problem statement and file format 1.0 (2025).
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sailviz.errors import RecordingError

LONGEST_FILE = 200_000_000  # bytes; the longest known solution has 2 million
COLUMNS = 12
MOST_FAULTS = 5  # told one by one
FARTHEST, NEAREST = 1e13, 1e3  # km from the star: beyond 67,000 au; inside it
LATEST, FASTEST = 1e11, 299_792.458  # s: 3,000 years; km/s: light
CATALOGUES = ("gtoc13_planets.csv", "gtoc13_asteroids.csv", "gtoc13_comets.csv")

CONIC, SAIL, FLYBY = "conic", "sail", "flyby"


class Arc(NamedTuple):
    """Rows of one kind. first, last : indices of its rows, both inclusive; body : 0 in open space."""

    kind: str
    first: int
    last: int
    body: int = 0


class Solution(NamedTuple):
    """A solution as it is written. lines (n,) : where each row stands in the file; body, flag (n,) integers; time (n,)
    s; position (n, 3) km; velocity (n, 3) km/s; control (n, 3)."""

    name: str
    lines: NDArray[np.int64]
    body: NDArray[np.int64]
    flag: NDArray[np.int64]
    time: NDArray[np.float64]
    position: NDArray[np.float64]
    velocity: NDArray[np.float64]
    control: NDArray[np.float64]
    arcs: tuple[Arc, ...]


class CompetitionBody(NamedTuple):
    """A body of the catalogue. gm m3/s2 and radius m, 0 for small bodies; semi-major axis m; angles rad at t = 0."""

    number: int
    name: str
    gm: float
    radius: float
    semi_major_axis: float
    eccentricity: float
    inclination: float
    node: float
    argument: float
    mean_anomaly: float
    weight: float


def read_solution(path: str | Path) -> Solution:
    """A solution, its rows sorted into arcs.

    RecordingError, in one sentence with the lines, for what is no solution: rows that are not 12 finite numbers, arcs
    with too few rows, places inside the star or beyond any flight.
    """
    lines, values, faults = [], [], []
    for number, words in _rows(path):
        found, fault = _numbers(words)
        if fault:
            faults.append(f"line {number}: {fault}")
        else:
            lines.append(number)
            values.append(found)
    _refuse(path, faults)
    if not values:
        raise RecordingError(f"{path} holds no rows of 12 numbers: it is no GTOC13 solution")
    table = np.array(values)
    body, flag = table[:, 0].astype(np.int64), table[:, 1].astype(np.int64)
    arcs, faults = _arcs(body, flag, lines)
    _refuse(path, faults)
    return Solution(
        str(path), np.array(lines), body, flag, table[:, 2], table[:, 3:6], table[:, 6:9], table[:, 9:], tuple(arcs)
    )


def _refuse(path: str | Path, faults: list[str]) -> None:
    if faults:
        more = len(faults) - MOST_FAULTS
        told = "; ".join(faults[:MOST_FAULTS]) + (f"; and {more} lines more" if more > 0 else "")
        raise RecordingError(f"{path} is no GTOC13 solution: {told}")


def _text(path: str | Path, encoding: str = "utf-8-sig") -> str:
    if Path(path).exists() and not Path(path).is_file():  # a pipe or a device may never end
        raise RecordingError(f"cannot read {path}: it is not a regular file")
    try:
        if Path(path).stat().st_size > LONGEST_FILE:
            raise RecordingError(f"{path} is too large for a file of GTOC13")
        return Path(path).read_text(encoding=encoding)
    except UnicodeDecodeError:
        raise RecordingError(f"{path} is no file of GTOC13: it is not text") from None
    except (OSError, ValueError) as error:
        why = getattr(error, "strerror", None) or str(error)
        raise RecordingError(f"cannot read {path}: {why.lower()}") from None


def _rows(path: str | Path) -> Iterator[tuple[int, list[str]]]:
    """(line number, words) of the lines that are rows."""
    for number, line in enumerate(_text(path).splitlines(), 1):
        text = line.strip()
        if text and text[0] not in "#!":
            yield number, re.split(r"\s*,\s*|\s+", text)


def _number(word: str) -> float:
    """A finite number, NaN for anything else."""
    try:
        value = float(word) if "_" not in word else math.nan  # Python would read 1_0 as 10
    except ValueError:
        return math.nan
    return value if math.isfinite(value) else math.nan


def _numbers(words: list[str]) -> tuple[list[float], str]:
    """The numbers of a row, and what is wrong with them, "" for nothing."""
    if len(words) != COLUMNS:
        return [], f"{len(words)} numbers where {COLUMNS} are due"
    found = [_number(word) for word in words]
    for word, value in zip(words, found, strict=True):
        if value != value:
            return [], f"{word[:40]!r} is no finite number"
    if not (found[0].is_integer() and 0 <= found[0] < 1e6):
        return [], f"the body {words[0][:40]} is no number of the catalogue"
    if found[1] not in (0.0, 1.0):
        return [], f"the flag is {words[1][:40]}, and 0 or 1 is due"
    r, v = math.hypot(*found[3:6]), math.hypot(*found[6:9])
    if not NEAREST <= r <= FARTHEST:
        return [], f"a place {r:.3g} km from the star, between {NEAREST:g} and {FARTHEST:g} km being possible"
    if v > FASTEST or abs(found[2]) > LATEST:
        return [], f"a speed of {v:.3g} km/s at {found[2]:.3g} s is in other units than km/s and s"
    if max(map(abs, found[9:])) > FASTEST:
        return [], f"the control {max(map(abs, found[9:])):.3g} is neither a normal nor a speed in km/s"
    return found, ""


def _arcs(body: NDArray[np.int64], flag: NDArray[np.int64], lines: list[int]) -> tuple[list[Arc], list[str]]:
    """Arcs in the order of the rows, and what is wrong with them."""
    arcs: list[Arc] = []
    faults: list[str] = []
    n, row = len(body), 0
    while row < n:
        last = row
        if body[row] == 0 and flag[row] == 1:
            while last + 1 < n and body[last + 1] == 0 and flag[last + 1] == 1:
                last += 1
            if last == row:
                faults.append(f"line {lines[row]}: a sail arc of one row, and two or more are due")
            arcs.append(Arc(SAIL, row, last))
        elif row + 1 < n and body[row + 1] == body[row] and flag[row + 1] == flag[row]:
            last = row + 1
            arcs.append(Arc(FLYBY if body[row] else CONIC, row, last, int(body[row])))
        elif body[row] and row == n - 1:
            arcs.append(Arc(FLYBY, row, row, int(body[row])))
        else:
            what = f"the flyby of body {body[row]}" if body[row] else "a conic"
            faults.append(f"line {lines[row]}: {what} has one row, and two alike in body and flag are due")
        row = last + 1
    return arcs, faults


def read_catalogue(folder: str | Path) -> dict[int, CompetitionBody]:
    """Bodies by their numbers, from the competition's files in a folder, of which one may be there or all:
    gtoc13_planets.csv (number, name, GM km3/s2, radius km, a km, e, i, node, argument, mean anomaly at t = 0 in deg,
    weight), gtoc13_asteroids.csv and gtoc13_comets.csv (the same without name, GM and radius).

    RecordingError, in one sentence, for a folder without any of them, and for lines that are no bodies.
    """
    place = Path(folder)
    files = [place / name for name in CATALOGUES if (place / name).exists()]
    if not files:
        raise RecordingError(f"{folder} is no catalogue of GTOC13: a folder with {', '.join(CATALOGUES)} is due")
    found: dict[int, CompetitionBody] = {}
    for file in files:
        named = file.name == CATALOGUES[0]
        for number, words in _catalogue_lines(file):
            try:
                body = _body(words, named)
            except ValueError as error:
                raise RecordingError(f"{file}, line {number}: {error}") from None
            if body.number in found:
                raise RecordingError(f"{file}, line {number}: body {body.number} is there twice")
            found[body.number] = body
    return found


def _catalogue_lines(file: Path) -> Iterator[tuple[int, list[str]]]:
    for number, line in enumerate(_text(file, "cp1252").splitlines(), 1):
        text = line.removeprefix("ï»¿").strip()  # a byte order mark, in this encoding
        if text and text[0] not in "#!":
            yield number, [word.strip() for word in text.split(",")]


def _body(words: list[str], named: bool) -> CompetitionBody:
    due = 11 if named else 8
    if len(words) != due:
        raise ValueError(f"{len(words)} columns where {due} are due")
    name = words[1] if named else ""
    number, *numbers = _all_numbers([words[0], *(words[2:] if named else words[1:])])
    gm, radius = (numbers[0], numbers[1]) if named else (0.0, 0.0)
    a, e, inclination, node, argument, anomaly, weight = numbers[2:] if named else numbers
    if not (number.is_integer() and number > 0):
        raise ValueError(f"{words[0]} is no number of a body")
    if not (a > 0.0 and 0.0 <= e < 1.0):
        raise ValueError(f"a semi-major axis of {a:g} km with eccentricity {e:g} is no ellipse")
    if gm < 0.0 or radius < 0.0:
        raise ValueError("GM and radius cannot be negative")
    inclination, node, argument, anomaly = (math.radians(angle) for angle in (inclination, node, argument, anomaly))
    return CompetitionBody(
        int(number), name, gm * 1e9, radius * 1e3, a * 1e3, e, inclination, node, argument, anomaly, weight
    )


def _all_numbers(words: Iterable[str]) -> list[float]:
    found = []
    for word in words:
        value = _number(word)
        if value != value:
            raise ValueError(f"{word[:40]!r} is no finite number")
        found.append(value)
    return found
