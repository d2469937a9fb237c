"""How far two columns are apart, where, and what by default they may be."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
import pyarrow as pa

from sailviz.recording.comparison.tables import plain
from sailviz.recording.entity import is_component
from sailviz.run import resample
from sailviz.words import unit_of

RELATIVE = 1e-9  # default tolerance: this part of the column's largest value
ROUNDING = 1e-14  # and no less than this for numbers of order one: angles, directions, ratios
FLOAT32 = 1e-5  # of the picture's float32 columns: their rounding, and what a camera can tell
COVERED = 2.0  # how many times the estimated cost of interpolation a default tolerance covers
Drawn = tuple[np.ndarray, pa.Array]  # steps and values of a column of the picture
COMPONENTS = {"quaternion": "xyzw", "acceleration_rtn_m_s2": "rtn"}


def component_name(column: str, index: tuple[int, ...]) -> str:
    """Which component of a vector, for people: x, y, z, or its number."""
    if not index:
        return ""
    letters = COMPONENTS.get(column, "xyz")
    return letters[index[0]] if len(index) == 1 and index[0] < len(letters) else str(list(index))


@dataclass(frozen=True)
class Difference:
    """What became of one quantity. Numbers in its unit; `largest` is inf where one side is not a number.

    row : step of A where the difference is largest; component : of a vector, "" for a scalar; time : s
    """

    quantity: str  # "/state:position_m"
    unit: str
    largest: float
    allowed: float  # where the difference is largest
    beyond: int  # values that differ by more than is allowed
    values: int
    row: int = -1
    component: str = ""
    time: float = math.nan
    a: float | str = math.nan
    b: float | str = math.nan
    interpolation: float = 0.0  # about what interpolating adds at most; 0 where rows were paired

    @property
    def equal(self) -> bool:
        """Whether no value differs by more than is allowed."""
        return self.beyond == 0


def default_tolerance(name: str, values: np.ndarray) -> float:
    """1e-9 of the column's largest value, and no less than rounding where numbers are of order one."""
    if values.dtype.kind != "f":
        return 0.0
    finite = values[np.isfinite(values)]
    largest = float(np.max(np.abs(finite))) if finite.size else 0.0
    return max(RELATIVE * largest, ROUNDING if unit_of(name) in ("rad", "") else 0.0)


def difference(quantity: str, a: np.ndarray, b: np.ndarray, atol: float, rtol: float) -> Difference:
    """The largest difference of two arrays of one shape, where it is and how many exceed what is allowed. `row` is the
    row in the arrays.
    """
    name = quantity.rpartition(":")[2]
    unit = unit_of(name)
    if not a.size:
        return Difference(quantity, unit, 0.0, atol, 0, 0)
    if a.dtype.kind != "f":
        gap, allowed = np.not_equal(a, b).astype(float), np.zeros(a.shape)
    else:
        gap = resample.misses(name, a, b)
        with np.errstate(invalid="ignore"):
            allowed = np.where(np.isfinite(a), atol + rtol * np.abs(a), atol)
    beyond = gap > allowed
    worst = np.argmax(np.where(beyond, gap, -1.0) if beyond.any() else gap)
    index = tuple(int(i) for i in np.unravel_index(worst, gap.shape))
    largest = float(gap[index])
    found = Difference(quantity, unit, largest, float(allowed[index]), int(beyond.sum()), a.size)
    if largest == 0:
        return found
    values = (plain(a[index]), plain(b[index]))
    return replace(found, row=index[0], component=component_name(name, index[1:]), a=values[0], b=values[1])


def drawn_difference(quantity: str, a: Drawn, b: Drawn, tolerances: tuple[float | None, float]) -> Difference:
    """The difference of two columns of the picture: (steps, Arrow column) each. Structure and whole numbers count
    exactly, float32 to 1e-5, float64 to 1e-9 of the largest value.
    """
    (steps_a, values_a), (steps_b, values_b) = a, b
    flat_a, structure_a, owner = flattened(values_a)
    flat_b, structure_b, _ = flattened(values_b)
    same = len(structure_a) == len(structure_b) and all(map(np.array_equal, structure_a, structure_b))
    if not np.array_equal(steps_a, steps_b) or not same or flat_a.shape != flat_b.shape or flat_a.dtype != flat_b.dtype:
        said = (f"{len(steps_a)} rows, {len(flat_a)} values", f"{len(steps_b)} rows, {len(flat_b)} values")
        said = said if said[0] != said[1] else ("other rows", "other rows")
        return Difference(quantity, "", math.inf, 0.0, 1, len(flat_a), a=said[0], b=said[1])
    atol, rtol = tolerances
    if flat_a.dtype.kind == "f" and atol is None:
        largest = float(np.nanmax(np.abs(flat_a), initial=0.0))
        part = FLOAT32 if flat_a.dtype == np.float32 else RELATIVE
        atol = max(part * largest, 1e-12)
    if flat_a.dtype.kind == "f":
        flat_a, flat_b = flat_a.astype(float), flat_b.astype(float)
    name = quantity.rpartition(":")[2]
    width = 4 if name.startswith("quaternion") and flat_a.size % 4 == 0 else 1
    shape = (-1, width) if width > 1 else (-1,)
    found = difference(quantity, flat_a.reshape(shape), flat_b.reshape(shape), atol or 0.0, rtol)
    if found.row < 0:
        return found
    row = int(owner[found.row * width]) if len(owner) else 0
    return replace(found, row=int(steps_a[row]), component="")


def flattened(column: pa.Array) -> tuple[np.ndarray, list[np.ndarray], np.ndarray]:
    """An Arrow column as flat values, the lengths of its lists level by level, and the row of each value."""
    structure: list[np.ndarray] = []
    owner = np.arange(len(column))
    while is_component(column.type) or pa.types.is_fixed_size_list(column.type):
        if is_component(column.type):
            lengths = np.asarray(column.value_lengths().fill_null(0))
            structure.append(lengths)
        else:
            lengths = np.full(len(column), column.type.list_size)
        owner = np.repeat(owner, lengths)
        column = column.flatten()
    if pa.types.is_integer(column.type) or pa.types.is_floating(column.type) or pa.types.is_boolean(column.type):
        return column.to_numpy(zero_copy_only=False), structure, owner
    return np.array([repr(value) for value in column.to_pylist()]), structure, owner
