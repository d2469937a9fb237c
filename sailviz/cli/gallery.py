"""The command that takes the pictures of the README."""

from __future__ import annotations

import click

from sailviz.cli.outputs import folder_at, make_folder
from sailviz.cli.shared import collecting_failures, progress_bar, say_if_compiling


@click.command(hidden=True)
@click.argument("scenes", nargs=-1, metavar="[SCENE...]")
@click.option("-o", "--output", default="assets/readme", show_default=True, metavar="DIR")
@click.option("-q", "--quiet", is_flag=True, help="No progress bar.")
def gallery(scenes: tuple[str, ...], output: str, quiet: bool) -> None:
    """Take the pictures of the README, one of every shipped scene, and print the table that shows them."""
    from sailviz.cli import readme_pictures

    with collecting_failures() as failures, failures.next(), progress_bar("Gallery", quiet) as progress:
        folder = folder_at(output, "pictures")
        say_if_compiling(quiet)
        make_folder(folder)
        click.echo(readme_pictures.markdown(readme_pictures.take(folder, scenes, progress=progress)))
