"""Judging a run by what its scene expects of it, block by block."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sailviz.quantities import spellings
from sailviz.run import Attitude, Run, Thrust
from sailviz.scene import Expectation, Scene


@dataclass(frozen=True)
class Verdict:
    """One expectation and what came of it; value and tolerance in the quantity's unit, measured NaN if it never came."""

    quantity: str
    at: str
    expected: float
    tolerance: float
    measured: float

    @property
    def passed(self) -> bool:
        """Whether the measured value lies within the tolerance."""
        return bool(abs(self.measured - self.expected) <= self.tolerance)

    def __str__(self) -> str:
        sign = "ok  " if self.passed else "FAIL"
        if np.isnan(self.measured):
            return f"{sign} {self.quantity} at {self.at}: expected {self.expected:.10g}, but this moment never came"
        return (
            f"{sign} {self.quantity} at {self.at}: {self.measured:.10g}, expected {self.expected:.10g} "
            f"within {self.tolerance:.3g} (off by {self.measured - self.expected:+.2g})"
        )


class Judge:
    """Takes the blocks of a run as they come; `verdicts` at the end."""

    def __init__(self, scene: Scene):
        self._expected = scene.expect
        self._quantities = [spellings()[item.quantity] for item in scene.expect]
        self._found = [np.nan] * len(scene.expect)
        self._longitude = 0.0  # of the last row so far, unwrapped

    def add(self, run: Run) -> None:
        """Look at the next block."""
        for i, (item, quantity) in enumerate(zip(self._expected, self._quantities, strict=True)):
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

    def verdicts(self) -> list[Verdict]:
        """What came of each expectation, in the order of the scene."""
        return [
            Verdict(
                item.quantity,
                item.at if item.at is not None else f"t = {item.at_time:.10g} s",
                item.value,
                item.within if item.within is not None else abs(item.value) * item.within_percent / 100,
                found,
            )
            for item, found in zip(self._expected, self._found, strict=True)
        ]

    def _unwrapped(self, run: Run):
        longitude = spellings()["longitude_rad"].of(run)
        return longitude + 2 * np.pi * np.round((self._longitude - longitude[0]) / (2 * np.pi))

    def _value(self, item: Expectation, quantity, run: Run):
        if item.at_time is not None:
            values = self._column(quantity, run)
            if run.time[0] <= item.at_time <= run.time[-1]:
                return np.interp(item.at_time, run.time, values)
            return None
        if item.at in ("start", "end", "min", "max"):
            values = self._column(quantity, run)
            pick = {"start": lambda v: v[0], "end": lambda v: v[-1], "min": np.nanmin, "max": np.nanmax}[item.at]
            return None if np.isnan(values).all() else pick(values)
        for event in run.events:
            if event.name == item.at:
                return self._column(quantity, _row_at(run, event))[0]
        return None

    def _column(self, quantity, run: Run):
        if quantity.stem == "longitude":
            return self._unwrapped(run) / quantity.factor
        return quantity.of(run)


def _row_at(run: Run, event) -> Run:
    """A Run of one row, the state at an event; attitude and thrust are those of the nearest row."""
    from dataclasses import fields, replace

    from sailviz.elements import elements

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
