"""What a fastest flight from a planet to another must satisfy, both where they are at their dates.

Necessary conditions (re-derived): costates as in `state_costate`; at arrival position and velocity are the planet's,
seven equations with |lam| = 1 for six costates and the flight time. The craft departs with the origin's own velocity
and the planets' pull is neglected.

Search: the fastest flight to the planet's orbit, wherever the planet, from the place of the date; then the planet is
moved along its orbit, both ways, from where that flight arrives to where it is.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from sailviz import ephemeris
from sailviz.constants import AU, MU_SUN
from sailviz.design.minimum_time import costates
from sailviz.design.minimum_time.kepler_orbit import KeplerOrbit
from sailviz.design.minimum_time.orbit_conditions import OrbitProblem, PlanarGuess
from sailviz.design.minimum_time.orbits import target_radius
from sailviz.design.minimum_time.state_costate import (
    COSTATES,
    POSITION,
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
    off_unit_length,
    solved,
)
from sailviz.elements import elements

SOLVED = 1e-9  # largest miss of a solution, au and 29.78 km/s
SMALLEST_SHIFT = 0.01  # of the way that the planet is moved
SPREAD = 3000.0  # s between positions that are differenced: rounding 1e-12, neglected terms 1e-14 of the speed


def planet_state(
    name: str, epoch: np.datetime64, time: npt.ArrayLike, source: str = "mean-elements"
) -> tuple[np.ndarray, np.ndarray]:
    """Heliocentric position m and velocity m/s, each (n, 3), ecliptic of J2000, at times (n,) s after the epoch.

    The velocity is the difference quotient of fourth order of `ephemeris.planet_position`, so that both belong
    together.
    """
    time = np.atleast_1d(np.asarray(time, dtype=float))
    far_before, before, here, after, far_after = (
        ephemeris.planet_position(name, epoch, time + k * SPREAD, source) for k in (-2, -1, 0, 1, 2)
    )
    return here, (far_before - 8 * before + 8 * after - far_after) / (12 * SPREAD)


@dataclass(frozen=True)
class Meeting:
    """Fastest flight of a sail from a planet to another; the departure of its Unknowns is in s after the epoch."""

    origin: str
    target: str
    epoch: np.datetime64
    sail: Sail
    source: str

    @property
    def smoothing(self) -> float:
        """With which an E-sail's switch is rounded off on the way."""
        return SMOOTHING if self.sail.rounds_off else 0.0

    def state(self, name: str, time: npt.ArrayLike) -> np.ndarray:
        """(n, 6) of a planet in units of au and mu = 1 at times in s after the epoch."""
        r, v = planet_state(name, self.epoch, time, self.source)
        return np.hstack([r / AU, v / SPEED_UNIT])

    def orbit(self, name: str, time: float) -> KeplerOrbit:
        """The orbit that osculates a planet's motion: it passes through its place at a time in s after the epoch."""
        (y,) = self.state(name, time)
        return KeplerOrbit.from_elements(elements(y[POSITION] * AU, y[VELOCITY] * SPEED_UNIT, MU_SUN))

    def start(self, unknowns: Unknowns) -> np.ndarray:
        """State and costates (12,) at departure."""
        (state,) = self.state(self.origin, unknowns.departure)
        return np.concatenate([state, unknowns.costates])

    def search(
        self, unknowns: Unknowns, smoothing: float = 0.0, tolerance: float = LOOSE, shift: float = 0.0
    ) -> tuple[Unknowns, float]:
        """The solution near some unknowns, the planet ahead by a shift in s, and its residual."""
        start = self.start(unknowns)[STATE]

        def residuals(batch: np.ndarray) -> np.ndarray:
            begin, spans = columns(batch)
            starts = np.hstack([np.broadcast_to(start, (len(batch), len(start))), begin])
            ends = costates.fly_all(starts, spans, self.sail, tolerance=tolerance, smoothing=smoothing)
            there = self.state(self.target, unknowns.departure + shift + spans * TIME_UNIT)
            return np.hstack([ends[:, STATE] - there, off_unit_length(begin)])

        return solved(residuals, unknowns, tolerance)

    def sharpen(self, unknowns: Unknowns) -> Unknowns | None:
        """The solution of the true sail to rounding, or None."""
        x = unknowns
        for eps in SHARPER if self.sail.rounds_off else (0.0,):
            x, residual = self.search(x, eps)
            if residual > NEAR:
                return None
        x, residual = self.search(x, 0.0, TIGHT)
        return x if residual <= SOLVED else None

    def fresh(self, departure: float, planar: PlanarGuess) -> list[Unknowns]:
        """Solutions for a departure in s after the epoch, from nothing; sorted by flight time."""
        origin, target = self.orbit(self.origin, departure), self.orbit(self.target, departure)
        problem = OrbitProblem(origin, target, self.sail)
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
        """Time in s, within one period, after which the planet comes to the direction of a place."""
        times = arrival + np.linspace(0, period, 721)
        places = self.state(self.target, times)[:, POSITION]
        cosine = places @ place / np.linalg.norm(places, axis=1)
        i = int(np.clip(np.argmax(cosine), 1, len(times) - 2))
        left, here, right = cosine[i - 1 : i + 2]
        return float(times[i] - arrival + 0.5 * (left - right) / (left - 2 * here + right) * (times[1] - times[0]))

    def _moved(self, unknowns: Unknowns, shift: float) -> Unknowns | None:
        """The true solution that a flight becomes as the planet moves to its place from a shift in s, or None."""
        x, residual = self.search(unknowns, self.smoothing, shift=shift)
        if residual > NEAR:
            return None
        share, step, before, at = 0.0, 0.1, None, 0.0
        while share < 1.0:
            following = min(1.0, share + step)
            guess = x if before is None else x.ahead(before, following - share, share - at)
            y, residual = self.search(guess, self.smoothing, shift=shift * (1 - following))
            if residual > NEAR:
                step *= 0.4
                if step < SMALLEST_SHIFT:
                    return None
                continue
            before, at, x, share = x, share, y, following
            step *= 1.5
        return self.sharpen(x)

    def _later(self, unknowns: Unknowns, departure: float) -> Unknowns:
        """Unknowns for another departure that mean to arrive at the same time: the costates where the flight then is,
        or, for an earlier one, would have been."""
        wait = (departure - unknowns.departure) / TIME_UNIT
        mirror = np.repeat([1.0, np.sign(wait), np.sign(wait), 1.0], 3) if wait else 1.0  # time runs backwards
        y = costates.propagate(self.start(unknowns) * mirror, abs(wait), self.sail, tolerance=LOOSE).end * mirror
        lam = y[COSTATES] / np.linalg.norm(y[COSTATES])
        return Unknowns(lam, max(unknowns.span - wait, 0.5 * unknowns.span), departure)

    def carried(self, unknowns: Unknowns, departure: float, halvings: int = 4) -> Unknowns | None:
        """The true solution for another departure in s after the epoch, from one nearby, or None: in one step, or in
        halves of halves."""
        same = Unknowns(unknowns.costates, unknowns.span, departure)
        for guess in (self._later(unknowns, departure), same):
            for smoothing in sorted({0.0, self.smoothing}):
                y, residual = self.search(guess, smoothing)
                if residual <= NEAR:
                    true = self.sharpen(y)
                    if true is not None:
                        return true
        if halvings == 0:
            return None
        middle = self.carried(unknowns, 0.5 * (unknowns.departure + departure), halvings - 1)
        return None if middle is None else self.carried(middle, departure, halvings - 1)
