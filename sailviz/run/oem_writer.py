"""Writing an orbit ephemeris message, and reading it back before it counts as written."""

from __future__ import annotations

import os
from collections.abc import Iterable
from datetime import UTC, datetime
from pathlib import Path

import numpy as np

from sailviz import files
from sailviz.calendar import DateError
from sailviz.errors import RecordingError
from sailviz.run import dates
from sailviz.run.oem import SAME_PLACE, Ephemeris, read_oem

LONGEST_VALUE = 200  # characters of a text field


def write_oem(path: str | Path, ephemeris: Ephemeris, comments: Iterable[str] = ()) -> Path:
    """Write an OEM, version 2.0, and read it back. Over a gap nothing may be interpolated, and where the velocity jumps
    nothing either: there a new segment begins. km and km/s with the 16 digits that the standard allows, epochs to
    the nanosecond. RecordingError where the file cannot be written or does not say what it should.
    """
    path = Path(path)
    e = ephemeris
    ns = np.round(e.time * 1e9).astype(np.int64)
    if not (np.isfinite(e.time).all() and np.isfinite(e.position).all() and np.isfinite(e.velocity).all()):
        raise RecordingError("an OEM holds finite numbers only")
    begins = _segments(e, ns)
    if np.any(np.diff(ns) < 0) or not set(np.flatnonzero(np.diff(ns) == 0) + 1) <= set(begins):
        raise RecordingError("an OEM needs rows at least a nanosecond apart, in order of time")
    epochs = _epochs(e, ns)
    with files.writing(path, "ephemeris", lambda part: _check_back(read_oem(part), e, ns, path)) as part:
        part.write_text("\n".join([*_head(), *_body(e, epochs, begins, comments), ""]), encoding="ascii")
    return path


def _segments(e: Ephemeris, ns: np.ndarray) -> list[int]:
    """The rows with which segments begin: the first, those after gaps, and those at which the velocity jumps."""
    jumps = [row + 1 for row in np.flatnonzero(np.diff(ns) == 0).tolist() if _jumps(e, row)]
    return sorted({0, *(row + 1 for row, _ in e.gaps), *jumps})


def _jumps(e: Ephemeris, row: int) -> bool:
    """Whether a row and the next one are one place with two velocities."""
    apart = [np.linalg.norm(part[row + 1] - part[row]) for part in (e.position, e.velocity)]
    size = [np.linalg.norm(part[row + 1]) for part in (e.position, e.velocity)]
    return bool(apart[0] <= SAME_PLACE * size[0] and apart[1] > SAME_PLACE * size[1])


def plain(text: str) -> str:
    """A text as one line of the message can hold it: ASCII, no control characters, no keyword at its beginning."""
    kept = "".join(c if c.isascii() and c.isprintable() else "?" if c.isprintable() else " " for c in text)
    kept = " ".join(kept.split())[:LONGEST_VALUE]
    return f"- {kept}" if kept.upper().startswith(("COMMENT", "META_", "COVARIANCE_")) else kept


def _epochs(e: Ephemeris, ns: np.ndarray) -> list[str]:
    """Epochs of all rows as they are written; UTC with the leap seconds that fall between the rows."""
    if e.time_system != "UTC":
        return [str(label) for label in e.epoch.astype("datetime64[ns]") + ns.astype("timedelta64[ns]")]
    try:
        instants = dates.instant_of(e.epoch) + ns
    except DateError as error:
        raise RecordingError(f"an OEM dates its rows in UTC: {error}") from None
    return dates.utc_texts(instants)


def _head() -> list[str]:
    stamp = os.environ.get("SOURCE_DATE_EPOCH")
    now = datetime.fromtimestamp(int(stamp), UTC) if stamp else datetime.now(UTC)
    return [
        "CCSDS_OEM_VERS = 2.0",
        f"CREATION_DATE = {now:%Y-%m-%dT%H:%M:%S}",
        "ORIGINATOR = SAILVIZ",
        "",
    ]


def _body(e: Ephemeris, epochs: list[str], begins: list[int], comments: Iterable[str]) -> list[str]:
    """The segments, those after the first without the comments."""
    lines, rows = [], _rows(e, epochs)
    for begin, end in zip(begins, [*begins[1:], len(rows)], strict=True):
        lines += [*_meta(e, epochs[begin:end], () if begin else comments), *rows[begin:end], ""]
    return lines[:-1]


def _meta(e: Ephemeris, epochs: list[str], comments: Iterable[str]) -> list[str]:
    return [
        "META_START",
        *(f"COMMENT {plain(line)}" for line in comments if plain(line)),
        f"OBJECT_NAME = {plain(e.name) or 'TRAJECTORY'}",
        f"OBJECT_ID = {plain(e.identity) or 'UNKNOWN'}",
        f"CENTER_NAME = {plain(e.center)}",
        f"REF_FRAME = {plain(e.frame)}",
        f"TIME_SYSTEM = {e.time_system}",
        f"START_TIME = {epochs[0]}",
        f"STOP_TIME = {epochs[-1]}",
        "META_STOP",
        "",
    ]


def _rows(e: Ephemeris, epochs: list[str]) -> list[str]:
    states = np.hstack([e.position, e.velocity]) / 1e3
    line = "%s" + " % .15e" * 6
    return [line % (epoch, *state) for epoch, state in zip(epochs, states.tolist(), strict=True)]


def _check_back(back: Ephemeris, e: Ephemeris, ns: np.ndarray, path: Path) -> None:
    """RecordingError unless a written message says what it should, to the last digit that it can hold."""
    scale = np.abs(e.position).max(), np.abs(e.velocity).max()
    if (
        len(back.time) != len(e.time)
        or np.any(np.abs(back.time - (ns - ns[0]) / 1e9) > 1e-9)
        or np.any(np.abs(back.position - e.position) > 1e-15 * scale[0])
        or np.any(np.abs(back.velocity - e.velocity) > 1e-15 * scale[1])
    ):
        raise RecordingError(f"{path} did not come back as it was written")
