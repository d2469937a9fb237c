"""The command that opens recordings on this screen."""

from __future__ import annotations

import click

from sailviz.cli.shared import collecting_failures, files_argument


@click.command()
@files_argument
def view(files: tuple[str, ...]) -> None:
    """Open recordings in the native viewer."""
    from sailviz.recording.views.viewers import open_viewer

    with collecting_failures() as failures, failures.next():
        open_viewer(*files)
