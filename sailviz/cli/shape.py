"""The command that says what light does to a shape: a file of facets."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

import click

from sailviz.cli.shared import BAD_INPUT, progress_bar, tell
from sailviz.shipped import shipped_scenes

if TYPE_CHECKING:
    from sailviz.checks.shape_report import Report


@click.command()
@click.argument("file", metavar="FILE|SCENE")
@click.option("--unit", metavar="UNIT", help="m, cm, mm, in, ft or km: of STL, OBJ and PLY, which have none.")
@click.option("--front", default="-z", show_default=True, metavar="AXIS", help="Axis of the file that the front faces.")
@click.option("--film", default="ideal", show_default=True, help="Of every film: a name, or b1,b2,b3.")
@click.option("--back", default="same", show_default=True, help='Of every film: "same", "black", or b1,b2,b3.')
@click.option(
    "--part",
    "parts",
    multiple=True,
    metavar="NAME=FILM[/BACK]",
    help="What one part is made of; a closed part, black without it, has no back. May be repeated.",
)
@click.option("--cells", type=int, default=32, show_default=True, help="Along a side of the table's cube, even.")
@click.option("--interpolation", type=click.Choice(["bilinear", "bicubic"]), default="bilinear", show_default=True)
@click.option("--no-shadow", is_flag=True, help="Let no part shade another.")
@click.option(
    "-o", "--output", metavar="FILE.rrd", help="Record the facets coloured by pressure, over the pitch angle."
)
@click.option("--json", "as_json", is_flag=True, help="Print what a script can read.")
@click.option("-q", "--quiet", is_flag=True, help="Print errors only.")
def shape(
    file: str,
    unit: str | None,
    front: str,
    film: str,
    back: str,
    parts: tuple[str, ...],
    cells: int,
    interpolation: str,
    no_shadow: bool,
    output: str | None,
    as_json: bool,
    quiet: bool,
) -> None:
    """Say what light does to a shape: its area and parts, force and centre of pressure facing the Sun and at 35 deg,
    and how well tensors and table say it.

    FILE is an STL, OBJ, GLB, PLY or 3MF file; SCENE a .toml file, or the name of a shipped one, whose sail has a shape.
    Body axes: +z away from the Sun.
    """
    from sailviz.errors import SailvizError
    from sailviz.files import check

    try:
        if output is not None:
            check(output, "recording")
        materials = {"film": film, "back": back, "parts": parts, "unit": unit, "front": front}
        with progress_bar("table of directions", quiet or as_json) as progress:
            found = _report(file, materials, cells, interpolation, not no_shadow, progress)
        if output is not None:
            from sailviz.recording.shape_picture import record_shape

            record_shape(found.picture(), output)
    except (SailvizError, ValueError) as error:
        tell(error)
        raise click.exceptions.Exit(BAD_INPUT) from None
    if as_json:
        click.echo(json.dumps(found.facts(), indent=2))
    elif not quiet:
        click.echo(found.words())
        if output is not None:
            click.echo(f"Recorded {output}")


def _report(
    file: str, materials: dict[str, Any], cells: int, interpolation: str, shadow: bool, progress: Any
) -> Report:
    """The report of a file of facets, or of a scene, which says all else itself."""
    from sailviz.checks import shape_report

    if file.lower().endswith(".toml") or file in shipped_scenes():
        return shape_report.report_of_scene(file)
    shape = shape_report.shape_of_file(file, **materials)
    return shape_report.report(file, shape, cells, interpolation, shadow, progress)
