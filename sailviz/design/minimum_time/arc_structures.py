"""Fastest flights of an electric sail between circles as rows of arcs T (thrust), C (coast) and S (singular), whose
lengths are unknowns, followed from a near circle to a far one; arcs come and go on the way.

On a singular arc the throttle lies between 0 and 1 (`steering.singular`). No flight that switches by itself finds such
an arc, for the surface S = 0 throws off whatever flies beside it; so the arcs are put in by hand, and judged by what
the switching function does. Equations: S = 0 where T and C meet, S = S' = 0 where a singular arc begins, and the
circle at the end. A coast beside a singular arc would solve its own with no length at all, so that there its leading
terms are divided by the length squared; so would an arc between two switches, where they are divided by the length.

Source: re-derived, with the strengthened Kelley condition for a singular arc to be a maximum.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from sailviz.design.minimum_time import shooting
from sailviz.design.minimum_time.boundary_conditions import DIRECTION, ToCircle, hamiltonians, polar
from sailviz.design.minimum_time.costates import propagate
from sailviz.design.minimum_time.finishing import Extremal
from sailviz.design.minimum_time.singular_arcs import KINDS, fly_arcs, propagate_arcs, switching

LENGTHS = 3  # place of the first arc's length among the unknowns, behind the direction of the costates
SOLVED = 1e-9  # largest entry of what is to vanish; it comes to 1e-12 where no coast is nearly without length
ROUNDING = 1e-12  # of S / |p| inside an arc
STEADY = 1e-10  # of H, whose size is 1
SAMPLES = 101  # of every arc that is judged
MOST_ARCS, DEPTH = 9, 3  # of a structure, and of changes made to one in a row
DULL = 0.03  # of an arc's length: a fault so near one end belongs to the arc beside it


Check = Callable[[], None]  # called between pieces of work; what it raises ends the search


def nothing() -> None:
    """The check of a search that nothing ends."""


class Structure(NamedTuple):
    """arcs : letters in KINDS; unknowns (3 + len(arcs),): direction of the costates (lam_r, lam_u, lam_v), lengths."""

    arcs: str
    unknowns: np.ndarray

    @property
    def lengths(self) -> np.ndarray:
        return self.unknowns[LENGTHS:]


class Fault(NamedTuple):
    """Why a row of arcs is no optimal flight: what is wrong, in which arc, and where in it, as a share of its length
    from its beginning (of a throttle below 0: how much of it, from that end)."""

    what: str
    arc: int
    where: float = 0.0


def starts(flight: ToCircle, unknowns: np.ndarray) -> np.ndarray:
    """(n, 12) of unknowns (n, >= 3)."""
    return flight.starts(np.hstack([unknowns[:, DIRECTION], np.zeros((len(unknowns), 1))]))


def misses(flight: ToCircle, arcs: str, unknowns: np.ndarray, radii: np.ndarray | None = None) -> np.ndarray:
    """What is to vanish (n, k) of unknowns (n, k). radii (n,) : of the circles, where they are not the flight's."""
    ends = fly_arcs(starts(flight, unknowns), arcs, unknowns[:, LENGTHS:], flight.sail)
    r, _, u, v = polar(ends[-1])
    radius = np.asarray(flight.radius if radii is None else radii)
    slow = np.sqrt(radius)
    size = np.linalg.norm(unknowns[:, DIRECTION], axis=1)
    found = [r / radius - 1, u * slow, v * slow - 1, size - 1]
    at = [switching(end, flight.sail) for end in ends]
    for i, (arc, following) in enumerate(pairwise(arcs)):
        if arc == "S":
            continue
        here, value = at[i + 1], at[i + 1].value
        if following == "C" and arcs[i + 2 : i + 3] == "S":  # seen from where the coast ends
            length, there = unknowns[:, LENGTHS + i + 1], at[i + 2]
            value = (value - there.value + there.rate * length) / length**2
        elif arc == "C" and i > 0 and arcs[i - 1] == "S":  # seen from where it begins
            length, there = unknowns[:, LENGTHS + i], at[i]
            value = (value - there.value - there.rate * length) / length**2
        elif following != "S" and i > 0 and arcs[i - 1] != "S":  # between two switches
            value = (value - at[i].value) / unknowns[:, LENGTHS + i]
        found.append(value)
        if following == "S":
            found.append(here.rate)
    return np.stack(found, axis=1)


def solve(flight: ToCircle, guess: Structure, check: Check = nothing) -> Structure | None:
    """The lengths and costates that make a row of arcs meet its equations; None where the search for them ends."""
    limit = np.concatenate([[0.2] * LENGTHS, np.maximum(0.3 * np.abs(guess.lengths), 0.2)])

    def batch(unknowns: np.ndarray) -> np.ndarray:
        check()
        return misses(flight, guess.arcs, unknowns)

    found = shooting.solve(batch, guess.unknowns, step=1e-7, goal=1e-13, most=40, limit=limit)
    return Structure(guess.arcs, found.unknowns) if found.residual < SOLVED else None


def faults(flight: ToCircle, solved: Structure) -> list[Fault]:
    """What makes a solution no optimal flight; empty where it is one."""
    wrong = [Fault("length", i) for i, length in enumerate(solved.lengths) if not length > 0]
    if wrong:
        return wrong
    start = starts(flight, solved.unknowns[None])
    scale = float(hamiltonians(start, flight.sail)[0])
    if not scale > 0:
        return [Fault("H", 0)]
    edges = np.concatenate([[0.0], np.cumsum(solved.lengths)])
    share = np.linspace(0.0, 1.0, SAMPLES)
    y = start
    for i, arc in enumerate(solved.arcs):
        length = float(solved.lengths[i])
        flown = propagate_arcs(y[0], [(KINDS[arc], length)], flight.sail, times=share * length)
        y = flown.end[None]
        found = switching(flown.rows, flight.sail)
        wrong += _throttle_faults(i, found.throttle) if arc == "S" else _sign_faults(i, arc, found.value)
        if abs(float(hamiltonians(y, flight.sail)[0]) / scale - 1) > STEADY * max(1.0, edges[-1]):
            wrong.append(Fault("H", i))
    return wrong


def _throttle_faults(i: int, throttle: np.ndarray) -> list[Fault]:
    """A throttle that leaves [0, 1]."""
    if not np.all(np.isfinite(throttle)):
        return [Fault("throttle", i)]
    wrong = []
    for what, margin in (("below", throttle), ("above", 1.0 - throttle)):
        for side, seen in (("start", margin), ("end", margin[::-1])):
            if seen[0] < 0:
                k = int(np.argmax(seen >= 0)) if np.any(seen >= 0) else len(seen) - 1
                part = (k - seen[k] / (seen[k] - seen[k - 1])) / (len(seen) - 1) if seen[k] >= 0 else 1.0
                wrong.append(Fault(f"{what} at {side}", i, float(part)))
    if not wrong and (throttle.min() < 0 or throttle.max() > 1):
        wrong.append(Fault("throttle", i))
    return wrong


def _sign_faults(i: int, arc: str, value: np.ndarray) -> list[Fault]:
    """Thrust where there should be none, or none where there should be."""
    inside = value[1:-1] if arc == "T" else -value[1:-1]
    worst = int(np.argmin(inside))
    return [Fault("sign", i, (worst + 1) / (len(value) - 1))] if inside[worst] <= -ROUNDING else []


def amended(solved: Structure, wrong: list[Fault]) -> Iterator[Structure]:
    """Rows of arcs that may be right where one has these faults."""
    for fault in wrong:
        if fault.what == "length":
            yield _without(solved, fault.arc)
        elif fault.what in ("below at start", "above at start", "below at end", "above at end"):
            yield from _beside_singular(solved, fault)
        elif fault.what == "sign":
            yield from _inserted(solved, fault)


def _rebuilt(solved: Structure, arcs: str, lengths: list[float]) -> Structure:
    return Structure(arcs, np.concatenate([solved.unknowns[DIRECTION], lengths]))


def _without(solved: Structure, i: int) -> Structure:
    """Arc i dropped, its neighbours joined where they are alike."""
    arcs, lengths = solved.arcs, solved.lengths.tolist()
    if 0 < i < len(arcs) - 1 and arcs[i - 1] == arcs[i + 1]:
        joined = [lengths[i - 1] + lengths[i + 1]]
        return _rebuilt(solved, arcs[:i] + arcs[i + 2 :], lengths[: i - 1] + joined + lengths[i + 2 :])
    return _rebuilt(solved, arcs[:i] + arcs[i + 1 :], lengths[:i] + lengths[i + 1 :])


def _beside_singular(solved: Structure, fault: Fault) -> Iterator[Structure]:
    """A coast put at the end of a singular arc where its throttle falls below 0, thrust where it rises above 1.

    With a throttle that is linear in time S comes back to 0 after a coast that begins as long before the throttle's
    root as half of what it goes on behind it.
    """
    i, arcs, lengths = fault.arc, solved.arcs, solved.lengths.tolist()
    new, at_start = ("C" if "below" in fault.what else "T"), "start" in fault.what
    beside = i - 1 if at_start else i + 1
    if not 0 <= beside < len(arcs) or arcs[beside] == new:
        return
    for part in (1.5 * fault.where, 0.75 * fault.where, 0.02, 0.1):
        short = min(part, 0.9) * lengths[i]
        pair = [short, lengths[i] - short] if at_start else [lengths[i] - short, short]
        names = new + "S" if at_start else "S" + new
        yield _rebuilt(solved, arcs[:i] + names + arcs[i + 1 :], lengths[:i] + pair + lengths[i + 1 :])


def _inserted(solved: Structure, fault: Fault) -> Iterator[Structure]:
    """A singular arc or a switch put where the switching function has the wrong sign."""
    i, w, arcs, lengths = fault.arc, fault.where, solved.arcs, solved.lengths.tolist()
    arc, length = arcs[i], lengths[i]
    head, tail, before, after = arcs[:i], arcs[i + 1 :], lengths[:i], lengths[i + 1 :]
    for short in (0.02 * length, 0.1 * length):
        if w > 0.5 and tail and tail[0] != "S":  # between this arc and the next
            yield _rebuilt(solved, head + arc + "S" + tail, [*before, length - short, short, *after])
        if w < 0.5 and head and head[-1] != "S":
            yield _rebuilt(solved, head + "S" + arc + tail, [*before, short, length - short, *after])
        if DULL < w < 1 - DULL:
            parts = [w * length - short / 2, short, (1 - w) * length - short / 2]
            for new in "CS" if arc == "T" else "ST":
                yield _rebuilt(solved, head + arc + new + arc + tail, [*before, *parts, *after])


def right(
    flight: ToCircle,
    guess: Structure,
    check: Check = nothing,
    depth: int = DEPTH,
    tried: set[tuple[str, int]] | None = None,
) -> Structure | None:
    """The optimal flight that a rough one leads to, its arcs changed where its faults say so; None where that fails."""
    tried = set() if tried is None else tried
    solved = solve(flight, guess, check)
    if solved is None:
        return None
    wrong = faults(flight, solved)
    if not wrong:
        return solved
    if depth == 0:
        return None
    for other in amended(solved, wrong):
        key = (other.arcs, int(1e3 * other.lengths @ np.arange(1, len(other.lengths) + 1)))
        if key in tried or len(other.arcs) > MOST_ARCS:
            continue
        tried.add(key)
        found = right(flight, other, check, depth - 1, tried)
        if found is not None:
            return found
    return None


def from_extremal(flight: ToCircle, extremal: Extremal) -> Structure:
    """The arcs of a flight that switches by itself."""
    start = flight.starts(extremal.unknowns[None])
    switches = propagate(start[0], extremal.time, flight.sail).switches
    lengths = np.diff(np.concatenate([[0.0], switches, [extremal.time]]))
    first = 0 if switching(start, flight.sail).value[0] > 0 else 1
    arcs = "".join("TC"[(first + i) % 2] for i in range(len(lengths)))
    direction = extremal.unknowns[DIRECTION]
    return Structure(arcs, np.concatenate([direction / np.linalg.norm(direction), lengths]))
