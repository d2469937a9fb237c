"""The command that says what recordings are."""

from __future__ import annotations

import json

import click

from sailviz.cli.shared import BAD_INPUT, collecting_failures, files_argument, in_one_sentence


@click.command()
@files_argument
@click.option("--verify", is_flag=True, help="Check the checksum of every entity, and name those that are damaged.")
@click.option("--json", "as_json", is_flag=True, help="Print what a script can read.")
def info(files: tuple[str, ...], verify: bool, as_json: bool) -> None:
    """Say what recordings are: scene, span, columns, versions, events, expectations, checksums.

    Exit code 2 where a file is damaged or no recording. With --verify all files are looked at, whatever becomes of one;
    a file without checksums (older, or by another program) says so and counts as good if it can be read from end to
    end.
    """
    from sailviz import recording
    from sailviz.recording.views.info import in_words

    if verify:
        _verify(files, as_json)
        return
    with in_one_sentence():
        facts = [recording.info(file) for file in files]
    if as_json:
        click.echo(json.dumps(facts[0] if len(facts) == 1 else facts, indent=2))
    else:
        click.echo("\n\n".join(map(in_words, facts)))


def _verify(files: tuple[str, ...], as_json: bool) -> None:
    from sailviz import recording
    from sailviz.recording.views.info import DAMAGED

    with collecting_failures() as failures:
        found = []
        for file in files:
            with failures.next(file):
                facts = recording.verify(file)
                found.append(facts)
                if facts["checksums"] == DAMAGED:
                    failures.worst(BAD_INPUT)
                if not as_json:
                    click.echo(facts["says"], err=facts["checksums"] == DAMAGED)
        if as_json:
            click.echo(json.dumps(found[0] if len(files) == 1 and found else found, indent=2))
