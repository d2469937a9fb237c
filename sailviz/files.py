"""Files that appear whole or not at all: written beside their name, flushed, synced, and only then moved to it.

What is not a regular file (a device, a pipe, a socket) is never renamed over: it is written into. A file that is
already there stays as it is until the new one is whole.
"""

from __future__ import annotations

import errno
import os
import shutil
import stat
import tempfile
import time
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from sailviz.errors import OutputError

PROBE = 1 << 16  # bytes that are tried where something could not be written
LEFTOVER_AGE = 60.0  # s: a part of a run that may have begun just now is left alone


@dataclass
class Output:
    """A file on its way. path : the name asked for; part : where to write until `publish` or `discard`."""

    path: Path
    part: Path
    what: str
    regular: bool = True
    _lock: int | None = None

    @classmethod
    def reserve(cls, path: str | os.PathLike[str], what: str = "file") -> Output:
        """Claim a name, at once, so that what cannot be written fails before anything is computed. what : word for the
        messages. Parts that dead runs left beside it are removed. OutputError, in one sentence, where it cannot be."""
        asked = Path(path)
        target = _followed(asked, what)
        regular = not target.exists() or target.is_file()
        if target.is_dir():
            raise OutputError(f"cannot write the {what} {asked}: it is a directory")
        if not target.parent.is_dir():
            raise OutputError(f"cannot write the {what} {asked}: there is no directory {target.parent}")
        try:
            if regular:
                if target.exists() and not os.access(target, os.W_OK):
                    raise OutputError(f"cannot write the {what} {asked}: the file there is write-protected")
                sweep(target)
                part = target.with_name(f".{target.name}.{os.getpid()}.part")
                handle = os.open(part, os.O_CREAT | os.O_RDWR | os.O_TRUNC, 0o666)
            else:
                handle, name = tempfile.mkstemp(prefix="sailviz-", suffix=f"-{target.name}.part")
                part = Path(name)
        except OSError as error:
            raise OutputError(f"cannot write the {what} {asked}: {reason(error)}") from None
        _lock(handle)
        return cls(target, part, what, regular, handle)

    def publish(self, check: Callable[[Path], None] | None = None) -> None:
        """Flush the part to the disk, let `check` look at it, and give it its name (or pour it into what is there).
        OutputError where the disk is full or the file cannot be moved; whatever was there before then stays."""
        try:
            with open(self.part, "rb+") as file:
                os.fsync(file.fileno())
            if check is not None:
                check(self.part)
            if self.regular:
                self._move()
            else:
                self._pour()
        except OSError as error:
            why = reason(error, self.part if self.regular else None)
            raise OutputError(f"cannot write the {self.what} {self.path}: {why}") from None
        finally:
            self.discard()

    def _move(self) -> None:
        if self.path.exists():
            if not self.path.is_file():
                raise OutputError(f"cannot write the {self.what} {self.path}: it is no longer a regular file")
            shutil.copymode(self.path, self.part)
        os.replace(self.part, self.path)
        if os.name == "posix":
            folder = os.open(self.path.parent, os.O_RDONLY)
            try:
                os.fsync(folder)
            except OSError as error:  # some file systems know no sync of folders
                if error.errno not in (errno.EINVAL, errno.EBADF):
                    raise
            finally:
                os.close(folder)

    def _pour(self) -> None:
        with open(self.part, "rb") as source, open(self.path, "wb", buffering=0) as target:
            shutil.copyfileobj(source, target, 1 << 16)

    def discard(self) -> None:
        """Leave nothing behind."""
        if self._lock is not None:
            os.close(self._lock)
            self._lock = None
        self.part.unlink(missing_ok=True)


def check(path: str | os.PathLike[str], what: str = "file") -> None:
    """Raise OutputError for what cannot be written, before it is computed."""
    Output.reserve(path, what).discard()


@contextmanager
def writing(
    path: str | os.PathLike[str], what: str = "file", check: Callable[[Path], None] | None = None
) -> Iterator[Path]:
    """Yields the path to write to; the file has its own name once the block ends well, and is gone if it does not.
    check : looks at the whole file before it is published. OutputError for every OSError on the way."""
    output = Output.reserve(path, what)
    try:
        yield output.part
        output.publish(check)
    except OSError as error:
        raise OutputError(f"cannot write the {what} {output.path}: {reason(error, output.part)}") from None
    finally:
        output.discard()


@contextmanager
def writing_folder(path: str | os.PathLike[str], what: str, mine: Callable[[Path], str]) -> Iterator[Path]:
    """Yields a folder to write into; it has its own name once the block ends well, and is gone if it does not.

    mine : looks at a folder that is there and not empty, which the new one would take the place of, and says in words
    why that must not be, "" where it may. OutputError for every OSError on the way.
    """
    asked = Path(path)
    target = asked.resolve() if asked.is_symlink() else asked
    if target.exists() and not target.is_dir():
        raise OutputError(f"cannot write the {what} into {asked}: it is no folder")
    if not target.parent.is_dir():
        raise OutputError(f"cannot write the {what} into {asked}: there is no directory {target.parent}")
    part, old = (target.with_name(f".{target.name}.{os.getpid()}.{word}") for word in ("new", "old"))
    try:
        reason_against = mine(target) if target.is_dir() and any(target.iterdir()) else ""
        if reason_against:
            raise OutputError(f"cannot write the {what} into {asked}: {reason_against}")
        part.mkdir()
    except OSError as error:
        raise OutputError(f"cannot write the {what} into {asked}: {reason(error)}") from None
    try:
        yield part
        if target.exists():
            os.replace(target, old)
        try:
            os.replace(part, target)
        except OSError:
            if old.exists():
                os.replace(old, target)
            raise
    except OSError as error:
        raise OutputError(f"cannot write the {what} into {asked}: {reason(error)}") from None
    finally:
        shutil.rmtree(part, ignore_errors=True)
        shutil.rmtree(old, ignore_errors=True)


def write_text(path: str | os.PathLike[str], text: str, what: str = "file") -> None:
    """Write a text file (UTF-8), whole or not at all. OutputError where it cannot be written."""
    with writing(path, what) as part:
        part.write_text(text, encoding="utf-8")


def reason(error: OSError, part: Path | None = None) -> str:
    """Why a file operation failed, in words; of a full disk also how much is there."""
    if error.errno in (errno.ENOSPC, errno.EDQUOT):
        if part is None:
            return "no space is left"
        words = "no space is left on the disk"
        try:
            free, size = shutil.disk_usage(part.parent).free, part.stat().st_size if part.exists() else 0
        except OSError:
            return words
        return f"{words}: {size:,} bytes are written, {free:,} more are free, and that is not enough"
    if error.errno == errno.EFBIG:
        return "the file grows beyond what this system or shell allows (ulimit -f)"
    if error.errno == errno.EPIPE:
        return "nobody reads what is written"
    return (error.strerror or str(error)).lower()


def lacking(part: Path) -> str:
    """Of a part that somebody else's code could not write: what is missing, found by writing a little more to it. ""
    where there is room."""
    try:
        with open(part, "rb+") as file:
            end = file.seek(0, os.SEEK_END)
            try:
                file.write(bytes(PROBE))
                file.flush()
                os.fsync(file.fileno())
            finally:
                file.truncate(end)
    except OSError as error:
        return reason(error, part)
    return ""


def sweep(target: Path) -> None:
    """Remove the parts that dead runs left beside a file: made by no living process and held by none."""
    _remove_dead(target.parent.glob(f".{_escaped(target.name)}.*.part"), LEFTOVER_AGE)


def sweep_folder(folder: Path) -> None:
    """Remove all parts of dead runs from a folder that belongs to one run, however young they are."""
    _remove_dead(folder.glob(".*.part"), 0.0)


def _remove_dead(parts: Iterable[Path], age: float) -> None:
    for part in parts:
        word = part.name.rsplit(".", 2)[1]
        try:
            if not word.isdecimal() or _alive(int(word)) or time.time() - part.stat().st_mtime < age:
                continue
            handle = os.open(part, os.O_RDWR)
        except OSError:
            continue
        try:
            if _lock(handle):
                part.unlink(missing_ok=True)
        except OSError:
            continue
        finally:
            os.close(handle)


def _escaped(name: str) -> str:
    return "".join(f"[{letter}]" if letter in "*?[" else letter for letter in name)


def _alive(process: int) -> bool:
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return False
    except OSError:
        return True
    return True


def _lock(handle: int) -> bool:
    """Hold a part as long as it grows; False where another process holds it."""
    try:
        import fcntl
    except ImportError:  # Windows, which does not remove files that are open
        return True
    try:
        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError:
        return False
    return True


def _followed(path: Path, what: str) -> Path:
    """The file behind a link; a link to what is no file stays as it is, since a pipe may have no other name.
    OutputError for links that lead round in a circle."""
    try:
        return path.resolve() if path.is_symlink() and (path.is_file() or not path.exists()) else path
    except (OSError, RuntimeError) as error:
        why = reason(error) if isinstance(error, OSError) else "its links lead round in a circle"
        raise OutputError(f"cannot write the {what} {path}: {why}") from None


def regular(path: str | os.PathLike[str]) -> bool:
    """Whether a path leads to a regular file."""
    try:
        return stat.S_ISREG(os.stat(path).st_mode)
    except OSError:
        return False
