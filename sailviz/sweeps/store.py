"""Rows of a sweep on their way to one table: in memory, or on disk in parts that outlive the process.

While a sweep flies, finished rows lie in NAME.parquet.parts, a small file each; at the end, or when interrupted, they
become NAME.parquet in the order of the flights. Memory stays flat: only which flights are done is kept.
"""

from __future__ import annotations

import json
import os
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from sailviz import files
from sailviz.errors import OutputError, SailvizError
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
    """Rows that end up in a parquet file; what an earlier, unfinished sweep of the same definition left is taken up.

    Each file holds the definition and a checksum for each of its pages. What is damaged, or of another sweep, is told
    in one sentence before anything is flown or written.
    """

    path: Path

    def __init__(self, definition: Definition, path: Path):
        super().__init__(definition)
        self.path = Path(path)
        self._parts = self.path.with_name(self.path.name + ".parts")
        self._note = self._parts / "definition.json"  # for people; what is flown already says so itself
        if self.path.is_dir():
            raise SweepError(f"{self.path} is a folder: name the table, for instance {self.path / 'sweep.parquet'}")
        if self._parts.exists() and not self._parts.is_dir():
            raise SweepError(f"{self._parts} is no folder, and the rows of a sweep lie there while it flies")
        for file in self._files():
            self._same(definition, file)
            for first, stop in self._flights(file):
                self.done[first:stop] = True
        self.resumed = int(self.done.sum())
        if self.done.all():
            return
        try:
            if not self.path.exists():
                files.check(self.path, "table")
            self._parts.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise SweepError(f"cannot write {self._parts}: {files.reason(error)}") from None
        except OutputError as error:
            raise SweepError(str(error)) from None
        _whole(self._note, lambda part: part.write_text(json.dumps(definition.facts(), indent=1)))

    def _files(self) -> list[Path]:
        parts = [file for file in self._parts.glob("*.parquet") if not file.name.startswith(".")]
        return [self.path] * os.path.lexists(self.path) + sorted(parts)

    def _same(self, definition: Definition, file: Path) -> None:
        """Raise SweepError, with what is different, for a file that is not of this sweep."""
        old, new = _told(self._facts(file)), _told(definition.facts())
        changed = [
            f"{key} was {_short(old.get(key))} and is {_short(new.get(key))}"
            for key in dict.fromkeys([*new, *old])
            if old.get(key) != new.get(key)
        ]
        if changed:
            raise SweepError(
                f"{file} holds another sweep: {'; '.join(changed)}. Name another file, or delete this one"
                + (f" and {self._parts}" if file == self.path and self._parts.exists() else "")
            )

    def _facts(self, file: Path) -> dict[str, Any]:
        """The definition that a file holds. SweepError where it holds none."""
        import pyarrow as pa
        import pyarrow.parquet as pq

        if not files.regular(file):
            raise SweepError(f"{file} is no regular file, and a sweep reads its table again when it goes on")
        try:
            facts = json.loads((pq.read_schema(file).metadata or {})[_FACTS])
        except (OSError, pa.ArrowException, KeyError, ValueError, RecursionError, MemoryError):
            facts = None
        if not isinstance(facts, dict):
            if file == self.path:
                raise SweepError(f"{file} exists and is not the table of a sweep, or is damaged: name another file")
            raise self._damaged(file, "it does not say of which sweep it is")
        return facts

    def _flights(self, file: Path) -> list[tuple[int, int]]:
        """(first, stop) flight of each row group, which holds consecutive flights. All of the file is read once, so
        that SweepError tells of damage before it matters."""
        import pyarrow as pa
        import pyarrow.parquet as pq

        found = []
        try:
            with pq.ParquetFile(file, page_checksum_verification=True) as source:
                if not source.schema_arrow.equals(self.schema):
                    raise self._damaged(file, "its columns are not those of this sweep")
                for group in range(source.num_row_groups):
                    table = source.read_row_group(group)
                    table.validate(full=True)
                    index = table["index"].to_numpy()
                    if not len(index) or not 0 <= index[0] <= len(self.done) - len(index):
                        raise self._damaged(file, "it holds flights that there are not")
                    if not np.array_equal(index, index[0] + np.arange(len(index))):
                        raise self._damaged(file, "its flights do not follow each other")
                    found.append((int(index[0]), int(index[0]) + len(index)))
        except (OSError, pa.ArrowException, ValueError, KeyError, OverflowError, MemoryError) as error:
            words = (str(error).splitlines() or [""])[0]
            raise self._damaged(file, words[:120] or "it cannot be read") from None
        if not found:
            raise self._damaged(file, "it holds no flights")
        return found

    def _damaged(self, file: Path, words: str) -> SweepError:
        others = "" if file == self.path else "; all others are kept"
        return SweepError(f"{file} is damaged: {words}. Delete it, and its flights are flown again{others}")

    def _keep(self, table: pa.Table, first: int) -> None:
        _whole(self._parts / f"{first:012d}-{len(table)}.parquet", lambda part: _write(part, table))

    def close(self) -> None:
        """Make one table of all parts, in the order of the flights; the parts go once it is there and whole."""
        import pyarrow as pa
        import pyarrow.parquet as pq

        parts = [file for file in self._files() if file != self.path]
        if not parts:
            if self.path.exists() or not self.done.any():
                self._sweep_up(parts)
            return
        groups = sorted(
            (first, stop, file, i) for file in self._files() for i, (first, stop) in enumerate(self._flights(file))
        )

        def merge(part: Path) -> None:
            with pq.ParquetWriter(part, self.schema, compression="zstd", write_page_checksum=True) as writer:
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

        def whole(part: Path) -> None:
            if sum(stop - first for first, stop in self._flights(part)) != int(self.done.sum()):
                raise SweepError(f"{self.path} could not be made of its parts in {self._parts}, which are kept")

        _whole(self.path, merge, whole)
        self._sweep_up(parts)

    def _sweep_up(self, parts: list[Path]) -> None:
        """Remove what this sweep put beside its table, and nothing else."""
        for file in [*parts, self._note]:
            file.unlink(missing_ok=True)
        files.sweep_folder(self._parts)  # a process that was killed may have been writing just then
        with suppress(OSError):  # not there, or something else lies in it
            self._parts.rmdir()

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


def _write(path: Path, table: pa.Table) -> None:
    import pyarrow.parquet as pq

    rows = max(len(table), 1)
    pq.write_table(table, path, compression="zstd", row_group_size=rows, write_page_checksum=True)


def _whole(path: Path, write: Callable[[Path], object], check: Callable[[Path], None] | None = None) -> None:
    """Write a file, whole or not at all. SweepError where that cannot be."""
    try:
        with files.writing(path, "table", check) as part:
            write(part)
    except OutputError as error:
        raise SweepError(f"{error}; the same command goes on from the flights that are done") from None


def _told(facts: dict[str, Any]) -> dict[str, Any]:
    """Facts of a definition, each with a name by which a person knows it."""
    values, vary = (facts[key] if isinstance(facts.get(key), dict) else {} for key in ("values", "vary"))
    inner = {**values, **{f"vary {key}": words for key, words in vary.items()}}
    return {key: value for key, value in facts.items() if key not in ("values", "vary")} | inner


def _short(value: Any) -> str:
    if value is None:
        return "not there"
    text = json.dumps(value)
    return text if len(text) <= 80 else text[:77] + "..."
