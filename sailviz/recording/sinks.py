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
from sailviz.files import Output
from sailviz.recording.addresses import check_answer
from sailviz.recording.drain import Drain, drain_into
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


Opened = Output | Viewer | Web | Connect | Memory | str


def resolve(sinks: Sequence[Sink]) -> list[Opened]:
    """Sinks as a user gives them -> Output, Viewer, Web, Connect, Memory or STDOUT. RecordingError for others."""
    wanted = [wish(sink) for sink in sinks]
    check_together(sinks, wanted)
    for sink in wanted:
        if isinstance(sink, Connect):
            check_answer(sink.url)
    resolved: list[Opened] = []
    try:
        for sink in wanted:
            resolved.append(Output.reserve(sink, "recording") if isinstance(sink, Path) else sink)
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
        if isinstance(sink, Output):
            sink.discard()


@dataclass
class Attached:
    """What a stream was attached to: the pipes that carry its bytes on, and the browser's server. `memory` and
    `direct` : where there are no such pipes, what Rerun keeps or writes by itself."""

    drains: list[Drain] = field(default_factory=list)
    server: rr.GrpcServerSink | None = None
    memory: rr.MemoryRecording | None = None
    direct: list[Output] = field(default_factory=list)


def attach(stream: rr.RecordingStream, sinks: Sequence[Opened]) -> Attached:
    """Point a stream at its sinks. RecordingError where one cannot be opened."""
    if list(sinks) == [STDOUT] and sys.stdout.isatty():
        raise RecordingError("a recording on standard output must be piped, e.g. `| rerun -`, not shown on a terminal")
    attached = Attached()
    try:
        open_sinks(stream, sinks, attached)
    except (ValueError, RuntimeError, OSError) as error:
        for drain in attached.drains:
            drain.release()
        raise RecordingError(f"cannot open the recording's sink: {str(error).splitlines()[0]}") from None
    return attached


def drain_of(sink: Opened) -> Drain | None:
    """The pipe towards a file, standard output or memory; None for a viewer, and where there are no such pipes."""
    try:
        if isinstance(sink, Output):
            return drain_into(os.open(sink.part, os.O_WRONLY), str(sink.path), sink.part)
        if isinstance(sink, Memory):
            content = bytearray()
            return Drain(content.extend, "memory", lambda: setattr(sink, "bytes", bytes(content)))
        if sink == STDOUT:
            sys.stdout.flush()
            return drain_into(os.dup(sys.stdout.fileno()), "to standard output")
    except OSError:
        return None
    return None


def open_sinks(stream: rr.RecordingStream, sinks: Sequence[Opened], attached: Attached) -> None:
    """Files, viewers and a browser's server, all at once."""
    targets: list[rr.FileSink | rr.GrpcSink | rr.GrpcServerSink] = []
    for sink in sinks:
        drain = drain_of(sink)
        if drain is not None:
            attached.drains.append(drain)
            targets.append(rr.FileSink(drain.path))
        elif isinstance(sink, Output):
            attached.direct.append(sink)
            targets.append(rr.FileSink(sink.part))
        elif isinstance(sink, Memory):
            attached.memory = stream.memory_recording()
            return
        elif sink == STDOUT:
            stream.stdout()
            return
        elif isinstance(sink, Connect):
            targets.append(rr.GrpcSink(sink.url))
        elif isinstance(sink, Viewer):
            rr.spawn(port=sink.port, connect=False, hide_welcome_screen=True, executable_path=viewer_binary())
            targets.append(rr.GrpcSink(f"rerun+http://127.0.0.1:{sink.port}/proxy"))
        elif isinstance(sink, Web):
            attached.server = rr.GrpcServerSink("127.0.0.1", sink.data_port)
            targets.append(attached.server)
    stream.set_sinks(*targets)
    for sink in sinks:
        if isinstance(sink, Web) and attached.server is not None:
            serve_page(viewer_binary(), sink.port)
            if sink.open_browser:
                # rerun's own address would open in the light theme
                webbrowser.open(web_address(sink, attached.server))


def viewer_binary() -> str:
    """Rerun's own viewer, which need not be on the PATH: it lies beside the package."""
    import rerun_cli

    return str(Path(rerun_cli.__file__).parent / ("rerun.exe" if os.name == "nt" else "rerun"))


def web_address(sink: Web, server: rr.GrpcServerSink) -> str:
    """What to type into a browser to see the recording."""
    return f"http://127.0.0.1:{sink.port}/?url={quote(server.uri, safe='')}&theme=dark"
