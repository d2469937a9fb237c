"""What a fastest flight from a body to another must satisfy, planets or small ones, both where they are at their dates.

Necessary conditions (re-derived): costates as in `state_costate`; at arrival position and velocity are the target's,
seven equations with |lam| = 1 for six costates and the flight time. The craft departs with the origin's own velocity
and the bodies' pull is neglected. Where the date is free, one more: with f the craft's motion and g a body's,

    lam . (f - g of the origin) at departure = lam . (f - g of the target) at arrival,

and elsewhere d time / d date = left side / right side - 1 (checked against differences). The right side is above zero
on a fastest flight, below on a slowest.

Search: the fastest flight to the target's orbit, wherever the target, from the place of the date; then the target is
moved along its orbit, both ways, from where that flight arrives to where it is.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from sailviz.constants import AU, DAY, MU_SUN
from sailviz.design.minimum_time import costates
from sailviz.design.minimum_time.effort import Effort
from sailviz.design.minimum_time.kepler_orbit import KeplerOrbit
from sailviz.design.minimum_time.moving_bodies import SPREAD, MovingBody
from sailviz.design.minimum_time.orbit_conditions import OrbitProblem, PlanarGuess
from sailviz.design.minimum_time.orbits import target_radius
from sailviz.design.minimum_time.state_costate import (
    COSTATES,
    POSITION,
    SIZE,
    SPEED_UNIT,
    STATE,
    TIME_UNIT,
    VELOCITY,
    Sail,
)
from sailviz.design.minimum_time.unknowns import (
    LOOSE,
    NEAR,
    SHARPER,
    SMOOTHING,
    TIGHT,
    Unknowns,
    columns,
    distinct,
    solved,
    with_unit_length,
)
from sailviz.elements import elements

SOLVED = 1e-9  # largest miss of a solution, au and 29.78 km/s
APART = 10 * SPREAD  # s between speeds that are differenced: moments are rounded to 1e-7 s, the rest as of SPREAD
STRAYS = 0.02  # of the flight time, from what the slope makes of it: more is another family
SHORTEST_STEP = 0.02 * DAY  # s, of the departure of a flight that is handed on: some take 60 days longer for each day
NEARBY = 15  # steps of a search that begins next to its solution
SMALLEST_SHARE = 0.01  # of the way on which a flight is followed


class Ends(NamedTuple):
    """lam . (motion of the craft - motion of the body) at departure and at arrival."""

    departure: float
    arrival: float

    @property
    def slope(self) -> float:
        """d time / d date, both in the same unit: above zero where leaving earlier is faster."""
        return self.departure / self.arrival - 1.0


@dataclass(frozen=True)
class Meeting:
    """Fastest flight of a sail from a body to another; the departure of its Unknowns is in s after the epoch."""

    origin: MovingBody
    target: MovingBody
    epoch: np.datetime64
    sail: Sail
    effort: Effort = field(default_factory=Effort, compare=False)

    @property
    def smoothing(self) -> float:
        """With which an E-sail's switch is rounded off on the way."""
        return SMOOTHING if self.sail.rounds_off else 0.0

    def state(self, body: MovingBody, time: npt.ArrayLike) -> np.ndarray:
        """(n, 6) of a body in units of au and mu = 1 at times in s after the epoch."""
        r, v = body.state(self.epoch, time)
        return np.hstack([r / AU, v / SPEED_UNIT])

    def orbit(self, body: MovingBody, time: float) -> KeplerOrbit:
        """The orbit that osculates a body's motion: it passes through its place at a time in s after the epoch."""
        (y,) = self.state(body, time)
        return KeplerOrbit.from_elements(elements(y[POSITION] * AU, y[VELOCITY] * SPEED_UNIT, MU_SUN))

    def start(self, unknowns: Unknowns) -> np.ndarray:
        """State and costates (12,) at departure."""
        (state,) = self.state(self.origin, unknowns.departure)
        return np.concatenate([state, unknowns.costates])

    def misses(self, ends: np.ndarray, there: np.ndarray) -> np.ndarray:
        """(n, 6) of what must vanish where flights end (n, 12), the target there (n, 6)."""
        return ends[:, STATE] - there

    def search(
        self,
        unknowns: Unknowns,
        smoothing: float = 0.0,
        tolerance: float = LOOSE,
        shift: float = 0.0,
        most: int | None = None,
    ) -> tuple[Unknowns, float]:
        """The solution near some unknowns, the target ahead by a shift in s, and its residual, in so many steps at
        most."""
        start = self.start(unknowns)[STATE]

        def residuals(batch: np.ndarray) -> np.ndarray:
            begin, spans = columns(batch)
            starts = np.empty((len(batch), SIZE))
            starts[:, STATE], starts[:, COSTATES] = start, begin
            ends = costates.fly_all(starts, spans, self.sail, tolerance=tolerance, smoothing=smoothing)
            there = np.empty((len(batch), len(start)))
            there[:] = self.state(self.target, unknowns.departure + shift + spans[0] * TIME_UNIT)
            for i in np.flatnonzero(spans != spans[0]).tolist():  # a derivative has one of them
                there[i] = self.state(self.target, unknowns.departure + shift + spans[i] * TIME_UNIT)
            return with_unit_length(self.misses(ends, there), begin)

        return solved(self.effort.watched(residuals), unknowns, tolerance, most)

    def motion(self, body: MovingBody, time: float) -> np.ndarray:
        """(6,) velocity and acceleration of a body in units of au and mu = 1 at a time in s after the epoch; of a
        planet as its mean elements move it, which is not quite Kepler's motion."""
        y = self.state(body, time + APART * np.arange(-2.0, 3.0))
        v = y[:, VELOCITY]
        return np.concatenate([v[2], (v[0] - 8 * v[1] + 8 * v[3] - v[4]) / (12 * APART / TIME_UNIT)])

    def ends(self, unknowns: Unknowns, tolerance: float = TIGHT) -> Ends:
        """Both sides of the condition for a free date, lam as in the unknowns."""
        start = self.start(unknowns)
        flight = costates.propagate(start, unknowns.span, self.sail, tolerance=tolerance)
        arrival = unknowns.departure + unknowns.span * TIME_UNIT
        return Ends(
            flight.hamiltonian - float(self.motion(self.origin, unknowns.departure) @ start[COSTATES]),
            flight.hamiltonian - float(self.motion(self.target, arrival) @ flight.end[COSTATES]),
        )

    def sharpen(self, unknowns: Unknowns) -> Unknowns | None:
        """The solution of the true sail to rounding, or None."""
        x = unknowns
        for eps in SHARPER if self.sail.rounds_off else (0.0,):
            x, residual = self.search(x, eps)
            if residual > NEAR:
                return None
        x, residual = self.search(x, 0.0, TIGHT)
        return x if residual <= SOLVED and self.ends(x, LOOSE).arrival > 0 else None

    def fresh(self, departure: float, planar: PlanarGuess | None) -> list[Unknowns]:
        """Solutions for a departure in s after the epoch, from a flight between circles; sorted by flight time."""
        if planar is None:
            return []
        origin, target = self.orbit(self.origin, departure), self.orbit(self.target, departure)
        problem = OrbitProblem(origin, target, self.sail, self.effort)
        (here,) = self.state(self.origin, departure)
        guess = problem.embedded(planar, origin.anomaly(here[POSITION]))
        x, residual = problem.search(guess, self.smoothing)
        if residual > NEAR or problem.hamiltonian(x) <= 0:
            x, residual, _ = problem.bend(guess, target_radius(problem), self.smoothing)
            if residual > NEAR or problem.hamiltonian(x) <= 0:
                return []
        end = costates.propagate(problem.start(x), x.span, self.sail, smoothing=self.smoothing).end
        arrival = departure + x.span * TIME_UNIT
        period = 2 * np.pi * target.semi_major_axis**1.5 * TIME_UNIT
        lead = self._time_to(end[POSITION], arrival, period)
        leaving = Unknowns(x.costates, x.span, departure)
        return distinct(self._moved(leaving, shift) for shift in (lead, lead - period))

    def _time_to(self, place: np.ndarray, arrival: float, period: float) -> float:
        """Time in s, within one period, after which the target comes to the direction of a place."""
        times = arrival + np.linspace(0, period, 721)
        places = self.state(self.target, times)[:, POSITION]
        cosine = places @ place / np.linalg.norm(places, axis=1)
        i = int(np.clip(np.argmax(cosine), 1, len(times) - 2))
        left, here, right = cosine[i - 1 : i + 2]
        return float(times[i] - arrival + 0.5 * (left - right) / (left - 2 * here + right) * (times[1] - times[0]))

    def _moved(self, unknowns: Unknowns, shift: float) -> Unknowns | None:
        """The true solution that a flight becomes as the target moves to its place from a shift in s, or None."""
        return self._along(unknowns, lambda share, x: self.search(x, self.smoothing, shift=shift * (1 - share)))

    def _along(
        self, unknowns: Unknowns, search: Callable[[float, Unknowns], tuple[Unknowns, float]]
    ) -> Unknowns | None:
        """The solution that a flight becomes along problems from share 0 to 1, the last of which is this one, or None.

        search(share, guess) -> the flight of a problem and its residual.
        """
        x, residual = search(0.0, unknowns)
        if residual > NEAR:
            return None
        share, step, before, at = 0.0, 0.1, None, 0.0
        while share < 1.0:
            following = min(1.0, share + step)
            guess = x if before is None else x.ahead(before, following - share, share - at)
            y, residual = search(following, guess)
            if residual > NEAR:
                step *= 0.4
                if step < SMALLEST_SHARE:
                    return None
                continue
            before, at, x, share = x, share, y, following
            step *= 1.5
        return self.sharpen(x)

    def _later(self, unknowns: Unknowns, departure: float, slope: float | None = None) -> Unknowns:
        """Unknowns for another departure: the costates where the flight then is, or, for an earlier one, would have
        been. slope : d time / d date, without which they mean to arrive at the same time."""
        wait = (departure - unknowns.departure) / TIME_UNIT
        mirror = np.repeat([1.0, np.sign(wait), np.sign(wait), 1.0], 3) if wait else 1.0  # time runs backwards
        y = costates.propagate(self.start(unknowns) * mirror, abs(wait), self.sail, tolerance=LOOSE).end * mirror
        lam = y[COSTATES] / np.linalg.norm(y[COSTATES])
        span = unknowns.span + wait * (-1.0 if slope is None else slope)
        return Unknowns(lam, max(span, 0.5 * unknowns.span), departure)

    def nearby(self, unknowns: Unknowns, departure: float, tolerance: float = LOOSE) -> Unknowns | None:
        """The flight for another departure near by, in s after the epoch, as good as a tolerance makes it; None where
        there is none of the same family, whose flight time goes on as its slope says."""
        slope = self.ends(unknowns, LOOSE).slope
        guess = self._later(unknowns, departure, slope)
        for smoothing in sorted({0.0, self.smoothing}):
            x, residual = self.search(guess, smoothing, tolerance if smoothing == 0.0 else LOOSE, most=NEARBY)
            if residual > NEAR:
                continue
            true = x if smoothing == 0.0 else self.sharpen(x)
            if true is not None and abs(true.span / guess.span - 1) < STRAYS and self.ends(true, LOOSE).arrival > 0:
                return true if tolerance == LOOSE or residual <= SOLVED else None
        return None

    def carried(self, unknowns: Unknowns, departure: float) -> Unknowns | None:
        """The flight of the same family, good to some 1e-7, for another departure in s after the epoch, in steps that
        adapt; None where the family ends before."""
        x, step = unknowns, departure - unknowns.departure
        while x.departure != departure:
            left = departure - x.departure
            y = self.nearby(x, departure if abs(step) >= 0.99 * abs(left) else x.departure + step)
            if y is not None:
                x, step = y, 2 * step
            elif abs(step) < SHORTEST_STEP:
                return None
            else:
                step = 0.4 * np.copysign(min(abs(step), abs(left)), left)
        return x
