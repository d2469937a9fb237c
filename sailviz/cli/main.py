"""The command line: the same verbs as the Python interface.

Exit codes: 0 all went well, 1 an expectation of a scene failed, 2 bad input, 3 the propagation or the recording failed,
130 interrupted. Heavy modules are imported by the command that needs them, so that `sailviz check` answers at once.
"""

from __future__ import annotations

import json
import os
import sys
from pathlib import Path

import click

from sailviz.cli import figures as cli_figures
from sailviz.cli import pictures as cli_pictures
from sailviz.cli import recordings as cli_recordings
from sailviz.cli import sweep as cli_sweep
from sailviz.cli import transfer as cli_transfer
from sailviz.cli.shared import (
    EXPECTATION_FAILED,
    collecting_failures,
    progress_bar,
    say_if_compiling,
    set_option,
    values_of,
)
from sailviz.errors import PropagationError, RecordingError
from sailviz.scene.loading import load_scene, schema
from sailviz.shipped import shipped_scenes


@click.group(context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(package_name="sailviz")
def main():
    """Trajectories of solar sails, electric sails and plasma brakes: computed, recorded, replayed."""


for _room in (cli_recordings, cli_pictures, cli_figures, cli_sweep, cli_transfer):
    for _command in _room.COMMANDS:
        main.add_command(_command)


scenes_argument = click.argument("scenes", nargs=-1, required=True, metavar="SCENE...")


@main.command("list")
def list_scenes():
    """Name the scenes that come with sailviz."""
    for name in shipped_scenes():
        click.echo(f"{name:<34} {load_scene(name).title}")


@main.command()
@scenes_argument
@set_option
def check(scenes, settings):
    """Read scenes and report every fault in them."""
    with collecting_failures() as failures:
        for name in scenes:
            with failures.next():
                scene = load_scene(name, values_of(settings))
                click.echo(f"{name}: ok, {scene.title}")


@main.command()
@click.argument("scene")
@set_option
def show(scene, settings):
    """Print every value of a scene, defaults included, in SI and in words."""
    from sailviz.scene.show import resolved_lines

    with collecting_failures() as failures, failures.next():
        for line in resolved_lines(load_scene(scene, values_of(settings))):
            click.echo(line)


@main.command("schema")
def print_schema():
    """Print the JSON Schema of scene files, for editors that complete and check them."""
    click.echo(json.dumps(schema(), indent=2))


@main.command()
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
@click.option("-q", "--quiet", is_flag=True, help="Print errors only.")
@click.option("--json", "as_json", is_flag=True, help="Print a summary that a script can read.")
def run(scenes, settings, output, view, web, connect, quiet, as_json):
    """Propagate scenes, record them, and judge them by what they expect.

    SCENE is a TOML file or the name of a shipped scene. Without -o, --view, --web or --connect the recording goes to
    NAME.rrd in the current folder.
    """
    if sum(map(bool, (view, web, connect))) > 1:
        raise click.UsageError("--view, --web and --connect exclude each other.")
    if output == "-" and (len(scenes) > 1 or view or web or connect or as_json):
        raise click.UsageError("-o - takes one scene and no viewer, and leaves no room for --json.")
    if len(scenes) > 1 and output and Path(output).suffix:
        raise click.UsageError("-o names one file, but there are several scenes: give a folder.")
    quiet = quiet or as_json or output == "-"
    with collecting_failures(as_json) as failures:
        for name in scenes:
            with failures.next(name):
                _run_one(name, values_of(settings), _sinks(name, output, view, web, connect), quiet, failures)


def _sinks(name, output, view, web, connect) -> list:
    """Where the recording of one scene goes, as words that need no import: ("file", path), ("view",), ..."""
    sinks = []
    if output == "-":
        sinks.append(("stdout",))
    elif output or not (view or web or connect):
        file = Path(f"{Path(name).stem}.rrd")
        if output:
            file = Path(output) if Path(output).suffix and not Path(output).is_dir() else Path(output) / file
        sinks.append(("file", file))
    sinks += [("view",)] * view + [("web",)] * web + ([("connect", connect)] if connect else [])
    return sinks


def _open(sinks):
    """Sinks of the recorder from words."""
    from sailviz import recording

    made = {
        "file": lambda path: path,
        "stdout": lambda: recording.STDOUT,
        "view": lambda: recording.VIEWER,
        "web": lambda: recording.WEB,
        "connect": recording.Connect,
    }
    for kind, *rest in sinks:
        if kind == "file":
            try:
                rest[0].parent.mkdir(parents=True, exist_ok=True)
            except OSError as error:
                raise RecordingError(f"cannot make the folder {rest[0].parent}: {error.strerror.lower()}") from None
    return [made[kind](*rest) for kind, *rest in sinks]


def _run_one(name, values, sinks, quiet, failures):
    scene = load_scene(name, values)
    from sailviz.checks.expectations import Judge, table
    from sailviz.simulation.loop import simulate_blocks

    say_if_compiling(quiet)
    judge = Judge(scene)
    with progress_bar(scene.title, quiet) as progress:
        blocks = simulate_blocks(scene, progress=progress)
        first = next(blocks)  # an infeasible scene fails here, before a recording is begun
        from sailviz.recording import Recorder

        rows, ended = 0, ""
        with Recorder(*_open(sinks)) as recorder:
            try:
                while first is not None:
                    recorder.add(first)
                    judge.add(first)
                    rows, ended = rows + len(first), first.ended
                    first = next(blocks, None)
            except (KeyboardInterrupt, PropagationError):
                recorder.__exit__(*sys.exc_info())  # finish the file with what there is
                _say_unfinished(recorder)
                raise
            recorded = recorder.finish()
            seconds = recorder.time
    verdicts = judge.verdicts()
    failures.summary(
        {
            "scene": name,
            "title": scene.title,
            "rows": rows,
            "duration_s": seconds,
            "ended": ended,
            "recording": [str(path) for path in recorded.paths],
            "identity": recorded.identity,
            "expectations": [
                {
                    "quantity": v.quantity,
                    "at": v.at,
                    "expected": v.expected,
                    "within": v.tolerance,
                    "measured": None if v.measured != v.measured else v.measured,
                    "passed": v.passed,
                }
                for v in verdicts
            ],
        }
    )
    if not quiet:
        from sailviz.words import duration

        end = f", ended by {ended}" if ended else ""
        click.echo(f"{scene.title}: {duration(seconds)}, {rows:,} rows{end}")
        if verdicts:
            click.echo(table(verdicts))
        for path in recorded.paths:
            click.echo(f"Recorded {path}; look at it with: {_rerun()} {path}")
    failed = [verdict for verdict in verdicts if not verdict.passed]
    if failed:
        failures.worst(EXPECTATION_FAILED)
        if quiet:
            for verdict in failed:
                click.echo(f"{name}: {verdict}", err=True)
    if recorded.url:
        click.echo(f"Watch it at {recorded.url} ; Ctrl-C ends it.", err=True)
        recorded.serve()


def _rerun() -> str:
    """How this person calls the viewer: by its name if the shell finds it, else by its path."""
    import shutil

    if shutil.which("rerun"):
        return "rerun"
    beside = Path(sys.executable).with_name("rerun")
    return os.path.relpath(beside) if Path.cwd() in beside.parents else str(beside)


def _say_unfinished(recorder):
    from sailviz.words import duration

    for path in recorder.recorded.paths if recorder.recorded else ():
        click.echo(f"Unfinished: {path} is valid up to {duration(recorder.time)} and says so.", err=True)


if __name__ == "__main__":
    main()
