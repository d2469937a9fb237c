"""Folders for what is needed for a while only; what dead runs left of theirs is swept away by the next."""

from __future__ import annotations

import os
import shutil
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

PREFIX, LOCK = "sailviz-", ".lock"
YOUNGEST = 60.0  # s: a folder that may have been made just now is left alone


@contextmanager
def scratch() -> Iterator[Path]:
    """A folder that is gone afterwards."""
    sweep()
    with tempfile.TemporaryDirectory(prefix=PREFIX, ignore_cleanup_errors=True) as name:
        handle = os.open(Path(name) / LOCK, os.O_CREAT | os.O_RDWR, 0o600)
        try:
            _held(handle)
            yield Path(name)
        finally:
            os.close(handle)


def sweep() -> None:
    """Remove folders of ours that no living process holds: their locks went with those that died."""
    if os.name != "posix":  # there is no telling who is alive
        return
    for folder in Path(tempfile.gettempdir()).glob(f"{PREFIX}*"):
        try:
            facts = folder.lstat()
            if folder.is_symlink() or facts.st_uid != os.geteuid() or time.time() - facts.st_mtime < YOUNGEST:
                continue
            handle = os.open(folder / LOCK, os.O_RDWR | os.O_NOFOLLOW)
        except OSError:  # none of these folders, or gone by now
            continue
        try:
            if _held(handle):
                shutil.rmtree(folder, ignore_errors=True)
        finally:
            os.close(handle)


def _held(handle: int) -> bool:
    """Hold a folder as long as its lock is open; False where another process does."""
    try:
        import fcntl

        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except ImportError:
        return True
    except OSError:
        return False
    return True
