"""Constant thrust along the radius, the circumference or the velocity, from a circular orbit: what the books give.

Canonical units: mu = 1, initial radius 1, so accelerations are in mu / r0^2. Each result carries the estimates of the
thesis, better ones of ours where there are any, and `.exact`, which integrates the motion.
Source: thesis, section 2.1 (Tsien, Prussing, Battin), (2.10)-(2.27), read in excerpt; errors measured by integration.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import numpy.typing as npt
from scipy.integrate import quad

from sailviz.propagate import dop853, dynamics
from sailviz.propagate.events import ENERGY, STOP, watch
from sailviz.steering import attitude

THRESHOLD = 1 / 8  # radial acceleration over mu / r0^2 that must be exceeded to escape: (2.14)
LAWS = {"radial": attitude.RADIAL, "circumferential": attitude.TRANSVERSE, "tangential": attitude.TANGENTIAL}
TOLERANCE = 1e-13  # of the integrations
BLOCK = 8192

# Limits for a -> 0 of r_esc sqrt(a) and of (1 - a t_esc) / a^(1/4), integrated at a = 1e-3 ... 1e-7 and extrapolated.
# Ours, not the thesis'.
CIRCUMFERENTIAL_LIMIT = 0.8532665, 0.7555398
TANGENTIAL_LIMIT = 0.8785874, 0.8082175


@dataclass(frozen=True)
class Escape:
    """Where the energy passes zero, by integration; NaN without escape. radius, time, angle (swept, rad): canonical."""

    radius: np.ndarray
    time: np.ndarray
    angle: np.ndarray


@dataclass(frozen=True)
class Trajectory:
    """Integrated motion at the times asked for; all (n,), canonical, NaN after an escape that was to end it."""

    time: np.ndarray
    radius: np.ndarray
    angle: np.ndarray
    radial_speed: np.ndarray
    transverse_speed: np.ndarray


@dataclass(frozen=True)
class RadialThrust:
    """Constant radial acceleration from a circular orbit. Angular momentum stays 1: (2.13).

    acceleration : over mu / r0^2, negative inwards. escapes : bool, a > 1/8. escape_radius 1 + 1 / (2 a) (2.15),
    escape_time and escape_angle by quadrature: exact; NaN without escape. turning_radius, period : the other extreme
    of a bounded orbit and the time from one passage of r0 to the next; NaN with escape, period inf at the threshold.
    """

    acceleration: np.ndarray
    escapes: np.ndarray
    escape_radius: np.ndarray
    escape_time: np.ndarray
    escape_angle: np.ndarray
    turning_radius: np.ndarray
    period: np.ndarray
    reason: str = ""

    def energy(self, radius: npt.ArrayLike) -> np.ndarray:
        """Orbital energy at a radius: (2.16)."""
        return -0.5 + self.acceleration * (np.asarray(radius, dtype=float) - 1)

    def radial_speed(self, radius: npt.ArrayLike) -> np.ndarray:
        """|r'| at a radius, NaN where the orbit does not go: r'^2 = (r - 1)(2 a r^2 - r + 1) / r^2."""
        r = np.asarray(radius, dtype=float)
        square = (r - 1) * (2 * self.acceleration * r * r - r + 1) / r**2
        return np.sqrt(np.where(square < 0, np.nan, square))

    @cached_property
    def exact(self) -> Escape:
        return _escapes("radial", self.acceleration, self.escapes)


@dataclass(frozen=True)
class SpiralThrust:
    """Constant circumferential or tangential acceleration from a circular orbit.

    acceleration : over mu / r0^2, positive. escape_radius, escape_time : the thesis' estimates, feasible where they
    make sense (escape outside the initial orbit), else NaN. better_escape_radius, better_escape_time : ours, from the
    limit of small acceleration, within 0.4 % up to a = 1e-2.
    """

    kind: str
    acceleration: np.ndarray
    escape_radius: np.ndarray
    escape_time: np.ndarray
    better_escape_radius: np.ndarray
    better_escape_time: np.ndarray
    feasible: np.ndarray
    reason: str = ""

    def radius_at_time(self, time: npt.ArrayLike) -> np.ndarray:
        """r after a time: (1 - a t)^-2, (2.20), the orbit nearly circular all the while."""
        return (1 - self.acceleration * np.asarray(time, dtype=float)) ** -2

    def radius_at_time_linear(self, time: npt.ArrayLike) -> np.ndarray:
        """r after a short time: 1 + 2 a t, the second form of (2.20)."""
        return 1 + 2 * self.acceleration * np.asarray(time, dtype=float)

    def radius_at_angle(self, angle: npt.ArrayLike) -> np.ndarray:
        """r after a swept angle in rad: 1 / sqrt(1 - 4 a theta), (2.23); NaN beyond 1 / (4 a)."""
        room = 1 - 4 * self.acceleration * np.asarray(angle, dtype=float)
        return 1 / np.sqrt(np.where(room > 0, room, np.nan))

    @cached_property
    def exact(self) -> Escape:
        return _escapes(self.kind, self.acceleration, np.asarray(self.acceleration) > 0)


def radial(acceleration: npt.ArrayLike) -> RadialThrust:
    """Tsien's problem: constant radial acceleration over mu / r0^2, scalar or array, either sign; see RadialThrust.

    The escape integrals run over x = sqrt(r - 1), where nothing is singular:
    t = int 2 (1 + x^2) dx / sqrt(2 a (1 + x^2)^2 - x^2), x from 0 to 1 / sqrt(2 a). The thesis calls (2.15)'s integral
    one of the first kind; it is not.
    """
    a = np.asarray(acceleration, dtype=float)
    escapes = a > THRESHOLD
    with np.errstate(divide="ignore"):
        escape_radius = np.where(escapes, 1 + 1 / (2 * a), np.nan)  # (2.15)
    bounded = a <= THRESHOLD
    turning = np.where(bounded, 2 / (1 + np.sqrt(np.maximum(1 - 8 * a, 0.0))), np.nan)
    time, angle = np.vectorize(_escape_integrals, otypes=[float, float])(a)
    reason = ""
    if a.ndim == 0 and not escapes:
        reason = "radial thrust leads to escape above 1/8 of the initial gravity, " + (
            "and at it only approaches twice the initial radius"
            if a == THRESHOLD
            else f"this one turns back at {float(turning):.6g} initial radii"
        )
    period = np.vectorize(_period, otypes=[float])(a)
    return RadialThrust(a[()], escapes[()], escape_radius[()], time[()], angle[()], turning[()], period[()], reason)


def circumferential(acceleration: npt.ArrayLike) -> SpiralThrust:
    """Constant circumferential acceleration over mu / r0^2, scalar or array; see SpiralThrust.

    r_esc = 1 / sqrt(2 a) (2.21), t_esc = (1 - r_esc^-1/2) / a (2.22). Rough: the true radius is 1.21 times larger.
    """
    a = np.asarray(acceleration, dtype=float)
    with np.errstate(divide="ignore", invalid="ignore"):
        radius = 1 / np.sqrt(2 * a)  # (2.21)
        return _spiral("circumferential", a, radius, (1 - radius**-0.5) / a, 0.5, CIRCUMFERENTIAL_LIMIT)  # (2.22)


def tangential(acceleration: npt.ArrayLike) -> SpiralThrust:
    """Constant acceleration along the velocity over mu / r0^2, scalar or array; see SpiralThrust.

    Battin: r_esc = (20 a^2)^-1/4 (2.26), t_esc = (1 - (20 a^2)^1/8) / a (2.27). Rough: the true radius is 1.86 times
    larger.
    """
    a = np.asarray(acceleration, dtype=float)
    with np.errstate(divide="ignore", invalid="ignore"):
        radius = (20 * a * a) ** -0.25  # (2.26)
        return _spiral("tangential", a, radius, (1 - (20 * a * a) ** 0.125) / a, 20**-0.5, TANGENTIAL_LIMIT)  # (2.27)


def trajectory(kind: str, acceleration: float, time: npt.ArrayLike, to_escape: bool = False) -> Trajectory:
    """The motion integrated. kind : "radial" | "circumferential" | "tangential". acceleration : scalar over mu / r0^2.
    time (n,) : increasing from 0 on. to_escape : whether to end where the energy passes zero. Error about 1e-11 after
    ten revolutions."""
    time = np.atleast_1d(np.asarray(time, dtype=float))
    return _integrate(kind, float(acceleration), time, to_escape)[0]


def _spiral(kind, a, radius, time, most, limit):
    feasible = (a > 0) & (a < most)
    reason = ""
    if a.ndim == 0 and not feasible:
        reason = f"the estimate of escape needs an acceleration between 0 and {most:.6g} of the initial gravity"
    with np.errstate(divide="ignore", invalid="ignore"):
        values = (radius, time, limit[0] / np.sqrt(a), (1 - limit[1] * a**0.25) / a)
    return SpiralThrust(kind, a[()], *(np.where(feasible, x, np.nan)[()] for x in values), feasible[()], reason)


def _escape_integrals(a):
    if not a > THRESHOLD:
        return np.nan, np.nan
    s = np.sqrt(2 * a)
    end = 1 / s  # sqrt(r_esc - 1)
    excess = (8 * a - 1) / (np.sqrt(8 * a) + 1)  # 2 s - 1

    def root(x):
        """sqrt(2 a (1 + x^2)^2 - x^2) as two factors, so that nothing cancels at the threshold."""
        return np.sqrt((s * (x - 1) ** 2 + excess * x) * (s * (1 + x * x) + x))

    points = [1.0] if end > 1 else None  # where it is slowest near the threshold
    options = {"epsabs": 0.0, "epsrel": 1e-13, "limit": 500, "points": points}
    return (
        quad(lambda x: 2 * (1 + x * x) / root(x), 0, end, **options)[0],
        quad(lambda x: 2 / ((1 + x * x) * root(x)), 0, end, **options)[0],
    )


def _period(a):
    if not a <= THRESHOLD:
        return np.nan
    if a == THRESHOLD:
        return np.inf
    split = np.sqrt(1 - 8 * a)
    turn = 2 / (1 + split)

    def slow(phi):
        r = (1 + turn) / 2 + (turn - 1) / 2 * np.sin(phi)
        # |2 a (r - r_p)| with r_p = (1 + split) / (4 a), the third root
        return r / np.sqrt(np.abs((1 + split) / 2 - 2 * a * r))

    return 2 * quad(slow, -np.pi / 2, np.pi / 2, epsabs=0.0, epsrel=1e-13, limit=500)[0]


def _escapes(kind, acceleration, happens):
    def one(a, happens):
        if not happens:
            return np.nan, np.nan, np.nan
        return _integrate(kind, a, None, True)[1]

    found = np.vectorize(one, otypes=[float] * 3)(acceleration, happens)
    return Escape(*(x[()] for x in found))


def _integrate(kind, a, times, to_escape):
    """(Trajectory at times, (radius, time, angle) of the escape or NaN). times None: only until the escape.

    The angle is unwrapped along rows that are never more than a third of a revolution apart.
    """
    model = dynamics.model(1.0, device=dynamics.THRUSTER, device_parameters=(a, 0.0, 0.0), steering=LAWS[kind])
    # circumferential and tangential thrust escape before 1 / a, when the speed of the start is spent
    last_time = (2 * _escape_integrals(a)[0] if kind == "radial" else 2 / a + 10) if times is None else times[-1]
    events = watch([(ENERGY, 0.0, 1, STOP)] if to_escape or times is None else [])
    run = dop853.start(0.0, (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), 1.0, events=len(events.kind))
    # at the fastest a craft turns with the circular rate at its closest: inward thrust can more than halve the radius
    closest = 1.0 if a >= 0 or kind != "radial" else float(2 / (1 + np.sqrt(1 - 8 * a)))
    step = 1.5 * closest**2
    kept, angle, last, begin = [], 0.0, 0.0, 0.0
    escape = (np.nan,) * 3
    while begin < last_time:
        rows = begin + step * np.arange(BLOCK + 1)[1:]
        wanted = np.empty(0) if times is None else times[(times >= begin) & (times <= min(rows[-1], last_time))]
        rows = np.unique(np.concatenate([rows[rows < last_time], wanted, [last_time] if rows[-1] >= last_time else []]))
        out = np.empty((6, len(rows)))
        status = dop853.advance(run, model, np.zeros(1), np.ones(1), events, rows, out, last_time, TOLERANCE, np.inf)
        done = dop853.rows_done(run) if status != dop853.DONE else len(rows)
        state = out[:, :done]
        if status == dop853.STOPPED:
            _, t, y = dop853.drain_events(run)[0]
            state = np.column_stack([state, y[:6]])
            rows = np.append(rows[:done], t)
            done += 1
        swept = angle + np.unwrap(np.concatenate([[last], np.arctan2(state[1], state[0])]))[1:] - last
        kept.append(np.vstack([rows[:done], state, swept]))
        if status == dop853.STOPPED:
            escape = float(np.hypot(*state[:2, -1])), float(rows[done - 1]), float(swept[-1])
        if status != dop853.DONE:
            break
        angle, last, begin = float(swept[-1]), float(np.arctan2(state[1, -1], state[0, -1])), float(rows[-1])
    if times is None:
        return None, escape
    t, x, y, _, u, v, _, swept = np.hstack(kept)
    r = np.hypot(x, y)
    columns = np.full((4, len(times)), np.nan)
    at = np.searchsorted(t, times)
    inside = at < len(t)
    at = at[inside]
    columns[:, inside] = (
        r[at],
        swept[at],
        (x[at] * u[at] + y[at] * v[at]) / r[at],
        (x[at] * v[at] - y[at] * u[at]) / r[at],
    )
    return Trajectory(times, *columns), escape
