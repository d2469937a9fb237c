"""The command that prints a scene as it is understood."""

from __future__ import annotations

import click

from sailviz.cli.shared import collecting_failures, set_option, values_of


@click.command()
@click.argument("scene")
@set_option
def show(scene: str, settings: tuple[str, ...]) -> None:
    """Print every value of a scene, defaults included, in SI and in words."""
    from sailviz.scene import load_scene
    from sailviz.scene.show import resolved_lines

    with collecting_failures() as failures, failures.next():
        for line in resolved_lines(load_scene(scene, values_of(settings))):
            click.echo(line)
