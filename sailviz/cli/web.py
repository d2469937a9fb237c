"""The command that shows recordings in a browser."""

from __future__ import annotations

import click

from sailviz.cli.numbers import PORT
from sailviz.cli.shared import collecting_failures, files_argument
from sailviz.cli.together import check_asked_for, check_files, name_option, one_picture, together_option


@click.command()
@files_argument
@together_option
@name_option
@click.option("--no-open", is_flag=True, help="Do not open a browser: print the address only.")
@click.option(
    "--port", type=PORT, default=0, help="Of the page, e.g. to forward it through ssh; a free one by default."
)
@click.option("--data-port", type=PORT, default=0, help="Of the recordings; a free one by default.")
def web(
    files: tuple[str, ...], together: bool | None, names: tuple[str, ...], no_open: bool, port: int, data_port: int
) -> None:
    """Show recordings in a browser on this machine; works offline. Ctrl-C ends it.

    Several flights of one family are shown in one picture, as `sailviz view` does; --apart shows each by itself.
    """
    from sailviz.recording.views.viewers import serve

    def started(url: str) -> None:
        click.echo(url)
        click.echo("Ctrl-C ends it.", err=True)
        if not no_open:
            import webbrowser

            webbrowser.open(url)

    check_asked_for(files, together, names)
    with collecting_failures() as failures, failures.next():
        check_files(files)
        with one_picture(files, together, names) as shown:
            serve(*shown, port=port, data_port=data_port, started=started)
