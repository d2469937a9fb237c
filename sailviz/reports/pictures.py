"""The pictures of a report: the flight at its start, half way and at its end, and its numbers over time."""

from __future__ import annotations

import os
from pathlib import Path

from sailviz.errors import RecordingError
from sailviz.reports.page import Picture

SIZE = (1280, 720)  # pixels of each
MOMENTS = (("start", "at the start"), (0.5, "half way"), ("end", "at the end"))


def pictures_of(path: Path) -> tuple[tuple[Picture, ...], str]:
    """The pictures that can be taken here, and a sentence about those that cannot."""
    from sailviz.figures import draw_recording
    from sailviz.figures.drawing import FigureError
    from sailviz.recording.views.scratch import scratch

    found: list[Picture] = []
    missing: list[str] = []
    with scratch() as folder:
        try:
            found += _views(path, folder)
        except RecordingError as error:
            missing.append(f"No pictures of the flight: {error}.")
        try:
            png = draw_recording(path, folder / "curves.png", style="light", dpi=130)
            found.append(Picture(png.read_bytes(), "What changes, over time"))
        except (FigureError, RecordingError) as error:
            missing.append(f"No curves: {error}.")
    return tuple(found), " ".join(missing)


def _views(path: Path, folder: str | os.PathLike[str]) -> list[Picture]:
    from sailviz.recording.views.screenshot import Studio

    found = []
    with Studio(path, size=SIZE, panels=False, style="paper") as studio:
        for at, words in MOMENTS:
            png = Path(folder) / "view.png"
            studio.shoot(png, view=studio.main, at=at, dressed=True)
            found.append(Picture(png.read_bytes(), f"{studio.main}, {words}"))
    return found
