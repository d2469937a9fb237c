"""Files that travel with the package: scenes and assets, found from an installed wheel and from a checkout alike."""

from __future__ import annotations

import tomllib
from functools import cache
from pathlib import Path

_PACKAGE = Path(__file__).parent


def shipped_folder(kind: str) -> Path:
    """Folder "scenes" or "assets": inside the package when installed, beside it in a checkout."""
    inside = _PACKAGE / kind
    return inside if inside.is_dir() else _PACKAGE.parent / kind


@cache
def shipped_scenes() -> dict[str, Path]:
    """Name -> file of every shipped scene, e.g. "displaced/circular"."""
    return {name: path for name, path in _named().items() if not name.startswith("sweeps/")}


def title_of(scene: Path) -> str:
    """The title of a shipped scene: of its file only what stands before the first section is read."""
    top = scene.read_text(encoding="utf-8").partition("\n[")[0]
    title: str = tomllib.loads(top)["title"]
    return title


@cache
def shipped_sweeps() -> dict[str, Path]:
    """Name -> file of every shipped sweep, e.g. "sweeps/pitch-to-venus"."""
    return {name: path for name, path in _named().items() if name.startswith("sweeps/")}


def _named() -> dict[str, Path]:
    folder = shipped_folder("scenes")
    return {path.relative_to(folder).with_suffix("").as_posix(): path for path in sorted(folder.glob("*/*.toml"))}
