"""Fastest flights between two orbits in space, with free anomalies at both ends, from nothing but the orbits.

Necessary conditions (re-derived): costates propagated as in `costates`; at either end they are perpendicular to the
motion along the orbit, lam . (v, -r / r^3) = 0, for there the anomaly is free. The end's orbit is compared by its
vectors of angular momentum and eccentricity: six equations for five elements, without the angles that fail on
circular, equatorial or retrograde orbits. Costates are found up to a factor, with |lam| = 1, and given with H = +1.

Search: the circle-to-circle flight between the mean distances, embedded at departure points all around the orbit; where
that is too far, the orbits are bent from coplanar circles to their true shape. Neighbouring departure points hand
their flights on, so that the lowest branch is followed around; then the departure point is set free. There are many
local solutions in space: what is returned is the best found.
"""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

import numpy as np

from sailviz.constants import AU, DAY
from sailviz.design.minimum_time import costates
from sailviz.design.minimum_time.costates import SPEED_UNIT, TIME_UNIT, Sail, canonical_sail
from sailviz.design.minimum_time.shooting import solve
from sailviz.elements import Elements

STARTS = 24  # departure points tried, evenly around the orbit
LOOSE, TIGHT = 1e-9, 1e-13  # tolerances of the propagation: on the way, and of the result
NEAR, EXACT = 1e-5, 1e-9  # boundary miss that is worth polishing, and that counts as solved
SMOOTHING = 0.03  # eps of an E-sail's switch while the departure points are searched
SHARPER = (0.01, 3e-3, 1e-3, 3e-4, 0.0)  # on the way back to the true sail
SMALLEST_BEND = 0.01
LEAST_CLIMB = 0.1  # of the logarithm of the distance, for a first flight between circles
MOST_CLOSER = 20  # steps towards a minimum
CLOSE_SLOPE, EXACT_SLOPE = 1e-4, 1e-12  # of lam . (v, -r / r^3)
ROWS = 400  # along a flight, to count its revolutions
SAME = 1e-6  # relative flight time below which two solutions are one


@dataclass(frozen=True)
class Path:
    """A Kepler orbit in units of au and mu = 1: semi-latus rectum p, eccentricity e, unit vectors towards periapsis
    and a quarter turn ahead of it."""

    p: float
    e: float
    P: np.ndarray
    Q: np.ndarray

    @classmethod
    def of(cls, orbit: Elements) -> Path:
        a, e, i = (float(x) for x in (orbit.semi_major_axis / AU, orbit.eccentricity, orbit.inclination))
        node, w = float(orbit.raan), float(orbit.argument)
        if not (0 <= e < 1 and a > 0 and np.isfinite([a, i, node, w]).all()):
            raise ValueError(
                f"a transfer joins ellipses: a semi-major axis of {a:g} au with eccentricity {e:g} is none"
            )
        ahead = np.array([-np.sin(node) * np.cos(i), np.cos(node) * np.cos(i), np.sin(i)])
        along = np.array([np.cos(node), np.sin(node), 0.0])
        P, Q = np.cos(w) * along + np.sin(w) * ahead, np.cos(w) * ahead - np.sin(w) * along
        return cls(a * (1 - e * e), e, P, Q)

    @property
    def semi_major_axis(self):
        return self.p / (1 - self.e**2)

    @property
    def momentum(self):
        return np.sqrt(self.p) * np.cross(self.P, self.Q)

    def state(self, anomaly):
        """Position and velocity, each (..., 3), at true anomalies rad."""
        c, s = np.cos(anomaly)[..., None], np.sin(anomaly)[..., None]
        return self.p / (1 + self.e * c) * (c * self.P + s * self.Q), (-s * self.P + (self.e + c) * self.Q) / np.sqrt(
            self.p
        )

    def anomaly(self, position):
        """True anomaly rad of the direction of a position (3,)."""
        return float(np.arctan2(position @ self.Q, position @ self.P))

    def bent(self, share, plane: Path, radius: float) -> Path:
        """A share of the way from a circle of some radius in another orbit's plane (0) to this orbit (1)."""
        n0, n = np.cross(plane.P, plane.Q), np.cross(self.P, self.Q)
        axis = np.cross(n, n0)
        sine, cosine = np.linalg.norm(axis), float(n @ n0)
        axis = axis / sine if sine > 1e-12 else self.P
        turn = (1 - share) * np.arctan2(sine, cosine)
        e = share * self.e
        a = radius ** (1 - share) * self.semi_major_axis**share
        return Path(a * (1 - e * e), e, _turned(self.P, axis, turn), _turned(self.Q, axis, turn))


def _turned(x, axis, angle):
    """Vectors (3,) turned about a unit axis: Rodrigues' formula."""
    return x * np.cos(angle) + np.cross(axis, x) * np.sin(angle) + axis * (axis @ x) * (1 - np.cos(angle))


def kepler_rates(y):
    """(v, -r / r^3) of states y (n, >= 6): the motion along the osculating orbit."""
    r = np.linalg.norm(y[:, :3], axis=1)[:, None]
    return np.hstack([y[:, 3:6], -y[:, :3] / r**3])


@dataclass(frozen=True)
class Problem:
    """Fastest flight of a sail from one Path to another. Unknowns (8,): costates (6), flight time, and the departure
    anomaly, which each search holds."""

    origin: Path
    target: Path
    sail: Sail

    def residuals(self, batch, tolerance, smoothing):
        """(m, 8): what m rows of unknowns leave of the target's orbit (6), of the condition for a free arrival, and of
        |lam| = 1."""
        starts = np.hstack([*self.origin.state(batch[:, 7]), batch[:, :6]])
        ends = costates.fly_all(
            starts, np.maximum(batch[:, 6], 1e-6), self.sail, tolerance=tolerance, smoothing=smoothing
        )
        r, v, lam = ends[:, :3], ends[:, 3:6], ends[:, 6:]
        h = np.cross(r, v)
        e = np.cross(v, h) - r / np.linalg.norm(r, axis=1)[:, None]
        rates = kepler_rates(ends)
        along = np.sum(rates * lam, 1) / (np.linalg.norm(lam, axis=1) * np.linalg.norm(rates, axis=1))
        return np.hstack([
            (h - self.target.momentum) / np.sqrt(self.target.p),
            e - self.target.e * self.target.P,
            along[:, None],
            (np.sum(batch[:, :6] ** 2, 1) - 1)[:, None],
        ])  # fmt: skip

    def search(self, unknowns, smoothing=0.0, tolerance=LOOSE):
        """The solution near some unknowns (8,) at their departure anomaly: (unknowns (8,), residual)."""
        anomaly, tight = unknowns[7], tolerance < LOOSE
        found = solve(
            lambda batch: self.residuals(
                np.column_stack([batch, np.full(len(batch), anomaly)]), tolerance, smoothing
            ),
            unknowns[:7],
            step=1e-7 if tight else 1e-6,
            goal=1e-13 if tight else 1e-7,
            most=10 if tight else 60,
            limit=np.array([0.3] * 6 + [0.25 * unknowns[6]]),
        )  # fmt: skip
        return np.append(found.unknowns, anomaly), found.residual

    def sharpen(self, unknowns):
        """The solution of the true sail from one whose switch was rounded off: (unknowns (8,), residual)."""
        x, residual = unknowns, np.inf
        for eps in SHARPER if self.sail.rounds_off else (0.0,):
            x, residual = self.search(x, eps)
            if residual > NEAR:
                break
        return x, residual

    def slope(self, unknowns):
        """lam . (v, -r / r^3) at departure: above zero where a later departure point makes the flight faster."""
        y = self.start(unknowns)[None]
        return float(np.sum(kepler_rates(y) * y[:, 6:]))

    def bend(self, unknowns, radius, smoothing=0.0):
        """The flight that grows out of the one between coplanar circles, the target's of some radius: shares of the
        true shape rise in steps that adapt. (unknowns (8,), residual, share reached)"""
        share, step, x, residual = 0.0, 0.25, np.array(unknowns, dtype=float), np.inf
        before, at = None, 0.0
        while share < 1.0:
            following = min(1.0, share + step)
            origin = self.origin.bent(following, self.origin, self.origin.semi_major_axis)
            target = self.target.bent(following, self.origin, radius)
            guess = x if before is None else x + (x - before) * (following - share) / (share - at)
            y, miss = Problem(origin, target, self.sail).search(guess, smoothing)
            if miss > NEAR:
                step *= 0.4
                if step < SMALLEST_BEND:
                    return x, np.inf, share
                continue
            before, at, x, share, residual = x, share, y, following, miss
            step *= 1.5
        return x, residual, share

    def carried(self, unknowns, anomaly):
        """Unknowns taken along the orbit to another departure anomaly, the costates turned with it."""
        x = np.array(unknowns, dtype=float)
        n = np.cross(self.origin.P, self.origin.Q)
        x[:3], x[3:6] = (_turned(part, n, anomaly - x[7]) for part in (x[:3], x[3:6]))
        x[7] = anomaly
        return x

    def start(self, unknowns):
        """State and costates (12,) at departure."""
        return np.concatenate([*self.origin.state(np.array(unknowns[7])), unknowns[:6]])

    def hamiltonian(self, unknowns):
        """H, with the sign that tells a fastest flight from a slowest one."""
        return costates.propagate(self.start(unknowns), 0.0, self.sail).hamiltonian

    def embedded(self, planar, span, anomaly):
        """Unknowns (8,) of a planar flight's costates (lam_r, lam_u, lam_v) put into the plane of departure."""
        lr, lu, lv = planar
        r_hat = self.origin.state(np.array(anomaly))[0]
        r_hat = r_hat / np.linalg.norm(r_hat)
        t_hat = np.cross(np.cross(self.origin.P, self.origin.Q), r_hat)
        r = self.origin.semi_major_axis
        # a circle's costates: lam_theta = 0 makes the transverse part of lam_r what the turning frame asks for
        lam = np.concatenate([lr * r_hat + lu * r**-1.5 * t_hat, lu * r_hat + lv * t_hat])
        return np.concatenate([lam / np.linalg.norm(lam), [span, anomaly]])


@dataclass(frozen=True)
class OrbitTransfer:
    """A flight from orbit to orbit. time s; revolutions swept about the Sun; departure_anomaly, arrival_anomaly true
    anomalies rad; costates (6,) at departure, lam_r and lam_v in units of mu = 1 and one au with H = +1, so that they
    are -d time / d (position, velocity); residual, the boundary miss, largest entry in the same units;
    hamiltonian_drift |H - 1| along the flight; solutions distinct minima found. position m and velocity m/s (3,) at
    departure.

    feasible False and reason: none was found; the numbers are then those of the nearest flight.
    """

    time: float
    revolutions: float
    departure_anomaly: float
    arrival_anomaly: float
    costates: np.ndarray
    residual: float
    hamiltonian_drift: float
    solutions: int
    claim: str
    feasible: bool
    reason: str
    position: np.ndarray
    velocity: np.ndarray
    device: object
    characteristic_acceleration: float


def swept(rows):
    """Revolutions about the Sun along dense states (n, >= 3)."""
    u = rows[:, :3] / np.linalg.norm(rows[:, :3], axis=1)[:, None]
    across = np.linalg.norm(np.cross(u[:-1], u[1:]), axis=1)
    return float(np.sum(np.arctan2(across, np.sum(u[:-1] * u[1:], axis=1))) / (2 * np.pi))


def orbit_to_orbit(
    initial_elements: Elements,
    final_elements: Elements,
    device="ideal",
    characteristic_acceleration=1e-3,
    *,
    starts: int = STARTS,
    workers: int = 2,
    progress: Callable[[float, str], None] | None = None,
) -> OrbitTransfer:
    """The fastest flight found between two ellipses, departure and arrival anomaly free (those of the elements do not
    count).

    device : a sail's name or a Film. characteristic_acceleration : m/s2. starts : departure points tried. workers :
    threads; the result does not depend on them. progress(share, words) is called as the search goes on. ValueError for
    orbits that are no ellipses or a thrust that is none. Residuals below 1e-12; locally optimal, and best found: other
    families of flights are not excluded.
    """
    if not (np.isfinite(characteristic_acceleration) and characteristic_acceleration > 0):
        raise ValueError(f"a characteristic acceleration must be positive, not {characteristic_acceleration}")
    problem = Problem(
        Path.of(initial_elements), Path.of(final_elements), canonical_sail(device, characteristic_acceleration)
    )
    radius = target_radius(problem)
    try:
        planar, span = planar_guess(problem, device, characteristic_acceleration)
    except NoGuess as reason:
        return _unknown(problem, str(reason), device, characteristic_acceleration)
    anomalies = 2 * np.pi * np.arange(starts) / starts
    total, done = 2 * starts, 0

    def report(n=1, words="departure points"):
        nonlocal done
        done = min(done + n, total)
        if progress is not None:
            progress(done / total, words)

    smoothing = SMOOTHING if problem.sail.rounds_off else 0.0

    def embedded(anomaly):
        x, residual = problem.search(problem.embedded(planar, span, anomaly), smoothing)
        report()
        return x if residual <= NEAR and problem.hamiltonian(x) > 0 else None

    def bent(anomaly):
        x, residual, share = problem.bend(problem.embedded(planar, span, anomaly), radius, smoothing)
        return x, residual if problem.hamiltonian(x) > 0 else np.inf, share

    with ThreadPoolExecutor(workers) as pool:
        ring = _hand_on(pool, problem, list(pool.map(embedded, anomalies)), anomalies, smoothing)
        missing = [i for i, x in enumerate(ring) if x is None]
        grown = dict(zip(missing, pool.map(bent, anomalies[missing]), strict=True))
        if grown:
            for i, (x, residual, _) in grown.items():
                ring[i] = x if residual <= NEAR else None
            ring = _hand_on(pool, problem, ring, anomalies, smoothing)
        if not any(x is not None for x in ring):
            x, _, share = max(grown.values(), key=lambda point: (point[2], -point[0][6]))
            return _nothing(problem, x, share, device, characteristic_acceleration)
        report(starts // 2, "minima")
        found = list(pool.map(lambda x: _minimum(problem, x, 2 * np.pi / starts, smoothing), _valleys(ring)))
    found = sorted((x for x in found if x is not None), key=lambda x: x[6])
    distinct = [x for i, x in enumerate(found) if i == 0 or x[6] > found[i - 1][6] * (1 + SAME)]
    report(total, "done")
    if not distinct:
        best = min((x for x in ring if x is not None), key=lambda x: x[6])
        return _nothing(problem, best, 1.0, device, characteristic_acceleration)
    claim = (
        f"best found of {len(distinct)} local {'minimum' if len(distinct) == 1 else 'minima'} "
        f"from {starts} departure points; a faster flight is not excluded"
    )
    return _transfer(problem, distinct[0], device, characteristic_acceleration, len(distinct), claim)


class NoGuess(Exception):
    """There is no flight between circles to begin with, and why."""


def target_radius(problem):
    """Radius of the circle aimed at first: the target's mean distance, or one tenth off where that is the origin's."""
    a0, a = problem.origin.semi_major_axis, problem.target.semi_major_axis
    return a if abs(np.log(a / a0)) > LEAST_CLIMB else a0 * np.exp(np.copysign(LEAST_CLIMB, a - a0))


def planar_guess(problem, device, characteristic_acceleration):
    """Costates (lam_r, lam_u, lam_v) and span of the flight between circles of the mean distances."""
    from sailviz.design.minimum_time.circles import circle_to_circle

    a0, a = problem.origin.semi_major_axis * AU, target_radius(problem) * AU
    found = circle_to_circle(a0, a, device, characteristic_acceleration)
    if not found.feasible:
        raise NoGuess(f"no flight found between circles of the mean distances: {found.reason}")
    lr, lu, lv = found.costates  # in units of the first circle; up to a factor
    unit = problem.origin.semi_major_axis**1.5
    return (lr, lu * unit, lv * unit), found.time / TIME_UNIT


def _hand_on(pool, problem, ring, anomalies, smoothing):
    """Flights handed from each departure point of the ring to the next, both ways round, wherever they are faster."""
    ways = list(pool.map(lambda way: _hand_on_one_way(problem, ring, anomalies, smoothing, way), (1, -1)))
    return [
        min((x for x in point if x is not None), key=lambda x: x[6], default=None) for point in zip(*ways, strict=True)
    ]


def _hand_on_one_way(problem, ring, anomalies, smoothing, way):
    found, n, before = list(ring), len(ring), None
    for step in range(2 * n):
        i = way * step % n
        if before is not None and (found[i] is None or found[i][6] > before[6] * (1 + SAME)):
            x, residual = problem.search(problem.carried(before, anomalies[i]), smoothing)
            faster = found[i] is None or x[6] < found[i][6] * (1 - SAME)
            if residual <= NEAR and faster and problem.hamiltonian(x) > 0:
                found[i] = x
        before = found[i]
        if step >= n and found[i] is ring[i]:  # nothing new comes round a second time
            break
    return found


def _valleys(ring):
    """The points of the ring that no neighbour beats."""
    neighbours = zip(ring, ring[-1:] + ring[:-1], ring[1:] + ring[:1], strict=True)
    return [x for x, *sides in neighbours if x is not None and all(y is None or x[6] <= y[6] for y in sides)]


def _minimum(problem, x, step, smoothing):
    """The minimum over the departure point near a point of the ring, for the true sail; None if it escapes."""
    if smoothing > 0:
        x = _descend(problem, x, step, smoothing, LOOSE, CLOSE_SLOPE)
        if x is None:
            return None
        x, residual = problem.sharpen(x)
        if residual > NEAR:
            return None
    x = _descend(problem, x, step, 0.0, LOOSE, CLOSE_SLOPE)
    if x is None:
        return None
    x, residual = problem.search(x, 0.0, TIGHT)
    x = _descend(problem, x, 0.1 * step, 0.0, TIGHT, EXACT_SLOPE) if residual <= EXACT else None
    return x if x is not None and problem.hamiltonian(x) > 0 else None


def _descend(problem, x, step, smoothing, tolerance, close):
    """The flight whose slope over the departure point vanishes, downhill from a flight x: steps that grow until the
    slope changes sign, then false position (Illinois). None where the flights cannot be followed that far.

    One unknown apart from the others: all eight at once converge from too near only, since the flight time hardly
    depends on the departure point.
    """
    near = NEAR if tolerance == LOOSE else EXACT
    low, g_low = x, problem.slope(x)
    high, g_high = None, 0.0
    for _ in range(MOST_CLOSER):
        if abs(g_low) <= close:
            return low
        if high is None:
            anomaly = low[7] + np.copysign(step, g_low)
        else:
            anomaly = low[7] + (high[7] - low[7]) * g_low / (g_low - g_high)
            if not min(low[7], high[7]) < anomaly < max(low[7], high[7]):
                break
        y, residual = problem.search(problem.carried(low, anomaly), smoothing, tolerance)
        if residual > near:
            if high is not None:
                return None
            step *= 0.3
            continue
        g = problem.slope(y)
        if g * g_low > 0:
            low, g_low, step = y, g, 2 * step
            if high is not None:
                g_high = 0.5 * g_high
        else:
            low, g_low, high, g_high = y, g, low, g_low
    return low if abs(g_low) <= 1e3 * close else None


def _transfer(problem, x, device, characteristic_acceleration, local, claim, feasible=True, reason=""):
    scaled = problem.start(x)
    scaled[6:] /= problem.hamiltonian(x)
    flight = costates.propagate(scaled, x[6], problem.sail, times=np.linspace(0, x[6], ROWS), tolerance=TIGHT)
    residual = max(np.abs(problem.residuals(x[None], TIGHT, 0.0)).max(), abs(problem.slope(x)))
    return OrbitTransfer(
        float(x[6] * TIME_UNIT),
        swept(flight.rows),
        float(np.mod(x[7], 2 * np.pi)),
        float(np.mod(problem.target.anomaly(flight.end[:3]), 2 * np.pi)),
        scaled[6:],
        float(residual),
        flight.drift,
        local,
        claim,
        feasible,
        reason,
        scaled[:3] * AU,
        scaled[3:6] * SPEED_UNIT,
        device,
        characteristic_acceleration,
    )


def _nothing(problem, x, share, device, characteristic_acceleration):
    """What came nearest: the flight to the orbit bent the furthest."""
    reason = (
        f"no flight found: an orbit {100 * share:.0f} % of the way from a coplanar circle to the one asked for is the "
        f"nearest that was reached, after {x[6] * TIME_UNIT / DAY:.1f} d"
    )
    return _transfer(problem, x, device, characteristic_acceleration, 0, reason, False, reason)


def _unknown(problem, reason, device, characteristic_acceleration):
    """The result of a search that could not begin."""
    position, velocity = problem.origin.state(np.array(0.0))
    nan = np.nan
    return OrbitTransfer(
        nan, nan, nan, nan, np.full(6, nan), nan, nan, 0, reason, False, reason,
        position * AU, velocity * SPEED_UNIT, device, characteristic_acceleration,
    )  # fmt: skip
