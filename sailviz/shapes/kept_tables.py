"""Tables of shapes on disk: made once for a shape, its materials and how it is to be read, found again by their hash.

They lie in the user's cache folder, `sailviz/tables`. A table that is damaged, or cut, or of another person, is made
anew; where nothing can be written it is made every time.
"""

from __future__ import annotations

import contextlib
import hashlib
import os
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np

from sailviz.shapes import facing, light_table
from sailviz.shapes.facets import Shape
from sailviz.shapes.light_force import LIGHT, Law
from sailviz.shapes.light_table import CELLS, COLUMNS, NODES, LightTable
from sailviz.shapes.shadows import may_shade, ray_caster

FORMAT = 1  # of the numbers and of how they are made
KEPT = 60  # tables; the oldest goes
SIGN = 32  # bytes of the checksum before the numbers


def folder() -> Path | None:
    """Where tables are kept; None where there is no home."""
    given = os.environ.get("LOCALAPPDATA") if os.name == "nt" else os.environ.get("XDG_CACHE_HOME")
    with contextlib.suppress(RuntimeError):
        return (Path(given) if given else Path.home() / ".cache") / "sailviz" / "tables"
    return None


def key(shape: Shape, cells: int, shadow: bool, interpolation: str, law: Law) -> str:
    """Hash of all that a table depends on, what casts its rays included; it is what a recording says of it."""
    backend = ray_caster() if shadow and may_shade(shape) else "none"
    parts = (FORMAT, shape.digest(), cells, interpolation, backend, repr(law))
    return hashlib.sha256(repr(parts).encode()).hexdigest()[:20]


def table_of(
    shape: Shape,
    cells: int = CELLS,
    *,
    shadow: bool = True,
    interpolation: str = "bilinear",
    law: Law = LIGHT,
    progress: Callable[[float], None] | None = None,
) -> LightTable:
    """`light_table.build`, from the disk where it has been made before."""
    return tables_of([shape], cells, shadow=shadow, interpolation=interpolation, law=law, progress=progress)[0]


def tables_of(
    shapes: Sequence[Shape],
    cells: int = CELLS,
    *,
    shadow: bool = True,
    interpolation: str = "bilinear",
    law: Law = LIGHT,
    progress: Callable[[float], None] | None = None,
) -> list[LightTable]:
    """`light_table.build_all`, each from the disk where it has been made before."""
    place, ring = folder(), light_table.INTERPOLATIONS[interpolation]
    count = NODES + 6 * (cells + 1 + 2 * ring) ** 2 * COLUMNS
    backend = ray_caster() if shadow and may_shade(shapes[0]) else "none"
    found: dict[int, LightTable] = {}
    files: list[Path | None] = []
    for i, shape in enumerate(shapes):
        light_table.check(shape, cells)
        word = key(shape, cells, shadow, interpolation, law)
        files.append(None if place is None else place / f"{word}.table")
        kept = None if place is None else _read(place / f"{word}.table", count)
        if kept is not None:
            found[i] = LightTable(kept, backend)
    missing = [i for i in range(len(shapes)) if i not in found]
    if missing:
        made = light_table.build_all(
            [shapes[i] for i in missing],
            cells,
            shadow=shadow,
            interpolation=interpolation,
            law=law,
            progress=progress,
        )
        for i, one in zip(missing, made, strict=True):
            found[i], file = one, files[i]
            if file is not None:
                _write(file, one.numbers)
    return [found[i] for i in range(len(shapes))]


def shares_of(shape: Shape, films: Sequence[Sequence[int]], cells: int) -> np.ndarray:
    """`facing.shares`, from the disk where they have been made before."""
    place, form = folder(), (len(films), 6, cells + 1, cells + 1, 2)
    light_table.check(shape, cells)
    parts = ("shares", FORMAT, shape.digest(), tuple(map(tuple, films)), cells, ray_caster())
    file = None if place is None else place / f"{hashlib.sha256(repr(parts).encode()).hexdigest()[:20]}.table"
    kept = None if file is None else _read(file, int(np.prod(form)))
    if kept is not None:
        return kept.reshape(form)
    made = facing.shares(shape, films, cells)
    if file is not None:
        _write(file, made)
    return made


def _read(file: Path, count: int) -> np.ndarray | None:
    """The numbers of a whole file of one's own; None for any other."""
    try:
        facts = file.lstat()
        if (
            not file.is_file()
            or file.is_symlink()
            or (hasattr(os, "geteuid") and facts.st_uid not in (0, os.geteuid()))
        ):
            return None
        if facts.st_size != SIGN + 8 * count:
            return None
        content = file.read_bytes()
    except OSError:
        return None
    if hashlib.sha256(content[SIGN:]).digest() != content[:SIGN]:
        return None
    return np.frombuffer(content[SIGN:], "<f8").astype(float)


def _write(file: Path, numbers: np.ndarray) -> None:
    """Keep the numbers, whole or not at all, where that can be."""
    content = np.ascontiguousarray(numbers, "<f8").tobytes()
    part = file.with_name(f"{file.name}.{os.getpid()}-{os.urandom(4).hex()}")
    try:
        file.parent.mkdir(parents=True, exist_ok=True)
        part.write_bytes(hashlib.sha256(content).digest() + content)
        os.replace(part, file)
        for old in sorted(file.parent.glob("*.table*"), key=lambda each: -each.stat().st_mtime)[KEPT:]:
            old.unlink(missing_ok=True)
    except OSError:  # not ours to write, no room
        with contextlib.suppress(OSError):
            part.unlink()
