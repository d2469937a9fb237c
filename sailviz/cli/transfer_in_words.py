"""What the search for a transfer found, in words for a person and in values for a script."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from sailviz.cli.transfer_ends_in_words import heading, name_of_target, rows_of_end, values_of_end
from sailviz.constants import AU, DAY

if TYPE_CHECKING:
    import numpy as np

    from sailviz.design.direct import DirectFlight
    from sailviz.design.minimum_time import OrbitTransfer, Rendezvous, Transfer
    from sailviz.design.minimum_time.effort import Ending
    from sailviz.design.minimum_time.planet_rendezvous import Window
    from sailviz.transfers import Solution

MOST_OF = 0.5  # of a flight at partial voltage: from there on a stronger sail is hardly faster


def direct_words(found: Solution, flight: DirectFlight) -> Iterator[str]:
    """What the direct method found and the indirect one has not confirmed, line by line."""
    from sailviz.design.minimum_time.state_costate import TIME_UNIT
    from sailviz.transfers import device_words

    yield _title(found)
    yield f"{device_words(flight.device)}, {flight.characteristic_acceleration * 1e3:g} mm/s² at 1 au"
    if not flight.feasible:
        yield from _without_an_answer(flight.reason, flight.ending)
        return
    assert flight.flown is not None, "a flight that was found was flown"
    rows = [("flight time", f"{flight.days} d, {flight.revolutions:.4f} revolutions about the Sun")]
    rows += [("found by", f"the direct method; {_confirmation(flight)}")]
    rows += [("flown again", f"its table misses the end by {flight.miss:.1e}, worth {flight.error / DAY:.1g} d")]
    if found.kind == "rendezvous":
        rows[1:1] = [("departure", _day(flight.leaves)), ("arrival", _day(flight.arrives))]
    if found.kind == "end":
        rows += rows_of_end(found, flight.flown.position, flight.flown.velocity)
    rows += [("closest to the Sun", f"{flight.closest / AU:.4f} au")]
    kinds = {"T": "thrust", "C": "coast", "S": "partial voltage"}
    if flight.arcs:
        days = [f"{kinds[arc.kind]} {arc.duration * TIME_UNIT / DAY:.1f} d" for arc in flight.arcs]
        rows += [("arcs", ", ".join(days))]
    rows += [("local solutions", f"{len(flight.solutions)} found")]
    for name, value in rows:
        yield f"  {name:<19}{value}"
    yield "  " + flight.claim
    yield from (f"  Mind: {note}." for note in found.notes)


def _held(flight: DirectFlight) -> str:
    from sailviz.design.minimum_time.state_costate import TIME_UNIT

    rate = flight.limits.turn_rate
    return "" if rate is None else f"; the sail turns by {math.degrees(rate) / TIME_UNIT * DAY:.3g}° a day at most"


def _confirmation(flight: DirectFlight) -> str:
    if flight.limits.cone is not None or flight.limits.turn_rate is not None:
        return "of a sail that is held the indirect one confirms nothing" + _held(flight)
    return "the indirect one did not confirm it"


def words(found: Solution) -> Iterator[str]:
    """What was found, line by line."""
    from sailviz.design.direct import DirectFlight
    from sailviz.design.minimum_time import Rendezvous
    from sailviz.transfers import device_words

    flight = found.flight
    if isinstance(flight, DirectFlight):
        yield from direct_words(found, flight)
        return
    craft = device_words(flight.device)
    yield _title(found)
    yield f"{craft}, {flight.characteristic_acceleration * 1e3:g} mm/s² at 1 au"
    if not flight.feasible:
        yield from _without_an_answer(flight.reason, flight.ending)
        return
    for name, value in _rows(found, flight):
        yield f"  {name:<19}{value}"
    yield "  " + flight.claim[0].upper() + flight.claim[1:] + ("" if flight.claim.endswith(".") else ".")
    for note in found.notes:
        yield f"  Mind: {note}."
    if isinstance(flight, Rendezvous) and flight.window is not None:
        yield from _window(flight, flight.window)


def _title(found: Solution) -> str:
    """From where to where, and in what sense."""
    ways = {
        "circles": "between circles in one plane",
        "orbits": "between orbits in space, both anomalies free",
        "rendezvous": f"to meet {name_of_target(found)} where it is",
    }
    if found.kind == "end":
        return heading(found)
    if found.end is not None:
        title = f"{found.origin.name} past {name_of_target(found)} where it is, at any speed"
    else:
        title = f"{found.origin.name} to {name_of_target(found)}, {ways[found.kind]}"
    return ", ".join(part for part in (title, found.within.words) if part)


def _rows(found: Solution, flight: Transfer | OrbitTransfer | Rendezvous) -> list[tuple[str, str]]:
    """Names and words of what is to be said of a flight that was found."""
    import numpy as np

    from sailviz.design.minimum_time import Rendezvous, Transfer
    from sailviz.transfers import path_of

    rows = [("flight time", f"{flight.time / DAY:.6f} d, {flight.revolutions:.4f} revolutions about the Sun")]
    if isinstance(flight, Rendezvous):
        rows += [("departure", _day(flight.departure)), ("arrival", _day(flight.arrival))]
        if found.end is not None:
            rows += [("passes it at", f"{flight.passing_speed / 1e3:.4f} km/s")]
    elif found.kind == "orbits":
        anomalies = f"{np.degrees(flight.departure_anomaly):.4f}° and {np.degrees(flight.arrival_anomaly):.4f}°"
        rows += [("true anomalies", f"{anomalies} at departure and arrival")]
    rows += [("costates", " ".join(f"{x:.10g}" for x in flight.costates))]
    planar = found.kind in ("circles", "end")
    of = "radius, radial and transverse speed; mu = r0 = 1" if planar else "position, velocity; 1 au"
    scaled = f"H = {flight.hamiltonian:.4f}" if isinstance(flight, Rendezvous) else "H = +1"
    rows += [("", f"of {of}, {scaled}: minus the days won per unit, in {_unit(found):.4f} d")]
    position, velocity, switches = path_of(flight)
    if found.kind == "end":
        rows += rows_of_end(found, position, velocity)
    rows += [("closest to the Sun", f"{np.linalg.norm(position, axis=1).min() / AU:.4f} au")]
    if len(switches):
        rows += [("thrust switches at", ", ".join(f"{t / DAY:.3f}" for t in switches) + " d")]
    if isinstance(flight, Transfer) and flight.throttle is not None:
        rows += _partial_voltage(flight)
    rows += [("residual", f"{flight.residual:.1e}, Hamiltonian drift {flight.hamiltonian_drift:.1e}")]
    rows += [("local solutions", f"{flight.solutions} found")]
    if isinstance(flight, Transfer | Rendezvous) and flight.method.startswith("direct"):
        rows += [("found by", "the direct method; confirmed by the indirect one, whose numbers these are")]
    return rows


def _window(flight: Rendezvous, window: Window) -> Iterator[str]:
    """The best dates of a window, and how long flights take from each of its dates."""
    import numpy as np

    yield from _best_dates(window, flight.slope)
    missing = "not searched" if flight.ending.stopped else "not found"
    yield "  Leaving on       takes, days"
    for day, time in zip(window.departures, window.times, strict=True):
        took = f"{time / DAY:9.3f}" if np.isfinite(time) else missing
        yield f"  {np.datetime_as_string(day, 'D')}       {took}"


def _partial_voltage(flight: Transfer) -> list[tuple[str, str]]:
    """What the throttle between 0 and 1 means."""
    if flight.throttle is None:
        return []
    low, high = flight.throttle
    share = sum(arc.end - arc.start for arc in flight.arcs if arc.kind == "singular")
    said = [
        ("arcs", ", ".join(f"{arc.kind} {(arc.end - arc.start) / DAY:.3f} d" for arc in flight.arcs)),
        ("partial voltage", f"throttle {low:.2f}-{high:.2f} for {share / DAY:.0f} of {flight.time / DAY:.0f} d;"),
        ("", "a sail that can only be on or off approaches this time by fast switching,"),
        ("", "and no on/off flight attains it"),
    ]
    if share > MOST_OF * flight.time:
        said.append(("", "more thrust would gain little: the sail cannot brake, since its thrust points outwards"))
    return said


def _best_dates(window: Window, slope: float) -> Iterator[str]:
    """The local best dates of a window, and what its edge costs."""
    import numpy as np

    if window.edge:
        way = "earlier" if window.edge == "first" else "later"
        yield f"  It is the {window.edge} day of the window: leaving {way} wins {abs(slope):.2f} d of each day."
    others = [
        f"{np.datetime_as_string(day, 'D')} {time / DAY:.2f} d"
        for day, time in zip(window.best_departures, window.best_times, strict=True)
    ][1:]
    if others:
        yield f"  Best nearby only: {', '.join(others)}."


def _without_an_answer(reason: str, ending: Ending) -> Iterator[str]:
    """Why there is no flight: that there can be none, or what a search without success has tried."""
    from sailviz.design.minimum_time.effort import IMPOSSIBLE, STOPPED

    reason = reason.removeprefix("no flight found: ")
    if ending.outcome == IMPOSSIBLE:
        yield f"  Impossible: {reason}."
        return
    yield f"  Not found by this search, which proves nothing: {reason}."
    if ending.stopped:
        yield f"  {STOPPED[ending.stopped]} after {ending.seconds:.1f} s."
    if ending.tried:
        yield f"  Tried: {ending.tried}, in {ending.seconds:.1f} s."
    if ending.advice:
        yield f"  To change: {'; '.join(ending.advice)}."


def _unit(found: Solution) -> float:
    """The canonical unit of time, d."""
    from sailviz.design.minimum_time.state_costate import TIME_UNIT

    radius = found.origin.orbit.semi_major_axis / AU if found.kind in ("circles", "end") else 1.0
    return radius**1.5 * TIME_UNIT / DAY


def _day(moment: np.datetime64) -> str:
    import numpy as np

    return np.datetime_as_string(moment, "m").replace("T", " ") + " UTC"


def summary(found: Solution) -> dict[str, Any]:
    """What was found, for JSON."""
    from sailviz.design.direct import DirectFlight
    from sailviz.design.minimum_time import Rendezvous, Transfer

    flight = found.flight
    if isinstance(flight, DirectFlight):
        return direct_summary(found, flight)
    values: dict[str, Any] = {
        **_asked(found),
        "claim": flight.claim,
        "time_d": _known(flight.time / DAY),
        "revolutions": _known(flight.revolutions),
        "costates": [_known(x) for x in flight.costates],
        "residual": _known(flight.residual),
        "hamiltonian_drift": _known(flight.hamiltonian_drift),
        "local_solutions": flight.solutions,
    }
    if isinstance(flight, Transfer | Rendezvous):
        values |= {"method": flight.method}
    if found.kind == "end":
        values |= values_of_end(found)
    if isinstance(flight, Rendezvous):
        values |= {"departure": str(flight.departure), "arrival": str(flight.arrival)}
        values |= {"slope_d_per_d": _known(flight.slope), "mind": list(found.notes)}
        values |= {"flyby": found.end is not None, "passing_speed_km_s": _known(flight.passing_speed / 1e3)}
    return values


def _asked(found: Solution) -> dict[str, Any]:
    """What was asked and how the search ended, for JSON: the same of every method."""
    flight = found.flight
    return {
        "kind": found.kind,
        "from": found.origin.name,
        "to": name_of_target(found),
        "sail": flight.device,
        "characteristic_acceleration_mm_s2": flight.characteristic_acceleration * 1e3,
        "found": flight.feasible,
        "outcome": found.outcome,
        "stopped": flight.ending.stopped or None,
        "tried": flight.ending.tried,
        "seconds": flight.ending.seconds,
        "nearest": flight.ending.nearest,
        "advice": list(flight.ending.advice),
    }


def direct_summary(found: Solution, flight: DirectFlight) -> dict[str, Any]:
    """What the direct method found and the indirect one has not confirmed, for JSON."""
    values = {
        **_asked(found),
        "claim": flight.claim,
        "method": "direct method",
        "confirmed": False,
        "time_d": _known(round(flight.time / DAY, flight.digits)) if flight.feasible else None,
        "miss": _known(flight.miss),
        "error_d": _known(flight.error / DAY),
        "revolutions": _known(flight.revolutions),
        "closest_au": _known(flight.closest / AU),
        "local_solutions": len(flight.solutions),
    }
    if found.kind == "rendezvous" and flight.feasible:
        values |= {"departure": str(flight.leaves), "arrival": str(flight.arrives)}
        values |= {"flyby": found.end is not None, "mind": list(found.notes)}
    return values | (values_of_end(found) if found.kind == "end" else {})


def days(flight: Transfer | OrbitTransfer | Rendezvous | DirectFlight) -> str:
    """The flight time alone, with the digits that are known."""
    from sailviz.design.direct import DirectFlight

    return flight.days if isinstance(flight, DirectFlight) else f"{flight.time / DAY:.6f}"


def _known(value: float) -> float | None:
    """A number for JSON, which has no NaN."""
    return float(value) if math.isfinite(value) else None
