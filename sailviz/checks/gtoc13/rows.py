"""Rows of a GTOC13 solution in SI, and what is found about them."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sailviz.checks.gtoc13 import rules
from sailviz.checks.gtoc13.rules import Finding
from sailviz.exchange.gtoc13 import Solution

Floats = NDArray[np.float64]


class States(NamedTuple):
    """time (n,) s, position (n, 3) m, velocity (n, 3) m/s; outward (n,) : r.v, negative on the way in."""

    time: Floats
    position: Floats
    velocity: Floats
    outward: Floats

    @property
    def both(self) -> Floats:
        """(n, 6)"""
        return np.hstack([self.position, self.velocity])


def states_of(given: Solution) -> States:
    """The rows in SI."""
    position, velocity = given.position * 1e3, given.velocity * 1e3
    return States(given.time, position, velocity, np.sum(position * velocity, axis=1))


class Findings:
    """Collects what is found, each with the row of the file at which it is."""

    def __init__(self, given: Solution):
        self._given = given
        self._violations: list[Finding] = []
        self._notes: list[Finding] = []

    def violation(self, row: int, name: str, size: float, limit: float | None, unit: str, words: str) -> None:
        """A rule that is broken at a row (index)."""
        self._violations.append(self._made(row, name, size, limit, unit, words))

    def note(self, row: int, name: str, size: float, limit: float | None, unit: str, words: str) -> None:
        """Something worth knowing that breaks no rule."""
        self._notes.append(self._made(row, name, size, limit, unit, words))

    def ordered(self, notes: bool = False) -> tuple[Finding, ...]:
        """Violations, or notes, in the order of the rows."""
        return tuple(sorted(self._notes if notes else self._violations, key=lambda finding: finding.row))

    def same_state(self, before: int, after: int, name: str) -> None:
        """Two rows (indices) of one moment say the same, to the digits that were printed."""
        self._same_place(before, after, name)
        apart = float(np.linalg.norm(self._given.velocity[after] - self._given.velocity[before]))
        self._compare(after, name, apart, rules.JOINT_SPEED / 1e3, 0.0, "km/s", "the velocities of both rows differ")

    def same_place(self, before: int, after: int, name: str) -> None:
        """Likewise but for the velocity."""
        self._same_place(before, after, name)

    def _same_place(self, before: int, after: int, name: str) -> None:
        given = self._given
        pause = float(abs(given.time[after] - given.time[before]))
        digit = float(np.spacing(abs(given.time[after])))
        self._compare(after, name, pause, rules.JOINT_TIME, digit, "s", "the times of both rows differ")
        apart = float(np.linalg.norm(given.position[after] - given.position[before]))
        digit = 2 * float(np.spacing(np.abs(given.position[after]).max()))  # a number of 17 digits has no finer ones
        words = "the places of both rows differ"
        self._compare(after, name, apart, rules.JOINT_PLACE / 1e3, digit, "km", words)

    def _compare(self, row: int, name: str, size: float, limit: float, digit: float, unit: str, words: str) -> None:
        if size > max(limit, digit):
            self.violation(row, name, size, limit, unit, words)
        elif size > 0.0:
            self.note(row, name, size, limit, unit, words)

    def _made(self, row: int, name: str, size: float, limit: float | None, unit: str, words: str) -> Finding:
        return Finding(row + 1, int(self._given.lines[row]), name, float(size), limit, unit, words)
