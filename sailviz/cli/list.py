"""The command that names the shipped scenes."""

from __future__ import annotations

import click

from sailviz.shipped import shipped_scenes


@click.command("list")
def list_scenes() -> None:
    """Name the scenes that come with sailviz."""
    from sailviz.scene import load_scene

    for name in shipped_scenes():
        click.echo(f"{name:<34} {load_scene(name).title}")
