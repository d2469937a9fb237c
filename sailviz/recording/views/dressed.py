"""Pictures dressed for papers and talks: one view with the title above, the line of the moment below, each part in its
colour, and how far the run has come.
"""

from __future__ import annotations

import io
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import pyarrow as pa

from sailviz.recording.drawing import style
from sailviz.recording.reader import FilePath, read

if TYPE_CHECKING:
    from PIL import ImageDraw, ImageFont

HEIGHT = 1080.0  # of a picture in which the sizes below are pixels
MARGIN, TITLE, LINE = 48, 46, 32
TITLE_DOWN, LINE_UP = 34, 82  # of the texts' tops, from the top and from the bottom
GAP = 54  # between the parts of the line, at most
SHADE_BELOW, SHADE_ABOVE = (170, 215, 1.2), (150, 170, 1.4)  # height, opacity and steepness of the dark behind texts
PROGRESS = 8
TRACK, DONE = (24, 30, 46), (130, 222, 255)
PLAIN = (235, 240, 250)
RAISED = 0.62  # size of a superscript two, which Pillow's own font lacks


@dataclass(frozen=True)
class Words:
    """The title of a recording, and what its line says from each share of the run on: share (n,), 0 to 1."""

    title: str
    share: np.ndarray
    line: list[str]

    def at(self, share: float) -> str:
        """The line at a share of the run."""
        if not self.line:
            return ""
        return self.line[max(int(np.searchsorted(self.share, share + 1e-9, side="right")) - 1, 0)]


def words_of(path: FilePath) -> Words:
    """The words of a recording; of one without a line of the moment only its title."""
    recording = read(path)
    title = recording.title
    if "/now" not in recording.entities:
        return Words(title, np.zeros(0), [])
    times, texts = [], []
    for table in recording["/now"].tables:  # of rows, and of gaps between them
        times.append(table["sim_time"].cast(pa.int64()).to_numpy().astype(float))
        texts += [text[0] for text in table["TextDocument:text"].to_pylist()]
    time = np.concatenate(times)
    order = np.argsort(time, kind="stable")
    time, span = time[order], time.max() - time.min()
    share = (time - time[0]) / span if span > 0 else 0 * time
    return Words(title, share, [texts[k].removeprefix("### ") for k in order.tolist()])


def dress(png: bytes, words: Words, share: float) -> bytes:
    """A picture with its title, the line at that share of the run, and a bar that says how far it has come."""
    from PIL import Image, ImageDraw

    image = Image.open(io.BytesIO(png)).convert("RGBA")
    width, height = image.size
    unit = height / HEIGHT
    image = Image.alpha_composite(image, Image.fromarray(shade(width, height, unit)))
    draw = ImageDraw.Draw(image)
    draw.text((MARGIN * unit, TITLE_DOWN * unit), words.title, font=font(TITLE * unit), fill=(255, 255, 255))
    write_line(draw, words.at(share), width, height, unit)
    draw.rectangle([0, height - PROGRESS * unit, width, height], fill=TRACK)
    draw.rectangle([0, height - PROGRESS * unit, width * share, height], fill=DONE)
    out = io.BytesIO()
    image.convert("RGB").save(out, "PNG")
    return out.getvalue()


def shade(width: int, height: int, unit: float) -> np.ndarray:
    """(height, width, 4) a dark that grows towards the top and the bottom, so that texts are read on anything."""
    row = np.arange(height)[:, None]
    (low, dark, steep), (high, darker, steeper) = SHADE_BELOW, SHADE_ABOVE
    below = dark * np.clip((row - (height - low * unit)) / (low * unit), 0, 1) ** steep
    above = darker * np.clip((high * unit - row) / (high * unit), 0, 1) ** steeper
    layer = np.empty((height, width, 4), np.uint8)
    layer[..., :3] = style.BACKGROUND
    layer[..., 3] = np.maximum(below, above)
    return layer


def write_line(draw: ImageDraw.ImageDraw, line: str, width: int, height: int, unit: float) -> None:
    """The parts of a line beside each other, smaller where they would not fit."""
    parts = [part.strip() for part in line.split("·")]
    size, room = LINE * unit, width - 2 * MARGIN * unit
    for _ in range(8):
        taken = sum(length(draw, part, size) for part in parts)
        if taken + 0.4 * size * len(parts) <= room:
            break
        size *= 0.92
    gap = min(GAP * unit, (room - taken) / max(len(parts) - 1, 1))
    x, y = MARGIN * unit, height - LINE_UP * unit
    for part in parts:
        x = write(draw, x, y, part, size, color_of(part)) + gap


def color_of(part: str) -> Any:
    """The colour of what a part of the line is about."""
    if part.startswith(("push", "drag", "air drag", "no ")):
        return tuple(style.PUSH)
    if "° off the" in part or part.startswith("in "):
        return tuple(style.SUN)
    if part.endswith("km up") or " from " in part:
        return tuple(style.TRAIL_RECENT)
    return PLAIN


def font(size: float) -> ImageFont.FreeTypeFont | ImageFont.ImageFont:
    """Pillow's own font, which is everywhere."""
    from PIL import ImageFont

    return ImageFont.load_default(max(round(size), 6))


def length(draw: ImageDraw.ImageDraw, text: str, size: float) -> float:
    """Pixels that a text takes."""
    pieces = text.split("²")
    return sum(draw.textlength(piece, font=font(size)) for piece in pieces) + 0.36 * size * (len(pieces) - 1)


def write(draw: ImageDraw.ImageDraw, x: float, y: float, text: str, size: float, fill: Any) -> float:
    """A text from x, y on, with a small raised 2 for each superscript -> where it ends."""
    for number, piece in enumerate(text.split("²")):
        if number:
            draw.text((x, y - 0.02 * size), "2", font=font(RAISED * size), fill=fill)
            x += 0.36 * size
        draw.text((x, y), piece, font=font(size), fill=fill)
        x += draw.textlength(piece, font=font(size))
    return x
