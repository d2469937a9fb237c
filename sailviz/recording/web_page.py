"""The page of the viewer for browsers, served from this machine to itself alone."""

from __future__ import annotations

import atexit
import os
import socket
import time
import urllib.error
import urllib.request
from contextlib import suppress

from sailviz.errors import RecordingError
from sailviz.recording.children import Child

HOST = "127.0.0.1"
START = 30.0  # s to wait for the server


def serve_page(binary: str, port: int) -> None:
    """Serve the page alone, as long as this process lives: Rerun's own function does it for every network there is.

    binary : Rerun's viewer. RecordingError where the port is taken or nothing answers.
    """
    check_free(HOST, port)
    command = [binary, "--serve-web", "--bind", HOST, "--port", str(free_port()), "--web-viewer-port", str(port)]
    process = Child(command, viewer_environment())
    atexit.register(process.end)
    wait_for_page(process, HOST, port)


def wait_for_page(process: Child, host: str, port: int) -> None:
    """Wait until a server answers. RecordingError where it ends or does not answer in time."""
    started = time.monotonic()
    opener = urllib.request.build_opener(urllib.request.ProxyHandler({}))  # never through a proxy
    while time.monotonic() - started < START:
        if process.poll() is not None:
            raise RecordingError(f"the server for the browser ended at once with code {process.returncode}")
        with suppress(urllib.error.URLError, OSError):
            opener.open(f"http://{host}:{port}/", timeout=1).close()
            return
        time.sleep(0.05)
    raise RecordingError(f"the server for the browser did not answer within {START:.0f} s")


def viewer_environment() -> dict[str, str]:
    """What Rerun's viewer is started with: it tells nobody anything, and says only what fails."""
    return dict(os.environ, RERUN_ANALYTICS="0", RUST_LOG=os.environ.get("RUST_LOG", "error"))


def free_port(host: str = HOST) -> int:
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
