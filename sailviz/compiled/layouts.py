"""Numbers by name, for compiled code."""

from __future__ import annotations

from typing import Any, get_type_hints

import numpy as np

STATE = 10  # numbers of a callback's state: position m, velocity m/s, mass kg, and for a device the unit normal


def layout(declared: type) -> np.dtype[Any]:
    """The structured type of a NamedTuple of floats and ints, by which compiled code reads its fields by name. The
    numbers that a callback has of its own must all be floats."""
    kinds = {float: np.float64, int: np.int64}
    return np.dtype([(name, kinds[kind]) for name, kind in get_type_hints(declared).items()], align=True)
