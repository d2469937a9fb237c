"""Fastest flights from the Earth, or another planet, to meet a planet where it is: for a date, or a window of dates.

Each date is solved as in `planet_conditions`; from date to date flights are handed on, wherever they are faster, and
the best date is refined. Costates are given as -d time / d (position, velocity): lam . (f - motion of the planet) = 1
at arrival.
"""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

import numpy as np

from sailviz import ephemeris
from sailviz.constants import AU
from sailviz.design.minimum_time import costates
from sailviz.design.minimum_time.orbit_conditions import OrbitProblem, PlanarGuess
from sailviz.design.minimum_time.orbits import ROWS, NoGuess, planar_guess
from sailviz.design.minimum_time.planet_conditions import SPREAD, Meeting
from sailviz.design.minimum_time.state_costate import (
    COSTATES,
    POSITION,
    SPEED_UNIT,
    STATE,
    TIME_UNIT,
    VELOCITY,
    canonical_sail,
    revolutions,
)
from sailviz.design.minimum_time.unknowns import TIGHT, Unknowns, fastest, span_of
from sailviz.propulsion.solar_sail import Film

DATES = 41  # tried in a window
ANCHORS = 4  # dates between two of a window's fresh searches
FASTER = 1e-9  # relative flight time by which a flight handed on must win


@dataclass(frozen=True)
class Window:
    """Launch-window curve: departures (n,) datetime64, times (n,) s of the fastest flight found, NaN where none was."""

    departures: np.ndarray
    times: np.ndarray


@dataclass(frozen=True)
class Rendezvous:
    """A flight that meets a planet. time s; departure, arrival datetime64; revolutions swept about the Sun; costates
    (6,) at departure, -d time / d (position, velocity) in units of mu = 1 and one au; hamiltonian, the H that belongs
    to them: +1 and the planet's motion at the arrival times the costates there, since the end moves; residual, largest
    miss in the same units; hamiltonian_drift relative, along the flight; solutions distinct ones found for this date.
    position m and velocity m/s (3,) at departure. window : the curve around the best departure, where a window was
    asked for.

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


Date = np.datetime64 | str
Curve = list[Unknowns | None]  # the fastest flight, or none, of each date


def rendezvous(
    target: str,
    departure: Date | tuple[Date, Date] | list[Date],
    device: Film | str = "ideal",
    characteristic_acceleration: float = 1e-3,
    *,
    origin: str = "Earth",
    dates: int = DATES,
    source: str = "mean-elements",
    workers: int = 2,
    progress: Callable[[float, str], None] | None = None,
) -> Rendezvous:
    """The fastest flight found from a planet to another that leaves on a date, or on the best date of a window.

    target, origin : names in `ephemeris.PLANETS`. departure : a datetime64 or its text, or a pair (first, last), of
    which evenly spread dates are tried, and the best is refined to seconds. device : a sail's name or a Film.
    characteristic_acceleration : m/s2. source : as in `ephemeris.planet_position`. progress(share, words). Starts and
    ends with the planets' velocities; their pull is neglected. Locally optimal, best found: others are not excluded.
    ValueError for planets, a window or a thrust that are none.
    """
    _check(target, origin, characteristic_acceleration)
    first, last = _window(departure)
    meeting = Meeting(origin, target, first, canonical_sail(device, characteristic_acceleration), source)
    length = float((last - first) / np.timedelta64(1, "ns")) * 1e-9
    times = np.linspace(0.0, length, dates) if length > 0 else np.zeros(1)
    anchors = sorted({*range(0, len(times), ANCHORS), len(times) - 1})
    total, done = len(anchors) + 3, 0

    def report() -> None:
        nonlocal done
        done += 1
        if progress is not None:
            progress(done / total, "departures")

    try:
        planar = _planar(meeting, device, characteristic_acceleration)
    except NoGuess as reason:
        return _nothing(meeting, first, str(reason), device, characteristic_acceleration)
    curve, solutions = _curve(meeting, times, anchors, planar, workers, report)
    report()
    best = fastest(curve)
    if best is None:
        when = f"that leaves between {first} and {last}" if last > first else f"for {first}"
        return _nothing(meeting, first, f"no flight found {when}", device, characteristic_acceleration)
    i, window = curve.index(best), None
    if length > 0:
        spans = np.array([np.nan if x is None else x.span for x in curve])
        window = Window(first + (times * 1e9).astype("timedelta64[ns]"), spans * TIME_UNIT)
        best = _refined(meeting, best, times, i)
    report()
    found = _result(meeting, best, device, characteristic_acceleration, solutions.get(i, 1), window)
    report()
    return found


def _check(target: str, origin: str, characteristic_acceleration: float) -> None:
    for name in (target, origin):
        if name not in ephemeris.PLANETS:
            raise ValueError(f"no ephemeris for {name!r}; there are {', '.join(ephemeris.PLANETS)}")
    if target == origin:
        raise ValueError(f"a rendezvous joins two planets, not {target} with itself")
    if not (np.isfinite(characteristic_acceleration) and characteristic_acceleration > 0):
        raise ValueError(f"a characteristic acceleration must be positive, not {characteristic_acceleration}")


def _window(departure: Date | tuple[Date, Date] | list[Date]) -> tuple[np.datetime64, np.datetime64]:
    """First and last date; the same one where a single date was given."""
    pair = departure if isinstance(departure, tuple | list) else (departure, departure)
    first, last = (np.datetime64(date).astype("datetime64[ns]") for date in pair)
    if last < first:
        raise ValueError(f"the window ends, {last}, before it begins, {first}")
    return first, last


def _planar(meeting: Meeting, device: Film | str, characteristic_acceleration: float) -> PlanarGuess:
    """The flight between circles of the planets' mean distances."""
    origin, target = meeting.orbit(meeting.origin, 0.0), meeting.orbit(meeting.target, 0.0)
    return planar_guess(OrbitProblem(origin, target, meeting.sail), device, characteristic_acceleration)


def _curve(
    meeting: Meeting,
    times: np.ndarray,
    anchors: list[int],
    planar: PlanarGuess,
    workers: int,
    searched: Callable[[], None],
) -> tuple[Curve, dict[int, int]]:
    """The fastest flight of each of the times (n,) s, from fresh searches at the anchors handed on both ways; and how
    many flights each of these searches found, if any. searched() is called after each."""

    def fresh(i: int) -> list[Unknowns]:
        found = meeting.fresh(times[i], planar)
        searched()
        return found

    with ThreadPoolExecutor(workers) as pool:
        found = dict(zip(anchors, pool.map(fresh, anchors), strict=True))
        begun: Curve = [found[i][0] if found.get(i) else None for i in range(len(times))]
        ways = list(pool.map(lambda way: _hand_on(meeting, begun, times, way), (1, -1)))
    curve = [fastest(point) for point in zip(*ways, strict=True)]
    return curve, {i: len(flights) for i, flights in found.items() if flights}


def _hand_on(meeting: Meeting, begun: Curve, times: np.ndarray, way: int) -> Curve:
    """Flights handed on from date to date, wherever they are faster."""
    found, before = list(begun), None
    order = range(len(times)) if way > 0 else range(len(times) - 1, -1, -1)
    for i in order:
        if before is not None:
            x, here = meeting.carried(before, times[i]), found[i]
            if x is not None and (here is None or x.span < here.span * (1 - FASTER)):
                found[i] = x
        before = found[i]
    return found


def _refined(meeting: Meeting, unknowns: Unknowns, times: np.ndarray, i: int) -> Unknowns:
    """The flight of the best departure between the neighbours of date i, to seconds."""
    from scipy.optimize import minimize_scalar

    low, high = times[max(i - 1, 0)], times[min(i + 1, len(times) - 1)]
    best = unknowns

    def span(departure: float) -> float:
        nonlocal best
        y = meeting.carried(best, departure)
        if y is None:
            return np.inf
        best = min(best, y, key=span_of)
        return y.span

    minimize_scalar(span, bounds=(low, high), method="bounded", options={"xatol": 60.0, "maxiter": 30})
    return best


def _result(
    meeting: Meeting,
    unknowns: Unknowns,
    device: Film | str,
    characteristic_acceleration: float,
    local: int,
    window: Window | None,
) -> Rendezvous:
    start, span = meeting.start(unknowns), unknowns.span
    flight = costates.propagate(start, span, meeting.sail, times=np.linspace(0, span, ROWS), tolerance=TIGHT)
    met = unknowns.departure + span * TIME_UNIT
    before, there, after = meeting.state(meeting.target, met + np.array([-SPREAD, 0.0, SPREAD]))
    motion = (after - before) / (2 * SPREAD / TIME_UNIT)  # mean elements do not move quite as Kepler has it
    gain = flight.hamiltonian - float(motion @ flight.end[COSTATES])
    departure = meeting.epoch + np.timedelta64(round(unknowns.departure * 1e9), "ns")
    where = "the window's dates" if window is not None else "both ways of meeting the planet"
    return Rendezvous(
        time=float(span * TIME_UNIT),
        departure=departure,
        arrival=departure + np.timedelta64(round(span * TIME_UNIT * 1e9), "ns"),
        revolutions=revolutions(flight.rows),
        costates=unknowns.costates / gain,
        residual=float(np.abs(flight.end[STATE] - there).max()),
        hamiltonian=flight.hamiltonian / gain,
        hamiltonian_drift=flight.drift / gain,
        solutions=local,
        claim=f"best found over {where}; a faster flight is not excluded",
        feasible=True,
        reason="",
        position=start[POSITION] * AU,
        velocity=start[VELOCITY] * SPEED_UNIT,
        device=device,
        characteristic_acceleration=characteristic_acceleration,
        window=window,
    )


def _nothing(
    meeting: Meeting, first: np.datetime64, reason: str, device: Film | str, characteristic_acceleration: float
) -> Rendezvous:
    (state,) = meeting.state(meeting.origin, 0.0)
    return Rendezvous(
        np.nan, first, np.datetime64("NaT"), np.nan, np.full(6, np.nan), np.nan, np.nan, np.nan, 0, reason,
        False, reason, state[POSITION] * AU, state[VELOCITY] * SPEED_UNIT, device, characteristic_acceleration,
    )  # fmt: skip
