"""What a recording holds, as one hash: equal for equal contents, however they were cut into chunks and whenever
written.
"""

from __future__ import annotations

import hashlib

import numpy as np
import pyarrow as pa

from sailviz.recording.contract import FILLED
from sailviz.recording.entity import ROW_ID, is_component, latest_static, strip
from sailviz.recording.reader import FilePath, Recording, read


def digest(path: FilePath | Recording) -> str:
    """SHA-256, hexadecimal, over the contents of every entity of a recording.

    Row ids, chunks, the recording's id, wall-clock timelines and the layout of the views do not count: the same scene
    run twice on one machine with one set of versions has one digest. Any bit of any number that changes, changes it.
    Points between rows, which are there for the eye alone, do not count either.
    """
    total = hashlib.sha256()
    for name, part in sorted(digest_by_entity(path).items()):
        total.update(f"{name} {part}\n".encode())
    return total.hexdigest()


def digest_by_entity(path: FilePath | Recording) -> dict[str, str]:
    """Hashes of the entities of a recording, to find out where two of them differ. "/state" -> hexadecimal."""
    recording = read(path)
    temporal: dict[tuple[str, tuple[str, ...]], list[pa.Table]] = {}
    static: dict[str, list[pa.RecordBatch]] = {}
    filled = FILLED in recording
    for chunk in recording.chunks():
        if chunk.entity_path.startswith("/__") or chunk.entity_path == FILLED:
            continue
        batch = chunk.to_record_batch()
        if filled and is_between(chunk.entity_path, batch.schema.names):
            continue
        if chunk.is_static:
            static.setdefault(chunk.entity_path, []).append(batch)
            continue
        names = tuple(sorted(name for name in batch.schema.names if name not in (ROW_ID, "log_time", "log_tick")))
        table = pa.Table.from_batches([batch.select(names)]).replace_schema_metadata(None)
        temporal.setdefault((chunk.entity_path, names), []).append(strip(table))
    hashes: dict[str, hashlib._Hash] = {}
    for (entity, _), tables in sorted(temporal.items()):
        hash_table(hashes.setdefault(entity, hashlib.sha256()), in_order_of_time(pa.concat_tables(tables)))
    for entity, batches in sorted(static.items()):
        state = hashes.setdefault(entity, hashlib.sha256())
        for name, value in sorted(latest_static(batches).items()):
            state.update(f"static {name} {value.type}".encode())
            hash_values(state, value)
    return {entity: state.hexdigest() for entity, state in hashes.items()}


def is_between(entity: str, columns: list[str]) -> bool:
    """Whether a chunk of the picture, by the names of its columns, holds points between rows, which have no step."""
    return entity.startswith(("/world", "/sail")) and "sim_time" in columns and "step" not in columns


def in_order_of_time(table: pa.Table) -> pa.Table:
    """Rows in order of all timelines, rows of one time in the order in which they were logged."""
    names = [name for name in table.column_names if not is_component(table[name].type)]
    keys = [table[name].cast(pa.int64()).to_numpy() for name in names]
    return table.take(np.lexsort(keys[::-1])) if keys and len(table) > 1 and not sorted_already(keys) else table


def sorted_already(keys: list[np.ndarray]) -> bool:
    """Whether the first timeline alone counts up."""
    return bool(np.all(keys[0][1:] > keys[0][:-1]))


def hash_table(state: hashlib._Hash, table: pa.Table) -> None:
    """Feed the columns of a table into a hash."""
    for name in table.column_names:
        state.update(f"{name} {table[name].type}".encode())
        hash_values(state, table[name].combine_chunks())


def hash_values(state: hashlib._Hash, values: pa.Array | pa.ChunkedArray) -> None:
    """Feed the bits of an Arrow array, without what its memory happens to look like, into a hash."""
    if isinstance(values, pa.ChunkedArray):
        values = pa.concat_arrays(values.chunks) if values.num_chunks else pa.array([], values.type)
    kind = values.type
    if is_component(kind):
        state.update(np.asarray(values.value_lengths().fill_null(-1), np.int64).tobytes())
        hash_values(state, values.flatten())
    elif pa.types.is_fixed_size_list(kind):
        hash_values(state, values.flatten())
    elif pa.types.is_temporal(kind):
        state.update(values.cast(pa.int64()).to_numpy(zero_copy_only=False).tobytes())
    elif pa.types.is_integer(kind) or pa.types.is_floating(kind):
        state.update(np.ascontiguousarray(values.to_numpy(zero_copy_only=False)).tobytes())
        state.update(f"{values.null_count} nulls".encode())
    elif pa.types.is_null(kind):
        state.update(f"{len(values)} nulls".encode())
    else:
        state.update(repr(values.to_pylist()).encode())
