"""Are two runs the same, and if not: which quantity differs, by how much, where and when?

Numbers are compared as float64 with tolerances per quantity; angles modulo a turn, quaternions up to their sign, NaN
equal to NaN in the same place. Rows are paired by time or by number; where the grids differ, the finer run is
interpolated at the rows of the coarser one, and the result says so. Events, views and the arrows of the picture count
as well.
"""

from __future__ import annotations

import difflib
import math
import re
from collections import Counter
from collections.abc import Mapping
from dataclasses import asdict, dataclass, replace

import numpy as np
import pyarrow as pa

from sailviz.errors import RecordingError
from sailviz.recording.comparison.tables import Evidence, Table, evidence
from sailviz.recording.reader import is_component
from sailviz.run import resample
from sailviz.scene.show import duration

RELATIVE = 1e-9  # default tolerance: this part of the column's largest value
ROUNDING = 1e-14  # and no less than this for numbers of order one: angles, directions, ratios
FLOAT32 = 1e-5  # of the picture's float32 columns: their rounding, and what a camera can tell
COVERED = 2.0  # how many times the estimated cost of interpolation a default tolerance covers
SHOWN = 8  # columns of the picture that are listed

UNITS = {
    "_m_s2": "m/s²",
    "_m_s": "m/s",
    "_kg_m3": "kg/m³",
    "_m3": "1/m³",
    "_N_m": "N/m",
    "_m": "m",
    "_s": "s",
    "_kg": "kg",
    "_rad": "rad",
    "_Pa": "Pa",
    "_V": "V",
    "_K": "K",
    "_N": "N",
}
COMPONENTS = {"quaternion": "xyzw", "acceleration_rtn_m_s2": "rtn"}


def unit_of(column: str) -> str:
    """position_m -> m; "" for a pure number."""
    return next((unit for ending, unit in UNITS.items() if column.endswith(ending)), "")


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
        return self.beyond == 0


@dataclass(frozen=True)
class Comparison:
    """The result of `compare`. `quantities` holds every quantity compared, `faults` whatever else differs, in words,
    `notes` what the reader should know, `picture` those columns of the picture that differ.
    """

    a: str
    b: str
    quantities: tuple[Difference, ...]
    faults: tuple[str, ...]
    notes: tuple[str, ...]
    picture: tuple[Difference, ...] = ()
    picture_columns: int = 0  # how many were compared

    @property
    def equal(self) -> bool:
        return not self.faults and not self.picture and all(d.equal for d in self.quantities)

    @property
    def different(self) -> tuple[Difference, ...]:
        """The quantities that differ by more than is allowed."""
        return tuple(d for d in self.quantities if not d.equal)

    def __getitem__(self, quantity: str) -> Difference:
        """The difference of one quantity: comparison["/state:position_m"]."""
        for found in (*self.quantities, *self.picture):
            if found.quantity == quantity:
                return found
        raise KeyError(f"{quantity} was not compared; {', '.join(d.quantity for d in self.quantities)} were")

    def table(self) -> str:
        """Every quantity on a line of its own, the worst place of each, aligned."""
        rows = [("", "quantity", "largest difference", "allowed", "where", "when", "A", "B")]
        rows += [_line(d) for d in (*self.quantities, *self.picture[:SHOWN])]
        widths = [max(len(row[i]) for row in rows) for i in range(len(rows[0]))]
        right = {2, 3}
        return "\n".join(
            "  ".join(
                c.rjust(w) if i in right else c.ljust(w) for i, (c, w) in enumerate(zip(row, widths, strict=True))
            ).rstrip()
            for row in rows
        )

    def verdict(self) -> str:
        """One sentence."""
        if self.equal:
            picture = f", {self.picture_columns} columns of the picture" if self.picture_columns else ""
            return f"Equal: {len(self.quantities)} quantities{picture}."
        parts = []
        if self.different:
            parts.append(f"{len(self.different)} of {len(self.quantities)} quantities")
        if self.picture:
            parts.append(f"{len(self.picture)} of {self.picture_columns} columns of the picture")
        if self.faults:
            parts.append("1 other thing" if len(self.faults) == 1 else f"{len(self.faults)} other things")
        return f"Different: {', '.join(parts)}."

    def __str__(self) -> str:
        lines = [f"A  {self.a}", f"B  {self.b}", *(f"note: {note}" for note in self.notes)]
        lines += [self.table(), *(f"DIFFERENT  {fault}" for fault in self.faults), self.verdict()]
        return "\n".join(lines)

    def to_dict(self) -> dict:
        """Everything, ready for JSON: NaN and infinity become null and "inf"."""

        def told(difference):
            return {key: _json(value) for key, value in asdict(difference).items()} | {"equal": difference.equal}

        return {
            "equal": self.equal,
            "a": self.a,
            "b": self.b,
            "quantities": [told(d) for d in self.quantities],
            "picture": {"columns": self.picture_columns, "different": [told(d) for d in self.picture]},
            "faults": list(self.faults),
            "notes": list(self.notes),
        }


def compare(
    a,
    b,
    *,
    rtol: float | Mapping[str, float] = 0.0,
    atol: float | Mapping[str, float] | None = None,
    on: str = "sim_time",
    picture: bool = True,
) -> Comparison:
    """Compare two recordings, runs, or tables written by `sailviz export --to npz`; each a path or an object.

    A value of B may differ from A's by atol + rtol |A|. Each is a number for all quantities or a mapping by name:
    "/state:position_m", "position_m" or "/state", in the quantity's unit; "" in a mapping stands for all others.
    Without an atol it is 1e-9 of the column's largest value in A, and no less than 1e-14 for angles, directions and
    ratios.
    on : "sim_time" pairs rows by time, and interpolates the finer run at the times of the coarser one where the grids
    differ; "step" pairs rows by number and never interpolates.
    picture : also compare the layout of the views and everything that is drawn, where both sides have it.
    Raises RecordingError for what cannot be read, and for a tolerance on a quantity that neither side has.
    """
    if on not in ("sim_time", "step"):
        raise RecordingError(f"rows are paired on sim_time or on step, not on {on!r}")
    a, b = evidence(a), evidence(b)
    return _Comparer(a, b, Tolerances(atol, rtol), on, picture).result()


class Tolerances:
    """Tolerances by quantity."""

    def __init__(self, atol, rtol):
        self._atol = self._by_name(atol, "atol")
        self._rtol = self._by_name(rtol, "rtol")
        self._used: set[str] = {""}

    @staticmethod
    def _by_name(given, word) -> dict[str, float]:
        if given is None:
            return {}
        named = dict(given) if isinstance(given, Mapping) else {"": given}
        for name, value in named.items():
            if not isinstance(value, int | float) or not value >= 0:
                raise RecordingError(f"{word} {name or 'for all quantities'} must be a number >= 0, not {value!r}")
        return {str(name): float(value) for name, value in named.items()}

    def of(self, entity: str, column: str) -> tuple[float | None, float]:
        """(atol, or None for the default; rtol) of a quantity."""
        return self._find(self._atol, entity, column), self._find(self._rtol, entity, column) or 0.0

    def _find(self, named, entity, column):
        for name in (f"{entity}:{column}", column, entity):
            if name in named:
                self._used.add(name)
                return named[name]
        return named.get("")

    def check_used(self, known) -> None:
        """Raise RecordingError for a name that no quantity has."""
        for name in [*self._atol, *self._rtol]:
            if name not in self._used:
                near = difflib.get_close_matches(name, known, 1, 0.4)
                hint = f"; did you mean {near[0]}?" if near else ""
                raise RecordingError(f"a tolerance is given for {name}, which neither side has{hint}")


@dataclass(frozen=True)
class Pairing:
    """How the rows of A and B belong together. rows_a, rows_b index rows that are compared as they are; otherwise
    `times` are those at which the finer side is interpolated."""

    rows_a: np.ndarray | None
    rows_b: np.ndarray | None
    times: np.ndarray | None = None
    finer: str = ""  # "A" | "B", the one that is interpolated

    @property
    def interpolated(self) -> bool:
        return self.times is not None


class _Comparer:
    def __init__(self, a: Evidence, b: Evidence, tolerances: Tolerances, on: str, picture: bool):
        self.a, self.b, self.tolerances, self.on = a, b, tolerances, on
        self.with_picture = picture
        self.quantities: list[Difference] = []
        self.faults: list[str] = []
        self.notes: list[str] = []
        self.told: set[str] = set()
        self.interpolated = False

    def result(self) -> Comparison:
        self._compare_facts()
        for entity in dict.fromkeys([*self.a.entities, *self.b.entities]):
            if self._in_both(entity, self.a.entities, self.b.entities, entity):
                self._compare_entity(entity, self.a.table(entity), self.b.table(entity))
        self._compare_events()
        self._compare_views()
        picture, count = self._compare_picture()
        self.tolerances.check_used([name for d in self.quantities for name in (d.quantity, *d.quantity.split(":"))])
        return Comparison(
            self.a.label, self.b.label, tuple(self.quantities), tuple(self.faults), tuple(self.notes), picture, count
        )

    # ------------------------------------------------------------ words
    def _in_both(self, name, in_a, in_b, said) -> bool:
        if name in in_a and name in in_b:
            return True
        self.faults.append(f"{said} is missing in {'B' if name in in_a else 'A'}")
        return False

    def _fault(self, text: str) -> None:
        if text not in self.told:
            self.told.add(text)
            self.faults.append(text)

    def _compare_facts(self) -> None:
        one, two = self.a.facts, self.b.facts
        for name, said in (("body", "central body"), ("craft_kind", "craft"), ("ended", "reason of the end")):
            if name in one and name in two and one[name] != two[name]:
                self.faults.append(f"{said}: {one[name] or 'none'!s} in A, {two[name] or 'none'!s} in B")
        if one.get("complete", True) != two.get("complete", True):
            self.faults.append(f"{'B' if one.get('complete', True) else 'A'} was interrupted or cut off")
        mu = "body_mu_m3_s2"
        if mu in one and mu in two and not math.isclose(one[mu], two[mu], rel_tol=1e-12):
            self.faults.append(f"gravitational parameter: {one[mu]:.12g} in A, {two[mu]:.12g} m³/s² in B")
        if self.a.epoch != self.b.epoch:
            told = ["none" if e.epoch is None else str(e.epoch.astype("datetime64[ms]")) for e in (self.a, self.b)]
            self.faults.append(f"epoch: {told[0]} in A, {told[1]} in B")
        if one.get("identity") != two.get("identity") and "identity" in one and "identity" in two:
            self.notes.append(f"made from different scenes: {one['identity']} and {two['identity']}")
        if one.get("versions") != two.get("versions") and "versions" in one and "versions" in two:
            self.notes.append(f"made by different versions: {one['versions']} and {two['versions']}")
        for side, facts in (("A", self.a), ("B", self.b)):
            if facts.thinned:
                self.notes.append(f"{side} holds only some of the rows of its run: the others are not compared")
        if (self.a.thinned or self.b.thinned) and one.get("rows") != two.get("rows"):
            self.faults.append(f"rows: the run of A has {one.get('rows')}, that of B {two.get('rows')}")

    # ------------------------------------------------------------ columns
    def _compare_entity(self, entity: str, a: Table, b: Table) -> None:
        if not len(a) or not len(b):
            if len(a) != len(b):
                self.faults.append(f"{entity} has no rows in {'A' if not len(a) else 'B'}")
            return
        pairing = self._pair(entity, a, b)
        if pairing is None:
            return
        for name in dict.fromkeys([*a.columns, *b.columns]):
            if self._in_both(name, a.columns, b.columns, f"{entity}:{name}"):
                if name == "time_s" and pairing.interpolated and len(a) != len(b):
                    continue  # the grids differ, as a note says
                self._compare_column(entity, name, a, b, pairing)

    def _time_tolerance(self, table: Table) -> float:
        atol, rtol = self.tolerances.of("/state", "time_s")
        largest = float(np.max(np.abs(table.time)))
        return (RELATIVE * largest if atol is None else atol) + rtol * largest

    def _pair(self, entity: str, a: Table, b: Table) -> Pairing | None:
        if self.on == "step":
            steps, rows_a, rows_b = np.intersect1d(a.step, b.step, return_indices=True)
            for side, table, thinned in (("B", a, self.b.thinned), ("A", b, self.a.thinned)):
                missing = np.setdiff1d(table.step, steps)
                if len(missing) and not thinned:
                    self._fault(f"rows: {len(missing)} are missing in {side}, the first is row {missing[0]}")
            return Pairing(rows_a, rows_b) if len(steps) else None
        tolerance = self._time_tolerance(a)
        if len(a) == len(b) and np.max(np.abs(a.time - b.time)) <= tolerance:
            rows = np.arange(len(a))
            return Pairing(rows, rows)
        if (self.a.thinned or self.b.thinned) and (rows := _within(a, b, tolerance)) is not None:
            return Pairing(*rows)
        return self._pair_by_interpolation(entity, a, b, tolerance)

    def _pair_by_interpolation(self, entity, a: Table, b: Table, tolerance) -> Pairing | None:
        for side, table in (("A", a), ("B", b)):
            if np.any(np.diff(table.time) <= 0):
                self._fault(f"{entity}: the times of {side} do not increase, so rows cannot be paired; compare on step")
                return None
        for word, one, two in (("starts", a.time[0], b.time[0]), ("ends", a.time[-1], b.time[-1])):
            if abs(one - two) > tolerance:
                off = f"{abs(one - two):.3g} s"
                self._fault(f"A {word} at {duration(float(one))}, B at {duration(float(two))}: {off} apart")
        start, end = max(a.time[0], b.time[0]), min(a.time[-1], b.time[-1])
        finer, coarse = ("B", a) if len(b) >= len(a) else ("A", b)
        times = coarse.time[(coarse.time >= start) & (coarse.time <= end)]
        if not len(times):
            self._fault("A and B have no time in common")
            return None
        if not self.interpolated:
            self.interpolated = True
            self.notes.append(
                f"the grids differ: {len(a):,} rows in A, {len(b):,} in B; {finer} was interpolated at {len(times):,} "
                f"times of the other, and default tolerances cover {COVERED:g} times what that adds"
            )
        return Pairing(None, None, times, finer)

    def _values(self, side: str, name: str, table: Table, pairing: Pairing):
        values = table.columns[name]
        if not pairing.interpolated:
            return values[pairing.rows_a if side == "A" else pairing.rows_b]
        if pairing.finer == side:
            return resample.at(pairing.times, name, table.time, values, table.columns)
        return values[np.searchsorted(table.time, pairing.times)]

    def _compare_column(self, entity: str, name: str, a: Table, b: Table, pairing: Pairing) -> None:
        if name == "time_s" and pairing.interpolated:  # as many rows at other times
            rows = np.arange(len(a))
            pairing = Pairing(rows, rows)
        one, two = self._values("A", name, a, pairing), self._values("B", name, b, pairing)
        if one.shape != two.shape:
            self.faults.append(f"{entity}:{name} has {_shape(one)} in A, {_shape(two)} in B")
            return
        atol, rtol = self.tolerances.of(entity, name)
        interpolation = 0.0
        if pairing.interpolated:
            table = a if pairing.finer == "A" else b
            interpolation = resample.cost(name, table.time, table.columns[name], table.columns)
        if atol is None:
            atol = default_tolerance(name, a.columns[name])
            atol = max(atol, COVERED * interpolation) if math.isfinite(interpolation) else atol
        found = difference(f"{entity}:{name}", one, two, atol, rtol)
        if found.row >= 0:
            row = found.row
            time = pairing.times[row] if pairing.interpolated else a.time[pairing.rows_a[row]]
            at = np.searchsorted(a.time, time) if pairing.interpolated else pairing.rows_a[row]
            found = replace(found, row=int(a.step[min(at, len(a) - 1)]), time=float(time))
        self.quantities.append(replace(found, interpolation=interpolation))

    # ------------------------------------------------------------ events, views, picture
    def _compare_events(self) -> None:
        one, two = _numbered(self.a.events), _numbered(self.b.events)
        for key in dict.fromkeys([*one, *two]):
            name, number = key
            event = one.get(key) or two[key]
            which = f" (number {number + 1})" if number else ""
            said = f'event "{name}"{which} at {duration(event.time)}'
            self._in_both(key, one, two, said)
        both = [(one[key], two[key]) for key in one if key in two]
        if not both:
            return
        columns = {
            "time_s": lambda event: event.time,
            "position_m": lambda event: event.state[:3],
            "velocity_m_s": lambda event: event.state[3:6],
            "mass_kg": lambda event: event.state[6],
        }
        for name, pick in columns.items():
            values_a, values_b = (np.array([pick(pair[side]) for pair in both], float) for side in (0, 1))
            atol, rtol = self.tolerances.of("/events", name)
            atol = default_tolerance(name, values_a) if atol is None else atol
            found = difference(f"/events:{name}", values_a, values_b, atol, rtol)
            if found.row >= 0:
                event = both[found.row][0]
                found = replace(found, row=event.step, time=event.time)
            self.quantities.append(found)

    def _compare_views(self) -> None:
        if not self.with_picture:
            return
        one, two = self.a.views, self.b.views
        if one is None and two is None:
            return
        if one is None or two is None:
            side = "A" if one is None else "B"
            if (self.a if one is None else self.b).picture is None:
                self.notes.append(f"{side} holds numbers only: views and picture are not compared")
            else:
                self.faults.append(f"the layout of the views is missing in {side}")
            return
        for lost, side in ((one - two, "B"), (two - one, "A")):
            for (kind, name, origin), count in sorted(lost.items()):
                times = f" ({count} times)" if count > 1 else ""
                self.faults.append(f'the {kind} view "{name}" of {origin} is missing in {side}{times}')

    def _compare_picture(self) -> tuple[tuple[Difference, ...], int]:
        if not self.with_picture or self.a.picture is None or self.b.picture is None:
            return (), 0
        if self.interpolated:
            self.notes.append("the picture is not compared: it is drawn on other rows")
            return (), 0
        one, two = self.a.picture(), dict(self.b.picture())
        differences, count, lost = [], 0, []
        state = self.a.table("/state") if "/state" in self.a.entities else None
        for entity, columns in one:
            if entity not in two:
                lost.append(entity)
                continue
            others = two.pop(entity)
            for name in dict.fromkeys([*columns, *others]):
                if not self._in_both(name, columns, others, f"{entity}:{name} of the picture"):
                    continue
                count += 1
                found = _drawn(f"{entity}:{name}", columns[name], others[name], self.tolerances.of(entity, name))
                if not found.equal:
                    if state is not None and found.row >= 0:
                        found = replace(found, time=float(np.interp(found.row, state.step, state.time)))
                    differences.append(found)
        for names, side in ((lost, "B"), (list(two), "A")):
            if names:
                self.faults.append(f"the picture of {side} lacks {', '.join(names)}")
        return tuple(differences), count


def default_tolerance(name: str, values) -> float:
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
        gap = resample.gaps(name, a, b)
        with np.errstate(invalid="ignore"):
            allowed = np.where(np.isfinite(a), atol + rtol * np.abs(a), atol)
    beyond = gap > allowed
    worst = np.argmax(np.where(beyond, gap, -1.0) if beyond.any() else gap)
    index = tuple(int(i) for i in np.unravel_index(worst, gap.shape))
    largest = float(gap[index])
    found = Difference(quantity, unit, largest, float(allowed[index]), int(beyond.sum()), a.size)
    if largest == 0:
        return found
    values = (_plain(a[index]), _plain(b[index]))
    return replace(found, row=index[0], component=component_name(name, index[1:]), a=values[0], b=values[1])


def _drawn(quantity: str, a, b, tolerances) -> Difference:
    """The difference of two columns of the picture: (steps, Arrow column) each. Structure and whole numbers count
    exactly, float32 to 1e-5, float64 to 1e-9 of the largest value.
    """
    (steps_a, values_a), (steps_b, values_b) = a, b
    flat_a, structure_a, owner = _flat(values_a)
    flat_b, structure_b, _ = _flat(values_b)
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


def _flat(column: pa.Array) -> tuple[np.ndarray, list[np.ndarray], np.ndarray]:
    """An Arrow column as flat values, the lengths of its lists level by level, and the row of each value."""
    structure, owner = [], np.arange(len(column))
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


def _within(a: Table, b: Table, tolerance: float):
    """(rows of A, rows of B) where every time of the shorter is one of the longer; None where it is not."""
    short, long = (a, b) if len(a) <= len(b) else (b, a)
    near = np.clip(np.searchsorted(long.time, short.time - tolerance), 0, len(long) - 1)
    if np.any(np.abs(long.time[near] - short.time) > tolerance) or len(np.unique(near)) < len(near):
        return None
    rows = np.arange(len(short))
    return (rows, near) if short is a else (near, rows)


def _numbered(events) -> dict:
    """Events by name and how many of that name came before."""
    count: Counter = Counter()
    found = {}
    for event in events:
        name = re.sub(r" at t = .*", "", event.name)  # the note of an interrupted run says when
        found[name, count[name]] = event
        count[name] += 1
    return found


def _shape(values) -> str:
    return f"{values.shape[1]} components" if values.ndim > 1 else "1 component"


def _plain(value):
    return value.item() if isinstance(value, np.generic) else value


def _json(value):
    if isinstance(value, float) and not math.isfinite(value):
        return None if math.isnan(value) else str(value)
    return value


def _line(d: Difference) -> tuple[str, ...]:
    def number(value, digits=3):
        if isinstance(value, str):
            return value if len(value) < 30 else value[:27] + "..."
        return f"{value:.{digits}g}" if isinstance(value, float) else str(value)

    mark = "ok" if d.equal else "DIFFERENT"
    unit = f" {d.unit}" if d.unit else ""
    if d.row < 0 and d.largest == 0:
        return mark, d.quantity, f"0{unit}", f"{d.allowed:.2g}{unit}", "", "", "", ""
    where = (f"row {d.row}" + (f", {d.component}" if d.component else "")) if d.row >= 0 else ""
    digits = 3
    if isinstance(d.a, float) and d.a and math.isfinite(d.largest) and d.largest:
        digits = min(17, max(3, math.ceil(math.log10(max(abs(d.a), 1e-300) / d.largest)) + 2))
    largest = "not a number" if d.largest == math.inf and d.values else number(d.largest) + unit
    if isinstance(d.a, str | bool):
        largest = "differs"
    when = duration(d.time) if math.isfinite(d.time) else ""
    values = ("", "") if d.equal else (number(d.a, digits), number(d.b, digits))
    return mark, d.quantity, largest, f"{d.allowed:.2g}{unit}", where, when, *values
