"""Fastest flights from the Earth, or another planet, to meet a planet where it is: for a date, or a window of dates.

Necessary conditions (re-derived): costates as in `costates`; at arrival position and velocity are the planet's, seven
equations with |lam| = 1 for six costates and the flight time. The craft departs with the origin's own velocity and the
planets' pull is neglected. Costates are given as -d time / d (position, velocity): lam . (f - motion of the planet) = 1
at arrival.

Search: the fastest flight to the planet's orbit, wherever the planet, from the place of the date; then the planet is
moved along its orbit, both ways, from where that flight arrives to where it is. From date to date flights are handed
on.
"""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

import numpy as np

from sailviz import ephemeris
from sailviz.constants import AU, MU_SUN
from sailviz.design.minimum_time import costates
from sailviz.design.minimum_time.costates import SPEED_UNIT, TIME_UNIT, Sail, canonical_sail
from sailviz.design.minimum_time.orbits import (
    LOOSE,
    NEAR,
    ROWS,
    SHARPER,
    SMOOTHING,
    TIGHT,
    NoGuess,
    Path,
    Problem,
    planar_guess,
    swept,
    target_radius,
)
from sailviz.design.minimum_time.shooting import solve
from sailviz.elements import elements

SOLVED = 1e-9  # largest miss of a solution, au and 29.78 km/s
SMALLEST_SHIFT = 0.01  # of the way that the planet is moved
ANCHORS = 4  # dates between two of a window's fresh searches
_SPREAD = 3000.0  # s between positions that are differenced: rounding 1e-12, neglected terms 1e-14 of the speed


@dataclass(frozen=True)
class Window:
    """Launch-window curve: departures (n,) datetime64, times (n,) s of the fastest flight found, NaN where none was."""

    departures: np.ndarray
    times: np.ndarray


@dataclass(frozen=True)
class Rendezvous:
    """A flight that meets a planet. time s; departure, arrival datetime64; revolutions swept about the Sun; costates
    (6,) at departure, -d time / d (position, velocity) in units of mu = 1 and one au; residual, largest miss in the
    same units; hamiltonian_drift relative, along the flight; solutions distinct ones found for this date. position m
    and velocity m/s (3,) at departure. window : the curve around the best departure, where a window was asked for.

    feasible False and reason: none was found; time is then NaN.
    """

    time: float
    departure: np.datetime64
    arrival: np.datetime64
    revolutions: float
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
    window: Window | None = None


def planet_state(name, epoch, time, source="mean-elements"):
    """Heliocentric position m and velocity m/s, each (n, 3), ecliptic of J2000, at times (n,) s after the epoch.

    The velocity is the difference quotient of fourth order of `ephemeris.planet_position`, so that both belong
    together.
    """
    time = np.atleast_1d(np.asarray(time, dtype=float))
    places = [ephemeris.planet_position(name, epoch, time + k * _SPREAD, source) for k in (-2, -1, 0, 1, 2)]
    velocity = (places[0] - 8 * places[1] + 8 * places[3] - places[4]) / (12 * _SPREAD)
    return places[2], velocity


@dataclass(frozen=True)
class Meeting:
    """Fastest flight of a sail from a planet to another. Unknowns (8,): costates (6), flight time, and the departure in
    s after the epoch, which is held."""

    origin: str
    target: str
    epoch: np.datetime64
    sail: Sail
    source: str

    def state(self, name, time):
        """(n, 6) in units of au and mu = 1 at times in s after the epoch."""
        r, v = planet_state(name, self.epoch, time, self.source)
        return np.hstack([r / AU, v / SPEED_UNIT])

    def start(self, unknowns):
        return np.concatenate([self.state(self.origin, unknowns[7])[0], unknowns[:6]])

    def search(self, unknowns, smoothing=0.0, tolerance=LOOSE, shift=0.0):
        """The solution near some unknowns (8,), the planet ahead by a shift in s: (unknowns (8,), residual)."""
        departure, tight = unknowns[7], tolerance < LOOSE
        start = self.start(unknowns)[:6]

        def residuals(batch):
            span = np.maximum(batch[:, 6], 1e-6)
            starts = np.hstack([np.broadcast_to(start, (len(batch), 6)), batch[:, :6]])
            ends = costates.fly_all(starts, span, self.sail, tolerance=tolerance, smoothing=smoothing)
            there = self.state(self.target, departure + shift + span * TIME_UNIT)
            return np.hstack([ends[:, :6] - there, (np.sum(batch[:, :6] ** 2, 1) - 1)[:, None]])

        found = solve(
            residuals,
            unknowns[:7],
            step=1e-7 if tight else 1e-6,
            goal=1e-13 if tight else 1e-7,
            most=10 if tight else 60,
            limit=np.array([0.3] * 6 + [0.25 * unknowns[6]]),
        )
        return np.append(found.unknowns, departure), found.residual

    def sharpen(self, unknowns):
        """The solution of the true sail to rounding, or None."""
        x = unknowns
        for eps in SHARPER if self.sail.rounds_off else (0.0,):
            x, residual = self.search(x, eps)
            if residual > NEAR:
                return None
        x, residual = self.search(x, 0.0, TIGHT)
        return x if residual <= SOLVED else None

    @property
    def smoothing(self):
        return SMOOTHING if self.sail.rounds_off else 0.0

    def fresh(self, departure, planar):
        """Solutions (8,) for a departure in s after the epoch, from nothing; sorted by flight time."""
        here, there = self.state(self.origin, departure)[0], self.state(self.target, departure)[0]
        orbits = [
            Path.of(elements(y[:3] * AU, y[3:] * SPEED_UNIT, MU_SUN)) for y in (here, there)
        ]  # osculating: they pass through the planets' places of the date
        problem = Problem(*orbits, self.sail)
        guess = problem.embedded(*planar, orbits[0].anomaly(here[:3]))
        x, residual = problem.search(guess, self.smoothing)
        if residual > NEAR or problem.hamiltonian(x) <= 0:
            x, residual, _ = problem.bend(guess, target_radius(problem), self.smoothing)
            if residual > NEAR or problem.hamiltonian(x) <= 0:
                return []
        end = costates.propagate(problem.start(x), x[6], self.sail, smoothing=self.smoothing).end
        x[7] = departure
        arrival = departure + x[6] * TIME_UNIT
        period = 2 * np.pi * orbits[1].semi_major_axis ** 1.5 * TIME_UNIT
        lead = self._time_to(end[:3], arrival, period)
        found = [self._moved(x, shift) for shift in (lead, lead - period)]
        return _distinct([y for y in found if y is not None])

    def _time_to(self, place, arrival, period):
        """Time in s, within one period, after which the planet comes to the direction of a place."""
        times = arrival + np.linspace(0, period, 721)
        places = self.state(self.target, times)[:, :3]
        cosine = places @ place / np.linalg.norm(places, axis=1)
        i = int(np.clip(np.argmax(cosine), 1, len(times) - 2))
        left, here, right = cosine[i - 1 : i + 2]
        return float(times[i] - arrival + 0.5 * (left - right) / (left - 2 * here + right) * (times[1] - times[0]))

    def _moved(self, unknowns, shift):
        """The true solution that a flight becomes as the planet moves to its place from a shift in s, or None."""
        x, residual = self.search(unknowns, self.smoothing, shift=shift)
        if residual > NEAR:
            return None
        share, step, before, at = 0.0, 0.1, None, 0.0
        while share < 1.0:
            following = min(1.0, share + step)
            guess = x if before is None else x + (x - before) * (following - share) / (share - at)
            y, residual = self.search(guess, self.smoothing, shift=shift * (1 - following))
            if residual > NEAR:
                step *= 0.4
                if step < SMALLEST_SHIFT:
                    return None
                continue
            before, at, x, share = x, share, y, following
            step *= 1.5
        return self.sharpen(x)

    def _later(self, unknowns, departure):
        """Unknowns for another departure that mean to arrive at the same time: the costates where the flight then is,
        or, for an earlier one, would have been."""
        wait = (departure - unknowns[7]) / TIME_UNIT
        mirror = np.repeat([1.0, np.sign(wait), np.sign(wait), 1.0], 3) if wait else 1.0  # time runs backwards
        y = costates.propagate(self.start(unknowns) * mirror, abs(wait), self.sail, tolerance=LOOSE).end * mirror
        lam = y[6:] / np.linalg.norm(y[6:])
        return np.concatenate([lam, [max(unknowns[6] - wait, 0.5 * unknowns[6]), departure]])

    def carried(self, unknowns, departure, halvings=4):
        """The true solution for another departure in s after the epoch, from one nearby, or None: in one step, or in
        halves of halves."""
        same = np.append(unknowns[:7], departure)
        for guess in (self._later(unknowns, departure), same):
            for smoothing in sorted({0.0, self.smoothing}):
                y, residual = self.search(guess, smoothing)
                if residual <= NEAR:
                    y = self.sharpen(y)
                    if y is not None:
                        return y
        if halvings == 0:
            return None
        middle = self.carried(unknowns, 0.5 * (unknowns[7] + departure), halvings - 1)
        return None if middle is None else self.carried(middle, departure, halvings - 1)


def _distinct(found):
    """Solutions sorted by flight time, each once."""
    found = sorted(found, key=lambda x: x[6])
    return [x for i, x in enumerate(found) if i == 0 or x[6] > found[i - 1][6] * (1 + 1e-6)]


def rendezvous(
    target,
    departure,
    device="ideal",
    characteristic_acceleration=1e-3,
    *,
    origin="Earth",
    dates=41,
    source="mean-elements",
    workers: int = 2,
    progress: Callable[[float, str], None] | None = None,
) -> Rendezvous:
    """The fastest flight found from a planet to another that leaves on a date, or on the best date of a window.

    target, origin : names in `ephemeris.PLANETS`. departure : a datetime64 or its text, or a pair (first, last), of
    which evenly spread dates are tried, and the best is refined to seconds. device : a sail's name or a Film.
    characteristic_acceleration : m/s2. source : as in `ephemeris.planet_position`. progress(share, words). Starts and
    ends with the planets' velocities; their pull is neglected. Locally optimal, best found: others are not excluded.
    """
    for name in (target, origin):
        if name not in ephemeris.PLANETS:
            raise ValueError(f"no ephemeris for {name!r}; there are {', '.join(ephemeris.PLANETS)}")
    if target == origin:
        raise ValueError(f"a rendezvous joins two planets, not {target} with itself")
    if not (np.isfinite(characteristic_acceleration) and characteristic_acceleration > 0):
        raise ValueError(f"a characteristic acceleration must be positive, not {characteristic_acceleration}")
    pair = isinstance(departure, tuple | list)
    first, last = (np.datetime64(d, "ns") for d in (departure if pair else (departure, departure)))
    if last < first:
        raise ValueError(f"the window ends, {last}, before it begins, {first}")
    meeting = Meeting(origin, target, first, canonical_sail(device, characteristic_acceleration), source)
    length = float((last - first) / np.timedelta64(1, "ns")) * 1e-9
    times = np.linspace(0.0, length, dates) if length > 0 else np.zeros(1)
    anchors = sorted({*range(0, len(times), ANCHORS), len(times) - 1})
    total, done = len(anchors) + 3, 0

    def report():
        nonlocal done
        done += 1
        if progress is not None:
            progress(done / total, "departures")

    try:
        planar = _planar(meeting, device, characteristic_acceleration)
    except NoGuess as reason:
        return _nothing(meeting, first, str(reason), device, characteristic_acceleration)

    def fresh(i):
        found = meeting.fresh(times[i], planar)
        report()
        return found

    with ThreadPoolExecutor(workers) as pool:
        searched = dict(zip(anchors, pool.map(fresh, anchors), strict=True))
        best = [searched[i][0] if searched.get(i) else None for i in range(len(times))]
        ways = list(pool.map(lambda way: _hand_on(meeting, best, times, way), (1, -1)))
    report()
    best = [
        min((x for x in point if x is not None), key=lambda x: x[6], default=None) for point in zip(*ways, strict=True)
    ]
    spans = np.array([np.nan if x is None else x[6] for x in best])
    if np.all(np.isnan(spans)):
        when = f"that leaves between {first} and {last}" if last > first else f"for {first}"
        return _nothing(meeting, first, f"no flight found {when}", device, characteristic_acceleration)
    i = int(np.nanargmin(spans))
    x = best[i]
    local = len(searched.get(i, [x])) or 1
    if length > 0:
        x = _refined(meeting, x, times, i)
    report()
    window = Window(first + (times * 1e9).astype("timedelta64[ns]"), spans * TIME_UNIT) if length > 0 else None
    found = _result(meeting, x, device, characteristic_acceleration, local, window)
    report()
    return found


def _planar(meeting, device, characteristic_acceleration):
    """Costates and span of the flight between circles of the planets' mean distances."""
    here, there = (
        Path.of(elements(y[0, :3] * AU, y[0, 3:] * SPEED_UNIT, MU_SUN))
        for y in (meeting.state(meeting.origin, 0.0), meeting.state(meeting.target, 0.0))
    )
    return planar_guess(Problem(here, there, meeting.sail), device, characteristic_acceleration)


def _hand_on(meeting, best, times, way):
    """Flights handed on from date to date, wherever they are faster."""
    found, before = list(best), None
    order = range(len(times)) if way > 0 else range(len(times) - 1, -1, -1)
    for i in order:
        if before is not None:
            x = meeting.carried(before, times[i])
            if x is not None and (found[i] is None or x[6] < found[i][6] * (1 - 1e-9)):
                found[i] = x
        before = found[i]
    return found


def _refined(meeting, x, times, i):
    """The flight of the best departure between the neighbours of a date, to seconds."""
    from scipy.optimize import minimize_scalar

    low, high = times[max(i - 1, 0)], times[min(i + 1, len(times) - 1)]
    best = x

    def span(departure):
        nonlocal best
        y = meeting.carried(best, departure)
        if y is None:
            return np.inf
        best = min(best, y, key=lambda z: z[6])
        return y[6]

    minimize_scalar(span, bounds=(low, high), method="bounded", options={"xatol": 60.0, "maxiter": 30})
    return best


def _result(meeting, x, device, characteristic_acceleration, local, window):
    start = meeting.start(x)
    flight = costates.propagate(start, x[6], meeting.sail, times=np.linspace(0, x[6], ROWS), tolerance=TIGHT)
    there = meeting.state(meeting.target, x[7] + x[6] * TIME_UNIT)[0]
    around = meeting.state(meeting.target, x[7] + x[6] * TIME_UNIT + np.array([-_SPREAD, _SPREAD]))
    motion = (around[1] - around[0]) / (2 * _SPREAD / TIME_UNIT)  # mean elements do not move quite as Kepler has it
    gain = flight.hamiltonian - float(motion @ flight.end[6:])
    departure = meeting.epoch + np.timedelta64(round(x[7] * 1e9), "ns")
    where = "the window's dates" if window is not None else "both ways of meeting the planet"
    return Rendezvous(
        time=float(x[6] * TIME_UNIT),
        departure=departure,
        arrival=departure + np.timedelta64(round(x[6] * TIME_UNIT * 1e9), "ns"),
        revolutions=swept(flight.rows),
        costates=x[:6] / gain,
        residual=float(np.abs(flight.end[:6] - there).max()),
        hamiltonian_drift=flight.drift / gain,
        solutions=local,
        claim=f"best found over {where}; a faster flight is not excluded",
        feasible=True,
        reason="",
        position=start[:3] * AU,
        velocity=start[3:6] * SPEED_UNIT,
        device=device,
        characteristic_acceleration=characteristic_acceleration,
        window=window,
    )


def _nothing(meeting, first, reason, device, characteristic_acceleration):
    start = meeting.start(np.zeros(8))
    return Rendezvous(
        np.nan, first, np.datetime64("NaT"), np.nan, np.full(6, np.nan), np.nan, np.nan, 0, reason, False, reason,
        start[:3] * AU, start[3:6] * SPEED_UNIT, device, characteristic_acceleration,
    )  # fmt: skip
