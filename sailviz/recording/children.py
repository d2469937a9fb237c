"""Programs that we start, and that end with us however we end: a watchman beside each ends it when we are gone, also
after kill -9.
"""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path

PATIENCE = 5.0  # s, from the polite request to end to the other one
# The watchman reads a pipe whose other end only we hold. A letter in it lets the program live or says that it is over;
# an end without a letter means that we died. It looks at the program's birth, so that it never ends a later one that
# was given the same number.
WATCHMAN = """
import os, signal, sys
for name in ("SIGINT", "SIGTERM", "SIGHUP"):
    hasattr(signal, name) and signal.signal(getattr(signal, name), signal.SIG_IGN)
number, born = int(sys.argv[1]), sys.argv[2]
if not sys.stdin.buffer.read(1):
    try:
        now = open(f"/proc/{number}/stat").read().rsplit(")", 1)[1].split()[19]
    except OSError:
        now = born if not os.path.isdir("/proc/self") else ""
    if now == born:
        os.kill(number, getattr(signal, "SIGKILL", signal.SIGTERM))
"""


class Child:
    """A program of ours. `wait`, `poll` and `returncode` are those of subprocess.Popen."""

    def __init__(self, command: Sequence[str], environment: Mapping[str, str] | None = None, quiet: bool = True):
        said = subprocess.DEVNULL if quiet else None
        self._process = subprocess.Popen(command, env=environment, stdin=subprocess.DEVNULL, stdout=said, stderr=said)
        try:
            self._watchman = subprocess.Popen(
                [sys.executable, "-I", "-S", "-c", WATCHMAN, str(self._process.pid), _born(self._process.pid)],
                stdin=subprocess.PIPE,
                stdout=subprocess.DEVNULL,
                stderr=subprocess.DEVNULL,
                start_new_session=True,  # what is sent to our group is not meant for it
            )
        except BaseException:
            self._end_program()
            raise

    @property
    def pid(self) -> int:
        """The number of the process."""
        return self._process.pid

    @property
    def returncode(self) -> int | None:
        """How it ended, None while it runs."""
        return self._process.returncode

    def poll(self) -> int | None:
        """How it ended, None while it runs."""
        return self._process.poll()

    def wait(self, timeout: float | None = None) -> int:
        """Wait until it ends by itself."""
        return self._process.wait(timeout)

    def end(self) -> None:
        """End it, politely first, and its watchman."""
        self._end_program()
        try:
            self._watchman.communicate(b"x", timeout=PATIENCE)
        except (subprocess.TimeoutExpired, OSError, ValueError):
            self._watchman.kill()
            self._watchman.wait()

    def _end_program(self) -> None:
        if self._process.poll() is None:
            self._process.terminate()
            try:
                self._process.wait(PATIENCE)
            except subprocess.TimeoutExpired:
                self._process.kill()
                self._process.wait()


def _born(number: int) -> str:
    """When a process began, as the system counts it; "" where that is not told."""
    try:
        return Path(f"/proc/{number}/stat").read_text().rsplit(")", 1)[1].split()[19]
    except OSError:
        return "" if os.path.isdir("/proc/self") else "unknown"
