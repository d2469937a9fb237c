"""Where Rerun's bytes go on their way to a file: through a pipe, the other end of which is ours.

Rerun writes in a thread of its own. On a full disk or a dead pipe that thread ends, says nothing to its caller, and may
leave a flush or the end of the stream waiting for ever. Behind a pipe it never fails; what fails is told to us.
"""

from __future__ import annotations

import os
import select
import threading
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path

from sailviz.recording.checksums import RunningSums

PIECE = 1 << 18  # bytes carried on at once
WIDE = 1 << 20  # bytes that the pipe holds, where the system lets us say
STEP = 2e-4  # s between two looks whether the pipe is empty


class Drain:
    """A pipe that is emptied into `write` by a thread. `path` is what Rerun writes to; `error` what went wrong."""

    def __init__(
        self,
        write: Callable[[bytes], object],
        word: str,
        done: Callable[[], object] = lambda: None,
        part: Path | None = None,
    ):
        """write : takes the next bytes, all of them, or raises OSError. word : where they go, for messages. done :
        called after the last. part : the file they go to, if it is one. OSError where there are no such pipes."""
        self._write, self.word, self._done, self.part = write, word, done, part
        self._source, self._held = os.pipe()  # our own hand on the near end keeps it open until Rerun has it
        self.path = Path(f"/dev/fd/{self._held}")
        try:
            if not self.path.exists():
                raise OSError("this system has no names for pipes")
        except OSError:
            os.close(self._source)
            os.close(self._held)
            raise
        _widen(self._held)
        self.error: OSError | None = None
        self.running = RunningSums()  # of all that was carried on
        self.offered = 0  # bytes that came from Rerun
        self._busy = False
        self._thread = threading.Thread(target=self._carry, name="recording", daemon=True)
        self._thread.start()

    def settle(self) -> None:
        """Wait until what Rerun has written has been carried on. OSError, the first there was, where it could not."""
        while self._thread.is_alive() and (_waiting(self._source) or self._busy):
            time.sleep(STEP)
        if self.error is not None:
            raise self.error

    def close(self) -> None:
        """Let go once Rerun has: wait for its last bytes. OSError as `settle`."""
        if self._held >= 0:
            os.close(self._held)
            self._held = -1
        self._thread.join()
        if self.error is not None:
            raise self.error

    def release(self) -> None:
        """Let go without waiting: Rerun may write on, and what it writes is still carried on."""
        if self._held >= 0:
            os.close(self._held)
            self._held = -1

    def _carry(self) -> None:
        try:
            while True:
                select.select([self._source], [], [])
                self._busy = True  # before the pipe is empty, so that `settle` sees one or the other
                piece = os.read(self._source, PIECE)
                if not piece:
                    return
                self._take(piece)
                self._busy = False
        finally:
            os.close(self._source)
            self._done()
            self._busy = False

    def _take(self, piece: bytes) -> None:
        self.offered += len(piece)
        if self.error is not None:
            return  # Rerun must not wait for a reader that has given up
        try:
            self._write(piece)
        except OSError as error:
            self.error = error
            return
        self.running.add(piece)


def drain_into(handle: int, word: str, part: Path | None = None) -> Drain:
    """A drain into an open file, which it closes in the end."""
    return Drain(_writer(handle), word, partial(os.close, handle), part)


def _writer(handle: int) -> Callable[[bytes], None]:
    """A function that writes all of its bytes."""

    def write(piece: bytes) -> None:
        rest = memoryview(piece)
        while rest:
            rest = rest[os.write(handle, rest) :]

    return write


def _waiting(handle: int) -> bool:
    try:
        return bool(select.select([handle], [], [], 0)[0])
    except (OSError, ValueError):  # closed
        return False


def _widen(handle: int) -> None:
    try:
        import fcntl

        fcntl.fcntl(handle, fcntl.F_SETPIPE_SZ, WIDE)
    except (ImportError, AttributeError, OSError):
        return
