"""The command that answers how fast a sail gets somewhere, and writes the flight down as a scene."""

from __future__ import annotations

import json
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

import click

from sailviz.cli.numbers import Number
from sailviz.cli.outputs import file_at
from sailviz.cli.shared import (
    BAD_INPUT,
    EXPECTATION_FAILED,
    INTERRUPTED,
    progress_bar,
    say_if_compiling,
    tell,
    time_limit_option,
)
from sailviz.cli.transfer_in_words import days, summary, words
from sailviz.cli.transfer_question import Question, question_options
from sailviz.constants import DAY
from sailviz.design.direct.extra import NoCasadiError
from sailviz.errors import OutputError
from sailviz.files import write_text

if TYPE_CHECKING:
    from sailviz.design.minimum_time.effort import Effort
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
@time_limit_option("Stop after so much wall time, with the best flight found until then, marked.")
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
    time_limit: float | None,
    as_json: bool,
    quiet: bool,
    **options: Any,
) -> None:
    """Find the fastest flight of a sail from one orbit to another, and how it must be steered.

    FROM and TO are planets, mercury to neptune, or small bodies such as ceres, apophis or kamooalewa; by default their
    orbits are circles in one plane. Exit code 1 where no flight was found, or none can be: the message says which, and
    what came nearest. Ctrl-C keeps the best flight found until then, marked, and -o writes it; exit code 130.
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
            assert aim is not None, "check has seen that there is one"
            _table(start, aim, sails, time_limit, quiet, as_json)
            return
        with _effort(
            start.name if aim is None else f"{start.name} to {aim.name}", time_limit, quiet or as_json
        ) as effort:
            found = find(
                start, aim, sails[0], acceleration * 1e-3, end=asked.end, within=asked.within,
                orbits=asked.orbits, departure=asked.departure, starts=asked.starts, dates=asked.dates,
                method=asked.method, limits=asked.limits, effort=effort,
            )  # fmt: skip
        text = scene_of(found, form) if output is not None and found.flight.feasible else None
    except (ValueError, OutputError, NoCasadiError) as error:
        tell(error)
        raise click.exceptions.Exit(BAD_INPUT) from None
    if as_json:
        click.echo(json.dumps(summary(found), indent=2))
    elif quiet and found.flight.feasible:
        click.echo(days(found.flight))
        if found.flight.ending.mark:
            tell(found.flight.ending.mark.strip())
    else:
        click.echo("\n".join(words(found)))
    if output is not None and text is not None:
        _write(output, text, quiet or as_json)
    _end(effort, EXPECTATION_FAILED if not found.flight.feasible else 0)


@contextmanager
def _effort(title: str, time_limit: float | None, quiet: bool) -> Iterator[Effort]:
    """What a search may take, with a bar; Ctrl-C ends it with the best so far."""
    from sailviz.design.minimum_time.effort import Effort

    with progress_bar(title, quiet) as bar:
        effort = Effort(time_limit, None if bar is None else lambda share, words: bar(share))
        with effort.listening():
            yield effort


def _end(effort: Effort, code: int) -> None:
    """End the command with the code, or with that of Ctrl-C where it was heard."""
    from sailviz.design.minimum_time.effort import INTERRUPTED as HEARD

    code = INTERRUPTED if effort.stopped == HEARD else code
    if code:
        raise click.exceptions.Exit(code)


def _table(
    start: Place, end: Place, sails: Sequence[str], time_limit: float | None, quiet: bool, as_json: bool
) -> None:
    """Flight times over the acceleration, one column per sail."""
    import numpy as np

    from sailviz.design.minimum_time.effort import FOUND, STOPPED
    from sailviz.design.minimum_time.state_costate import canonical_sail
    from sailviz.transfers import flight_times

    for sail in sails:
        canonical_sail(sail, 1e-3)  # ValueError for what is no sail, before the work begins
    with _effort(f"{start.name} to {end.name}", time_limit, quiet or as_json) as effort:
        found = flight_times(start, end, sails, np.array(TABLE_MM_S2) * 1e-3, effort=effort)
    if as_json:
        days = [[None if np.isnan(x) else x / DAY for x in row] for row in found.time]
        values = {
            "characteristic_acceleration_mm_s2": TABLE_MM_S2,
            "sails": sails,
            "time_d": days,
            "outcome": found.outcome.tolist(),
            "stopped": effort.stopped or None,
        }
        click.echo(json.dumps(values, indent=2))
        _end(effort, 0)
        return
    click.echo(f"{start.name} to {end.name}, between circles in one plane: days (revolutions), best found")
    width = max(22, *(len(sail) + 2 for sail in sails))
    click.echo("  mm/s²" + "".join(sail.rjust(width) for sail in sails))
    for i, a in enumerate(TABLE_MM_S2):
        cells = [
            f"{t / DAY:.4f} ({n:.3f})" if outcome == FOUND else outcome
            for t, n, outcome in zip(found.time[i], found.revolutions[i], found.outcome[i], strict=True)
        ]
        click.echo(f"{a:7.2f}" + "".join(cell.rjust(width) for cell in cells))
    if effort.stopped:
        click.echo(f"{STOPPED[effort.stopped]} after {effort.seconds:.1f} s.")
    _end(effort, 0)


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
