"""The command that gives recordings a fingerprint."""

from __future__ import annotations

import click

from sailviz.cli.shared import files_argument, in_one_sentence


@click.command()
@files_argument
def digest(files: tuple[str, ...]) -> None:
    """Print a hash of what recordings hold: equal for equal contents, whenever and however they were written."""
    from sailviz import recording

    with in_one_sentence():
        for file in files:
            click.echo(f"{recording.digest(file)}  {file}")
