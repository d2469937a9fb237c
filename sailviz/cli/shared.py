"""What commands share: arguments, settings as KEY=VALUE, a progress bar, messages and exit codes.

0 all went well, 1 an expectation or a picture failed, 2 bad input or the time limit, 3 the propagation failed, 4 a
fault of sailviz itself, 130 interrupted, 141 nobody reads what is printed.
"""

from __future__ import annotations

import json
import re
import sys
import tomllib
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

import click

from sailviz.errors import PropagationError, RecordingError, SailvizError, SceneError, TimeLimitError

if TYPE_CHECKING:
    from sailviz.scene import Scene

EXPECTATION_FAILED, BAD_INPUT, RUN_FAILED, UNFORESEEN, INTERRUPTED, UNREAD = 1, 2, 3, 4, 130, 141
LONGEST_WORD, LONGEST_LINE = 300, 2000  # letters of a message; what is longer was given by accident

scenes_argument = click.argument("scenes", nargs=-1, required=True, metavar="SCENE...")
files_argument = click.argument("files", nargs=-1, required=True, metavar="FILE...")
set_option = click.option(
    "--set",
    "settings",
    multiple=True,
    metavar="KEY=VALUE",
    help="Put a value over the scene's, e.g. propagation.duration_yr=1.",
)


def time_limit_option(help: str) -> Callable[[Any], Any]:
    """--time-limit, in seconds."""
    kind = click.FloatRange(0, 1e9, min_open=True)
    return click.option("--time-limit", type=kind, callback=_a_number, metavar="SECONDS", help=help)


def _a_number(context: click.Context, option: click.Parameter, value: float | None) -> float | None:
    if value is not None and value != value:
        raise click.BadParameter("nan is not a number of seconds")
    return value


def values_of(settings: Iterable[str]) -> dict[str, Any]:
    """KEY=VALUE pairs; the value is read as TOML, or taken as text where it is not."""
    values = {}
    for setting in settings:
        key, equals, text = setting.partition("=")
        if not equals or not key.strip():
            raise click.BadParameter(f"{setting!r} is not KEY=VALUE", param_hint="--set")
        try:
            values[key.strip()] = tomllib.loads(f"value = {text}")["value"]
        except tomllib.TOMLDecodeError:
            values[key.strip()] = text.strip()
    return values


def say_if_compiling(quiet: bool) -> None:
    """Tell a person why the first run, or the first that needs other machine code, takes so long."""
    from sailviz.compiled import when_long

    if not quiet:
        when_long(_say_compiling)


def _say_compiling() -> None:
    click.echo("Compiling for this machine: once, up to half a minute.", err=True)


@contextmanager
def progress_bar(title: str, quiet: bool) -> Iterator[Callable[[float], None] | None]:
    """A bar for work longer than a second, silent when not on a terminal."""
    if quiet or not sys.stderr.isatty():
        yield None
        return
    from tqdm import tqdm

    with tqdm(
        total=1.0, desc=title[:40], delay=1, leave=False, bar_format="{l_bar}{bar}| {elapsed}<{remaining}"
    ) as bar:
        yield lambda fraction: bar.update(fraction - bar.n)


def make_tables(scene: Scene, quiet: bool) -> None:
    """Have the tables of a sail's shape, under a bar of their own where they have to be made: it may take longer than
    the flight. SceneError where they cannot be had."""
    from sailviz.scene.device import has_shape

    if not has_shape(scene.device):
        return
    from sailviz.simulation.sail_shape import sail_shape

    with progress_bar("Light on the shape", quiet) as progress:
        sail_shape(scene, progress)


def tell(message: object) -> None:
    """A message to the person at the shell, on standard error."""
    click.echo(bearable(said(message)), err=True)


def said(message: object) -> str:
    """A message in words; a scene's faults in those of a shell, which puts values over the scene's by --set."""
    return message.words("--set") if isinstance(message, SceneError) else str(message)


def bearable(text: str) -> str:
    """A message whose words and lines are not endless."""
    text = re.sub(rf"\S{{{LONGEST_WORD},}}", lambda word: f"{word[0][:200]}...{word[0][-60:]}", text)
    lines = [line if len(line) <= LONGEST_LINE else f"{line[:1500]}...{line[-200:]}" for line in text.split("\n")]
    return "\n".join(lines)


class Failures:
    """Collects what went wrong over several scenes, so that one bad scene does not hide the others."""

    def __init__(self, as_json: bool):
        self.code = 0
        self.as_json = as_json
        self.summaries: list[dict[str, Any]] = []

    def worst(self, code: int) -> None:
        """Exit with this code, unless with a higher one."""
        self.code = max(self.code, code)

    def summary(self, values: dict[str, Any]) -> None:
        """What --json prints of one scene."""
        self.summaries.append(values)

    @contextmanager
    def next(self, name: str = "") -> Iterator[None]:
        """Go on with the next scene whatever becomes of this one."""
        try:
            yield
        except SceneError as error:
            self._tell(name, error, BAD_INPUT)
        except TimeLimitError as error:
            self._tell(name, error, BAD_INPUT)
        except RecordingError as error:
            self._tell(name, error, BAD_INPUT)
        except SailvizError as error:  # a flight, or an analytic solution beside it, that cannot go on
            self._tell(name, error, RUN_FAILED)

    def _tell(self, name: str, error: Exception, code: int) -> None:
        self.worst(code)
        if self.as_json:
            self.summaries.append({"scene": name, "error": said(error)})
        tell(f"{name}: {error}" if isinstance(error, (PropagationError, TimeLimitError)) else error)


@contextmanager
def collecting_failures(as_json: bool = False) -> Iterator[Failures]:
    """What goes wrong within is told when it happens; the worst of it is the exit code."""
    failures = Failures(as_json)
    try:
        yield failures
    except KeyboardInterrupt:
        click.echo("Interrupted.", err=True)
        failures.worst(INTERRUPTED)
    if as_json:
        click.echo(json.dumps(failures.summaries, indent=2))
    if failures.code:
        sys.exit(failures.code)


@contextmanager
def in_one_sentence() -> Iterator[None]:
    """A recording that cannot be read or written ends the command in one sentence and exit code 2."""
    try:
        yield
    except RecordingError as error:
        tell(error)
        sys.exit(BAD_INPUT)
