"""What can be compared: a recording, a run, or a table that `sailviz export --to npz` wrote, all in one form."""

from __future__ import annotations

import json
import os
import re
from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa

from sailviz import files
from sailviz.errors import RecordingError
from sailviz.recording.comparison.digest import is_between
from sailviz.recording.contract import FILLED
from sailviz.recording.entity import (
    TIMELINES,
    Entity,
    group_by_columns,
    is_component,
    latest_static,
    short,
    to_numpy,
)
from sailviz.recording.reader import EventRow, FilePath, Recording, read
from sailviz.run.arrays import Run
from sailviz.sky.bodies import BODIES

Source = Recording | Run | FilePath  # what can be compared and exported

TRUTH = ("/state", "/attitude", "/thrust", "/elements", "/environment", "/film", "/phases", "/approximation")
DEVICES = "/thrust/"  # above the entities of several devices
FLIGHT = "/flight/"  # above the entities of flights that were recorded together
APART = (*TRUTH, "/events", "/scene", "/about")  # not part of the picture
FACTS: tuple[str, ...] = ("title", "family", "body", "body_mu_m3_s2", "craft_kind", "rows", "complete", "ended")
FACTS += ("identity", "versions", "body_radius_m", "accuracy", "text")


Drawn = tuple[str, dict[str, tuple[np.ndarray, pa.Array]]]  # an entity, and the steps and values of its columns


@dataclass(frozen=True)
class Table:
    """Columns of one entity on the same rows. step (n,) int64; time (n,) s; columns name -> (n, ...)."""

    step: np.ndarray
    time: np.ndarray
    columns: dict[str, np.ndarray]

    def __len__(self) -> int:
        return len(self.step)


@dataclass(frozen=True)
class Evidence:
    """One side of a comparison. `views` and `picture` are None where there is nothing that could be looked at."""

    label: str
    entities: tuple[str, ...]
    table: Callable[[str], Table]  # of an entity, read anew each time: a recording may be larger than memory
    events: tuple[EventRow, ...] = ()
    facts: dict[str, Any] = field(default_factory=dict)
    epoch: np.datetime64 | None = None
    thinned: bool = False  # holds only some of the rows of its run
    views: Counter[tuple[str, str, str]] | None = None  # (kind, name, origin) -> how many
    picture: Callable[[], Iterator[Drawn]] | None = None  # (entity, name -> arrow column), one at a time
    starts: dict[str, float] = field(default_factory=dict)  # s, by /flight/NAME, of several flights
    frame: str = ""  # of sailviz.frames.FRAMES, in which the numbers are; "" where that is not known

    @property
    def gaps(self) -> tuple[tuple[float, float], ...]:
        """s, (start, end) of the spans without data."""
        return tuple((float(start), float(end)) for start, end in self.facts.get("gaps_s", ()))


def evidence(source: Source | Evidence, label: str = "") -> Evidence:
    """Recording, Run, or path of an .rrd or .npz file -> Evidence. RecordingError for anything that is none of them."""
    if isinstance(source, Evidence):
        return source
    if isinstance(source, Run):
        return of_run(source, label or f"run {source.setting.title!r}")
    if isinstance(source, Recording):
        return of_recording(source, label or str(source.path))
    if not isinstance(source, str | os.PathLike):
        raise RecordingError(f"cannot compare {source!r}: give a recording, a Run, or the path of an .rrd or .npz file")
    if Path(source).suffix == ".npz" and not _of_others(Path(source)):
        return of_npz(Path(source), label or str(source))
    from sailviz.recording.flights import is_flight, read_flight

    if is_flight(source):
        return of_run(read_flight(Path(source)), label or str(source))
    return of_recording(read(source), label or str(source))


def _of_others(path: Path) -> bool:
    """Whether an archive is not one of `export`, as far as its names tell; False for what is no archive."""
    try:
        with open(path, "rb") as file, np.load(file, allow_pickle=False) as stored:
            return "state.time_s" not in stored.files and any("position" in name for name in stored.files)
    except Exception:  # said where it is read
        return False


def of_run(run: Run, label: str) -> Evidence:
    """A run as evidence: numbers only."""
    from sailviz.recording.attitude_ensembles import attitude_ensemble_path, attitude_ensemble_table
    from sailviz.recording.contract import ensemble_path, ensemble_table, tables

    steps = run.first + np.arange(len(run))
    found = {entity: Table(steps, run.time, table) for entity, table in tables(run).items() if table}
    for ensemble in run.setting.ensembles:
        found[ensemble_path(ensemble)] = Table(ensemble.step, ensemble.time, ensemble_table(ensemble))
    for turned in run.setting.attitude_ensembles:
        found[attitude_ensemble_path(turned)] = Table(turned.step, turned.time, attitude_ensemble_table(turned))
    events = sorted(run.events, key=lambda event: event.time)
    rows = np.minimum(np.searchsorted(run.time, [event.time for event in events], side="left"), len(run) - 1)
    setting = run.setting
    facts = {
        "title": setting.title,
        "family": setting.family,
        "body": setting.body.name,
        "body_mu_m3_s2": setting.body.mu,
        "body_radius_m": setting.body.radius,
        "craft_kind": setting.craft.kind,
        "rows": len(run),
        "complete": True,
        "ended": run.ended,
        "identity": setting.identity,
        "versions": json.dumps(setting.versions, sort_keys=True),
        "accuracy": setting.accuracy,
        "text": setting.text,
    } | ({"gaps_s": [list(gap) for gap in setting.gaps]} if setting.gaps else {})
    return Evidence(
        label,
        tuple(found),
        found.__getitem__,
        tuple(
            EventRow(event.name, float(event.time), np.broadcast_to(event.state, 7), int(steps[row]))
            for event, row in zip(events, rows, strict=True)
        ),
        facts,
        None if setting.epoch is None else setting.epoch.astype("datetime64[ns]"),
        frame=frame_of(setting.body.name, setting.resolved),
    )


def of_recording(recording: Recording, label: str) -> Evidence:
    """A recording as evidence, with its views and its picture; one by others by its float64 columns."""
    known = truth_of(recording)
    sailviz = bool(recording.contract)
    entities = known if sailviz else [name for name in recording.entities if numeric(recording, name)]
    facts: dict[str, Any] = {}
    frame = ""
    if "/scene" in recording:
        scene = recording["/scene"]
        frame = frame_of(str(scene["body"][0]), _resolved(scene)) if "body" in scene else ""
        facts = {name: plain(scene[name][0]) for name in FACTS if name in scene}
        facts["complete"] = recording.complete
        facts |= {"gaps_s": recording.gaps.tolist()} if len(recording.gaps) else {}
    elif not recording.complete:
        facts = {"complete": False} if recording.cut_off else {}
    return Evidence(
        label,
        tuple(entities),
        lambda entity: table_of(recording, entity),
        tuple(recording.events),
        facts,
        epoch_of(recording),
        views=views_of(recording),
        picture=(lambda: picture_of(recording)) if sailviz else None,
        starts={flight.path: flight.start for flight in recording.flights},
        frame=frame,
    )


def _resolved(scene: Entity) -> dict[str, Any]:
    """Every value of the scene, as far as it can be read."""
    try:
        found = json.loads(str(scene["resolved"][0])) if "resolved" in scene else {}
    except ValueError:
        return {}
    return found if isinstance(found, dict) else {}


def frame_of(body: str, resolved: dict[str, Any]) -> str:
    """The frame of a run's numbers, of sailviz.frames.FRAMES: the one that its scene names, else the one in which
    flights round a body are computed; "" where arrays came from elsewhere and where the body is of the scene's own."""
    if resolved.get("frame"):
        return str(resolved["frame"])
    if body in ("Sun", "Earth"):
        return "ecliptic-j2000" if body == "Sun" else "equator-of-date"
    known = resolved.get("kind") != "trajectory" and any(one.name == body for one in BODIES.values())
    return "ecliptic-j2000" if known and resolved else ""


def truth_of(recording: Recording) -> list[str]:
    """The entities of the contract that have rows: those of the run, of its ensembles, of the flights beside it."""
    own = ("/ensemble/", "/attitude_ensemble/")
    ensembles = [name for name in recording.entities if name.startswith(own) and name.count("/") == 2]
    beside = [name for name in recording.entities if name.startswith(FLIGHT) and not name.endswith("/scene")]
    devices = [name for name in recording.entities if name.startswith(DEVICES)]
    return [entity for entity in TRUTH if entity in recording] + devices + ensembles + beside


def flight_of(entity: str) -> str:
    """Above the entities of the flight beside the first to which one belongs, e.g. /flight/flat; "" for others."""
    return "/".join(entity.split("/")[:3]) if entity.startswith(FLIGHT) else ""


def of_npz(path: Path, label: str) -> Evidence:
    """An archive of arrays as evidence. RecordingError for one that `export` has not written."""
    if path.exists() and not path.is_file():
        raise RecordingError(f"{path} is no regular file, and a table is read in any order")
    try:
        with open(path, "rb") as file, np.load(file, allow_pickle=False) as stored:
            values = {name: stored[name] for name in stored.files}
    except OSError as error:
        raise RecordingError(f"cannot read {path}: {files.reason(error)}") from None
    except Exception:  # damage shows in whatever way it meets numpy, zipfile or zlib
        raise RecordingError(f"{path} is not a table of numpy arrays, or is damaged or cut off") from None
    if "state.time_s" not in values or "state.step" not in values:
        raise RecordingError(f"{path} was not written by `sailviz export --to npz`: it has no state.time_s")
    tables: dict[str, dict[str, np.ndarray]] = {}
    for name, column in values.items():
        entity, _, short_name = name.rpartition(".")
        tables.setdefault(f"/{entity}", {})[short_name] = column
    scene = {name: plain(value[()]) for name, value in tables.pop("/scene", {}).items()}
    rows = tables.pop("/events", None)
    events: tuple[EventRow, ...] = ()
    if rows is not None:
        try:
            columns = zip(rows["name"], rows["time_s"], rows["state"], rows["step"], strict=True)
            events = tuple(EventRow(str(name), float(time), state, int(step)) for name, time, state, step in columns)
        except (KeyError, ValueError, TypeError):
            raise RecordingError(f"{path} was not written by `sailviz export --to npz`: its events are none") from None
    steps, times = values["state.step"], values["state.time_s"]

    def table(entity: str) -> Table:
        columns = dict(tables[entity])
        own = columns.get("time_s", times)
        if flight_of(entity) and not entity.endswith(("/state", "/events")):
            columns.pop("time_s", None)  # it is no column of theirs, and stands there since the rows are the flight's
        return Table(columns.pop("step", steps), own, columns)

    return Evidence(
        label,
        tuple(tables),
        table,
        events,
        {name: scene[name] for name in FACTS if name in scene},
        np.datetime64(scene["epoch"], "ns") if scene.get("epoch") else None,
        thinned=bool(scene.get("thinned", False)),
        frame=str(scene.get("frame", "")) or frame_of(str(scene.get("body", "")), {}),
    )


def plain(value: Any) -> Any:
    """A numpy scalar or array as Python's own."""
    return value.tolist() if isinstance(value, np.generic | np.ndarray) else value


def numeric(recording: Recording, name: str) -> bool:
    """Whether an entity has a column of float64 over time."""
    kinds = [column.type for table in recording.head(name).tables for column in table.schema]
    return any(is_component(kind) and innermost(kind) == pa.float64() for kind in kinds)


def innermost(kind: pa.DataType) -> pa.DataType:
    """What lists of lists hold in the end."""
    while is_component(kind) or pa.types.is_fixed_size_list(kind):
        kind = kind.value_type
    return kind


def table_of(recording: Recording, name: str) -> Table:
    """The columns of an entity over time. Columns that were logged at other times than the first are left out."""
    entity = Entity(name, list(recording.chunks(name)))
    if not entity.tables:
        raise RecordingError(f"{recording.path}: {name} does not change over time")
    table = entity.tables[0]
    columns = {short(column): to_numpy(table[column]) for column in table.column_names if ":" in column}
    lines = [column for column in table.column_names if not is_component(table[column].type)]
    steps = table["step"].to_numpy() if "step" in lines else np.arange(len(table))
    if "time_s" in columns:
        return Table(steps, columns["time_s"], columns)
    top = flight_of(name)
    own = name.removeprefix(top)
    if (own in TRUTH or own.startswith(DEVICES)) and f"{top}/state" in recording:
        # the float64 times, where the rows are those of /state
        state = Entity(f"{top}/state", list(recording.chunks(f"{top}/state")))
        if np.array_equal(state.timeline("step"), steps):
            return Table(steps, state["time_s"], columns)
    line = next((line for line in ("sim_time", *lines) if line in lines), None)
    if line is None:
        raise RecordingError(f"{recording.path}: {name} stands on no timeline")
    time = table[line].cast(pa.int64()).to_numpy()
    return Table(steps, time / 1e9 if pa.types.is_temporal(table[line].type) else time.astype(float), columns)


def epoch_of(recording: Recording) -> np.datetime64 | None:
    """UTC label of t = 0, ns."""
    if "/state" not in recording:
        return None
    state = recording["/state"]
    try:
        utc, elapsed = state.timeline("utc"), state.timeline("sim_time")
    except KeyError:
        return None
    return np.datetime64(utc[0] - elapsed[0], "ns") if len(utc) else None


def views_of(recording: Recording) -> Counter[tuple[str, str, str]] | None:
    """(kind, name, origin) of every view of the layout that travels with a recording; None without a layout."""
    found: dict[str, tuple[int, dict[str, Any]]] = {}
    layouts = recording.blueprints()
    for number, layout in enumerate(layouts):
        for chunk in layout:
            if not re.fullmatch("/view/[^/]+", chunk.entity_path):  # the properties of a view lie below it
                continue
            batch = chunk.to_record_batch()
            for row in range(len(batch)):
                view = found.setdefault(chunk.entity_path, (number, {}))[1]
                for name in batch.schema.names:
                    if name.startswith("ViewBlueprint:") and batch.column(name)[row].is_valid:
                        view[short(name)] = batch.column(name)[row].as_py()[0]
    if not layouts:
        return None
    newest = max((number for number, _ in found.values()), default=0)
    return Counter(
        (view.get("class_identifier", ""), view.get("display_name", ""), view.get("space_origin", ""))
        for number, view in found.values()
        if number == newest and view.get("class_identifier")
    )


def picture_of(recording: Recording) -> Iterator[Drawn]:
    """(entity, name -> (steps, Arrow column)) of everything that is there to be looked at. Static columns have the
    step -1; those of several rows stand in order of step.
    """
    apart, filled = {*APART, FILLED, *truth_of(recording)}, FILLED in recording
    for name in recording.entities:
        if name in apart or name.startswith(FLIGHT):
            continue
        batches = [chunk.to_record_batch() for chunk in recording.chunks(name)]
        yield name, _columns([each for each in batches if not (filled and is_between(name, each.schema.names))])


def _columns(batches: list[pa.RecordBatch]) -> dict[str, tuple[np.ndarray, pa.Array]]:
    """Of one entity."""
    temporal = [batch for batch in batches if any(line in batch.schema.names for line in TIMELINES)]
    static = [batch for batch in batches if not any(line in batch.schema.names for line in TIMELINES)]
    columns = {short(key): (np.array([-1]), value) for key, value in latest_static(static).items()}
    for table in group_by_columns(temporal):
        steps = table["step"].to_numpy() if "step" in table.column_names else np.arange(len(table))
        for key in table.column_names:
            if is_component(table[key].type):
                within = "step" not in table.column_names and short(key) in columns
                word = f"{short(key)} within gaps" if within else short(key)
                columns[word] = (steps, table[key].combine_chunks())
    return columns
