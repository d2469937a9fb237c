"""Attitude parameter messages: how a craft stands at one moment (CCSDS 504.0-B, versions 1 and 2, keywords or XML).

Version 2 puts each kind of attitude between its own START and STOP, with the scalar of a quaternion last, from frame A
to frame B; version 1 has keywords with Q_ before them, and the direction in Q_DIR. Of a message the quaternion counts.
Manoeuvres are refused by name; Euler angles, spin, rates and inertia are passed over, and said so.
"""

from __future__ import annotations

from collections.abc import Sequence
from datetime import UTC, datetime
from pathlib import Path

import numpy as np

from sailviz import files, ndm
from sailviz.calendar import DateError, tai
from sailviz.errors import RecordingError
from sailviz.exchange.aem import AttitudeRows, direction, unit_length
from sailviz.exchange.keywords import Word, keyword, needed, number
from sailviz.exchange.opm import plain

SECTIONS = {"EULER": "Euler angles", "ANGVEL": "rates", "SPIN": "spin", "INERTIA": "inertia"}
COMPONENTS = ("Q1", "Q2", "Q3", "QC")
REQUIRED = ("OBJECT_NAME", "OBJECT_ID", "TIME_SYSTEM", "EPOCH", "REF_FRAME_A", "REF_FRAME_B", *COMPONENTS)
OF_VERSION_1 = {"Q_FRAME_A": "REF_FRAME_A", "Q_FRAME_B": "REF_FRAME_B", "Q_DIR": "ATTITUDE_DIR"}
KNOWN = (*REQUIRED, "ATTITUDE_DIR", "CCSDS_APM_VERS", "CREATION_DATE", "ORIGINATOR", "MESSAGE_ID", "CLASSIFICATION",
         "CENTER_NAME")  # fmt: skip
PASSED = {  # keywords outside of sections, by their beginnings
    "EULER_": "Euler angles", "ROTATION_": "Euler angles", "RATE_FRAME": "rates", "X_": "Euler angles",
    "Y_": "Euler angles", "Z_": "Euler angles", "SPIN_": "spin", "NUTATION": "spin", "INERTIA_": "inertia",
    "I1": "inertia", "I2": "inertia", "I3": "inertia", "IXX": "inertia", "IYY": "inertia", "IZZ": "inertia",
    "IXY": "inertia", "IXZ": "inertia", "IYZ": "inertia", "ANGVEL_": "rates", "Q1_DOT": "rates", "Q2_DOT": "rates",
    "Q3_DOT": "rates", "QC_DOT": "rates", "USER_DEFINED": "what users have defined",
}  # fmt: skip


def read_apm(path: str | Path) -> AttitudeRows:
    """Read an APM, as a single row. RecordingError, in one sentence with the line, for what is none, is malformed, has
    manoeuvres or no quaternion."""
    words, passed = _words(path)
    version = words["CCSDS_APM_VERS"].value[:1] if "CCSDS_APM_VERS" in words else "2"
    if version not in ("1", "2"):
        raise RecordingError(f"{path} is an APM of version {version}; known are 1 and 2")
    if not any(key in words for key in COMPONENTS):
        raise RecordingError(f"{path} has no quaternion, and an attitude in another form is not read")
    needed(words, REQUIRED, path)
    system = words["TIME_SYSTEM"].value.upper()
    try:
        instant = tai(words["EPOCH"].value, system)
    except DateError as error:
        raise RecordingError(f"{path}, line {words['EPOCH'].line}: {error}") from None
    q, mended = unit_length(np.array([[number(words[key], key, "", path) for key in COMPONENTS]]),
                            [words["Q1"].line], path)  # fmt: skip
    frame, of_body = direction(words, version, path)
    q = q * ([1.0, 1.0, 1.0, 1.0] if of_body else [-1.0, -1.0, -1.0, 1.0])
    notes = (
        *mended,
        *(f"{what} are passed over" if what.endswith("s") else f"{what} is passed over" for what in passed),
    )
    return AttitudeRows(words["OBJECT_NAME"].value, words["OBJECT_ID"].value, frame, system,
                        np.array([instant], np.int64), q, (0,), notes)  # fmt: skip


def _words(path: str | Path) -> tuple[dict[str, Word], tuple[str, ...]]:
    """The keywords that count, and what is passed over."""
    words: dict[str, Word] = {}
    passed: dict[str, None] = {}
    section = ""
    for line, text in ndm.lines(path, "APM"):
        upper = text.upper()
        if upper in ("META_START", "META_STOP", "QUAT_START", "QUAT_STOP"):
            continue
        begun = next((name for name in SECTIONS if upper in (f"{name}_START", f"{name}_STOP")), "")
        if begun:
            section = "" if upper.endswith("STOP") else begun
            passed[SECTIONS[begun]] = None
            continue
        if upper.startswith("MAN_"):
            raise RecordingError(f"{path}, line {line}: the message has manoeuvres ({upper[:40]}), which are not flown")
        key, word = keyword(text, line, path)
        key = OF_VERSION_1.get(key, key)
        what = next((what for begin, what in PASSED.items() if key.startswith(begin)), "")
        if section or what:
            passed[what or SECTIONS[section]] = None
        elif key in words:
            raise RecordingError(f"{path}, line {line}: {key} is there twice")
        elif key in KNOWN:
            words[key] = word
        else:
            raise RecordingError(f"{path}, line {line}: {key[:60]} is no keyword of an APM")
    return words, tuple(passed)


def write_apm(path: str | Path, rows: AttitudeRows, epoch: str, center: str = "") -> Path:
    """Write the one row of an attitude as an APM, version 2.0, from its frame to SC_BODY_1, and read it back. epoch :
    as it is written, in the time system. RecordingError where it cannot be written or does not say what it should."""
    q: Sequence[float] = np.asarray(rows.quaternion, float).ravel().tolist()
    length = float(np.linalg.norm(q))
    if len(q) != 4 or not np.isfinite(length) or length == 0.0:
        raise RecordingError("an APM holds one quaternion")
    lines = [
        "CCSDS_APM_VERS = 2.0",
        f"CREATION_DATE = {datetime.now(UTC):%Y-%m-%dT%H:%M:%S}",
        "ORIGINATOR = SAILVIZ",
        "META_START",
        f"OBJECT_NAME = {plain(rows.name) or 'CRAFT'}",
        f"OBJECT_ID = {plain(rows.identity) or 'UNKNOWN'}",
        *([f"CENTER_NAME = {plain(center)}"] if center else []),
        f"TIME_SYSTEM = {rows.time_system}",
        "META_STOP",
        f"EPOCH = {plain(epoch)}",
        "QUAT_START",
        f"REF_FRAME_A = {plain(rows.frame)}",
        "REF_FRAME_B = SC_BODY_1",
        *(f"{key} = {value / length:.15f}" for key, value in zip(COMPONENTS, q, strict=True)),
        "QUAT_STOP",
    ]

    def check(part: Path) -> None:
        back = read_apm(part)
        if np.abs(back.quaternion[0] - np.array(q) / length).max() > 3e-15 or back.instants[0] != rows.instants[0]:
            raise RecordingError(f"{path} did not come back as it was written")

    with files.writing(path, "message", check) as part:
        part.write_text("\n".join([*lines, ""]), encoding="ascii")
    return Path(path)
