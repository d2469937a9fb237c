"""A person who waits because something is compiled is told so."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager

LONG = 2.0  # s that nobody need be told of
_listening: list[Callable[[], None]] = []


def when_long(tell: Callable[[], None]) -> None:
    """Call `tell` once, from a thread of its own, as soon as anything in this process, or in a worker process that is
    started hereafter, has been compiled for LONG. tell : a function of a module, which worker processes find."""
    _listening[:] = [tell]


def listener() -> Callable[[], None] | None:
    """Whom `when_long` would call, if anybody: for worker processes, to which it has to be passed on."""
    return _listening[0] if _listening else None


@contextmanager
def compiling() -> Iterator[None]:
    """While the body compiles something."""
    if not _listening:
        yield
        return
    from threading import Timer

    timer = Timer(LONG, _tell)
    timer.daemon = True
    timer.start()
    try:
        yield
    finally:
        timer.cancel()


def _tell() -> None:
    while _listening:
        _listening.pop()()
