"""Functions that Python calls, and C functions that compiled code calls by their address, without numba once their
machine code is on disk."""

from __future__ import annotations

import ctypes
import operator
import struct
from collections.abc import Callable, Sequence
from functools import cache, cached_property, update_wrapper
from typing import Any

import numpy as np

from sailviz.compiled import machine_code
from sailviz.compiled.decorators import OPTIONS, called
from sailviz.compiled.machine_code import CannotLoadError, MachineCode
from sailviz.compiled.waiting import compiling

_REAL, _WHOLE = struct.Struct("d"), struct.Struct("q")
MISFIT, FAILED = -1, -2  # results of a call whose arguments do not fit, and of one that failed: `compiling`
TYPES = (np.ndarray, float, np.float64)  # the types that compiled code looks for in what is handed over
AS_AN_ARRAY = 0x80  # METH_FASTCALL: arguments are handed over as an array of addresses and their number


DTYPES: dict[str, np.dtype[Any]] = {
    "d": np.dtype(np.float64),
    "i": np.dtype(np.int64),
    "j": np.dtype(np.int32),
    "u": np.dtype(np.uint64),
}
DTYPES["b"] = np.dtype(np.bool_)


class Kind:
    """What an entry takes in one place.

    word : d or i for a float or an integer; with a number of axes, d2, i1, j1, u1, b1, r1, an array in C order of
    float64, int64, int32, uint64, bool or records; in capitals, D2, one that is written.
    """

    def __init__(self, word: str, record: np.dtype[Any] | None):
        letter, axes = word[0].lower(), word[1:]
        self.word, self.is_array, self.written = word, bool(axes), word[0].isupper()
        dtype: np.dtype[Any] | None = record if letter == "r" else DTYPES.get(letter)
        if dtype is None or not (axes.isdecimal() if axes else word in "di"):
            raise ValueError(f"there is no kind {word!r}")
        self.axes = int(axes or 0)
        self.dtype: np.dtype[Any] = dtype


class _Definition(ctypes.Structure):
    """Python's PyMethodDef."""

    _fields_ = (
        ("name", ctypes.c_char_p),
        ("function", ctypes.c_void_p),
        ("flags", ctypes.c_int),
        ("help", ctypes.c_char_p),
    )


class Entry:
    """A function of arrays and numbers that Python calls and that returns an integer, not below zero.

    It is called as a function of Python's own, built in; compiled code reads the arguments out of numpy's arrays by
    itself (`unpacking.py`), which costs a tenth of handing over what an array consists of. TypeError where they are not
    of the kinds declared.
    """

    def __init__(self, function: Callable[..., int], kinds: str, record: np.dtype[Any] | None):
        update_wrapper(self, function)
        self.py_func = function
        self.name = f"{function.__module__}.{function.__qualname__}"
        self.kernel = called(function)  # for compiled code
        self.declared = kinds
        self.kinds = tuple(Kind(word, record) for word in kinds.split())
        self._floats = tuple(i for i, kind in enumerate(self.kinds) if kind.word == "d")
        self._integers = tuple(i for i, kind in enumerate(self.kinds) if kind.word == "i")
        self._count = len(self.kinds)

    @property
    def _numba_type_(self) -> Any:
        return self.kernel._numba_type_

    def _compiled(self) -> MachineCode | None:
        from sailviz.compiled.compiling import compile_for_python
        from sailviz.compiled.unpacking import unpacking

        kernel = self.kernel.bare
        fits, arguments = unpacking(self.kinds)

        def unpacked(types: Any, place: Any) -> Any:
            if not fits(types, place):
                return MISFIT
            return kernel(*arguments(place))

        return compile_for_python(unpacked, self.py_func.__qualname__, self._count)

    @cached_property
    def native(self) -> Callable[..., int] | None:
        """The compiled function, or None where numba has to call it. It returns MISFIT, and has done nothing, where the
        arguments are not of the kinds declared; an integer is to come as the float of the same bits."""
        if not _memory_is_as_expected():
            return None
        address = _address(self.py_func, self._compiled)
        return None if address is None else _built_in(self.name, address)

    @cached_property
    def at_once(self) -> Callable[..., int]:
        """What costs least to call: `native`, if there is one; where it returns MISFIT the entry itself is to be called
        with the same arguments. Of an entry of arrays and floats."""
        return self if self.native is None or self._integers else self.native

    @cached_property
    def _by_numba(self) -> Callable[..., int]:
        import numba

        made: Callable[..., int] = numba.njit(**OPTIONS)(self.py_func)
        return made

    def __call__(self, *arguments: Any) -> int:
        if len(arguments) != self._count:
            raise TypeError(f"{self.name} takes {self._count} arguments, not {len(arguments)}")
        native = self.native
        if native is None:
            return self._called_by_numba(arguments)
        if self._integers:
            given = [*arguments]
            for i in self._integers:
                (given[i],) = _REAL.unpack(_WHOLE.pack(arguments[i]))  # as a float of the same bits
            result = native(*given)
        else:
            result = native(*arguments)
        if result == FAILED:
            raise RuntimeError(f"{self.name} failed")
        return result if result >= 0 else self._converted(arguments)

    def _converted(self, arguments: Sequence[Any]) -> int:
        """Once more, with every number that is none of Python's and numpy's floats made one."""
        given = list(arguments)
        for i in self._floats:
            given[i] = float(given[i])
        if all(type(arguments[i]) in TYPES[1:] for i in self._floats):
            raise TypeError(f"{self.name} does not take {self._misfits(arguments)}")
        return self(*given)

    def _called_by_numba(self, arguments: Sequence[Any]) -> int:
        misfits = self._misfits(arguments)
        if misfits:
            raise TypeError(f"{self.name} does not take {misfits}")
        numbers: dict[str, Callable[[Any], Any]] = {"d": float, "i": operator.index}
        pairs = zip(arguments, self.kinds, strict=True)
        return int(self._by_numba(*(one if kind.is_array else numbers[kind.word](one) for one, kind in pairs)))

    def _misfits(self, arguments: Sequence[Any]) -> str:
        """Which arguments are not of their kinds, in words."""
        pairs = enumerate(zip(arguments, self.kinds, strict=True), 1)
        return "; ".join(
            f"{_described(one)} as argument {number}, {kind.word}"
            for number, (one, kind) in pairs
            if kind.is_array and not _fits(one, kind)
        )


def _built_in(name: str, address: int) -> Callable[..., int]:
    """A function of Python's own of machine code that takes its arguments AS_AN_ARRAY."""
    new = ctypes.PYFUNCTYPE(ctypes.py_object, ctypes.c_void_p, ctypes.py_object, ctypes.c_void_p)
    definition = _Definition(name.encode(), address, AS_AN_ARRAY, None)
    _definitions.append(definition)  # which Python reads at each call
    made: Callable[..., int] = new(("PyCFunction_NewEx", ctypes.pythonapi))(ctypes.addressof(definition), TYPES, None)
    return made


_definitions: list[_Definition] = []


def _fits(array: Any, kind: Kind) -> bool:
    return (
        type(array) is np.ndarray
        and array.ndim == kind.axes
        and array.dtype == kind.dtype
        and array.flags.c_contiguous
        and array.flags.aligned
        and (array.flags.writeable or not kind.written)
    )


def _described(one: Any) -> str:
    if not isinstance(one, np.ndarray):
        return type(one).__name__
    order = "" if one.flags.c_contiguous else " not in C order"
    return f"an array {one.shape} of {one.dtype.kind}{one.dtype.itemsize}{order}"


def entry(kinds: str, record: np.dtype[Any] | None = None) -> Callable[[Callable[..., int]], Entry]:
    """Make an `Entry` of a module-level function that creates no array, counts no reference and raises nothing.

    kinds : what it takes, in order, see `Kind`; record : the structured type of its records.
    """
    return lambda function: Entry(function, kinds, record)


@cache
def c_function(function: Callable[..., None], declared: Callable[[], Any]) -> tuple[int, object]:
    """(address, what keeps it alive) of a function that compiled code calls in numba's own convention: int status(
    *result, **error, arguments ...). Compiled on first use.

    declared : makes its signature, of numba's types, for which numba is imported. A function that does not do without
    numba, as one that calls numba's `carray`, is kept and found again by numba.
    """
    address = _address(function, lambda: _without_numba(function, declared()))
    if address is not None:
        return address, function
    from sailviz.compiled.compiling import compile_by_numba

    with compiling():
        return compile_by_numba(function, declared())


def _without_numba(function: Callable[..., None], signature: Any) -> MachineCode | None:
    from numba.core.errors import NumbaError

    from sailviz.compiled.compiling import compile_native

    try:
        return compile_native(function, signature)
    except NumbaError:  # told by numba when it compiles the function in its own way
        return None


def _address(function: Callable[..., Any], make: Callable[[], MachineCode | None]) -> int | None:
    """Address of machine code from the disk, or else made and kept there; None where it does not do without numba."""
    try:
        found = machine_code.kept(function)
        if found is not None:
            return machine_code.load(found)
        with compiling():
            made = make()
        if made is None:
            return None
        address = machine_code.load(made)
    except CannotLoadError:
        return None
    machine_code.keep(function, made)
    return address


@cache
def _memory_is_as_expected() -> bool:
    """Whether tuples, floats and numpy's arrays lie in memory as compiled code reads them (`unpacking`)."""
    from sailviz.compiled import memory

    return memory.is_as_expected()
