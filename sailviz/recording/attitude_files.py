"""The attitude of a recording in the files in which missions exchange it.

aem   CCSDS 504.0-B, version 2, dated in UTC
ck    a kernel of SPICE, a segment of type 3, dated by a clock; the clock and the craft's axes stand in two text kernels
      beside it, of the same name: NAME.bc, NAME.tsc, NAME.tf

Where the attitude jumps and after a gap a new block or interval begins. Rows of a stowed sail say no attitude and are
left out, with a break.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from sailviz import frames
from sailviz.errors import RecordingError
from sailviz.exchange import aem, ck, spk
from sailviz.recording.axes import axes_of, kernel_frame, turned
from sailviz.recording.comparison.tables import Evidence, Table
from sailviz.run import dates
from sailviz.run import gaps as spans
from sailviz.run.oem import EQUATOR
from sailviz.run.oem_writer import plain
from sailviz.version import __version__

SAME_ATTITUDE = 1e-9  # by which two quaternions at one time may differ and be one
TICK = 1e-6  # s


@dataclass(frozen=True)
class Attitude:
    """Rows (k,) that have an attitude, quaternion (k, 4) x y z w from the craft's axes to those of a frame, begins :
    those among the k with which unbroken stretches begin; stowed : how many rows have none."""

    rows: np.ndarray
    quaternion: np.ndarray
    begins: tuple[int, ...]
    stowed: int


def attitude_of(data: Evidence, epoch: np.datetime64, state: Table, frame: str, what: str) -> Attitude:
    """The attitude of a recording in a frame. Of two rows at one time both count where they differ. RecordingError
    where there is none."""
    if "/attitude" not in data.entities:
        raise RecordingError(f"{data.label} has no /attitude, and {what} holds nothing else")
    columns = data.table("/attitude").columns
    known = np.isfinite(columns["quaternion"]).all(axis=1) & np.any(columns["normal"], axis=1)
    if not known.any():
        raise RecordingError(f"{data.label} says of no row how the craft stands, and {what} holds nothing else")
    turn = np.broadcast_to(frames.quaternion(axes_of(data, epoch, state, frame)[None])[0], (len(known), 4))
    quaternion = product(turn, np.where(known[:, None], columns["quaternion"], [0.0, 0.0, 0.0, 1.0]))
    again = np.diff(state.time, prepend=-np.inf) == 0.0
    alike = np.abs(np.sum(quaternion * np.roll(quaternion, 1, axis=0), axis=1)) > 1.0 - SAME_ATTITUDE
    kept = known & ~(again & alike & np.roll(known, 1))
    new = again & ~alike
    new[spans.last_rows(state.time, data.gaps) + 1] = True
    new |= known & ~np.roll(known, 1)
    group = np.cumsum(new)[kept]
    begins = np.flatnonzero(np.diff(group, prepend=-1))
    rows = np.flatnonzero(kept)
    return Attitude(rows, quaternion[rows], tuple(begins.tolist()), int(np.count_nonzero(~known)))


def product(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Quaternions (n, 4) x y z w that turn by b, then by a."""
    u, v, p, q = a[:, :3], b[:, :3], a[:, 3:], b[:, 3:]
    vector = p * v + q * u + np.cross(u, v)
    return np.hstack([vector, p * q - np.sum(u * v, axis=1, keepdims=True)])


def write_aem(data: Evidence, epoch: np.datetime64, state: Table, path: Path, frame: str) -> Path:
    """The attitude: from the axes of the message to those of the craft. Of two rows at one time the later counts."""
    wanted = frame or (EQUATOR if data.frame else "")
    found = attitude_of(data, epoch, state, wanted, "an AEM")
    instants = dates.instant_of(epoch) + np.round(state.time[found.rows] * 1e9).astype(np.int64)
    kept = np.diff(instants, append=np.iinfo(np.int64).max) > 0
    row_of = np.cumsum(kept) - kept  # of a row, or of the later one at its time, among those that are kept
    title = str(data.facts.get("title", ""))
    rows = aem.AttitudeRows(
        plain(title).upper()[:60] or "TRAJECTORY",
        str(data.facts.get("identity", "")) or "UNKNOWN",
        wanted,
        "UTC",
        instants[kept],
        found.quaternion[kept],
        tuple(sorted({int(row_of[row]) for row in found.begins})),
    )
    return aem.write_aem(path, rows, dates.utc_texts(rows.instants), str(data.facts.get("body", "")).upper())


def write_ck(
    data: Evidence, epoch: np.datetime64, state: Table, path: Path, frame: str, craft_id: int
) -> tuple[Path, ...]:
    """The attitude as a kernel, with its clock and its frame. Where the attitude jumps, the row before the jump stands
    a tick earlier, so that both are there."""
    wanted, word = kernel_frame(data, frame, "a CK")
    found = attitude_of(data, epoch, state, wanted, "a CK")
    clock, axes = path.with_suffix(".tsc"), path.with_suffix(".tf")
    if path in (clock, axes):
        raise RecordingError(f"beside {path} stand its clock and its frame, .tsc and .tf: a CK's name ends in .bc")
    how = turned(data, epoch, state, wanted)[2]
    et = spk.seconds_of_tdb(epoch, state.time[found.rows])
    ends = (*found.begins[1:], len(et))
    for begin in found.begins[1:]:
        if et[begin] <= et[begin - 1]:
            et[begin - 1] -= TICK
    pointings = [ck.Pointing(et[a:b], found.quaternion[a:b]) for a, b in zip(found.begins, ends, strict=True)]
    title, identity = " ".join(str(data.facts.get("title", "")).split()), str(data.facts.get("identity", ""))
    comments = [
        *([title] if title else []),
        f"made by sailviz {__version__} from the scene {identity}",
        *([how] if how else []),
        f"t = 0 of the run is {str(epoch)[:23]} UTC; its seconds are those of TDB",
        *([f"{found.stowed} rows of a stowed craft, which have no attitude, are left out"] if found.stowed else []),
        f"The axes of the craft are {ck.frame_name(craft_id)}; z is the normal of a sail, or the thrust's direction.",
    ]
    alone = path.exists() and not path.is_file()  # a device or a pipe: nothing lies beside it
    written = [ck.write_ck(path, pointings, frame=word, craft=craft_id, name=title or "attitude", comments=comments)]
    if not alone:
        written.append(ck.write_clock(clock, craft_id, ck.clock_start(float(et[0]))))
        written.append(ck.write_frame(axes, craft_id))
    return tuple(written)
