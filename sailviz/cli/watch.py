"""The command that flies a scene again whenever its file is saved. Heavy modules are imported inside."""

from __future__ import annotations

import time
import tomllib
from collections.abc import Iterable, Iterator, Mapping
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from sailviz.cli.numbers import PORT
from sailviz.cli.shared import (
    collecting_failures,
    make_tables,
    progress_bar,
    said,
    say_if_compiling,
    set_option,
    tell,
    time_limit_option,
    values_of,
)
from sailviz.cli.telling import tell_flight
from sailviz.errors import PropagationError, RecordingError, SceneError, TimeLimitError

if TYPE_CHECKING:
    from sailviz.recording.views.live import LiveViewer
    from sailviz.scene import Scene

EVERY = 0.2  # s between two looks at the files; a file that is the same twice is no longer being written
Stamps = dict[Path, tuple[int, int, int] | None]  # time of the last change, size and number of each file


@click.command()
@click.argument("scene", metavar="SCENE")
@set_option
@click.option(
    "--port", type=PORT, default=0, help="On which the viewer listens to this machine; a free one by default."
)
@time_limit_option("Give a flight up after so much wall time.")
@click.option("-q", "--quiet", is_flag=True, help="Print faults only.")
def watch(scene: str, settings: tuple[str, ...], port: int, time_limit: float | None, quiet: bool) -> None:
    """Fly a scene again whenever its file is saved, in one viewer that stays open.

    The eye, the moment and what else was changed in the viewer stay. Faults are told here and above the last good
    flight. Files of measured winds that the scene names are watched as well. Ctrl-C, or closing the window, ends it.
    """
    values = values_of(settings)
    with collecting_failures() as failures, failures.next(scene):
        from sailviz.scene.loading import find_scene

        find_scene(scene)  # a name that there is not is told before a window opens
        from sailviz.recording.views.live import LiveViewer

        with suppress(KeyboardInterrupt), LiveViewer(port) as viewer:
            Watch(scene, values, viewer, time_limit, quiet).go_on()


class Changed(Exception):
    """A file was saved, or the window closed, while its scene was flown."""


class Watch:
    """One scene and the viewer that shows it."""

    def __init__(self, name: str, values: dict[str, Any], viewer: LiveViewer, time_limit: float | None, quiet: bool):
        self._name, self._values, self._viewer = name, values, viewer
        self._time_limit, self._quiet = time_limit, quiet
        self._files: list[Path] = []
        self._stamps: Stamps = {}
        self._flights, self._shown = 0, viewer.folder / "none"

    def go_on(self) -> None:
        """Fly, show, and wait for the next change, until the viewer is closed."""
        say_if_compiling(self._quiet)
        while self._viewer.is_open:
            try:
                self._once()
                if not self._quiet:
                    click.echo(f"Watching {self._name}; Ctrl-C ends it.", err=True)
            except Changed:
                pass
            except RecordingError as error:
                if self._viewer.is_open:  # else its window was closed meanwhile
                    tell(error)
            self._wait()

    def _once(self) -> None:
        """Fly the scene as it is now and show it, or tell what is wrong with it."""
        file = scene_file(self._name)
        self._look([file])
        self._look([file, *named_in(file, self._name, self._values)])
        try:
            from sailviz.scene import load_scene

            scene = load_scene(self._name, self._values)
            path = self._flown(scene)
            self._viewer.show(path)
            self._shown.unlink(missing_ok=True)  # the viewer may read on in what it shows
            self._shown = path
        except (SceneError, PropagationError, TimeLimitError) as error:
            tell(said(error))
            self._viewer.tell("Not flown", f"The scene could not be flown:\n\n```\n{said(error)}\n```")

    def _flown(self, scene: Scene) -> Path:
        """Fly a scene -> its recording. Changed where a file is saved on the way."""
        from sailviz.checks.expectations import Judge
        from sailviz.recording import Recorder
        from sailviz.simulation import simulate_blocks

        self._flights += 1
        path = self._viewer.folder / f"flight_{self._flights}.rrd"
        judge, rows, ended = Judge(scene), 0, ""
        try:
            make_tables(scene, self._quiet)
            with progress_bar(scene.title, self._quiet) as bar:

                def progress(done: float) -> None:
                    self._check()
                    if bar is not None:
                        bar(done)

                blocks = simulate_blocks(scene, progress=progress, time_limit=self._time_limit)
                with Recorder(path) as recorder:
                    for block in blocks:
                        recorder.add(block)
                        judge.add(block)
                        rows, ended = rows + len(block), block.ended
        except BaseException:
            path.unlink(missing_ok=True)
            raise
        if not self._quiet:
            remarks = recorder.recorded.remarks if recorder.recorded else ()
            tell_flight(scene.title, recorder.time, rows, ended, judge.verdicts(), remarks)
        return path

    def _look(self, files: Iterable[Path]) -> None:
        """Remember how files are before they are read; what is remembered of one already stays."""
        self._files = list(files)
        self._stamps = stamps(self._files) | {file: self._stamps[file] for file in self._files if file in self._stamps}

    def _check(self) -> None:
        if stamps(self._files) != self._stamps or not self._viewer.is_open:
            raise Changed

    def _wait(self) -> None:
        """Wait until a file differs from what was read and is whole, or the viewer is closed."""
        before = self._stamps
        while self._viewer.is_open:
            now = stamps(self._files)
            if now != self._stamps and now == before:
                self._stamps = {}
                return
            before = now
            time.sleep(EVERY)


def scene_file(name: str) -> Path:
    """The file that a path or a shipped name means; the path where there is none just now, as while it is replaced."""
    from sailviz.scene.loading import find_scene

    try:
        return find_scene(name)[0]
    except SceneError:
        return Path(name)


def named_in(file: Path, name: str, values: Mapping[str, Any]) -> list[Path]:
    """The files that a scene names, whether it can be flown or not, and those of the values put over it."""
    from sailviz.scene.named_files import folder_beside, outside

    try:
        tables = tomllib.loads(file.read_text(encoding="utf-8-sig"))
    except (OSError, ValueError, RecursionError):
        tables = {}
    folder = folder_beside(name)
    names = {*_files_of(tables), *(value for key, value in values.items() if key.split(".")[-1] == "file")}
    return [folder / text for text in sorted(filter(None, map(str, names))) if not outside(folder, text)]


def _files_of(part: Any) -> Iterator[str]:
    """Every text under the key `file`, however deep."""
    if isinstance(part, dict):
        if isinstance(part.get("file"), str):
            yield part["file"]
        part = list(part.values())
    if isinstance(part, list):
        for inner in part:
            yield from _files_of(inner)


def stamps(files: Iterable[Path]) -> Stamps:
    """How files are now: None for one that is not there. Editors that save under a new name change its number."""
    found: Stamps = {}
    for file in files:
        try:
            facts = file.stat()
            found[file] = (facts.st_mtime_ns, facts.st_size, facts.st_ino)
        except OSError:
            found[file] = None
    return found
