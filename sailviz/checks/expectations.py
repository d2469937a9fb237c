"""Judging a run by what its scene expects of it, block by block."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, fields, replace
from typing import Any

import numpy as np

from sailviz.checks.closed_forms import FORMS, Motion, error
from sailviz.elements import elements
from sailviz.run.arrays import Attitude, AttitudeEnsemble, Event, Run, Thrust
from sailviz.run.quantities import arc, circular_mean, unwrapped
from sailviz.scene.loading import Scene
from sailviz.scene.quantities import Quantity, of_ensemble, spellings
from sailviz.scene.sections import STATISTICS_OF_ROWS, Expectation


@dataclass(frozen=True)
class Verdict:
    """One expectation and what came of it; value and tolerance in the quantity's unit, measured NaN if it never
    came. turn : what an angle that counts modulo a turn is counted by, infinite for everything else."""

    quantity: str
    at: str
    expected: float
    tolerance: float
    measured: float
    turn: float = np.inf

    @property
    def off(self) -> float:
        """Measured less expected, for an angle along the shortest arc."""
        return float(arc(self.measured, self.expected, self.turn))

    @property
    def passed(self) -> bool:
        """Whether the measured value lies within the tolerance."""
        return bool(abs(self.off) <= self.tolerance)

    @property
    def miss(self) -> str:
        """How far the measured value is from the expected one, in words."""
        if np.isnan(self.measured):
            if self.at == "mean" and np.isfinite(self.turn):
                return "it goes all round or is never a number: no mean"
            if self.at == "drift" and not np.isfinite(self.turn):
                return "it starts at 0 or is never a number: no relative drift"
            return "it is never a number" if self.at in STATISTICS_OF_ROWS else "this moment never came"
        return f"off by {self.off:+.2g}"

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


class Reckoning:
    """One expectation on its way through the blocks of a run."""

    def __init__(self, item: Expectation):
        self.item = item
        self.quantity = spellings()[item.quantity]
        self.found = float("nan")
        self._first = float("nan")  # value of the first row, for the drift
        self._last = float("nan")  # of the last row so far, for the mean and for times between blocks
        self._area = 0.0  # integral over time so far, for the mean
        self._vector = np.zeros(2)  # the same of (cosine, sine) of an angle that counts modulo a turn

    @property
    def turn(self) -> float:
        """After which the value is the same again, infinite if never."""
        return self.quantity.turn

    def add(self, block: Block) -> None:
        """Look at the next block of the run."""
        if self.item.ensemble is not None:
            if block.begins:
                self._look_at_ensemble(block.run)
            return
        WAYS[self._way()](self, block)

    def _way(self) -> str:
        """How the block is looked at: by a statistic of all rows, at a time, or at an event."""
        if self.item.at_time is not None:
            return "at_time"
        return self.item.at if self.item.at in STATISTICS_OF_ROWS and self.item.at is not None else "event"

    def _look_at_ensemble(self, run: Run) -> None:
        for turned in run.setting.attitude_ensembles:
            if turned.name == self.item.ensemble:
                self.found = of_attitude_ensemble(turned, self.quantity, self.item)
        for ensemble in run.setting.ensembles:
            if ensemble.name == self.item.ensemble and self.item.statistic is not None:
                self.found = of_ensemble(ensemble, self.quantity, self.item.statistic)

    def start(self, block: Block) -> None:
        """The first row."""
        self._first_known(block.values(self)[0])

    def end(self, block: Block) -> None:
        """The last row that is a number."""
        value = block.values(self)[-1]
        self.found = self.found if np.isnan(value) else float(value)

    def min(self, block: Block) -> None:
        """The smallest of all rows."""
        self.found = float(np.fmin(self.found, np.fmin.reduce(block.values(self))))

    def max(self, block: Block) -> None:
        """The largest of all rows."""
        self.found = float(np.fmax(self.found, np.fmax.reduce(block.values(self))))

    def drift(self, block: Block) -> None:
        """The largest relative distance from the first row; of an angle on a circle the largest arc, in its unit."""
        values, turn = block.values(self), self.turn
        self._first = first = float(values[0]) if block.begins else self._first
        if np.isfinite(turn):
            if np.isfinite(first):
                away = np.abs(arc(values, first, turn))
                self.found = float(np.fmax(self.found, np.nanmax(away, initial=0.0)))
        elif first != 0 and np.isfinite(first):
            self.found = float(np.fmax(self.found, np.nanmax(np.abs(values / first - 1), initial=0.0)))

    def mean(self, block: Block) -> None:
        """The mean over time, by trapezoids; of an angle on a circle the direction of its mean unit vector."""
        time, values = self._with_last_row(block)
        span = time[-1] - block.start
        if np.isfinite(self.turn):
            angle = 2 * np.pi * values / self.turn
            vectors = np.stack([np.cos(angle), np.sin(angle)])
            self._vector += np.trapezoid(vectors, time, axis=1)
            cosine, sine = self._vector / span if span > 0 else vectors[:, -1]
            self.found = circular_mean(float(cosine), float(sine), self.turn)
            return
        self._area += float(np.trapezoid(values, time))
        self.found = self._area / span if span > 0 else float(values[-1])

    def at_time(self, block: Block) -> None:
        """The value at a time, by straight lines between the rows, those of two blocks included; of an angle on a
        circle along the shortest arc."""
        time, values = self._with_last_row(block)
        moment = self.item.at_time or 0.0
        if time[0] <= moment <= time[-1]:
            value = float(np.interp(moment, time, unwrapped(values, self.turn)))
            self._first_known(value % self.turn if np.isfinite(self.turn) else value)

    def event(self, block: Block) -> None:
        """At the first event of the name."""
        for event in block.run.events:
            if event.name == self.item.at:
                self._first_known(block.values(self, _row_at(block.run, event))[0])
                return

    def _first_known(self, value: float) -> None:
        """Of several values the first that is a number counts."""
        if np.isnan(self.found):
            self.found = float(value)

    def _with_last_row(self, block: Block) -> tuple[np.ndarray, np.ndarray]:
        """Times and values of the block, the last row of the block before included."""
        time, values = block.run.time, block.values(self)
        if not block.begins:
            time, values = np.append(block.end_before, time), np.append(self._last, values)
        self._last = float(values[-1])
        return time, values


WAYS: dict[str, Callable[[Reckoning, Block], None]] = {
    "start": Reckoning.start,
    "end": Reckoning.end,
    "min": Reckoning.min,
    "max": Reckoning.max,
    "mean": Reckoning.mean,
    "drift": Reckoning.drift,
    "at_time": Reckoning.at_time,
    "event": Reckoning.event,
}


@dataclass(frozen=True)
class Block:
    """Consecutive rows of a run, and what came before them."""

    run: Run
    begins: bool  # the run begins with it
    start: float  # s, of the run's first row
    end_before: float  # s, of the last row before the block
    longitude_before: float  # rad, of that row, unwrapped
    motions: dict[str, Motion]  # closed forms from the first row

    def values(self, asked: Reckoning, run: Run | None = None) -> np.ndarray:
        """What is asked for in each row of the block, or of a run in its place; in the unit asked for."""
        run = self.run if run is None else run
        if asked.item.closed_form is not None:
            return error(self.motions[asked.item.closed_form], self.start, run)
        if asked.quantity.stem == "longitude":
            return self.longitude(run) / asked.quantity.factor
        if asked.item.device is not None:
            run = replace(run, thrust=run.devices[asked.item.device])
        return asked.quantity.of(run)

    def longitude(self, run: Run) -> np.ndarray:
        """Unwrapped over the blocks, rad."""
        longitude = spellings()["longitude_rad"].of(run)
        turns: np.ndarray = np.round((self.longitude_before - longitude[0]) / (2 * np.pi))
        return longitude + 2 * np.pi * turns


class Judge:
    """Takes the blocks of a run as they come; `verdicts` at the end."""

    def __init__(self, scene: Scene):
        self._reckonings = [Reckoning(item) for item in scene.expect]
        self._start: float | None = None  # s
        self._end = 0.0  # time of the last row so far, s
        self._longitude = 0.0  # of that row, unwrapped
        self._motions: dict[str, Motion] = {}  # closed forms from the first row

    def add(self, run: Run) -> None:
        """Look at the next block."""
        begins = self._start is None
        if self._start is None:
            self._start = float(run.time[0])
            forms = {one.item.closed_form for one in self._reckonings}
            self._motions = {name: FORMS[name](run) for name in forms if name}
        block = Block(run, begins, self._start, self._end, self._longitude, self._motions)
        for one in self._reckonings:
            one.add(block)
        self._longitude = float(block.longitude(run)[-1])
        self._end = float(run.time[-1])

    def verdicts(self) -> list[Verdict]:
        """What came of each expectation, in the order of the scene."""
        return [
            Verdict(
                _name(one.item),
                one.item.at if one.item.at is not None else f"t = {one.item.at_time:.10g} s",
                one.item.value,
                _tolerance(one.item),
                one.found,
                one.turn,
            )
            for one in self._reckonings
        ]


def _tolerance(item: Expectation) -> float:
    """In the quantity's unit."""
    if item.within is not None:
        return item.within
    return abs(item.value) * (item.within_percent or 0.0) / 100


def _name(item: Expectation) -> str:
    """What is expected, in words."""
    if item.closed_form is not None:
        return f"error against {item.closed_form}"
    if item.device is not None:
        return f"{item.quantity} of {item.device}"
    return item.quantity if item.ensemble is None else f"{item.quantity}, {item.statistic} of {item.ensemble}"


def _row_at(run: Run, event: Event) -> Run:
    """A Run of one row, the state at an event; attitude and thrust are those of the nearest row."""
    nearest = [int(np.argmin(np.abs(run.time - event.time)))]
    position, velocity = event.state[None, :3], event.state[None, 3:6]

    def row(part: Any) -> Any:
        if isinstance(part, dict):
            return {name: values[nearest] for name, values in part.items()}
        values = [getattr(part, f.name) for f in fields(part)]
        return type(part)(*(row(value) if isinstance(value, dict) else value[nearest] for value in values))

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
        devices={name: row(device) for name, device in run.devices.items()},
        elements=elements(position, velocity, run.setting.body.mu),
        environment={name: values[nearest] for name, values in run.environment.items()},
        film={name: values[nearest] for name, values in run.film.items()},
        bodies={},
        events=(),
    )


def check(scene: Scene, run: Run) -> list[Verdict]:
    """Verdicts of a scene's [[expect]] blocks on a whole run."""
    judge = Judge(scene)
    judge.add(run)
    return judge.verdicts()


def of_attitude_ensemble(ensemble: AttitudeEnsemble, quantity: Quantity, item: Expectation) -> float:
    """A statistic over the flights of a craft that turns, of what each has at a moment, in the quantity's unit: "mean",
    "miss" (mean less the scene's own flight's), "deviation" or "percentile"; of "share" that of the flights which meet
    the event. NaN where a flight has no value."""
    if quantity.stem == "share":
        return float(ensemble.share(str(item.at))[-1])
    values = ensemble.values.get(f"{quantity.stem}@{item.at}", np.full(ensemble.flights + 1, np.nan)) / quantity.factor
    flights, nominal = values[:-1], values[-1]
    if item.statistic == "percentile":
        return float(np.percentile(flights, item.percent or 0.0))
    found = {"mean": flights.mean(), "miss": flights.mean() - nominal, "deviation": flights.std(ddof=1)}
    return float(found[item.statistic or "mean"])
