"""The command that answers how fast a sail gets somewhere, and writes the flight down as a scene."""

from __future__ import annotations

import json
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

import click

from sailviz.cli.numbers import Number
from sailviz.cli.outputs import file_at
from sailviz.cli.shared import BAD_INPUT, EXPECTATION_FAILED, progress_bar, say_if_compiling, tell
from sailviz.cli.transfer_in_words import summary, words
from sailviz.cli.transfer_question import Question, question_options
from sailviz.constants import DAY
from sailviz.errors import OutputError
from sailviz.files import write_text

if TYPE_CHECKING:
    from sailviz.transfers import Place

TABLE_MM_S2 = (2.0, 1.5, 1.0, 0.75, 0.5, 0.35, 0.25)


@click.command()
@click.argument("origin", metavar="FROM")
@click.argument("target", metavar="TO", required=False)
@click.option(
    "--sail",
    "sails",
    multiple=True,
    metavar="NAME",
    help="ideal (default), eta-perfect, jpl-1978, jpl-2015, electric-sail, electric-sail-original, ...-updated or "
    "...-polynomial. Several with --table.",
)
@click.option(
    "-a",
    "--acceleration",
    type=Number(0, 1e3, "mm/s²", above=True),
    default=1.0,
    show_default=True,
    metavar="MM_S2",
    help="At 1 au, in mm/s².",
)
@question_options
@click.option("--table", "as_table", is_flag=True, help="Flight times over the acceleration, between circles.")
@click.option("-o", "--output", metavar="FILE", help="Write the flight as a scene that sailviz run flies.")
@click.option(
    "--form",
    type=click.Choice(["costates", "table"]),
    default="costates",
    show_default=True,
    help="How the scene steers: from initial costates, or by a table of attitudes.",
)
@click.option("--json", "as_json", is_flag=True, help="Print what was found for a script to read.")
@click.option("-q", "--quiet", is_flag=True, help="Print the flight time in days only.")
def transfer(
    origin: str,
    target: str | None,
    sails: tuple[str, ...],
    acceleration: float,
    as_table: bool,
    output: str | None,
    form: str,
    as_json: bool,
    quiet: bool,
    **options: Any,
) -> None:
    """Find the fastest flight of a sail from one orbit to another, and how it must be steered.

    FROM and TO are planets, mercury to neptune, or small bodies such as ceres, apophis or kamooalewa; by default their
    orbits are circles in one plane. Exit code 1 where no flight was found; the nearest one is then told.
    """
    sails = sails or ("ideal",)
    asked = Question.taken(options)
    try:
        asked.check(target, sails, as_table, output)
        if output is not None and output != "-":
            file_at(output, "scene")
        from sailviz.transfers import find, place, scene_of

        say_if_compiling(quiet or as_json)
        start, aim = place(origin), asked.aim(target)
        if as_table:
            _table(start, aim, sails, quiet, as_json)
            return
        with _progress(f"{start.name} to {aim.name}", quiet or as_json) as progress:
            found = find(
                start, aim, sails[0], acceleration * 1e-3,
                orbits=asked.orbits, departure=asked.departure, starts=asked.starts, dates=asked.dates,
                progress=progress,
            )  # fmt: skip
        text = scene_of(found, form) if output is not None and found.flight.feasible else None
    except (ValueError, OutputError) as error:
        tell(error)
        raise click.exceptions.Exit(BAD_INPUT) from None
    if as_json:
        click.echo(json.dumps(summary(found), indent=2))
    elif quiet and found.flight.feasible:
        click.echo(f"{found.flight.time / DAY:.6f}")
    else:
        click.echo("\n".join(words(found)))
    if not found.flight.feasible:
        raise click.exceptions.Exit(EXPECTATION_FAILED)
    if output is not None and text is not None:
        _write(output, text, quiet or as_json)


@contextmanager
def _progress(title: str, quiet: bool) -> Iterator[Callable[[float, str], None] | None]:
    with progress_bar(title, quiet) as bar:
        yield None if bar is None else lambda share, words: bar(min(max(share, 0.0), 1.0))


def _table(start: Place, end: Place, sails: Sequence[str], quiet: bool, as_json: bool) -> None:
    """Flight times over the acceleration, one column per sail."""
    import numpy as np

    from sailviz.design.minimum_time.state_costate import canonical_sail
    from sailviz.transfers import flight_times

    for sail in sails:
        canonical_sail(sail, 1e-3)  # ValueError for what is no sail, before the work begins
    with _progress(f"{start.name} to {end.name}", quiet or as_json) as progress:
        found = flight_times(start, end, sails, np.array(TABLE_MM_S2) * 1e-3, progress=progress)
    if as_json:
        days = [[None if np.isnan(x) else x / DAY for x in row] for row in found.time]
        values = {"characteristic_acceleration_mm_s2": TABLE_MM_S2, "sails": sails, "time_d": days}
        click.echo(json.dumps(values, indent=2))
        return
    click.echo(f"{start.name} to {end.name}, between circles in one plane: days (revolutions), best found")
    width = max(22, *(len(sail) + 2 for sail in sails))
    click.echo("  mm/s²" + "".join(sail.rjust(width) for sail in sails))
    for a, times, turns in zip(TABLE_MM_S2, found.time, found.revolutions, strict=True):
        cells = ["none found" if np.isnan(t) else f"{t / DAY:.4f} ({n:.3f})" for t, n in zip(times, turns, strict=True)]
        click.echo(f"{a:7.2f}" + "".join(cell.rjust(width) for cell in cells))


def _write(output: str, text: str, quiet: bool) -> None:
    if output == "-":
        if not sys.stdout.isatty():  # a scene is UTF-8 whatever the console speaks
            sys.stdout.buffer.write(text.encode())
        else:
            sys.stdout.write(text)
        return
    try:
        write_text(output, text, "scene")
    except OutputError as error:
        tell(error)
        raise click.exceptions.Exit(BAD_INPUT) from None
    if not quiet:
        click.echo(f"Wrote {output}; fly it with: sailviz run {output}")
