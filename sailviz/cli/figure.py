"""The command that draws figures for paper. matplotlib is imported only when something is drawn."""

from __future__ import annotations

from pathlib import Path

import click

from sailviz.cli.outputs import file_at, folder_at, is_folder, make_folder
from sailviz.cli.shared import BAD_INPUT, tell


@click.command()
@click.argument("figures", nargs=-1, metavar="NAME|RECORDING...")
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
@click.option(
    "--quantity",
    "quantities",
    multiple=True,
    metavar="NAME",
    help="Of a recording, over time: a quantity as [[expect]] names it, a column of /environment, or thrust/NAME, the "
    "push of one of several devices. May be repeated.",
)
@click.option("--over", metavar="NAME", help="Of a recording: the quantity that its curves run along instead of time.")
@click.option("--orbit", is_flag=True, help="Of a recording: its orbit, seen from the pole or, if low, in its plane.")
@click.option("-q", "--quiet", is_flag=True, help="Print errors only.")
def figure(
    figures: tuple[str, ...],
    listing: bool,
    output: str | None,
    style: str,
    dpi: int,
    series: str | None,
    quantities: tuple[str, ...],
    over: str | None,
    orbit: bool,
    quiet: bool,
) -> None:
    """Draw figures: the thesis' own from our functions, maps of stability, validity, spirals and escape, and curves of
    recordings.

    A RECORDING is told from a NAME by its ending, .rrd, or by how the file begins.
    """
    from sailviz.errors import RecordingError
    from sailviz.figures import FigureError, draw, draw_recording, names, title

    if listing:
        for name in names():
            click.echo(f"{name:<14} {title(name)}")
        return
    recordings = {name for name in figures if is_recording(name)}
    target = Path() if output is None else Path(output)
    folder = output is None or is_folder(target) or not target.suffix
    why_not = contradiction(figures, recordings, folder, bool(quantities or over or orbit), series)
    if why_not:
        raise click.UsageError(why_not)
    try:
        for name in sorted(set(figures) - recordings):
            title(name)  # a wrong name is found before anything is drawn
        check_place(output, folder)
        for name in figures:
            if name in recordings:
                path, words = target / f"{Path(name).stem}.png" if folder else target, name
                draw_recording(name, path, quantities, orbit=orbit, over=over or "", style=style, dpi=dpi)
            else:
                path, words = target / f"{name}.png" if folder else target, title(name)
                draw(name, path, style, dpi, **({"series": series} if series else {}))
            if not quiet:
                click.echo(f"Drew {path}: {words}")
    except (FigureError, RecordingError, OSError) as error:
        tell(error)
        raise click.exceptions.Exit(BAD_INPUT) from None


def contradiction(figures: tuple[str, ...], recordings: set[str], folder: bool, asked: bool, series: str | None) -> str:
    """What is wrong with options that exclude each other, in a sentence; "" for nothing. asked : what is for
    recordings alone; folder : whether several files can be written."""
    if not figures:
        return "Name a figure or a recording, or see the figures with --list."
    if asked and len(recordings) < len(set(figures)):
        return "--quantity, --over and --orbit are for recordings."
    if series and recordings:
        return "--series is for wind-fit, not for recordings."
    return "" if folder or len(figures) == 1 else "-o names one file, but there are several figures: give a folder."


def check_place(output: str | None, folder: bool) -> None:
    """Make the folder that is meant, or see that the file can be written. OutputError where that cannot be."""
    if folder:
        make_folder(folder_at("." if output is None else output, "figures"))
    elif output is not None:
        file_at(output, "figure")


def is_recording(name: str) -> bool:
    """Whether a word means a recording, not a figure: by its ending, or by how the file of that name begins."""
    if name.endswith(".rrd"):
        return True
    try:
        with open(name, "rb") as file:
            return file.read(3) == b"RRF"
    except (OSError, ValueError):
        return False
