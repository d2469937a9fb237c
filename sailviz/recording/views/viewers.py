"""Recordings shown to people: in a browser, served from this machine without the internet, or in the native viewer."""

from __future__ import annotations

import os
import signal
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Self
from urllib.parse import quote

from sailviz.errors import RecordingError
from sailviz.recording.children import Child
from sailviz.recording.reader import FilePath, read
from sailviz.recording.sinks import viewer_binary
from sailviz.recording.web_page import check_free, free_port, viewer_environment, wait_for_page

BUFFER = 1 << 30  # bytes that the server holds at least; what does not fit is dropped, oldest first


class WebServer:
    """Recordings served to browsers: `with WebServer("orbit.rrd") as server: print(server.url)`.

    port : of the page; data_port : of the recordings; 0 takes free ones. host : the address to listen on.
    Raises RecordingError where a file is no recording, a port is taken, or the server does not come up.
    """

    def __init__(self, *paths: FilePath, port: int = 0, data_port: int = 0, host: str = "127.0.0.1"):
        for path in paths:
            read(path)  # says in one sentence what cannot be shown
        self._paths = [Path(path).resolve() for path in paths]
        self._host, self._port, self._data_port = host, port, data_port

    @property
    def url(self) -> str:
        """What to type into a browser."""
        source = f"rerun+http://{self._host}:{self._data_port}/proxy"
        return f"http://{self._host}:{self._port}/?url={quote(source, safe='')}&hide_welcome_screen&theme=dark"

    def __enter__(self) -> Self:
        self._port = self._port or free_port(self._host)
        self._data_port = self._data_port or free_port(self._host)
        for port in (self._port, self._data_port):
            check_free(self._host, port)
        size = sum(path.stat().st_size for path in self._paths)
        command = [viewer_binary(), "--serve-web", "--bind", self._host, "--port", str(self._data_port)]
        command += ["--web-viewer-port", str(self._port), "--server-memory-limit", f"{BUFFER + 4 * size}B"]
        self._process = Child([*command, *map(str, self._paths)], viewer_environment())
        try:
            wait_for_page(self._process, self._host, self._port)
        except BaseException:
            self.__exit__()
            raise
        return self

    def __exit__(self, *_: object) -> None:
        self._process.end()

    def wait(self) -> None:
        """Wait until the server ends by itself, which it should not: RecordingError."""
        code = self._process.wait()
        raise RecordingError(f"the server for the browser ended by itself with code {code}")


def serve(
    *paths: FilePath, port: int = 0, data_port: int = 0, started: Callable[[str], None] = lambda url: None
) -> None:
    """Serve recordings to browsers until Ctrl-C, or until the process is asked to end. started : called with the
    address once it answers.
    """
    with asked_to_end(), suppress(KeyboardInterrupt), WebServer(*paths, port=port, data_port=data_port) as server:
        started(server.url)
        server.wait()


def open_viewer(*paths: FilePath) -> None:
    """Show recordings in the native viewer and wait until its window is closed; each keeps the layout of its family.

    Raises RecordingError where a file is no recording, or there is no screen.
    """
    for path in paths:
        read(path)
    check_screen()
    process = Child(
        [viewer_binary(), *(str(Path(path).resolve()) for path in paths)], viewer_environment(), quiet=False
    )
    try:
        code = process.wait()
    finally:
        process.end()
    if code:
        raise RecordingError(f"the viewer ended with code {code}")


def check_screen() -> None:
    """Raise RecordingError where a window has nowhere to open."""
    if sys.platform.startswith("linux") and not (os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")):
        raise RecordingError(
            "there is no screen for the viewer: `sailviz web` shows recordings in a browser, `sailviz picture` as PNG"
        )


@contextmanager
def asked_to_end() -> Iterator[None]:
    """Let SIGTERM end the body as Ctrl-C does, so that no server is left behind."""

    def interrupt(*_: object) -> None:
        raise KeyboardInterrupt

    try:
        before = signal.signal(signal.SIGTERM, interrupt)
    except ValueError:  # not the main thread
        yield
        return
    try:
        yield
    finally:
        signal.signal(signal.SIGTERM, before)
