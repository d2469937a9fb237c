"""Ways out: fastest flights from the limit of the distance from the Sun, passed at some speed, to where a flight ends.

At the limit the radial speed is 0 and the angle about the Sun free, so that the ways out are a family of one number,
the speed there. One is searched from nothing, and followed to higher and lower speeds. A far radius is come to from
nearer ones. Units: mu = 1 and the distance of departure.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from sailviz.design.minimum_time import shooting
from sailviz.design.minimum_time.boundary_conditions import SPAN, PolarState, direction, fly, hamiltonians
from sailviz.design.minimum_time.effort import Effort
from sailviz.design.minimum_time.finishing import NEAR, TIGHT
from sailviz.design.minimum_time.planar_ends import Absolute, AtRadius, ToEnd
from sailviz.design.minimum_time.search import search

PARABOLIC = (1.0, 1.15, 0.85)  # speeds over that of a parabola at the limit, from which ways out are searched
DIRECTIONS = 200  # of costates, for one of these searches
FIRST_RADIUS = 4.0  # to which a flight is sought first, and carried on from there
FARTHER = 1.5  # the next radius over the last
FASTER, FINEST = 1.03, 1.001  # the next speed over the last; its smallest ratio
KINDS = 3  # of ways out from one speed, the fastest ones, that are followed


@dataclass(frozen=True)
class WaysOut:
    """Flights at rising speeds (n,) at the limit: unknowns (n, 4) as those of a ToEnd, worth (n,) what more speed
    there saves of time, - d time / d speed."""

    speed: np.ndarray
    unknowns: np.ndarray
    worth: np.ndarray

    def at(self, speed: np.ndarray | float) -> tuple[np.ndarray, np.ndarray]:
        """Time and worth at speeds, between the known ones; NaN beyond them."""
        time, worth = (
            np.interp(speed, self.speed, x, left=np.nan, right=np.nan) for x in (self.unknowns[:, SPAN], self.worth)
        )
        return time, worth

    def unknowns_at(self, speed: float) -> np.ndarray:
        """Unknowns (4,) at a speed."""
        return np.array([np.interp(speed, self.speed, column) for column in self.unknowns.T])


def families(flight: ToEnd, limit: float, slowest: float, fastest: float, effort: Effort) -> list[WaysOut]:
    """All ways out from a limit to the end of a flight that are found, for speeds there between two."""
    for share in PARABOLIC:
        speed = float(np.clip(share * np.sqrt(2 / limit), slowest, fastest))
        found = []
        for x in _searched(flight, limit, speed, effort)[:KINDS]:
            up, down = (_followed(flight, limit, speed, x, to, effort) for to in (fastest, slowest))
            speeds, unknowns = (np.array(some) for some in zip(*down[::-1], (speed, x), *up, strict=True))
            found.append(WaysOut(speeds, unknowns, _worth(flight, limit, speeds, unknowns)))
        if found:
            return found
    return []


def _from(flight: ToEnd, limit: float, speed: float) -> ToEnd:
    return replace(flight, begin=PolarState(limit, 0.0, speed))


def _worth(flight: ToEnd, limit: float, speeds: np.ndarray, unknowns: np.ndarray) -> np.ndarray:
    """lam_v / H at the limit (n,); NaN of flights that are no fastest ones."""
    starts = np.concatenate([_from(flight, limit, v).starts(x[None]) for v, x in zip(speeds, unknowns, strict=True)])
    h, size = hamiltonians(starts, flight.sail), np.linalg.norm(unknowns[:, :3], axis=1)
    with np.errstate(invalid="ignore", divide="ignore"):
        return np.where(h > 0, unknowns[:, 2] / size / h, np.nan)


def _solved(problem: ToEnd, unknowns: np.ndarray, effort: Effort) -> np.ndarray | None:
    """Unknowns (4,) of the way out near others, or None."""

    def misses(x: np.ndarray) -> np.ndarray:
        at = Absolute.of(fly(problem, x, TIGHT, 0.0))
        return np.stack([*problem.end.misses(at), direction(x)[1] - 1], axis=1)

    x = shooting.solve(effort.watched(misses), unknowns, step=1e-7, goal=1e-8, most=15).unknowns
    near = np.abs(problem.misses(x[None], TIGHT)).max() < NEAR
    return x if near and 0.5 * unknowns[SPAN] < x[SPAN] < 2 * unknowns[SPAN] else None


def _searched(flight: ToEnd, limit: float, speed: float, effort: Effort) -> list[np.ndarray]:
    """Unknowns (4,) of ways out at a speed, fastest first."""
    problem, end = _from(flight, limit, speed), flight.end
    far = isinstance(end, AtRadius) and end.radius > FIRST_RADIUS
    if far:
        problem = replace(problem, end=AtRadius(FIRST_RADIUS))

    def fastest(unknowns: np.ndarray) -> bool:
        return bool(hamiltonians(problem.starts(unknowns[None]), problem.sail)[0] > 0)

    span = np.pi + 2 * problem.end.scale
    found = search(problem, span, DIRECTIONS, True, fastest, effort=effort, zooms=0, all_of_them=True)
    out = []
    for x in [extremal.unknowns for extremal in found.extremals]:
        carried: np.ndarray | None = x
        if far:
            assert isinstance(end, AtRadius)
            carried = _carried_out(problem, x, end.radius, effort)
        if carried is not None:
            out.append(carried)
    return out


def _carried_out(problem: ToEnd, unknowns: np.ndarray, radius: float, effort: Effort) -> np.ndarray | None:
    """The way out to a radius from that to FIRST_RADIUS."""
    at, x, before, ratio = FIRST_RADIUS, unknowns, None, FARTHER
    while at < radius:
        following = min(radius, at * ratio)
        guess = x * np.array([1.0, 1.0, 1.0, following / at])
        if before is not None:
            guess = x + (x - before[1]) * (following - at) / (at - before[0])
        found = _solved(replace(problem, end=AtRadius(following)), guess, effort)
        if found is None:
            ratio = np.sqrt(ratio)
            if ratio < FINEST:
                return None
            continue
        before, at, x, ratio = (at, x), following, found, min(ratio * ratio, FARTHER)
    return x


def _followed(
    flight: ToEnd, limit: float, speed: float, unknowns: np.ndarray, to: float, effort: Effort
) -> list[tuple[float, np.ndarray]]:
    """(speed, unknowns) at speeds from one on to another, both left out where they coincide."""
    found, ratio, before, x = list[tuple[float, np.ndarray]](), FASTER, None, unknowns
    while speed != to:
        following = min(to, speed * ratio) if to > speed else max(to, speed / ratio)
        guess = x if before is None else x + (x - before[1]) * (following - speed) / (speed - before[0])
        new = _solved(_from(flight, limit, following), guess, effort)
        if new is None:
            ratio = np.sqrt(ratio)
            if ratio < FINEST:
                break
            continue
        before, speed, x = (speed, x), following, new
        found.append((speed, x))
        ratio = min(ratio**1.5, FASTER)
    return found
