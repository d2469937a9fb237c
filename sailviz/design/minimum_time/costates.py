"""State and costates of a minimum-time flight flown together, one right-hand side for all sails.

Units: mu = 1, one au = 1; equations in `state_costate`. Integrator: Dormand-Prince 8(5,3), see `propagate.dop853`; here
with the stages in a loop, which compiles in seconds. Where a sail switches on or off the right-hand side jumps: steps
land there, found to rounding.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from sailviz.compiled import called, entry
from sailviz.design.minimum_time.state_costate import LRX, LVX, SIZE, VX, Sail, right_hand_side, scales
from sailviz.propagate import dop853_coefficients

DONE, UNDERFLOW, TOO_MANY_STEPS = range(3)
REASONS = ("", "the steps became too small", "it took too many steps")
MOST_STEPS = 20_000
AT_ONCE = 16  # flights in one piece of compiled work, which hears no Ctrl-C: milliseconds, 0.5 s at the very most
MOST_SWITCHES = 1024
STATUS, STEPS, SWITCHES = range(3)  # of `Flights.counts`
TIME, H, DRIFT = range(3)  # of `Flights.numbers`
WORK = 27  # rows of twelve: 16 stages, 8 coefficients, three states
SHARP = 1e-3  # of the tolerance: how much of a step may lie behind the switch that it lands on
SAFETY, SHRINK_MOST, GROW_MOST = 0.9, 0.333, 6.0  # Hairer's values


def _row(prefix: str, first: int, width: int) -> np.ndarray:
    return np.array([getattr(dop853_coefficients, f"{prefix}_{j}", 0.0) for j in range(first, first + width)])


_A = np.array([_row(f"A{i}", 1, 16) for i in range(1, 17)])
_E5, _E3 = _row("E5", 1, 12), _row("E3", 1, 12)
_D = np.array([_row(f"D{i}", 1, 16) for i in range(4, 8)])


@called
def _step(y, kind, p, eps, h, k, w, new):
    """new = the state a step h ahead of y, k (16, 12) its stages with k[0] given and k[12] the derivative at new.
    Returns (scaled error before division by the tolerance, switching function at new)."""
    for i in range(1, 13):
        for j in range(SIZE):
            w[j] = 0.0
        for stage in range(i):
            a = _A[i, stage]
            if a != 0.0:
                for j in range(SIZE):
                    w[j] += a * k[stage, j]
        for j in range(SIZE):
            w[j] = y[j] + h * w[j]
        support, _ = right_hand_side(w, kind, p, eps, k[i])
    for j in range(SIZE):
        new[j] = w[j]
    # positions and costates each against what they are measured with on the orbit at hand
    r, v, lr, lv = scales(y)
    r1, v1, lr1, lv1 = scales(new)
    r, v, lr, lv = max(r, r1), max(v, v1), max(lr, lr1), max(lv, lv1)
    e5 = e3 = 0.0
    for j in range(SIZE):
        scale = r if j < VX else v if j < LRX else lr if j < LVX else lv
        p5 = p3 = 0.0
        for stage in range(12):
            p5 += _E5[stage] * k[stage, j]
            p3 += _E3[stage] * k[stage, j]
        e5 += (p5 / scale) ** 2
        e3 += (p3 / scale) ** 2
    if e5 == 0.0 and e3 == 0.0:
        return 0.0, support
    return abs(h) * e5 / np.sqrt((e5 + 0.01 * e3) * SIZE), support


@called
def _interpolant(y, kind, p, eps, h, k, w, new, m):
    """Monomial coefficients m (8, 12) of the dense output over the step: y(t + x h) = sum m[i] x^i."""
    for i in range(13, 16):
        for j in range(SIZE):
            w[j] = 0.0
        for stage in range(i):
            a = _A[i, stage]
            if a != 0.0:
                for j in range(SIZE):
                    w[j] += a * k[stage, j]
        for j in range(SIZE):
            w[j] = y[j] + h * w[j]
        right_hand_side(w, kind, p, eps, k[i])
    for j in range(SIZE):
        f0 = new[j] - y[j]
        f1 = h * k[0, j] - f0
        f2 = 2.0 * f0 - h * (k[12, j] + k[0, j])
        f3 = f4 = f5 = f6 = 0.0
        for stage in range(16):
            f3 += _D[0, stage] * k[stage, j]
            f4 += _D[1, stage] * k[stage, j]
            f5 += _D[2, stage] * k[stage, j]
            f6 += _D[3, stage] * k[stage, j]
        f3, f4, f5, f6 = h * f3, h * f4, h * f5, h * f6
        # Hairer's nested form, multiplied out as in `propagate.dop853`
        m[0, j] = y[j]
        m[1, j] = f0 + f1
        m[2, j] = f2 + f3 - f1
        m[3, j] = f4 + f5 - 2.0 * f3 - f2
        m[4, j] = f6 - 3.0 * f5 - 2.0 * f4 + f3
        m[5, j] = f4 + 3.0 * f5 - 3.0 * f6
        m[6, j] = 3.0 * f6 - f5
        m[7, j] = -f6


@called
def _up_to_switch(y, kind, p, eps, h, k, w, new, before, after, near):
    """The step cut to land just behind the switch, at most about so near to it, so that it and the one after it are
    smooth: `_step` again with (error, switching function at its end, its length), from the switching function before
    and after the whole step."""
    low, high = 0.0, h
    last, g_last, here, g_here = 0.0, before, h, after
    error, beyond = 0.0, True
    for _ in range(100):
        if high - low <= near:
            break
        # a secant, a little too long; halving where it leads nowhere
        slope = (g_here - g_last) / (here - last)
        middle = here - g_here / slope + 0.5 * near if slope != 0.0 else low
        if not low < middle < high:
            middle = 0.5 * (low + high)
        last, g_last, here = here, g_here, middle
        error, g_here = _step(y, kind, p, eps, here, k, w, new)
        beyond = (g_here > 0.0) != (before > 0.0)
        if beyond:
            high = here
            if abs(g_here * (here - last)) <= near * abs(g_here - g_last):
                break
        else:
            low = here
    if here != high or not beyond:
        error, g_here = _step(y, kind, p, eps, high, k, w, new)
    return error, g_here, high


@called
def _propagate(start, span, kind, p, eps, tolerance, t_out, out, switches, end, work):
    """`propagate` without its arrays made: out (n, 12), switches (k,), end (12,) are filled; work (WORK, 12). Into the
    past where the span is negative, and then without switches.

    Returns (status, time reached, steps, number of switches, H at the start, largest |H - H(0)|).
    """
    k, m, w, y, new = work[:16], work[16:24], work[24], work[25], work[26]
    sense = -1.0 if span < 0.0 else 1.0
    span = abs(span)
    for j in range(SIZE):
        y[j] = start[j]
    support, hamiltonian = right_hand_side(y, kind, p, eps, k[0])
    drift, t, row, steps, found = 0.0, 0.0, 0, 0, 0
    while row < len(t_out) and t_out[row] <= 0.0:
        for j in range(SIZE):
            out[row, j] = start[j]
        row += 1
    r, v, _, _ = scales(y)
    wish = min(3.0 * tolerance**0.125 * r / v, span)
    status = DONE
    rejected = False
    while t < span:
        if steps >= MOST_STEPS:
            status = TOO_MANY_STEPS
            break
        landing = t + 1.01 * wish >= span
        h = span - t if landing else wish
        if not h > 4e-16 * span:
            status = UNDERFLOW
            break
        steps += 1
        error, after = _step(y, kind, p, eps, sense * h, k, w, new)
        switching = eps == 0.0 and sense > 0.0 and (after > 0.0) != (support > 0.0)
        if switching:
            near = max(1e-15 * span, SHARP * tolerance * h)
            error, after, high = _up_to_switch(y, kind, p, eps, h, k, w, new, support, after, near)
            landing, h = landing and high == h, high
        error /= tolerance
        if not error < 1.0:
            wish = h * (max(SHRINK_MOST, SAFETY * error**-0.125) if np.isfinite(error) else 0.1)
            rejected = True
            continue
        grow = GROW_MOST if error == 0.0 else min(GROW_MOST, max(SHRINK_MOST, SAFETY * error**-0.125))
        t1 = span if landing else t + h
        if row < len(t_out) and t_out[row] <= t1:
            _interpolant(y, kind, p, eps, sense * h, k, w, new, m)
            while row < len(t_out) and t_out[row] <= t1:
                x = (t_out[row] - t) / h
                for j in range(SIZE):
                    value = m[7, j]
                    for i in range(6, -1, -1):
                        value = value * x + m[i, j]
                    out[row, j] = value
                row += 1
        if switching:
            if found < len(switches):
                switches[found] = t1
            found += 1
            wish = max(wish, h)
        else:
            wish = h * (min(grow, 1.0) if rejected else grow)
        rejected = False
        t = t1
        for j in range(SIZE):
            y[j] = new[j]
        support, now = right_hand_side(y, kind, p, eps, k[0])
        drift = max(drift, abs(now - hamiltonian))
    for j in range(SIZE):
        end[j] = y[j]
    return status, t, steps, found, hamiltonian, drift


@entry("d2 d1 i d1 d d d1 D3 D2 D2 I2 D2 D2")
def propagate_compiled(starts, spans, kind, p, eps, tolerance, t_out, rows, switches, ends, counts, numbers, work):
    """Flights from starts (n, 12) over spans (n,), each with the same times t_out (m,): rows (n, m, 12), switches
    (n, k), ends (n, 12), counts (n, 3) and numbers (n, 3) as in `Flights` are filled. work : (WORK, 12)."""
    for i in range(len(spans)):
        counts[i, STATUS], numbers[i, TIME], counts[i, STEPS], counts[i, SWITCHES], numbers[i, H], numbers[i, DRIFT] = (
            _propagate(starts[i], spans[i], kind, p, eps, tolerance, t_out, rows[i], switches[i], ends[i], work)
        )
    return 0


class Flights(NamedTuple):
    """Many flights: rows (n, m, 12) at the times asked for, NaN where they were not reached, ends (n, 12), switches
    (n, k) times, counts (n, 3) of STATUS, STEPS, SWITCHES and numbers (n, 3), the TIME reached, H at the start and
    DRIFT, the largest |H - H(0)|."""

    rows: np.ndarray
    ends: np.ndarray
    switches: np.ndarray
    counts: np.ndarray
    numbers: np.ndarray


def fly_dense(
    starts: np.ndarray,
    spans: np.ndarray,
    sail: Sail,
    times: np.ndarray,
    tolerance: float,
    smoothing: float,
    switches: int = 0,
) -> Flights:
    """Flights from starts (n, 12) over spans (n,), seen at times (m,), float64 arrays in C order; so many switches of
    each are kept."""
    n = len(spans)
    rows = np.empty((n, len(times), SIZE))
    rows.fill(np.nan)
    flown = Flights(
        rows,
        np.empty((n, SIZE)),
        np.empty((n, switches)),
        np.empty((n, 3), dtype=np.int64),
        np.empty((n, 3)),
    )
    propagate_compiled(
        starts, spans, sail.kind, sail.parameters, smoothing, tolerance, times,
        flown.rows, flown.switches, flown.ends, flown.counts, flown.numbers, np.empty((WORK, SIZE)),
    )  # fmt: skip
    return flown


@dataclass(frozen=True)
class Flight:
    """One flight in units of mu = 1 and one au: end (12,) state and costates at time; rows (n, 12) at the times asked
    for; switches (k,) times at which the sail switched on or off; hamiltonian H at the start and drift, the largest
    |H - H(0)|; steps taken. reason says why a flight ended early."""

    time: float
    end: np.ndarray
    rows: np.ndarray
    switches: np.ndarray
    hamiltonian: float
    drift: float
    steps: int
    reason: str = ""


def propagate(
    start: npt.ArrayLike,
    span: float,
    sail: Sail,
    *,
    times: npt.ArrayLike = (),
    tolerance: float = 1e-13,
    smoothing: float = 0.0,
) -> Flight:
    """Fly state and costates start (12,) - r, v, lam_r, lam_v - for a span >= 0, the sail steered optimally.

    Units mu = 1 and one au. times (n,) : increasing, for dense output of seventh order, an error of a few tolerances.
    tolerance : relative, per step, of each of the four vectors. smoothing : eps that rounds the switch off, 0 the true
    sail. H drifts by 1e-13 to 1e-11 of |lam| over some revolutions.
    """
    times = np.ascontiguousarray(times, dtype=float)
    if len(times) and not (np.all(np.diff(times) >= 0) and times[0] >= 0 and times[-1] <= span):
        raise ValueError("the times asked for must increase from 0 to the span at most")
    starts = np.array(start, dtype=float).reshape(1, SIZE)
    flown = fly_dense(starts, np.array([span], dtype=float), sail, times, tolerance, smoothing, MOST_SWITCHES)
    (status, steps, found), (time, hamiltonian, drift) = flown.counts[0].tolist(), flown.numbers[0].tolist()
    switches = flown.switches[0, : min(found, MOST_SWITCHES)].copy()
    return Flight(time, flown.ends[0], flown.rows[0], switches, hamiltonian, drift, steps, REASONS[status])


def fly_all(
    starts: npt.ArrayLike, spans: npt.ArrayLike, sail: Sail, *, tolerance: float = 1e-13, smoothing: float = 0.0
) -> np.ndarray:
    """Ends (n, 12) of n flights from starts (n, 12) over spans (n,); NaN where one fails. Units as in `propagate`."""
    starts, spans = np.ascontiguousarray(starts, dtype=float), np.ascontiguousarray(spans, dtype=float)
    ends, none = np.empty_like(starts), np.empty(0)
    for first in range(0, len(spans), AT_ONCE):
        part = slice(first, first + AT_ONCE)
        flown = fly_dense(starts[part], spans[part], sail, none, tolerance, smoothing)
        ends[part] = flown.ends
        if flown.counts[:, STATUS].any():
            ends[part][flown.counts[:, STATUS] != DONE] = np.nan
    return ends
