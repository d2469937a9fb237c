"""Position and velocity of a recording in the files in which missions exchange trajectories: dated, centred, in a frame
that others know.

oem   CCSDS 502.0-B, dated in UTC
aem   CCSDS 504.0-B, version 2: the attitude of the craft, dated in UTC
spk   a kernel of SPICE, segments of type 13, dated in TDB: the file has the ending bsp

In both a new segment begins after a gap and where the velocity jumps. A run says in which of its own frames it was
computed; it is turned to the equator of J2000, which counts as the axes of the ICRF, or with frame = "ECLIPJ2000" to
the ecliptic of J2000. What came as arrays is in the ecliptic of J2000 round the Sun, in the mean equator of its first
date round the Earth, and in a frame that must be named round another body: nothing is turned then.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

from sailviz import frames
from sailviz.errors import RecordingError
from sailviz.exchange import aem, spk
from sailviz.recording.comparison.tables import Evidence, Table
from sailviz.run import dates
from sailviz.run import gaps as spans
from sailviz.run.oem import ECLIPTIC, EQUATOR, SAME_PLACE, Ephemeris
from sailviz.run.oem_writer import plain, write_oem
from sailviz.sky.bodies import BODIES
from sailviz.sky.places import Sky, tdb_ahead
from sailviz.version import __version__

ORBIT_FILES = ("oem", "spk", "aem")
CRAFT = spk.CRAFT
STATE = ("position_m", "velocity_m_s")
TURNED = {EQUATOR: "icrf", ECLIPTIC: "ecliptic-j2000"}  # the frames that runs are turned to
SPK_FRAMES = {EQUATOR: "J2000", "J2000": "J2000", ECLIPTIC: ECLIPTIC}
J2000_TT = np.datetime64("2000-01-01T12:00:00", "ns")
HOW = {  # a run's own frame -> what a message says of it
    "ecliptic-j2000": "computed in the ecliptic of J2000; rotated by the obliquity 84381.448 arcsec about x",
    "icrf": "computed in the axes of the ICRF",
    "equator-of-date": "computed in the mean equator of the first row's date; turned to J2000, nutation neglected",
}
AS_IT_IS = "ECLIPJ2000: x to the equinox of J2000, z to the pole of the ecliptic of J2000"


def ids_named(craft_id: int, centre_id: int | None) -> bool:
    """Whether an id was given that only an SPK has."""
    return craft_id != CRAFT or centre_id is not None


def write_orbit(data: Evidence, path: Path, to: str, frame: str, craft_id: int, centre_id: int | None) -> Path:
    """Write one of ORBIT_FILES. RecordingError, in one sentence, for what cannot be said in it: it dates every row, of
    one flight, in a frame that is known."""
    what = f"an {to.upper()}"
    if data.starts:
        count = len(data.starts)
        raise RecordingError(
            f"{data.label} holds {count} flights, and {what} one: export the recording of each by itself"
        )
    if "/state" not in data.entities:
        raise RecordingError(f"{data.label} has no /state, so no position and velocity to write")
    if data.epoch is None:
        raise RecordingError(f"{data.label} has no epoch, and {what} dates every row: give the scene an epoch")
    state = data.table("/state")
    if np.any(np.diff(state.time) < 0):
        raise RecordingError(f"{data.label}: its times do not increase, and {what} needs that")
    if to == "oem":
        return _oem(data, data.epoch, state, path, frame)
    if to == "aem":
        return _aem(data, data.epoch, state, path, frame)
    return _spk(data, data.epoch, state, path, frame, craft_id, centre_id)


def _turned(data: Evidence, epoch: np.datetime64, state: Table, frame: str) -> tuple[np.ndarray, np.ndarray, str]:
    """(position, velocity) (n, 3) in one of TURNED, and how it was computed, "" where nothing is known."""
    position, velocity = (state.columns[name] for name in STATE)
    own, body = data.frame, str(data.facts.get("body", ""))
    if not own:
        if not frame:
            words = f"which frame a run round {body or 'an unnamed body'} is in is not known: name it with frame"
            raise RecordingError(words)
        return position, velocity, ""
    if frame not in TURNED:
        raise RecordingError(f"a run round {_article(body)} is written in {' or '.join(TURNED)}, not in {frame}")
    if TURNED[frame] == own:
        return position, velocity, AS_IT_IS if frame == ECLIPTIC else HOW[own]
    centuries = Sky(epoch).centuries
    turn = frames.icrf_to(own, centuries) @ frames.icrf_to(TURNED[frame], centuries).T  # from the frame wanted to it
    return position @ turn, velocity @ turn, HOW[own].split(";")[0] if frame == ECLIPTIC else HOW[own]


def _article(body: str) -> str:
    return f"the {body}" if body in ("Sun", "Earth", "Moon") else body


def _oem(data: Evidence, epoch: np.datetime64, state: Table, path: Path, frame: str) -> Path:
    position, velocity, how = _turned(data, epoch, state, frame or (EQUATOR if data.frame else ""))
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


def _aem(data: Evidence, epoch: np.datetime64, state: Table, path: Path, frame: str) -> Path:
    """The attitude: from the axes of the message to those of the craft. Of two rows at one time the later counts."""
    if "/attitude" not in data.entities:
        raise RecordingError(f"{data.label} has no /attitude, and an AEM holds nothing else")
    quaternion = data.table("/attitude").columns["quaternion"]
    wanted = frame or (EQUATOR if data.frame else "")
    axes = np.eye(3)
    if data.frame or not frame:
        along = replace(state, columns=dict.fromkeys(STATE, axes))
        axes = _turned(data, epoch, along, wanted)[0].T  # from the axes of the run to those wanted
    turn = np.broadcast_to(frames.quaternion(axes[None])[0], quaternion.shape)
    instants = dates.instant_of(epoch) + np.round(state.time * 1e9).astype(np.int64)
    kept = np.diff(instants, append=np.iinfo(np.int64).max) > 0
    row_of = np.cumsum(kept) - 1  # of a row among those that are kept
    begins = {0, *(int(row_of[row]) + 1 for row in spans.last_rows(state.time, data.gaps))}
    title = str(data.facts.get("title", ""))
    rows = aem.AttitudeRows(
        plain(title).upper()[:60] or "TRAJECTORY",
        str(data.facts.get("identity", "")) or "UNKNOWN",
        wanted,
        "UTC",
        instants[kept],
        product(turn, quaternion)[kept],
        tuple(sorted(begins)),
    )
    return aem.write_aem(path, rows, dates.utc_texts(rows.instants), str(data.facts.get("body", "")).upper())


def product(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Quaternions (n, 4) x y z w that turn by b, then by a."""
    u, v, p, q = a[:, :3], b[:, :3], a[:, 3:], b[:, 3:]
    vector = p * v + q * u + np.cross(u, v)
    return np.hstack([vector, p * q - np.sum(u * v, axis=1, keepdims=True)])


def _spk(
    data: Evidence, epoch: np.datetime64, state: Table, path: Path, frame: str, craft_id: int, centre_id: int | None
) -> Path:
    if frame and frame not in SPK_FRAMES:
        raise RecordingError(f"an SPK is written in J2000 or {ECLIPTIC}, not in {frame}")
    body = str(data.facts.get("body", ""))
    centre = (
        centre_id if centre_id is not None else next((one.number for one in BODIES.values() if one.name == body), None)
    )
    if centre is None:
        words = f"which NAIF id {body or 'an unnamed body'} has is not known: name it with centre_id"
        raise RecordingError(f"{words} (--centre-id)")
    known = EQUATOR if SPK_FRAMES.get(frame, "J2000") == "J2000" else ECLIPTIC
    position, velocity, how = _turned(data, epoch, state, known if data.frame else frame)
    title, identity = " ".join(str(data.facts.get("title", "")).split()), str(data.facts.get("identity", ""))
    arcs, alone = _arcs(state.time, _et(epoch, state.time), position, velocity, data.gaps)
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
        frame=SPK_FRAMES.get(frame, "J2000"),
        target=craft_id,
        name=title or "trajectory",
        comments=comments,
    )


def _name(title: str) -> str:
    """A title as SPICE takes a body's name: capitals, no quotes, at most 36 characters."""
    kept = "".join(letter if letter.isascii() and letter.isalnum() else " " for letter in title.upper())
    return " ".join(kept.split())[:36].strip() or "TRAJECTORY"


def _et(epoch: np.datetime64, time: np.ndarray) -> np.ndarray:
    """s of TDB after J2000 (n,) of seconds after an epoch: those of a run are of TDB."""
    tt = float((epoch - J2000_TT) / np.timedelta64(1, "ns")) * 1e-9 + tdb_ahead(epoch)
    start: float = tt + spk.tdb_less_tt(tt)
    return start + np.asarray(time, float)


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
