"""Runs and recordings inside a notebook, in Rerun's viewer, served by the notebook's own machine."""

from __future__ import annotations

import os
from contextlib import redirect_stdout
from io import StringIO
from typing import Any

from sailviz.errors import RecordingError
from sailviz.recording.reader import FilePath, Recording, read
from sailviz.run.arrays import Run

ASSET = "RERUN_NOTEBOOK_ASSET"


def show(source: Run | Recording | FilePath, *, width: int | str = "auto", height: int | str = 640) -> Any:
    """Rerun's viewer as a notebook widget, with everything in it; the last line of a cell shows it.

    source : a Run, a path, or what `read` returned; width, height : pixels, or "auto" for the cell's width
    Works offline: the viewer comes from a server beside the kernel. Where the kernel runs on another machine than the
    browser, set the environment variable RERUN_NOTEBOOK_ASSET to "inline" first.
    Raises RecordingError where the extra `notebook` is missing, or there is nothing to show.
    """
    viewer = viewer_class()(width=width, height=height, theme="dark")
    viewer.send_rrd(as_bytes(source))
    return viewer


def viewer_class() -> Any:
    """Rerun's widget. It decides on import where its code comes from: from here, unless the user decided otherwise."""
    os.environ.setdefault(ASSET, "serve-local")
    try:
        with redirect_stdout(StringIO()):  # it tells its port
            from rerun_notebook import Viewer
    except ImportError:
        raise RecordingError(
            "a viewer in a notebook needs the extra notebook: pip install 'sailviz[notebook]'"
        ) from None
    return Viewer


def as_bytes(source: Run | Recording | FilePath) -> bytes:
    """A recording as it would be in a file."""
    if isinstance(source, Run):
        from sailviz.recording.sinks import Memory
        from sailviz.recording.writer import record

        memory = Memory()
        record(source, memory)
        return memory.bytes
    if isinstance(source, str | os.PathLike):
        source = read(source)
    if not isinstance(source, Recording):
        raise RecordingError(f"a notebook shows a Run, a path or a Recording, not a {type(source).__name__}")
    return source.path.read_bytes()
