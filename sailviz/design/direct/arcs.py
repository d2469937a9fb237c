"""Which parts of a flight have full thrust, none, or partial voltage: read from the throttle of a coarse solution.

A fixed mesh smears each switch over an interval, so that short parts are dropped; whether the rest is a structure of a
fastest flight is for its acceptance tests to say.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import groupby

import numpy as np

from sailviz.design.direct.guesses import mesh
from sailviz.design.direct.transcription import COAST, FULL, PARTIAL, Arc, Guess, Nodes, Question

ON, OFF = 0.97, 0.03  # throttles above and below which a point counts as full thrust and as none
FEWEST = 6  # intervals of a part
LEAST_VECTOR = 1e-6  # length of a control that has a direction
LEAST = 0.015  # of the flight: shorter parts are smears of a switch


def arcs_of(times: np.ndarray, throttles: np.ndarray, intervals: int, least: float = LEAST) -> tuple[Arc, ...]:
    """The parts of a flight from its throttles (n,) at times (n,), of a mesh of so many intervals in all; shorter ones
    than a share of the flight are dropped."""
    span = float(times[-1])
    kinds = [FULL if x > ON else COAST if x < OFF else PARTIAL for x in throttles]
    edges = np.concatenate([[0.0], 0.5 * (times[1:] + times[:-1]), [span]])
    parts: list[tuple[str, float, float]] = []
    first = 0
    for kind, group in groupby(kinds):
        last = first + len(list(group))
        parts.append((kind, float(edges[first]), float(edges[last])))
        first = last
    while True:
        short = [i for i, (_, begin, end) in enumerate(parts) if end - begin < least * span]
        if not short or len(parts) == 1:
            break
        parts = _without(parts, min(short, key=lambda i: parts[i][2] - parts[i][1]))
    return tuple(
        Arc(kind, end - begin, max(FEWEST, round(intervals * (end - begin) / span))) for kind, begin, end in parts
    )


def _without(parts: Sequence[tuple[str, float, float]], i: int) -> list[tuple[str, float, float]]:
    """The parts without one of them, whose time its neighbours share."""
    _, begin, end = parts[i]
    before, after = list(parts[:i]), list(parts[i + 1 :])
    if not before:
        return [(after[0][0], begin, after[0][2]), *after[1:]]
    if not after:
        return [*before[:-1], (before[-1][0], before[-1][1], end)]
    middle = 0.5 * (begin + end)
    (kind, first, _), (following, _, last) = before[-1], after[0]
    if kind == following:
        return [*before[:-1], (kind, first, last), *after[1:]]
    return [*before[:-1], (kind, first, middle), (following, middle, last), *after[1:]]


def guess_on(q: Question, nodes: Nodes) -> Guess:
    """A solution read at the nodes of another question's mesh, as its guess."""
    times = nodes.times[-1] * mesh(q)
    states = np.stack([np.interp(times, nodes.times, column) for column in nodes.states.T], axis=1)
    throttles = np.interp(times, nodes.times[1:], nodes.throttles)
    size = np.linalg.norm(nodes.vectors, axis=1)
    known = size > LEAST_VECTOR  # without thrust there is no direction
    units = nodes.vectors[known] / size[known, None]
    vectors = np.stack([np.interp(times, nodes.times[1:][known], column) for column in units.T], axis=1)
    vectors /= np.maximum(np.linalg.norm(vectors, axis=1), LEAST_VECTOR)[:, None]
    kinds = np.repeat([arc.kind for arc in q.arcs], [4 * arc.intervals for arc in q.arcs]) if q.arcs else None
    if kinds is not None:
        kinds = np.append(kinds[:1], kinds)
        throttles = np.where(kinds == FULL, 1.0, np.where(kinds == COAST, 0.0, np.clip(throttles, 0.05, 0.95)))
    own = np.concatenate([nodes.start, nodes.end])
    return Guess(states, times, vectors, "the flight on a coarser mesh", throttles, own)
