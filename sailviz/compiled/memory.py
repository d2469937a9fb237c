"""How tuples, floats and numpy's arrays lie in memory: what compiled code reads of them. Places in bytes."""

from __future__ import annotations

import ctypes
import sys
from typing import Any

import numpy as np

HEAD = object.__basicsize__  # of every object; its last word is the type
TYPE = HEAD - 8
ITEMS = tuple.__basicsize__
NUMBER = HEAD  # of a float, and of a np.float64
DATA, AXES, SHAPE, STRIDES, DTYPE, FLAGS = HEAD, HEAD + 8, HEAD + 16, HEAD + 24, HEAD + 40, HEAD + 48  # of an array
LETTER, ORDER, SIZE = HEAD + 8, HEAD + 10, HEAD + 24  # of a dtype: its kind, its byte order, the size of an item
WHOLE = ctypes.c_int64
C_ORDER, ALIGNED, WRITEABLE = 0x1, 0x100, 0x400  # flags of an array


def is_as_expected() -> bool:
    """Whether that holds here: looked up in a few objects whose content is known. Reads nothing beyond them."""
    if sys.implementation.name != "cpython" or ctypes.sizeof(ctypes.c_void_p) != 8 or sys.byteorder != "little":
        return False
    if np.ndarray.__basicsize__ < FLAGS + 4 or np.dtype.__basicsize__ < SIZE + 8:
        return False
    array, number = np.zeros((3, 5)), 0.625
    return _of_numbers(array, number) and _of_arrays(array) and _of_kinds(array)


def _of_numbers(array: np.ndarray, number: float) -> bool:
    """Whether a pair holds its items, and a float, numpy's as well, its number where they are looked for."""
    pair, of_numpy = (array, number), np.float64(number)
    return bool(
        _read(id(pair) + ITEMS, WHOLE) == id(array)
        and _read(id(pair) + ITEMS + 8, WHOLE) == id(number)
        and _read(id(number) + TYPE, WHOLE) == id(float)
        and _read(id(number) + NUMBER, ctypes.c_double) == number
        and np.float64.__basicsize__ >= NUMBER + 8
        and _read(id(of_numpy) + TYPE, WHOLE) == id(np.float64)
        and _read(id(of_numpy) + NUMBER, ctypes.c_double) == number
    )


def _of_arrays(array: np.ndarray) -> bool:
    """Whether an array (3, 5) of floats has its data, axes, shape, strides and flags there."""
    address = id(array)
    return bool(
        _read(address + TYPE, WHOLE) == id(np.ndarray)
        and _read(address + DATA, WHOLE) == array.ctypes.data
        and _read(address + AXES, ctypes.c_int) == 2
        and [_read(_read(address + SHAPE, WHOLE) + 8 * i, WHOLE) for i in range(2)] == [3, 5]
        and [_read(_read(address + STRIDES, WHOLE) + 8 * i, WHOLE) for i in range(2)] == [40, 8]
        and _read(address + FLAGS, ctypes.c_int) & 0x501 == C_ORDER | ALIGNED | WRITEABLE
    )


def _of_kinds(array: np.ndarray) -> bool:
    """Whether an array of floats says there what its numbers are."""
    dtype = _read(id(array) + DTYPE, WHOLE)
    return bool(
        dtype == id(array.dtype)
        and _read(dtype + LETTER, ctypes.c_char) == b"f"
        and _read(dtype + ORDER, ctypes.c_char) == b"="
        and _read(dtype + SIZE, WHOLE) == 8
    )


def _read(address: int, kind: Any) -> Any:
    return kind.from_address(address).value
