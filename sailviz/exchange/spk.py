"""SPK kernels: the file in which SPICE, Cosmographia, GMAT, STK and Basilisk exchange trajectories.

Written are states on rows of any spacing, type 13 (Hermite through positions and velocities) or 9 (Lagrange, of each by
itself), one segment for each unbroken stretch; read are those two, and 5 and 8, whose rows stand there as well. Source:
NAIF, "SPK Required Reading" (types and arrays; read); tests hold what is written to CSPICE.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import sin
from pathlib import Path

import numpy as np

from sailviz.errors import RecordingError
from sailviz.exchange import daf
from sailviz.sky.places import tdb_ahead

FRAMES = {"J2000": 1, "ECLIPJ2000": 17}  # SPICE's J2000 has the axes of the ICRF
J2000_TT = np.datetime64("2000-01-01T12:00:00", "ns")
HERMITE, LAGRANGE = 13, 9
WINDOWS = {HERMITE: 8, LAGRANGE: 8}  # rows that one moment is interpolated in: degree 15 and degree 7
DIRECTORY = 100  # epochs between those that the directory repeats
CRAFT = -910001  # NAIF id of a craft of no agency
BODIES = {  # NAIF id -> the centres that flights here have
    10: "SUN", 1: "MERCURY", 2: "VENUS", 399: "EARTH", 301: "MOON", 4: "MARS", 5: "JUPITER", 6: "SATURN",
    7: "URANUS", 8: "NEPTUNE", 199: "MERCURY", 299: "VENUS", 499: "MARS", 599: "JUPITER", 699: "SATURN", 799: "URANUS",
    899: "NEPTUNE", 3: "EARTH MOON BARYCENTER", 0: "SSB",
}  # fmt: skip
LARGEST = 1e28  # m, m/s: beyond everything
WITH_ROWS = (5, 8, 9, 13)  # types whose arrays hold rows of states


@dataclass(frozen=True)
class Arc:
    """An unbroken stretch of flight. et (n,) s of TDB after J2000, increasing; position, velocity (n, 3) m, m/s."""

    et: np.ndarray
    position: np.ndarray
    velocity: np.ndarray


@dataclass(frozen=True)
class Segment(Arc):
    """An arc as a kernel has it. target, centre : NAIF ids; frame : NAIF's word, or its number where that has none
    here; kind : its type."""

    name: str
    target: int
    centre: int
    frame: str
    kind: int


def tdb_less_tt(tt: float) -> float:
    """s at a moment, s of TT after J2000: the formula, good to 30 us, and constants of NAIF's leap-second kernels, so
    that a date means the same moment here and in SPICE."""
    anomaly = 6.239996 + 1.99096871e-7 * tt
    return 1.657e-3 * sin(anomaly + 1.671e-2 * sin(anomaly))


def seconds_of_tdb(epoch: np.datetime64, time: np.ndarray) -> np.ndarray:
    """s of TDB after J2000 (n,) of seconds (n,) after an epoch, UTC: those of a run are of TDB."""
    tt = float((epoch - J2000_TT) / np.timedelta64(1, "ns")) * 1e-9 + tdb_ahead(epoch)
    start: float = tt + tdb_less_tt(tt)
    return start + np.asarray(time, float)


def write_spk(
    path: str | Path,
    arcs: Sequence[Arc],
    *,
    centre: int,
    frame: str = "J2000",
    target: int = CRAFT,
    name: str = "",
    kind: int = HERMITE,
    comments: Sequence[str] = (),
) -> Path:
    """Write a kernel. frame : of FRAMES; kind : 13 or 9; name : of every segment, 40 characters of it.
    RecordingError where an arc has no two rows or times that do not increase, where ids cannot be those of a craft and
    of a body, or where the file cannot be written."""
    if target >= 0:
        raise RecordingError(f"the NAIF id of a craft is negative, and {target} is not")
    if kind not in WINDOWS:
        raise RecordingError(f"an SPK is written with segments of type {HERMITE} or {LAGRANGE}, not {kind}")
    if frame not in FRAMES:
        raise RecordingError(f"an SPK is written in {' or '.join(FRAMES)}, not in {frame}")
    arrays = []
    for arc in arcs:
        if len(arc.et) < 2 or np.any(np.diff(arc.et) <= 0):
            raise RecordingError("an arc of an SPK has two rows or more, in order of time")
        if not all(np.isfinite(part).all() for part in (arc.et, arc.position, arc.velocity)):
            raise RecordingError("an SPK holds finite numbers only")
        numbers = (target, centre, FRAMES[frame], kind)
        arrays.append(daf.Array(name, (float(arc.et[0]), float(arc.et[-1])), numbers, _packed(arc, kind)))
    if not arrays:
        raise RecordingError("an SPK needs an arc of two rows or more")
    return daf.write(path, "SPK", arrays, name, comments)


def _packed(arc: Arc, kind: int) -> np.ndarray:
    """The array of a segment: states, epochs, directory, and how many rows make a polynomial."""
    states = np.hstack([arc.position, arc.velocity]) / 1e3
    window = min(WINDOWS[kind], len(arc.et))
    directory = arc.et[DIRECTORY - 1 : -1 : DIRECTORY]
    return np.concatenate([states.ravel(), arc.et, directory, [window - 1.0, float(len(arc.et))]])


def read_spk(path: str | Path) -> tuple[Segment, ...]:
    """The segments of a kernel whose arrays hold rows. RecordingError, in one sentence, for what is no SPK, is cut or
    damaged, or holds no such segment."""
    found = daf.read(path)
    if found.kind != "SPK":
        raise RecordingError(f"{path} is a {found.kind or 'nameless'} kernel, not an SPK")
    rows = [array for array in found.arrays if array.numbers[3] in WITH_ROWS]
    if not rows:
        kinds = ", ".join(map(str, sorted({array.numbers[3] for array in found.arrays}))) or "none"
        known = ", ".join(map(str, WITH_ROWS))
        raise RecordingError(f"{path} holds no segment of type {known}, whose rows are read here; it has: {kinds}")
    return tuple(_segment(array, path) for array in rows)


def _segment(array: daf.Array, path: str | Path) -> Segment:
    target, centre, frame, kind = array.numbers
    values = array.values
    count = int(values[-1]) if len(values) > 3 and 1 <= values[-1] <= len(values) / 6 else 0
    if kind == 8:  # equal steps: first epoch, step, degree, number of rows
        size, et = 6 * count + 4, values[-4] + values[-3] * np.arange(count)
    else:  # epochs of their own, a directory, and mu or the window
        size = 7 * count + (count // DIRECTORY if kind == 5 else (count - 1) // DIRECTORY) + 2
        et = values[6 * count : 7 * count]
    with np.errstate(over="ignore", invalid="ignore"):  # damage may have left any number
        states = values[: 6 * count].reshape(count, 6) * 1e3
    if not count or size != len(values) or not np.all(np.abs(states) < LARGEST) or not np.all(np.diff(et) > 0):
        raise RecordingError(f"{path} is damaged: its segment {array.name or kind!r} is not one of type {kind}")
    names = {number: word for word, number in FRAMES.items()}
    return Segment(et, states[:, :3], states[:, 3:], array.name, target, centre, names.get(frame, str(frame)), kind)
