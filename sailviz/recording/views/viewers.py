"""Recordings shown to people: in a browser, served from this machine without the internet, or in the native viewer."""

from __future__ import annotations

import os
import signal
import socket
import sys
import time
import urllib.error
import urllib.request
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Self
from urllib.parse import quote

from sailviz.errors import RecordingError
from sailviz.recording.reader import FilePath, read
from sailviz.recording.sinks import viewer_binary
from sailviz.recording.views.children import Child

START = 30.0  # s to wait for the server
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
            self._wait_for_page()
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

    def _wait_for_page(self) -> None:
        started = time.monotonic()
        opener = urllib.request.build_opener(urllib.request.ProxyHandler({}))  # never through a proxy
        while time.monotonic() - started < START:
            if self._process.poll() is not None:
                raise RecordingError(f"the server for the browser ended at once with code {self._process.returncode}")
            with suppress(urllib.error.URLError, OSError):
                opener.open(f"http://{self._host}:{self._port}/", timeout=1).close()
                return
            time.sleep(0.05)
        raise RecordingError(f"the server for the browser did not answer within {START:.0f} s")


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
    if sys.platform.startswith("linux") and not (os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")):
        raise RecordingError(
            "there is no screen for the viewer: `sailviz web` shows recordings in a browser, `sailviz picture` as PNG"
        )
    process = Child(
        [viewer_binary(), *(str(Path(path).resolve()) for path in paths)], viewer_environment(), quiet=False
    )
    try:
        code = process.wait()
    finally:
        process.end()
    if code:
        raise RecordingError(f"the viewer ended with code {code}")


def viewer_environment() -> dict[str, str]:
    """What Rerun's viewer is started with: it tells nobody anything, and says only what fails."""
    return dict(os.environ, RERUN_ANALYTICS="0", RUST_LOG=os.environ.get("RUST_LOG", "error"))


def free_port(host: str = "127.0.0.1") -> int:
    """A port on which nobody listens."""
    with socket.socket() as probe:
        probe.bind((host, 0))
        return int(probe.getsockname()[1])


def check_free(host: str, port: int) -> None:
    """Raise RecordingError where somebody listens on a port."""
    with socket.socket() as probe:
        probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            probe.bind((host, port))
        except OSError as error:
            raise RecordingError(f"cannot listen on {host}:{port}: {(error.strerror or str(error)).lower()}") from None


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
