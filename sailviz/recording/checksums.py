"""Sums by which damage to a recording is found.

Each message of a file holds rows of one entity. /__checksums, static, is the last thing that is logged:
crc32   of each message before it, in their order; the first one with the head of the file
of_these   CRC-32 of those numbers
bytes   of the file before the message that holds them

A CRC-32 misses no flipped bit and no damage of up to four bytes in a row, and of other accidents one in 4e9. Names
that begin with __ are left out of digests and comparisons: what they say follows from the rest.
"""

from __future__ import annotations

import zlib
from array import array
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pyarrow as pa
import rerun as rr

from sailviz.errors import DamagedError, RecordingError
from sailviz.files import reason
from sailviz.recording.framing import ARROW, FRAME, HEAD, Framing
from sailviz.recording.messages import SENSELESS, chunk_in, entity_of, named

ENTITY = "/__checksums"
PIECE = 1 << 20  # bytes read at once
LATEST = 8  # messages from the end among which the sums are looked for
ADVICE = "record it again, or take a copy"


class RunningSums:
    """The sums of the messages of a file, fed with its bytes in pieces of any size. `count` : bytes so far."""

    def __init__(self) -> None:
        self.count = 0
        self._sums = array("I")
        self._head = bytearray()
        self._due = HEAD + FRAME  # bytes of the head that comes next
        self._left = 0  # bytes of the message that are still to come
        self._sum = 0

    def add(self, piece: bytes) -> None:
        """The next bytes."""
        view = memoryview(piece)
        self.count += len(view)
        while view:
            if len(self._head) < self._due:
                taken, view = view[: self._due - len(self._head)], view[self._due - len(self._head) :]
                self._head += taken
                if len(self._head) < self._due:
                    return
                self._sum, self._left = zlib.crc32(self._head), int.from_bytes(self._head[-8:], "little")
            taken, view = view[: self._left], view[self._left :]
            self._sum = zlib.crc32(taken, self._sum)
            self._left -= len(taken)
            if not self._left:
                self._sums.append(self._sum)
                self._head, self._due = bytearray(), FRAME

    @property
    def sums(self) -> np.ndarray:
        """Of the whole messages so far, (n,) uint32."""
        return np.array(self._sums, np.uint32)


def of_file(path: Path, stop: int | None = None) -> RunningSums:
    """The sums of the messages of a file, up to a byte if one is given. OSError where it cannot be read."""
    running, left = RunningSums(), path.stat().st_size if stop is None else stop
    with open(path, "rb", buffering=0) as file:
        while left and (piece := file.read(min(left, PIECE))):
            running.add(piece)
            left -= len(piece)
    return running


def facts(sums: np.ndarray, count: int) -> rr.DynamicArchetype:
    """The static entity that holds the sums. count : bytes of the file so far."""
    of_these = pa.array([zlib.crc32(sums.tobytes())], pa.uint32())
    components = {"crc32": pa.array(sums), "of_these": of_these, "bytes": pa.array([count])}
    return rr.DynamicArchetype("sailviz.Checksums", components=components)


@dataclass(frozen=True)
class Sums:
    """The sums that a file holds. start : where the message lies that holds them, bytes; intact : they are themselves
    as they were written; of_this_file : they are those of this file, not of one from which it was put together."""

    sums: np.ndarray
    start: int
    intact: bool
    of_this_file: bool


def sums_of(path: Path, frames: Framing) -> Sums | None:
    """The sums that a file holds, found without Rerun; None where there are none that can be read."""
    with open(path, "rb") as file:
        for place, message in reversed(list(enumerate(frames.messages))[-LATEST:]):
            if message.kind != ARROW:
                continue
            file.seek(message.start + FRAME)
            try:
                batch = chunk_in(file.read(message.length))
                if entity_of(batch) != ENTITY:
                    continue
                found = {name.rsplit(":", 1)[-1]: batch.column(name).to_pylist()[-1] for name in batch.schema.names}
                sums = np.array(found["crc32"], np.uint32)
                intact = zlib.crc32(sums.tobytes()) == found["of_these"][0]
                ours = found["bytes"][0] == message.start and len(sums) == place
            except SENSELESS:
                continue  # damaged: the file then counts as one without sums
            return Sums(sums, message.start, intact, ours)
    return None


def check(path: Path, frames: Framing, sums: Sums, label: str) -> None:
    """Raise DamagedError, naming the entities, where the bytes of a file are not those that were written."""
    if not sums.intact:
        raise DamagedError(f"{label} is damaged: its checksums are not those that were written; {ADVICE}")
    try:
        found = of_file(path, sums.start).sums
        wrong = [message for message, same in zip(frames.messages, found == sums.sums, strict=False) if not same]
        names = named(path, frames, wrong) if wrong else []
    except OSError as error:
        raise RecordingError(f"cannot read {label}: {reason(error)}") from None
    if wrong:
        what = f"{', '.join(names)} {'do' if len(names) > 1 else 'does'}" if names else "a part of it does"
        raise DamagedError(
            f"{label} is damaged: {what} not have the checksum with which it was written; {ADVICE}", names
        )
