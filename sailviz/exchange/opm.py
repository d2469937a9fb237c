"""Orbit parameter messages: one state of a craft, with its mass and areas (CCSDS 502.0-B-3, as keywords or XML).

    found = read_opm("state.opm")
    found.position, found.velocity, found.epoch

Manoeuvres are refused by name: what they change is not flown here. Keplerian elements, covariance and what users have
defined are passed over, and said so.
"""

from __future__ import annotations

from datetime import UTC, datetime
from pathlib import Path
from typing import NamedTuple

from sailviz import files, ndm
from sailviz.calendar import DateError, tai
from sailviz.errors import RecordingError
from sailviz.exchange.keywords import Word, keyword, needed, number

Three = tuple[float, float, float]

STATE = ("X", "Y", "Z", "X_DOT", "Y_DOT", "Z_DOT")
REQUIRED = ("OBJECT_NAME", "OBJECT_ID", "CENTER_NAME", "REF_FRAME", "TIME_SYSTEM", "EPOCH", *STATE)
CRAFT = {  # what a message may say of the craft: its unit
    "MASS": "kg", "SOLAR_RAD_AREA": "m**2", "SOLAR_RAD_COEFF": "", "DRAG_AREA": "m**2", "DRAG_COEFF": "",
}  # fmt: skip
ELEMENTS = ("SEMI_MAJOR_AXIS", "ECCENTRICITY", "INCLINATION", "RA_OF_ASC_NODE", "ARG_OF_PERICENTER", "TRUE_ANOMALY",
            "MEAN_ANOMALY", "GM")  # fmt: skip
HEAD = ("CCSDS_OPM_VERS", "CREATION_DATE", "ORIGINATOR", "MESSAGE_ID", "CLASSIFICATION")
LONGEST_VALUE = 200


class OrbitParameters(NamedTuple):
    """One state. instant : ns of TAI since 1970; epoch : as it is written, in time_system; position m, velocity m/s in
    frame about center; mass kg, areas m2, None where they are not given; notes : what was passed over."""

    name: str
    identity: str
    center: str
    frame: str
    time_system: str
    epoch: str
    instant: int
    position: Three
    velocity: Three
    mass: float | None = None
    solar_area: float | None = None
    solar_coefficient: float | None = None
    drag_area: float | None = None
    drag_coefficient: float | None = None
    notes: tuple[str, ...] = ()


def read_opm(path: str | Path) -> OrbitParameters:
    """Read an OPM. RecordingError, in one sentence with the line, for what is none, is malformed, or has manoeuvres."""
    words, passed = _words(path)
    needed(words, REQUIRED, path)
    system = words["TIME_SYSTEM"].value.upper()
    try:
        instant = tai(words["EPOCH"].value, system)
    except DateError as error:
        raise RecordingError(f"{path}, line {words['EPOCH'].line}: {error}") from None
    x, y, z, vx, vy, vz = (
        1e3 * number(words[key], key, "km/s" if key.endswith("_DOT") else "km", path) for key in STATE
    )
    if not (x or y or z):
        raise RecordingError(f"{path}: the craft stands in the centre of {words['CENTER_NAME'].value}")
    mass, solar, solar_c, drag, drag_c = (
        number(words[key], key, unit, path) if key in words else None for key, unit in CRAFT.items()
    )
    for key, value in (("MASS", mass), ("SOLAR_RAD_AREA", solar), ("DRAG_AREA", drag)):
        if value is not None and value < 0.0:
            raise RecordingError(f"{path}, line {words[key].line}: {key} is negative")
    return OrbitParameters(
        words["OBJECT_NAME"].value, words["OBJECT_ID"].value, words["CENTER_NAME"].value.upper(),
        words["REF_FRAME"].value.upper(), system, words["EPOCH"].value, instant, (x, y, z), (vx, vy, vz),
        mass, solar, solar_c, drag, drag_c, passed,
    )  # fmt: skip


def _words(path: str | Path) -> tuple[dict[str, Word], tuple[str, ...]]:
    """The keywords that count, and sentences about those that do not."""
    words: dict[str, Word] = {}
    passed: dict[str, None] = {}
    for line, text in ndm.lines(path, "OPM"):
        if text.upper() in ("META_START", "META_STOP"):
            continue
        key, word = keyword(text, line, path)
        if key.startswith("MAN_"):
            raise RecordingError(f"{path}, line {line}: the message has manoeuvres ({key}), which are not flown here")
        if key == "REF_FRAME_EPOCH":
            raise RecordingError(f"{path}, line {line}: a frame with an epoch of its own (REF_FRAME_EPOCH) is not read")
        if key in ELEMENTS:
            passed["Keplerian elements are passed over: the state counts"] = None
        elif key.startswith(("C", "COV_")) and key not in (*HEAD, "CENTER_NAME"):
            passed["covariances are passed over"] = None
        elif key.startswith("USER_DEFINED"):
            passed["what users have defined is passed over"] = None
        elif key in words:
            raise RecordingError(f"{path}, line {line}: {key} is there twice")
        elif key in (*HEAD, *REQUIRED, *CRAFT):
            words[key] = word
        else:
            raise RecordingError(f"{path}, line {line}: {key[:60]} is no keyword of an OPM")
    return words, tuple(passed)


def write_opm(path: str | Path, state: OrbitParameters) -> Path:
    """Write an OPM, version 2.0, with the digits of its numbers, and read it back. RecordingError where it cannot be
    written or does not say what it should."""
    lines = [
        "CCSDS_OPM_VERS = 2.0",
        f"CREATION_DATE = {datetime.now(UTC):%Y-%m-%dT%H:%M:%S}",
        "ORIGINATOR = SAILVIZ",
        f"OBJECT_NAME = {plain(state.name) or 'CRAFT'}",
        f"OBJECT_ID = {plain(state.identity) or 'UNKNOWN'}",
        f"CENTER_NAME = {plain(state.center)}",
        f"REF_FRAME = {plain(state.frame)}",
        f"TIME_SYSTEM = {plain(state.time_system)}",
        f"EPOCH = {plain(state.epoch)}",
    ]
    values = [value / 1e3 for value in (*state.position, *state.velocity)]
    units = ["km"] * 3 + ["km/s"] * 3
    lines += [f"{key} = {value:.15e} [{unit}]" for key, value, unit in zip(STATE, values, units, strict=True)]
    craft = (state.mass, state.solar_area, state.solar_coefficient, state.drag_area, state.drag_coefficient)
    for (key, unit), amount in zip(CRAFT.items(), craft, strict=True):
        if amount is not None:
            lines.append(f"{key} = {amount:.15e}" + (f" [{unit}]" if unit else ""))

    def check(part: Path) -> None:
        back = read_opm(part)
        pairs = zip((*back.position, *back.velocity), (*state.position, *state.velocity), strict=True)
        if back.instant != state.instant or any(abs(a - b) > 1e-14 * abs(b) for a, b in pairs):
            raise RecordingError(f"{path} did not come back as it was written")

    with files.writing(path, "message", check) as part:
        part.write_text("\n".join([*lines, ""]), encoding="ascii")
    return Path(path)


def plain(text: str) -> str:
    """A text as one line of a message can hold it: ASCII, no control characters, no keyword at its beginning."""
    kept = "".join(c if c.isascii() and c.isprintable() else "?" if c.isprintable() else " " for c in text)
    kept = " ".join(kept.split())[:LONGEST_VALUE]
    return f"- {kept}" if kept.upper().startswith(("COMMENT", "META_", "DATA_", "COVARIANCE_")) else kept
