"""Sums by which damage to a recording is found: of what each entity holds, and of the bytes of its file.

/__checksums, static, the last thing that is logged:
entities, sha256   of what each entity of the contract holds, however it is cut into chunks (`ContentSums`)
bytes, bytes_sha256   of the file up to the message that holds them; absent where there is no file

Names that begin with __ are left out of digests and comparisons: what they say follows from the rest.
"""

from __future__ import annotations

import hashlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import pyarrow as pa
import rerun as rr

from sailviz.errors import RecordingError
from sailviz.files import reason
from sailviz.recording.framing import ARROW, FRAME, Framing, Message

if TYPE_CHECKING:
    from sailviz.recording.reader import EventRow, Recording
    from sailviz.run.arrays import Event

ENTITY = "/__checksums"
PIECE = 1 << 20  # bytes hashed at once
LATEST = 8  # messages from the end among which the sums are looked for
LARGEST = 1 << 24  # bytes of the message that holds the sums, at most
LZ4 = 2
FIELDS = {2: "compression", 3: "size", 5: "payload"}  # of the protobuf message that holds a chunk


class ContentSums:
    """SHA-256 of the columns of the entities of a run, fed block by block."""

    def __init__(self) -> None:
        self._columns: dict[str, dict[str, hashlib._Hash]] = {}

    def add(self, entity: str, table: Mapping[str, np.ndarray]) -> None:
        """The next rows of an entity's columns, (n,) or (n, k) each."""
        columns = self._columns.setdefault(entity, {})
        for name, values in table.items():
            columns.setdefault(name, hashlib.sha256()).update(_bits(values))

    def result(self) -> dict[str, str]:
        """Entity -> hexadecimal."""
        sums = {}
        for entity, columns in self._columns.items():
            total = hashlib.sha256()
            for name, column in sorted(columns.items()):
                total.update(f"{name} {column.hexdigest()}\n".encode())
            sums[entity] = total.hexdigest()
        return sums


def _bits(values: np.ndarray) -> bytes:
    values = np.asarray(values)
    if values.dtype == object or values.dtype.kind in "US":
        return repr(values.tolist()).encode()
    return np.ascontiguousarray(values, np.uint8 if values.dtype == bool else np.float64).tobytes()


def sum_of_facts(facts: rr.DynamicArchetype) -> str:
    """SHA-256 of static values, as they are logged."""
    columns = {batch.component_descriptor().component: batch.as_arrow_array() for batch in facts.as_component_batches()}
    return _sum_of_static({name.rsplit(":", 1)[-1]: column.to_pylist() for name, column in columns.items()})


def _sum_of_static(values: Mapping[str, object]) -> str:
    return hashlib.sha256(repr(sorted(values.items())).encode()).hexdigest()


def sum_of_bytes(path: Path, stop: int) -> str:
    """SHA-256 of a file up to a byte. OSError where it cannot be read."""
    total, left = hashlib.sha256(), stop
    with open(path, "rb", buffering=0) as file:
        while left and (piece := file.read(min(left, PIECE))):
            total.update(piece)
            left -= len(piece)
    return total.hexdigest()


def sum_of_file(path: Path) -> tuple[int, str]:
    """How many bytes a file has by now, and their SHA-256. RecordingError where it cannot be read."""
    try:
        size = path.stat().st_size
        return size, sum_of_bytes(path, size)
    except OSError as error:
        raise RecordingError(f"cannot read {path}: {reason(error)}") from None


def facts(sums: Mapping[str, str], file_bytes: tuple[int, str] | None) -> rr.DynamicArchetype:
    """The static entity that holds the sums. file_bytes : how many bytes of the file, and their sum."""
    components = {"entities": pa.array(list(sums)), "sha256": pa.array(list(sums.values()))}
    if file_bytes is not None:
        components |= {"bytes": pa.array([file_bytes[0]]), "bytes_sha256": pa.array([file_bytes[1]])}
    return rr.DynamicArchetype("sailviz.Checksums", components=components)


@dataclass(frozen=True)
class Sums:
    """The sums that a file holds of itself. start : where the message lies that holds them, bytes."""

    entities: dict[str, str]
    start: int
    bytes: int = -1
    bytes_sha256: str = ""

    @property
    def of_this_file(self) -> bool:
        """Whether the sum of the bytes is one of this file, not of one from which it was rewritten."""
        return self.bytes == self.start


def sums_of(path: Path, frames: Framing) -> Sums | None:
    """The sums that a file holds, found without Rerun; None where there are none that can be read."""
    latest = [message for message in frames.messages[-LATEST:] if message.kind == ARROW and message.length < LARGEST]
    with open(path, "rb") as file:
        for message in reversed(latest):
            file.seek(message.start + FRAME)
            found = _sums_in(file.read(message.length), message)
            if found is not None:
                return found
    return None


def _sums_in(content: bytes, message: Message) -> Sums | None:
    try:
        batch = _batch(content)
        if batch is None or (batch.schema.metadata or {}).get(b"rerun:entity_path") != ENTITY.encode():
            return None
        batch.validate(full=True)
        values = {name.rsplit(":", 1)[-1]: batch.column(name).to_pylist()[-1] for name in batch.schema.names}
        entities = dict(zip(values["entities"], values["sha256"], strict=True))
        if "bytes" not in values:
            return Sums(entities, message.start)
        return Sums(entities, message.start, int(values["bytes"][0]), str(values["bytes_sha256"][0]))
    except (pa.ArrowException, OSError, ValueError, KeyError, IndexError, TypeError, MemoryError):
        return None  # damaged: the file then counts as one without sums


def _batch(content: bytes) -> pa.RecordBatch | None:
    """The chunk in a message; None where it is not told how."""
    fields = _fields(content)
    payload, size = fields.get("payload"), fields.get("size")
    if not isinstance(payload, bytes) or not isinstance(size, int) or not 0 < size < LARGEST:
        return None
    if fields.get("compression") == LZ4:
        payload = pa.decompress(payload, size, codec="lz4_raw")
    return pa.ipc.open_stream(payload).read_next_batch()


def _fields(content: bytes) -> dict[str, int | bytes]:
    """The fields of a protobuf message that matter here. ValueError where it is none."""
    found: dict[str, int | bytes] = {}
    place = 0
    while place < len(content):
        key, place = _number(content, place)
        value: int | bytes
        if key & 7 == 0:
            value, place = _number(content, place)
        elif key & 7 == 2:
            length, place = _number(content, place)
            value, place = content[place : place + length], place + length
        elif key & 7 == 1:
            value, place = content[place : place + 8], place + 8
        else:
            raise ValueError("not a message as Rerun writes it")
        if key >> 3 in FIELDS:
            found[FIELDS[key >> 3]] = value
    return found


def _number(content: bytes, place: int) -> tuple[int, int]:
    """A number of variable length -> the number, where the next field begins."""
    value = shift = 0
    while True:
        byte = content[place]
        value |= (byte & 0x7F) << shift
        place, shift = place + 1, shift + 7
        if byte < 0x80:
            return value, place
        if shift > 63:
            raise ValueError("a number without an end")


def check_bytes(path: Path, sums: Sums, label: str) -> None:
    """Raise RecordingError where the bytes of a file are not those that were written."""
    try:
        found = sum_of_bytes(path, sums.bytes)
    except OSError as error:
        raise RecordingError(f"cannot read {label}: {reason(error)}") from None
    if found != sums.bytes_sha256:
        raise RecordingError(
            f"{label} is damaged: it does not have the checksum with which it was written; record it again, or take a "
            f"copy"
        )


def check_contents(recording: Recording, sums: Sums) -> None:
    """Raise RecordingError, naming the entities, where columns are not those that were written."""
    wrong = [entity for entity, expected in sums.entities.items() if _content_of(recording, entity) != expected]
    if wrong:
        raise RecordingError(
            f"{recording.label} is damaged: {', '.join(wrong)} {'does' if len(wrong) == 1 else 'do'} not have the "
            f"checksum with which it was written; record it again, or take a copy"
        )


def _content_of(recording: Recording, entity: str) -> str:
    """The sum of an entity as it is read; "" where it is not there."""
    if entity not in recording:
        return ""
    if entity == "/scene":
        scene = recording[entity]
        return _sum_of_static({name: scene.arrow(name).to_pylist()[-1] for name in scene})
    total = ContentSums()
    total.add(entity, event_table(recording.events) if entity == "/events" else recording.fresh(entity))
    return total.result()[entity]


def event_table(events: Sequence[EventRow | Event]) -> dict[str, np.ndarray]:
    """Events as columns, in an order that does not depend on when they were logged."""
    ordered = sorted(events, key=lambda event: (event.time, event.name))
    return {
        "name": np.array([event.name for event in ordered], object),
        "time_s": np.array([event.time for event in ordered], float),
        "state": np.array([np.broadcast_to(event.state, 7) for event in ordered], float),
    }


def event_sum(events: Sequence[Event]) -> dict[str, str]:
    """The sum of the events of a run, {} without any."""
    total = ContentSums()
    if events:
        total.add("/events", event_table(events))
    return total.result()
