"""The command that judges a solution of GTOC13."""

from __future__ import annotations

import json
import sys
from pathlib import Path

import click

from sailviz.cli.outputs import file_or_folder
from sailviz.cli.shared import EXPECTATION_FAILED, in_one_sentence


@click.command()
@click.argument("file", metavar="FILE")
@click.option(
    "--catalogue", metavar="DIR", help="Folder of the competition's gtoc13_planets.csv, _asteroids.csv, _comets.csv."
)
@click.option(
    "-o", "--output", metavar="FILE", help="Record a replay: planets, arcs, flybys, score, violations in red."
)
@click.option("--json", "as_json", is_flag=True, help="Print what a script can read.")
@click.option("-q", "--quiet", is_flag=True, help="Print nothing: the exit code says it.")
def gtoc13(file: str, catalogue: str | None, output: str | None, as_json: bool, quiet: bool) -> None:
    """Judge a solution of GTOC13, the 13th Global Trajectory Optimisation Competition: fly it again, list whatever
    breaks a rule with row and size, count its score.

    Score is J without the factor c of the day on which it was handed in. The competition's catalogue is not part of
    sailviz: --catalogue names the folder, needed for flybys. Exit code 0: legal, 1: violations, 2: unreadable.
    """
    from sailviz.checks.gtoc13 import judge

    with in_one_sentence():
        path = None if output is None else file_or_folder(output, f"{Path(file).stem}.rrd", "recording", (".rrd",))
        found = judge(file, catalogue)
    if as_json:
        click.echo(json.dumps(found.as_json(), indent=2))
    elif not quiet:
        from sailviz.checks.gtoc13.words import in_words

        click.echo(in_words(found))
    if path is not None:
        from sailviz import recording
        from sailviz.checks.gtoc13.replay import replay

        with in_one_sentence():
            recorded = recording.record(replay(found, catalogue), path)
        if not (quiet or as_json):
            click.echo(f"Recorded {path}, {recorded.rows:,} rows; look at it with: sailviz view {path}")
    sys.exit(0 if found.legal else EXPECTATION_FAILED)
