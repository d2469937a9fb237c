"""Which flights of a sweep to record, and their recordings: by number, or by what the table says of them."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from sailviz.errors import Fault, PropagationError, SceneError
from sailviz.sweeps.definition import Definition
from sailviz.sweeps.flight import FAILED, schema_of
from sailviz.words import nearest

if TYPE_CHECKING:
    import pyarrow as pa

    from sailviz.sweeps.store import FileStore

Pick = int | tuple[str, str]

_RULES = ("min", "max", "median")


def check_picks(definition: Definition, wanted: Iterable[str | int]) -> list[Pick]:
    """Flights by number, or ("min" | "max" | "median", column), or ("failed", ""). SceneError names every wrong one."""
    found: list[Pick] = []
    faults = []
    columns = [
        name
        for name, kind in zip(schema_of(definition).names, schema_of(definition).types, strict=True)
        if str(kind) in ("double", "int64")
    ]
    for item in wanted:
        rule, colon, name = str(item).strip().partition(":")
        if rule.isdecimal() and not colon:
            if int(rule) < definition.flights:
                found.append(int(rule))
            else:
                faults.append(Fault("record", f"there is no flight {rule}: they are 0 to {definition.flights - 1}."))
        elif rule == "failed" and not colon:
            found.append(("failed", ""))
        elif rule in _RULES and colon:
            if name in columns:
                found.append((rule, name))
            else:
                faults.append(Fault("record", f'"{name}" is no column of numbers.', nearest(name, columns)))
        else:
            words = "a flight's number, min:COLUMN, max:COLUMN, median:COLUMN or failed"
            faults.append(Fault("record", f'"{item}" picks nothing: write {words}.'))
    if faults:
        raise SceneError(faults, "sweep")
    return found


def picked(picks: Iterable[Pick], table: pa.Table) -> list[int]:
    """Numbers of the flights, each once; a rule that no flight meets picks none."""
    index = table["index"].to_numpy()
    good = np.array([status != FAILED for status in table["status"].to_pylist()], dtype=bool)
    found: list[int] = []
    for pick in picks:
        if isinstance(pick, int):
            found.append(pick)
        elif pick[0] == "failed":
            found += index[~good][:1].tolist()
        else:
            values = table[pick[1]].to_numpy().astype(float)
            usable = np.flatnonzero(good & np.isfinite(values))
            if len(usable):
                order = usable[np.argsort(values[usable], kind="stable")]
                place = {"min": 0, "max": -1, "median": (len(order) - 1) // 2}[pick[0]]
                found.append(int(index[order[place]]))
    return list(dict.fromkeys(found))


def record_picked(definition: Definition, picks: Sequence[Pick], store: FileStore) -> dict[int, Path]:
    """Fly the picked flights once more, in this process, and record each as NAME-NUMBER.rrd beside the table. A flight
    that broke down is recorded as far as it came, one that never began not at all."""
    from sailviz.recording import record
    from sailviz.simulation import simulate_blocks

    digits = len(str(definition.flights - 1))
    scene = definition.scene()
    written: dict[int, Path] = {}
    columns = [name for _, name in (pick for pick in picks if isinstance(pick, tuple)) if name]
    for flight in picked(picks, store.columns(["index", "status", *dict.fromkeys(columns)])):
        path = store.path.with_name(f"{store.path.stem}-{flight:0{digits}d}.rrd")
        values = definition.values(flight)
        words = ", ".join(f"{key.rpartition('.')[2]} {_short(value)}" for key, value in values.items())
        try:
            made = scene.with_values({"title": f"{scene.title}: flight {flight}, {words}", **values})
            record(simulate_blocks(made), path)
        except PropagationError:
            pass
        except SceneError:
            continue
        if path.exists():
            written[flight] = path
    return written


def _short(value: Any) -> str:
    return f"{value:.6g}" if isinstance(value, float) else str(value)
