"""A fastest flight as a finite problem: Radau collocation of degree four on intervals of a mesh.

Within an interval each state is a polynomial of degree four through its begin and four Radau points, the last of which
is the interval's end; each control is a polynomial of degree three through the four. The mesh is even in the
independent variable s with dt / ds = L r^k: k = 0 is time itself, k = 3/2 crowds it near the Sun, where all goes fast.
Time is a state, L one of the unknowns. Method: L. T. Biegler, Nonlinear Programming (2010), chapter 10, from memory;
checked against the indirect method.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from sailviz.design.direct.electric import ElectricSail
from sailviz.design.direct.ends import End, Start
from sailviz.design.direct.extra import casadi
from sailviz.design.direct.film import FilmSail
from sailviz.design.direct.frames_of_state import Axes
from sailviz.design.direct.limits import Limits

if TYPE_CHECKING:
    import casadi as ca

DEGREE = 4
# of Radau's quadrature on (0, 1]: zeros of P_4 - P_3 shifted, the last one 1
POINTS = np.array([0.08858795951270395, 0.4094668644407347, 0.787659461760847, 1.0])
NODES = np.append(0.0, POINTS)
SUN_GRAZING = 1.5  # k of a mesh that follows the pace of motion
NO_LIMITS = Limits()
SHORTEST, LONGEST = 1e-6, 1e4  # of the stretched parts of a flight


def _derivatives() -> np.ndarray:
    """(5, 4): of Lagrange's polynomials on NODES, at POINTS."""
    found = np.empty((DEGREE + 1, DEGREE))
    for j in range(DEGREE + 1):
        others = np.delete(NODES, j)
        basis = np.poly(others) / np.prod(NODES[j] - others)
        found[j] = np.polyval(np.polyder(basis), POINTS)
    return found


DERIVATIVES = _derivatives()


def _bends() -> np.ndarray:
    """(2, 4): what of four values at POINTS is no straight line. A partial throttle is held to one in each interval:
    left free it swings about from point to point, which the states hardly notice and a table of it does."""
    lines = np.stack([np.ones(DEGREE), POINTS])
    return np.linalg.svd(lines)[2][2:]


BENDS = _bends()
CHANGES = np.diff(np.eye(DEGREE), axis=0)  # (3, 4): a turn rate is held in each interval, and so within its limit


FULL, COAST, PARTIAL = "T", "C", "S"  # arcs of full thrust, of none, and of a throttle between


class Arc(NamedTuple):
    """A part of a flight with one kind of throttle, on a mesh of its own: how long it takes, and in how many
    intervals."""

    kind: str
    duration: float
    intervals: int


@dataclass(frozen=True)
class Question:
    """What is asked: the fastest flight of a sail from a start to an end within limits; units mu = 1 and one au."""

    axes: Axes
    sail: FilmSail | ElectricSail
    start: Start
    end: End
    limits: Limits = NO_LIMITS
    pace: float = 0.0  # k of the mesh
    intervals: int = 40
    arcs: tuple[Arc, ...] = ()  # of a throttle whose switches are known roughly: their durations are then unknowns

    @property
    def lengths(self) -> tuple[int, ...]:
        """How many intervals each of the parts has that are stretched independently."""
        return tuple(arc.intervals for arc in self.arcs) or (self.intervals,)

    @property
    def turns(self) -> bool:
        """Whether the sail's normal is a state, since its turning is limited."""
        return self.limits.turn_rate is not None


class Guess(NamedTuple):
    """Where a search begins, at the nodes (4 N + 1) of a mesh: states (n, size), times (n,), control vectors (n, axes)
    of full thrust, throttles (n,) and the start's and end's own unknowns, where they are known."""

    states: np.ndarray
    times: np.ndarray
    vectors: np.ndarray
    words: str
    throttles: np.ndarray | None = None
    own: np.ndarray | None = None


class Nodes(NamedTuple):
    """A flight at the nodes: states (n, size), times (n,), and at the points between control vectors (n - 1, axes),
    of a sail that turns its normals at the nodes (n, axes), and
    throttles (n - 1,); the unknowns of start and end; the costates of the start's state, minus the change of the
    flight time with it; and the change of the flight time with each condition of the end."""

    states: np.ndarray
    times: np.ndarray
    vectors: np.ndarray
    throttles: np.ndarray
    start: np.ndarray
    end: np.ndarray
    costates: np.ndarray
    prices: np.ndarray


@dataclass(frozen=True)
class Transcription:
    """The finite problem of a question: unknowns z, objective and constraints as casadi has them, and their bounds."""

    question: Question
    problem: dict[str, ca.MX]
    z_low: np.ndarray
    z_high: np.ndarray
    g_low: np.ndarray
    g_high: np.ndarray
    state_size: int  # with time and, where it turns, the normal
    control_size: int
    initial_rows: slice  # of g: the start's state
    final_rows: slice  # of g: the conditions of the end
    conditions: ca.Function  # of the end: last state, time of arrival after the epoch, the end's unknowns

    @property
    def nodes(self) -> int:
        return DEGREE * sum(self.question.lengths) + 1

    def packed(self, guess: Guess) -> np.ndarray:
        """z of a guess."""
        q = self.question
        columns = [guess.states, guess.times[:, None]]
        throttles = np.full((self.nodes, 1), 0.9) if guess.throttles is None else guess.throttles[:, None]
        vectors = throttles * guess.vectors if q.sail.throttles and not q.turns else guess.vectors
        if q.turns:
            normals = guess.vectors
            if q.sail.throttles:  # halfway to r_hat
                normals = guess.vectors + _outward(q.axes, guess.states)
                normals = normals / np.linalg.norm(normals, axis=1)[:, None]
            columns.append(normals)
            controls = [np.zeros((self.nodes, q.axes.turn_axes))]
        else:
            controls = [vectors]
        if q.sail.throttles:
            controls.append(throttles)
        radii = np.linalg.norm(q.axes.cartesian(guess.states)[:, :3], axis=1)
        bounds = DEGREE * np.concatenate([[0], np.cumsum(q.lengths)])
        lengths = [(guess.times[b] - guess.times[a]) / np.mean(radii[a : b + 1] ** q.pace) for a, b in pairwise(bounds)]
        own = [u.guess for u in (*q.start.unknowns(), *q.end.unknowns())] if guess.own is None else guess.own
        return np.concatenate([lengths, own, np.hstack(columns).ravel(), np.hstack(controls)[1:].ravel()])

    def unpacked(self, z: np.ndarray, multipliers: np.ndarray) -> Nodes:
        """The flight of z, and the multipliers of g."""
        q, n = self.question, self.nodes
        parts = len(q.lengths)
        begin = parts + len(q.start.unknowns())
        first = begin + len(q.end.unknowns())
        last = first + n * self.state_size
        x = z[first:last].reshape(n, self.state_size)
        u = z[last:].reshape(n - 1, self.control_size)
        vectors = x[:, q.axes.size + 1 :] if q.turns else u[:, : q.axes.axes]
        throttles = u[:, -1] if q.sail.throttles else np.ones(n - 1)
        return Nodes(
            x[:, : q.axes.size],
            x[:, q.axes.size],
            vectors,
            throttles,
            z[parts:begin],
            z[begin:first],
            multipliers[self.initial_rows],
            -multipliers[self.final_rows],
        )


def _outward(axes: Axes, states: np.ndarray) -> np.ndarray:
    """r_hat (n, axes) along the axes of controls."""
    if axes.axes == 2:
        return np.tile([1.0, 0.0], (len(states), 1))
    return states[:, :3] / np.linalg.norm(states[:, :3], axis=1)[:, None]


class _Point(NamedTuple):
    """What is asked of one point of a mesh: rates of the states per s and L, and bounded expressions."""

    rates: ca.Function
    bounded: ca.Function
    low: list[float]
    high: list[float]


def _point(q: Question) -> _Point:
    ca = casadi()
    axes, sail = q.axes, q.sail
    size = axes.size + 1 + (axes.axes if q.turns else 0)
    x = ca.SX.sym("x", size)
    u = ca.SX.sym("u", (axes.turn_axes if q.turns else axes.axes) + sail.throttles)
    throttle = u[-1] if sail.throttles else None
    if not q.turns:
        n = u[: axes.axes]
        thrust = sail.thrust(axes, x, n, throttle)
        bounded = sail.constraints(axes, x, n, throttle, q.limits)
        low, high = [0.0] * len(bounded), [np.inf] * len(bounded)
        if not sail.throttles:
            # within a cone the hull has less thrust than any attitude: only a sail that flaps would feel so little
            least = -np.inf if q.limits.cone is None else 1.0
            bounded, low, high = [*bounded, ca.sumsqr(n)], [*low, least], [*high, 1.0]
        more = []
    else:
        n, rate = x[axes.size + 1 :], u[: axes.turn_axes]
        more = axes.turned(x, n, rate)
        limit = q.limits.turn_rate or 0.0
        bounded, low, high = [limit**2 - ca.sumsqr(rate)], [0.0], [np.inf]
        if axes.axes == 3:  # a turn about the normal itself is none
            bounded, low, high = [*bounded, ca.dot(rate, n)], [*low, 0.0], [*high, 0.0]
        if isinstance(sail, ElectricSail):
            thrust = sail.thrust_of_normal(axes, x, n, throttle)
            kept = [] if q.limits.cone is None else [_cosine(axes, x, n) - float(np.cos(q.limits.cone))]
        else:
            thrust = sail.thrust(axes, x, n, throttle)
            kept = sail.constraints(axes, x, n, throttle, q.limits)
        bounded, low, high = [*bounded, *kept], low + [0.0] * len(kept), high + [np.inf] * len(kept)
    if q.limits.closest is not None and axes.axes == 3:
        bounded, low, high = [*bounded, axes.radius(x)], [*low, q.limits.closest], [*high, np.inf]
    pace = axes.radius(x) ** q.pace if q.pace else 1.0
    rates = [pace * y for y in [*axes.rates(x, thrust), 1.0, *more]]
    return _Point(
        ca.Function("rates", [x, u], [ca.vertcat(*rates)]),
        ca.Function("bounded", [x, u], [ca.vertcat(*bounded)]),
        low,
        high,
    )


def _cosine(axes: Axes, x: ca.SX, n: ca.SX) -> ca.SX:
    return sum(n[i] * o for i, o in enumerate(axes.outward(x)))


def transcribe(q: Question) -> Transcription:
    """The finite problem of a question."""
    ca = casadi()
    axes, sail, intervals = q.axes, q.sail, sum(q.lengths)
    count = DEGREE * intervals
    size = axes.size + 1 + (axes.axes if q.turns else 0)
    controls = (axes.turn_axes if q.turns else axes.axes) + sail.throttles
    begin, end = q.start.unknowns(), q.end.unknowns()
    lengths = ca.MX.sym("L", len(q.lengths))
    p = [ca.MX.sym(f"p{i}") for i in range(len(begin) + len(end))]
    x, u = ca.MX.sym("x", size, count + 1), ca.MX.sym("u", controls, count)
    point = _point(q)
    rates = point.rates.map(count)(x[:, 1:], u)
    own_start, own_end = p[: len(begin)], p[len(begin) :]
    first, last = ca.vertcat(*q.start.state(own_start)), x[:, count]
    g = [x[: axes.size, 0] - first, x[axes.size, 0]]
    low, high = [np.zeros(axes.size + 1)], [np.zeros(axes.size + 1)]
    if q.turns:
        g.append(ca.sumsqr(x[axes.size + 1 :, 0]) - 1)
        low.append(np.zeros(1))
        high.append(np.zeros(1))
    parts = np.repeat(np.arange(len(q.lengths)), q.lengths)
    for i, part in enumerate(parts):
        step = lengths[int(part)] / q.lengths[part]
        within = x[:, DEGREE * i : DEGREE * (i + 1) + 1]
        here = slice(DEGREE * i, DEGREE * (i + 1))
        g.append(ca.vec(within @ DERIVATIVES - step * rates[:, here]))
    equal = size * count
    for i, part in enumerate(parts):
        if q.turns:
            g.append(ca.vec(u[: axes.turn_axes, DEGREE * i : DEGREE * (i + 1)] @ CHANGES.T))
            equal += axes.turn_axes * len(CHANGES)
        if q.arcs and q.arcs[part].kind == PARTIAL:
            g.append(BENDS @ u[-1, DEGREE * i : DEGREE * (i + 1)].T)
            equal += len(BENDS)
    moment = q.start.moment(own_start) + last[axes.size]
    starts, ends = q.start.conditions(own_start), q.end.conditions(axes, last, moment, own_end)
    g.append(ca.vertcat(*starts, *ends))
    first_end = axes.size + 1 + q.turns + equal + len(starts)
    equal += len(starts) + len(ends)
    low.append(np.zeros(equal))
    high.append(np.zeros(equal))
    g.append(ca.vec(point.bounded.map(count)(x[:, 1:], u)))
    g_low, u_low, u_high = _bounds_of_arcs(q, parts, point, controls)
    low.append(g_low)
    high.append(np.tile(point.high, count))
    z = ca.vertcat(lengths, *p, ca.vec(x), ca.vec(u))
    closest = q.limits.closest if q.limits.closest is not None and axes.axes == 2 else axes.low[0]
    x_low = np.concatenate([[closest], axes.low[1:], [0.0], [-1.0] * (size - axes.size - 1)])
    x_high = np.concatenate([axes.high, [np.inf], [1.0] * (size - axes.size - 1)])
    own = [*begin, *end]
    return Transcription(
        q,
        {"x": z, "f": last[axes.size], "g": ca.vertcat(*g)},
        np.concatenate([[SHORTEST] * len(q.lengths), [y.low for y in own], np.tile(x_low, count + 1), u_low]),
        np.concatenate([[LONGEST] * len(q.lengths), [y.high for y in own], np.tile(x_high, count + 1), u_high]),
        np.concatenate(low),
        np.concatenate(high),
        size,
        controls,
        slice(0, axes.size),
        slice(first_end, first_end + len(ends)),
        _conditions(q),
    )


def _bounds_of_arcs(q: Question, parts: np.ndarray, point: _Point, controls: int) -> tuple[np.ndarray, ...]:
    """Lower bounds of what is bounded at the points, and bounds of the controls there, all flat: on arcs of known
    throttle that is fixed, and where there is none the sail's cone of forces is a point that bounds nothing."""
    turn = q.limits.turn_rate if q.limits.turn_rate is not None else 1.0
    low, high = np.full((len(parts), DEGREE, controls), -turn), np.full((len(parts), DEGREE, controls), turn)
    g_low = np.tile(point.low, (len(parts), DEGREE, 1))
    if q.sail.throttles:
        low[..., -1], high[..., -1] = 0.0, 1.0
        kinds = np.array([arc.kind for arc in q.arcs] or [PARTIAL])[parts]
        low[kinds == FULL, :, -1] = 1.0
        low[kinds == COAST], high[kinds == COAST] = 0.0, 0.0
        g_low[kinds == COAST] = -np.inf
    return g_low.ravel(), low.ravel(), high.ravel()


def _conditions(q: Question) -> ca.Function:
    ca = casadi()
    x, moment = ca.SX.sym("x", q.axes.size), ca.SX.sym("t")
    p = ca.SX.sym("p", len(q.end.unknowns()))
    return ca.Function(
        "conditions", [x, moment, p], [ca.vertcat(*q.end.conditions(q.axes, x, moment, ca.vertsplit(p)))]
    )
