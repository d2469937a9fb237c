"""The command that draws figures for paper. matplotlib is imported only when something is drawn."""

from __future__ import annotations

from pathlib import Path

import click

from sailviz.cli.outputs import file_at, folder_at, is_folder, make_folder
from sailviz.cli.shared import BAD_INPUT, tell


@click.command()
@click.argument("figures", nargs=-1, metavar="NAME...")
@click.option("--list", "listing", is_flag=True, help="Name the figures there are.")
@click.option(
    "-o", "--output", metavar="FILE|DIR", help="PNG, SVG or PDF by its ending; NAME.png in this folder by default."
)
@click.option("--style", type=click.Choice(["dark", "light"]), default="dark", show_default=True)
@click.option("--dpi", type=click.IntRange(30, 1200), default=160, show_default=True, help="Of a PNG.")
@click.option(
    "--series",
    metavar="FILE",
    help="Solar wind for wind-fit: .csv, .npz or .parquet with utc or time_h and pressure_nPa, or an OMNI2 text.",
)
@click.option("-q", "--quiet", is_flag=True, help="Print errors only.")
def figure(
    figures: tuple[str, ...],
    listing: bool,
    output: str | None,
    style: str,
    dpi: int,
    series: str | None,
    quiet: bool,
) -> None:
    """Draw figures: the thesis' own from our functions, and maps of stability, validity, spirals and escape."""
    from sailviz.errors import OutputError
    from sailviz.figures import FigureError, draw, names, title

    if listing:
        for name in names():
            click.echo(f"{name:<14} {title(name)}")
        return
    if not figures:
        raise click.UsageError("Name a figure, or see them with --list.")
    options = {"series": series} if series else {}
    target = Path() if output is None else Path(output)
    folder = output is None or is_folder(target) or not target.suffix
    if len(figures) > 1 and not folder:
        raise click.UsageError("-o names one file, but there are several figures: give a folder.")
    try:
        for name in figures:
            title(name)  # a wrong name is found before anything is drawn
        if folder:
            make_folder(folder_at("." if output is None else output, "figures"))
        else:
            file_at(target, "figure")
        for name in figures:
            path = draw(name, target / f"{name}.png" if folder else target, style, dpi, **options)
            if not quiet:
                click.echo(f"Drew {path}: {title(name)}")
    except (FigureError, OutputError, OSError) as error:
        tell(error)
        raise click.exceptions.Exit(BAD_INPUT) from None
