"""Judging a run by what its scene expects of it, block by block."""

from __future__ import annotations

from dataclasses import dataclass, fields, replace

import numpy as np

from sailviz.checks.closed_forms import FORMS, error
from sailviz.elements import elements
from sailviz.run.arrays import Attitude, Run, Thrust
from sailviz.scene.loading import Expectation, Scene
from sailviz.scene.quantities import of_ensemble, spellings


@dataclass(frozen=True)
class Verdict:
    """One expectation and what came of it; value and tolerance in the quantity's unit, measured NaN if it never
    came."""

    quantity: str
    at: str
    expected: float
    tolerance: float
    measured: float

    @property
    def passed(self) -> bool:
        """Whether the measured value lies within the tolerance."""
        return bool(abs(self.measured - self.expected) <= self.tolerance)

    @property
    def miss(self) -> str:
        """How far the measured value is from the expected one, in words."""
        if np.isnan(self.measured):
            if self.at == "drift":
                return "it starts at 0 or is never a number: no relative drift"
            extreme = self.at in ("start", "end", "min", "max", "mean")
            return "it is never a number" if extreme else "this moment never came"
        return f"off by {self.measured - self.expected:+.2g}"

    def __str__(self) -> str:
        sign = "ok  " if self.passed else "FAIL"
        if np.isnan(self.measured):
            return f"{sign} {self.quantity} at {self.at}: expected {self.expected:.10g}, but {self.miss}"
        return (
            f"{sign} {self.quantity} at {self.at}: {self.measured:.10g}, expected {self.expected:.10g} "
            f"within {self.tolerance:.3g} ({self.miss})"
        )


def table(verdicts: list[Verdict]) -> str:
    """Verdicts under each other: quantity, where, what was measured and expected, how much it may be off and is."""
    rows = [("", "quantity", "at", "measured", "expected", "within", "")]
    for v in verdicts:
        measured = "" if np.isnan(v.measured) else f"{v.measured:.10g}"
        sign = "ok" if v.passed else "FAIL"
        rows.append((sign, v.quantity, v.at, measured, f"{v.expected:.10g}", f"{v.tolerance:.3g}", v.miss))
    widths = [max(len(row[i]) for row in rows) for i in range(len(rows[0]))]
    numbers = {3, 4, 5}
    return "\n".join(
        "  ".join(
            cell.rjust(width) if i in numbers else cell.ljust(width)
            for i, (cell, width) in enumerate(zip(row, widths, strict=True))
        ).rstrip()
        for row in rows
    )


class Judge:
    """Takes the blocks of a run as they come; `verdicts` at the end."""

    def __init__(self, scene: Scene):
        self._expected = scene.expect
        self._quantities = [spellings()[item.quantity] for item in scene.expect]
        self._found = [np.nan] * len(scene.expect)
        self._first = [np.nan] * len(scene.expect)  # value of the first row, for the drift
        self._last = [np.nan] * len(scene.expect)  # of the last row so far, for the mean and for times between blocks
        self._areas = [0.0] * len(scene.expect)  # integral over time so far, for the mean
        self._start: float | None = None  # s
        self._end = 0.0  # time of the last row so far, s
        self._motions: dict = {}  # closed forms from the first row
        self._longitude = 0.0  # of the last row so far, unwrapped

    def add(self, run: Run) -> None:
        """Look at the next block."""
        begins = self._start is None
        if begins:
            self._start = float(run.time[0])
            names = {item.closed_form for item in self._expected if item.closed_form}
            self._motions = {name: FORMS[name](run) for name in names}
            ensembles = {ensemble.name: ensemble for ensemble in run.setting.ensembles}
            for i, (item, quantity) in enumerate(zip(self._expected, self._quantities, strict=True)):
                if item.ensemble in ensembles:
                    self._found[i] = of_ensemble(ensembles[item.ensemble], quantity, item.statistic)
        for i, (item, quantity) in enumerate(zip(self._expected, self._quantities, strict=True)):
            if item.ensemble is not None:
                continue
            if item.at in ("mean", "drift"):
                self._gather(i, item, self._column(item, quantity, run), run, begins)
                continue
            if item.at_time is not None:
                value = self._at_time(i, item, self._column(item, quantity, run), run, begins)
            else:
                value = self._value(item, quantity, run)
            if value is None or np.isnan(value):
                continue
            old = self._found[i]
            if item.at == "min":
                value = np.fmin(old, value)
            elif item.at == "max":
                value = np.fmax(old, value)
            elif item.at != "end" and not np.isnan(old):
                continue  # start, a time or the first event of this name: the first value counts
            self._found[i] = float(value)
        self._longitude = float(self._unwrapped(run)[-1])
        self._end = float(run.time[-1])

    def verdicts(self) -> list[Verdict]:
        """What came of each expectation, in the order of the scene."""
        return [
            Verdict(
                _name(item),
                item.at if item.at is not None else f"t = {item.at_time:.10g} s",
                item.value,
                item.within if item.within is not None else abs(item.value) * item.within_percent / 100,
                found,
            )
            for item, found in zip(self._expected, self._found, strict=True)
        ]

    def _gather(self, i: int, item: Expectation, values, run: Run, begins: bool) -> None:
        """Carry a mean over time (trapezoids) or the largest drift on over a block."""
        if item.at == "drift":
            self._first[i] = first = values[0] if begins else self._first[i]
            if first != 0 and np.isfinite(first):
                self._found[i] = float(np.fmax(self._found[i], np.nanmax(np.abs(values / first - 1), initial=0.0)))
            return
        time = run.time
        if not begins:  # from the last row of the block before
            time, values = np.append(self._end, time), np.append(self._last[i], values)
        self._areas[i] += float(np.trapezoid(values, time))
        self._last[i] = values[-1]
        span = time[-1] - self._start
        self._found[i] = self._areas[i] / span if span > 0 else float(values[-1])

    def _at_time(self, i: int, item: Expectation, values, run: Run, begins: bool):
        """The value at a time, by straight lines between the rows, those of two blocks included; None outside."""
        time = run.time
        if not begins:
            time, values = np.append(self._end, time), np.append(self._last[i], values)
        self._last[i] = values[-1]
        return np.interp(item.at_time, time, values) if time[0] <= item.at_time <= time[-1] else None

    def _unwrapped(self, run: Run):
        longitude = spellings()["longitude_rad"].of(run)
        return longitude + 2 * np.pi * np.round((self._longitude - longitude[0]) / (2 * np.pi))

    def _value(self, item: Expectation, quantity, run: Run):
        if item.at in ("start", "end", "min", "max"):
            values = self._column(item, quantity, run)
            pick = {"start": lambda v: v[0], "end": lambda v: v[-1], "min": np.nanmin, "max": np.nanmax}[item.at]
            return None if np.isnan(values).all() else pick(values)
        for event in run.events:
            if event.name == item.at:
                return self._column(item, quantity, _row_at(run, event))[0]
        return None

    def _column(self, item: Expectation, quantity, run: Run):
        if item.closed_form is not None:
            return error(self._motions[item.closed_form], self._start, run)
        if quantity.stem == "longitude":
            return self._unwrapped(run) / quantity.factor
        return quantity.of(run)


def _name(item: Expectation) -> str:
    """What is expected, in words."""
    if item.closed_form is not None:
        return f"error against {item.closed_form}"
    return item.quantity if item.ensemble is None else f"{item.quantity}, {item.statistic} of {item.ensemble}"


def _row_at(run: Run, event) -> Run:
    """A Run of one row, the state at an event; attitude and thrust are those of the nearest row."""
    nearest = [int(np.argmin(np.abs(run.time - event.time)))]
    position, velocity = event.state[None, :3], event.state[None, 3:6]

    def row(part):
        return type(part)(*(getattr(part, f.name)[nearest] for f in fields(part)))

    attitude: Attitude = row(run.attitude)
    thrust: Thrust = row(run.thrust)
    return replace(
        run,
        time=np.array([event.time]),
        position=position,
        velocity=velocity,
        mass=event.state[6:7],
        attitude=attitude,
        thrust=thrust,
        elements=elements(position, velocity, run.setting.body.mu),
        environment={name: values[nearest] for name, values in run.environment.items()},
        bodies={},
        events=(),
    )


def check(scene: Scene, run: Run) -> list[Verdict]:
    """Verdicts of a scene's [[expect]] blocks on a whole run."""
    judge = Judge(scene)
    judge.add(run)
    return judge.verdicts()
