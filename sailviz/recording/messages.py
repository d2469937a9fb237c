"""What the messages of a recording's file hold, read without Rerun: a chunk, and the index at the end.

Messages are protobuf; of their fields only those with which a chunk is unpacked are looked at.
"""

from __future__ import annotations

from pathlib import Path

import pyarrow as pa

from sailviz.recording.framing import FRAME, TAIL, Framing, Message

LZ4 = 2
LARGEST = 1 << 28  # bytes of one message, unpacked, at most
INDEX, TABLE = 1, 4  # fields of the index: one for each store, and its table of chunks
PATH = b"rerun:entity_path"
Fields = list[tuple[int, int | bytes]]
# what pyarrow and the unpacking raise on bytes that make no sense
SENSELESS = (pa.ArrowException, OSError, ValueError, KeyError, IndexError, TypeError, MemoryError, OverflowError)


def chunk_in(content: bytes) -> pa.RecordBatch:
    """The chunk that a message holds. SENSELESS where it is damaged."""
    fields = dict(fields_of(content))
    return unpacked(fields.get(5), fields.get(2), fields.get(3))


def unpacked(payload: int | bytes | None, compression: int | bytes | None, size: int | bytes | None) -> pa.RecordBatch:
    """A table as Rerun packs it. SENSELESS where it is damaged."""
    if not isinstance(payload, bytes) or (compression == LZ4 and not (isinstance(size, int) and 0 < size < LARGEST)):
        raise ValueError("not packed as Rerun packs")
    if compression == LZ4:
        payload = pa.decompress(payload, size, codec="lz4_raw")
    batch = pa.ipc.open_stream(payload).read_next_batch()
    batch.validate(full=True)
    return batch


def entity_of(batch: pa.RecordBatch) -> str:
    """The entity of which a chunk holds rows, "" where that is not told."""
    return str((batch.schema.metadata or {}).get(PATH, b"").decode(errors="replace"))


def named(path: Path, frames: Framing, messages: list[Message]) -> list[str]:
    """The entities, sorted, to which messages belong: by the index at the end of the file, else by what the messages
    say of themselves. Those of which neither tells are left out."""
    index, names = _index(path, frames), set()
    with open(path, "rb") as file:
        for message in messages:
            name = index.get(message.start, "") or index.get(message.start + FRAME, "")
            if not name:
                file.seek(message.start + FRAME)
                try:
                    name = entity_of(chunk_in(file.read(message.length)))
                except SENSELESS:
                    continue
            names.add(name)
    return sorted(names - {""})


def _index(path: Path, frames: Framing) -> dict[int, str]:
    """Where the chunk of which entity begins; {} where there is no index that can be read."""
    places: dict[int, str] = {}
    try:
        with open(path, "rb") as file:
            file.seek(max(frames.size - TAIL, 0))
            tail = file.read(TAIL)
            file.seek(int.from_bytes(tail[:8], "little"))
            content = file.read(min(int.from_bytes(tail[8:16], "little"), frames.size))
        for number, store in fields_of(content):
            parts = fields_of(store) if number == INDEX and isinstance(store, bytes) else []
            for table in [dict(fields_of(part)) for key, part in parts if key == TABLE and isinstance(part, bytes)]:
                batch = unpacked(table.get(2), table.get(3), table.get(4))
                places |= dict(
                    zip(
                        batch.column("chunk_byte_offset").to_pylist(),
                        batch.column("chunk_entity_path").to_pylist(),
                        strict=True,
                    )
                )
    except SENSELESS:
        return {}
    return places


def fields_of(content: bytes) -> Fields:
    """(number, value) of the fields of a protobuf message. SENSELESS where it is none."""
    found: Fields = []
    place = 0
    while place < len(content):
        key, place = _number(content, place)
        value: int | bytes
        if key & 7 == 0:
            value, place = _number(content, place)
        elif key & 7 == 2:
            length, place = _number(content, place)
            value, place = content[place : place + length], place + length
        elif key & 7 in (1, 5):
            length = 8 if key & 7 == 1 else 4
            value, place = content[place : place + length], place + length
        else:
            raise ValueError("not a message as Rerun writes it")
        found.append((key >> 3, value))
    return found


def _number(content: bytes, place: int) -> tuple[int, int]:
    """A number of variable length -> the number, where the next field begins."""
    value = shift = 0
    while shift < 70:
        byte = content[place]
        value |= (byte & 0x7F) << shift
        place, shift = place + 1, shift + 7
        if byte < 0x80:
            return value, place
    raise ValueError("a number without an end")
