"""The command that prints what a scene file may hold, for editors."""

from __future__ import annotations

import json

import click


@click.command()
def schema() -> None:
    """Print the JSON Schema of scene files, for editors that complete and check them."""
    from sailviz import scene

    click.echo(json.dumps(scene.schema(), indent=2))
