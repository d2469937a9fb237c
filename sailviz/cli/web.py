"""The command that shows recordings in a browser."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import click

from sailviz.cli.flight_options import FlightOptions, body_option, mesh_options
from sailviz.cli.numbers import PORT
from sailviz.cli.outputs import folder_at
from sailviz.cli.shared import collecting_failures, files_argument
from sailviz.cli.together import check_asked_for, check_files, name_option, one_picture, recorded, together_option


@click.command()
@files_argument
@together_option
@name_option
@body_option
@mesh_options
@click.option(
    "--export",
    "exported",
    metavar="DIR",
    help="Write a folder that any web server can hand out, so that a link opens the flight, and end.",
)
@click.option("--no-open", is_flag=True, help="Do not open a browser: print the address only.")
@click.option(
    "--port", type=PORT, default=0, help="Of the page, e.g. to forward it through ssh; a free one by default."
)
@click.option("--data-port", type=PORT, default=0, help="Of the recordings; a free one by default.")
def web(
    files: tuple[str, ...],
    together: bool | None,
    names: tuple[str, ...],
    body: str,
    mesh: str | None,
    unit: str | None,
    front: str | None,
    exported: str | None,
    no_open: bool,
    port: int,
    data_port: int,
) -> None:
    """Show recordings, or flights of others as `view` does, in a browser on this machine. Ctrl-C ends it.

    Works offline.

    Several flights of one family are shown in one picture, as `sailviz view` does; --apart shows each by itself.
    """
    if exported is not None and (no_open or port or data_port):
        raise click.UsageError(
            "--export writes files and serves nothing: --no-open, --port and --data-port go without it."
        )
    from sailviz.recording.views.viewers import serve

    def started(url: str) -> None:
        click.echo(url)
        click.echo("Ctrl-C ends it.", err=True)
        if not no_open:
            import webbrowser

            webbrowser.open(url)

    check_asked_for(files, together, names)
    said = FlightOptions(body, mesh, unit, front)
    with collecting_failures() as failures, failures.next():
        said.check(files)
        folder = None if exported is None else folder_at(exported, "pages")
        with recorded(files, said) as known:
            check_files(known)
            with one_picture(known, together, names) as shown:
                if folder is not None:
                    _export(shown, folder)
                else:
                    serve(*shown, port=port, data_port=data_port, started=started)


def _export(shown: Sequence[str | Path], folder: Path) -> None:
    from sailviz.recording.views.web_folder import write_web_folder

    written = write_web_folder(shown, folder)
    click.echo(
        f"{written.folder}: index.html, {', '.join(written.recordings)} and viewer/, {written.size / 1e6:,.1f} MB"
    )
    click.echo(
        f"Any web server shows it; one for this machine: python -m http.server --bind 127.0.0.1 -d {written.folder}",
        err=True,
    )
