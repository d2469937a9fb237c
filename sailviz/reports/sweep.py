"""The report of a sweep, from its table: what varied, what came of it, and for descents how many come down in time."""

from __future__ import annotations

import hashlib
import json
import math
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from sailviz.deorbits.disposal import DOWN, NOT_COVERED, RULES, shares_within
from sailviz.errors import RecordingError
from sailviz.reports.page import Page, Section, Table
from sailviz.reports.sweep_pictures import column as column_of
from sailviz.reports.sweep_pictures import sweep_pictures
from sailviz.sweeps.censoring import AT_LEAST, Number, bounded, statistics
from sailviz.sweeps.flight import FAILED
from sailviz.sweeps.report import column, reported
from sailviz.units import UNITS
from sailviz.version import __version__

if TYPE_CHECKING:
    import pyarrow as pa

    from sailviz.scene import Scene

SHOWN = {"mean": "mean", "deviation": "deviation", "min": "least", "p5": "5 %", "median": "median", "p95": "95 %",
         "max": "largest"}  # fmt: skip
FACTS = b"sailviz.sweep"
MOST_ROWS = 60  # of the table of flights that a page shows


def sweep_page(
    table: pa.Table, scene: Scene | None, *, path: Path | None = None, again: str = "", pictures: bool = True
) -> Page:
    """The page of the table of a sweep. scene : that was varied, None if it is not at hand; path : of the table;
    again : the command that flies it; pictures : whether one is drawn. RecordingError for a table that is not of a
    sweep."""
    facts = facts_of(table)
    asked = [name for name in table.column_names if _is_asked(name)]
    rows = table.num_rows
    title = f"{scene.title if scene is not None else facts['scene']}: {rows:,} flights"
    seen, no_picture = sweep_pictures(table, facts, asked, title) if pictures else ((), "")
    sections = [
        *_disposal(table, asked, facts),
        *_numbers(table, asked),
        *([Section("Pictures", (no_picture,) * bool(no_picture), pictures=seen)] if seen or no_picture else []),
        _varied(facts, table),
        _flights(table, facts, asked),
    ]
    answer = tuple(_answer(table, asked))
    made = [("scene", str(facts["scene"])), ("flown by", f"sailviz {facts['sailviz']}"), ("seed", str(facts["seed"]))]
    if path is not None:
        made += [("table", path.name), ("SHA-256", hashlib.sha256(path.read_bytes()).hexdigest())]
    made += [("fly it again", again)] * bool(again)
    values = tuple((key, _plain(value)) for key, value in facts["values"].items())
    sections += [
        Section("Inputs", tables=(Table(tuple(made)),)),
        Section("Scene", tables=(Table(values, caption="Every value that the scene's file or the sweep sets"),)),
    ]
    return Page(
        title, answer, tuple(sections), f"sailviz {__version__}; every number is read from the table of the sweep."
    )


def facts_of(table: pa.Table) -> dict[str, Any]:
    """The definition that the table of a sweep holds. RecordingError where it holds none."""
    try:
        facts = json.loads((table.schema.metadata or {})[FACTS])
        return {
            key: facts[key] for key in ("scene", "values", "vary", "together", "draws", "seed", "report", "sailviz")
        }
    except (KeyError, ValueError, TypeError):
        raise RecordingError(
            "this table does not say of which sweep it is: a report is of one that sailviz wrote"
        ) from None


def _is_asked(name: str) -> bool:
    """Whether a column holds a measured quantity, QUANTITY@MOMENT."""
    if "@" not in name or name.endswith((AT_LEAST, " passed")):
        return False
    try:
        return column(reported(name.split(" #")[0])) != ""
    except ValueError:
        return False


def _answer(table: pa.Table, asked: list[str]) -> Iterator[str]:
    """The sentences that a sweep is read for."""
    times = _times(asked)
    for name in times:
        values, least = column_of(table, name), column_of(table, name + AT_LEAST)
        event = name.split("@")[1]
        numbers = statistics(values, least)
        if not numbers:
            continue
        said = ", ".join(f"{SHOWN[key]} {_cell(numbers[key])}" for key in ("p5", "median", "p95"))
        yield f"Until {event}: {said} {_unit(name)}."
        still = int(np.count_nonzero(np.isfinite(least)))
        if still:
            share = f"{still:,} of {table.num_rows:,} flights ({still / table.num_rows:.1%})"
            yield f"{share} had not come there when their time was over."
    if not times and asked:
        numbers = statistics(column_of(table, asked[0]), np.zeros(0))
        if numbers:
            least_to_largest = f"from {_cell(numbers['min'])} to {_cell(numbers['max'])}"
            yield f"{asked[0]}: median {_cell(numbers['median'])}, {least_to_largest}."
    failed = table["status"].to_pylist().count(FAILED)
    if failed:
        yield f"{failed:,} flights failed; what is told here leaves them out."
    if not asked:
        yield "Nothing was measured: the sweep asks for no quantity."


def _lowest(facts: dict[str, Any]) -> set[str]:
    """Names of the scene's events at altitudes from which every craft comes down."""
    events = facts["values"].get("event")
    found = set()
    for event in events if isinstance(events, list) else ():
        for unit, size in UNITS["length"].items():
            height = event.get(f"altitude_{unit}")
            if event.get("kind") == "altitude" and isinstance(height, (int, float)) and height * size <= DOWN:
                found.add(event.get("name"))
    return found


def _disposal(table: pa.Table, asked: list[str], facts: dict[str, Any]) -> Iterator[Section]:
    """Of descents to an event from which nothing stays up: how many come there within each limit."""
    ends = _lowest(facts)
    values = {name: factor for name, factor in _times(asked).items() if name.split("@")[1] in ends}
    for name, factor in values.items():
        known, least = column_of(table, name) * factor, column_of(table, name + AT_LEAST) * factor
        flown = np.isfinite(known) | np.isfinite(least)
        known, least = known[flown], least[flown]
        if not len(known):
            continue
        rows = []
        for limit, seconds, rule in RULES:
            kept, late, open_ = shares_within(known, least, seconds)
            rows.append((limit, *(f"{count:,} ({count / len(known):.1%})" for count in (kept, late, open_)), rule))
        head = ("limit", "down within it", "not", "not flown so long", "rule")
        yield Section("Disposal", NOT_COVERED, (Table(tuple(rows), head, "Counted from the start of each flight"),))


def _numbers(table: pa.Table, asked: list[str]) -> Iterator[Section]:
    times, rows = _times(asked), []
    for name in asked:
        least = column_of(table, name + AT_LEAST) if name in times else np.zeros(0)
        known = column_of(table, name)
        numbers = statistics(known, least)
        counts = (f"{np.count_nonzero(np.isfinite(known)):,}", f"{np.count_nonzero(np.isfinite(least)):,}")
        rows.append((name, *counts, *(_cell(numbers.get(key)) for key in SHOWN)))
    if rows:
        head = ("quantity", "flights", "still flying", *SHOWN.values())
        yield Section("What came of it", tables=(Table(tuple(rows), head),))


def _varied(facts: dict[str, Any], table: pa.Table) -> Section:
    rows = []
    for key, words in facts["vary"].items():
        flown = [value for value in table[key].to_pylist() if value is not None]
        numbers = [value for value in flown if isinstance(value, (int, float))]
        span = f"{min(numbers):.6g} to {max(numbers):.6g}" if numbers else f"{len(set(map(str, flown)))} values"
        rows.append((key, _plain(words), span))
    said = () if rows else ("Nothing was varied.",)
    tables = (Table(tuple(rows), ("key", "as asked for", "flown")),) if rows else ()
    return Section("What was varied", said, tables)


def _flights(table: pa.Table, facts: dict[str, Any], asked: list[str]) -> Section:
    names = ["index", *facts["vary"], "status", "ended", *asked]
    names = [name for name in names if name in table.column_names]
    some = table.select(names).slice(0, MOST_ROWS).to_pylist()
    rows = tuple(tuple(_plain(row[name]) for name in names) for row in some)
    more = f"The first {MOST_ROWS} of {table.num_rows:,}" if table.num_rows > MOST_ROWS else "All of them"
    return Section("Flights", tables=(Table(rows, tuple(names), more),))


def _times(asked: list[str]) -> dict[str, float]:
    """Column -> seconds of its unit, of the times at which something happens."""
    return bounded({name: reported(name) for name in asked if " #" not in name})


def _unit(name: str) -> str:
    quantity = name.split("@")[0]
    return next((unit for unit in UNITS["time"] if quantity == f"time_{unit}"), "")


def _cell(number: Number | None) -> str:
    if number is None:
        return "-"
    return ("at least " if number.at_least else "") + f"{number.value:.6g}"


def _plain(value: object) -> str:
    if value is None or (isinstance(value, float) and math.isnan(value)):
        return "-"
    return f"{value:.7g}" if isinstance(value, float) else str(value)
