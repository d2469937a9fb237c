"""Where the search for a direct flight begins: rough flights over the flight time, the revolutions and the way.

In the plane the radius grows evenly from begin to end, at the circular speed, with one pitch throughout; in space
equinoctial elements do. Where a flight may come near the Sun, falls at several pitches are tried too, past the Sun and
out again. None of them needs to be flyable.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from sailviz.design.direct.electric import ElectricSail
from sailviz.design.direct.film import FilmSail
from sailviz.design.direct.transcription import POINTS, Guess, Question

OUTWARD = 0.6  # rad of pitch: near that of the largest transverse thrust of a film
FALLS = np.radians([20.0, 35.0, 50.0])  # pitches of a fall towards the Sun
STEPS_PER_TURN = 400  # of a rough flight, in the pace of motion


def mesh(q: Question) -> np.ndarray:
    """The nodes (4 N + 1,) of a question's mesh between 0 and 1, arcs by their durations."""
    if not q.arcs:
        return np.append(0.0, ((np.arange(q.intervals)[:, None] + POINTS) / q.intervals).ravel())
    found, begin, total = [np.zeros(1)], 0.0, sum(arc.duration for arc in q.arcs)
    for arc in q.arcs:
        share = arc.duration / total
        found.append(begin + share * ((np.arange(arc.intervals)[:, None] + POINTS) / arc.intervals).ravel())
        begin += share
    return np.concatenate(found)


def times_of(radii: np.ndarray, s: np.ndarray, pace: float, span: float) -> np.ndarray:
    """Times (n,) at nodes s of a mesh on which dt / ds is as radii^pace, over a span."""
    rate = radii**pace
    time = np.append(0.0, np.cumsum(0.5 * (rate[1:] + rate[:-1]) * np.diff(s)))
    return span * time / time[-1]


def spiral_time(sail: FilmSail | ElectricSail, first: float, last: float) -> float:
    """A rough flight time between circles: a slow spiral or, with much thrust, half an ellipse."""
    across = 0.385 if isinstance(sail, FilmSail) else 0.25  # the largest transverse thrust over the characteristic one
    k = sail.fall - 1.5
    change = abs(np.log(last / first)) if k == 0 else abs((last**k - first**k) / k)
    slow = change / (2 * across * sail.strength)
    return float(np.hypot(slow, np.pi * (0.5 * (first + last)) ** 1.5))


def planar(q: Question, first: float, last: float, span: float, turns: float, pitch: float) -> Guess:
    """Evenly from radius to radius within a span and some turns, at one pitch."""
    s = mesh(q)
    r = first + (last - first) * s
    states = np.stack([r, 2 * np.pi * turns * s, 0 * s, r**-0.5], axis=1)
    vectors = np.tile(q.sail.vector_of(pitch), (len(s), 1))
    words = f"{turns:.2f} revolutions"
    return Guess(states, times_of(r, s, q.pace, span), vectors, words)


def planar_guesses(q: Question, first: float, last: float, angle: float | None = None) -> Iterator[Guess]:
    """Several, the likeliest first. angle : swept, rad, where that is given."""
    quick = spiral_time(q.sail, first, last)
    outward = OUTWARD if last >= first else -OUTWARD
    for stretch in (0.9, 1.4, 0.6):
        span = stretch * quick
        turns = span / (2 * np.pi * (0.5 * (first + last)) ** 1.5) if angle is None else angle / (2 * np.pi)
        if angle is not None:
            span = angle * (0.5 * (first + last)) ** 1.5 * (stretch / 0.9)
        yield planar(q, first, last, span, turns, outward)


def falls(q: Question, closest: float, last: float) -> Iterator[Guess]:
    """Down past the Sun at a distance and out to a radius, at several pitches of the fall."""
    for pitch in FALLS:
        found = _fall(q, closest, last, float(pitch))
        if found is not None:
            yield found


def _fall(q: Question, closest: float, last: float, pitch: float) -> Guess | None:
    from sailviz.design.direct.ends import FromState

    assert isinstance(q.start, FromState), "a fall begins at a given state"
    y, t = np.array([q.start.state_given[i] for i in range(4)]), 0.0
    rows, phase = [(t, *y, -pitch)], 0
    while len(rows) < 20_000:
        r, _, u, v = y
        if phase == 0:
            h, energy = r * v, 0.5 * (u * u + v * v) - 1 / r
            a, e2 = -0.5 / energy, 1 + 2 * energy * h * h
            if energy < 0 and a * (1 - np.sqrt(max(e2, 0.0))) < 1.02 * closest:
                phase = 1
        elif phase == 1 and u > 0:
            phase = 2
        elif phase == 2 and r > last:
            break
        attitude = (-pitch, 0.5 * np.pi, 0.5 * OUTWARD)[phase]
        h_t = 2 * np.pi * r**1.5 / STEPS_PER_TURN
        y, t = _stepped(q, y, attitude, h_t), t + h_t
        rows.append((t, *y, attitude))
        if r < 0.5 * closest or r > 4 * max(last, 1.0):
            return None
    else:
        return None
    flown = np.array(rows)
    s = np.append(0.0, np.cumsum(np.diff(flown[:, 0]) * flown[1:, 1] ** -q.pace))
    nodes = mesh(q) * s[-1]
    time, r, angle, u, v, attitude = (np.interp(nodes, s, column) for column in flown.T)
    if q.limits.closest is not None:
        r = np.maximum(r, q.limits.closest)
    vectors = np.array([q.sail.vector_of(float(x)) for x in np.clip(attitude, -1.3, 1.3)])
    return Guess(np.stack([r, angle, u, v], axis=1), time, vectors, f"a fall at a pitch of {np.degrees(pitch):.0f} deg")


def _stepped(q: Question, y: np.ndarray, pitch: float, h: float) -> np.ndarray:
    """One step of Runge and Kutta's fourth order of a polar state at one pitch."""

    def rates(x: np.ndarray) -> np.ndarray:
        r, _, u, v = x
        c, s = max(np.cos(pitch), 0.0), np.sin(pitch)
        if isinstance(q.sail, FilmSail):
            size = q.sail.strength / q.sail.film.total * c / r**2
            along = q.sail.film.b2 * c + q.sail.film.b3
            push = size * (q.sail.film.b1 + along * c), size * along * s
        else:
            size = q.sail.strength / (2 * r)
            push = size * (1 + c * c), size * c * s
        return np.array([u, v / r, v * v / r - 1 / r**2 + push[0], push[1] - u * v / r])

    a = rates(y)
    b = rates(y + 0.5 * h * a)
    c = rates(y + 0.5 * h * b)
    d = rates(y + h * c)
    return y + h / 6 * (a + 2 * b + 2 * c + d)


# ---------------------------------------------------------------- in space


def spatial(q: Question, first: np.ndarray, last: np.ndarray, span: float, turns: int) -> Guess:
    """From state to state (6,) within a span, equinoctial elements and longitude changed evenly; some whole turns more
    than the angle between. ValueError where one of the two moves backwards: equinoctial elements fail there."""
    a, b = _equinoctial(first), _equinoctial(last)
    sweep = (b[5] - a[5]) % (2 * np.pi) + 2 * np.pi * turns
    b[5] = a[5] + sweep
    s = mesh(q)
    states = _from_equinoctial(a + (b - a) * s[:, None])
    r = np.linalg.norm(states[:, :3], axis=1)
    u = states[:, :3] / r[:, None]
    h = np.cross(states[:, :3], states[:, 3:])
    t = np.cross(h / np.linalg.norm(h, axis=1)[:, None], u)
    outward = OUTWARD if r[-1] >= r[0] else -OUTWARD
    along, across = q.sail.vector_of(outward)
    return Guess(states, times_of(r, s, q.pace, span), along * u + across * t, f"{sweep / (2 * np.pi):.2f} revolutions")


def _equinoctial(state: np.ndarray) -> np.ndarray:
    """(6,) p, f, g, h, k, L of a state."""
    r, v = state[:3], state[3:]
    momentum = np.cross(r, v)
    n = momentum / np.linalg.norm(momentum)
    if n[2] < -0.9:
        raise ValueError("no guess is known for an orbit that runs backwards")
    h, k = -n[1] / (1 + n[2]), n[0] / (1 + n[2])
    size = 1 + h * h + k * k
    f_hat = np.array([1 + h * h - k * k, 2 * h * k, -2 * k]) / size
    g_hat = np.array([2 * h * k, 1 - h * h + k * k, 2 * h]) / size
    e = np.cross(v, momentum) - r / np.linalg.norm(r)
    return np.array([momentum @ momentum, e @ f_hat, e @ g_hat, h, k, np.arctan2(r @ g_hat, r @ f_hat)])


def _from_equinoctial(rows: np.ndarray) -> np.ndarray:
    """States (n, 6) of rows (n, 6)."""
    p, f, g, h, k, longitude = rows.T
    size = 1 + h * h + k * k
    f_hat = np.stack([1 + h * h - k * k, 2 * h * k, -2 * k], axis=1) / size[:, None]
    g_hat = np.stack([2 * h * k, 1 - h * h + k * k, 2 * h], axis=1) / size[:, None]
    c, s = np.cos(longitude), np.sin(longitude)
    r = p / (1 + f * c + g * s)
    place = (r * c)[:, None] * f_hat + (r * s)[:, None] * g_hat
    speed = (-(g + s) / np.sqrt(p))[:, None] * f_hat + ((f + c) / np.sqrt(p))[:, None] * g_hat
    return np.hstack([place, speed])
