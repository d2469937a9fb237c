"""Where a recording goes: a file, a viewer, a browser, standard output, memory.

Files and viewers can be had at once. Standard output and memory stand alone.
"""

from __future__ import annotations

import os
import socket
import sys
import webbrowser
from dataclasses import dataclass, field
from pathlib import Path
from urllib.parse import quote, urlsplit

import rerun as rr

from sailviz.errors import RecordingError

STDOUT = "-"


@dataclass(frozen=True)
class Viewer:
    """The native viewer on this machine; started unless one listens on the port already."""

    port: int = 9876


@dataclass(frozen=True)
class Web:
    """A viewer in the browser, served from this machine without the internet."""

    port: int = 9090
    data_port: int = 9876
    open_browser: bool = True


@dataclass(frozen=True)
class Connect:
    """A viewer that runs already, perhaps elsewhere, e.g. `rerun+http://192.168.0.5:9876/proxy`."""

    url: str


@dataclass
class Memory:
    """`bytes` holds the recording, as a file would, once it is finished."""

    bytes: bytes = field(default=b"", repr=False)


VIEWER = Viewer()
WEB = Web()


@dataclass(frozen=True)
class File:
    """A file under its final name and under the name it has while it grows."""

    path: Path
    part: Path

    @staticmethod
    def reserve(path) -> File:
        """Claim a path: the growing file is made at once, so that what cannot be written fails at once."""
        path = Path(path)
        if path.is_dir():
            raise RecordingError(f"cannot write the recording {path}: it is a directory")
        if not path.parent.is_dir():
            raise RecordingError(f"cannot write the recording {path}: there is no directory {path.parent}")
        part = path.with_name(f".{path.name}.{os.getpid()}.part")
        try:
            part.touch()
        except OSError as error:
            raise RecordingError(f"cannot write the recording {path}: {error.strerror.lower()}") from None
        return File(path, part)

    def publish(self) -> None:
        try:
            os.replace(self.part, self.path)
        except OSError as error:
            raise RecordingError(f"cannot write the recording {self.path}: {error.strerror.lower()}") from None

    def discard(self) -> None:
        self.part.unlink(missing_ok=True)


def resolve(sinks) -> list:
    """Sinks as a user gives them -> File, Viewer, Web, Connect, Memory or STDOUT. RecordingError for anything else."""
    if not sinks:
        raise RecordingError("a recording needs somewhere to go: a path, VIEWER, WEB, Connect(url), Memory() or '-'")
    wanted = [sink if isinstance(sink, Viewer | Web | Connect | Memory) or sink == STDOUT else None for sink in sinks]
    if len(sinks) > 1 and any(isinstance(sink, Memory) or sink == STDOUT for sink in wanted):
        raise RecordingError("standard output and memory each take a recording alone; other sinks can be combined")
    if sum(isinstance(sink, Viewer | Web) for sink in wanted) > 1:
        raise RecordingError("a recording goes to one viewer at a time: choose the native one or the browser")
    for sink, given in zip(wanted, sinks, strict=True):
        if sink is None and not isinstance(given, str | os.PathLike):
            raise RecordingError(
                f"a recording cannot go to {given!r}: give a path, VIEWER, WEB, Connect(url), Memory() or '-'"
            )
    paths = [Path(given).resolve() for sink, given in zip(wanted, sinks, strict=True) if sink is None]
    if len(set(paths)) < len(paths):
        raise RecordingError(f"the same file is given twice: {max(paths, key=paths.count)}")
    for sink in wanted:
        if isinstance(sink, Connect):
            check_answer(sink.url)
    resolved = []
    try:
        for sink, given in zip(wanted, sinks, strict=True):
            resolved.append(File.reserve(given) if sink is None else sink)
    except RecordingError:
        discard(resolved)
        raise
    return resolved


def check_answer(url: str) -> None:
    """Raise RecordingError unless something listens at a viewer's address: the stream itself would wait for ever."""
    parts = urlsplit(url)
    if not parts.scheme.startswith("rerun") or not parts.hostname:
        raise RecordingError(f"{url} is no address of a viewer, which looks like rerun+http://127.0.0.1:9876/proxy")
    try:
        socket.create_connection((parts.hostname, parts.port or 9876), timeout=3).close()
    except OSError as error:
        raise RecordingError(f"no viewer answers at {url}: {error.strerror or error}") from None


def discard(sinks) -> None:
    """Leave nothing of a recording that never began."""
    for sink in sinks:
        if isinstance(sink, File):
            sink.discard()


def attach(stream: rr.RecordingStream, sinks: list):
    """Point a stream at its sinks -> what is needed later: the memory recording, or the data server."""
    if sinks == [STDOUT]:
        if sys.stdout.isatty():
            raise RecordingError(
                "a recording on standard output must be piped, e.g. `| rerun -`, not shown on a terminal"
            )
        stream.stdout()
        return None
    if isinstance(sinks[0], Memory):
        return stream.memory_recording()
    try:
        return open_sinks(stream, sinks)
    except (ValueError, RuntimeError) as error:
        raise RecordingError(f"cannot open the recording's sink: {str(error).splitlines()[0]}") from None


def open_sinks(stream: rr.RecordingStream, sinks: list):
    """Files, viewers and a browser's server, all at once -> the server, None without one."""
    targets, server = [], None
    for sink in sinks:
        if isinstance(sink, File):
            targets.append(rr.FileSink(sink.part))
        elif isinstance(sink, Connect):
            targets.append(rr.GrpcSink(sink.url))
        elif isinstance(sink, Viewer):
            rr.spawn(port=sink.port, connect=False, hide_welcome_screen=True, executable_path=viewer_binary())
            targets.append(rr.GrpcSink(f"rerun+http://127.0.0.1:{sink.port}/proxy"))
        else:
            server = rr.GrpcServerSink("127.0.0.1", sink.data_port)
            targets.append(server)
    stream.set_sinks(*targets)
    for sink in sinks:
        if isinstance(sink, Web):
            rr.serve_web_viewer(web_port=sink.port, open_browser=False, connect_to=server.uri)
            if sink.open_browser:
                webbrowser.open(web_address(sink, server))  # rerun's own address would open in the light theme
    return server


def viewer_binary() -> str:
    """Rerun's own viewer, which need not be on the PATH: it lies beside the package."""
    import rerun_cli

    return str(Path(rerun_cli.__file__).parent / ("rerun.exe" if os.name == "nt" else "rerun"))


def web_address(sink: Web, server) -> str:
    """What to type into a browser to see the recording."""
    return f"http://127.0.0.1:{sink.port}/?url={quote(server.uri, safe='')}&theme=dark"
