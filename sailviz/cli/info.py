"""The command that says what recordings are."""

from __future__ import annotations

import json

import click

from sailviz.cli.shared import files_argument, in_one_sentence


@click.command()
@files_argument
@click.option("--json", "as_json", is_flag=True, help="Print what a script can read.")
def info(files: tuple[str, ...], as_json: bool) -> None:
    """Say what recordings are: scene, span, columns, versions, events, expectations."""
    from sailviz import recording
    from sailviz.recording.views.info import in_words

    with in_one_sentence():
        facts = [recording.info(file) for file in files]
    if as_json:
        click.echo(json.dumps(facts[0] if len(facts) == 1 else facts, indent=2))
    else:
        click.echo("\n\n".join(map(in_words, facts)))
