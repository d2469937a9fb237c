"""The command that makes recordings of flights of others."""

from __future__ import annotations

from pathlib import Path

import click

from sailviz.cli.flight_options import FlightOptions, body_option, mesh_options
from sailviz.cli.outputs import file_or_folder, make_folder
from sailviz.cli.shared import collecting_failures, files_argument
from sailviz.cli.telling import rerun_command
from sailviz.errors import RecordingError


@click.command()
@files_argument
@click.option("-o", "--output", metavar="FILE|DIR", help="By default NAME.rrd in this folder.")
@body_option
@mesh_options
@click.option("-q", "--quiet", is_flag=True, help="Print errors only.")
def record(
    files: tuple[str, ...],
    output: str | None,
    body: str,
    mesh: str | None,
    unit: str | None,
    front: str | None,
    quiet: bool,
) -> None:
    """Record flights of others: .oem, .bsp, .csv, .parquet, .npz. Scenes are flown and recorded by `run`.

    Nothing is propagated: what is drawn between rows that lie far apart is told as no data.
    """
    from sailviz.recording.flights import is_flight

    said = FlightOptions(body, mesh, unit, front)
    if len(files) > 1 and output and Path(output).suffix:
        raise click.UsageError("-o names one file, but there are several flights: give a folder.")
    with collecting_failures() as failures:
        with failures.next():
            said.check(tuple(filter(is_flight, files)) or files)
        for file in () if failures.code else files:
            with failures.next(file):
                if not is_flight(file):
                    raise RecordingError(
                        f"{file} is no flight of others, which ends in .oem, .bsp, .csv, .parquet or .npz; "
                        "a scene is flown and recorded by `sailviz run`"
                    )
                path = file_or_folder(output or ".", f"{Path(file).stem}.rrd", "recording")
                flight = said.read(file)
                from sailviz.recording import record as written

                make_folder(path.parent)
                found = written(flight, path)
                if not quiet:
                    for remark in found.remarks:
                        click.echo(remark)
                    click.echo(f"Recorded {path}, {found.rows:,} rows; look at it with: {rerun_command()} {path}")
