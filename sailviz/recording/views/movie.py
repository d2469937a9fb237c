"""Movies of a recording, frame by frame from one headless viewer: mp4 with the extra `movie`, webp and gif."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from sailviz import files
from sailviz.errors import RecordingError
from sailviz.recording.reader import FilePath
from sailviz.recording.views.instant import Moment, fraction_of
from sailviz.recording.views.scratch import scratch
from sailviz.recording.views.screenshot import AGREE as FIRST_AGREE
from sailviz.recording.views.screenshot import FRAME, Studio

if TYPE_CHECKING:
    from PIL import Image

Encoder = Callable[[list[Path], Path, float], None]  # frames, file, frames per second
MOST_FRAMES = 3000
AGREE = 2  # pictures in a row that must be the same, after the first: the viewer has loaded everything by then
WEBP_QUALITY = 82  # of 100; thin bright lines on black still have clean edges
PALETTE_FROM = 9  # frames, evenly spaced, from which a gif's colours are chosen


@dataclass(frozen=True)
class MovieReport:
    """A movie that was made. `errors` and `warnings` are what the views complained about in any frame."""

    path: Path
    size: tuple[int, int]
    frames: int
    errors: tuple[str, ...]
    warnings: tuple[str, ...]
    seconds: float  # of wall time


def make_movie(
    path: FilePath,
    out: FilePath,
    *,
    view: str | None = None,
    start: Moment = "start",
    end: Moment = "end",
    seconds: float = 8.0,
    fps: float = 12.0,
    size: tuple[int, int] = (1280, 720),
    panels: bool = False,
    dressed: bool = True,
    scale: float = 1.0,
    style: str = "dark",
    progress: Callable[[float], None] | None = None,
) -> MovieReport:
    """Make a movie of a recording; its format is the ending of `out`: .mp4, .webp or .gif.

    view, panels, dressed, size, scale, style : as in `picture`; start, end : moments of the run, as in `fraction_of`
    seconds, fps : of the movie; progress : called with the fraction that is done
    Nothing is written unless all of it is. Raises RecordingError for what cannot be shown, encoded or written.
    """
    began = time.monotonic()
    encode = check_format(out)
    count = frames_of(seconds, fps)
    files.check(out, "movie")
    first, last = fraction_of(path, start), fraction_of(path, end)
    if view is not None or dressed:
        size, panels = (size[0] + FRAME[0], size[1] + FRAME[1]), False
    errors: dict[str, None] = {}
    warnings: dict[str, None] = {}
    frames: list[Path] = []
    with files.writing(out, "movie") as part, scratch() as folder:
        with Studio(path, size=size, panels=panels, scale=scale, style=style) as studio:
            view = view or (studio.main if dressed else None)
            for number, at in enumerate(np.linspace(first, last, count)):
                agree = AGREE if number else FIRST_AGREE
                png = folder / f"{number:05d}.png"
                report = studio.shoot(png, view=view, at=float(at), agree=agree, dressed=dressed)
                frames.append(report.path)
                errors |= dict.fromkeys(report.errors)
                warnings |= dict.fromkeys(report.warnings)
                if progress:
                    progress((number + 1) / (count + 1))  # the encoding counts as a frame
        encode(frames, part, fps)
        if progress:
            progress(1.0)
    return MovieReport(Path(out), report.size, count, tuple(errors), tuple(warnings), time.monotonic() - began)


def frames_of(seconds: float, fps: float) -> int:
    """How many frames a movie has. RecordingError where that is not 2 to MOST_FRAMES, or more than 60 in a second."""
    if not (0 < seconds < np.inf and 0 < fps <= 60 and 1 < round(seconds * fps) <= MOST_FRAMES):
        raise RecordingError(
            f"a movie has 2 to {MOST_FRAMES:,} frames, at most 60 in a second, not {seconds:g} s at {fps:g} per second"
        )
    return round(seconds * fps)


def check_format(out: FilePath) -> Encoder:
    """The encoder for a file's ending. RecordingError where there is none, so that it is known before the work."""
    encoders = {".mp4": mp4, ".webp": webp, ".gif": gif}
    ending = Path(out).suffix.lower()
    if ending not in encoders:
        raise RecordingError(f"{out} is no movie: its name must end in .mp4, .webp or .gif")
    if ending == ".mp4":
        ffmpeg()
    return encoders[ending]


def ffmpeg() -> Any:
    """The package that encodes mp4. RecordingError where the extra is missing."""
    try:
        import imageio_ffmpeg
    except ImportError:
        raise RecordingError("mp4 needs the extra movie: pip install 'sailviz[movie]'; webp and gif do not") from None
    return imageio_ffmpeg


def webp(frames: list[Path], out: Path, fps: float) -> None:
    """All colours, small."""
    images = [image(frame) for frame in frames]
    images[0].save(
        out,
        "WEBP",
        save_all=True,
        append_images=images[1:],
        duration=round(1000 / fps),
        loop=0,
        quality=WEBP_QUALITY,
        method=4,
    )


def gif(frames: list[Path], out: Path, fps: float) -> None:
    """One palette for all frames and no dithering, so that what stands still does not flicker."""
    from PIL import Image

    chosen = [image(frames[i]) for i in np.unique(np.linspace(0, len(frames) - 1, PALETTE_FROM).astype(int))]
    width, height = chosen[0].size
    sheet = Image.new("RGB", (width, height * len(chosen)))
    for row, frame in enumerate(chosen):
        sheet.paste(frame, (0, row * height))
    palette = palette_of(sheet, 256)
    images = [image(frame).quantize(palette=palette, dither=Image.Dither.NONE) for frame in frames]
    images[0].save(
        out, "GIF", save_all=True, append_images=images[1:], duration=round(1000 / fps), loop=0, optimize=False
    )


def palette_of(picture: Image.Image, colours: int) -> Image.Image:
    """An image whose palette serves a picture: most colours where most pixels are, the others spread over all that
    occur, so that a thin green arrow in a dark sky stays green.
    """
    from PIL import Image

    spread = colours // 3
    parts = ((colours - spread, Image.Quantize.MEDIANCUT), (spread, Image.Quantize.MAXCOVERAGE))
    palettes = [picture.quantize(count, method=method).getpalette() for count, method in parts]
    chosen = [value for palette in palettes for value in palette or ()]
    holder = Image.new("P", (1, 1))
    holder.putpalette(chosen[: 3 * colours])
    return holder


def mp4(frames: list[Path], out: Path, fps: float) -> None:
    """H.264, for what does not play webp."""
    width, height = image(frames[0]).size
    width, height = width - width % 2, height - height % 2  # H.264 halves the resolution of colours
    writer = ffmpeg().write_frames(
        str(out),
        (width, height),
        fps=fps,
        codec="libx264",
        macro_block_size=2,
        output_params=["-crf", "20", "-movflags", "+faststart", "-f", "mp4"],  # the part's name does not say so
    )
    writer.send(None)
    try:
        for frame in frames:
            writer.send(np.ascontiguousarray(np.asarray(image(frame))[:height, :width]))
    except OSError as error:
        raise RecordingError(f"the encoder of mp4 failed: {str(error).splitlines()[0]}") from None
    finally:
        writer.close()


def image(path: Path) -> Image.Image:
    """A frame."""
    from PIL import Image

    with Image.open(path) as opened:
        return opened.convert("RGB")
