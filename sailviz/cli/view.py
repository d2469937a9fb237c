"""The command that opens recordings on this screen."""

from __future__ import annotations

import click

from sailviz.cli.flight_options import FlightOptions, body_option, mesh_options
from sailviz.cli.shared import collecting_failures, files_argument
from sailviz.cli.together import check_asked_for, check_files, name_option, one_picture, recorded, together_option


@click.command()
@files_argument
@together_option
@name_option
@body_option
@mesh_options
def view(
    files: tuple[str, ...],
    together: bool | None,
    names: tuple[str, ...],
    body: str,
    mesh: str | None,
    unit: str | None,
    front: str | None,
) -> None:
    """Open recordings in the native viewer, or flights of others: .oem, .bsp, .csv, .parquet, .npz.

    Several flights of one family, about one body, are shown in one picture, each in its own colour and called after its
    file or by --name; --apart shows each by itself, as are those that cannot be put together.
    """
    check_asked_for(files, together, names)
    said = FlightOptions(body, mesh, unit, front)
    with collecting_failures() as failures, failures.next():
        said.check(files)
        with recorded(files, said) as known:
            _show(known, together, names)


def _show(known: list[str], together: bool | None, names: tuple[str, ...]) -> None:
    from sailviz.recording.views.viewers import check_screen, open_viewer

    check_files(known)
    check_screen()
    with one_picture(known, together, names) as shown:
        open_viewer(*shown)
