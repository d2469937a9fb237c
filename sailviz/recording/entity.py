"""One entity of a recording: its columns, out of the pieces in which rerun keeps them, as numpy."""

from __future__ import annotations

import difflib
from collections.abc import Iterator, Mapping

import numpy as np
import pyarrow as pa
import pyarrow.compute
from rerun.chunk import Chunk

from sailviz.words import unit_of

ROW_ID = "rerun.controls.RowId"
TIMELINES = ("step", "sim_time", "utc")


class Entity(Mapping[str, np.ndarray]):
    """Columns of one entity by name, numpy, in order of `step`; made when asked for."""

    def __init__(self, path: str, chunks: list[Chunk]):
        self.path = path
        batches = [chunk.to_record_batch() for chunk in chunks if not chunk.is_static]
        self._static = latest_static([chunk.to_record_batch() for chunk in chunks if chunk.is_static])
        self.tables = group_by_columns(batches)
        self._names: dict[str, str] = {}
        for table in self.tables:
            self._names.update({short(name): name for name in table.column_names if ":" in name})
        self._names.update({short(name): name for name in self._static})

    def __getitem__(self, name: str) -> np.ndarray:
        return to_numpy(self.arrow(name))

    def __iter__(self) -> Iterator[str]:
        return iter(self._names)

    def __len__(self) -> int:
        return len(self._names)

    __eq__ = object.__eq__
    __hash__ = object.__hash__

    def __repr__(self) -> str:
        rows = max((len(table) for table in self.tables), default=0)
        return f"<Entity {self.path}, {counted(rows)}: {self.described()}>"

    def arrow(self, name: str) -> pa.Array | pa.ChunkedArray:
        """A column as Arrow keeps it. KeyError, with the nearest name, where there is none."""
        if name not in self._names:
            near = difflib.get_close_matches(name, self._names, 1, 0.4)
            hint = f"; did you mean {near[0]}?" if near else f"; it has {', '.join(self._names)}"
            raise KeyError(f"{self.path} has no column {name}{hint}")
        full = self._names[name]
        for table in self.tables:
            if full in table.column_names:
                return table[full]
        return self._static[full]

    def timeline(self, name: str = "step") -> np.ndarray:
        """The rows' place on a timeline: step int64, sim_time timedelta64[ns], utc datetime64[ns]."""
        for table in self.tables:
            if name in table.column_names:
                values: np.ndarray = table[name].to_numpy()
                return values
        raise KeyError(f"{self.path} is not on a timeline {name}")

    @property
    def timelines(self) -> tuple[str, ...]:
        """Those on which its rows stand."""
        return tuple(name for name in TIMELINES if any(name in table.column_names for table in self.tables))

    def described(self) -> str:
        """Its columns with shapes and units: "time_s (n,) s, position_m (n, 3) m"; of a static one the names alone."""
        if not self.tables:
            return ", ".join(self)
        return ", ".join(f"{name} {shape_of(self.arrow(name))} {unit_of(name)}".rstrip() for name in self)


def counted(rows: int) -> str:
    """How many rows, in words."""
    return {0: "static", 1: "1 row"}.get(rows, f"{rows} rows")


def shape_of(column: pa.Array | pa.ChunkedArray) -> str:
    """The shape of a component column as numpy in words, n rows: "(n,)", "(n, 3)", "(n, ...)" where rows differ."""
    counts = set(pa.compute.unique(pa.compute.list_value_length(column)).to_pylist())
    kind, sizes = column.type.value_type, []
    while pa.types.is_fixed_size_list(kind):
        sizes.append(str(kind.list_size))
        kind = kind.value_type
    if len(counts) > 1:
        sizes.insert(0, "...")
    elif counts and (count := counts.pop()) != 1:
        sizes.insert(0, str(count))
    return f"(n, {', '.join(sizes)})" if sizes else "(n,)"


def short(name: str) -> str:
    """sailviz.State:position_m -> position_m."""
    return name.rsplit(":", 1)[-1]


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
    groups: dict[tuple[str, ...], list[pa.Table]] = {}
    batches = sorted(batches, key=lambda batch: "step" not in batch.schema.names)  # what stands within gaps comes last
    for batch in batches:
        names = tuple(sorted(name for name in batch.schema.names if name != ROW_ID))
        groups.setdefault(names, []).append(pa.Table.from_batches([batch.select(names).replace_schema_metadata(None)]))
    return [in_order(pa.concat_tables([strip(table) for table in tables])) for tables in groups.values()]


def strip(table: pa.Table) -> pa.Table:
    """Without metadata on the fields, so that tables of different chunks can be joined."""
    return table.cast(pa.schema([pa.field(field.name, field.type) for field in table.schema]))


def in_order(table: pa.Table) -> pa.Table:
    """Rows in order of the first timeline that there is."""
    for name in (*TIMELINES, *table.column_names):
        if name in table.column_names and not is_component(table[name].type):
            index = table[name].cast(pa.int64()).to_numpy()
            return table if np.all(index[1:] >= index[:-1]) else table.take(np.argsort(index, kind="stable"))
    return table


def is_component(kind: pa.DataType) -> bool:
    """Whether a column of this type holds components, not the rows' places on a timeline."""
    return bool(pa.types.is_list(kind) or pa.types.is_large_list(kind))


def to_numpy(column: pa.Array | pa.ChunkedArray) -> np.ndarray:
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
    numbers: np.ndarray = values.to_numpy(zero_copy_only=False)
    return numbers
