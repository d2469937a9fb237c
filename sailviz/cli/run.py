"""The command that flies scenes, records them and judges them. Heavy modules are imported inside."""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from sailviz.cli.outputs import file_at, file_or_folder, make_folder
from sailviz.cli.run_together import DEFAULT, check_asked, run_together
from sailviz.cli.shared import (
    EXPECTATION_FAILED,
    Failures,
    collecting_failures,
    make_tables,
    progress_bar,
    say_if_compiling,
    scenes_argument,
    set_option,
    time_limit_option,
    values_of,
)
from sailviz.cli.telling import rerun_command, tell_flight, verdict_facts
from sailviz.cli.together import name_option
from sailviz.errors import PropagationError, TimeLimitError

if TYPE_CHECKING:
    from sailviz.checks import Verdict
    from sailviz.recording import Recorder
    from sailviz.run import Run
    from sailviz.scene import Scene


@click.command()
@scenes_argument
@set_option
@click.option(
    "-o", "--output", metavar="FILE|DIR", help="Recording to write, or folder for several; - for standard output."
)
@click.option("--view", is_flag=True, help="Watch in the native viewer while it is computed.")
@click.option("--web", is_flag=True, help="Serve it to a browser on this machine; works offline.")
@click.option(
    "--connect", metavar="URL", help="Send it to a viewer that runs already, e.g. rerun+http://host:9876/proxy."
)
@click.option(
    "--together", is_flag=True, help="Record scenes of one family in one picture, together.rrd unless -o is given."
)
@name_option
@time_limit_option("End each scene after so much wall time; what was recorded until then stays.")
@click.option("-q", "--quiet", is_flag=True, help="Print errors only.")
@click.option("--json", "as_json", is_flag=True, help="Print a summary that a script can read.")
def run(
    scenes: tuple[str, ...],
    settings: tuple[str, ...],
    output: str | None,
    view: bool,
    web: bool,
    connect: str | None,
    together: bool,
    names: tuple[str, ...],
    time_limit: float | None,
    quiet: bool,
    as_json: bool,
) -> None:
    """Propagate scenes, record them, and judge them by what they expect.

    SCENE is a TOML file or the name of a shipped scene. Without -o, --view, --web or --connect the recording goes to
    NAME.rrd in the current folder.

    With --together flights of one family, about one body, are drawn in one picture, each in its own colour and called
    after its scene or by --name, with how far they are from the first one. They are recorded once all have flown.
    """
    if view + web + (connect is not None) > 1:
        raise click.UsageError("--view, --web and --connect exclude each other.")
    called = check_asked(scenes, names, output) if together else []
    if names and not together:
        raise click.UsageError("--name is for several flights in one picture, with --together.")
    if output == "-" and ((len(scenes) > 1 and not together) or view or web or connect is not None or as_json):
        raise click.UsageError("-o - takes one recording and no viewer, and leaves no room for --json.")
    if len(scenes) > 1 and not together and output and Path(output).suffix:
        raise click.UsageError("-o names one file, but there are several scenes: give a folder.")
    quiet = quiet or as_json or output == "-"
    values = values_of(settings)
    with collecting_failures(as_json) as failures:
        if together:
            with failures.next("together"):
                sinks = _sinks(DEFAULT, output, view, web, connect)
                run_together(scenes, called, values, sinks, failures, quiet, time_limit)
            return
        for name in scenes:
            with failures.next(name):
                sinks = _sinks(name, output, view, web, connect)
                _run_one(name, values, sinks, quiet, failures, time_limit)


def _sinks(name: str, output: str | None, view: bool, web: bool, connect: str | None) -> Callable[[], list[Any]]:
    """Where the recording of one scene goes, checked now. Called once there is something to record, what comes back
    makes the file's folder and the recorder's sinks."""
    watched = view or web or connect is not None
    file = None
    if output is not None and output != "-":
        file = file_or_folder(output, f"{Path(name).stem}.rrd", "recording")
    elif output is None and not watched:
        file = file_at(f"{Path(name).stem}.rrd", "recording")
    if connect is not None:
        from sailviz.recording.addresses import check_answer

        check_answer(connect)

    def made() -> list[Any]:
        from sailviz import recording

        if file is not None:
            make_folder(file.parent)
        places: list[Any] = [recording.STDOUT] if output == "-" else [] if file is None else [file]
        places += [recording.VIEWER] * view + [recording.WEB] * web
        return places + ([] if connect is None else [recording.Connect(connect)])

    return made


def _run_one(
    name: str,
    values: dict[str, Any],
    sinks: Callable[[], list[Any]],
    quiet: bool,
    failures: Failures,
    time_limit: float | None,
) -> None:
    from sailviz.scene import load_scene

    scene = load_scene(name, values)
    from sailviz.checks.expectations import Judge

    say_if_compiling(quiet)
    judge = Judge(scene)
    recorder, rows, ended = _flown(scene, sinks, judge.add, quiet, time_limit)
    recorded = recorder.finish()
    verdicts = judge.verdicts()
    facts = {
        "scene": name,
        "title": scene.title,
        "rows": rows,
        "duration_s": recorder.time,
        "ended": ended,
        "recording": [str(path) for path in recorded.paths],
        "identity": recorded.identity,
        "expectations": [verdict_facts(verdict) for verdict in verdicts],
    }
    failures.summary(facts)
    if not quiet:
        _tell(facts, verdicts, recorded.remarks)
    failed = [verdict for verdict in verdicts if not verdict.passed]
    if failed:
        failures.worst(EXPECTATION_FAILED)
        if quiet:
            for verdict in failed:
                click.echo(f"{name}: {verdict}", err=True)
    if recorded.url:
        click.echo(f"Watch it at {recorded.url} ; Ctrl-C ends it.", err=True)
        recorded.serve()


def _flown(
    scene: Scene,
    sinks: Callable[[], list[Any]],
    judge: Callable[..., None],
    quiet: bool,
    time_limit: float | None,
) -> tuple[Recorder, int, str]:
    """Fly, record and judge a scene block by block -> (recorder that is finished, rows, what ended the run)."""
    from sailviz.simulation import simulate_blocks

    make_tables(scene, quiet)
    with progress_bar(scene.title, quiet) as progress:
        blocks = simulate_blocks(scene, progress=progress, time_limit=time_limit)
        block: Run | None = next(blocks)  # an infeasible scene fails here, before a recording is begun
        from sailviz.recording import Recorder

        rows, ended = 0, ""
        with Recorder(*sinks()) as recorder:
            try:
                while block is not None:
                    recorder.add(block)
                    judge(block)
                    rows, ended = rows + len(block), block.ended
                    block = next(blocks, None)
            except (KeyboardInterrupt, PropagationError, TimeLimitError):
                recorder.__exit__(*sys.exc_info())  # finish the file with what there is
                _say_unfinished(recorder)
                raise
            recorder.finish()
    return recorder, rows, ended


def _tell(facts: dict[str, Any], verdicts: list[Verdict], remarks: tuple[str, ...]) -> None:
    tell_flight(facts["title"], facts["duration_s"], facts["rows"], facts["ended"], verdicts, remarks)
    for path in facts["recording"]:
        click.echo(f"Recorded {path}; look at it with: {rerun_command()} {path}")


def _say_unfinished(recorder: Recorder) -> None:
    from sailviz.words import duration

    for path in recorder.recorded.paths if recorder.recorded else ():
        click.echo(f"Unfinished: {path} is valid up to {duration(recorder.time)} and says so.", err=True)
