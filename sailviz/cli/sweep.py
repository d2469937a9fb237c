"""The command that flies a scene many times and writes one table. Heavy modules are imported inside."""

from __future__ import annotations

import json
import re
import sys
from collections import Counter
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from sailviz.cli.outputs import file_at
from sailviz.cli.shared import (
    BAD_INPUT,
    EXPECTATION_FAILED,
    INTERRUPTED,
    RUN_FAILED,
    say_if_compiling,
    set_option,
    tell,
    time_limit_option,
    values_of,
)
from sailviz.errors import RecordingError, SailvizError, SceneError, TimeLimitError

if TYPE_CHECKING:
    from sailviz.sweeps import Sweep
    from sailviz.sweeps.censoring import Number
    from sailviz.sweeps.definition import Definition


ENDINGS = (".parquet", ".csv", "")


@click.command()
@click.argument("scene")
@click.option(
    "--vary",
    multiple=True,
    metavar="KEY=VALUES",
    help="0.5:1.5:11, 0.1:10:21:log, 20,25,40, normal(1,0.05), uniform(a,b), lognormal(median,sigma), "
    "gamma(shape,scale) or seed; repeatable.",
)
@click.option("--together", is_flag=True, default=None, help="Listed values step in pace instead of making a grid.")
@click.option("--draws", type=click.IntRange(1), metavar="N", help="Flights per point of the grid.")
@click.option("--seed", type=click.IntRange(0), metavar="N", help="Of the draws; 0 by default.")
@click.option("--report", multiple=True, metavar="QUANTITY@MOMENT", help="To measure, e.g. radius_au@end; repeatable.")
@click.option(
    "--record",
    multiple=True,
    metavar="PICK",
    help="Flights to record: 0,5, min:COLUMN, max:COLUMN, median:COLUMN, failed.",
)
@set_option
@click.option(
    "-o", "--output", metavar="FILE", help="Table, .parquet or .csv; NAME-sweep.parquet in this folder by default."
)
@click.option(
    "--engine",
    default="processes",
    show_default=True,
    metavar="ENGINE",
    help="processes, threads, serial, dask (a cluster on this machine) or dask://HOST:PORT.",
)
@click.option("--workers", type=click.IntRange(1, 1024), metavar="N", help="As many as there are cores by default.")
@time_limit_option("End the whole sweep after so much wall time; flights that are done stay.")
@click.option("-q", "--quiet", is_flag=True, help="Print errors only.")
@click.option("--json", "as_json", is_flag=True, help="Print a summary that a script can read.")
def sweep(
    scene: str,
    vary: tuple[str, ...],
    together: bool | None,
    draws: int | None,
    seed: int | None,
    report: tuple[str, ...],
    record: tuple[str, ...],
    settings: tuple[str, ...],
    output: str | None,
    engine: str,
    workers: int | None,
    time_limit: float | None,
    quiet: bool,
    as_json: bool,
) -> None:
    """Fly a scene over a grid or over distributions of its keys, and write a table with a row per flight.

    SCENE is a scene or a sweep file, or the name of a shipped one. A sweep that was interrupted or killed goes on where
    it stopped when the same command is given again. Exit codes as for run: 1 if a flight missed an expectation of the
    scene, 3 if one failed.
    """
    quiet = quiet or as_json
    path = Path(f"{Path(scene).stem}-sweep.parquet" if output is None else output)
    try:
        file_at(path if output is None else output, "table", ENDINGS)
        from sailviz.sweeps.definition import define

        definition, wanted = define(scene, _varied(vary), draws, seed, _listed(report), together, values_of(settings))
        from sailviz.sweeps.loop import fly_all

        say_if_compiling(quiet)
        with _progress(path.stem, definition.flights, quiet) as progress:
            found = fly_all(definition, [*wanted, *_listed(record)], None, engine, workers, path, progress, time_limit)
    except KeyboardInterrupt:
        _say_unfinished("Interrupted", path)
        sys.exit(INTERRUPTED)
    except TimeLimitError as error:
        _say_unfinished(str(error), path)
        sys.exit(BAD_INPUT)
    except (SceneError, RecordingError, OSError) as error:
        tell(error)
        sys.exit(BAD_INPUT)
    except SailvizError as error:
        tell(f"{scene}: {error}")
        sys.exit(BAD_INPUT)
    if as_json:
        click.echo(json.dumps(_facts(found, definition), indent=2))
    elif not quiet:
        _tell(found, definition)
    if found.failed:
        sys.exit(RUN_FAILED)
    if found.missed:
        sys.exit(EXPECTATION_FAILED)


def _varied(items: Iterable[str]) -> dict[str, str]:
    found = {}
    for item in items:
        key, equals, text = item.partition("=")
        if not equals or not key.strip():
            raise click.BadParameter(f"{item!r} is not KEY=VALUES", param_hint="--vary")
        if key.strip() in found:
            raise click.BadParameter(f"{key.strip()} is given twice", param_hint="--vary")
        found[key.strip()] = text.strip()
    return found


def _listed(items: Iterable[str]) -> list[str]:
    return [word.strip() for item in items for word in item.split(",") if word.strip()]


@contextmanager
def _progress(title: str, flights: int, quiet: bool) -> Iterator[Callable[[int, int], None] | None]:
    """A bar with flights, their rate and the time left, silent when not on a terminal."""
    if quiet or not sys.stderr.isatty():
        yield None
        return
    from tqdm import tqdm

    with tqdm(total=flights, desc=title[:40], unit=" flights", delay=1, leave=False, smoothing=0.1) as bar:
        begun: list[int] = []

        def progress(done: int, _: int) -> None:
            if not begun:  # flights done before say nothing of the rate
                begun.append(done)
                bar.initial = bar.n = done
            bar.update(done - bar.n)

        yield progress


def _say_unfinished(why: str, path: Path) -> None:
    from sailviz.sweeps.loop import parquet_of

    rows = 0
    if parquet_of(path).exists():
        import pyarrow.parquet as pq

        rows = pq.read_metadata(parquet_of(path)).num_rows
    where = f"{path} holds the {rows:,} flights that are done" if rows else "no flight was done yet"
    click.echo(f"{why}: {where}. The same command goes on from there.", err=True)


def _statistics(found: Sweep, definition: Definition) -> dict[str, dict[str, Number | int]]:
    """Of every measured column: how many flights have it, how many are still on their way, and its statistics."""
    from sailviz.sweeps.censoring import AT_LEAST, bounded, statistics

    asked = definition.asked
    bounds = bounded(asked)
    table = found.to_arrow([*asked, *(name + AT_LEAST for name in bounds)])
    told: dict[str, dict[str, Number | int]] = {}
    for name in asked:
        values = table[name].to_numpy()
        least = table[name + AT_LEAST].to_numpy() if name in bounds else values[:0]
        numbers = statistics(values, least)
        if numbers:
            known, on_their_way = (int((column == column).sum()) for column in (values, least))
            told[name] = {"flights": known, "running": on_their_way, **numbers}
    return told


def _facts(found: Sweep, definition: Definition) -> dict[str, Any]:
    return {
        "table": str(found.path),
        "flights": found.flights,
        "failed": found.failed,
        "running": found.running,
        "missed": found.missed,
        "resumed": found.resumed,
        "recordings": {str(number): str(path) for number, path in found.recordings.items()},
        "statistics": {name: _plain(numbers) for name, numbers in _statistics(found, definition).items()},
    }


def _plain(numbers: dict[str, Number | int]) -> dict[str, Any]:
    """A column's statistics for JSON; `at_least` names those that are bounds."""
    told: dict[str, Any] = {
        word: number if isinstance(number, int) else number.value for word, number in numbers.items()
    }
    return told | {"at_least": [word for word, number in numbers.items() if isinstance(number, tuple) and number[1]]}


def _tell(found: Sweep, definition: Definition) -> None:
    before = f", {found.resumed:,} of them done before" if found.resumed else ""
    click.echo(f"{definition.scene().title}: {found.flights:,} flights{before}")
    shown = {"mean": "mean", "deviation": "deviation", "min": "min", "p5": "5 %", "median": "median", "p95": "95 %",
             "max": "max"}  # fmt: skip
    rows: list[tuple[str, ...]] = [("quantity", "flights", "running", *shown.values())]
    for name, numbers in _statistics(found, definition).items():
        rows.append((name, *(_cell(numbers.get(word)) for word in ("flights", "running", *shown))))
    if not found.running:
        rows = [(*row[:2], *row[3:]) for row in rows]
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    for row in rows if len(rows) > 1 else ():
        cells = [
            cell.rjust(width) if i else cell.ljust(width)
            for i, (cell, width) in enumerate(zip(row, widths, strict=True))
        ]
        click.echo("  ".join(cells))
    if found.running:
        click.echo(f"{found.running:,} had not come where they were awaited when their time was over")
    if found.missed:
        click.echo(f"{found.missed:,} missed an expectation of the scene")
    if found.failed:
        click.echo(f"{found.failed:,} failed:")
        for reason, count in _reasons(found):
            click.echo(f"  {count:,}: {reason}")
    click.echo(f"Wrote {found.path}")
    for number, path in found.recordings.items():
        click.echo(f"Recorded flight {number}: {path}")


def _cell(number: Number | int | None) -> str:
    if number is None:
        return "-"
    if isinstance(number, int):
        return f"{number:,}"
    return ("at least " if number.at_least else "") + f"{number.value:.7g}"


def _reasons(found: Sweep, most: int = 5) -> list[tuple[str, int]]:
    """The commonest reasons of failure, shortened, numbers left out so that equal ones count together."""
    words = Counter(
        re.sub(r"[-+]?\d[\d.]*(e[-+]?\d+)?", "#", reason)[:160]
        for reason in found.to_arrow(["reason"])["reason"].to_pylist()
        if reason
    )
    return words.most_common(most)
