"""Where forces under a sky have kinks and jumps: edges of shadows, the magnetopause, where the craft turns back towards
the light under a law that is on or off, and where the air changes the side of the sail on which it falls.

A step ends at each of them, so that no shadow is jumped over and no step runs across a kink; where the force jumps, it
keeps to one side as far as the step goes. When that will be is foreseen along a Kepler arc (`edges_callback.arc`). A
shadow is approached by its distance over a speed that is not exceeded, so that even one that is crossed in a fraction
of a step is met.

A callback of the integrator: compiled when the first scene needs it.
"""

from __future__ import annotations

import numpy as np

from sailviz.compiled import STATE, called, inlined
from sailviz.environment import magnetosphere, sky
from sailviz.environment.eclipse import CYLINDER, NO_SHADOW
from sailviz.environment.shadow import PENUMBRA, SHARP, UMBRA, edge_distance
from sailviz.propagate.callbacks import Callback, callback
from sailviz.propagate.dynamics import direction
from sailviz.propagate.edges_callback import arc, arc_ahead, enter, next_kink
from sailviz.propagate.parameters import PARAMETERS, array_at, record_at
from sailviz.propagate.sky_callback import outside_magnetosphere, seen_from
from sailviz.steering import by_light

AHEAD = 0.02  # s after the start of a step at which its side is looked for: more than a foreseen time is wrong
FOUND = 1e-4  # s to which the time at an edge is found
LOOKS = 6  # at most along a step for what has no distance
CLOSEST = 1 / 400  # of a step, by which the approach to a shadow goes on at least
FASTER = 1.5  # a bound of the relative speed over that at the start of a step
EDGE_ON = 1e-9  # of the speed, below which a sail has no side towards the flow
RECEDING, WIND, FLOW = 3, 4, 5  # edges beside those of environment.shadow


@called
def across_the_flow(t, x, y, z, vx, vy, vz, m, p):
    """Speed, m/s, at which the air meets the sail's back, raised by EDGE_ON of the whole: a sail that its law keeps
    edge-on has rounding alone, and no sides."""
    inverse = 1.0 / np.sqrt(x * x + y * y + z * z)
    nx, ny, nz, _, _ = direction(t, x, y, z, vx, vy, vz, m, x * inverse, y * inverse, z * inverse, p)
    w = p.surface.rotation
    qx, qy, qz = vx + w * y, vy - w * x, vz
    return nx * qx + ny * qy + nz * qz + EDGE_ON * np.sqrt(qx * qx + qy * qy + qz * qz)


@called
def side(edge, body, t, dt, y, p, tables):
    """How far the arc from y at t is from an edge dt s later: m, or m/s; its sign tells the sides apart."""
    x, yy, z = arc(dt, y)
    at = p.places.sky
    sky.set_to(t + dt, at, p.sky, tables)
    if edge == WIND:
        return outside_magnetosphere(x, yy, z, p, tables)
    if edge in (RECEDING, FLOW):
        h = 1e-3 * np.sqrt((x * x + yy * yy + z * z) / (y[3] * y[3] + y[4] * y[4] + y[5] * y[5]))
        x1, y1, z1 = arc(dt + h, y)
        x0, y0, z0 = arc(dt - h, y)
        vx, vy, vz = 0.5 * (x1 - x0) / h, 0.5 * (y1 - y0) / h, 0.5 * (z1 - z0) / h
        if edge == FLOW:
            return across_the_flow(t + dt, x, yy, z, vx, vy, vz, y[6], p)
        ux, uy, uz, _ = sky.from_light(x, yy, z, at, tables)
        return vx * ux + vy * uy + vz * uz
    x, yy, z, lx, ly, lz, radius = seen_from(body, x, yy, z, p, tables)
    return edge_distance(edge, x, yy, z, lx, ly, lz, radius, p.sky.light_radius)


@called
def between(edge, body, t, low, high, at_low, at_high, y, p, tables):
    """Time between low and high (s after t) just beyond the edge: regula falsi, Illinois' way."""
    before = at_low > 0.0
    last = 0
    for _ in range(60):
        if high - low < FOUND:
            break
        middle = low - at_low * (high - low) / (at_high - at_low)
        middle = min(max(middle, low + 0.1 * FOUND), high - 0.1 * FOUND)
        value = side(edge, body, t, middle, y, p, tables)
        if (value > 0.0) != before:
            high, at_high = middle, value
            at_low *= 0.5 if last > 0 else 1.0
            last = 1
        else:
            low, at_low = middle, value
            at_high *= 0.5 if last < 0 else 1.0
            last = -1
    return high


@called
def by_looks(edge, body, t, span, y, p, tables):
    """Time after t, at most span s, at which an edge is crossed, by looking several times."""
    low = min(AHEAD, 0.5 * span)
    at_low = side(edge, body, t, low, y, p, tables)
    for look in range(1, LOOKS + 1):
        high = span * look / LOOKS
        if high <= low:
            continue
        at_high = side(edge, body, t, high, y, p, tables)
        if (at_high > 0.0) != (at_low > 0.0):
            return between(edge, body, t, low, high, at_low, at_high, y, p, tables)
        low, at_low = high, at_high
    return span


@called
def body_speed(body, t, span, p, tables):
    """Speed, m/s, of a body of the sky along a step; 0 of the central one."""
    if body < 0:
        return 0.0
    at = p.places.sky
    row = at + sky.HEAD + sky.BODY * body + sky.X
    sky.set_to(t, at, p.sky, tables)
    x, y, z = tables[row], tables[row + 1], tables[row + 2]
    sky.set_to(t + span, at, p.sky, tables)
    x, y, z = tables[row] - x, tables[row + 1] - y, tables[row + 2] - z
    return np.sqrt(x * x + y * y + z * z) / span


@called
def into_shadow(edge, body, t, span, y, p, tables):
    """The same for a shadow, from outside: no crossing is missed that is longer than CLOSEST of the span."""
    speed = np.sqrt(y[3] * y[3] + y[4] * y[4] + y[5] * y[5])
    speed = FASTER * (speed + body_speed(body, t, span, p, tables))
    low = min(AHEAD, 0.5 * span)
    at_low = side(edge, body, t, low, y, p, tables)
    if at_low <= 0.0:
        return by_looks(edge, body, t, span, y, p, tables)
    while low < span:
        high = min(span, low + max(at_low / speed, CLOSEST * span))
        at_high = side(edge, body, t, high, y, p, tables)
        if at_high <= 0.0:
            return between(edge, body, t, low, high, at_low, at_high, y, p, tables)
        low, at_low = high, at_high
    return span


@inlined
def _casts(body, p, tables):
    if body < 0:
        return p.sky.centre_radius > 0.0
    return tables[p.places.sky + sky.HEAD + sky.BODY * body + sky.RADIUS] > 0.0


@called
def next_shadow(t, span, y, p, tables):
    """Time after t, at most span s, at which a shadow's edge is crossed."""
    for body in range(-1, p.sky.bodies):
        if not _casts(body, p, tables):
            continue
        if p.sky.shadow == CYLINDER:
            span = into_shadow(SHARP, body, t, span, y, p, tables)
            continue
        span = into_shadow(PENUMBRA, body, t, span, y, p, tables)
        if side(PENUMBRA, body, t, min(AHEAD, 0.5 * span), y, p, tables) <= 0.0:
            span = by_looks(UMBRA, body, t, span, y, p, tables)
    return span


@called
def take_sides(t, y, p, tables):
    """Keep to the sides on which the craft is a moment later. Returns whether one of them has changed."""
    sides = p.sides
    lit, receding, windy, facing = sides.lit, sides.receding, sides.windy, sides.facing
    sides.lit = 1
    if p.sky.shadow == CYLINDER:
        for body in range(-1, p.sky.bodies):
            if _casts(body, p, tables) and side(SHARP, body, t, AHEAD, y, p, tables) <= 0.0:
                sides.lit = 0
    if p.by_light.law == by_light.ON_OFF:
        sides.receding = 1 if side(RECEDING, -1, t, AHEAD, y, p, tables) > 0.0 else 0
    if p.magnetosphere.kind != magnetosphere.NONE:
        sides.windy = 1 if side(WIND, -1, t, AHEAD, y, p, tables) > 0.0 else 0
    if p.pushed.drag_area > 0.0 or p.pushed.blown == 1:
        sides.facing = 1 if side(FLOW, -1, t, AHEAD, y, p, tables) > 0.0 else -1
    kept = lit == sides.lit and receding == sides.receding and windy == sides.windy
    return not kept or facing != sides.facing


def _ahead(time, state, parameters, own, number, out):
    """Before a step of at most `number` s: hold what it keeps to. state : its last three the acceleration, m/s2.
    out : s after which the step has to end, and 1 where the acceleration has jumped here."""
    p = record_at(parameters, PARAMETERS)
    y, tables, found = array_at(state, STATE), array_at(p.places.address, p.places.end), array_at(out, 4)
    fresh = p.held.active == 0  # at the start of a run nothing has been held
    jumps = enter(time, y, p, tables)
    jumps = take_sides(time, y, p, tables) or jumps or fresh
    span = next_kink(time, arc_ahead(y, number), y, p, tables)
    if p.sky.shadow != NO_SHADOW:
        span = next_shadow(time, span, y, p, tables)
    if p.by_light.law == by_light.ON_OFF:
        span = by_looks(RECEDING, -1, time, span, y, p, tables)
    if p.magnetosphere.kind != magnetosphere.NONE:
        span = by_looks(WIND, -1, time, span, y, p, tables)
    if p.pushed.drag_area > 0.0 or p.pushed.blown == 1:
        span = by_looks(FLOW, -1, time, span, y, p, tables)
    found[0], found[1], found[2], found[3] = span, 1.0 if jumps else 0.0, 0.0, 0.0


def sky_edges() -> Callback:
    """Where steps under a sky end, for `dynamics.model`."""
    return callback(_ahead)
