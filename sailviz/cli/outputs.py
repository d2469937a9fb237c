"""Where a command may write: what cannot be written is refused before any work, in a sentence."""

from __future__ import annotations

import os
from pathlib import Path

from sailviz.errors import OutputError

PART = ".4194304.part"  # what the name of a growing file has more than its own, a dot before it apart


def file_at(given: str | os.PathLike[str], what: str, endings: tuple[str, ...] = ()) -> Path:
    """The path of a file that can be written, as far as that can be known. what : word for the messages; endings : of
    its name, any if there are none. OutputError, in one sentence, where it cannot be."""
    path = _named(given, what)
    if is_folder(path):
        raise OutputError(f"cannot write the {what} {path}: it is a directory")
    if endings and path.suffix.lower() not in endings:
        raise OutputError(f"{path} is no {what}: its name must end in {' or '.join(filter(None, endings))}")
    if not path.exists() or path.is_file():  # nothing appears beside a device or a pipe
        _check_folder(path.parent, what, path)
    if path.exists() and not os.access(path, os.W_OK):
        raise OutputError(f"cannot write the {what} {path}: permission denied")
    return path


def folder_at(given: str | os.PathLike[str], what: str) -> Path:
    """The path of a folder that is there and can be written to, or that can be made in one that is. OutputError as
    above."""
    path = _named(given, what)
    if path.exists() and not path.is_dir():
        raise OutputError(f"cannot write the {what} into {path}: it is no folder")
    _check_folder(path if path.is_dir() else path.parent, what, path)
    return path


def file_or_folder(given: str | os.PathLike[str], name: str, what: str, endings: tuple[str, ...] = ()) -> Path:
    """The file that -o means: itself if it has an ending or is a device or a pipe, else `name` in the folder of that
    name."""
    path = _named(given, what)
    if not path.is_dir() and (path.suffix or (path.exists() and not path.is_file())):
        return file_at(path, what, endings)
    folder = folder_at(path, what)
    return file_at(folder / name, what, endings) if folder.is_dir() else folder / name


def is_folder(given: str | os.PathLike[str]) -> bool:
    """Whether a folder stands under a name, whatever the name is made of."""
    return os.path.isdir(given)


def make_folder(folder: Path) -> None:
    """Make a folder where there is none, in one that is. OutputError where that cannot be."""
    try:
        folder.mkdir(exist_ok=True)
    except OSError as error:
        raise OutputError(f"cannot make the folder {folder}: {(error.strerror or str(error)).lower()}") from None


def _named(given: str | os.PathLike[str], what: str) -> Path:
    """A path that a file system knows; OutputError for no name, one too long, or of what no name is made of."""
    text = os.fspath(given)
    if not text.strip():
        raise OutputError(f"the name of the {what} is empty")
    path = Path(text)
    try:
        for known in (path, path.with_name(f".{path.name}{PART}") if path.name else path):
            known.lstat()
    except (FileNotFoundError, NotADirectoryError):
        pass
    except (OSError, ValueError) as error:  # too long, or with a null character in it
        why = (getattr(error, "strerror", None) or str(error)).lower()
        raise OutputError(f"cannot write the {what} {path}: {why}") from None
    return path


def _check_folder(folder: Path, what: str, path: Path) -> None:
    if not folder.is_dir():
        why = f"{folder} is no directory" if folder.exists() else f"there is no directory {folder}"
        raise OutputError(f"cannot write the {what} {path}: {why}")
    if not os.access(folder, os.W_OK | os.X_OK):
        raise OutputError(f"cannot write the {what} {path}: permission denied in {folder}")
