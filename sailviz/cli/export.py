"""The command that writes the truth of a recording in a form that other programs read."""

from __future__ import annotations

import click

from sailviz.cli.outputs import file_at, folder_at, is_folder
from sailviz.cli.shared import in_one_sentence


@click.command()
@click.argument("file")
@click.option(
    "--to",
    "form",
    type=click.Choice(["csv", "parquet", "npz", "oem", "aem", "spk", "ck", "cosmographia"]),
    help="Format; by default the ending of -o, .bsp for spk, .bc for ck.",
)
@click.option("-o", "--output", metavar="FILE|DIR", help="By default named after the recording, in this folder.")
@click.option(
    "--entity", "entities", multiple=True, metavar="/ENTITY", help="Only this entity, e.g. /state; repeatable."
)
@click.option("--frame", default="", help="Frame of a message or kernel: EME2000, or ECLIPJ2000.")
@click.option("--craft-id", type=int, default=-910001, show_default=True, help="NAIF id of the craft in kernels.")
@click.option("--centre-id", type=int, help="NAIF id of the central body in an SPK; by default by its name.")
def export(
    file: str,
    form: str | None,
    output: str | None,
    entities: tuple[str, ...],
    frame: str,
    craft_id: int,
    centre_id: int | None,
) -> None:
    """Write a recording as CSV, Parquet, numpy archive (npz), orbit or attitude message (oem, aem) or kernel of SPICE.

    spk holds the positions and velocities. ck holds the attitude: SPICE reads NAME.bc with the clock NAME.tsc and the
    frame NAME.tf, which are written beside it.

    cosmographia makes a folder, -o DIR or NAME-cosmographia: open its load.json in NAIF's Cosmographia (File, Open
    Catalog). The folder must be new, empty, or one that this command has made.
    """
    from sailviz import recording

    with in_one_sentence():
        if output is not None:
            folder_at(output, "files") if is_folder(output) else file_at(output, "file")
        for path in recording.export(
            file, output, form or "", entities=entities, frame=frame, craft_id=craft_id, centre_id=centre_id
        ):
            click.echo(path)
