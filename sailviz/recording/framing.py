"""How a recording's file is put together, read without Rerun: a damaged file must not reach code that ends the process.

RRF2 is a head of 12 bytes, then messages (kind and length, both 64-bit little-endian, then what they hold), an end
message that holds the index, and 32 bytes that say where the index lies. Files may be written one behind the other.
"""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO

from sailviz.errors import DamagedError, RecordingError
from sailviz.files import reason, regular

MAGIC, FOOT, FOOT_AT = b"RRF2", b"RRF2FOOT", 20  # where in the last 32 bytes the word lies
NEWEST = (0, 41)  # rerun whose files are known here
HEAD, FRAME, TAIL = 12, 16, 32  # bytes of the head of a file, of the head of a message, of what follows the end message
END, STORE, ARROW, LAYOUT = KINDS = range(4)  # of messages
COMPRESSIONS, SERIALISERS = (0, 1), (2,)


@dataclass(frozen=True)
class Message:
    """One message: where its head begins, bytes; what kind it is; how many bytes it holds behind the head."""

    start: int
    kind: int
    length: int

    @property
    def stop(self) -> int:
        """Where the next one begins."""
        return self.start + FRAME + self.length


@dataclass(frozen=True)
class Framing:
    """The whole messages of a file. `cut` : the file ends before its end message, or within it."""

    size: int
    messages: tuple[Message, ...]
    cut: bool
    indexed: bool = False  # whether an index follows

    @property
    def whole(self) -> int:
        """How many bytes, from the start of the file, are whole messages."""
        return self.messages[-1].stop if self.messages else HEAD


def framing(path: Path, label: str = "") -> Framing:
    """Where the messages of a file lie. RecordingError, in one sentence, for what is no recording, was written by a
    newer Rerun, or is damaged where its messages join."""
    label = label or str(path)
    try:
        if not regular(path) and path.exists():
            raise RecordingError(f"{label} is no regular file, and a recording is read in any order")
        with open(path, "rb") as file:
            size = file.seek(0, os.SEEK_END)
            check_head(file, label)
            return _walked(file, size, label)
    except OSError as error:
        raise RecordingError(f"cannot read {label}: {reason(error)}") from None


def check_head(file: BinaryIO, label: str) -> None:
    """Raise RecordingError for what cannot be a recording, or one of a newer Rerun."""
    file.seek(0)
    head = file.read(HEAD)
    if not head:
        raise RecordingError(f"{label} is empty")
    if head[:4] != MAGIC:
        raise RecordingError(f"{label} is not a Rerun recording")
    if len(head) < HEAD:
        raise RecordingError(f"{label} was cut off before anything was recorded")
    if (head[4], head[5]) > NEWEST:
        raise RecordingError(
            f"{label} was written by Rerun {head[4]}.{head[5]}; this sailviz reads files up to {NEWEST[0]}.{NEWEST[1]}"
        )
    if head[8] not in COMPRESSIONS or head[9] not in SERIALISERS or any(head[10:]):
        raise damaged(label, 8)


def damaged(label: str, at: int) -> DamagedError:
    """The sentence for a file whose bytes make no sense from a place on."""
    return DamagedError(f"{label} is damaged and cannot be read: its bytes make no sense from number {at:,} on")


def _walked(file: BinaryIO, size: int, label: str) -> Framing:
    messages: list[Message] = []
    place, indexed = HEAD, False
    while True:
        file.seek(place)
        head = file.read(FRAME)
        if len(head) < FRAME or not any(head):  # the system fills with zeros what a crash kept from the disk
            return Framing(size, tuple(messages), True)
        message = Message(place, int.from_bytes(head[:8], "little"), int.from_bytes(head[8:], "little"))
        if message.kind not in KINDS:
            raise damaged(label, place)
        if message.stop > size:
            if _ends_well(file, size):  # nothing was cut off, so the length is wrong
                raise damaged(label, place)
            return Framing(size, tuple(messages), True)
        if message.kind != END:
            messages.append(message)
            place = message.stop
            continue
        file.seek(message.stop)
        tail = file.read(TAIL + HEAD)
        if tail[FOOT_AT : FOOT_AT + len(FOOT)] == FOOT:
            place, tail, indexed = message.stop + TAIL, tail[TAIL:], True
        elif tail and not tail.startswith(MAGIC):
            if len(tail) >= TAIL:
                raise damaged(label, message.stop)
            return Framing(size, tuple(messages), True)
        else:
            place = message.stop
        if not tail:
            return Framing(size, tuple(messages), False, indexed)
        if not tail.startswith(MAGIC):
            raise damaged(label, place)
        place += HEAD


def _ends_well(file: BinaryIO, size: int) -> bool:
    file.seek(max(size - TAIL, 0))
    return FOOT in file.read(TAIL)
