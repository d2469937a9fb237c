"""The command that reads scenes and says what is wrong with them."""

from __future__ import annotations

import click

from sailviz.cli.shared import collecting_failures, scenes_argument, set_option, values_of


@click.command()
@scenes_argument
@set_option
def check(scenes: tuple[str, ...], settings: tuple[str, ...]) -> None:
    """Read scenes and report every fault in them."""
    from sailviz.scene import load_scene

    with collecting_failures() as failures:
        for name in scenes:
            with failures.next():
                scene = load_scene(name, values_of(settings))
                click.echo(f"{name}: ok, {scene.title}")
