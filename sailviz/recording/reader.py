"""Recordings read back as numpy. Needs rerun, pyarrow and numpy, nothing that draws or simulates."""

from __future__ import annotations

import difflib
import json
import tempfile
import warnings
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np
import pyarrow as pa
from rerun.chunk import RrdReader

from sailviz.errors import RecordingError

MAGIC = b"RRF2"
NEWEST = (0, 41)  # rerun whose files are known here
FRAME = 16  # bytes of a message's head: kind and length of what follows, both 64-bit little-endian
ROW_ID = "rerun.controls.RowId"
TIMELINES = ("step", "sim_time", "utc")


def read(path) -> Recording:
    """Open a recording. Cheap: columns are read when they are asked for.

    A file that was cut off is read as far as its last whole message (`complete` is then False).
    Raises RecordingError, in one sentence, for what is not a recording or was written by a newer rerun.
    """
    return Recording(Path(path))


class Recording:
    """A recording on disk. `rec["/state"]["position_m"]` is (n, 3) float64, as it was in the run, bit for bit."""

    def __init__(self, path: Path):
        self.path = path
        self._whole = None  # a temporary file that keeps the whole messages of one that was cut off
        check_head(path)
        self._reader = self._open(path)

    def __getitem__(self, entity: str) -> Entity:
        name = "/" + entity.strip("/")
        if name not in self.entities:
            near = difflib.get_close_matches(name, self.entities, 1, 0.4)
            hint = f"; did you mean {near[0]}?" if near else ""
            raise KeyError(f"{self.path} has no entity {name}{hint}")
        if name not in self._tables:
            self._tables[name] = Entity(name, self._chunks(name))
        return self._tables[name]

    def __contains__(self, entity: str) -> bool:
        return "/" + entity.strip("/") in self.entities

    def __repr__(self) -> str:
        return f"<Recording {self.path}: {len(self.entities)} entities>"

    @cached_property
    def entities(self) -> tuple[str, ...]:
        """Paths of everything that was recorded, sorted: the truth (/state, ...), the plots and the picture."""
        if self._store is not None:
            lines = self._store.summary().splitlines()
            names = {line.split(" rows=")[0].strip() for line in lines if line.strip()}
        else:
            names = {chunk.entity_path for chunk in self._stream()}
        return tuple(sorted(name for name in names if not name.startswith("/__")))

    @property
    def application_id(self) -> str:
        """`sailviz_<family>_<start of the identity>`, or the name of the application that wrote the file."""
        return self._reader.recordings()[0].application_id

    @property
    def scene_text(self) -> str:
        """The scene file that was run, word for word."""
        return self._scene("text", "")

    @property
    def resolved(self) -> dict:
        """Every value of the scene, SI."""
        return json.loads(self._scene("resolved", "{}"))

    @property
    def versions(self) -> dict[str, str]:
        return json.loads(self._scene("versions", "{}"))

    @property
    def accuracy(self) -> str:
        """How the numbers were made."""
        return self._scene("accuracy", "")

    @property
    def identity(self) -> str:
        """Hash of the resolved scene."""
        return self._scene("identity", "")

    @property
    def contract(self) -> str:
        """`sailviz/1`, or "" for a recording by another application."""
        return self._scene("contract", "")

    @property
    def complete(self) -> bool:
        """False where the run was interrupted or the file was cut off."""
        return bool(self._scene("complete", False)) and self._whole is None

    @property
    def events(self) -> list[EventRow]:
        """What happened, in order of time."""
        if "/events" not in self:
            return []
        table = self["/events"]
        names, times, states, steps = table["name"], table["time_s"], table["state"], table.timeline("step")
        order = np.argsort(times, kind="stable")
        return [EventRow(str(names[i]), float(times[i]), states[i], int(steps[i])) for i in order]

    @cached_property
    def _tables(self) -> dict[str, Entity]:
        return {}

    def _scene(self, name: str, otherwise):
        if "/scene" not in self:
            return otherwise
        scene = self["/scene"]
        return scene[name][0] if name in scene else otherwise

    @cached_property
    def _store(self):
        """The file's index, None for a file that was cut off."""
        return None if self._whole else self._reader.store()

    def _stream(self):
        return self._reader.stream() if self._store is None else self._store.stream()

    def _chunks(self, entity: str) -> list:
        return list(self._stream().filter(content=entity))

    def _open(self, path: Path):
        try:
            reader = open_quietly(path)
            if not reader.recordings():
                raise RecordingError(f"{path} holds no recording")
            reader.store()
            return reader
        except (RuntimeError, ValueError):
            pass
        whole = whole_messages(path)
        self._whole = tempfile.NamedTemporaryFile(suffix=".rrd")  # noqa: SIM115, lives as long as the Recording
        self._whole.write(path.read_bytes()[:whole])
        self._whole.flush()
        try:
            reader = open_quietly(Path(self._whole.name))
            if reader.recordings():
                return reader
        except (RuntimeError, ValueError) as error:
            raise RecordingError(f"{path} cannot be read: {str(error).splitlines()[0]}") from None
        raise RecordingError(f"{path} was cut off before anything was recorded")


class Entity(Mapping):
    """Columns of one entity by name, numpy, in order of `step`; made when asked for."""

    def __init__(self, path: str, chunks: list):
        self.path = path
        batches = [chunk.to_record_batch() for chunk in chunks if not chunk.is_static]
        self._static = latest_static([chunk.to_record_batch() for chunk in chunks if chunk.is_static])
        self._tables = group_by_columns(batches)
        self._names = {}
        for table in self._tables:
            self._names.update({short(name): name for name in table.column_names if ":" in name})
        self._names.update({short(name): name for name in self._static})

    def __getitem__(self, name: str) -> np.ndarray:
        if name not in self._names:
            near = difflib.get_close_matches(name, self._names, 1, 0.4)
            hint = f"; did you mean {near[0]}?" if near else f"; it has {', '.join(self._names)}"
            raise KeyError(f"{self.path} has no column {name}{hint}")
        full = self._names[name]
        for table in self._tables:
            if full in table.column_names:
                return to_numpy(table[full])
        return to_numpy(self._static[full])

    def __iter__(self):
        return iter(self._names)

    def __len__(self) -> int:
        return len(self._names)

    def timeline(self, name: str = "step") -> np.ndarray:
        """The rows' place on a timeline: step int64, sim_time timedelta64[ns], utc datetime64[ns]."""
        for table in self._tables:
            if name in table.column_names:
                return table[name].to_numpy()
        raise KeyError(f"{self.path} is not on a timeline {name}")


@dataclass(frozen=True)
class EventRow:
    """An event as recorded. time s, state (7,) position m, velocity m/s, mass kg, step the row at or after it."""

    name: str
    time: float
    state: np.ndarray
    step: int


def short(name: str) -> str:
    """sailviz.State:position_m -> position_m."""
    return name.rsplit(":", 1)[-1]


def open_quietly(path: Path):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # a file without a footer is our business, not the caller's
        return RrdReader(str(path))


def check_head(path: Path) -> None:
    """Raise RecordingError for what cannot be a recording, or one of a newer rerun."""
    try:
        with open(path, "rb") as file:
            head = file.read(12)
    except OSError as error:
        raise RecordingError(f"cannot read {path}: {error.strerror.lower()}") from None
    if not head:
        raise RecordingError(f"{path} is empty")
    if head[:4] != MAGIC:
        raise RecordingError(f"{path} is not a Rerun recording")
    if len(head) < 12:
        raise RecordingError(f"{path} was cut off before anything was recorded")
    if (head[4], head[5]) > NEWEST:
        raise RecordingError(
            f"{path} was written by Rerun {head[4]}.{head[5]}; this sailviz reads files up to {NEWEST[0]}.{NEWEST[1]}"
        )


def whole_messages(path: Path) -> int:
    """How many bytes of a file that was cut off are whole messages."""
    size, end = path.stat().st_size, 12
    with open(path, "rb") as file:
        while end + FRAME <= size:
            file.seek(end + 8)
            length = int.from_bytes(file.read(8), "little")
            if end + FRAME + length > size:
                break
            end += FRAME + length
    return end


def latest_static(batches: list[pa.RecordBatch]) -> dict[str, pa.Array]:
    """Of static columns the value logged last: row ids count up in time."""
    latest: dict[str, tuple[bytes, pa.Array]] = {}
    for batch in batches:
        for row, row_id in enumerate(batch.column(ROW_ID).to_pylist()):
            for name in batch.schema.names:
                if name == ROW_ID or not batch.column(name)[row].is_valid:
                    continue
                if name not in latest or row_id > latest[name][0]:
                    latest[name] = (row_id, batch.column(name).slice(row, 1))
    return {name: value for name, (_, value) in latest.items()}


def group_by_columns(batches: list[pa.RecordBatch]) -> list[pa.Table]:
    """Batches of the same columns as one table each, rows in order of the first timeline."""
    groups: dict[tuple, list] = {}
    for batch in batches:
        names = tuple(sorted(name for name in batch.schema.names if name != ROW_ID))
        groups.setdefault(names, []).append(pa.Table.from_batches([batch.select(names).replace_schema_metadata(None)]))
    return [in_order(pa.concat_tables([strip(table) for table in tables])) for tables in groups.values()]


def strip(table: pa.Table) -> pa.Table:
    """Without metadata on the fields, so that tables of different chunks can be joined."""
    return table.cast(pa.schema([pa.field(field.name, field.type) for field in table.schema]))


def in_order(table: pa.Table) -> pa.Table:
    for name in (*TIMELINES, *table.column_names):
        if name in table.column_names and not is_component(table[name].type):
            index = table[name].cast(pa.int64()).to_numpy()
            return table if np.all(index[1:] >= index[:-1]) else table.take(np.argsort(index, kind="stable"))
    return table


def is_component(kind: pa.DataType) -> bool:
    return pa.types.is_list(kind) or pa.types.is_large_list(kind)


def to_numpy(column) -> np.ndarray:
    """A component column with k values a row -> (n,) for k = 1, (n, k) for k > 1, objects where rows differ in k."""
    column = column.combine_chunks() if isinstance(column, pa.ChunkedArray) else column
    rows = len(column)
    counts = np.asarray(column.value_lengths().fill_null(0))
    if not np.all(counts == 1):
        same = rows and np.all(counts == counts[0])
        if not same:
            values = np.empty(rows, object)
            values[:] = [to_numpy_values(pa.array(row.values)) if row.is_valid else None for row in column]
            return values
    values = to_numpy_values(column.flatten())
    return values if rows and counts[0] == 1 else values.reshape(rows, counts[0] if rows else 0, *values.shape[1:])


def to_numpy_values(values: pa.Array) -> np.ndarray:
    """Arrow values -> numpy; fixed-size lists become a further dimension, strings and structures objects."""
    if pa.types.is_fixed_size_list(values.type):
        inner = to_numpy_values(values.flatten())
        return inner.reshape(len(values), values.type.list_size, *inner.shape[1:])
    if pa.types.is_string(values.type) or pa.types.is_nested(values.type):
        objects = np.empty(len(values), object)
        objects[:] = values.to_pylist()
        return objects
    return values.to_numpy(zero_copy_only=False)
