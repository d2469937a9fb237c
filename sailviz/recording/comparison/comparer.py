"""Are two runs the same, and if not: which quantity differs, by how much, where and when?

Numbers are compared as float64 with tolerances per quantity; angles modulo a turn, quaternions up to their sign, NaN
equal to NaN in the same place. Rows are paired by time or by number; where the grids differ, the finer run is
interpolated at the rows of the coarser one, and the result says so. Events, views and the arrows of the picture count
as well.
"""

from __future__ import annotations

import math
import re
from collections import Counter
from collections.abc import Callable, Container, Iterable, Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from sailviz.errors import RecordingError
from sailviz.recording.comparison.differences import (
    COVERED,
    RELATIVE,
    Difference,
    default_tolerance,
    difference,
    drawn_difference,
)
from sailviz.recording.comparison.pairing import NONE, Pairing, within
from sailviz.recording.comparison.result import Comparison
from sailviz.recording.comparison.tables import Evidence, Source, Table, evidence
from sailviz.recording.comparison.tolerances import Tolerances
from sailviz.recording.reader import EventRow
from sailviz.run import gaps, resample
from sailviz.words import duration


def compare(
    a: Source | Evidence,
    b: Source | Evidence,
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
    return Comparer(evidence(a), evidence(b), Tolerances(atol, rtol), on, picture).result()


class Comparer:
    """One comparison, as it finds what differs."""

    def __init__(self, a: Evidence, b: Evidence, tolerances: Tolerances, on: str, picture: bool):
        self.a, self.b, self.tolerances, self.on = a, b, tolerances, on
        self.with_picture = picture
        self.quantities: list[Difference] = []
        self.faults: list[str] = []
        self.notes: list[str] = []
        self.told: set[str] = set()
        self.interpolated = False

    def result(self) -> Comparison:
        """Compare everything."""
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

    def _in_both(self, name: Any, in_a: Container[Any], in_b: Container[Any], said: str) -> bool:
        if name in in_a and name in in_b:
            return True
        self.faults.append(f"{said} is missing in {'B' if name in in_a else 'A'}")
        return False

    def _fault(self, text: str) -> None:
        if text not in self.told:
            self.told.add(text)
            self.faults.append(text)

    def _note(self, text: str) -> None:
        if text not in self.told:
            self.told.add(text)
            self.notes.append(text)

    def _gaps_of(self, side: str) -> tuple[tuple[float, float], ...]:
        return (self.a if side == "A" else self.b).gaps

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
        self._compare_epochs()
        if len(self.a.gaps) != len(self.b.gaps) or not np.allclose(self.a.gaps, self.b.gaps, rtol=RELATIVE):
            told = [gap_words(side.gaps) for side in (self.a, self.b)]
            self.faults.append(f"without data: {told[0]} in A, {told[1]} in B")
        for name, said in (("identity", "made from different scenes"), ("versions", "made by different versions")):
            if name in one and name in two and one[name] != two[name]:
                self.notes.append(f"{said}: {one[name]} and {two[name]}")
        self._note_thinned(one.get("rows"), two.get("rows"))

    def _compare_epochs(self) -> None:
        if self.a.epoch != self.b.epoch:
            told = ["none" if e.epoch is None else str(e.epoch.astype("datetime64[ms]")) for e in (self.a, self.b)]
            self.faults.append(f"epoch: {told[0]} in A, {told[1]} in B")

    def _note_thinned(self, rows_a: int | None, rows_b: int | None) -> None:
        for side, facts in (("A", self.a), ("B", self.b)):
            if facts.thinned:
                self.notes.append(f"{side} holds only some of the rows of its run: the others are not compared")
        if (self.a.thinned or self.b.thinned) and rows_a != rows_b:
            self.faults.append(f"rows: the run of A has {rows_a}, that of B {rows_b}")

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
        if (self.a.thinned or self.b.thinned) and (both := within(a, b, tolerance)) is not None:
            return Pairing(*both)
        return self._pair_by_interpolation(entity, a, b, tolerance)

    def _pair_by_interpolation(self, entity: str, a: Table, b: Table, tolerance: float) -> Pairing | None:
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
        known = times[~gaps.inside(times, self._gaps_of(finer))]
        if not len(known):
            self._fault("A and B have no time in common")
            return None
        if len(known) < len(times):
            self._note(f"{len(times) - len(known):,} rows lie where {finer} is without data: they are not compared")
        times = known
        if not self.interpolated:
            self.interpolated = True
            self.notes.append(
                f"the grids differ: {len(a):,} rows in A, {len(b):,} in B; {finer} was interpolated at {len(times):,} "
                f"times of the other, and default tolerances cover {COVERED:g} times what that adds"
            )
        return Pairing(NONE, NONE, times, finer)

    def _values(self, side: str, name: str, table: Table, pairing: Pairing) -> np.ndarray:
        values = table.columns[name]
        if pairing.times is None:
            return np.asarray(values[pairing.rows_a if side == "A" else pairing.rows_b])
        if pairing.finer == side:
            return np.asarray(resample.at(pairing.times, name, table.time, values, table.columns, self._gaps_of(side)))
        return np.asarray(values[np.searchsorted(table.time, pairing.times)])

    def _compare_column(self, entity: str, name: str, a: Table, b: Table, pairing: Pairing) -> None:
        if name == "time_s" and pairing.interpolated:  # as many rows at other times
            rows = np.arange(len(a))
            pairing = Pairing(rows, rows)
        one, two = self._values("A", name, a, pairing), self._values("B", name, b, pairing)
        if one.shape != two.shape:
            self.faults.append(f"{entity}:{name} has {components(one)} in A, {components(two)} in B")
            return
        atol, rtol = self.tolerances.of(entity, name)
        interpolation = 0.0
        if pairing.interpolated:
            table = a if pairing.finer == "A" else b
            without = self._gaps_of(pairing.finer)
            interpolation = resample.cost(name, table.time, table.columns[name], table.columns, without)
        if atol is None:
            atol = default_tolerance(name, a.columns[name])
            atol = max(atol, COVERED * interpolation) if math.isfinite(interpolation) else atol
        found = difference(f"{entity}:{name}", one, two, atol, rtol)
        if found.row >= 0:
            row = found.row
            if pairing.times is None:
                at = int(pairing.rows_a[row])
                time = float(a.time[at])
            else:
                time = float(pairing.times[row])
                at = min(int(np.searchsorted(a.time, time)), len(a) - 1)
            found = replace(found, row=int(a.step[at]), time=time)
        self.quantities.append(replace(found, interpolation=interpolation))

    def _compare_events(self) -> None:
        one, two = numbered(self.a.events), numbered(self.b.events)
        for key in dict.fromkeys([*one, *two]):
            name, number = key
            event = one.get(key) or two[key]
            which = f" (number {number + 1})" if number else ""
            said = f'event "{name}"{which} at {duration(event.time)}'
            self._in_both(key, one, two, said)
        both = [(one[key], two[key]) for key in one if key in two]
        if not both:
            return
        columns: dict[str, Callable[[EventRow], Any]] = {
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
        differences: list[Difference] = []
        lost: list[str] = []
        count = 0
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
                found = drawn_difference(
                    f"{entity}:{name}", columns[name], others[name], self.tolerances.of(entity, name)
                )
                if not found.equal:
                    if state is not None and found.row >= 0:
                        found = replace(found, time=float(np.interp(found.row, state.step, state.time)))
                    differences.append(found)
        for names, side in ((lost, "B"), (list(two), "A")):
            if names:
                self.faults.append(f"the picture of {side} lacks {', '.join(names)}")
        return tuple(differences), count


def numbered(events: Iterable[EventRow]) -> dict[tuple[str, int], EventRow]:
    """Events by name and how many of that name came before."""
    count: Counter[str] = Counter()
    found = {}
    for event in events:
        name = re.sub(r" at t = .*", "", event.name)  # the note of an interrupted run says when
        found[name, count[name]] = event
        count[name] += 1
    return found


def gap_words(spans: gaps.Gaps) -> str:
    """How much is without data, in words."""
    if not spans:
        return "nothing"
    return f"{duration(gaps.total(spans))} in {len(spans)} gap{'s' if len(spans) > 1 else ''}"


def components(values: np.ndarray) -> str:
    """How many numbers stand in a row."""
    return f"{values.shape[1]} components" if values.ndim > 1 else "1 component"
