"""Reading a whole file in a process of its own: what is damaged may end the process that reads it.

Rerun and Arrow are written for files as they were written; a flipped bit can end the process from within. Files without
a checksum of their own (by others, or cut off) are therefore read once where that harms nobody.
"""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

from sailviz.errors import DamagedError

PATIENCE, RATE = 120.0, 2e6  # s, and bytes in a s on a slow machine, after which the reading counts as hanging
UNREADABLE = 3


def probe(path: Path, label: str) -> None:
    """Raise DamagedError, in one sentence, for a file that cannot be read from end to end."""
    patience = PATIENCE + path.stat().st_size / RATE
    command = [sys.executable, "-P", "-m", "sailviz.recording.read_through", str(path)]
    environment = dict(os.environ, RUST_LOG="off", RUST_BACKTRACE="0")
    environment["PYTHONPATH"] = os.pathsep.join(filter(None, [str(Path(__file__).parents[2]), *sys.path]))
    try:
        done = subprocess.run(
            command, env=environment, stdin=subprocess.DEVNULL, capture_output=True, timeout=patience, check=False
        )
    except subprocess.TimeoutExpired:
        raise DamagedError(f"{label} is damaged and cannot be read: reading it does not end") from None
    except OSError:
        return  # no process can be started here: better to try than to refuse
    if done.returncode == UNREADABLE:
        raise DamagedError(f"{label} cannot be read: it is damaged ({done.stdout.decode(errors='replace').strip()})")
    if done.returncode:
        raise DamagedError(f"{label} cannot be read: it is damaged (its contents do not decode)")
