"""What happens within one step: events and contact with the surface, found on the step's polynomial.

Each integrator leaves a step as a polynomial in x, which runs from 0 to 1, or from -1 to 1 (`collocation`). Where on it
what is watched passes its level, and where the run ends or the device goes out of use, is the same for all.
"""

from __future__ import annotations

import numpy as np

from sailviz.compiled import called, inlined
from sailviz.propagate.dynamics import SIZE
from sailviz.propagate.events import (
    APSIS,
    END_OF_USE,
    ON_A_CIRCLE,
    QUANTITY,
    RADIUS,
    STOP,
    measure,
    off_level,
    passes,
    sign_at,
)
from sailviz.propagate.stepping import CLOCK, DENSE, EVENTS, IN_USE, STATUS, STOPPED, STOPPED_BY, SURFACE, TWICE


@inlined
def evaluate(m, x, w):
    """w (SIZE,) = the polynomial at x, which runs from 0 to 1 over the step, or from -1 to 1 (`collocation`)."""
    for j in range(SIZE):
        p = m[m.shape[0] - 1, j]
        for i in range(m.shape[0] - 2, -1, -1):
            p = p * x + m[i, j]
        w[j] = p


@inlined
def root(m, kind, level, mu, low, high, g_low, w):
    """x in [low, high] where the event function changes sign: bisection to the last bit, w = the state there."""
    for _ in range(64):
        middle = 0.5 * (low + high)
        if middle <= low or middle >= high:
            break
        evaluate(m, middle, w)
        g = measure(kind, level, w, mu)
        if (g < 0.0) == (g_low < 0.0):
            low = middle
        else:
            high = middle
    evaluate(m, high, w)
    return high


@inlined
def note(s, index, time, w):
    n = s.counter[EVENTS]
    s.event[n, 0] = index
    s.event[n, 1] = time
    for j in range(7):
        s.event[n, 2 + j] = w[j]
    s.counter[EVENTS] = n + 1


@inlined
def at(dense, x, kind, level, t0, h, factor, p, w):
    """`off_level` at the place x of a step, with w = the state there."""
    evaluate(dense, x, w)
    return off_level(kind, level, t0 + x * h, w, factor, p)


@inlined
def crossing(dense, kind, level, t0, h, low, high, g_low, factor, p, w):
    """x in [low, high] where what is watched passes its level: bisection to the last bit, w = the state there."""
    for _ in range(64):
        middle = 0.5 * (low + high)
        if middle <= low or middle >= high:
            break
        if (at(dense, middle, kind, level, t0, h, factor, p, w) < 0.0) == (g_low < 0.0):
            low = middle
        else:
            high = middle
    evaluate(dense, high, w)
    return high


@called
def dip(dense, kind, level, t0, h, low, high, g_low, g, factor, p, w):
    """x between two samples on the same side of the level at which a quantity is beyond it, else `high`. Looked for
    where its slopes at both ends say that it may be: those of a curve that bends one way."""
    side, span = (1.0 if g_low > 0.0 else -1.0), high - low
    little = 1e-3 * span
    falls = side * (g_low - at(dense, low + little, kind, level, t0, h, factor, p, w)) / little
    rises = side * (g - at(dense, high - little, kind, level, t0, h, factor, p, w)) / little
    if not (falls > 0.0 and rises > 0.0):
        return high
    meet = (side * (g_low - g) + rises * span) / (falls + rises)  # of the two tangents, from low on
    if side * g_low - falls * meet > 0.0:
        return high
    a, b = low, high
    for _ in range(80):  # thirds: the least of a curve with one bottom
        third = (b - a) / 3.0
        left = side * at(dense, a + third, kind, level, t0, h, factor, p, w)
        if left < 0.0:
            return a + third
        right = side * at(dense, b - third, kind, level, t0, h, factor, p, w)
        if right < 0.0:
            return b - third
        if left < right:
            b = b - third
        else:
            a = a + third
    return high


@called
def find_events(s, watch, dense, t0, h, x_start, x_end, samples, factor, p, w):
    """Record every event of a step, times t0 + h x, from x_start up to x_end in order of time, looking at that many
    samples of it. Returns x of the first that stops the run or ends the use of the device, else 2, and its index."""
    before = s.counter[EVENTS]
    low = x_start
    for piece in range(1, samples + 1):
        high = x_start + (x_end - x_start) * piece / samples
        stop_x, stop_index = 2.0, -1
        first = s.counter[EVENTS]
        for e in range(len(watch.kind)):
            kind, level = watch.kind[e], watch.level[e]
            evaluate(dense, high, w)
            g_low = s.sign[e]
            if g_low == 0.0:
                g = sign_at(kind, level, t0 + high * h, w, factor, p)
            else:
                g = off_level(kind, level, t0 + high * h, w, factor, p)
            s.sign[e] = g
            if watch.action[e] == END_OF_USE and s.counter[IN_USE] == 0:
                continue
            turn = high
            if kind >= QUANTITY and g_low * g > 0.0 and not (kind >= ON_A_CIRCLE and abs(g_low - g) > 0.5 * np.pi):
                turn = dip(dense, kind, level, t0, h, low, high, g_low, g, factor, p, w)
            a, b, g_a, g_b = low, turn, g_low, (g if turn == high else -g_low)
            for _ in range(TWICE):
                if passes(kind, g_a, g_b) and (watch.sense[e] == 0 or (watch.sense[e] > 0) == (g_a < 0.0)):
                    x = crossing(dense, kind, level, t0, h, a, b, g_a, factor, p, w)
                    at_row = s.counter[EVENTS]
                    note(s, e, t0 + x * h, w)
                    while at_row > first and s.event[at_row - 1, 1] > s.event[at_row, 1]:  # keep them in order of time
                        for j in range(9):
                            s.event[at_row - 1, j], s.event[at_row, j] = s.event[at_row, j], s.event[at_row - 1, j]
                        at_row -= 1
                    if watch.action[e] != 0 and x < stop_x:
                        stop_x, stop_index = x, e
                if turn == high:
                    break
                a, b, g_a, g_b = turn, high, -g_low, g
        if stop_index >= 0:
            n = s.counter[EVENTS]
            while (
                n > before and s.event[n - 1, 1] > t0 + stop_x * h
            ):  # what would have come after the stop did not happen
                n -= 1
            s.counter[EVENTS] = n
            evaluate(dense, stop_x, w)
            for e in range(len(watch.kind)):
                s.sign[e] = off_level(watch.kind[e], watch.level[e], t0 + stop_x * h, w, factor, p)
            s.sign[stop_index] = 0.0
            return stop_x, stop_index
        low = high
    return 2.0, -1


@inlined
def surface_met(y, new, mu, surface):
    """(whether a step from y to new ends below the surface, whether it passes a periapsis that may lie below it)."""
    touched = new[0] * new[0] + new[1] * new[1] + new[2] * new[2] < surface * surface
    passed = surface > 0.0 and measure(APSIS, 0.0, y, mu) < 0.0 and measure(APSIS, 0.0, new, mu) > 0.0
    return touched, passed


@inlined
def happenings(s, watch, t0, h, touched, passed, samples, factor, p, new, w):
    """Note what happens in the step [t0, t0 + h], whose polynomial is there. Returns x where it is cut short, with new
    = the state there, else 2."""
    m, mu, surface = s.work[DENSE:CLOCK], p.gravity.mu, p.surface.radius
    contact = 2.0
    lowest = 1.0
    if passed:
        lowest = root(m, APSIS, 0.0, mu, 0.0, 1.0, -1.0, w)
        touched = measure(RADIUS, surface, w, mu) < 0.0
    if touched:
        contact = root(m, RADIUS, surface, mu, 0.0, lowest, 1.0, w)
    return events_until(s, watch, m, t0, h, 0.0, contact, samples, factor, p, new, w)


@inlined
def events_until(s, watch, m, t0, h, x_start, contact, samples, factor, p, new, w):
    """Note the events of the step up to its end, x = 1, or to the contact with the surface. Returns x where it is cut
    short, with new = the state there, else 2."""
    stop_x, stop_index = 2.0, -1
    if len(watch.kind) > 0:
        stop_x, stop_index = find_events(s, watch, m, t0, h, x_start, min(contact, 1.0), samples, factor, p, w)
    if contact < min(stop_x, 2.0):
        evaluate(m, contact, w)
        note(s, -1, t0 + contact * h, w)
        stop_x, stop_index, s.counter[STATUS] = contact, -1, SURFACE
    if stop_x < 2.0:  # the run goes on, or ends, at the event
        evaluate(m, stop_x, new)
        if stop_index >= 0 and watch.action[stop_index] == STOP:
            s.counter[STATUS], s.counter[STOPPED_BY] = STOPPED, stop_index
        elif stop_index >= 0:
            s.counter[IN_USE] = 0
    return stop_x
