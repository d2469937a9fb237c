"""Double precision array files, the container of SPICE kernels: arrays of numbers, each with a summary and a name.

A file is made of records of 1024 bytes: the file record, lines of comment, pairs of summary and name records, then the
arrays, whose addresses count doubles from 1. Source: NAIF, "DAF Required Reading" (layout; read), the summaries' form
after our own files against CSPICE.
"""

from __future__ import annotations

import struct
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from sailviz import files
from sailviz.errors import RecordingError

RECORD = 1024  # bytes
WORDS = RECORD // 8
IN_A_RECORD = 1000  # characters of comment, the rest of a record stays empty
END_OF_LINE, END_OF_COMMENTS = b"\0", b"\4"
DOUBLES, INTEGERS = 2, 6  # of a summary, in SPK and CK alike
SUMMARY = DOUBLES + INTEGERS // 2  # words
SUMMARIES = 25  # in a record, after its three words of control
NAME = 8 * SUMMARY  # characters
TRANSFERRED = b"FTPSTR:\r:\n:\r\n:\r\x00:\x81:\x10\xce:ENDFTP"  # shows whether a transfer as text has spoilt a file
TRANSFERRED_AT = 699  # byte
LONGEST_FILE = 4_000_000_000  # bytes


@dataclass(frozen=True)
class Array:
    """One array of a file. span : its two doubles, s of TDB after J2000 or ticks of a clock; numbers : its integers but
    the two addresses; values (n,) float64."""

    name: str
    span: tuple[float, float]
    numbers: tuple[int, int, int, int]
    values: np.ndarray


@dataclass(frozen=True)
class ArrayFile:
    """What a file holds. kind : "SPK", "CK", ..."""

    kind: str
    internal_name: str
    comments: tuple[str, ...]
    arrays: tuple[Array, ...]


def write(
    path: str | Path, kind: str, arrays: Sequence[Array], internal_name: str = "", comments: Sequence[str] = ()
) -> Path:
    """Write a file, whole or not at all, little-endian. kind : "SPK" or "CK". OutputError where that cannot be."""
    path = Path(path)
    written = _comment_records(comments)
    pairs = max(1, -(-len(arrays) // SUMMARIES))
    first = 2 + len(written) // RECORD  # summary record, from 1
    address = (first - 1 + 2 * pairs) * WORDS + 1
    summaries, body = [], []
    for array in arrays:
        values = np.ascontiguousarray(array.values, "<f8")
        numbers = (*array.numbers, address, address + len(values) - 1)
        summaries.append(struct.pack(f"<{DOUBLES}d{INTEGERS}i", *array.span, *numbers))
        body.append(values.tobytes())
        address += len(values)
    last = first + 2 * (pairs - 1)
    parts = [_file_record(kind, internal_name, first, last, address), written]
    for pair in range(pairs):
        own = slice(pair * SUMMARIES, (pair + 1) * SUMMARIES)
        after, before = first + 2 * (pair + 1) if pair < pairs - 1 else 0, first + 2 * (pair - 1) if pair else 0
        control = struct.pack("<3d", after, before, len(summaries[own]))
        parts.append((control + b"".join(summaries[own])).ljust(RECORD, b"\0"))
        parts.append(b"".join(_text(array.name, NAME) for array in arrays[own]).ljust(RECORD))
    data = b"".join(body)
    parts += [data, bytes(-len(data) % RECORD)]
    with files.writing(path, "kernel") as part, open(part, "wb") as file:
        file.writelines(parts)
    return path


def _file_record(kind: str, internal_name: str, first: int, last: int, free: int) -> bytes:
    head = _text(f"DAF/{kind}", 8) + struct.pack("<2i", DOUBLES, INTEGERS) + _text(internal_name, 60)
    head += struct.pack("<3i", first, last, free) + b"LTL-IEEE"
    return (head.ljust(TRANSFERRED_AT, b"\0") + TRANSFERRED).ljust(RECORD, b"\0")


def _text(text: str, length: int) -> bytes:
    """Printable ASCII, blank-filled or cut."""
    kept = "".join(letter if " " <= letter <= "~" else "?" for letter in " ".join(text.split()))
    return kept[:length].ljust(length).encode("ascii")


def _comment_records(lines: Sequence[str]) -> bytes:
    if not lines:
        return b""
    kept = (line.expandtabs(4).rstrip() for line in lines)
    plain = ("".join(letter if " " <= letter <= "~" else "?" for letter in line) for line in kept)
    text = b"".join(line.encode("ascii") + END_OF_LINE for line in plain) + END_OF_COMMENTS
    records = [text[start : start + IN_A_RECORD] for start in range(0, len(text), IN_A_RECORD)]
    return b"".join(record.ljust(RECORD, b"\0") for record in records)


def read(path: str | Path) -> ArrayFile:
    """Read a file of either byte order. RecordingError, in one sentence, for what is none or is cut or damaged."""
    data = _bytes(path)
    order = _order(data, path)
    first = struct.unpack_from(f"{order}i", data, 76)[0]
    if struct.unpack_from(f"{order}2i", data, 8) != (DOUBLES, INTEGERS):
        raise RecordingError(f"{path} is a DAF with other summaries than those of an SPK or CK")
    proof = data[TRANSFERRED_AT : TRANSFERRED_AT + len(TRANSFERRED)]
    if proof[:6] == TRANSFERRED[:6] and proof != TRANSFERRED:  # files before 1999 have none
        raise RecordingError(f"{path} is damaged: it was transferred as text, not as it is")
    words = np.frombuffer(data, f"{order}f8", len(data) // 8)
    arrays, record, seen = [], first, set[int]()
    while record or not seen:
        if record in seen or not 2 <= record < len(data) // RECORD:
            raise RecordingError(f"{path} is cut off or damaged: it names a record {record} that it does not hold")
        seen.add(record)
        at = (record - 1) * RECORD
        after, _, count = struct.unpack_from(f"{order}3d", data, at)
        if not (0 <= count <= SUMMARIES and 0 <= after <= len(data)):
            raise RecordingError(f"{path} is damaged: its record {record} holds no summaries")
        for k in range(int(count)):
            name = data[at + RECORD + k * NAME : at + RECORD + (k + 1) * NAME].decode("ascii", "replace").strip()
            found = struct.unpack_from(f"{order}{DOUBLES}d{INTEGERS}i", data, at + 24 + 8 * SUMMARY * k)
            begin, end = found[-2:]
            if not 1 <= begin <= end <= len(words):
                raise RecordingError(f"{path} is cut off or damaged: an array of it lies outside")
            values = np.asarray(words[begin - 1 : end], float)
            arrays.append(Array(name, found[:2], found[2:6], values))
        record = int(after)
    kind = data[4:8].decode("ascii", "replace").strip()
    inside = data[16:76].decode("ascii", "replace").strip()
    return ArrayFile(kind, inside, _comments(data[RECORD : (first - 1) * RECORD]), tuple(arrays))


def _bytes(path: str | Path) -> bytes:
    found = Path(path)
    if found.exists() and not found.is_file():  # a pipe or a device may never end
        raise RecordingError(f"cannot read {path}: it is not a regular file")
    try:
        if found.stat().st_size > LONGEST_FILE:
            raise RecordingError(f"{path} has more than {LONGEST_FILE / 1e9:g} GB")
        return found.read_bytes()
    except OSError as error:
        raise RecordingError(f"cannot read {path}: {files.reason(error)}") from None


def _order(data: bytes, path: str | Path) -> str:
    """ "<" or ">" as struct has it."""
    if data.startswith(b"DAFETF") or data.startswith(b"'DAFETF"):
        raise RecordingError(f"{path} is a kernel in transfer form: turn it into a binary one with NAIF's tobin")
    if not data.startswith(b"DAF/"):
        raise RecordingError(f"{path} is no binary kernel: it does not begin with DAF/")
    if len(data) < 3 * RECORD:
        raise RecordingError(f"{path} is cut off")
    orders = {b"LTL-IEEE": "<", b"BIG-IEEE": ">"}
    if data[88:96] not in orders:
        raise RecordingError(f"{path} holds numbers in a form that is not known here: {data[88:96]!r}")
    return orders[data[88:96]]


def _comments(data: bytes) -> tuple[str, ...]:
    text = b"".join(data[at : at + IN_A_RECORD] for at in range(0, len(data), RECORD))
    text = text.split(END_OF_COMMENTS)[0].rstrip(b"\0")
    return tuple(line.decode("ascii", "replace") for line in text.split(END_OF_LINE)) if text else ()
