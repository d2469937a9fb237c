"""Files that a scene or a sweep names: regular files inside its folder, so that a file from elsewhere reads nothing
else of the machine that it is flown on."""

from __future__ import annotations

import os
import stat
from pathlib import Path, PureWindowsPath
from typing import TYPE_CHECKING

from sailviz.shipped import shipped_scenes, shipped_sweeps
from sailviz.words import nearest, shown

if TYPE_CHECKING:
    from sailviz.scene.loading import Scene

KINDS = (
    (stat.S_ISDIR, "a folder"),
    (stat.S_ISFIFO, "a pipe"),
    (stat.S_ISSOCK, "a socket"),
    (stat.S_ISCHR, "a device"),
    (stat.S_ISBLK, "a device"),
)


def folder_of(scene: Scene) -> Path:
    """Where the files that a scene names lie: beside its own, or in the working directory for a scene of no file."""
    return folder_beside(scene.source)


def folder_beside(source: str) -> Path:
    """The same for what a scene was loaded from: a path or a shipped name."""
    if not os.path.isfile(source) and (shipped := (shipped_scenes() | shipped_sweeps()).get(source)) is not None:
        return shipped.parent
    return Path(os.path.abspath(os.path.dirname(source) if os.path.isfile(source) else ""))


def outside(folder: Path, name: str) -> str:
    """Why a name may not be read, in a sentence without a full stop; "" if it may, or if there is no such file."""
    if not name.strip() or not name.isprintable():
        return f"{shown(name)} is no name of a file"
    windows = PureWindowsPath(name)
    if name.startswith(("/", "\\", "~")) or windows.drive or windows.root:
        return f"{shown(name)} is an absolute path: name a file in the folder of this one or below it"
    if ".." in windows.parts:
        return f'{shown(name)} leads out of the folder of this file: ".." is not allowed in a name'
    path = folder / name
    try:
        if not path.resolve().is_relative_to(folder.resolve()):
            return f"{shown(name)} is a link that leads out of the folder of this file"
        mode = path.stat().st_mode
    except FileNotFoundError:
        return ""
    except (OSError, RuntimeError, ValueError) as error:
        return f"{shown(name)} cannot be read: {(getattr(error, 'strerror', None) or str(error)).lower()}"
    if stat.S_ISREG(mode):
        return ""
    word = next((word for holds, word in KINDS if holds(mode)), "something else")
    return f"{shown(name)} is {word}, not a regular file"


def unreadable(folder: Path, name: str) -> str:
    """Why what lies under a name inside a folder cannot be read, as `outside` says it; "" if it can."""
    path = folder / name
    if not path.exists():
        beside = sorted(item.name for item in folder.iterdir() if item.suffix == path.suffix) if folder.is_dir() else []
        hint = nearest(name, beside) if beside else ""
        return f"there is no file {shown(name)} beside this one or below it" + (f". {hint}" if hint else "")
    return "" if os.access(path, os.R_OK) else f"{shown(name)} cannot be read: permission denied"
