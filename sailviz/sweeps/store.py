"""Rows of a sweep on their way to one table: in memory, or on disk in parts that outlive the process.

While a sweep flies, finished rows lie in NAME.parquet.parts, a small file each; at the end, or when interrupted, they
become NAME.parquet in the order of the flights. Memory stays flat: only which flights are done is kept.
"""

from __future__ import annotations

import json
import os
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from sailviz.errors import SailvizError
from sailviz.sweeps.definition import Definition
from sailviz.sweeps.flight import FAILED, schema_of

if TYPE_CHECKING:
    import pyarrow as pa

GROUP_ROWS = 65_536  # of the finished table, read at once
_FACTS = b"sailviz.sweep"


class SweepError(SailvizError):
    """A sweep that cannot begin, go on or be written, in one sentence."""


class MemoryStore:
    """Rows that are kept as an arrow table and nowhere else."""

    path: Path | None = None

    def __init__(self, definition: Definition):
        self.schema = schema_of(definition).with_metadata({_FACTS: json.dumps(definition.facts()).encode()})
        self.done = np.zeros(definition.flights, dtype=bool)
        self._tables: list[tuple[int, pa.Table]] = []

    def add(self, rows: list[dict[str, Any]]) -> None:
        """Take rows of consecutive flights."""
        import pyarrow as pa

        self.done[[row["index"] for row in rows]] = True
        self._keep(pa.Table.from_pylist(rows, schema=self.schema), rows[0]["index"])

    def _keep(self, table: pa.Table, first: int) -> None:
        self._tables.append((first, table))

    def close(self) -> None:
        """Put what there is into order."""
        import pyarrow as pa

        tables = [table for _, table in sorted(self._tables, key=lambda item: item[0])]
        self._tables = [(0, pa.concat_tables(tables).combine_chunks() if tables else self.schema.empty_table())]

    def columns(self, names: list[str] | None = None) -> pa.Table:
        """The table, or only some columns of it."""
        table = self._tables[0][1]
        return table if names is None else table.select(names)


class FileStore(MemoryStore):
    """Rows that end up in a parquet file; what an earlier, unfinished sweep of the same definition left is taken up."""

    path: Path

    def __init__(self, definition: Definition, path: Path):
        super().__init__(definition)
        self.path = Path(path)
        self._parts = self.path.with_name(self.path.name + ".parts")
        if self.path.is_dir():
            raise SweepError(f"{self.path} is a folder: name the table, for instance {self.path / 'sweep.parquet'}")
        if self.path.exists():
            self._same(definition, self._facts_of_table())
        known = self._parts / "definition.json"
        if known.exists():
            self._same(definition, json.loads(known.read_text()))
        for file in self._files():
            for first, stop in _groups(file):
                self.done[first:stop] = True
        self.resumed = int(self.done.sum())
        if self.done.all():
            return
        try:
            self._parts.mkdir(parents=True, exist_ok=True)
            _whole(known, lambda part: part.write_text(json.dumps(definition.facts(), indent=1)))
        except OSError as error:
            raise SweepError(f"cannot write {self._parts}: {(error.strerror or str(error)).lower()}") from None

    def _facts_of_table(self) -> dict[str, Any]:
        import pyarrow as pa
        import pyarrow.parquet as pq

        try:
            facts = (pq.read_schema(self.path).metadata or {}).get(_FACTS)
        except (OSError, pa.ArrowException):
            facts = None
        if facts is None:
            raise SweepError(f"{self.path} exists and is not the table of a sweep: name another file")
        return json.loads(facts)

    def _same(self, definition: Definition, facts: dict[str, Any]) -> None:
        old, new = _told(facts), _told(definition.facts())
        changed = [
            f"{key} was {_short(old.get(key))} and is {_short(new.get(key))}"
            for key in dict.fromkeys([*new, *old])
            if old.get(key) != new.get(key)
        ]
        if changed:
            raise SweepError(
                f"{self.path} holds another sweep: {'; '.join(changed)}. Name another file, or delete this one"
                + (f" and {self._parts}" if self._parts.exists() else "")
            )

    def _files(self) -> list[Path]:
        return [self.path] * self.path.exists() + sorted(self._parts.glob("*.parquet"))

    def _keep(self, table: pa.Table, first: int) -> None:
        try:
            _whole(self._parts / f"{first:012d}-{len(table)}.parquet", lambda part: _write(part, table))
        except OSError as error:
            raise SweepError(f"cannot write {self._parts}: {(error.strerror or str(error)).lower()}") from None

    def close(self) -> None:
        """Make one table of all parts, in the order of the flights."""
        import pyarrow as pa
        import pyarrow.parquet as pq

        parts = list(self._parts.glob("*.parquet"))
        if not parts and (self.path.exists() or not self._parts.exists()):
            shutil.rmtree(self._parts, ignore_errors=True)
            return
        groups = sorted(
            (first, stop, file, i) for file in self._files() for i, (first, stop) in enumerate(_groups(file))
        )

        def merge(part: Path) -> None:
            with pq.ParquetWriter(part, self.schema, compression="zstd") as writer:
                waiting: list[pa.Table] = []
                rows, end = 0, 0
                for first, stop, file, i in groups:
                    if stop <= end:  # known from another file already
                        continue
                    if waiting and (first != end or rows >= GROUP_ROWS):
                        writer.write_table(pa.concat_tables(waiting), row_group_size=rows)
                        waiting, rows = [], 0
                    with pq.ParquetFile(file) as source:
                        table = source.read_row_group(i)
                    table = table.slice(max(end - first, 0)).replace_schema_metadata(self.schema.metadata)
                    waiting.append(table)
                    rows, end = rows + len(table), stop
                if waiting:
                    writer.write_table(pa.concat_tables(waiting), row_group_size=rows)

        try:
            _whole(self.path, merge)
        except OSError as error:
            raise SweepError(f"cannot write {self.path}: {(error.strerror or str(error)).lower()}") from None
        shutil.rmtree(self._parts, ignore_errors=True)

    def columns(self, names: list[str] | None = None) -> pa.Table:
        """The table, or only some columns of it, read from the file."""
        import pyarrow.parquet as pq

        if not self.path.exists():
            return self.schema.empty_table().select(names or self.schema.names)
        return pq.read_table(self.path, columns=names)


def counts(store: MemoryStore) -> tuple[int, int]:
    """(flights that failed, flights that missed an expectation)."""
    import pyarrow.compute as pc

    verdicts = [name for name in store.schema.names if name.endswith(" passed")]
    table = store.columns(["status", *verdicts])
    missed = np.zeros(len(table), dtype=bool)
    for name in verdicts:
        missed |= ~pc.fill_null(table[name], True).to_numpy()
    return int(pc.sum(pc.equal(table["status"], FAILED)).as_py() or 0), int(missed.sum())


def _groups(file: Path) -> list[tuple[int, int]]:
    """(first, stop) flight of each row group, from the file's footer alone; each holds consecutive flights."""
    import pyarrow as pa
    import pyarrow.parquet as pq

    try:
        meta = pq.read_metadata(file)
    except (OSError, pa.ArrowException) as error:
        raise SweepError(f"{file} cannot be read: {error}; delete it and its flights are flown again") from None
    return [
        (found.min, found.max + 1)
        for found in (meta.row_group(i).column(0).statistics for i in range(meta.num_row_groups))
    ]


def _write(path: Path, table: pa.Table) -> None:
    import pyarrow.parquet as pq

    pq.write_table(table, path, compression="zstd", row_group_size=max(len(table), 1))


def _whole(path: Path, write: Callable[[Path], object]) -> None:
    """Write under a temporary name first, so that a file appears whole."""
    part = path.with_name(f".{path.name}.{os.getpid()}.part")
    try:
        write(part)
        os.replace(part, path)
    finally:
        part.unlink(missing_ok=True)


def _told(facts: dict[str, Any]) -> dict[str, Any]:
    """Facts of a definition, each with a name by which a person knows it."""
    inner = {**facts.get("values", {}), **{f"vary {key}": words for key, words in facts.get("vary", {}).items()}}
    return {key: value for key, value in facts.items() if key not in ("values", "vary")} | inner


def _short(value: Any) -> str:
    if value is None:
        return "not there"
    text = json.dumps(value)
    return text if len(text) <= 80 else text[:77] + "..."
