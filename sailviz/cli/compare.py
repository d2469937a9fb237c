"""The command that says by how much two recordings differ."""

from __future__ import annotations

import json
import sys
from collections.abc import Iterable

import click

from sailviz.cli.flight_options import FlightOptions, body_option
from sailviz.cli.shared import in_one_sentence

DIFFERENT = 1


@click.command()
@click.argument("a")
@click.argument("b")
@click.option("--atol", multiple=True, metavar="[QUANTITY=]X", help="Allowed difference, e.g. /state:position_m=1.0.")
@click.option("--rtol", multiple=True, metavar="[QUANTITY=]X", help="Allowed difference relative to A; 0 by default.")
@click.option(
    "--on", type=click.Choice(["sim_time", "step"]), default="sim_time", show_default=True, help="Pair rows by it."
)
@body_option
@click.option("--no-picture", is_flag=True, help="Compare numbers and events only.")
@click.option("--json", "as_json", is_flag=True, help="Print what a script can read.")
@click.option("-q", "--quiet", is_flag=True, help="Print nothing: the exit code says it.")
def compare(
    a: str,
    b: str,
    atol: tuple[str, ...],
    rtol: tuple[str, ...],
    on: str,
    body: str,
    no_picture: bool,
    as_json: bool,
    quiet: bool,
) -> None:
    """Compare two recordings, tables written by export --to npz, or flights of others.

    Prints the largest difference of every quantity, where and when. Without --atol a quantity may differ by 1e-9 of its
    largest value. Exit code 0: equal, 1: different, 2: unreadable.
    """
    from sailviz import recording
    from sailviz.recording.comparison.tables import of_run
    from sailviz.recording.flights import is_flight

    with in_one_sentence():
        said = FlightOptions(body)
        said.check((a, b))
        found = recording.compare(
            *(of_run(said.read(file), file) if body and is_flight(file) else file for file in (a, b)),
            atol=_tolerances(atol, "--atol") or None,
            rtol=_tolerances(rtol, "--rtol"),
            on=on,
            picture=not no_picture,
        )
    if as_json:
        click.echo(json.dumps(found.to_dict(), indent=2))
    elif not quiet:
        click.echo(str(found))
    sys.exit(0 if found.equal else DIFFERENT)


def _tolerances(given: Iterable[str], option: str) -> dict[str, float]:
    """["/state:position_m=1.0", "1e-6"] -> {"/state:position_m": 1.0, "": 1e-6}."""
    found = {}
    for item in given:
        name, _, number = item.rpartition("=")
        try:
            found[name.strip()] = allowed = float(number)
        except ValueError:
            raise click.BadParameter(f"{item!r} is not a number or QUANTITY=NUMBER", param_hint=option) from None
        if not allowed >= 0:  # infinity lets a quantity go unlooked at
            raise click.BadParameter(f"{item!r}: what is allowed is a number of at least 0", param_hint=option)
    return found
