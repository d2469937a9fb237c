"""Attitude ephemeris messages: quaternions over time (CCSDS 504.0-B, versions 1 and 2, as keywords or XML).

In version 2 a quaternion is Q1 Q2 Q3 QC, its scalar last, and turns from frame A to frame B: v_B = C v_A. With A the
frame of a run and B the craft these are the numbers of a quaternion from body to world, (x, y, z, w). Version 1 says
the order (QUATERNION_TYPE) and the direction (ATTITUDE_DIR) by keywords.
"""

from __future__ import annotations

from collections.abc import Sequence
from datetime import UTC, datetime
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sailviz import files, ndm
from sailviz.calendar import DateError, tai
from sailviz.errors import RecordingError
from sailviz.exchange.keywords import Word, finite, keyword, needed
from sailviz.exchange.opm import plain

Floats = NDArray[np.float64]

REQUIRED = ("OBJECT_NAME", "OBJECT_ID", "REF_FRAME_A", "REF_FRAME_B", "TIME_SYSTEM", "ATTITUDE_TYPE")
NUMBERS = {"QUATERNION": 4, "QUATERNION/DERIVATIVE": 8, "QUATERNION/RATE": 7, "QUATERNION/ANGVEL": 7}
NOTICED, WRONG = 1e-6, 1e-2  # by which a quaternion's length may be off 1
BODY = ("SC_BODY", "SC BODY", "SPACECRAFT_BODY", "ACTUATOR", "SENSOR", "INSTRUMENT")


class AttitudeRows(NamedTuple):
    """Attitudes over time. instants (n,) ns of TAI since 1970; quaternion (n, 4) x y z w, from body to frame; begins :
    rows with which blocks begin, between which nothing is interpolated; notes : what was mended or passed over."""

    name: str
    identity: str
    frame: str
    time_system: str
    instants: NDArray[np.int64]
    quaternion: Floats
    begins: tuple[int, ...] = (0,)
    notes: tuple[str, ...] = ()


def read_aem(path: str | Path) -> AttitudeRows:
    """Read an AEM. RecordingError, in one sentence with the line, for what is none, is malformed, has another kind of
    attitude than quaternions, or changes its frames."""
    blocks: list[tuple[dict[str, Word], list[tuple[int, str]]]] = []
    version, section = "2", "head"
    for line, text in ndm.lines(path, "AEM"):
        upper = text.upper()
        if upper == "META_START":
            blocks.append(({}, []))
            section = "meta"
        elif upper in ("META_STOP", "DATA_START", "DATA_STOP"):
            section = "data" if upper == "DATA_START" else "between"
        elif section == "head":
            key, word = keyword(text, line, path)
            version = word.value[:1] if key == "CCSDS_AEM_VERS" else version
        elif section == "meta":
            key, word = keyword(text, line, path)
            if key in blocks[-1][0]:
                raise RecordingError(f"{path}, line {line}: {key} is there twice")
            blocks[-1][0][key] = word
        elif section == "data" and blocks:
            blocks[-1][1].append((line, text))
        else:
            raise RecordingError(f"{path}, line {line}: {text[:60]!r} stands outside of a block")
    if version not in ("1", "2"):
        raise RecordingError(f"{path} is an AEM of version {version[:10]}; known are 1 and 2")
    blocks = [block for block in blocks if block[1]]
    if not blocks:
        raise RecordingError(f"{path} holds no attitudes")
    return _joined([_block(meta, rows, version, path) for meta, rows in blocks], path)


def _block(meta: dict[str, Word], rows: list[tuple[int, str]], version: str, path: str | Path) -> AttitudeRows:
    needed(meta, REQUIRED, path)
    kind = meta["ATTITUDE_TYPE"].value.upper().replace(" ", "")
    if kind not in NUMBERS:
        raise RecordingError(f"{path}, line {meta['ATTITUDE_TYPE'].line}: an attitude of type {kind[:40]} is not read; "
                             f"known: {', '.join(NUMBERS)}")  # fmt: skip
    system = meta["TIME_SYSTEM"].value.upper()
    instants, values = [], []
    for line, text in rows:
        epoch, *words = text.split()
        if len(words) != NUMBERS[kind]:
            raise RecordingError(f"{path}, line {line}: an epoch and {NUMBERS[kind]} numbers were due: {text[:80]!r}")
        try:
            instants.append(tai(epoch, system))
        except DateError as error:
            raise RecordingError(f"{path}, line {line}: {error}") from None
        numbers = [finite(word, "an attitude", line, path) for word in words]
        if len(instants) > 1 and instants[-1] <= instants[-2]:
            raise RecordingError(f"{path}, line {line}: epochs must increase")
        values.append(numbers)
    q = np.array(values)
    scalar_first = version == "1" and meta["QUATERNION_TYPE"].value.upper() == "FIRST" \
        if "QUATERNION_TYPE" in meta else False  # fmt: skip
    q = np.roll(q[:, :4], -1, axis=1) if scalar_first else q[:, :4]
    q, notes = unit_length(q, [line for line, _ in rows], path)
    if NUMBERS[kind] > 4:
        notes.append("rates are passed over")
    frame, of_body = direction(meta, version, path)
    q = q * ([1.0, 1.0, 1.0, 1.0] if of_body else [-1.0, -1.0, -1.0, 1.0])
    return AttitudeRows(
        meta["OBJECT_NAME"].value, meta["OBJECT_ID"].value, frame, system, np.array(instants, np.int64), q, (0,),
        tuple(notes),
    )  # fmt: skip


def unit_length(q: Floats, lines: Sequence[int], path: str | Path) -> tuple[Floats, list[str]]:
    """Quaternions (n, 4) of length 1, and a sentence where they were brought to it. RecordingError, with the line of
    the worst, where they are no attitudes."""
    with np.errstate(over="ignore"):
        length = np.linalg.norm(q, axis=1)
    worst = int(np.argmax(np.abs(length - 1.0)))
    if abs(length[worst] - 1.0) > WRONG:
        raise RecordingError(f"{path}, line {lines[worst]}: a quaternion of length {length[worst]:.6g}, and 1 is due")
    return q / length[:, None], ["quaternions were brought to length 1"] if abs(length[worst] - 1.0) > NOTICED else []


def direction(meta: dict[str, Word], version: str, path: str | Path) -> tuple[str, bool]:
    """The frame that is not the craft's, and whether the quaternions turn from it to the craft (so that they are those
    from body to world)."""
    a, b = (meta[f"REF_FRAME_{side}"].value.upper() for side in "AB")
    craft = [word.startswith(BODY) for word in (a, b)]
    if craft[0] == craft[1]:
        raise RecordingError(f"{path}: of the frames {a} and {b} one is due that belongs to the craft, such as SC_BODY")
    way = meta["ATTITUDE_DIR"].value.upper() if version == "1" and "ATTITUDE_DIR" in meta else "A2B"
    if way not in ("A2B", "B2A"):
        raise RecordingError(f"{path}: ATTITUDE_DIR is A2B or B2A, not {way[:20]}")
    return (b if craft[0] else a), craft[1] == (way == "A2B")


def _joined(blocks: Sequence[AttitudeRows], path: str | Path) -> AttitudeRows:
    """All blocks as one; where one ends at the instant at which the next begins the later row counts."""
    frames = {(block.frame, block.time_system) for block in blocks}
    if len(frames) > 1:
        told = ", ".join(sorted(" ".join(pair) for pair in frames))
        raise RecordingError(f"{path} changes its frame or time system: {told}")
    instants, parts, begins, rows = [], [], [], 0
    for k, block in enumerate(blocks):
        last = len(block.instants)
        if k + 1 < len(blocks):
            after = blocks[k + 1].instants[0]
            if after < block.instants[0]:
                raise RecordingError(f"{path}: its blocks are not in order of time")
            last = int(np.searchsorted(block.instants, after))
        if last:
            begins.append(rows)
            instants.append(block.instants[:last])
            parts.append(block.quaternion[:last])
            rows += last
    notes = dict.fromkeys(note for block in blocks for note in block.notes)
    first = blocks[0]
    q = _continuous(np.concatenate(parts))
    return AttitudeRows(
        first.name, first.identity, first.frame, first.time_system, np.concatenate(instants), q, tuple(begins),
        tuple(notes),
    )  # fmt: skip


def _continuous(quaternion: Floats) -> Floats:
    """The same attitudes, each quaternion of the sign that is nearer to the one before."""
    if len(quaternion) < 2:
        return quaternion
    turned = np.sum(quaternion[1:] * quaternion[:-1], axis=1) < 0
    sign = np.where(np.concatenate([[False], np.cumsum(turned) % 2 == 1]), -1.0, 1.0)
    found: Floats = quaternion * sign[:, None]
    return found


def write_aem(path: str | Path, rows: AttitudeRows, epochs: Sequence[str], center: str = "") -> Path:
    """Write an AEM, version 2.0, from the frame to SC_BODY_1, and read it back. epochs (n,) : the instants as they are
    written, in the time system. RecordingError where it cannot be written or does not say what it should."""
    q = np.asarray(rows.quaternion, float)
    length = np.linalg.norm(q, axis=1, keepdims=True)
    if not (np.isfinite(q).all() and np.all(length > 0)):
        raise RecordingError("an AEM holds quaternions, and of a row there is none")
    q = _continuous(q / length)
    lines = ["CCSDS_AEM_VERS = 2.0", f"CREATION_DATE = {datetime.now(UTC):%Y-%m-%dT%H:%M:%S}", "ORIGINATOR = SAILVIZ"]
    for begin, end in zip(rows.begins, [*rows.begins[1:], len(q)], strict=True):
        lines += [
            "",
            "META_START",
            f"OBJECT_NAME = {plain(rows.name) or 'CRAFT'}",
            f"OBJECT_ID = {plain(rows.identity) or 'UNKNOWN'}",
            *([f"CENTER_NAME = {plain(center)}"] if center else []),
            f"REF_FRAME_A = {plain(rows.frame)}",
            "REF_FRAME_B = SC_BODY_1",
            f"TIME_SYSTEM = {rows.time_system}",
            f"START_TIME = {epochs[begin]}",
            f"STOP_TIME = {epochs[end - 1]}",
            "ATTITUDE_TYPE = QUATERNION",
            "META_STOP",
            "",
            "DATA_START",
            *(f"{epochs[k]} " + " ".join(f"{value: .15f}" for value in q[k]) for k in range(begin, end)),
            "DATA_STOP",
        ]

    def check(part: Path) -> None:
        back = read_aem(part)
        if len(back.quaternion) != len(q) or np.abs(back.quaternion - q).max() > 3e-15:
            raise RecordingError(f"{path} did not come back as it was written")

    with files.writing(path, "message", check) as part:
        part.write_text("\n".join([*lines, ""]), encoding="ascii")
    return Path(path)
