"""What a recording is, for a person or a script, without reading more of it than that takes."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

import numpy as np
import pyarrow as pa

from sailviz.errors import DamagedError
from sailviz.recording.comparison.tables import epoch_of, innermost, plain, truth_of, views_of
from sailviz.recording.entity import is_component, short
from sailviz.recording.reader import FilePath, Recording, read
from sailviz.words import duration

HOLD, NONE, DAMAGED = "hold", "none", "damaged"
UNKNOWN = "none (by an older sailviz, another program, or cut off): it can be read, as it was written or not"


def verify(source: FilePath) -> dict[str, Any]:
    """Whether a recording is as it was written, ready for JSON.

    Keys: path; checksums: "hold", "none" (a file without its own, which was read from end to end) or "damaged";
    damaged: the entities in which damage lies, as far as that can be told; says: a sentence. RecordingError for what is
    no recording.
    """
    facts: dict[str, Any] = {"path": str(source), "checksums": HOLD, "damaged": [], "says": ""}
    try:
        recording = read(source)
    except DamagedError as error:
        return facts | {"checksums": DAMAGED, "damaged": list(error.entities), "says": str(error)}
    if not recording.sealed:
        return facts | {"checksums": NONE, "says": f"{source}: checksums: {UNKNOWN}"}
    return facts | {"says": f"{source}: the checksums of its {len(recording.entities)} entities hold"}


def info(source: FilePath | Recording) -> dict[str, Any]:
    """Everything about a recording that is not its numbers, ready for JSON. source : path or Recording.

    Keys: path, bytes, application, contract, title, family, body, craft, rows, span_s, epoch, complete, ended,
    checksums ("hold", or "none" where the file has none of its own), identity, versions, accuracy, flights (of several
    that were recorded together: name, title, identity, rows, start_s), events, expectations, views,
    truth (entity -> column -> kind), picture (entities).
    """
    recording = read(source)
    scene: Mapping[str, np.ndarray] = recording.get("/scene", {})

    def told(name: str) -> Any:
        return plain(scene[name][0]) if name in scene else ""

    time = recording["/state"]["time_s"] if "/state" in recording else np.zeros(0)
    epoch, views = epoch_of(recording), views_of(recording)
    truth = truth_of(recording) + [name for name in ("/events",) if name in recording]
    known = {*truth, "/scene", *(f"{flight.path}/scene" for flight in recording.flights)}
    return {
        "path": str(recording.path),
        "bytes": recording.path.stat().st_size,
        "application": recording.application_id,
        "contract": recording.contract,
        "title": told("title"),
        "family": told("family"),
        "body": told("body"),
        "craft": told("craft_kind"),
        "rows": len(time),
        "span_s": [float(time[0]), float(time[-1])] if len(time) else None,
        "epoch": None if epoch is None else str(epoch.astype("datetime64[ms]")),
        "complete": recording.complete,
        "ended": told("ended"),
        "checksums": HOLD if recording.sealed else NONE,
        "identity": recording.identity,
        "versions": recording.versions,
        "accuracy": recording.accuracy,
        "flights": [
            {"name": f.name, "title": f.title, "identity": f.identity, "rows": f.rows, "start_s": f.start}
            for f in recording.flights
        ],
        "events": [{"name": event.name, "time_s": event.time} for event in recording.events],
        "expectations": [dict(item) for item in recording.resolved.get("expect", [])],
        "views": sorted(name for _, name, _ in (views or {})),
        "truth": {name: kinds(recording, name) for name in truth},
        "picture": [name for name in recording.entities if name not in known],
    }


def kinds(recording: Recording, name: str) -> dict[str, str]:
    """Column -> what it holds, e.g. "float64 x 3", from the schema of the first rows."""
    found = {}
    for table in recording.head(name).tables:
        for column in table.column_names:
            kind = table[column].type
            if not is_component(kind):
                continue
            inner = kind.value_type
            size = f" x {inner.list_size}" if pa.types.is_fixed_size_list(inner) else ""
            word = {"double": "float64", "float": "float32"}.get(str(innermost(kind)), str(innermost(kind)))
            found[short(column)] = word + size
    return found


def in_words(facts: dict[str, Any]) -> str:
    """The same, to be read."""
    lines = [facts["title"] or facts["path"]]

    def say(name: str, value: str) -> None:
        if value:
            lines.append(f"  {name:<13} {value}")

    size = facts["bytes"]
    say("file", f"{facts['path']}, {size / 1e6:.3g} MB" if size >= 1e5 else f"{facts['path']}, {size / 1e3:.3g} kB")
    application = facts["application"]
    say(
        "made by",
        f"{application}, contract {facts['contract']}" if facts["contract"] else f"{application} (no sailviz)",
    )
    say("family", f"{facts['family']}: {facts['craft']} round the {facts['body']}" if facts["family"] else "")
    if facts["span_s"]:
        start, end = facts["span_s"]
        say(
            "rows",
            f"{facts['rows']:,} over {duration(end - start)}" + (f", from {duration(start)} on" if start else ""),
        )
    say("epoch", f"{facts['epoch']} UTC" if facts["epoch"] else "")
    if facts["contract"] or not facts["complete"]:
        why = f"yes, ended by {facts['ended']}" if facts["ended"] else "yes"
        say("complete", why if facts["complete"] else "no: the run was interrupted, or the file was cut off")
    say("checksums", "those of every entity hold" if facts["checksums"] == HOLD else UNKNOWN)
    say("identity", facts["identity"])
    say("versions", ", ".join(f"{name} {number}" for name, number in facts["versions"].items()))
    say("accuracy", facts["accuracy"])
    for flight in facts["flights"]:
        start = f", from {duration(flight['start_s'])} on" if flight["start_s"] else ""
        say("flight", f"{flight['name']}: {flight['title']}, {flight['rows']:,} rows{start}, {flight['identity'][:16]}")
    for event in facts["events"]:
        say("event", f"{event['name']} at {duration(event['time_s'])}")
    for item in facts["expectations"]:
        say("expects", expectation(item))
    say("views", ", ".join(facts["views"]))
    for entity, columns in facts["truth"].items():
        say(entity, ", ".join(f"{name} ({kind})" for name, kind in columns.items()))
    say("picture", f"{len(facts['picture'])} entities")
    return "\n".join(lines)


def expectation(item: dict[str, Any]) -> str:
    """What the scene expects of a run."""
    at = item.get("at") or f"t = {duration(item.get('at_time') or 0.0)}"
    within = f"{item['within_percent']:g} %" if item.get("within_percent") else f"{item.get('within') or 0:g}"
    of = f", {item['statistic']} of {item['ensemble']}," if item.get("ensemble") else ""
    of = f" of {item['device']}" if item.get("device") else of
    return f"{item['quantity']}{of} at {at}: {item['value']:.10g} within {within}"


def as_json(facts: dict[str, Any]) -> str:
    """The same, for scripts."""
    return json.dumps(facts, indent=2)
