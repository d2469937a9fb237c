"""Functions that compiled code calls, compiled when compiled code or Python first asks for them and not before."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import cached_property, update_wrapper
from importlib import import_module
from typing import Any

from sailviz.compiled.machine_code import sources

# No reassociation: compensated sums and NaN must mean what they say. Contraction (fused multiply-add) is safe.
OPTIONS: dict[str, Any] = {"error_model": "numpy", "fastmath": {"contract", "nsz"}, "nogil": True}
# Without reference counting, which would cost as much as the physics: 134 ns against 71 ns for one right-hand side.
WITHIN: dict[str, Any] = {"_nrt": False, **OPTIONS}
# Without the ways in for callers that are not compiled.
BARE = {"no_cpython_wrapper": True, "no_cfunc_wrapper": True}


class Late:
    """Something for compiled code that is made when it is first needed, since making it imports numba.

    numba takes it for what it stands for. `made` is what Python calls, `bare` what compiled code calls, `py_func` the
    function as it is written, if it is one.
    """

    def __init__(
        self,
        make: Callable[[], Any],
        function: Callable[..., Any] | None = None,
        make_bare: Callable[[], Any] | None = None,
    ):
        self._make, self._make_bare = make, make_bare
        if function is not None:
            update_wrapper(self, function)
            self.py_func = function

    @cached_property
    def made(self) -> Any:
        """For Python."""
        return self._make()

    @cached_property
    def bare(self) -> Any:
        """For compiled code."""
        return self.made if self._make_bare is None else self._make_bare()

    @property
    def _numba_type_(self) -> Any:
        from numba.core.registry import cpu_target

        return cpu_target.typing_context.resolve_value_type(self.bare)

    def __call__(self, *arguments: Any) -> Any:
        return self.made(*arguments)


def _njit(function: Callable[..., Any], **options: Any) -> Late:
    def make(**more: Any) -> Any:
        import numba

        with_all: Any = numba.njit  # some of the options are in no stub
        return with_all(**options, **more)(function)

    return Late(make, function, lambda: _once(make(**BARE)))


def _once(dispatcher: Any) -> Any:
    """Let a function be compiled once for all numbers, where numba would compile it anew for each that is written down
    in a call: the optimiser, which merges it into its caller, finds them all the same."""
    from numba.core.types import unliteral

    template = dispatcher.get_call_template

    def general(arguments: Sequence[Any], named: Mapping[str, Any]) -> Any:
        return template(tuple(map(unliteral, arguments)), {name: unliteral(one) for name, one in named.items()})

    dispatcher.get_call_template = general
    return dispatcher


def inlined(function: Callable[..., Any]) -> Late:
    """For small functions that only other compiled functions call; the optimiser merges them. They may read and write
    arrays but not create any."""
    return _njit(function, forceinline=True, **WITHIN)


def called(function: Callable[..., Any]) -> Late:
    """Like `inlined`, for functions called from so many places that copies of them would only lengthen the
    compilation."""
    return _njit(function, **WITHIN)


def apart(function: Callable[..., Any]) -> Late:
    """Like `called`, for long functions that are called from several places or seldom: there is one copy of them, in
    whatever they are called. (Of what a function of `inlined` calls numba would make copies too.)"""
    return _njit(function, forceinline=False, **WITHIN)


def summing(function: Callable[..., Any]) -> Late:
    """Like `inlined`, for sums that may be taken in any order that the compiler fixes: the same in every run."""
    return _njit(function, forceinline=True, **{**WITHIN, "fastmath": {"contract", "nsz", "reassoc"}})


def compiled(function: Callable[..., Any]) -> Late:
    """A module-level function of scalars and arrays that numba compiles for what it is called with.

    numba keeps the machine code: it honours NUMBA_CACHE_DIR, then tries the package's __pycache__, then the user's
    cache folder; where none of them can be written the function is compiled anew in every process. The code on disk
    holds for the sources it was made of: numba itself looks at the function's own file only, and would miss a change in
    a function that this one calls.
    """

    def make() -> Any:
        import numba

        try:
            dispatcher: Any = numba.njit(cache=True, **OPTIONS)(function)
        except RuntimeError:  # "no locator available": nowhere to write
            return numba.njit(**OPTIONS)(function)
        stamp(dispatcher)
        return dispatcher

    return Late(make, function)


def stamp(made: Any) -> None:
    """Let what numba keeps of a function hold for these sources only."""
    file = getattr(made._cache, "_cache_file", None)
    if file is not None and hasattr(file, "_source_stamp"):
        file._source_stamp = (file._source_stamp, sources())


def late(module: str, name: str, *arguments: Any) -> Late:
    """What only compiled code uses, an intrinsic above all, from a module that is imported when code is compiled; or
    with arguments, what a function there makes of them."""

    def make() -> Any:
        made = getattr(import_module(module), name)
        made = made(*arguments) if arguments else made
        from numba.core.registry import cpu_target

        cpu_target.typing_context.refresh()  # it may be new to numba
        cpu_target.target_context.refresh()
        return made

    return Late(make)
