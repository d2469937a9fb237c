"""What a fastest flight between two orbits in space must satisfy, both anomalies free.

Necessary conditions (re-derived): costates as in `state_costate`; at either end they are perpendicular to the motion
along the orbit, lam . (v, -r / r^3) = 0, for there the anomaly is free. The end's orbit is compared by its vectors of
angular momentum and eccentricity: six equations for five elements, without the angles that fail on circular,
equatorial or retrograde orbits.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import NamedTuple

import numpy as np

from sailviz.design.minimum_time import costates
from sailviz.design.minimum_time.effort import Effort
from sailviz.design.minimum_time.kepler_orbit import KeplerOrbit, cross, length, turned
from sailviz.design.minimum_time.state_costate import COSTATES, POSITION, SIZE, VELOCITY, Sail, kepler_rates
from sailviz.design.minimum_time.unknowns import LOOSE, NEAR, SHARPER, Unknowns, columns, solved

SMALLEST_BEND = 0.01  # of the way from a coplanar circle to the orbit's true shape


class PlanarGuess(NamedTuple):
    """A flight between circles: costates of radius, radial and transverse speed up to a factor, and its span, in units
    of mu = 1 and one au."""

    costates: tuple[float, float, float]
    span: float


class Bent(NamedTuple):
    """How far a flight could be followed as its orbits were bent: unknowns and residual at the share reached."""

    unknowns: Unknowns
    residual: float
    share: float


@dataclass(frozen=True)
class OrbitProblem:
    """Fastest flight of a sail from one orbit to another; the departure of its Unknowns is a true anomaly rad. Its
    searches end with the effort."""

    origin: KeplerOrbit
    target: KeplerOrbit
    sail: Sail
    effort: Effort = field(default_factory=Effort, compare=False)

    def residuals(self, batch: np.ndarray, departure: float, tolerance: float, smoothing: float) -> np.ndarray:
        """(m, 8): what m rows of packed unknowns leave of the target's orbit (6), of the condition for a free arrival,
        and of |lam| = 1."""
        begin, spans = columns(batch)
        starts = np.empty((len(batch), SIZE))
        starts[:, POSITION], starts[:, VELOCITY] = self.origin.state(departure)
        starts[:, COSTATES] = begin
        ends = costates.fly_all(starts, spans, self.sail, tolerance=tolerance, smoothing=smoothing)
        r, v, lam = ends[:, POSITION], ends[:, VELOCITY], ends[:, COSTATES]
        rates = kepler_rates(ends)
        h = cross(r, v)
        out = np.empty((len(batch), 8))
        out[:, 0:3] = h / np.sqrt(self.target.p) - self.target.normal
        out[:, 3:6] = cross(v, h) - r / length(r)[:, None] - self.target.e * self.target.P
        out[:, 6] = (rates * lam).sum(axis=1) / (length(lam) * length(rates))
        out[:, 7] = (begin * begin).sum(axis=1) - 1.0
        return out

    def search(self, unknowns: Unknowns, smoothing: float = 0.0, tolerance: float = LOOSE) -> tuple[Unknowns, float]:
        """The solution near some unknowns at their departure anomaly, and its residual."""

        def residuals(batch: np.ndarray) -> np.ndarray:
            return self.residuals(batch, unknowns.departure, tolerance, smoothing)

        return solved(self.effort.watched(residuals), unknowns, tolerance)

    def sharpen(self, unknowns: Unknowns) -> tuple[Unknowns, float]:
        """The solution of the true sail from one whose switch was rounded off, and its residual."""
        x, residual = unknowns, np.inf
        for eps in SHARPER if self.sail.rounds_off else (0.0,):
            x, residual = self.search(x, eps)
            if residual > NEAR:
                break
        return x, residual

    def slope(self, unknowns: Unknowns) -> float:
        """lam . (v, -r / r^3) at departure: above zero where a later departure point makes the flight faster."""
        y = self.start(unknowns)[None]
        return float(np.sum(kepler_rates(y) * y[:, COSTATES]))

    def bent(self, share: float, radius: float) -> OrbitProblem:
        """The problem between orbits that are this share of the way from coplanar circles to their true shape."""
        origin = self.origin.bent(share, self.origin, self.origin.semi_major_axis)
        return replace(self, origin=origin, target=self.target.bent(share, self.origin, radius))

    def bend(self, unknowns: Unknowns, radius: float, smoothing: float = 0.0) -> Bent:
        """The flight that grows out of the one between coplanar circles, the target's of some radius: shares of the
        true shape rise in steps that adapt."""
        share, step, x, residual = 0.0, 0.25, unknowns, np.inf
        before, at = None, 0.0
        while share < 1.0:
            following = min(1.0, share + step)
            guess = x if before is None else x.ahead(before, following - share, share - at)
            y, miss = self.bent(following, radius).search(guess, smoothing)
            if miss > NEAR:
                step *= 0.4
                if step < SMALLEST_BEND:
                    return Bent(x, np.inf, share)
                continue
            before, at, x, share, residual = x, share, y, following, miss
            step *= 1.5
        return Bent(x, residual, share)

    def carried(self, unknowns: Unknowns, anomaly: float) -> Unknowns:
        """Unknowns taken along the orbit to another departure anomaly, the costates turned with it."""
        angle, lam = anomaly - unknowns.departure, unknowns.costates
        parts = [turned(part, self.origin.normal, angle) for part in (lam[:3], lam[3:])]  # lam_r, lam_v
        return Unknowns(np.concatenate(parts), unknowns.span, anomaly)

    def start(self, unknowns: Unknowns) -> np.ndarray:
        """State and costates (12,) at departure."""
        return np.concatenate([*self.origin.state(unknowns.departure), unknowns.costates])

    def hamiltonian(self, unknowns: Unknowns) -> float:
        """H, with the sign that tells a fastest flight from a slowest one."""
        return costates.propagate(self.start(unknowns), 0.0, self.sail).hamiltonian

    def embedded(self, planar: PlanarGuess, anomaly: float) -> Unknowns:
        """A planar flight put into the plane of departure."""
        lr, lu, lv = planar.costates
        r_hat = self.origin.state(anomaly)[0]
        r_hat = r_hat / np.linalg.norm(r_hat)
        t_hat = np.cross(self.origin.normal, r_hat)
        r = self.origin.semi_major_axis
        # a circle's costates: lam_theta = 0 makes the transverse part of lam_r what the turning frame asks for
        lam = np.concatenate([lr * r_hat + lu * r**-1.5 * t_hat, lu * r_hat + lv * t_hat])
        return Unknowns(lam / np.linalg.norm(lam), planar.span, anomaly)
