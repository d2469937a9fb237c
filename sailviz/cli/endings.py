"""How a command ends other than by itself: asked to by the system, on a console that cannot print, or by a fault of
ours."""

from __future__ import annotations

import io
import signal
import sys
import threading
import traceback
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType

from sailviz.cli.shared import RUN_FAILED, UNFORESEEN, tell

SIGNALS = ("SIGTERM", "SIGHUP")  # what ends a service and what a closed terminal sends; Windows knows the first only


@contextmanager
def asked_to_end() -> Iterator[None]:
    """Let SIGTERM and SIGHUP end the body as Ctrl-C does, once: what follows finishes its files undisturbed. Signals
    that are ignored (`nohup`) stay so."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    known = [getattr(signal, name) for name in SIGNALS if hasattr(signal, name)]
    before = {number: signal.getsignal(number) for number in known}
    heard = [number for number in known if before[number] is signal.SIG_DFL]

    def interrupt(number: int, frame: FrameType | None) -> None:
        for other in heard:
            signal.signal(other, _unheard)  # SIG_IGN would make Python complain of one that is on its way
        on_interrupt = signal.getsignal(signal.SIGINT)
        if callable(on_interrupt):  # whoever holds back Ctrl-C just now, because a block is written, holds back this
            on_interrupt(number, frame)
        else:
            raise KeyboardInterrupt

    for number in heard:
        signal.signal(number, interrupt)
    try:
        yield
    finally:
        for number in heard:
            signal.signal(number, before[number])


def _unheard(_number: int, _frame: FrameType | None) -> None:
    """A second signal while the first one is obeyed."""


def printable() -> None:
    """Replace what the console cannot print, instead of failing over it."""
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper) and stream.errors == "strict":
            stream.reconfigure(errors="replace")


def unforeseen(error: Exception) -> int:
    """Say that sailviz is at fault, and where to report it -> exit code."""
    from sailviz.version import __version__  # it reads the package's metadata, which takes a while

    if isinstance(error, MemoryError):
        tell("There is not enough memory for this.")
        return RUN_FAILED
    traceback.print_exception(error)
    tell(
        f"This is a fault of sailviz {__version__}, not of yours. Please report it as an issue of its repository, "
        "with the lines above and the command."
    )
    return UNFORESEEN
