"""Flying a few flights of a sweep, in whatever process; what comes back is rows of numbers, never an exception of
theirs."""

from __future__ import annotations

import json
import time
from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

import sailviz
from sailviz.errors import PropagationError, SailvizError, SceneError, TimeLimitError
from sailviz.scene.loading import Scene
from sailviz.sweeps.censoring import AT_LEAST, bounded, still_running
from sailviz.sweeps.definition import Definition

if TYPE_CHECKING:
    import pyarrow as pa

OK, RUNNING, FAILED = "ok", "running", "failed"
DIED = "the worker process died, for lack of memory perhaps"
_scenes: dict[str, Scene] = {}  # of the definition that this process flies


def schema_of(definition: Definition) -> pa.Schema:
    """Columns of the table of a sweep, in order."""
    import pyarrow as pa

    columns = [("index", pa.int64())]
    for axis in definition.axes:
        columns.append((axis.key, _type_of(axis.values)))
    for draw in definition.drawn:
        columns.append((draw.key, pa.int64() if draw.distribution == "seed" else pa.float64()))
    columns += [("seed", pa.int64()), ("status", pa.string()), ("reason", pa.string()), ("ended", pa.string())]
    columns += [("duration_s", pa.float64())]
    for name in definition.expected:
        columns += [(name, pa.float64()), (f"{name} passed", pa.bool_())]
    columns += [(name, pa.float64()) for name in definition.report if name not in definition.expected]
    columns += [(name + AT_LEAST, pa.float64()) for name in bounded(definition.asked)]
    return pa.schema([*columns, ("wall_s", pa.float64())])


def _type_of(values: Iterable[Any]) -> pa.DataType:
    import pyarrow as pa

    kinds = {type(value) for value in values}
    if kinds == {bool}:
        return pa.bool_()
    if kinds == {int}:
        return pa.int64()
    return pa.float64() if kinds <= {int, float} else pa.string()


def _cell(value: Any, kind: str) -> Any:
    """A varied value as its column takes it; in a column of words, lists and tables as JSON."""
    if kind != "string":
        return value
    return json.dumps(value, default=str) if isinstance(value, (list, dict)) else str(value)


def fly(definition: Definition, first: int, stop: int, time_limit: float | None = None) -> list[dict[str, Any]]:
    """Rows of the flights first ... stop - 1. Raises only if this process runs another sailviz, or TimeLimitError when
    the flights together have taken time_limit s of wall time."""
    if definition.version != sailviz.__version__:
        raise SailvizError(f"a worker runs sailviz {sailviz.__version__}, this is {definition.version}")
    scene = _scenes.get(definition.identity)
    if scene is None:
        _scenes.clear()
        scene = _scenes[definition.identity] = definition.scene()
    until = None if time_limit is None else time.perf_counter() + time_limit
    return [_row(definition, scene, flight, until) for flight in range(first, stop)]


def blank(definition: Definition, flight: int) -> dict[str, Any]:
    """What is known of a flight before it flies."""
    kinds = {axis.key: str(_type_of(axis.values)) for axis in definition.axes}
    values = {key: _cell(value, kinds.get(key, "")) for key, value in definition.values(flight).items()}
    return {"index": flight, **values, "seed": definition.seed_of(flight), "status": FAILED, "reason": "", "ended": ""}


def _row(definition: Definition, scene: Scene, flight: int, until: float | None) -> dict[str, Any]:
    row = blank(definition, flight)
    began = time.perf_counter()
    flown: list[float] = []
    try:
        row |= _measured(definition, scene.with_values(definition.values(flight)), flown, until)
    except TimeLimitError:
        raise
    except SceneError as error:
        row["reason"] = "; ".join(map(str, error.faults))
    except PropagationError as error:
        row["reason"], flown = str(error), [error.time]
    except Exception as error:  # whatever it is, the other flights go on
        if isinstance(error.__cause__, KeyboardInterrupt):  # pydantic makes an error of its own of Ctrl-C
            raise error.__cause__ from None
        row["reason"] = f"{type(error).__name__}: {error}"
    row["duration_s"] = flown[-1] if flown else 0.0
    row["wall_s"] = time.perf_counter() - began
    return row


def _measured(definition: Definition, scene: Scene, flown: list[float], until: float | None) -> dict[str, Any]:
    from sailviz.checks.expectations import Judge
    from sailviz.simulation import simulate_blocks

    reported = definition.reported()
    judge = Judge(scene.model_copy(update={"expect": [*scene.expect, *reported]}))
    ended = ""
    limit = None if until is None else max(until - time.perf_counter(), 1e-9)
    for block in simulate_blocks(scene, drawn=False, time_limit=limit):
        judge.add(block)
        flown[:], ended = [float(block.time[-1])], block.ended
    verdicts = judge.verdicts()
    count = len(verdicts) - len(reported)
    found = {name: _number(verdict.measured) for name, verdict in zip(definition.report, verdicts[count:], strict=True)}
    for name, verdict in zip(definition.expected, verdicts[:count], strict=False):
        found |= {name: _number(verdict.measured), f"{name} passed": verdict.passed}
    items = zip([*scene.expect, *reported], (verdict.measured for verdict in verdicts), strict=True)
    running = still_running(items, any(event.stop for event in scene.event), ended)
    for name, unit in bounded(definition.asked).items() if running else ():
        found[name + AT_LEAST] = None if found[name] is not None else flown[-1] / unit
    return found | {"ended": ended, "status": RUNNING if running else OK}


def _number(value: float) -> float | None:
    """Nothing instead of NaN: what was never measured has no number."""
    return None if value != value else value
