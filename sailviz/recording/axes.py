"""The axes in which a recording is written for others: those of the ICRF, or of the ecliptic of J2000."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from sailviz import frames
from sailviz.errors import RecordingError
from sailviz.recording.comparison.tables import Evidence, Table
from sailviz.run.oem import ECLIPTIC, EQUATOR
from sailviz.sky.places import Sky

STATE = ("position_m", "velocity_m_s")
TURNED = {EQUATOR: "icrf", ECLIPTIC: "ecliptic-j2000"}  # the frames that runs are turned to
KERNEL_FRAMES = {EQUATOR: "J2000", "J2000": "J2000", ECLIPTIC: ECLIPTIC}  # what they are called in SPICE
HOW = {  # a run's own frame -> what a message says of it
    "ecliptic-j2000": "computed in the ecliptic of J2000; rotated by the obliquity 84381.448 arcsec about x",
    "icrf": "computed in the axes of the ICRF",
    "equator-of-date": "computed in the mean equator of the first row's date; turned to J2000, nutation neglected",
}
AS_IT_IS = "ECLIPJ2000: x to the equinox of J2000, z to the pole of the ecliptic of J2000"


def turned(data: Evidence, epoch: np.datetime64, state: Table, frame: str) -> tuple[np.ndarray, np.ndarray, str]:
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


def axes_of(data: Evidence, epoch: np.datetime64, state: Table, frame: str) -> np.ndarray:
    """R (3, 3) that takes vectors of a recording to a frame of TURNED, or, of one whose frame is not known, to the one
    that is named."""
    axes = np.eye(3)
    if data.frame or not frame:
        axes = turned(data, epoch, replace(state, columns=dict.fromkeys(STATE, axes)), frame)[0].T
    return axes


def kernel_frame(data: Evidence, frame: str, what: str) -> tuple[str, str]:
    """(the frame of TURNED that rows are turned to, or the one that is named; what SPICE calls it)."""
    if frame and frame not in KERNEL_FRAMES:
        raise RecordingError(f"{what} is written in J2000 or {ECLIPTIC}, not in {frame}")
    word = KERNEL_FRAMES.get(frame, "J2000")
    known = EQUATOR if word == "J2000" else ECLIPTIC
    return (known if data.frame else frame), word


def _article(body: str) -> str:
    return f"the {body}" if body in ("Sun", "Earth", "Moon") else body
