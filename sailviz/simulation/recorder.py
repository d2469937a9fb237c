"""Scene -> recording: what `sailviz.record` does with a scene is to fly it straight into the recording."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from sailviz.recording import writer
from sailviz.recording.sinks import Sink
from sailviz.recording.writer import Recorded
from sailviz.run.arrays import Run

if TYPE_CHECKING:
    from sailviz.scene.loading import SceneSource


Blocks = Iterator[Run] | list[Run] | tuple[Run, ...]


def record(source: Run | Blocks | SceneSource, sink: Sink, *more_sinks: Sink) -> Recorded:
    """Record a run, its blocks, or a scene, which is flown block by block, to one sink or to several.

    source : a Run, consecutive blocks of one, or whatever `load_scene` takes: a Scene, a
    path, the name of a shipped scene, a dictionary. sink : a path, VIEWER, WEB, Connect(url), Memory() or "-", as in
    `sailviz.recording.record`, which this is for arrays. Raises RecordingError where a sink cannot be written, before
    anything is flown; SceneError for a faulty scene; PropagationError where the integration breaks down, with the rows
    so far recorded.
    """
    if isinstance(source, Run | Iterator | list | tuple):
        return writer.record(source, sink, *more_sinks)
    from sailviz.scene.loading import load_scene  # arrays are recorded without compiled code and without scenes
    from sailviz.simulation.loop import simulate_blocks

    return writer.record(simulate_blocks(load_scene(source)), sink, *more_sinks)
