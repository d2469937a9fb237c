"""Recordings as tables for other programs: CSV, Parquet, numpy archives, and orbit ephemeris messages.

csv, parquet   one table: step, time_s, utc where there is an epoch, then entity.column_unit[.component]; events in a
               second file beside it, NAME.events.csv, and each ensemble in NAME.ensemble.OWN_NAME.csv; each flight
               beside the first, on its own clock, in NAME.flight.OWN_NAME.csv
npz            every column under its own key, e.g. state.position_m (n, 3), events.time_s, scene.identity
oem, spk       position and velocity (orbit_files.py); a new segment after a gap and at a jump
aem, ck        the attitude (attitude_files.py); beside a CK its clock and its frame, NAME.tsc and NAME.tf
cosmographia   a folder with catalogue, kernels and mesh (cosmographia.py)
"""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path

import numpy as np
import pyarrow as pa

from sailviz import files
from sailviz.errors import RecordingError
from sailviz.recording.comparison.tables import Evidence, Source, Table, evidence, flight_of
from sailviz.recording.orbit_files import ATTITUDES, CRAFT, ORBIT_FILES, check_ids, write_orbit
from sailviz.recording.reader import EventRow, FilePath

FORMATS = ("csv", "parquet", "npz", *ORBIT_FILES, "cosmographia")
ENDING = {"spk": "bsp", "ck": "bc"}  # of a file, where that is not the format's word
ENDINGS = {ending: to for to, ending in ENDING.items()}
FEW = 5  # rows of an entity that stands on other rows than the truth, where only a part of those is wanted
LETTERS = {"quaternion": "xyzw", "acceleration_rtn_m_s2": "rtn"}


def export(
    source: Source,
    out: FilePath | None = None,
    to: str = "",
    *,
    entities: Sequence[str] = (),
    frame: str = "",
    craft_id: int = CRAFT,
    centre_id: int | None = None,
) -> tuple[Path, ...]:
    """Write a recording (or a Run, or a path of either kind that `compare` takes) for another program -> files written.

    out : file or folder; without one a file named after the recording in the current folder. to : one of FORMATS, by
    default the ending of `out`; a device or a pipe takes the rows alone, with no file of events beside it. entities :
    those wanted, all of the truth by default. frame : of an OEM, AEM, SPK or CK, see `orbit_files`. craft_id : NAIF's
    of the craft in kernels; centre_id : of the central body in an SPK; that of the Sun, a planet or the Moon
    needs no word.
    Raises RecordingError, in one sentence, for what cannot be read, written or said in that format.
    """
    data = evidence(source)
    path, to = _target(data, out, to)
    wanted = tuple("/" + name.strip("/") for name in entities)
    if to == "cosmographia":
        from sailviz.recording.cosmographia import write_cosmographia

        if wanted or centre_id is not None:
            raise RecordingError(
                "a folder for Cosmographia holds the whole flight: it takes no entity and no centre_id"
            )
        return (write_cosmographia(source, path, frame, craft_id),)
    files.check(path, "table")
    try:
        check_ids(to, craft_id, centre_id)
        if to in ORBIT_FILES:
            held, content = ("/attitude", "the attitude") if to in ATTITUDES else ("/state", "position and velocity")
            if wanted and wanted != (held,):
                raise RecordingError(f"{ORBIT_FILES[to]} holds {content}; it takes no other entity than {held}")
            return write_orbit(data, path, to, frame, craft_id, centre_id)
        if frame:
            raise RecordingError(
                f"a frame is named in an OEM, AEM, SPK or CK; {to} holds the numbers in the frame of the run"
            )
        if to == "npz":
            return (written_whole(path, lambda part: write_npz(part, arrays(data, wanted))),)
        return _write_tables(data, path, to, wanted)
    except OSError as error:
        raise RecordingError(f"cannot write {path}: {(error.strerror or str(error)).lower()}") from None


def _target(data: Evidence, given: FilePath | None, to: str) -> tuple[Path, str]:
    out = None if given is None else Path(given)
    if not to:
        to = out.suffix.removeprefix(".").lower() if out is not None else ""
        to = ENDINGS.get(to, to)
        if to not in FORMATS:
            raise RecordingError(f"a recording is exported to one of {', '.join(FORMATS)}; say which")
    if to not in FORMATS:
        raise RecordingError(f"cannot export to {to}; there are {', '.join(FORMATS)}")
    stem = Path(data.label).stem or "run"
    if to == "cosmographia":
        return Path(f"{stem}-cosmographia") if out is None else out, to
    name = f"{stem}.{ENDING.get(to, to)}"
    if out is None:
        return Path(name), to
    return (out / name if out.is_dir() else out), to


def written_whole(path: Path, write: Callable[[Path], None]) -> Path:
    """Write a table, whole or not at all -> its path. OutputError where it cannot be written."""
    with files.writing(path, "table") as part:
        write(part)
    return path


def _write_tables(data: Evidence, path: Path, to: str, wanted: Sequence[str]) -> tuple[Path, ...]:
    entities = [name for name in wanted or data.entities if name != "/events"]
    events = _wanted_events(data, wanted)
    meta = {b"sailviz": json.dumps(data.facts, sort_keys=True).encode()}
    if not entities and events is not None:
        return (written_whole(path, lambda part: _write_arrow(part, events.replace_schema_metadata(meta), to)),)
    apart = {} if wanted else _on_other_rows(entities)
    others = {name for names in apart.values() for name in names}
    table = flat_table(data, [name for name in entities if name not in others]).replace_schema_metadata(meta)
    alone = path.exists() and not path.is_file()  # a device or a pipe: nothing lies beside it
    written = [written_whole(path, lambda part: _write_arrow(part, table, to))]
    for top, names in {} if alone else apart.items():
        beside = path.with_name(f"{path.stem}{top.replace('/', '.')}{path.suffix}")
        own = flat_table(data, names).replace_schema_metadata(meta)
        written.append(written_whole(beside, partial(_write_arrow, table=own, to=to)))
    if events is not None and not alone:
        beside = path.with_name(f"{path.stem}.events{path.suffix}")
        written.append(written_whole(beside, lambda part: _write_arrow(part, events, to)))
    return tuple(written)


def _on_other_rows(entities: Sequence[str]) -> dict[str, list[str]]:
    """Entities that do not stand on the rows of the first flight, by what their file is called after: each ensemble,
    each flight beside the first, and the events of that."""
    found: dict[str, list[str]] = {}
    for name in entities:
        flight = flight_of(name)
        if name.startswith(("/ensemble/", "/attitude_ensemble/")) or name == f"{flight}/events":
            found[name] = [name]
        elif flight:
            found.setdefault(flight, []).append(name)
    return found


def _wanted_events(data: Evidence, wanted: Sequence[str]) -> pa.Table | None:
    """The events, unless others are wanted or there are none. RecordingError where they were asked for in vain."""
    if data.events and (not wanted or "/events" in wanted):
        return events_table(data)
    if "/events" in wanted:
        raise RecordingError(f"{data.label} holds no events")
    return None


def _write_arrow(path: Path, table: pa.Table, to: str) -> None:
    if to == "parquet":
        import pyarrow.parquet

        # numbers that hardly repeat: dictionaries only cost time
        pyarrow.parquet.write_table(table, path, compression="zstd", use_dictionary=False)
    else:
        import pyarrow.csv

        pyarrow.csv.write_csv(table, path)


def flat_table(data: Evidence, entities: Sequence[str]) -> pa.Table:
    """Entities side by side, one column per number. RecordingError where they do not stand on the same rows."""
    columns: dict[str, pa.Array] = {}
    first: tuple[Table, str] | None = None
    tops = {flight_of(entity) for entity in entities}
    top = tops.pop() if len(tops) == 1 else ""  # of the flight, where all is one flight's
    for entity in entities:
        table = data.table(entity)
        if first is None:
            first = table, entity
            columns["step"] = pa.array(table.step)
            columns["time_s"] = pa.array(np.asarray(table.time, float))
            if data.epoch is not None:
                since = table.time + data.starts.get(flight_of(entity), 0.0)
                ns = np.round(since * 1e9).astype(np.int64).astype("timedelta64[ns]")
                columns["utc"] = pa.array(data.epoch + ns)
        elif not np.array_equal(first[0].step, table.step):
            raise RecordingError(f"{entity} stands on other rows than {first[1]}: export it alone, or all to npz")
        for name, values in table.columns.items():
            if name != "time_s":
                key = f"{entity.removeprefix(top).strip('/')}.{name}"
                columns.update(_components(key, name, values, data.label))
    return pa.table(columns)


def _components(key: str, name: str, values: np.ndarray, label: str) -> dict[str, pa.Array]:
    """A column of vectors as columns of numbers: state.position_m.x, ..."""
    if values.dtype == object and not all(isinstance(value, str) for value in values.ravel()):
        raise RecordingError(f"{label}: {key} has another number of values in each row; that makes no table")
    if values.ndim == 1:
        return {key: pa.array(values)}
    letters = LETTERS.get(name, "xyz")
    flat = values.reshape(len(values), -1)
    named = values.ndim == 2 and flat.shape[1] <= len(letters)
    return {f"{key}.{letters[i] if named else i}": pa.array(flat[:, i]) for i in range(flat.shape[1])}


def events_table(data: Evidence) -> pa.Table:
    """name, time_s, utc, position_m.x ... velocity_m_s.z, mass_kg: one row per event."""
    states = np.array([event.state for event in data.events], float).reshape(-1, 7)
    columns = {
        "name": pa.array([event.name for event in data.events]),
        "step": pa.array([event.step for event in data.events]),
        "time_s": pa.array([event.time for event in data.events]),
    }
    if data.epoch is not None:
        ns = np.round(np.array([event.time for event in data.events]) * 1e9).astype(np.int64)
        columns["utc"] = pa.array(data.epoch + ns.astype("timedelta64[ns]"))
    columns |= _components("position_m", "position_m", states[:, :3], data.label)
    columns |= _components("velocity_m_s", "velocity_m_s", states[:, 3:6], data.label)
    columns["mass_kg"] = pa.array(states[:, 6])
    return pa.table(columns)


def arrays(data: Evidence, wanted: Sequence[str] = (), rows: np.ndarray | None = None) -> dict[str, np.ndarray]:
    """Everything as arrays by key: state.position_m, events.name, scene.identity ... rows : indices into the rows of
    the truth, for a part of them, and FEW of any other entity; the archive then says that it is thinned.
    """
    found: dict[str, np.ndarray] = {}
    steps = data.table("/state").step if "/state" in data.entities else None
    for entity in [name for name in wanted or data.entities if name != "/events"]:
        table, key = data.table(entity), entity.strip("/")
        same = steps is not None and not flight_of(entity) and np.array_equal(table.step, steps)
        pick = _picked(rows, same, len(table))
        if entity == "/state" or not same or wanted:
            found[f"{key}.step"] = np.asarray(table.step)[pick]
            found[f"{key}.time_s"] = np.asarray(table.time, float)[pick]
        for name, values in table.columns.items():
            if values.dtype == object:
                _components(f"{key}.{name}", name, values, data.label)  # refuses rows of different lengths
                values = values.astype(str)
            found[f"{key}.{name}"] = values[pick]
    if not wanted or "/events" in wanted:
        found |= _event_arrays(data.events)
    for name, value in data.facts.items():
        found[f"scene.{name}"] = np.asarray(value)
    found["scene.epoch"] = np.asarray("" if data.epoch is None else str(data.epoch))
    found["scene.frame"] = np.asarray(data.frame)
    found["scene.thinned"] = np.asarray(rows is not None or data.thinned)
    return found


def _picked(rows: np.ndarray | None, same: bool, count: int) -> slice | np.ndarray:
    """Which of the rows of an entity are wanted. same : whether they are the rows of the truth."""
    if rows is None:
        return slice(None)
    return rows if same else np.unique(np.linspace(0, count - 1, FEW).round().astype(int))


def _event_arrays(events: Sequence[EventRow]) -> dict[str, np.ndarray]:
    if not events:
        return {}
    return {
        "events.name": np.array([event.name for event in events]),
        "events.time_s": np.array([event.time for event in events]),
        "events.state": np.array([event.state for event in events], float).reshape(-1, 7),
        "events.step": np.array([event.step for event in events]),
    }


def write_npz(path: Path, values: dict[str, np.ndarray], compressed: bool = False) -> None:
    """Write arrays by name."""
    with open(path, "wb") as file:
        save: Callable[..., None] = np.savez_compressed if compressed else np.savez
        save(file, **values)
