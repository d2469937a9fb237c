"""Machine code on disk: object files that LLVM loads by itself, each with what it takes to trust it.

An object holds for one processor, one compiler and one content of the sources, which its name says in a hash. A damaged
one would crash the process, so its first line is a checksum of all that follows. Files that another person could have
put there are not read. Where nothing can be written, code is compiled anew in every process.
"""

from __future__ import annotations

import contextlib
import ctypes
import json
import os
import platform
import stat
import sys
from collections.abc import Callable
from functools import cache
from hashlib import sha256
from importlib.metadata import version
from pathlib import Path
from typing import Any, NamedTuple

FORMAT = 2  # of the files
PYTHONS_OWN = ("PyEval_SaveThread", "PyEval_RestoreThread", "PyLong_FromLongLong")  # that machine code calls
KEPT = 6  # objects of one function in a folder: other processors and sources share it; the oldest goes

PACKAGE = Path(__file__).parents[1]
ROOMS = ("compiled", "design", "environment", "propagate", "propulsion", "run", "simulation", "steering", "uncertainty")


class MachineCode(NamedTuple):
    """An object file and how to use it."""

    name: str  # of the function
    needs: tuple[str, ...]  # names of functions that it calls and does not have
    code: bytes


class CannotLoadError(RuntimeError):
    """Machine code for which a process without numba lacks something."""


@cache
def sources() -> tuple[tuple[str, str], ...]:
    """(name, hash of the content) of the sources that may be in machine code: those of the rooms that compile, and what
    stands beside them."""
    files = [PACKAGE / name for name in os.listdir(PACKAGE) if name.endswith(".py")]
    for room in ROOMS:
        for folder, _, names in os.walk(PACKAGE / room):
            files += [Path(folder, name) for name in names if name.endswith(".py")]
    return tuple(
        (file.relative_to(PACKAGE).as_posix(), sha256(file.read_bytes()).hexdigest()[:16]) for file in sorted(files)
    )


@cache
def _llvm() -> tuple[Any, Any]:
    """llvmlite.binding, and the engine that loads objects. CannotLoadError where there is none."""
    import llvmlite.binding as llvm

    try:
        llvm.initialize_native_target()
        llvm.initialize_native_asmprinter()
        machine = llvm.Target.from_default_triple().create_target_machine(codemodel="jitdefault", jit=True)
        engine = llvm.create_mcjit_compiler(llvm.parse_assembly(""), machine)
        nextafter = ctypes.CDLL(None).nextafter  # numba's name for it would be known to numba only
        llvm.add_symbol("numba_nextafter", ctypes.cast(nextafter, ctypes.c_void_p).value)
        for name in PYTHONS_OWN:
            llvm.add_symbol(name, ctypes.cast(getattr(ctypes.pythonapi, name), ctypes.c_void_p).value)
    except (OSError, RuntimeError, AttributeError, TypeError) as error:
        raise CannotLoadError(str(error)) from None
    return llvm, engine


@cache
def key() -> str:
    """Hash of all that machine code depends on."""
    llvm, _ = _llvm()
    environment = {name: value for name, value in os.environ.items() if name.startswith("NUMBA_")}
    environment.pop("NUMBA_CACHE_DIR", None)
    parts = (
        FORMAT,
        version("numba"),
        version("llvmlite"),
        version("numpy"),
        sys.implementation.cache_tag,
        object.__basicsize__,
        platform.machine(),
        sys.platform,
        llvm.get_host_cpu_name(),
        llvm.get_host_cpu_features().flatten(),
        sorted(environment.items()),
        sources(),
    )
    return sha256(repr(parts).encode()).hexdigest()[:20]


def folders() -> list[Path]:
    """Where machine code may lie, the best place first: NUMBA_CACHE_DIR alone, if it can be written; else beside the
    package, else in the user's cache."""
    places = [PACKAGE / "__pycache__"]
    home = os.environ.get("LOCALAPPDATA") if os.name == "nt" else os.environ.get("XDG_CACHE_HOME")
    with contextlib.suppress(RuntimeError):
        places.append((Path(home) if home else Path.home() / ".cache") / "sailviz")
    given = os.environ.get("NUMBA_CACHE_DIR")
    if not given:
        return places
    with contextlib.suppress(OSError):
        Path(given).mkdir(parents=True, exist_ok=True)
    return [Path(given)] if os.access(given, os.W_OK) else [Path(given), *places]


def kept(function: Callable[..., Any]) -> MachineCode | None:
    """The machine code of a function from the disk; None if it is not there or not to be trusted."""
    for file in _files(function):
        with contextlib.suppress(OSError, ValueError, KeyError, TypeError):
            return _trusted(file)
    return None


def keep(function: Callable[..., Any], made: MachineCode) -> None:
    """Write machine code where it can be written, whole or not at all."""
    head = json.dumps({"name": made.name, "needs": made.needs}).encode()
    content = head + b"\n" + made.code
    for file in _files(function):
        part = file.with_name(f"{file.name}.{os.getpid()}-{os.urandom(4).hex()}")
        try:
            file.parent.mkdir(parents=True, exist_ok=True)
            with open(part, "xb") as stream:
                stream.write(sha256(content).hexdigest().encode() + b"\n" + content)
            os.replace(part, file)
        except OSError:  # not ours to write, no room
            with contextlib.suppress(OSError):
                part.unlink()
            continue
        _make_room(file)
        return


def load(made: MachineCode) -> int:
    """Address of the function. CannotLoadError where something is missing that it needs: LLVM would end the process."""
    llvm, engine = _llvm()
    missing = [name for name in made.needs if not llvm.address_of_symbol(name)]
    if missing:
        raise CannotLoadError(f"{made.name} needs {', '.join(missing)}")
    engine.add_object_file(llvm.ObjectFileRef.from_data(made.code))
    engine.finalize_object()
    address = int(engine.get_function_address(made.name))
    if not address:
        raise CannotLoadError(f"{made.name} is not in its object")
    return address


def _files(function: Callable[..., Any]) -> list[Path]:
    """Where the machine code of a function may lie. Nowhere, if it is not known where its source is."""
    name = f"{function.__module__}.{function.__qualname__}"
    own = b""
    if not name.startswith("sailviz."):  # somebody's own: what it takes from other modules is not looked at
        try:
            own = Path(function.__code__.co_filename).read_bytes()
        except (OSError, ValueError):
            return []
    if "<" in name:  # what it closes over is known to nobody
        return []
    hashed = sha256(key().encode() + own).hexdigest()[:20]
    return [folder / f"{name}-{hashed}.object" for folder in folders()]


def _trusted(file: Path) -> MachineCode:
    """The content of a file. ValueError for one that is damaged, cut, or of another person."""
    handle = os.open(file, os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0))
    with open(handle, "rb") as stream:
        facts = os.fstat(handle)
        owners = {0, os.geteuid(), PACKAGE.stat().st_uid} if hasattr(os, "geteuid") else {facts.st_uid}
        if not stat.S_ISREG(facts.st_mode) or facts.st_uid not in owners or facts.st_mode & stat.S_IWOTH:
            raise ValueError(f"{file} may be anybody's")
        check, _, content = stream.read().partition(b"\n")
    if check != sha256(content).hexdigest().encode():
        raise ValueError(f"{file} is damaged")
    head, _, code = content.partition(b"\n")
    facts_of_it = json.loads(head)
    return MachineCode(str(facts_of_it["name"]), tuple(facts_of_it["needs"]), code)


def _make_room(file: Path) -> None:
    """Let the newest objects of a function stay; what a process that died has half written goes with the others."""
    name = file.name.rpartition("-")[0]
    with contextlib.suppress(OSError):
        files = sorted(file.parent.glob(f"{name}-*.object*"), key=lambda file: file.stat().st_mtime, reverse=True)
        for file in files[KEPT:]:
            file.unlink(missing_ok=True)
