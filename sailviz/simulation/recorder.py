"""Scene -> recording: what `sailviz.record` does with a scene is to fly it straight into the recording."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any, cast

from sailviz.recording import writer
from sailviz.recording.reader import Recording
from sailviz.recording.sinks import Sink, discard, resolve
from sailviz.recording.writer import Recorded
from sailviz.run.arrays import Run

if TYPE_CHECKING:
    from sailviz.scene.loading import Scene, SceneSource


Blocks = Iterator[Run] | list[Run] | tuple[Run, ...]


def record(
    source: Run | Blocks | SceneSource | Sink | None = None,
    sink: Sink | None = None,
    *more_sinks: Sink,
    runs: Mapping[str, Run | SceneSource | Recording] | None = None,
) -> Recorded:
    """Record a run, its blocks, or a scene, which is flown block by block, to one sink or to several; or several runs
    in one picture: `record(runs={"flat": run, "billowed": other}, sink="both.rrd")`.

    source : a Run, consecutive blocks of one, somebody's flight (the path of an .oem, .bsp, .csv, .parquet or .npz), or
    whatever `load_scene` takes: a Scene, a path, the name of a shipped scene, a dictionary.
    sink : a path, VIEWER, WEB, Connect(url), Memory() or "-", as in `sailviz.recording.record`.
    runs : name -> a Run, a scene, which is flown, or a Recording,
    instead of a source; all of one family and about one body. Then whatever stands by its place is a sink.
    Raises RecordingError where a sink cannot be written, before anything is flown, and for runs that cannot be put
    together; SceneError for a faulty scene; PropagationError where the integration breaks down, with the rows so far
    recorded, of a single scene.
    """
    if runs is not None:
        return record_flights(runs, *(given for given in (source, sink, *more_sinks) if given is not None))
    if source is None or sink is None:
        raise TypeError("record needs a run or a scene, and somewhere to put it: record(run, 'orbit.rrd')")
    if isinstance(source, Run | Iterator | list | tuple):
        return writer.record(source, sink, *more_sinks)
    from sailviz.recording.flights import is_flight, read_flight

    if is_flight(source):
        return writer.record(read_flight(cast("str", source)), sink, *more_sinks)
    from sailviz.scene.loading import load_scene  # arrays are recorded without compiled code and without scenes
    from sailviz.simulation.loop import simulate_blocks

    return writer.record(simulate_blocks(load_scene(cast("SceneSource", source))), sink, *more_sinks)


def record_flights(runs: Mapping[str, Run | SceneSource | Recording], *sinks: Any) -> Recorded:
    """Record flights by name in one picture; scenes among them are flown once all is known to fit together."""
    from sailviz.recording.companions import check_together
    from sailviz.recording.overlay import record_together
    from sailviz.recording.recorded_run import drawn_run_of

    discard(resolve(sinks))  # what cannot be written is told before anything is flown
    known: dict[str, Run] = {}
    scenes: dict[str, Scene] = {}
    for name, source in runs.items():
        if isinstance(source, Run):
            known[name] = source
        elif isinstance(source, Recording):
            known[name] = drawn_run_of(source)
        else:
            from sailviz.scene.loading import load_scene

            scenes[name] = load_scene(source)
    if not scenes:
        return record_together(known, *sinks)
    from sailviz.simulation.bodies import body_of
    from sailviz.simulation.loop import simulate
    from sailviz.simulation.metadata import family_of

    told = {name: (run.setting.family, run.setting.body.name) for name, run in known.items()}
    told |= {name: (family_of(scene), body_of(scene).name) for name, scene in scenes.items()}
    check_together([(name, *told[name]) for name in runs])
    flown = {name: known[name] if name in known else simulate(scenes[name]) for name in runs}
    return record_together(flown, *sinks)
