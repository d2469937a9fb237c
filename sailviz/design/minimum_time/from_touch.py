"""Flights that touch a limit of their distance from the Sun, flown from the touching point to both sides.

Flown from departure, all that is behind the touching point hangs on the fall to it, and what is a little off there is
far off at the end. From the touching point, r = r_min and u = 0, both halves are tame. Units: mu = 1 and the distance
of departure.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from sailviz.design.minimum_time import costates, shooting
from sailviz.design.minimum_time.boundary_conditions import SHORTEST, cartesian, polar
from sailviz.design.minimum_time.effort import Effort
from sailviz.design.minimum_time.finishing import TIGHT
from sailviz.design.minimum_time.planar_ends import Absolute, Polar, ToEnd
from sailviz.design.minimum_time.touches import jumped

SPEED, LAM_R, LAM_U, LAM_V, JUMP, BEFORE, AFTER = range(7)  # places of the unknowns
SOLVED = 1e-9  # largest miss
JUMPS_LESS = 4  # steps in which a jump is taken away


@dataclass(frozen=True)
class FromTouch:
    """A ToEnd whose flight touches a perihelion limit once, or turns where it likes.

    Unknowns (7): transverse speed at the touching point, costates of r, u and v before it, of length 1, jump of that of
    r, times before and after. Misses (7): the state of departure, the end, the costates' length. Where the jump is
    given, 0 for a flight that has no limit, the logarithm of the distance stands in its place among the unknowns.
    """

    flight: ToEnd
    perihelion: float
    given: float | None = None  # jump

    def starts(self, unknowns: np.ndarray) -> np.ndarray:
        """States and costates (n, 12) before the touching point, of unknowns (n, 7)."""
        v, lam_r, lam_u, lam_v = unknowns[:, :JUMP].T
        r = np.full(len(v), self.perihelion) if self.given is None else np.exp(unknowns[:, JUMP])
        return cartesian(r, 0.0, 0.0, v, lam_r, lam_u * v / r, lam_u, lam_v)

    def misses(self, unknowns: np.ndarray) -> np.ndarray:
        """(n, 7) from (n, 7); NaN where a flight fails. The end's costates are measured by their length at the touching
        point: so their misses depend on the unknowns in proportion."""
        touching = self.starts(unknowns)
        begins, ends = self._begins(unknowns, touching), self._ends(unknowns, touching)
        r, _, u, v = polar(begins)
        begin = self.flight.begin
        off = r - begin.radius, u - begin.radial, v - begin.transverse
        length = np.sqrt(np.sum(unknowns[:, LAM_R:JUMP] ** 2, axis=1)) - 1
        return np.stack([*off, *self.flight.end.misses(Absolute.of(ends)), length], axis=1)

    def _begins(self, unknowns: np.ndarray, touching: np.ndarray) -> np.ndarray:
        spans = -np.maximum(unknowns[:, BEFORE], SHORTEST)
        return costates.fly_all(touching, spans, self.flight.sail, tolerance=TIGHT)

    def _ends(self, unknowns: np.ndarray, touching: np.ndarray) -> np.ndarray:
        spans = np.maximum(unknowns[:, AFTER], SHORTEST)
        jump = unknowns[:, JUMP] if self.given is None else np.full(len(unknowns), self.given)
        return costates.fly_all(jumped(touching, jump), spans, self.flight.sail, tolerance=TIGHT)

    def solved(self, unknowns: np.ndarray, effort: Effort, most: int = 25) -> np.ndarray | None:
        """Unknowns (7,) without misses near others, or None."""
        found = shooting.solve(effort.watched(self.misses), unknowns, step=1e-7, goal=1e-11, most=most)
        x = found.unknowns
        return x if found.residual < SOLVED and min(x[BEFORE], x[AFTER]) > SHORTEST else None

    def from_departure(self, unknowns: np.ndarray) -> np.ndarray:
        """Unknowns of a `Touching` (6,) of unknowns (7,) that solve this."""
        at = Polar.of(self._begins(unknowns[None], self.starts(unknowns[None])))
        lam = np.array([at.lam_r[0], at.lam_u[0], at.lam_v[0]])
        size = float(at.size[0])
        times = unknowns[BEFORE] + unknowns[AFTER], unknowns[BEFORE]
        return np.array([*lam / size, *times, unknowns[JUMP] / size])

    def freed(self, unknowns: np.ndarray, effort: Effort) -> np.ndarray | None:
        """Unknowns of the ToEnd (4,) for a flight without a limit that one touching it, unknowns (7,), leads to: the
        jump is taken away little by little; None where that leads to none."""
        x = unknowns.copy()
        x[JUMP] = np.log(self.perihelion)
        for share in np.linspace(1, 0, JUMPS_LESS + 1)[1:]:
            lesser = replace(self, given=float(share * unknowns[JUMP]))
            found = lesser.solved(x, effort)
            if found is None:
                return None
            x = found
        return lesser.from_departure(x)[:4]
