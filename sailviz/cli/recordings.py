"""The commands that read recordings: info, export, compare, digest. Heavy modules are imported inside."""

from __future__ import annotations

import json
import sys
from contextlib import contextmanager

import click

from sailviz.errors import RecordingError

DIFFERENT, UNREADABLE, INTERRUPTED = 1, 2, 130


@contextmanager
def _one_sentence():
    """What cannot be read or written ends in one sentence and exit code 2."""
    try:
        yield
    except RecordingError as error:
        click.echo(str(error), err=True)
        sys.exit(UNREADABLE)
    except KeyboardInterrupt:
        click.echo("Interrupted.", err=True)
        sys.exit(INTERRUPTED)


@click.command()
@click.argument("files", nargs=-1, required=True, metavar="FILE...")
@click.option("--json", "as_json", is_flag=True, help="Print what a script can read.")
def info(files, as_json):
    """Say what recordings are: scene, span, columns, versions, events, expectations."""
    from sailviz.recording.views.info import in_words
    from sailviz.recording.views.info import info as facts_of

    with _one_sentence():
        facts = [facts_of(file) for file in files]
    if as_json:
        click.echo(json.dumps(facts[0] if len(facts) == 1 else facts, indent=2))
    else:
        click.echo("\n\n".join(map(in_words, facts)))


@click.command()
@click.argument("file")
@click.option(
    "--to", "form", type=click.Choice(["csv", "parquet", "npz", "oem"]), help="Format; by default the ending of -o."
)
@click.option("-o", "--output", metavar="FILE|DIR", help="By default a file named after the recording, in this folder.")
@click.option(
    "--entity", "entities", multiple=True, metavar="/ENTITY", help="Only this entity, e.g. /state; repeatable."
)
@click.option("--frame", default="", help="Frame of an OEM: EME2000, or ECLIPJ2000 for what circles the Sun.")
def export(file, form, output, entities, frame):
    """Write a recording as CSV, Parquet, numpy archive (npz) or orbit ephemeris message (oem)."""
    from sailviz.recording.exports import export as write

    with _one_sentence():
        for path in write(file, output, form or "", entities=entities, frame=frame):
            click.echo(path)


@click.command()
@click.argument("a")
@click.argument("b")
@click.option("--atol", multiple=True, metavar="[QUANTITY=]X", help="Allowed difference, e.g. /state:position_m=1.0.")
@click.option("--rtol", multiple=True, metavar="[QUANTITY=]X", help="Allowed difference relative to A; 0 by default.")
@click.option(
    "--on", type=click.Choice(["sim_time", "step"]), default="sim_time", show_default=True, help="Pair rows by it."
)
@click.option("--no-picture", is_flag=True, help="Compare numbers and events only.")
@click.option("--json", "as_json", is_flag=True, help="Print what a script can read.")
@click.option("-q", "--quiet", is_flag=True, help="Print nothing: the exit code says it.")
def compare(a, b, atol, rtol, on, no_picture, as_json, quiet):
    """Compare two recordings (or tables written by export --to npz).

    Prints the largest difference of every quantity, where and when. Without --atol a quantity may differ by 1e-9 of its
    largest value. Exit code 0: equal, 1: different, 2: unreadable.
    """
    from sailviz.recording.comparison.comparer import compare as compared

    with _one_sentence():
        found = compared(
            a,
            b,
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


def _tolerances(given, option) -> dict[str, float]:
    """["/state:position_m=1.0", "1e-6"] -> {"/state:position_m": 1.0, "": 1e-6}."""
    found = {}
    for item in given:
        name, _, number = item.rpartition("=")
        try:
            found[name.strip()] = float(number)
        except ValueError:
            raise click.BadParameter(f"{item!r} is not a number or QUANTITY=NUMBER", param_hint=option) from None
    return found


@click.command()
@click.argument("files", nargs=-1, required=True, metavar="FILE...")
def digest(files):
    """Print a hash of what recordings hold: equal for equal contents, whenever and however they were written."""
    from sailviz.recording.comparison.digest import digest as digest_of

    with _one_sentence():
        for file in files:
            click.echo(f"{digest_of(file)}  {file}")


COMMANDS = (info, export, compare, digest)
