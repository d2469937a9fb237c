"""Orbit ephemeris messages (CCSDS 502.0-B, as keywords or XML): the file in which missions exchange trajectories.

Read here because the maintained reader, `oem`, holds one astropy object per row and rounds epochs to microseconds,
which is centimetres on the way round the Sun; the tests let it judge. Writing is oem_writer.py's business.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field, replace
from itertools import pairwise
from pathlib import Path

import numpy as np

from sailviz import frames, ndm
from sailviz.calendar import DateError, tai
from sailviz.errors import RecordingError
from sailviz.run import dates
from sailviz.sky.places import Sky

ECLIPTIC = "ECLIPJ2000"
EQUATOR = "EME2000"
OF_DATE = "MOD"  # mean equator and equinox of date, in which sailviz keeps what circles the Earth
SAME_AXES = {"J2000": EQUATOR, "ICRF": "ICRF", "GCRF": "GCRF", "ICRF1": "ICRF", "ICRF2": "ICRF", "ICRF3": "ICRF"}
NEARLY_INERTIAL = (EQUATOR, "ICRF", "GCRF")  # 0.02 arcsec from each other
NEARLY_OF_DATE = (OF_DATE, "TOD", "TEME")  # up to 19 arcsec of nutation from each other
REQUIRED = ("OBJECT_NAME", "CENTER_NAME", "REF_FRAME", "TIME_SYSTEM")
SAME_PLACE = 1e-6  # of the distance: two rows at one epoch closer than this are one place
SAME_FLIGHT = 1e-2  # of the distance: overlapping blocks farther apart than this are two flights
LARGEST = 1e25  # km, km/s: beyond everything
LONG_GAP = 2.0  # row steps between two blocks, from where on rows are missing


@dataclass(frozen=True)
class Ephemeris:
    """A trajectory as an OEM holds it, in SI.

    time (n,) s since `epoch`, physical seconds, leap seconds counted; position (n, 3) m; velocity (n, 3) m/s. epoch :
    of the first row, in time_system. gaps : (last row before, seconds without data) between blocks. notes : sentences
    about what was passed over, joined or missing.
    """

    name: str
    identity: str
    center: str  # "SUN", "EARTH", ...
    frame: str  # "EME2000", "ICRF", ...
    time_system: str
    epoch: np.datetime64
    time: np.ndarray
    position: np.ndarray
    velocity: np.ndarray
    gaps: tuple[tuple[int, float], ...] = ()
    notes: tuple[str, ...] = ()

    @property
    def without_data(self) -> tuple[tuple[float, float], ...]:
        """The gaps as (start, end) pairs in s, as `trajectory` takes them."""
        return tuple((float(self.time[row]), float(self.time[row + 1])) for row, _ in self.gaps)

    @property
    def utc(self) -> np.datetime64:
        """The epoch in UTC. RecordingError for a time system that has no known distance from UTC, and before 1972."""
        try:
            return dates.utc_of(dates.instant_of(self.epoch, self.time_system))
        except DateError as error:
            raise RecordingError(str(error)) from None

    def in_ecliptic(self) -> Ephemeris:
        """The same trajectory in the ecliptic of J2000, where sailviz keeps what circles the Sun.

        ICRF and GCRF count as EME2000, 0.02 arcsec away. RecordingError for other frames.
        """
        if self.frame == ECLIPTIC:
            return self
        if self.frame not in NEARLY_INERTIAL:
            known = ", ".join(("J2000", *NEARLY_INERTIAL, ECLIPTIC))
            raise RecordingError(
                f"how the frame {self.frame} lies in the ecliptic is not known here; known round the Sun: {known}"
            )
        return self._turned(frames.EQUATOR_FROM_ECLIPTIC.T, ECLIPTIC)

    def in_equator_of_date(self) -> Ephemeris:
        """The same trajectory in the mean equator of the first row's date, where sailviz keeps what circles the Earth.

        True equators of date (TOD, TEME) count as the mean one, up to 19 arcsec of nutation away: 0.6 km at 7000 km.
        RecordingError for other frames, such as those that turn with the Earth.
        """
        if self.frame in NEARLY_OF_DATE:
            return self
        if self.frame not in NEARLY_INERTIAL:
            known = ", ".join(("J2000", *NEARLY_INERTIAL, *NEARLY_OF_DATE))
            raise RecordingError(f"the frame {self.frame} cannot be turned here; known round the Earth: {known}")
        return self._turned(frames.precession(Sky(self.utc).centuries), OF_DATE)

    def _turned(self, matrix: np.ndarray, frame: str) -> Ephemeris:
        return replace(self, frame=frame, position=self.position @ matrix.T, velocity=self.velocity @ matrix.T)


@dataclass
class _Block:
    """A segment of the file: its metadata, and its rows with the line that each stands in."""

    line: int
    meta: dict[str, str] = field(default_factory=dict)
    epochs: list[str] = field(default_factory=list)
    states: list[list[float]] = field(default_factory=list)
    lines: list[int] = field(default_factory=list)
    instants: np.ndarray = field(default_factory=lambda: np.zeros(0, np.int64))  # ns of TAI
    values: np.ndarray = field(default_factory=lambda: np.zeros((0, 6)))  # m, m/s

    def keep(self, rows: np.ndarray) -> None:
        self.instants, self.values = self.instants[rows], self.values[rows]
        self.lines = list(np.array(self.lines)[rows])


def read_oem(path: str | Path) -> Ephemeris:
    """Read an OEM, keywords or XML, versions 1 to 3, all its blocks as one trajectory.

    Of each block the rows between USEABLE_START_TIME and USEABLE_STOP_TIME count. Where blocks still overlap the later
    one counts from its first row on; where one begins at the epoch and place at which another ends, the later row
    counts, or both do where the velocity jumps. Accelerations and covariances are passed over. RecordingError, in one
    sentence with the line, for what is no OEM, is malformed, or changes its frame or centre.
    """
    blocks, notes = _blocks(ndm.lines(path, "OEM"), path)
    meta = _common_meta(blocks, path)
    for block in blocks:
        _read_times(block, meta["TIME_SYSTEM"], path)
    dropped = sum(_within_window(block, meta["TIME_SYSTEM"], path) for block in blocks)
    if dropped:
        notes.append(f"{dropped} rows outside the blocks' useable spans, which serve interpolation only, were left out")
    blocks = [block for block in blocks if len(block.instants)]
    if not blocks:
        raise RecordingError(f"{path} holds no states")
    notes += _joined(blocks, path)
    gaps = _gaps(blocks)
    if gaps:
        longest = max(seconds for _, seconds in gaps)
        notes.append(f"{len(blocks)} blocks, {longest:,.6g} s without data between two of them")
    instants = np.concatenate([block.instants for block in blocks])
    values = np.concatenate([block.values for block in blocks])
    return Ephemeris(
        meta["OBJECT_NAME"],
        blocks[0].meta.get("OBJECT_ID", ""),
        meta["CENTER_NAME"].upper(),
        _frame(meta["REF_FRAME"]),
        meta["TIME_SYSTEM"].upper(),
        dates.label_of(int(instants[0]), meta["TIME_SYSTEM"].upper()),
        (instants - instants[0]) / 1e9,
        values[:, :3],
        values[:, 3:],
        gaps,
        tuple(notes),
    )


def of_one_state(
    about: tuple[str, str, str, str, str],
    instant: int,
    position: tuple[float, float, float],
    velocity: tuple[float, float, float],
    notes: tuple[str, ...] = (),
) -> Ephemeris:
    """A trajectory of one row. about : name, identity, centre, frame, time system; instant : ns of TAI; SI."""
    name, identity, center, frame, system = about
    epoch = dates.label_of(instant, system)
    state = np.array([position], float), np.array([velocity], float)
    return Ephemeris(name, identity, center, _frame(frame), system, epoch, np.zeros(1), *state, (), notes)


_SECTIONS = {"META_START": "meta", "META_STOP": "data", "COVARIANCE_START": "covariance", "COVARIANCE_STOP": "data"}


def _blocks(lines: list[ndm.Line], path: str | Path) -> tuple[list[_Block], list[str]]:
    """The blocks as they are written, and what in them is passed over."""
    blocks: list[_Block] = []
    passed: dict[str, None] = {}
    section = "header"
    for number, text in lines:
        if text.upper() in _SECTIONS:
            section = _SECTIONS[text.upper()]
            if text.upper() == "META_START":
                blocks.append(_Block(number))
            elif section == "covariance":
                passed["covariances are passed over"] = None
        elif section == "meta":
            key, _, value = text.partition("=")
            if key.strip().upper() == "REF_FRAME_EPOCH":
                raise RecordingError(
                    f"{path}, line {number}: a frame with an epoch of its own is not read here ({key})"
                )
            blocks[-1].meta[key.strip().upper()] = value.strip()
        elif re.fullmatch(r"(\s*\[[^\]]*\])+", text):  # the units of the columns
            continue
        elif section == "data":
            if not blocks:
                raise RecordingError(f"{path}, line {number}: states stand before the first META_START")
            epoch, *numbers = text.split()
            if len(numbers) == 9:
                passed["accelerations are passed over"] = None
            blocks[-1].epochs.append(epoch)
            blocks[-1].states.append(_six(numbers, text, number, path))
            blocks[-1].lines.append(number)
    if not any(block.states for block in blocks):
        raise RecordingError(f"{path} holds no states")
    return [block for block in blocks if block.states], list(passed)


def _six(numbers: list[str], text: str, line: int, path: str | Path) -> list[float]:
    try:
        if len(numbers) not in (6, 9):
            raise ValueError
        found = [float(number) for number in numbers[:6]]
    except ValueError:
        raise RecordingError(f"{path}, line {line}: an epoch and six numbers were due, not {text[:80]!r}") from None
    if not np.isfinite(found).all():
        raise RecordingError(f"{path}, line {line}: a state is not a finite number: {text[:80]!r}")
    if max(map(abs, found)) > LARGEST:
        raise RecordingError(f"{path}, line {line}: a state is out of all bounds: {text[:80]!r}")
    return found


def _frame(word: str) -> str:
    return SAME_AXES.get(word.upper(), word.upper())


def _common_meta(blocks: list[_Block], path: str | Path) -> dict[str, str]:
    """Metadata in which all blocks agree, letter case aside. RecordingError where they do not, or lack a value."""
    common = {}
    for key in REQUIRED:
        values = {block.meta.get(key, "") for block in blocks}
        alike = {_frame(value) if key == "REF_FRAME" else value.upper() for value in values}
        if "" in values:
            raise RecordingError(f"{path} has no {key}")
        if len(alike) > 1 and key != "OBJECT_NAME":
            raise RecordingError(f"{path} changes its {key}: {', '.join(sorted(values))}")
        common[key] = blocks[0].meta[key]
    return common


def _read_times(block: _Block, system: str, path: str | Path) -> None:
    """Epochs as instants, states in SI; a row that repeats the one before is dropped."""
    instants = []
    for epoch, line in zip(block.epochs, block.lines, strict=True):
        try:
            instants.append(tai(epoch, system.upper()))
        except DateError as error:
            raise RecordingError(f"{path}, line {line}: {error}") from None
    block.instants = np.array(instants, np.int64)
    block.values = np.array(block.states) * 1e3
    new = np.ones(len(instants), bool)
    for row in range(1, len(instants)):
        step = instants[row] - instants[row - 1]
        if step == 0 and block.states[row] == block.states[row - 1]:
            new[row] = False
        elif step <= 0:
            what = (
                "repeats the epoch of the row before with another state" if step == 0 else "lies before the row above"
            )
            raise RecordingError(f"{path}, line {block.lines[row]}: this row {what}; epochs must increase")
    block.keep(new)


def _within_window(block: _Block, system: str, path: str | Path) -> int:
    """Keep the rows of the useable span -> how many were dropped."""
    if "USEABLE_START_TIME" not in block.meta and "USEABLE_STOP_TIME" not in block.meta:
        return 0
    edges = []
    for end, default in (("START", block.instants[0]), ("STOP", block.instants[-1])):
        text = block.meta.get(f"USEABLE_{end}_TIME", block.meta.get(f"{end}_TIME"))
        try:
            edges.append(int(default) if text is None else tai(text, system.upper()))
        except DateError as error:
            raise RecordingError(f"{path}, block at line {block.line}: {error}") from None
    inside = (block.instants >= edges[0]) & (block.instants <= edges[1])
    block.keep(inside)
    return int(np.count_nonzero(~inside))


def _joined(blocks: list[_Block], path: str | Path) -> list[str]:
    """Cut every block where the next one takes over -> sentences on what was cut or jumps."""
    notes = []
    for before, after in pairwise(blocks):
        start = after.instants[0]
        places = f"the blocks at lines {before.line} and {after.line}"
        if start < before.instants[0]:
            raise RecordingError(f"{path}: {places} are not in order of time")
        if start > before.instants[-1]:
            continue
        row = int(np.searchsorted(before.instants, start))
        off, jump = _apart(before, row, after)
        if off > SAME_FLIGHT:
            raise RecordingError(f"{path}: {places} overlap and are {off:.2g} of the distance apart there")
        cut = np.arange(len(before.instants)) < row
        if start == before.instants[-1]:
            if off <= SAME_PLACE and jump > SAME_PLACE:
                notes.append(f"the velocity jumps between {places}")
                continue
            before.keep(cut)
        else:
            before.keep(cut)
            notes.append(f"{places} overlap; the later one counts from its first row on")
    blocks[:] = [block for block in blocks if len(block.instants)]
    return notes


def _apart(before: _Block, row: int, after: _Block) -> tuple[float, float]:
    """How far two blocks are apart where the later one begins: place over distance, velocity over speed."""
    state, start = after.values[0], after.instants[0]
    other = before.values[row]
    if before.instants[row] != start and row > 0:
        a, b = before.values[row - 1], before.values[row]
        span = (before.instants[row] - before.instants[row - 1]) / 1e9
        other = _between(a, b, span, (start - before.instants[row - 1]) / 1e9 / span)
    off = np.linalg.norm((other - state).reshape(2, 3), axis=1)
    size = np.maximum(np.linalg.norm(state.reshape(2, 3), axis=1), 1e-300)
    return float(off[0] / size[0]), float(off[1] / size[1])


def _between(a: np.ndarray, b: np.ndarray, span: float, x: float) -> np.ndarray:
    """State (6,) at the fraction x of a step of span s, by Hermite's cubic through two rows."""
    rise, low, high = b[:3] - a[:3], span * a[3:], span * b[3:]
    place = a[:3] + x * (low + x * (3 * rise - 2 * low - high + x * (low + high - 2 * rise)))
    rate = low + x * (2 * (3 * rise - 2 * low - high) + 3 * x * (low + high - 2 * rise))
    return np.concatenate([place, rate / span])


def _gaps(blocks: list[_Block]) -> tuple[tuple[int, float], ...]:
    """(last row before, seconds without data) wherever two blocks are farther apart than twice their rows are."""
    found, rows = [], 0
    for before, after in pairwise(blocks):
        rows += len(before.instants)
        pause = float(after.instants[0] - before.instants[-1]) / 1e9
        steps = [
            float(np.median(np.diff(block.instants))) / 1e9 for block in (before, after) if len(block.instants) > 1
        ]
        if steps and pause > LONG_GAP * max(steps):
            found.append((rows - 1, pause))
    return tuple(found)
