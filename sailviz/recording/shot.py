"""Pictures of a recording, without a screen: Rerun's viewer runs headless on software Vulkan and is asked for screenshots."""

from __future__ import annotations

import contextlib
import os
import socket
import subprocess
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from sailviz.errors import RecordingError
from sailviz.recording.blueprint import all_views, blueprint, find, short_names
from sailviz.recording.layout import Layout
from sailviz.recording.reader import read

PACKAGES = "libvulkan1 mesa-vulkan-drivers"
START, SETTLE = 60.0, 25.0  # s to wait for the viewer, and for a picture that no longer changes
AGREE = 3  # frames in a row that must be the same


@dataclass(frozen=True)
class PictureReport:
    """A picture that was taken. `errors` and `warnings` are what the views complained about."""

    path: Path
    size: tuple[int, int]
    errors: tuple[str, ...]
    warnings: tuple[str, ...]
    seconds: float


def picture(path, png, *, view: str | None = None, at=1.0, size=(1600, 900), panels: bool = True) -> PictureReport:
    """Take one picture of a recording.

    view : the start of a view's name (System, From the pole, Follow, ...) to have it alone, None for the whole window
    at : fraction of the run, or "start", "end"; panels : False leaves out the menu and the time panel
    Raises RecordingError where there is no such view, no Vulkan, or no viewer.
    """
    with Studio(path, size=size, panels=panels) as studio:
        return studio.shoot(png, view=view, at=at)


class Studio:
    """One headless viewer for many pictures of one recording."""

    def __init__(self, path, *, size=(1600, 900), panels: bool = True):
        self._path, self._size, self._panels = Path(path).resolve(), tuple(size), panels
        recording = read(self._path)
        text = recording["/scene"]["layout"][0] if recording.contract else ""
        self._layout = Layout.from_json(text) if text else None
        self._application = recording.application_id
        self._timeline = None

    @property
    def views(self) -> list[str]:
        """Names of the views that can be shot; none for a recording by another application."""
        return short_names(all_views(self._layout)) if self._layout else []

    def __enter__(self) -> Studio:
        check_vulkan()
        from rerun.experimental import ViewerClient

        self._scratch = tempfile.TemporaryDirectory(prefix="sailviz-")
        self._process, port = start_viewer(self._path, self._size, self._scratch.name)
        started = time.monotonic()
        self._client = None
        while True:
            if self._process.poll() is not None:
                self._stop()
                raise RecordingError(f"the viewer ended at once; headless pictures need Vulkan: apt-get install {PACKAGES}")
            try:
                self._client = self._client or ViewerClient.connect(f"rerun+http://127.0.0.1:{port}/proxy")
                state = self._client.get_state()
                if state.active_recording and not state.loading and any(r.timelines for r in state.recordings):
                    break
            except Exception:
                pass  # not up yet
            if time.monotonic() - started > START:
                self._stop()
                raise RecordingError(f"the viewer did not show {self._path} within {START:.0f} s")
            time.sleep(0.05)
        recording = next(r for r in state.recordings if r.store_id == state.active_recording)
        self._timelines = {timeline.name: timeline for timeline in recording.timelines}
        self._timeline = self._timelines[self._layout.timeline if self._layout else recording.current_timeline]
        self._shown = (None, None)
        return self

    def __exit__(self, *_) -> None:
        self._stop()

    def shoot(self, png, *, view: str | None = None, at=1.0, active: str | None = None) -> PictureReport:
        """Take a picture of the window, or of one view alone; `active` is the tab in front."""
        started = time.monotonic()
        self._show(view, active)
        self._go(at)
        name = None
        if view is not None:
            name = next((v.view_id for v in self._client.get_state().views if v.name.lower().startswith(view.lower())), None)
            if name is None:
                raise RecordingError(f"{self._path} has no view {view}")
        image = self._settled(name)
        try:
            Path(png).write_bytes(image)
        except OSError as error:
            raise RecordingError(f"cannot write the picture {png}: {error.strerror.lower()}") from None
        reports = [(v.name, r) for v in self._client.get_state().views for r in v.reports]
        sorted_out = {
            severity: tuple(f"{name}: {r.summary}" for name, r in reports if (r.severity == "error") == (severity == "error"))
            for severity in ("error", "warning")
        }
        width, height = (int.from_bytes(image[start : start + 4], "big") for start in (16, 20))
        seconds = time.monotonic() - started
        return PictureReport(Path(png), (width, height), sorted_out["error"], sorted_out["warning"], seconds)

    def _show(self, view: str | None, active: str | None) -> None:
        """Lay the window out afresh where another view, tab or no panels are wanted."""
        wanted = (view, active)
        if wanted == self._shown and self._panels:
            return
        if self._layout is None:
            if view is not None:
                return  # a stranger's layout is taken as it is
            return
        try:
            for name in (view, active):
                if name is not None:
                    find(all_views(self._layout), name)
        except KeyError as error:
            raise RecordingError(f"{self._path}: {error.args[0]}") from None
        made = Path(self._scratch.name) / f"layout{time.monotonic_ns()}.rbl"
        blueprint(self._layout, active=active, only=view, panels=self._panels).save(self._application, str(made))
        before = {v.view_id for v in self._client.get_state().views}
        self._client.open(str(made))
        started = time.monotonic()
        while time.monotonic() - started < SETTLE:
            if not before & {v.view_id for v in self._client.get_state().views}:
                break
            time.sleep(0.05)
        self._shown = wanted

    def _go(self, at) -> None:
        """Put the time cursor at a fraction of the run."""
        try:
            fraction = {"start": 0.0, "end": 1.0}[at] if isinstance(at, str) else float(at)
        except (KeyError, ValueError):
            raise RecordingError(f"a picture is taken at a fraction of the run, 'start' or 'end', not at {at!r}") from None
        timeline = self._timeline
        value = int(timeline.start + (timeline.end - timeline.start) * min(max(fraction, 0.0), 1.0))
        place = {
            "sequence": lambda: {"sequence": value},
            "duration": lambda: {"duration": np.timedelta64(value, "ns")},
            "timestamp": lambda: {"timestamp": np.datetime64(value, "ns")},
        }[timeline.time_type]()
        self._client.set_time(timeline.name, play_state="paused", **place)

    def _settled(self, view_id) -> bytes:
        """A screenshot once it no longer changes: chunks are loaded lazily."""
        last, same, started = b"", 1, time.monotonic()
        while same < AGREE and time.monotonic() - started < SETTLE:
            image = self._client.take_screenshot(view_id) if view_id else self._client.take_screenshot()
            same = same + 1 if image == last else 1
            last = image
            time.sleep(0.1)
        return last

    def _stop(self) -> None:
        self._process.terminate()
        try:
            self._process.wait(5)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()
        self._scratch.cleanup()


def start_viewer(path: Path, size, scratch: str):
    """Start Rerun's own binary headless -> process, port."""
    import rerun_cli

    binary = Path(rerun_cli.__file__).parent / "rerun"
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port = probe.getsockname()[1]
    environment = dict(os.environ, RUST_LOG="error", RERUN_ANALYTICS="0")
    environment.setdefault("XDG_RUNTIME_DIR", scratch)
    command = [str(binary), "--headless", "--bind", "127.0.0.1", "--port", str(port)]
    command += ["--window-size", f"{size[0]}x{size[1]}", "--hide-welcome-screen", "--memory-limit", "4GiB", str(path)]
    process = subprocess.Popen(command, env=environment, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    return process, port


def has_vulkan() -> bool:
    """Whether a Vulkan loader and at least one driver are installed."""
    from ctypes.util import find_library

    loader = find_library("vulkan") or any(Path(p).exists() for p in ("/usr/lib/libvulkan.so.1", "/usr/lib64/libvulkan.so.1"))
    homes = ("/usr/share/vulkan/icd.d", "/etc/vulkan/icd.d", "/usr/local/share/vulkan/icd.d")
    drivers = any(next(Path(home).glob("*.json"), None) for home in homes if Path(home).is_dir())
    named = os.environ.get("VK_ICD_FILENAMES") or os.environ.get("VK_DRIVER_FILES")
    return bool(loader) and bool(drivers or named)


def check_vulkan() -> None:
    """Raise RecordingError where headless pictures cannot work on Linux for want of Vulkan."""
    with contextlib.suppress(AttributeError):
        if os.uname().sysname == "Linux" and not has_vulkan():
            raise RecordingError(f"pictures without a screen need software Vulkan: apt-get install {PACKAGES}")
