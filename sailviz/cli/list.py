"""The command that names the shipped scenes."""

from __future__ import annotations

import click

from sailviz.shipped import shipped_scenes, title_of


@click.command("list")
def list_scenes() -> None:
    """Name the scenes that come with sailviz."""
    scenes = shipped_scenes()
    width = max(map(len, scenes), default=0)
    for name, path in scenes.items():
        click.echo(f"{name:<{width}} {title_of(path)}")
