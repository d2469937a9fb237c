"""Pictures of a recording, without a screen: Rerun's viewer runs headless on software Vulkan and is asked for
screenshots.
"""

from __future__ import annotations

import contextlib
import copy
import io
import math
import os
import time
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import cached_property, partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, Self

from sailviz import files
from sailviz.errors import RecordingError
from sailviz.recording.children import Child
from sailviz.recording.reader import FilePath, read
from sailviz.recording.sinks import viewer_binary
from sailviz.recording.views import paper
from sailviz.recording.views.asking import A, ask, place_on
from sailviz.recording.views.dressed import Words, dress, words_of
from sailviz.recording.views.scratch import scratch
from sailviz.recording.web_page import free_port

if TYPE_CHECKING:
    from rerun.experimental import ViewerClient

PACKAGES = "libvulkan1 mesa-vulkan-drivers"
START, SETTLE = 60.0, 25.0  # s to wait for the viewer, and for a picture that no longer changes
AGREE = 3  # frames in a row that must be the same
BAR = 37  # pixels of the empty bar that a hidden menu leaves
MAIN_TOGETHER = ("Flight", "Descent", "Riding along")  # riding along with one, others are not in sight
MAIN = ("Flight", "Riding along")  # the names of main views, and of recordings from elsewhere whatever comes first
STYLES = ("dark", "paper")
LARGEST_SCALE, MOST_PIXELS = 4.0, 8192
LARGER = "ui.zoom_in_ui"  # the viewer's command that makes everything a tenth larger
FRAME = (7, 34)  # pixels of the window round a view that fills it, the bar apart


@dataclass(frozen=True)
class PictureReport:
    """A picture that was taken. `errors` and `warnings` are what the views complained about."""

    path: Path
    size: tuple[int, int]
    errors: tuple[str, ...]
    warnings: tuple[str, ...]
    seconds: float


def picture(
    path: FilePath,
    png: FilePath,
    *,
    view: str | None = None,
    at: float | str = 1.0,
    size: tuple[int, int] = (1600, 900),
    panels: bool = True,
    chrome: bool = False,
    dressed: bool = False,
    scale: float = 1.0,
    style: str = "dark",
) -> PictureReport:
    """Take one picture of a recording.

    view : the start of a view's name (Flight, From above, Riding along, ...) to have it alone, None for the window
    at : fraction of the run, or "start", "end"; panels : False leaves out the time panel; chrome : with the viewer's
    menu and badges; dressed : one view, by default the main one, with the title above, the line of the moment below
    and how far the run has come; size : of the window in points; scale : pixels to a point, 1 to 4 in tenths, so that
    the same layout is sharp in print; style : "dark" or "paper", on white
    Raises RecordingError where there is no such view, no Vulkan, or no viewer.
    """
    alone = view is not None or dressed
    if alone:
        size, panels = (size[0] + FRAME[0], size[1] + FRAME[1]), False
    with Studio(path, size=size, panels=panels, chrome=chrome and not alone, scale=scale, style=style) as studio:
        return studio.shoot(png, view=view or (studio.main if dressed else None), at=at, dressed=dressed)


class Studio:
    """One headless viewer for many pictures of one recording: `with Studio("orbit.rrd") as studio:
    studio.shoot("a.png")`.
    """

    def __init__(
        self,
        path: FilePath,
        *,
        size: tuple[int, int] = (1600, 900),
        panels: bool = True,
        chrome: bool = False,
        scale: float = 1.0,
        style: str = "dark",
    ):
        read(path)  # says in one sentence what cannot be shown
        self._path, self._panels, self._chrome = Path(path).resolve(), panels, chrome
        self._zoom, self._paper = tenths_above_one(scale, size), is_paper(style)
        height = int(size[1]) + (0 if chrome else BAR)
        self._size = (math.ceil(scale * int(size[0])), math.ceil(scale * height))
        self._whole = (round(scale * int(size[0])), round(scale * int(size[1])))
        self._alone = (round(scale * (int(size[0]) - FRAME[0])), round(scale * (int(size[1]) - FRAME[1])))

    def __enter__(self) -> Self:
        check_vulkan()
        with contextlib.ExitStack() as begun:
            folder = begun.enter_context(scratch())
            files_shown = [self._path]
            if self._paper:
                files_shown.append(paper.write_changes(self._path, folder / "paper.rrd"))
            self._process, port = start_viewer(files_shown, self._size, folder)
            begun.callback(self._process.end)
            self._client, state = self._wait_for_viewer(f"rerun+http://127.0.0.1:{port}/proxy")
            recording = next(r for r in state.recordings if r.store_id == state.active_recording)
            timelines = {timeline.name: timeline for timeline in recording.timelines}
            self._timeline = timelines[recording.current_timeline]
            self._blueprint = self._asked("for its blueprint", self._client.get_blueprint).blueprint
            for _ in range(self._zoom):
                self._asked("for larger letters", lambda: self._client.run_command(LARGER))
            self._shown: tuple[str | None, str | None] | None = None
            self._begun = begun.pop_all()
        return self

    def _asked(self, words: str, question: Callable[[], A]) -> A:
        """The viewer's answer. RecordingError, in a sentence, where it never answers."""
        return ask(self._process, words, question, f"the viewer of {self._path.name}")

    def _wait_for_viewer(self, url: str) -> tuple[ViewerClient, Any]:
        """The viewer, and its state once it shows the recording."""
        from rerun.experimental import ViewerClient

        started, client = time.monotonic(), None
        while time.monotonic() - started < START:
            if self._process.poll() is not None:
                raise RecordingError(f"the viewer ended at once; it may want the packages {PACKAGES}")
            with contextlib.suppress(Exception):  # not up yet
                client = client or ViewerClient.connect(url)
                state = client.get_state()
                if state.active_recording and not state.loading and any(r.timelines for r in state.recordings):
                    return client, state
            time.sleep(0.05)
        raise RecordingError(f"the viewer did not show {self._path} within {START:.0f} s")

    @cached_property
    def _words(self) -> Words:
        """What a dressed picture says."""
        return words_of(self._path)

    @property
    def main(self) -> str:
        """The name of the view that shows the flight."""
        names, first = self._names(), MAIN_TOGETHER if read(self._path).flights else MAIN
        found = (named(wanted, names) for wanted in first)
        return next((name for name in found if name is not None), next(iter(names)))

    @property
    def views(self) -> list[str]:
        """Names of the views of the recording, without what stands in brackets."""
        return sorted(name.split(" (")[0].split(" [")[0] for name in self._names())

    def _names(self) -> dict[str, str]:
        """Name of each view -> its id in the blueprint."""
        parts = {path: part["ViewBlueprint"] for path, part in self._blueprint.items() if "ViewBlueprint" in part}
        return {part.get("display_name", path): path.rsplit("/", 1)[-1] for path, part in parts.items()}

    def __exit__(self, *_: object) -> None:
        self._begun.close()

    def shoot(
        self,
        png: FilePath,
        *,
        view: str | None = None,
        at: float | str = 1.0,
        active: str | None = None,
        agree: int = AGREE,
        dressed: bool = False,
    ) -> PictureReport:
        """Take a picture of the window, or of one view alone; `active` is the start of the name of the tab in front,
        and `dressed` is as in `picture`."""
        started = time.monotonic()
        identity = self._show(view, active)
        self._go(at)
        image = self._settled(identity, agree)
        if identity is None and not self._chrome:
            image = without_bar(image, self._whole)
        elif identity is not None and not self._panels and self._zoom:
            image = resized(image, self._alone)
        if dressed:
            image = dress(image, self._words, fraction(at))
        if self._paper:
            image = paper.on_paper(image)
        try:
            Path(png).write_bytes(image)
        except OSError as error:
            raise RecordingError(f"cannot write the picture {png}: {files.reason(error)}") from None
        state = self._asked("for its state", self._client.get_state)
        reports = [(v.name, r) for v in state.views for r in v.reports]
        errors = tuple(f"{name}: {r.summary}" for name, r in reports if r.severity == "error")
        warnings = tuple(f"{name}: {r.summary}" for name, r in reports if r.severity != "error")
        width, height = (int.from_bytes(image[start : start + 4], "big") for start in (16, 20))
        return PictureReport(Path(png), (width, height), errors, warnings, time.monotonic() - started)

    def _find(self, name: str) -> str:
        names = self._names()
        title = named(name, names)
        if title is not None:
            return names[title]
        raise RecordingError(f"{self._path} has no view {name}; it has {', '.join(self.views)}")

    def _show(self, view: str | None, active: str | None) -> str | None:
        """Change the viewer's blueprint to what is wanted -> the id of the view that is alone."""
        alone = self._find(view) if view else None
        front = self._find(active) if active else None
        wanted = (alone, front)
        as_it_is = self._chrome and self._panels
        if wanted != (self._shown or (None, None)) or (self._shown is None and not as_it_is):
            changed = copy.deepcopy(self._blueprint)
            if not self._chrome:
                hide(changed, "top_panel", "PanelBlueprint")
            if not self._panels:
                hide(changed, "time_panel", "TimePanelBlueprint")
            if alone:
                changed["/viewport"]["ViewportBlueprint"]["maximized"] = alone
            for part in changed.values():
                container = part.get("ContainerBlueprint", {})
                if f"view/{front}" in container.get("contents", ()):
                    container["active_tab"] = f"view/{front}"
            self._asked("to change its blueprint", lambda: self._client.set_blueprint(changed, of="recording"))
            self._shown = wanted
        return alone

    def _go(self, at: float | str) -> None:
        """Put the time cursor at a fraction of the run."""
        timeline = self._timeline
        value = int(timeline.start + (timeline.end - timeline.start) * fraction(at))
        place = place_on(timeline.time_type, value)
        self._asked("for a moment", lambda: self._client.set_time(timeline.name, play_state="paused", **place))

    def _settled(self, view_id: str | None, agree: int) -> bytes:
        """A screenshot once it no longer changes: chunks are loaded lazily."""
        last, same, started = b"", 1, time.monotonic()
        while time.monotonic() - started < SETTLE:
            image = self._asked("for a picture", partial(self._client.take_screenshot, *([view_id] if view_id else [])))
            same = same + 1 if image == last else 1
            last = image
            if same >= agree:
                break
            time.sleep(0.1)
        return last


def named(word: str, names: Iterable[str]) -> str | None:
    """The name that is a word but for what stands in brackets, else the first that begins with it; None for none."""
    begin = [name for name in names if name.lower().startswith(word.lower())]
    same = (name for name in begin if name.split(" (")[0].split(" [")[0].lower() == word.lower())
    return next(same, begin[0] if begin else None)


def fraction(at: float | str) -> float:
    """A moment as a share of the run, 0 to 1. Raises RecordingError for what is none."""
    try:
        value = {"start": 0.0, "end": 1.0}[at] if isinstance(at, str) else float(at)
    except (KeyError, ValueError):
        raise RecordingError(f"a picture is taken at a fraction of the run, 'start' or 'end', not at {at!r}") from None
    return min(max(value, 0.0), 1.0)


def hide(blueprint: dict[str, Any], panel: str, archetype: str) -> None:
    """Leave a panel of the viewer out."""
    blueprint.setdefault(f"/{panel}", {}).setdefault(archetype, {})["state"] = "Hidden"


def tenths_above_one(scale: float, size: tuple[int, int]) -> int:
    """How many times the viewer is asked for larger letters. RecordingError for scales that it cannot show."""
    tenths = round(10 * scale) if 1 <= scale <= LARGEST_SCALE else 0
    if not tenths or abs(tenths - 10 * scale) > 1e-6:
        raise RecordingError(f"a scale is 1 to {LARGEST_SCALE:g} pixels to a point, in tenths, not {scale:g}")
    if max(size) * scale > MOST_PIXELS:
        raise RecordingError(
            f"{size[0]}x{size[1]} at {scale:g} pixels to a point is more than {MOST_PIXELS:,} pixels wide or high"
        )
    return tenths - 10


def is_paper(style: str) -> bool:
    """Whether pictures are on white. RecordingError for a style that there is not."""
    if style not in STYLES:
        raise RecordingError(f"a picture's style is {' or '.join(STYLES)}, not {style!r}")
    return style == "paper"


def start_viewer(paths: list[Path], size: tuple[int, int], folder: Path) -> tuple[Child, int]:
    """Start Rerun's own binary headless -> process, port."""
    port = free_port()
    environment = dict(os.environ, RUST_LOG="error", RERUN_ANALYTICS="0")
    environment["TMPDIR"] = str(folder)  # what the viewer spills is swept away with the rest
    environment.setdefault("XDG_RUNTIME_DIR", str(folder))
    command = [viewer_binary(), "--headless", "--bind", "127.0.0.1", "--port", str(port)]
    command += [
        "--window-size",
        f"{size[0]}x{size[1]}",
        "--hide-welcome-screen",
        "--memory-limit",
        "4GiB",
        *map(str, paths),
    ]
    return Child(command, environment), port


def without_bar(image: bytes, size: tuple[int, int]) -> bytes:
    """The lower part of a picture of the window, of that size: without the empty bar at its top."""
    from PIL import Image

    window = Image.open(io.BytesIO(image))
    top = window.height - size[1]
    out = io.BytesIO()
    window.crop((0, top, size[0], window.height)).save(out, "PNG")
    return out.getvalue()


def resized(image: bytes, size: tuple[int, int]) -> bytes:
    """A picture of a view that is a pixel too small or too large where a scale is no whole number."""
    from PIL import Image

    picture = Image.open(io.BytesIO(image))
    if picture.size == size:
        return image
    out = io.BytesIO()
    picture.resize(size, Image.Resampling.LANCZOS).save(out, "PNG")
    return out.getvalue()


def has_vulkan() -> bool:
    """Whether a Vulkan loader and at least one driver are installed."""
    from ctypes.util import find_library

    loader = find_library("vulkan") or any(
        Path(p).exists() for p in ("/usr/lib/libvulkan.so.1", "/usr/lib64/libvulkan.so.1")
    )
    homes = ("/usr/share/vulkan/icd.d", "/etc/vulkan/icd.d", "/usr/local/share/vulkan/icd.d")
    drivers = any(next(Path(home).glob("*.json"), None) for home in homes if Path(home).is_dir())
    named = os.environ.get("VK_ICD_FILENAMES") or os.environ.get("VK_DRIVER_FILES")
    return bool(loader) and bool(drivers or named)


def check_vulkan() -> None:
    """Raise RecordingError where headless pictures cannot work on Linux for want of Vulkan."""
    with contextlib.suppress(AttributeError):
        if os.uname().sysname == "Linux" and not has_vulkan():
            raise RecordingError(f"pictures without a screen need software Vulkan: apt-get install {PACKAGES}")
