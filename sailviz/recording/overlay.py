"""Two or more flights in one recording and one picture: the first as ever, its companions beside it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from sailviz.recording import timelines
from sailviz.recording.companions import overlay_of
from sailviz.recording.sinks import Sink
from sailviz.recording.writer import Recorded, Recorder, served
from sailviz.run.arrays import Run


def record_together(runs: Mapping[str, Run], sink: Sink, *more_sinks: Sink) -> Recorded:
    """`recorded_together`, and where it is for the browser serve it until Ctrl-C."""
    return served(recorded_together(runs, sink, *more_sinks))


def recorded_together(runs: Mapping[str, Run], *sinks: Sink) -> Recorded:
    """Record runs by name in one picture; sinks as in `record`.

    All are of one family and about one body. The first decides frame, unit, camera and clock; its numbers stand where
    those of a single run do, those of the others under /flight/NAME. All are held in memory.
    Raises RecordingError, with every fault, for runs that cannot be put together, before a sink is opened.
    """
    overlay = overlay_of(runs)
    first = next(iter(runs.values()))
    for companion in overlay.companions:
        timelines.check_duration(companion.shown)
    with Recorder(*sinks, overlay=overlay) as recorder:
        recorder.add(replace(first, setting=overlay.setting))
        return recorder.finish()
