"""Whether times, positions and velocities are in the units they should be in: what flies along a conic says so itself.

The median miss over some pairs of rows between where Kepler's motion leads and where the next row stands, as a share of
the way between them, is near 0 in the right units and near or above 1 in wrong ones.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sailviz import two_body
from sailviz.constants import AU, DAY

Floats = NDArray[np.float64]

PAIRS = 9  # of rows that are looked at
RIGHT = 0.05  # a miss below is that of the right units
CLEARER = 3.0  # how many times smaller the miss of the only other reading must be
SLOWEST, FASTEST = 0.5, 1.05  # of the way over speed times step: chords of honest data lie within 0.83 and 1.002
SHORT = 0.25  # of the osculating period: longer steps have chords that say nothing about speed
STRANGE_MU = 2.0  # factor by which the gravity in the rows may differ from mu before it is another body's


@dataclass(frozen=True)
class Reading:
    """What the numbers might be: words, and the factors that would make SI of them."""

    words: str
    time: float = 1.0
    position: float = 1.0
    velocity: float = 1.0


_TIMES = (("ns", 1e-9), ("us", 1e-6), ("ms", 1e-3), ("minutes", 60.0), ("hours", 3600.0), ("days", DAY))
READINGS = (
    *(Reading(f"time looks like {unit}, wanted s", time=factor) for unit, factor in _TIMES),
    Reading("position looks like kilometres, wanted m", position=1e3),
    Reading("position looks like au, wanted m", position=AU),
    Reading("velocity looks like kilometres a second, wanted m/s", velocity=1e3),
    Reading("velocity looks like metres a day, wanted m/s", velocity=1 / DAY),
    Reading("velocity looks like kilometres a day, wanted m/s", velocity=1e3 / DAY),
    Reading("velocity looks like kilometres an hour, wanted m/s", velocity=1e3 / 3600),
    Reading("position looks like kilometres and velocity like km/s, wanted m and m/s", position=1e3, velocity=1e3),
    Reading(
        "position looks like kilometres and velocity like km/day, wanted m and m/s", position=1e3, velocity=1e3 / DAY
    ),
    Reading("position looks like au and velocity like au/day, wanted m and m/s", position=AU, velocity=AU / DAY),
    Reading("position looks like au and velocity like km/s, wanted m and m/s", position=AU, velocity=1e3),
    Reading("time looks like days, position like kilometres and velocity like km/s, wanted SI", DAY, 1e3, 1e3),
    Reading("time looks like days, position like au and velocity like au/day, wanted SI", DAY, AU, AU / DAY),
)


def fault(time: Floats, position: Floats, velocity: Floats, mu: float) -> tuple[str, str]:
    """(what is wrong with the units, what is merely strange), each "" where there is nothing.

    time (n,) s, position (n, 3) m, velocity (n, 3) m/s of rows of which some follow one another within one arc; mu
    in m3/s2. Thrust as large as gravity, or rows a turn apart, make the rows follow no reading: that is strange, not
    wrong.
    """
    rows = _pairs(time)
    if len(rows) == 0:
        return "", ""
    states = position[rows], velocity[rows], position[rows + 1], time[rows + 1] - time[rows]
    as_said = _miss(*states, Reading(""), mu)
    if as_said < RIGHT:
        return "", _strange_gravity(position[rows], velocity[rows], position[rows + 1], velocity[rows + 1], mu)
    misses = sorted((_miss(*states, reading, mu), i) for i, reading in enumerate(READINGS))
    best, second = misses[0], misses[1]
    if best[0] < RIGHT and CLEARER * best[0] < min(second[0], as_said):
        return READINGS[best[1]].words, ""
    return _wrong_speed(*states, velocity[rows + 1], mu), "the rows do not follow gravity alone"


def miss(time: Floats, position: Floats, velocity: Floats, mu: float) -> float:
    """How far, as a share of the way, Kepler's motion under a mu m3/s2 misses the next row: the median over some rows
    as in `fault`; infinite where no two rows follow one another."""
    rows = _pairs(time)
    if len(rows) == 0:
        return np.inf
    return _miss(position[rows], velocity[rows], position[rows + 1], time[rows + 1] - time[rows], Reading(""), mu)


def _pairs(time: Floats) -> NDArray[np.int64]:
    """Rows that have another one a positive step after them, spread over the whole run."""
    usable = np.flatnonzero(np.diff(time) > 0)
    if len(usable) <= PAIRS:
        return usable
    step = np.diff(time)[usable]
    usable = usable[step <= 3 * np.median(step)]  # not across gaps
    return usable[np.unique(np.linspace(0, len(usable) - 1, PAIRS).round().astype(np.int64))]


def _miss(r0: Floats, v0: Floats, r1: Floats, step: Floats, reading: Reading, mu: float) -> float:
    """Median of |Kepler's place - the next row| over the way between the rows."""
    a, b = r0 * reading.position, r1 * reading.position
    reached, _ = two_body.advance(a, v0 * reading.velocity, step * reading.time, mu)
    with np.errstate(invalid="ignore", divide="ignore", over="ignore"):
        share = np.linalg.norm(reached - b, axis=1) / np.linalg.norm(b - a, axis=1)
    share = np.where(np.isfinite(share), share, np.inf)
    return float(np.median(share))


def _wrong_speed(r0: Floats, v0: Floats, r1: Floats, step: Floats, v1: Floats, mu: float) -> str:
    """A sentence where the craft moves at another speed than its velocity says."""
    r, v2 = np.linalg.norm(r0, axis=1), np.sum(v0 * v0, axis=1)
    with np.errstate(invalid="ignore", divide="ignore"):
        axis = 1 / np.maximum(2 / r - v2 / mu, 1e-300)
        turn = 2 * np.pi * np.sqrt(np.minimum(axis, 1e60) ** 3 / mu)
        short = step < SHORT * turn
        way = np.linalg.norm(r1 - r0, axis=1) / step
        ratio = way / (0.5 * (np.linalg.norm(v0, axis=1) + np.linalg.norm(v1, axis=1)))
    if not np.any(short):
        return ""
    found = float(np.median(ratio[short]))
    if SLOWEST <= found <= FASTEST:
        return ""
    return (
        f"the craft moves {found:.3g} times as fast as its velocity says; check the units of time, position, velocity"
    )


def _strange_gravity(r0: Floats, v0: Floats, r1: Floats, v1: Floats, mu: float) -> str:
    """A sentence where the energy of the rows asks for another mu: dense rows would not show it otherwise."""
    near, far = 1 / np.linalg.norm(r0, axis=1), 1 / np.linalg.norm(r1, axis=1)
    telling = np.abs(far - near) > 1e-3 * near
    if not np.any(telling):
        return ""
    work = np.sum(v1 * v1, axis=1) - np.sum(v0 * v0, axis=1)
    found = float(np.median(work[telling] / (2 * (far - near)[telling])))
    if mu / STRANGE_MU < found < mu * STRANGE_MU:
        return ""
    return f"the rows change speed as if mu were {found:.3g} m3/s2, not {mu:.6g}"
