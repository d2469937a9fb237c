"""Position and velocity of a recording in the files in which missions exchange trajectories: dated, centred, in a frame
that others know.

oem       CCSDS 502.0-B, dated in UTC
spk       a kernel of SPICE, segments of type 13, dated in TDB: the file has the ending bsp
aem, ck   the attitude (attitude_files.py)

In all a new segment begins after a gap and where the velocity jumps. A run says in which of its own frames it was
computed; it is turned to the equator of J2000, which counts as the axes of the ICRF, or with frame = "ECLIPJ2000" to
the ecliptic of J2000. What came as arrays is in the ecliptic of J2000 round the Sun, in the mean equator of its first
date round the Earth, and in a frame that must be named round another body: nothing is turned then.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from sailviz.errors import RecordingError
from sailviz.exchange import spk
from sailviz.recording.attitude_files import write_aem, write_ck
from sailviz.recording.axes import kernel_frame, turned
from sailviz.recording.comparison.tables import Evidence, Table
from sailviz.run import gaps as spans
from sailviz.run.oem import EQUATOR, SAME_PLACE, Ephemeris
from sailviz.run.oem_writer import plain, write_oem
from sailviz.sky.bodies import BODIES
from sailviz.version import __version__

ORBIT_FILES = {"oem": "an OEM", "aem": "an AEM", "spk": "an SPK", "ck": "a CK"}
ATTITUDES = ("aem", "ck")
KERNELS = ("spk", "ck")
CRAFT = spk.CRAFT


def check_ids(to: str, craft_id: int, centre_id: int | None) -> None:
    """RecordingError where an id was given that a format has no place for."""
    if to not in KERNELS and (craft_id != CRAFT or centre_id is not None):
        raise RecordingError(f"craft and centre have NAIF ids in an SPK, the craft in a CK; {to} knows none")
    if to == "ck" and centre_id is not None:
        raise RecordingError("a CK says how the craft stands, and has no place for a centre_id")


def write_orbit(
    data: Evidence, path: Path, to: str, frame: str, craft_id: int, centre_id: int | None
) -> tuple[Path, ...]:
    """Write one of ORBIT_FILES -> files written. RecordingError, in one sentence, for what cannot be said in it: it
    dates every row, of one flight, in a frame that is known."""
    what = ORBIT_FILES[to]
    if data.starts:
        count = len(data.starts)
        raise RecordingError(
            f"{data.label} holds {count} flights, and {what} one: export the recording of each by itself"
        )
    if "/state" not in data.entities:
        raise RecordingError(f"{data.label} has no /state, so no position and velocity to write")
    epoch = data.epoch
    if epoch is None:
        raise RecordingError(f"{data.label} has no epoch, and {what} dates every row: give the scene an epoch")
    state = data.table("/state")
    if np.any(np.diff(state.time) < 0):
        raise RecordingError(f"{data.label}: its times do not increase, and {what} needs that")
    if to == "ck":
        return write_ck(data, epoch, state, path, frame, craft_id)
    if to == "oem":
        return (_oem(data, epoch, state, path, frame),)
    if to == "aem":
        return (write_aem(data, epoch, state, path, frame),)
    return (_spk(data, epoch, state, path, frame, craft_id, centre_id),)


def _oem(data: Evidence, epoch: np.datetime64, state: Table, path: Path, frame: str) -> Path:
    position, velocity, how = turned(data, epoch, state, frame or (EQUATOR if data.frame else ""))
    title, identity = str(data.facts.get("title", "")), str(data.facts.get("identity", ""))
    comments = [title, f"made by sailviz from the scene {identity}", *([how] if how else [])]
    ephemeris = Ephemeris(
        plain(title).upper()[:60] or "TRAJECTORY",
        identity or "UNKNOWN",
        str(data.facts.get("body", "")).upper(),
        frame or EQUATOR,
        "UTC",
        epoch,
        state.time,
        position,
        velocity,
        tuple((row, float(state.time[row + 1] - state.time[row])) for row in spans.last_rows(state.time, data.gaps)),
    )
    return write_oem(path, ephemeris, comments)


def _spk(
    data: Evidence, epoch: np.datetime64, state: Table, path: Path, frame: str, craft_id: int, centre_id: int | None
) -> Path:
    wanted, word = kernel_frame(data, frame, "an SPK")
    body = str(data.facts.get("body", ""))
    centre = (
        centre_id if centre_id is not None else next((one.number for one in BODIES.values() if one.name == body), None)
    )
    if centre is None:
        words = f"which NAIF id {body or 'an unnamed body'} has is not known: name it with centre_id"
        raise RecordingError(f"{words} (--centre-id)")
    position, velocity, how = turned(data, epoch, state, wanted)
    title, identity = " ".join(str(data.facts.get("title", "")).split()), str(data.facts.get("identity", ""))
    arcs, alone = _arcs(state.time, spk.seconds_of_tdb(epoch, state.time), position, velocity, data.gaps)
    if not arcs:
        raise RecordingError(f"{data.label} has no two rows one after the other, and an SPK interpolates between rows")
    comments = [
        *([title] if title else []),
        f"made by sailviz {__version__} from the scene {identity}",
        *([how] if how else []),
        f"t = 0 of the run is {str(epoch)[:23]} UTC; its seconds are those of TDB",
        *([f"{alone} rows between two breaks, which make no arc, are left out"] if alone else []),
        "A name for the craft, as a text kernel:",
        "\\begindata",
        f"NAIF_BODY_NAME += ( '{_name(title)}' )",
        f"NAIF_BODY_CODE += ( {craft_id} )",
        "\\begintext",
    ]
    return spk.write_spk(
        path,
        arcs,
        centre=centre,
        frame=word,
        target=craft_id,
        name=title or "trajectory",
        comments=comments,
    )


def _name(title: str) -> str:
    """A title as SPICE takes a body's name: capitals, no quotes, at most 36 characters."""
    kept = "".join(letter if letter.isascii() and letter.isalnum() else " " for letter in title.upper())
    name = " ".join(kept.split())[:36].strip() or "TRAJECTORY"
    return f"{name} CRAFT" if name in spk.BODIES.values() else name  # or the kernel would rename the body


def _arcs(
    time: np.ndarray, et: np.ndarray, position: np.ndarray, velocity: np.ndarray, gaps: tuple[tuple[float, float], ...]
) -> tuple[list[spk.Arc], int]:
    """The unbroken arcs, and how many rows stand alone. One of two rows at one time and in one state is left out; where
    the velocities differ an arc ends and the next one begins."""
    kept, breaks = [0], {row + 1 for row in spans.last_rows(time, gaps)}
    begins = []
    for row in range(1, len(et)):
        before = kept[-1]
        if et[row] <= et[before] and row not in breaks:
            if np.linalg.norm(velocity[row] - velocity[before]) <= SAME_PLACE * np.linalg.norm(velocity[row]):
                continue
            if np.linalg.norm(position[row] - position[before]) > SAME_PLACE * np.linalg.norm(position[row]):
                raise RecordingError("at one time the craft is at two places: an SPK cannot say that")
            breaks.add(row)
        if row in breaks:
            begins.append(len(kept))
        kept.append(row)
    arcs, alone = [], 0
    for rows in np.split(np.array(kept), begins):
        if len(rows) > 1:
            arcs.append(spk.Arc(et[rows], position[rows], velocity[rows]))
        alone += len(rows) == 1
    return arcs, alone
