"""Fastest flights from the Earth, or another body, to meet a planet or a small body where it is: for a date, or for the
best date of a window.

Dates some months apart are searched afresh as in `planet_conditions`; each flight found is followed downhill over its
date as in `launch_dates`, and handed on from date to date wherever it is faster, which makes the window's curve.
Costates are given as -d time / d (position, velocity): lam . (f - motion of the target) = 1 at arrival.
"""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field, replace

import numpy as np

from sailviz import ephemeris
from sailviz.constants import AU, DAY
from sailviz.design.minimum_time import costates, launch_dates
from sailviz.design.minimum_time.body_flyby import Passing
from sailviz.design.minimum_time.effort import Effort, Ending
from sailviz.design.minimum_time.launch_dates import LocalBest
from sailviz.design.minimum_time.moving_bodies import MovingBody, Planet
from sailviz.design.minimum_time.orbit_conditions import OrbitProblem, PlanarGuess
from sailviz.design.minimum_time.orbits import ROWS, NoGuess, planar_guess
from sailviz.design.minimum_time.planet_conditions import Meeting
from sailviz.design.minimum_time.state_costate import (
    POSITION,
    SPEED_UNIT,
    TIME_UNIT,
    VELOCITY,
    canonical_sail,
    revolutions,
)
from sailviz.design.minimum_time.unknowns import TIGHT, Unknowns, fastest
from sailviz.propulsion.solar_sail import Film

DATES = 41  # tried in a window
APART = 105 * DAY  # s between a window's fresh searches, at most where it is not very long
FEWEST_ANCHORS, MOST_ANCHORS = 3, 60
TOO_SLOW = 1.5  # times the fastest flight found: not followed
FASTER = 1e-6  # relative flight time by which a flight handed on must win


@dataclass(frozen=True)
class Window:
    """Launch-window curve: departures (n,) datetime64, times (n,) s of the fastest flight found, NaN where none was.
    best_departures (k,) datetime64, best_times (k,) s: the local best dates found, fastest first. edge : "first" or
    "last" where the best of all is that day of the window only for want of days beyond it, else ""."""

    departures: np.ndarray
    times: np.ndarray
    best_departures: np.ndarray
    best_times: np.ndarray
    edge: str


@dataclass(frozen=True)
class Rendezvous:
    """A flight that meets a body, or passes it. time s; departure, arrival datetime64; revolutions swept about the Sun;
    costates (6,) at departure, -d time / d (position, velocity) in units of mu = 1 and one au; hamiltonian, the H that
    belongs to them: +1 and the planet's motion at the arrival times the costates there, since the end moves; residual,
    largest miss in the same units, of a fly-by also of the primer, which vanishes at the end; hamiltonian_drift
    relative, along the flight; solutions distinct ones found for this date, or best dates of the window. position m and
    velocity m/s (3,) at departure. window : the curve around the best departure, where a window was asked for. slope :
    d time / d departure, zero but for rounding at a best date. passing_speed m/s, past the body, of a fly-by. ending :
    how the search ended.

    feasible False and reason: none was found; time is then NaN.
    """

    time: float
    departure: np.datetime64
    arrival: np.datetime64
    revolutions: float
    costates: np.ndarray
    hamiltonian: float
    residual: float
    hamiltonian_drift: float
    solutions: int
    claim: str
    feasible: bool
    reason: str
    position: np.ndarray
    velocity: np.ndarray
    device: Film | str
    characteristic_acceleration: float
    window: Window | None = None
    slope: float = np.nan
    passing_speed: float = np.nan
    method: str = "shooting"
    ending: Ending = field(default_factory=Ending)


Date = np.datetime64 | str
Curve = list[Unknowns | None]  # the fastest flight, or none, of each date


def rendezvous(
    target: str | MovingBody,
    departure: Date | tuple[Date, Date] | list[Date],
    device: Film | str = "ideal",
    characteristic_acceleration: float = 1e-3,
    *,
    origin: str | MovingBody = "Earth",
    flyby: bool = False,
    dates: int = DATES,
    source: str = "mean-elements",
    workers: int = 2,
    progress: Callable[[float, str], None] | None = None,
    time_limit: float | None = None,
    effort: Effort | None = None,
) -> Rendezvous:
    """The fastest flight found from a body to another that leaves on a date, or on the best date of a window.

    target, origin : names in `ephemeris.PLANETS`, or bodies such as a `moving_bodies.SmallBodyOrbit`. departure : a
    datetime64 or its text (UTC), or a pair (first, last), whose best date is found to seconds; evenly spread dates of
    it make its curve. flyby : past the body at any speed, instead of with its velocity. device : a sail's name or a
    Film. characteristic_acceleration : m/s2. source : of planets, as in `ephemeris.planet_position`. progress(share,
    words) and time_limit s, or an effort with both: at its end the best so far. Starts with the origin's velocity; the
    bodies' pull is neglected. Locally optimal, best found: others are not excluded. ValueError for bodies, a window or
    a thrust that are none.
    """
    effort = Effort.of(effort, progress, time_limit)
    begin, aim = _body(origin, source), _body(target, source)
    _check(aim, begin, characteristic_acceleration)
    first, last = _window(departure)
    sail = canonical_sail(device, characteristic_acceleration)
    meeting = (Passing if flyby else Meeting)(begin, aim, first, sail, effort)
    asked = Asked(meeting, device, characteristic_acceleration)
    length = float((last - first) / np.timedelta64(1, "ns")) * 1e-9
    planar: PlanarGuess | None = None
    try:
        planar = _planar(asked)
    except NoGuess as none:
        if not flyby:
            return _nothing(asked, first, str(none), none.ending)
    if length > 0:
        return _best_of_window(asked, planar, length, dates, workers)
    found: list[Unknowns] = []
    with effort.stoppable():
        found = meeting.fresh(0.0, planar)
    effort.report(0.9, "departures")
    if not found:
        return _nothing(
            asked, first, f"no flight found for {first.astype('datetime64[s]')}", _without_success(effort, planar)
        )
    return _result(asked, found[0], len(found))


def rendezvous_near(
    meeting: Meeting,
    guess: Unknowns,
    length: float,
    device: Film | str,
    characteristic_acceleration: float,
) -> Rendezvous | None:
    """The flight of a meeting that a good guess leads to, on its date or, in a window of a length in s from the epoch
    on, on the best date nearby; None where it leads to none."""
    found: Unknowns | None = None
    with meeting.effort.stoppable():
        found = meeting.sharpen(guess)
        if found is not None and length > 0:
            best = launch_dates.local_best(meeting, found, 0.0, length)
            found = found if best is None else best.flight
    return None if found is None else _result(Asked(meeting, device, characteristic_acceleration), found, 1)


@dataclass(frozen=True)
class Asked:
    """Between which bodies, and by what sail."""

    meeting: Meeting
    device: Film | str
    characteristic_acceleration: float


def _body(name: str | MovingBody, source: str) -> MovingBody:
    if not isinstance(name, str):
        return name
    if name not in ephemeris.PLANETS:
        raise ValueError(f"no ephemeris for {name!r}; there are {', '.join(ephemeris.PLANETS)}")
    return Planet(name, source)


def _check(target: MovingBody, origin: MovingBody, characteristic_acceleration: float) -> None:
    if target == origin:
        raise ValueError(f"a rendezvous joins two bodies, not {target.name} with itself")
    if not (np.isfinite(characteristic_acceleration) and characteristic_acceleration > 0):
        raise ValueError(f"a characteristic acceleration must be positive, not {characteristic_acceleration}")


def _window(departure: Date | tuple[Date, Date] | list[Date]) -> tuple[np.datetime64, np.datetime64]:
    """First and last date; the same one where a single date was given."""
    pair = departure if isinstance(departure, tuple | list) else (departure, departure)
    first, last = (np.datetime64(date).astype("datetime64[ns]") for date in pair)
    if last < first:
        raise ValueError(f"the window ends, {last}, before it begins, {first}")
    return first, last


def _planar(asked: Asked) -> PlanarGuess:
    """The flight between circles of the bodies' mean distances."""
    meeting = asked.meeting
    origin, target = meeting.orbit(meeting.origin, 0.0), meeting.orbit(meeting.target, 0.0)
    problem = OrbitProblem(origin, target, meeting.sail, meeting.effort)
    return planar_guess(problem, asked.device, asked.characteristic_acceleration)


def _best_of_window(asked: Asked, planar: PlanarGuess | None, length: float, dates: int, workers: int) -> Rendezvous:
    """The flight of the best date from the epoch to a length in s after it, with the curve of the window."""
    meeting, effort = asked.meeting, asked.meeting.effort
    anchors = np.linspace(0.0, length, int(np.clip(length // APART + 2, FEWEST_ANCHORS, MOST_ANCHORS)))
    done = 0

    def fresh(departure: float) -> list[Unknowns]:
        nonlocal done
        found = meeting.fresh(departure, planar)
        flights.extend(found)
        done += 1
        effort.count("dates searched afresh")
        effort.report(0.6 * done / len(anchors), "departures")
        return found

    def followed(unknowns: Unknowns) -> None:
        bests.append(launch_dates.local_best(meeting, unknowns, 0.0, length))

    flights: list[Unknowns] = []
    bests: list[LocalBest | None] = []
    times = np.linspace(0.0, length, dates)
    curve: Curve = [None] * dates
    with effort.stoppable(), ThreadPoolExecutor(workers) as pool:
        list(pool.map(fresh, anchors))
        fast = TOO_SLOW * min((x.span for x in flights), default=np.inf)
        list(pool.map(followed, [x for x in flights if x.span <= fast]))
        effort.report(0.8, "departures")
        begun = _begun(meeting, [*flights, *(x.flight for x in launch_dates.distinct(bests))], times)
        ways = list(pool.map(lambda way: _hand_on(meeting, begun, times, way), (1, -1)))
        curve = [fastest(point) for point in zip(*ways, strict=True)]
        effort.report(0.85, "departures")
        waiting = _waiting_is_faster(curve, times)
        again = pool.map(lambda i: fastest(meeting.fresh(float(times[i]), planar)), waiting)
        new = {i: x for i, x in zip(waiting, again, strict=True) if x is not None and x is fastest([x, curve[i]])}
        begun = [new.get(i, x) for i, x in enumerate(curve)]
        ways = list(pool.map(lambda way: _hand_on(meeting, begun, times, way, set(new)), (1, -1)))
        curve = [fastest(point) for point in zip(*ways, strict=True)]
        effort.report(0.9, "departures")
        known = launch_dates.distinct(bests)
        deeper = [x for x in _valleys(curve) if not any(_leads_to(x, best, length / dates) for best in known)]
        list(pool.map(followed, deeper))
    return _of_window(asked, launch_dates.distinct(bests), flights, times, curve, planar)


def _of_window(
    asked: Asked,
    bests: list[LocalBest],
    flights: list[Unknowns],
    times: np.ndarray,
    curve: Curve,
    planar: PlanarGuess | None,
) -> Rendezvous:
    first = asked.meeting.epoch
    best = fastest([*(x.flight for x in bests), *flights])
    if best is None:
        begin = first.astype("datetime64[s]")
        last = begin + np.timedelta64(round(times[-1]), "s")
        ending = _without_success(asked.meeting.effort, planar)
        return _nothing(asked, first, f"no flight found that leaves between {begin} and {last}", ending)
    spans = np.array([np.nan if x is None else x.span for x in curve])
    edge = next((("first", "last")[int(x.slope < 0)] for x in bests if x.flight is best and x.at_edge), "")
    window = Window(
        departures=first + (times * 1e9).astype("timedelta64[ns]"),
        times=spans * TIME_UNIT,
        best_departures=first + (np.array([x.flight.departure for x in bests]) * 1e9).astype("timedelta64[ns]"),
        best_times=np.array([x.flight.span for x in bests]) * TIME_UNIT,
        edge=edge,
    )
    return _result(asked, best, max(len(bests), 1), window)


def _begun(meeting: Meeting, flights: list[Unknowns], times: np.ndarray) -> Curve:
    """Flights, each brought to the date of the times (n,) s that is nearest to it; the fastest of each."""
    curve: Curve = [None] * len(times)
    for x in flights:
        i = int(np.argmin(np.abs(times - x.departure)))
        curve[i] = fastest([curve[i], meeting.carried(x, times[i])])
    return curve


def _valleys(curve: Curve) -> list[Unknowns]:
    """The flights of the curve that no neighbour beats."""
    around = [None, *curve, None]
    return [
        x
        for before, x, after in zip(around, curve, around[2:], strict=False)
        if x is not None and all(y is None or x.span <= y.span for y in (before, after))
    ]


def _leads_to(unknowns: Unknowns, best: LocalBest, spacing: float) -> bool:
    """Whether a flight of the curve is the neighbour of a best date that is known."""
    near = abs(unknowns.departure - best.flight.departure) <= spacing
    return near and unknowns.span >= best.flight.span * (1 - FASTER)


def _waiting_is_faster(curve: Curve, times: np.ndarray) -> list[int]:
    """Dates whose flight is not the fastest, or is missing: to wait, the sail edge-on beside the body that is left, for
    the flight of a later date would come to the target before it."""
    arrivals = np.array([np.inf if x is None else times[i] + x.span * TIME_UNIT for i, x in enumerate(curve)])
    later = np.append(np.minimum.accumulate(arrivals[::-1])[::-1][1:], np.inf)
    return [i for i, x in enumerate(curve) if x is None or arrivals[i] > later[i] * (1 + FASTER)]


def _hand_on(meeting: Meeting, begun: Curve, times: np.ndarray, way: int, only: set[int] | None = None) -> Curve:
    """Flights handed on from date to date, wherever they are faster. only : from these dates on."""
    found, before = list(begun), None
    order = range(len(times)) if way > 0 else range(len(times) - 1, -1, -1)
    handed = False
    for i in order:
        if before is not None and (only is None or handed or i - way in only):
            x, here = meeting.carried(before, times[i]), found[i]
            handed = x is not None and (here is None or x.span < here.span * (1 - FASTER))
            if handed:
                found[i] = x
        before = found[i]
    return found


def _result(asked: Asked, unknowns: Unknowns, local: int, window: Window | None = None) -> Rendezvous:
    effort, meeting = asked.meeting.effort, replace(asked.meeting, effort=Effort())  # to be told even if it was stopped
    start, span = meeting.start(unknowns), unknowns.span
    flight = costates.propagate(start, span, meeting.sail, times=np.linspace(0, span, ROWS), tolerance=TIGHT)
    (there,) = meeting.state(meeting.target, unknowns.departure + span * TIME_UNIT)
    ends = meeting.ends(unknowns)
    departure = meeting.epoch + np.timedelta64(round(unknowns.departure * 1e9), "ns")
    passing = isinstance(meeting, Passing)
    ways = f"{'the ways past' if passing else 'both ways of meeting'} {meeting.target.name}"
    where = "the window's dates" if window is not None else ways
    effort.report(1.0, "done")
    return Rendezvous(
        time=float(span * TIME_UNIT),
        departure=departure,
        arrival=departure + np.timedelta64(round(span * TIME_UNIT * 1e9), "ns"),
        revolutions=revolutions(flight.rows),
        costates=unknowns.costates / ends.arrival,
        residual=float(np.abs(meeting.misses(flight.end[None], there[None])).max()),
        hamiltonian=flight.hamiltonian / ends.arrival,
        hamiltonian_drift=flight.drift / ends.arrival,
        solutions=local,
        claim=f"best found over {where}; a faster flight is not excluded.{effort.found().mark}",
        feasible=True,
        reason="",
        position=start[POSITION] * AU,
        velocity=start[VELOCITY] * SPEED_UNIT,
        device=asked.device,
        characteristic_acceleration=asked.characteristic_acceleration,
        window=window,
        slope=ends.slope,
        passing_speed=float(np.linalg.norm(flight.end[VELOCITY] - there[VELOCITY]) * SPEED_UNIT) if passing else np.nan,
        ending=effort.found(),
    )


def _nothing(asked: Asked, first: np.datetime64, reason: str, ending: Ending | None = None) -> Rendezvous:
    """The result where there is no flight; ending : of a search before, by default of this one."""
    ending = ending or _without_success(asked.meeting.effort)
    if ending.nearest and ending.nearest not in reason:
        reason = f"{reason}; {ending.nearest}"
    (state,) = asked.meeting.state(asked.meeting.origin, 0.0)
    return Rendezvous(
        np.nan, first, np.datetime64("NaT"), np.nan, np.full(6, np.nan), np.nan, np.nan, np.nan, 0, reason,
        False, reason, state[POSITION] * AU, state[VELOCITY] * SPEED_UNIT, asked.device,
        asked.characteristic_acceleration, ending=ending,
    )  # fmt: skip


def _without_success(effort: Effort, planar: PlanarGuess | None = None) -> Ending:
    """How a search ended that found no flight. planar : one that there is between circles."""
    advice = ["take a higher characteristic acceleration", "leave on another date, or on the best of a window"]
    if effort.stopped:
        advice.append(f"give the search more time than the {effort.seconds:.3g} s it had")
    nearest = ""
    if planar is not None:
        days = planar.span * TIME_UNIT / DAY
        nearest = f"between circles of the two mean distances, with the bodies anywhere on them, it takes {days:.4f} d"
    return effort.not_found(nearest, *advice)
