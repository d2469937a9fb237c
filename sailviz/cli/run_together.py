"""`sailviz run --together`: several scenes are flown, judged each by itself, and recorded in one picture."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from sailviz.cli.outputs import is_folder
from sailviz.cli.shared import EXPECTATION_FAILED, Failures, make_tables, progress_bar, say_if_compiling
from sailviz.cli.telling import rerun_command, tell_flight, verdict_facts
from sailviz.cli.together import flight_names, refuse_names
from sailviz.errors import RecordingError

if TYPE_CHECKING:
    from sailviz.checks import Verdict
    from sailviz.run import Run
    from sailviz.scene import Scene

DEFAULT = "together.rrd"


def check_asked(scenes: Sequence[str], names: Sequence[str], output: str | None) -> list[str]:
    """What the flights are called. UsageError for what makes no one picture."""
    if len(scenes) < 2:
        raise click.UsageError("--together takes two scenes or more.")
    if output not in (None, "-") and (is_folder(str(output)) or not Path(str(output)).suffix):
        raise click.UsageError(f"--together writes one recording: -o names its file, such as {DEFAULT}, not a folder.")
    return flight_names(scenes, names)


def run_together(
    scenes: Sequence[str],
    names: Sequence[str],
    values: dict[str, Any],
    sinks: Callable[[], list[Any]],
    failures: Failures,
    quiet: bool,
    time_limit: float | None,
) -> None:
    """Fly, judge and record. Nothing is recorded unless every flight comes to its end."""
    loaded = _loaded(scenes, names, values, failures)
    if loaded is None:
        return
    say_if_compiling(quiet)
    flown: dict[str, Run] = {}
    facts, verdicts = [], []
    for path, name, scene in zip(scenes, names, loaded, strict=True):
        with failures.next(path):
            flown[name], judged = _flown(scene, quiet, time_limit)
            facts.append(_summary(path, name, scene, flown[name], judged))
            verdicts.append(judged)
    if len(flown) < len(names):
        missing = ", ".join(name for name in names if name not in flown)
        raise RecordingError(f"nothing was recorded: {missing} did not fly to the end")
    from sailviz.recording.overlay import recorded_together

    recorded = recorded_together(flown, *sinks())
    for each, judged in zip(facts, verdicts, strict=True):
        each["recording"] = [str(path) for path in recorded.paths]
        failures.summary(each)
        _judge(each, judged, failures, quiet)
    if not quiet:
        for file in recorded.paths:
            click.echo(f"Recorded {file}; look at it with: {rerun_command()} {file}")
    if recorded.url:
        click.echo(f"Watch it at {recorded.url} ; Ctrl-C ends it.", err=True)
        recorded.serve()


def _loaded(
    scenes: Sequence[str], names: Sequence[str], values: dict[str, Any], failures: Failures
) -> list[Scene] | None:
    """The scenes, once it is known that they fit together; None where one has faults, which have been told."""
    from sailviz.recording.companions import check_together, name_faults
    from sailviz.scene import load_scene

    loaded = []
    for path in scenes:
        with failures.next(path):
            loaded.append(load_scene(path, values))
    refuse_names(name_faults(names))
    if len(loaded) < len(scenes):
        return None
    from sailviz.simulation.bodies import body_of
    from sailviz.simulation.metadata import family_of

    told = [(name, family_of(scene), body_of(scene).name) for name, scene in zip(names, loaded, strict=True)]
    check_together(told)
    many = [name for name, scene in zip(names, loaded, strict=True) if scene.ensemble or scene.chaos]
    if many:
        raise RecordingError(f"{', '.join(many)}: an ensemble of flights; only single flights are put in one picture")
    return loaded


def _flown(scene: Scene, quiet: bool, time_limit: float | None) -> tuple[Run, list[Verdict]]:
    """A whole flight, and what became of what its scene expects."""
    from sailviz.checks.expectations import Judge
    from sailviz.run.arrays import join
    from sailviz.simulation import simulate_blocks

    judge, blocks = Judge(scene), []
    make_tables(scene, quiet)
    with progress_bar(scene.title, quiet) as progress:
        for block in simulate_blocks(scene, progress=progress, time_limit=time_limit):
            judge.add(block)
            blocks.append(block)
    return join(blocks), judge.verdicts()


def _summary(path: str, name: str, scene: Scene, run: Run, verdicts: list[Verdict]) -> dict[str, Any]:
    return {
        "scene": path,
        "name": name,
        "title": scene.title,
        "rows": len(run),
        "duration_s": float(run.time[-1]),
        "ended": run.ended,
        "recording": [],
        "identity": run.setting.identity,
        "expectations": [verdict_facts(verdict) for verdict in verdicts],
    }


def _judge(facts: dict[str, Any], verdicts: list[Verdict], failures: Failures, quiet: bool) -> None:
    """Tell a flight and its verdicts, and remember whether one has failed."""
    if not quiet:
        title = f"{facts['name']}: {facts['title']}"
        tell_flight(title, facts["duration_s"], facts["rows"], facts["ended"], verdicts)
    failed = [verdict for verdict in verdicts if not verdict.passed]
    if failed:
        failures.worst(EXPECTATION_FAILED)
        for verdict in failed if quiet else ():
            click.echo(f"{facts['scene']}: {verdict}", err=True)
