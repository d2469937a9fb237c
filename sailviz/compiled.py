"""How sailviz compiles: one decorator, cached on disk, able to run from a read-only installation."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any, get_type_hints

import numba
import numpy as np
from numba.core import sigutils
from numba.core.ccallback import CFunc

# No reassociation: compensated sums and NaN must mean what they say. Contraction (fused multiply-add) is safe.
_OPTIONS: dict[str, Any] = {"error_model": "numpy", "fastmath": {"contract", "nsz"}, "nogil": True}


_njit: Any = numba.njit  # some of the options are in no stub
_PACKAGE = Path(__file__).parent
_ROOMS = ("design", "environment", "propagate", "propulsion", "simulation", "steering", "uncertainty")  # that compile
_SOURCES = tuple(
    (path.relative_to(_PACKAGE).as_posix(), path.stat().st_mtime_ns, path.stat().st_size)
    for path in sorted(_PACKAGE.rglob("*.py"))
    if path.parent == _PACKAGE or path.relative_to(_PACKAGE).parts[0] in _ROOMS
)


def compiled(function: Callable[..., Any]) -> Any:
    """Compile a module-level function of scalars and arrays on first use and keep the machine code on disk.

    numba honours NUMBA_CACHE_DIR, then tries the package's __pycache__, then the user's cache folder; where none of
    them can be written the function is compiled anew in every process. The code on disk holds for the sources it was
    made of: numba itself looks at the function's own file only, and would miss a change in a function that this one
    calls.
    """
    try:
        dispatcher = _njit(cache=True, **_OPTIONS)(function)
    except RuntimeError:  # "no locator available": nowhere to write
        return _njit(**_OPTIONS)(function)
    _stamp(dispatcher)
    return dispatcher


@cache
def cached_c_function(function: Callable[..., Any], signature: Any) -> CFunc:
    """A C function (numba.cfunc), its machine code kept on disk under the same rules as that of `compiled`."""
    options = {key: value for key, value in _OPTIONS.items() if key != "nogil"}
    made = CFunc(function, sigutils.normalize_signature(signature), {}, options)
    try:
        made.enable_caching()
    except RuntimeError:  # nowhere to write
        made = CFunc(function, sigutils.normalize_signature(signature), {}, options)
    _stamp(made)
    made.compile()
    return made


def _stamp(made: Any) -> None:
    file = getattr(made._cache, "_cache_file", None)
    if file is not None and hasattr(file, "_source_stamp"):
        file._source_stamp = (file._source_stamp, _SOURCES)


def inlined(function: Callable[..., Any]) -> Any:
    """Like `compiled`, for small functions that only other compiled functions call; the optimiser merges them.

    They may read and write arrays but not create any: compiled without reference counting, which would otherwise
    cost as much as the physics (134 ns against 71 ns for one right-hand side, numba 0.68).
    """
    return _njit(_nrt=False, forceinline=True, **_OPTIONS)(function)


def called(function: Callable[..., Any]) -> Any:
    """Like `inlined`, for functions called from so many places that copies of them would only lengthen the
    compilation."""
    return _njit(_nrt=False, **_OPTIONS)(function)


STATE = 10  # numbers of a callback's state: position m, velocity m/s, mass kg, and for a device the unit normal


def layout(declared: type) -> np.dtype[Any]:
    """The structured type of a NamedTuple of floats and ints, by which compiled code reads its fields by name. The
    numbers that a callback has of its own must all be floats."""
    kinds = {float: np.float64, int: np.int64}
    return np.dtype([(name, kinds[kind]) for name, kind in get_type_hints(declared).items()], align=True)


def is_compiled(function: Any) -> bool:
    """Whether the machine code of a `compiled` function is in memory or on disk already. A guess: it only decides
    whether a person is told to wait."""
    if function.signatures:
        return True
    try:
        return bool(function._cache._cache_file._load_index())
    except (AttributeError, OSError):  # no cache, or another numba
        return False
