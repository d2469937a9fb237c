"""What a fastest flight past a body at its date must satisfy: the body's place is reached, at any speed.

Necessary conditions (re-derived): those of a rendezvous (`planet_conditions`), but for the velocity at the end, which
is free: the primer lam_v vanishes there. With it lam . (f - g) = H - lam_r . (velocity of the body), which is above 0
on a fastest flight; the condition for a free date keeps its form.

Search: from costates that vanish so at the end of the origin's own motion and push towards the target there, over many
flight times; the target is put where such a flight comes to and moved back to its place. Flights that meet the body are
let go past it, too: the end s lam_v + (1 - s) (v - v of the body) = 0, that of a price on the speed of passage, is
followed from s = 0 to 1.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from sailviz.design.minimum_time import costates
from sailviz.design.minimum_time.orbit_conditions import PlanarGuess
from sailviz.design.minimum_time.planet_conditions import Meeting
from sailviz.design.minimum_time.state_costate import COSTATES, LAM_V, OWN, POSITION, TIME_UNIT, VELOCITY, Sail
from sailviz.design.minimum_time.unknowns import LOOSE, NEAR, Unknowns, distinct
from sailviz.steering.optimal import STRENGTH

SPANS = np.geomspace(0.25, 12.0, 90)  # flight times looked at: two weeks to two years
AIMED = 3  # times that a flight is aimed at where the target is, from where the last one came to
TRIED = 6  # flight times that come nearest and are followed
NO_THRUST = 1e-12  # share of a sail's strength that moves nothing


@dataclass(frozen=True)
class Passing(Meeting):
    """Fastest flight of a sail from a body past another. offset (3,) au, by which the target is put elsewhere; free,
    the share s of the velocity's freedom: 1 but on the way to it."""

    offset: tuple[float, float, float] = (0.0, 0.0, 0.0)
    free: float = 1.0

    def misses(self, ends: np.ndarray, there: np.ndarray) -> np.ndarray:
        """(n, 6): place, and the primer in units of the costates' length."""
        place = ends[:, POSITION] - there[:, POSITION] - np.array(self.offset)
        primer = ends[:, LAM_V] / np.linalg.norm(ends[:, COSTATES], axis=1)[:, None]
        return np.hstack([place, self.free * primer + (1 - self.free) * (ends[:, VELOCITY] - there[:, VELOCITY])])

    def fresh(self, departure: float, planar: PlanarGuess | None) -> list[Unknowns]:
        """Solutions for a departure in s after the epoch, from nothing and from flights that meet the body; sorted by
        flight time."""
        found = [self._followed(x, self._gap(x)) for x in self._rough(departure)]
        meeting = Meeting(self.origin, self.target, self.epoch, self.sail, self.effort)
        found += [self._let_go(x) for x in meeting.fresh(departure, planar)]
        return distinct(found)

    def _rough(self, departure: float) -> list[Unknowns]:
        """Flights that come near the target, their primer vanishing there roughly; nearest first."""
        idle = Sail(self.sail.kind, self.sail.parameters.copy())
        idle.parameters[OWN + STRENGTH] *= NO_THRUST
        (here,) = self.state(self.origin, departure)
        there = self.state(self.target, departure + SPANS * TIME_UNIT)[:, POSITION]
        starts = np.hstack([np.tile(here, (len(SPANS), 1)), np.tile([1.0, 0, 0, 0, 0, 0], (len(SPANS), 1))])
        drifted = costates.fly_all(starts, SPANS, idle, tolerance=LOOSE)
        came, lam = drifted[:, POSITION], np.empty((len(SPANS), 6))
        for _ in range(AIMED):
            self.effort.check()
            drifted[:, COSTATES] = 0.0
            gap = there - came
            drifted[:, COSTATES.start : LAM_V.start] = gap / np.linalg.norm(gap, axis=1)[:, None]
            back = costates.fly_all(drifted, -SPANS, idle, tolerance=LOOSE)
            lam = back[:, COSTATES] / np.linalg.norm(back[:, COSTATES], axis=1)[:, None]
            starts[:, COSTATES] = lam
            pushed = costates.fly_all(starts, SPANS, self.sail, tolerance=LOOSE, smoothing=self.smoothing)
            miss = np.linalg.norm(pushed[:, POSITION] - there, axis=1)
            came = pushed[:, POSITION]
        self.effort.count("flight times looked at", len(SPANS))
        around = np.concatenate([[np.inf], miss, [np.inf]])
        lowest = np.flatnonzero((miss <= around[:-2]) & (miss <= around[2:]))
        chosen = sorted(lowest, key=lambda i: miss[i])[:TRIED]
        return [Unknowns(lam[i], float(SPANS[i]), departure) for i in chosen]

    def _gap(self, unknowns: Unknowns) -> np.ndarray:
        """(3,) from the target to where a flight ends."""
        begin, span = self.start(unknowns)[None], np.array([unknowns.span])
        end = costates.fly_all(begin, span, self.sail, tolerance=LOOSE, smoothing=self.smoothing)[0]
        return end[POSITION] - self.state(self.target, unknowns.departure + unknowns.span * TIME_UNIT)[0, POSITION]

    def _followed(self, unknowns: Unknowns, offset: np.ndarray) -> Unknowns | None:
        """The flight past the target that a rough one becomes as the target moves to its place, or None."""
        at_once, residual = self.search(unknowns, self.smoothing)
        if residual <= NEAR:
            return self.sharpen(at_once)

        def elsewhere(share: float, guess: Unknowns) -> tuple[Unknowns, float]:
            x, y, z = ((1 - share) * offset).tolist()
            return replace(self, offset=(x, y, z)).search(guess, self.smoothing)

        return self._along(unknowns, elsewhere)

    def _let_go(self, unknowns: Unknowns) -> Unknowns | None:
        """The flight past the target that one becomes which meets it, or None."""
        return self._along(unknowns, lambda share, x: replace(self, free=share).search(x, self.smoothing))
