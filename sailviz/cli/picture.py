"""The command that takes pictures and makes movies. Heavy modules are imported inside."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from sailviz import files
from sailviz.cli.numbers import Number
from sailviz.cli.outputs import file_at, file_or_folder, make_folder
from sailviz.cli.shared import (
    collecting_failures,
    make_tables,
    progress_bar,
    say_if_compiling,
    set_option,
    values_of,
)
from sailviz.errors import RecordingError

if TYPE_CHECKING:
    from sailviz.recording import MovieReport, PictureReport

VIEW_FAILED = 1
MAGIC = b"RRF2"  # the first bytes of a recording
PICTURE_SIZE, MOVIE_SIZE = (1600, 900), (1280, 720)


class Size(click.ParamType):
    """WIDTHxHEIGHT in pixels."""

    name = "size"

    def convert(self, value: Any, parameter: click.Parameter | None, context: click.Context | None) -> tuple[int, int]:
        """(width, height) from what was written."""
        if isinstance(value, tuple):
            return value
        found = re.fullmatch(r"(\d{2,5})[x×](\d{2,5})", value.strip())
        size = (int(found[1]), int(found[2])) if found else (0, 0)
        if not all(64 <= side <= 8192 for side in size):
            self.fail(f"{value!r} is not WIDTHxHEIGHT in pixels, 64 to 8192 each, such as 1600x900", parameter, context)
        return size


@click.command()
@click.argument("sources", nargs=-1, required=True, metavar="FILE|SCENE...")
@click.option("-o", "--output", metavar="PNG|DIR", help="By default NAME.png in this folder.")
@click.option(
    "--view", metavar="NAME", help="One view alone, by the start of its name: Flight, From above, Riding along, Push..."
)
@click.option("--at", default="end", show_default=True, metavar="TIME", help="start, end, 0.6, or 120d, 0.5yr, 36h.")
@click.option("--size", type=Size(), metavar="WxH", help="In pixels; 1600x900, a movie 1280x720.")
@click.option(
    "--scale",
    type=Number(1, 4),
    default=1.0,
    show_default=True,
    metavar="N",
    help="N pixels for each of the size, in tenths: the same picture, sharper.",
)
@click.option(
    "--style",
    type=click.Choice(["dark", "paper"]),
    default="dark",
    show_default=True,
    help="On black, or on white for print.",
)
@click.option("--dressed", is_flag=True, help="One view with title, line of the moment and progress, as movies have.")
@click.option("--plain", is_flag=True, help="A movie of the whole window, or of one view, without these.")
@click.option("--chrome", is_flag=True, help="With the viewer's menu and badges.")
@click.option("--bare", is_flag=True, help="Without the time panel too.")
@click.option("--movie", "film", metavar="MOVIE", help="Make a .mp4, .webp or .gif of the whole run instead.")
@click.option(
    "--seconds",
    type=Number(0, 3000, "seconds", above=True),
    default=8.0,
    show_default=True,
    help="How long the movie lasts.",
)
@click.option(
    "--fps", type=Number(0, 60, above=True), default=12.0, show_default=True, help="Pictures in a second of the movie."
)
@click.option("-q", "--quiet", is_flag=True, help="Print errors only.")
@set_option
def picture(
    sources: tuple[str, ...],
    output: str | None,
    view: str | None,
    at: str,
    size: tuple[int, int] | None,
    scale: float,
    style: str,
    dressed: bool,
    plain: bool,
    chrome: bool,
    bare: bool,
    film: str | None,
    seconds: float,
    fps: float,
    quiet: bool,
    settings: tuple[str, ...],
) -> None:
    """Take pictures or make movies of recordings and scenes, without a screen.

    A scene is simulated first. Exit code 1 where a view of the recording complains.
    """
    if film is not None and output is not None:
        raise click.UsageError("-o is for pictures; --movie names its own file.")
    if (dressed or view) and (chrome or bare):
        raise click.UsageError("--chrome and --bare are for the whole window, not for one view.")
    if plain and (dressed or film is None):
        raise click.UsageError("--plain is for movies, which are dressed otherwise.")
    if len(sources) > 1 and (film is not None or (output and Path(output).suffix)):
        raise click.UsageError("one name, but there are several sources: give a folder.")
    with collecting_failures() as failures, failures.next():
        size = size or (MOVIE_SIZE if film else PICTURE_SIZE)
        _check_before(at, film, seconds, fps, size, scale)
        page = {"size": size, "scale": scale, "style": style}
        for source, out in zip(sources, _outputs(sources, output, film), strict=True):
            with failures.next(source), _recording_of(source, settings, quiet) as path:
                report: PictureReport | MovieReport
                if film:
                    report = _film(path, out, source, view, seconds, fps, not plain, quiet, page)
                else:
                    looks = {"panels": not bare, "chrome": chrome, "dressed": dressed}
                    report = _shoot(path, out, view, at, page | looks)
                for sentence in report.errors:
                    click.echo(f"{source}: {sentence}", err=True)
                    failures.worst(VIEW_FAILED)
                if not quiet:
                    click.echo(_said(report))


def _check_before(at: str, film: str | None, seconds: float, fps: float, size: tuple[int, int], scale: float) -> None:
    """Everything that can be known to fail before a scene is simulated."""
    from sailviz.recording.views.instant import moment
    from sailviz.recording.views.movie import check_format, frames_of
    from sailviz.recording.views.screenshot import check_vulkan, tenths_above_one

    check_vulkan()
    moment(at)
    tenths_above_one(scale, size)
    if film is not None:
        check_format(film)
        frames_of(seconds, fps)


def _outputs(sources: Sequence[str], output: str | None, film: str | None) -> list[Path]:
    """Where the picture of each source goes; folders are made."""
    if film is not None:
        files = [file_at(film, "movie")]
    else:
        given = "." if output is None else output
        files = [file_or_folder(given, f"{Path(source).stem}.png", "picture", (".png",)) for source in sources]
        twice = next((file.name for file in files if files.count(file) > 1), None)
        if twice:
            raise RecordingError(f"two pictures would have the same name, {twice}: take them one by one with -o")
    make_folder(files[0].parent)
    return files


def _shoot(path: Path, out: Path, view: str | None, at: str, looks: dict[str, Any]) -> PictureReport:
    from dataclasses import replace

    from sailviz.recording.views import screenshot
    from sailviz.recording.views.instant import fraction_of

    fraction = fraction_of(path, at)
    with files.writing(out, "picture") as part:
        report = screenshot.picture(path, part, view=view, at=fraction, **looks)
    return replace(report, path=out)


def _film(
    path: Path,
    out: Path,
    source: str,
    view: str | None,
    seconds: float,
    fps: float,
    dressed: bool,
    quiet: bool,
    page: dict[str, Any],
) -> MovieReport:
    from sailviz.recording.views.movie import make_movie

    with progress_bar(f"Movie of {source}", quiet) as progress:
        return make_movie(path, out, view=view, seconds=seconds, fps=fps, dressed=dressed, progress=progress, **page)


def _said(report: PictureReport | MovieReport) -> str:
    width, height = report.size
    frames = f", {report.frames} frames" if hasattr(report, "frames") else ""
    return f"{report.path}: {width} x {height}{frames}, {report.path.stat().st_size / 1e3:,.0f} kB"


def is_recording(source: str) -> bool:
    """Whether a source is a recording, by its ending or its first bytes, rather than a scene."""
    path = Path(source)
    if path.suffix == ".rrd":
        return True
    try:
        with path.open("rb") as file:
            return file.read(4) == MAGIC
    except OSError:
        return False


@contextmanager
def _recording_of(source: str, settings: Sequence[str], quiet: bool) -> Iterator[Path]:
    """The path of a recording: the source itself, or a temporary one of the scene."""
    if is_recording(source):
        if settings:
            raise RecordingError(f"{source} is a recording: --set changes scenes, and this one was flown already")
        yield Path(source)
        return
    from sailviz.scene import load_scene

    scene = load_scene(source, values_of(settings))
    from sailviz.recording import record
    from sailviz.recording.views.scratch import scratch
    from sailviz.simulation import simulate_blocks

    say_if_compiling(quiet)
    make_tables(scene, quiet)
    with scratch() as folder:
        path = folder / f"{Path(source).stem}.rrd"
        with progress_bar(scene.title, quiet) as progress:
            record(simulate_blocks(scene, progress=progress), path)
        yield path
