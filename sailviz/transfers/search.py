"""How fast a sail gets from one orbit to another, asked in words.

    from sailviz import transfers
    solution = transfers.find("earth", "mars", "ideal", 1e-3)
    print(transfers.scene_of(solution))

The search is that of `design.minimum_time`; here are the orbits of the planets and what a question may say.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from sailviz.design.direct.extra import there_is_casadi
from sailviz.design.direct.limits import Limits
from sailviz.design.direct.search import DirectFlight
from sailviz.design.direct.transcription import NO_LIMITS
from sailviz.design.minimum_time.circles import circle_to_circle
from sailviz.design.minimum_time.effort import IMPOSSIBLE, NOT_FOUND, Effort, Progress, Stopped
from sailviz.design.minimum_time.orbits import STARTS, OrbitTransfer, orbit_to_orbit
from sailviz.design.minimum_time.planar_transfer import Transfer, no_transfer
from sailviz.design.minimum_time.planet_rendezvous import DATES, Date, Rendezvous, rendezvous
from sailviz.propulsion.devices import ELECTRIC_SAILS
from sailviz.propulsion.solar_sail import FILMS, Film
from sailviz.transfers.direct import METHODS, in_the_plane
from sailviz.transfers.direct_bodies import to_body
from sailviz.transfers.ends import NO_BOUNDS, Arrival, Bounds, Distance, End, FlyBy
from sailviz.transfers.places import Place, circle, names, place, trusted
from sailviz.words import nearest

PLACES = names()
SAILS = (*FILMS, *ELECTRIC_SAILS)
SAME_CIRCLE = 1e-4  # relative difference of two radii


@dataclass(frozen=True)
class Solution:
    """A transfer found, or the nearest: kind "circles", "orbits", "rendezvous" or "end", where from and where to, and
    the flight with its time, costates, residual and claim. Of kind "end" also the end, None for the circle of the
    target, and the limits kept to; the target of a distance is its circle, of an escape none. notes : sentences on how
    far the bodies' elements can be trusted."""

    kind: str
    origin: Place
    target: Place | None
    flight: Transfer | OrbitTransfer | Rendezvous | DirectFlight
    notes: tuple[str, ...] = ()
    end: End | None = None
    within: Bounds = NO_BOUNDS

    @property
    def outcome(self) -> str:
        """ "found", "not found" by this search, which proves nothing, or "impossible", which is proven: `flight.ending`
        says what was tried, what came nearest and what to change."""
        return self.flight.ending.outcome


def find(
    origin: str | Place,
    target: str | Place | None,
    device: Film | str = "ideal",
    characteristic_acceleration: float = 1e-3,
    *,
    end: End | None = None,
    within: Bounds = NO_BOUNDS,
    orbits: bool = False,
    departure: Date | tuple[Date, Date] | None = None,
    starts: int | None = None,
    dates: int | None = None,
    method: str = "auto",
    limits: Limits = NO_LIMITS,
    progress: Progress | None = None,
    time_limit: float | None = None,
    effort: Effort | None = None,
) -> Solution:
    """The fastest flight found from one place to another; nothing need be guessed.

    origin, target : names in PLACES, or a Place. device : a name in SAILS or a Film, characteristic_acceleration m/s2.
    Between circles at the mean distances; with orbits=True, or to an inclined circle, between the orbits in space with
    free anomalies; with departure, a date or (first, last) as datetime64 or text, from body to body. end : what the
    flight comes to instead of an orbit (`transfers.ends`), within : what it then keeps to, between circles; a target is
    None but for a FlyBy, which goes past the body itself where there is a departure. starts, dates : of
    `orbit_to_orbit` and `rendezvous`. method : "indirect", by costates; "direct", by collocation and confirmed by the
    indirect one, in the plane or from body to body, with the extra `direct` only; "auto", the direct one where the
    other fails or limits are set: those it keeps to, and an answer under them is a DirectFlight. progress(share, words)
    is called now and then; after time_limit s of wall time the best so far is the answer, marked; effort : an `Effort`
    instead of both, which may listen to Ctrl-C. ValueError for what is no place, sail or date; where no flight was
    found, `Solution.outcome` says whether there is none.
    """
    effort = Effort.of(effort, progress, time_limit)
    begin = place(origin) if isinstance(origin, str) else origin
    aim = place(target) if isinstance(target, str) else target
    if isinstance(device, str) and device not in SAILS:
        raise ValueError(f'there is no sail called "{device}". {nearest(device, SAILS)}')
    in_space = orbits or (aim is not None and aim.inclined)
    _check_method(method, limits, in_space)
    a_c = characteristic_acceleration
    if departure is not None and aim is not None and (end is None or isinstance(end, FlyBy)):
        return _at_dates(begin, aim, device, a_c, departure, dates, end, within, method, limits, effort)
    if end is not None or within.any:
        if departure is not None or in_space:
            raise ValueError("other ends and limits are those of flights between circles in one plane")
        return _to_end(begin, aim, device, a_c, end, within, method, limits, effort)
    if aim is None:
        raise ValueError("a flight that has no end of its own needs a target")
    if in_space:
        first = begin if orbits else circle(begin.radius, name=begin.name)
        count = STARTS if starts is None else starts
        found = orbit_to_orbit(first.orbit, aim.orbit, device, a_c, starts=count, effort=effort)
        return Solution("orbits", first, aim, found)
    return _between_circles(begin, aim, device, a_c, method, limits, effort)


def _between_circles(
    origin: Place,
    target: Place,
    device: Film | str,
    characteristic_acceleration: float,
    method: str,
    limits: Limits,
    effort: Effort,
) -> Solution:
    """By the indirect method, and where that answers nothing, or keeps to no limits, by the direct one."""
    begin, aim = (circle(end.radius, name=end.name) for end in (origin, target))
    if abs(aim.radius / begin.radius - 1) < SAME_CIRCLE:
        raise ValueError(f"{aim.name} is where {begin.name} is: between the two circles there is nothing to fly")
    if method != "direct" and not limits.any:
        flight = circle_to_circle(begin.radius, aim.radius, device, characteristic_acceleration, effort=effort)
        done = flight.feasible or effort.stopped or flight.ending.outcome == IMPOSSIBLE
        if done or method == "indirect" or not _may_be_direct(device):
            return Solution("circles", begin, aim, flight)
    direct = in_the_plane(
        begin.radius, aim.radius, None, NO_BOUNDS, device, characteristic_acceleration, limits=limits, effort=effort
    )  # fmt: skip
    return Solution("circles", begin, aim, direct)


def _to_end(
    origin: Place,
    target: Place | None,
    device: Film | str,
    characteristic_acceleration: float,
    end: End | None,
    within: Bounds,
    method: str,
    limits: Limits,
    effort: Effort,
) -> Solution:
    """A flight in one plane to an end that is no orbit, or within limits: methods as between circles."""
    from sailviz.transfers.to_ends import flight_to_end

    if (target is None) == (end is None or isinstance(end, FlyBy)):
        raise ValueError("a fly-by and a circle have a target, and no other end has one")
    if isinstance(end, (Distance, Arrival)):
        target = circle(end.radius)
    begin = circle(origin.radius, name=origin.name)
    aim = None if target is None else circle(target.radius, name=target.name)
    radius = None if aim is None else aim.radius
    if method != "direct" and not limits.any:
        found = flight_to_end(begin.radius, radius, end, within, device, characteristic_acceleration, effort)
        done = found.feasible or effort.stopped or found.ending.outcome == IMPOSSIBLE
        if done or method == "indirect" or not _may_be_direct(device):
            return Solution("end", begin, aim, found, end=end, within=within)
    proof = within.impossible(begin.radius, radius)
    if proof:
        none = no_transfer(device, characteristic_acceleration, begin.radius, proof, effort.impossible())
        return Solution("end", begin, aim, none, end=end, within=within)
    direct = in_the_plane(
        begin.radius, radius, end, within, device, characteristic_acceleration, limits=limits, effort=effort
    )
    return Solution("end", begin, aim, direct, end=end, within=within)


def _check_method(method: str, limits: Limits, elsewhere: bool) -> None:
    """ValueError for a method that is none or that does not answer the question. elsewhere : it is not asked between
    circles in one plane."""
    if method not in METHODS:
        raise ValueError(f'there is no method "{method}". {nearest(method, METHODS)}')
    if elsewhere and (method == "direct" or limits.any):
        what = "the direct method" if method == "direct" else "a limit on the way"
        raise ValueError(f"{what} is for flights in one plane, or from body to body on a date")
    if method == "indirect" and limits.any:
        raise ValueError("limits on the way are kept by the direct method only")


def _may_be_direct(device: Film | str) -> bool:
    """Whether the direct method is installed and knows a sail."""
    return there_is_casadi() and (device not in ELECTRIC_SAILS or device == "electric-sail")


def dates_of(flight: Rendezvous | DirectFlight) -> tuple[np.datetime64, np.datetime64]:
    """Departure and arrival, UTC, of a flight between bodies."""
    if isinstance(flight, DirectFlight):
        return flight.leaves, flight.arrives
    return flight.departure, flight.arrival


def _at_dates(
    origin: Place,
    target: Place,
    device: Film | str,
    characteristic_acceleration: float,
    departure: Date | tuple[Date, Date],
    dates: int | None,
    end: End | None,
    within: Bounds,
    method: str,
    limits: Limits,
    effort: Effort,
) -> Solution:
    """From body to body where they are, or past it: methods as between circles."""
    if origin.body is None or target.body is None:
        none = origin if origin.body is None else target
        raise ValueError(f"a date needs bodies whose places are known, and {none.name} is none of them")
    if within.any or limits.any:
        raise ValueError("limits on the way are those of flights in one plane: a flight on a date keeps to none")
    pair = departure if isinstance(departure, tuple | list) else (departure, departure)
    try:
        first, last = (np.datetime64(date).astype("datetime64[ns]") for date in pair)
    except ValueError:
        raise ValueError(f"{departure!r} is no date: write 2030-01-01") from None
    for one in (origin, target):
        trusted(one, first)
    flyby, a_c = isinstance(end, FlyBy), characteristic_acceleration
    found: Rendezvous | DirectFlight | None = None
    if method != "direct":
        found = rendezvous(
            target.body, (first, last), device, a_c, origin=origin.body, flyby=flyby,
            dates=DATES if dates is None else dates, effort=effort,
        )  # fmt: skip
    if found is None or not (found.feasible or effort.stopped or method == "indirect" or not _may_be_direct(device)):
        found = to_body(
            origin.body, target.body, (first, last), device, a_c, flyby=flyby, limits=NO_LIMITS, effort=effort
        )  # fmt: skip
    notes: list[str] = []
    if found.feasible:
        moments = dates_of(found)
        notes = [note for one, date in zip((origin, target), moments, strict=True) for note in trusted(one, date)]
    return Solution("rendezvous", origin, target, found, tuple(notes), end=end, within=within)


NOT_SEARCHED = "not searched"  # a flight of a table whose time was over before


@dataclass(frozen=True)
class FlightTimes:
    """time (n, k) s over characteristic_acceleration (n,) m/s2 for k devices, NaN where there is none; revolutions
    (n, k); outcome (n, k): that of each search, or NOT_SEARCHED."""

    characteristic_acceleration: np.ndarray
    devices: tuple[str, ...]
    time: np.ndarray
    revolutions: np.ndarray
    outcome: np.ndarray


def flight_times(
    origin: str | Place,
    target: str | Place,
    devices: Sequence[str],
    characteristic_acceleration: npt.ArrayLike,
    *,
    progress: Progress | None = None,
    time_limit: float | None = None,
    effort: Effort | None = None,
) -> FlightTimes:
    """Flight times between circles, each from a search of its own. devices : names; acceleration (n,) m/s2. progress,
    time_limit, effort : as of `find`, for all of them together; a search that it ends counts as not searched, unless it
    had found a flight."""
    effort = Effort.of(effort, progress, time_limit)
    a_c = np.asarray(characteristic_acceleration, dtype=float)
    time, turns = (np.full((len(a_c), len(devices)), np.nan) for _ in range(2))
    outcome = np.full(time.shape, NOT_SEARCHED, dtype=object)
    with effort.stoppable():
        for k, device in enumerate(devices):
            for i, a in enumerate(a_c):
                effort.check()
                done = (k * len(a_c) + i) / time.size
                effort.report(done, f"{device}, {a * 1e3:g} mm/s²")
                found = find(origin, target, device, float(a), effort=effort.part(done, done + 1 / time.size))
                if found.outcome == NOT_FOUND and effort.stopped:
                    raise Stopped
                outcome[i, k] = found.outcome
                time[i, k], turns[i, k] = found.flight.time, found.flight.revolutions
    return FlightTimes(a_c, tuple(devices), time, turns, outcome)
