"""Recordings read back as numpy. Needs rerun, pyarrow and numpy, nothing that draws or simulates."""

from __future__ import annotations

import difflib
import json
import os
import re
import tempfile
import textwrap
import warnings
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np
from rerun.chunk import Chunk, LazyChunkStream, LazyStore, RrdReader

from sailviz.errors import DamagedError, RecordingError
from sailviz.files import reason
from sailviz.recording import checksums
from sailviz.recording.entity import Entity, counted
from sailviz.recording.framing import FRAME, HEAD, framing
from sailviz.recording.probe import probe
from sailviz.recording.sinks import Memory

PICTURE = ("world", "sail", "plots", "phase", "about", "log", "arrival", "histogram")  # what is there for the eye
FLIGHT_SCENE = re.compile("/flight/[^/]+/scene")
EMPTY = "holds no recording"
FilePath = str | os.PathLike[str]
TERMINAL = 110  # characters in a line
TOLD = 12  # entities of a recording by others that are described on a terminal


def read(source: FilePath | bytes | BinaryIO | Memory | Recording) -> Recording:
    """Open a recording: its checksum is looked at, columns are read when they are asked for.

    source : a path, the bytes of a file, an open binary file, a Memory that `record` has filled, or a Recording.
    A file that was cut off is read as far as its last whole message (`complete` is then False). A file without a
    checksum (by others, older, or cut off) is first read in a process of its own, which damage may end.
    Raises RecordingError, in one sentence, for what is damaged, not a recording, or was written by a newer rerun.
    """
    if isinstance(source, Recording):
        return source
    if isinstance(source, str | os.PathLike):
        return Recording(Path(source))
    if isinstance(source, Memory):
        return Recording(kept(source.bytes), "memory")
    if isinstance(source, bytes):
        return Recording(kept(source), "bytes")
    content = source.read() if hasattr(source, "read") else None
    if not isinstance(content, bytes):
        raise RecordingError(f"cannot read {source!r}: give a path, bytes, or a file that was opened for reading bytes")
    return Recording(kept(content), str(getattr(source, "name", "bytes")))


def kept(content: bytes) -> tempfile._TemporaryFileWrapper[bytes]:
    """Bytes in a temporary file, which is there as long as it is referred to."""
    try:
        file = tempfile.NamedTemporaryFile(suffix=".rrd")  # noqa: SIM115
        file.write(content)
        file.flush()
    except OSError as error:
        raise RecordingError(
            f"cannot keep {len(content):,} bytes in {tempfile.gettempdir()}: {reason(error)}"
        ) from None
    return file


class Recording(Mapping[str, Entity]):
    """A recording as a mapping from the paths of its entities, each a mapping from the names of its columns.

    `recording["/state"]["position_m"]` is (n, 3) float64, as it was in the run, bit for bit.
    """

    def __init__(self, file: Path | tempfile._TemporaryFileWrapper[bytes], label: str = "", trusted: bool = False):
        """file : a path, or a temporary file that lives as long as the Recording. label : its name in words.
        trusted : it is whole, or this process may end if it is not."""
        self._file = file
        self.path = file if isinstance(file, Path) else Path(file.name)
        self.label = label or str(self.path)
        self._whole: tempfile._TemporaryFileWrapper[bytes] | None = None  # the whole messages of one that was cut off
        self._tables: dict[str, Entity] = {}
        self._frames = framing(self.path, self.label)
        self._sums = checksums.sums_of(self.path, self._frames)
        self._check_whole(trusted)
        self._reader = self._open()

    def __getitem__(self, entity: str) -> Entity:
        name = "/" + entity.strip("/")
        if name not in self.entities:
            near = difflib.get_close_matches(name, self.entities, 1, 0.4)
            hint = f"; did you mean {near[0]}?" if near else ""
            raise KeyError(f"{self.label} has no entity {name}{hint}")
        if name not in self._tables:
            self._tables[name] = self.fresh(name)
        return self._tables[name]

    def __contains__(self, entity: object) -> bool:
        return isinstance(entity, str) and "/" + entity.strip("/") in self.entities

    def __iter__(self) -> Iterator[str]:
        return iter(self.entities)

    def __len__(self) -> int:
        return len(self.entities)

    __eq__ = object.__eq__  # the same object: two recordings are compared by `compare`
    __hash__ = object.__hash__

    def __repr__(self) -> str:
        rows, ours = self._rows(), [name for name in self.entities if self._is_truth(name)]
        told = ours or list(self.entities)[:TOLD]
        width = max((len(name) for name in told), default=0)
        lines = [f"<Recording {self.label}: {len(self.entities)} entities{'' if self.complete else ', not complete'}>"]
        for name in told:
            columns = f"{counted(rows.get(name, 0))}: {self.head(name).described()}"
            whole = columns.replace(" ", "\0").replace(",\0", ", ")  # fold between columns only
            indent = f"  {name:<{width}}  "
            folded = textwrap.wrap(whole, TERMINAL, initial_indent=indent, subsequent_indent=" " * len(indent))
            lines += [line.replace("\0", " ") for line in folded]
        if len(told) < len(self.entities):
            lines.append(f"  and {len(self.entities) - len(told)} {'of plots and picture' if ours else 'more'}")
        return "\n".join(lines)

    @cached_property
    def entities(self) -> tuple[str, ...]:
        """Paths of everything that was recorded, sorted: the truth (/state, ...), the plots and the picture."""
        if self._store is not None:
            lines = self._store.summary().splitlines()
            names = {line.split(" rows=")[0].strip() for line in lines if line.strip()}
        else:
            names = {chunk.entity_path for chunk in self.chunks()}
        return tuple(sorted(name for name in names if not name.startswith("/__")))

    @property
    def application_id(self) -> str:
        """`sailviz_<family>_<start of the identity>`, or the name of the application that wrote the file."""
        return str(self._reader.recordings()[0].application_id)

    @property
    def recording_id(self) -> str:
        """What a viewer knows it by: files of the same application and id are one recording."""
        return str(self._reader.recordings()[0].recording_id)

    @property
    def title(self) -> str:
        """The scene's title, "" where there is none."""
        return self._word("title")

    @property
    def scene_text(self) -> str:
        """The scene file that was run, word for word."""
        return self._word("text")

    @property
    def resolved(self) -> dict[str, Any]:
        """Every value of the scene, SI."""
        values: dict[str, Any] = json.loads(self._word("resolved") or "{}")
        return values

    @property
    def versions(self) -> dict[str, str]:
        """Name and version of what made it."""
        values: dict[str, str] = json.loads(self._word("versions") or "{}")
        return values

    @property
    def accuracy(self) -> str:
        """How the numbers were made."""
        return self._word("accuracy")

    @property
    def identity(self) -> str:
        """Hash of the resolved scene."""
        return self._word("identity")

    @property
    def contract(self) -> str:
        """`sailviz/1`, or "" for a recording by another application."""
        return self._word("contract")

    @property
    def cut_off(self) -> bool:
        """Whether the file ends in the middle of a message."""
        return self._whole is not None

    @property
    def complete(self) -> bool:
        """False where the run was interrupted or the file was cut off."""
        scene: Mapping[str, np.ndarray] = self.get("/scene", {})
        return not self.cut_off and "complete" in scene and bool(scene["complete"][0])

    @property
    def events(self) -> list[EventRow]:
        """What happened, in order of time."""
        if "/events" not in self:
            return []
        table = self["/events"]
        names, times, states, steps = table["name"], table["time_s"], table["state"], table.timeline("step")
        order = np.argsort(times, kind="stable")
        return [EventRow(str(names[i]), float(times[i]), states[i], int(steps[i])) for i in order]

    @property
    def flights(self) -> list[FlightFacts]:
        """Those that were recorded together, the first one first; none of a recording of one."""
        scene: Mapping[str, np.ndarray] = self.get("/scene", {})
        order = [str(name) for name in np.ravel(scene["flights"])] if self.contract and "flights" in scene else []
        found = []
        for path in dict.fromkeys(name.rsplit("/", 1)[0] for name in self.entities if FLIGHT_SCENE.fullmatch(name)):
            facts = self[f"{path}/scene"]
            name, title, identity = (str(facts[key][0]) for key in ("name", "title", "identity"))
            found.append(FlightFacts(path, name, title, identity, float(facts["start_s"][0]), int(facts["rows"][0])))
        return sorted(found, key=lambda flight: order.index(flight.name) if flight.name in order else len(order))

    @property
    def gaps(self) -> np.ndarray:
        """(k, 2) s, starts and ends of the spans without data."""
        scene: Mapping[str, np.ndarray] = self.get("/scene", {})
        return np.array(scene.get("gaps_s", []), float).reshape(-1, 2)

    def chunks(self, entity: str = "") -> Iterator[Chunk]:
        """The pieces in which rerun keeps an entity, or all of the file, read anew each time."""
        stream = self._stream()
        yield from stream.filter(content=entity) if entity else stream

    def fresh(self, entity: str) -> Entity:
        """An entity read anew, not kept."""
        return Entity(entity, list(self.chunks(entity)))

    @property
    def sealed(self) -> bool:
        """Whether the bytes of the file were found to be those that were written."""
        return self._sums is not None and self._sums.of_this_file and not self._frames.cut

    def head(self, entity: str) -> Entity:
        """An entity with the first of its rows only: enough to know its columns."""
        found: list[Chunk] = []
        for chunk in self.chunks(entity):
            found.append(chunk)
            if not chunk.is_static:
                break
        return Entity(entity, found)

    def blueprints(self) -> list[list[Chunk]]:
        """The pieces of each layout of views that travels with the recording."""
        return [list(self._reader.stream(store=layout)) for layout in self._reader.blueprints()]

    def _word(self, name: str) -> str:
        """One of the words in /scene, "" where it is not there."""
        scene: Mapping[str, np.ndarray] = self.get("/scene", {})
        return str(scene[name][0]) if name in scene else ""

    def _is_truth(self, name: str) -> bool:
        """Whether an entity is one of the contract, not of the picture."""
        return name.split("/")[1] not in PICTURE if self.contract else False

    def _rows(self) -> dict[str, int]:
        """How many rows each entity has; none for a file that was cut off, which has no index."""
        counts: dict[str, int] = {}
        for line in [] if self._store is None else self._store.summary().splitlines():
            name, _, told = line.partition(" rows=")
            number, _, more = told.partition(" ")
            if more.startswith("static=False"):
                counts[name.strip()] = counts.get(name.strip(), 0) + int(number)
        return counts

    @cached_property
    def _store(self) -> LazyStore | None:
        """The file's index, None for a file that was cut off."""
        return self._reader.store() if self._frames.indexed else None

    def _stream(self) -> LazyChunkStream:
        return self._reader.stream() if self._store is None else self._store.stream()

    def _check_whole(self, trusted: bool) -> None:
        """Raise RecordingError for a file that is damaged, or holds nothing; keep the whole messages of one that was
        cut off."""
        if not self._frames.messages:
            early = self._frames.cut and self._frames.size >= HEAD + FRAME
            raise RecordingError(f"{self.label} {'was cut off before anything was recorded' if early else EMPTY}")
        if self._frames.cut:
            try:
                self._whole = kept(self.path.read_bytes()[: self._frames.whole])
            except OSError as error:
                raise RecordingError(f"cannot read {self.label}: {reason(error)}") from None
        if self._sums is not None and self.sealed:
            checksums.check(self.path, self._frames, self._sums, self.label)
        elif not trusted:
            probe(Path(self._whole.name) if self._whole else self.path, self.label)

    def _open(self) -> RrdReader:
        try:
            reader = open_quietly(Path(self._whole.name) if self._whole else self.path)
            if not reader.recordings():
                raise RecordingError(f"{self.label} {EMPTY}")
            if self._frames.indexed:
                reader.store()
        except (RuntimeError, ValueError) as error:
            words = (str(error).splitlines() or [""])[0]
            raise DamagedError(f"{self.label} is damaged and cannot be read: {words}") from None
        return reader


@dataclass(frozen=True)
class FlightFacts:
    """One of several flights that were recorded together. path : above its entities, but that the first one's numbers
    stand at the top; start : s of the first one's clock at its own time 0."""

    path: str
    name: str
    title: str
    identity: str
    start: float
    rows: int


@dataclass(frozen=True)
class EventRow:
    """An event as recorded. time s, state (7,) position m, velocity m/s, mass kg, step the row at or after it."""

    name: str
    time: float
    state: np.ndarray
    step: int


def open_quietly(path: Path) -> RrdReader:
    """A reader that says nothing of a file without a footer: that is our business, not the caller's."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return RrdReader(str(path))
