"""Where a recording goes: a file, a viewer, a browser, standard output, memory.

Files and viewers can be had at once. Standard output and memory stand alone.
"""

from __future__ import annotations

import os
import sys
import webbrowser
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from urllib.parse import quote

import rerun as rr

from sailviz.errors import RecordingError
from sailviz.recording.addresses import check_answer
from sailviz.recording.web_page import serve_page

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
Sink = str | os.PathLike[str] | Viewer | Web | Connect | Memory  # as a user gives it


@dataclass(frozen=True)
class File:
    """A file under its final name and under the name it has while it grows."""

    path: Path
    part: Path

    @staticmethod
    def reserve(path: str | os.PathLike[str]) -> File:
        """Claim a path: the growing file is made at once, so that what cannot be written fails at once."""
        final = Path(path)
        if final.is_dir():
            raise RecordingError(f"cannot write the recording {final}: it is a directory")
        if not final.parent.is_dir():
            raise RecordingError(f"cannot write the recording {final}: there is no directory {final.parent}")
        part = final.with_name(f".{final.name}.{os.getpid()}.part")
        try:
            part.touch()
        except OSError as error:
            raise RecordingError(f"cannot write the recording {final}: {reason(error)}") from None
        return File(final, part)

    def publish(self) -> None:
        """Give the file its name."""
        try:
            os.replace(self.part, self.path)
        except OSError as error:
            raise RecordingError(f"cannot write the recording {self.path}: {reason(error)}") from None

    def discard(self) -> None:
        """Leave nothing of it."""
        self.part.unlink(missing_ok=True)


Opened = File | Viewer | Web | Connect | Memory | str


def reason(error: OSError) -> str:
    """Why the system refused, in its words."""
    return (error.strerror or str(error)).lower()


def resolve(sinks: Sequence[Sink]) -> list[Opened]:
    """Sinks as a user gives them -> File, Viewer, Web, Connect, Memory or STDOUT. RecordingError for anything else."""
    wanted = [wish(sink) for sink in sinks]
    check_together(sinks, wanted)
    for sink in wanted:
        if isinstance(sink, Connect):
            check_answer(sink.url)
    resolved: list[Opened] = []
    try:
        for sink in wanted:
            resolved.append(File.reserve(sink) if isinstance(sink, Path) else sink)
    except RecordingError:
        discard(resolved)
        raise
    return resolved


Wanted = Path | Viewer | Web | Connect | Memory | str


def wish(given: Sink) -> Wanted:
    """What a user means: a Path for a file, STDOUT, or the sink itself. RecordingError for what is no sink."""
    if isinstance(given, Viewer | Web | Connect | Memory):
        return given
    if isinstance(given, str | os.PathLike):
        return STDOUT if given == STDOUT else Path(given)
    raise RecordingError(f"a recording cannot go to {given!r}: give a path, VIEWER, WEB, Connect(url), Memory() or '-'")


def check_together(sinks: Sequence[Sink], wanted: Sequence[Wanted]) -> None:
    """Raise RecordingError for sinks that exclude each other, or none at all."""
    if not sinks:
        raise RecordingError("a recording needs somewhere to go: a path, VIEWER, WEB, Connect(url), Memory() or '-'")
    if len(sinks) > 1 and any(isinstance(sink, Memory) or sink == STDOUT for sink in wanted):
        raise RecordingError("standard output and memory each take a recording alone; other sinks can be combined")
    if sum(isinstance(sink, Viewer | Web) for sink in wanted) > 1:
        raise RecordingError("a recording goes to one viewer at a time: choose the native one or the browser")
    paths = [path.resolve() for path in wanted if isinstance(path, Path)]
    if len(set(paths)) < len(paths):
        raise RecordingError(f"the same file is given twice: {max(paths, key=paths.count)}")


def discard(sinks: Sequence[Opened]) -> None:
    """Leave nothing of a recording that never began."""
    for sink in sinks:
        if isinstance(sink, File):
            sink.discard()


Attached = rr.MemoryRecording | rr.GrpcServerSink | None


def attach(stream: rr.RecordingStream, sinks: Sequence[Opened]) -> Attached:
    """Point a stream at its sinks -> what is needed later: the memory recording, or the data server."""
    if list(sinks) == [STDOUT]:
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


def open_sinks(stream: rr.RecordingStream, sinks: Sequence[Opened]) -> rr.GrpcServerSink | None:
    """Files, viewers and a browser's server, all at once -> the server, None without one."""
    targets: list[rr.FileSink | rr.GrpcSink | rr.GrpcServerSink] = []
    server: rr.GrpcServerSink | None = None
    for sink in sinks:
        if isinstance(sink, File):
            targets.append(rr.FileSink(sink.part))
        elif isinstance(sink, Connect):
            targets.append(rr.GrpcSink(sink.url))
        elif isinstance(sink, Viewer):
            rr.spawn(port=sink.port, connect=False, hide_welcome_screen=True, executable_path=viewer_binary())
            targets.append(rr.GrpcSink(f"rerun+http://127.0.0.1:{sink.port}/proxy"))
        elif isinstance(sink, Web):
            server = rr.GrpcServerSink("127.0.0.1", sink.data_port)
            targets.append(server)
    stream.set_sinks(*targets)
    for sink in sinks:
        if isinstance(sink, Web) and server is not None:
            serve_page(viewer_binary(), sink.port)
            if sink.open_browser:
                webbrowser.open(web_address(sink, server))  # rerun's own address would open in the light theme
    return server


def viewer_binary() -> str:
    """Rerun's own viewer, which need not be on the PATH: it lies beside the package."""
    import rerun_cli

    return str(Path(rerun_cli.__file__).parent / ("rerun.exe" if os.name == "nt" else "rerun"))


def web_address(sink: Web, server: rr.GrpcServerSink) -> str:
    """What to type into a browser to see the recording."""
    return f"http://127.0.0.1:{sink.port}/?url={quote(server.uri, safe='')}&theme=dark"
