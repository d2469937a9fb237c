"""Points between rows that lie far apart, for the eye alone: Kepler's motion from the row before and, where that misses
the next row, what has to be added as a cubic on top (Hermite's).

No point of it is a row: nothing is counted, measured or judged by it. Where neither tells the way there is none.
Source of the rule: that a coast is Kepler's arc and that Hermite's cubic needs steps under a twelfth of a turn.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from sailviz import ephemeris, frames, two_body
from sailviz.elements import elements
from sailviz.run import gaps, resample
from sailviz.run.arrays import Attitude, Run, Thrust

EVEN = 72  # points in a revolution
MOST = 4 * EVEN  # between two rows
ALL = 4000  # of a run, about
COAST = 1e-3  # of the way between two rows, and of the speed: what Kepler's motion may miss of a coast
SHORT = 1 / 12  # of a revolution, below which a cubic tells the way
PUSHED = 0.05  # of the way between two rows: what thrust may add over longer steps, as a cubic on top of Kepler's
SCAN, LOOKS = 65, 3  # times at which the swept angle is looked up, and how often for an orbit that turns sharply


class Points(NamedTuple):
    """row (m,) of the run before each point; time (m,) s, position (m, 3) m, velocity (m, 3) m/s; coast (m,) bool,
    whether Kepler's motion alone leads to the next row. unknown (k,) : rows from which no way is known to the next."""

    row: np.ndarray
    time: np.ndarray
    position: np.ndarray
    velocity: np.ndarray
    coast: np.ndarray
    unknown: np.ndarray


@dataclass(frozen=True)
class FilledRun:
    """run : rows and the points between them, in order; filled (n,) bool, which of them are points."""

    run: Run
    filled: np.ndarray


def points_between(run: Run) -> Points:
    """The points of a run between rows that are more than 1 / EVEN of a revolution apart, gaps and jumps left out."""
    mu = run.setting.body.mu
    step = np.diff(run.time)
    swept = revolutions(run, mu)
    far = np.setdiff1d(np.flatnonzero((swept > 1 / EVEN) & (step > 0)), gaps.last_rows(run.time, run.setting.gaps))
    found: list[tuple[np.ndarray, ...]] = []
    unknown: list[int] = []
    if len(far):
        ends = two_body.advance(run.position[far], run.velocity[far], step[far], mu)
        off, turned = run.position[far + 1] - ends[0], run.velocity[far + 1] - ends[1]
        with np.errstate(invalid="ignore", divide="ignore"):
            way = np.linalg.norm(run.position[far + 1] - run.position[far], axis=1)
            way = np.maximum(way, np.linalg.norm(run.position[far], axis=1) * np.minimum(swept[far], 1.0))
            missed = np.linalg.norm(off, axis=1) / way
            slower = np.linalg.norm(turned, axis=1) / np.linalg.norm(run.velocity[far + 1], axis=1)
        known = (missed < PUSHED) | ((swept[far] < SHORT) & np.isfinite(missed))
        unknown = far[~known].tolist()
        coarser = max(float(np.sum(np.minimum(EVEN * swept[far[known]], MOST))) / ALL, 1.0)
        for row, d, w, coast in zip(
            far[known].tolist(), off[known], turned[known], ((missed < COAST) & (slower < COAST))[known], strict=True
        ):
            s = even_shares(run, row, float(step[row]), mu, coarser)[1:-1]
            place, speed = bent(run, row, s, d, w, mu)
            count = len(s)
            found.append((np.full(count, row), run.time[row] + s * step[row], place, speed, np.full(count, coast)))
    open_ = np.array(unknown, int)
    if not found:
        none = np.zeros(0)
        return Points(none.astype(int), none, np.zeros((0, 3)), np.zeros((0, 3)), none.astype(bool), open_)
    row, time, place, speed, coast = (np.concatenate(part) for part in zip(*found, strict=True))
    return Points(row, time, place, speed, coast, open_)


def bent(
    run: Run, row: int, share: np.ndarray, off: np.ndarray, turned: np.ndarray, mu: float
) -> tuple[np.ndarray, np.ndarray]:
    """Places (p, 3) m and velocities (p, 3) m/s at shares (p,) of the time from a row to the next: Kepler's motion from
    the row and on top the cubic that meets the next one, whose place it misses by `off` (3,) m and whose velocity by
    `turned` (3,) m/s."""
    h = float(run.time[row + 1] - run.time[row])
    s = share[:, None]
    count = len(share)
    place, speed = two_body.advance(
        np.tile(run.position[row], (count, 1)), np.tile(run.velocity[row], (count, 1)), share * h, mu
    )
    place = place + (3 * s**2 - 2 * s**3) * off + (s**3 - s**2) * h * turned
    speed = speed + (6 * s - 6 * s**2) * off / h + (3 * s**2 - 2 * s) * turned
    return place, speed


def revolutions(run: Run, mu: float) -> np.ndarray:
    """(n - 1,) from row to row: by the faster of the two rows' pace, or by the mean one of their orbit."""
    r2 = np.sum(run.position**2, axis=1)
    rate = np.linalg.norm(np.cross(run.position, run.velocity), axis=1) / r2 / (2 * np.pi)
    a = run.elements.semi_major_axis
    with np.errstate(invalid="ignore", divide="ignore"):
        mean = np.where((a > 0) & np.isfinite(a), np.sqrt(mu / np.abs(a) ** 3), 0.0) / (2 * np.pi)
    rate = np.maximum(rate, mean)
    return np.asarray(np.maximum(rate[1:], rate[:-1]) * np.diff(run.time))


def fly(run: Run, row: int, times: np.ndarray, mu: float) -> np.ndarray:
    """Places (p, 3) m on the orbit of a row, times (p,) s after it."""
    count = len(times)
    places, _ = two_body.advance(
        np.tile(run.position[row], (count, 1)), np.tile(run.velocity[row], (count, 1)), times, mu
    )
    return places


def even_shares(run: Run, row: int, step: float, mu: float, coarser: float = 1.0) -> np.ndarray:
    """Shares of the time (p,), 0 to 1, at which the angle swept from the centre is nearly even; coarser : how many
    times larger than a part in EVEN of a revolution it is."""
    s = np.linspace(0, 1, SCAN)
    for _ in range(LOOKS):
        out = fly(run, row, s * step, mu)
        out /= np.linalg.norm(out, axis=1, keepdims=True)
        angle = np.arctan2(np.linalg.norm(np.cross(out[1:], out[:-1]), axis=1), np.sum(out[1:] * out[:-1], axis=1))
        along = np.concatenate([[0.0], np.cumsum(angle)]) + 1e-3 * s  # a fall straight down sweeps nothing
        if angle.max() < 2 * (2 * np.pi / EVEN):
            break
        s = np.interp(np.linspace(0, along[-1], SCAN), along, s)  # closer where it turns fast
    count = int(np.clip(np.ceil(EVEN * along[-1] / (2 * np.pi * coarser)), 4 / coarser, MOST)) + 1
    return np.asarray(np.interp(np.linspace(0, along[-1], max(count, 2)), along, s))


def can_be_filled(run: Run) -> bool:
    """Whether a run is arrays from elsewhere, with bodies whose places are known at any time."""
    known = {"Sun"} if run.setting.body.name == "Earth" else set(ephemeris.PLANETS)
    dated = run.setting.epoch is not None or not run.bodies
    return run.setting.resolved.get("kind") == "trajectory" and dated and set(run.bodies) <= known


def filled_run(run: Run, points: Points) -> FilledRun:
    """Rows and points in order of time. Attitude and thrust go evenly from row to row, what is switched or stowed stays
    as in the row before."""
    order = np.argsort(np.concatenate([np.arange(len(run)), points.row + 0.5]), kind="stable")
    filled = np.concatenate([np.zeros(len(run), bool), np.ones(len(points.row), bool)])[order]
    after = points.row + 1
    stowed = np.asarray(~run.attitude.normal.any(axis=1))
    held = np.asarray(stowed[points.row] | stowed[after])[:, None]

    def between(name: str, values: np.ndarray) -> np.ndarray:
        return resample.at(points.time, name, run.time, values)

    def put(rows: np.ndarray, new: np.ndarray) -> np.ndarray:
        found: np.ndarray = np.concatenate([rows, new])[order]
        return found

    position, velocity = put(run.position, points.position), put(run.velocity, points.velocity)
    normal = np.where(held, run.attitude.normal[points.row], frames.unit(between("normal", run.attitude.normal)))
    quaternion = np.where(held, run.attitude.quaternion[points.row], between("quaternion", run.attitude.quaternion))
    steady = np.asarray(run.thrust.on[points.row] & run.thrust.on[after])[:, None]
    push = np.where(steady, between("acceleration", run.thrust.acceleration), run.thrust.acceleration[points.row])
    axes = frames.rtn(points.position, points.velocity)
    pitch, cone, clock = frames.pitch_cone_clock(axes, normal, push)
    bare = ~normal.any(axis=1)
    attitude = Attitude(
        put(run.attitude.pitch, np.where(bare, np.nan, pitch)),
        put(run.attitude.cone, cone),
        put(run.attitude.clock, np.where(bare, np.nan, clock)),
        put(run.attitude.normal, normal),
        put(run.attitude.quaternion, quaternion),
    )
    size = np.linalg.norm(push, axis=1)
    thrust = Thrust(
        put(run.thrust.acceleration, push),
        put(run.thrust.acceleration_rtn, frames.to_frame(axes, push)),
        put(run.thrust.magnitude, size),
        put(run.thrust.on, run.thrust.on[points.row]),
    )
    whole = replace(
        run,
        time=put(run.time, points.time),
        position=position,
        velocity=velocity,
        mass=put(run.mass, run.mass[points.row]),
        attitude=attitude,
        thrust=thrust,
        elements=elements(position, velocity, run.setting.body.mu),
        environment={name: put(values, _acting(run, points, name)) for name, values in run.environment.items()},
        bodies={name: put(places, _place(run, name, points.time)) for name, places in run.bodies.items()},
        approximations={},
    )
    return FilledRun(whole, filled)


def _acting(run: Run, points: Points, name: str) -> np.ndarray:
    """What surrounds the craft, as in the row before; how far the Earth has turned is known at any time."""
    if name == "earth_rotation_rad" and run.setting.epoch is not None:
        return np.asarray(ephemeris.greenwich_sidereal_time(run.setting.epoch, points.time))
    return np.asarray(run.environment[name][points.row])


def _place(run: Run, name: str, time: np.ndarray) -> np.ndarray:
    """Where a body stands at times (m,) s, (m, 3) m."""
    assert run.setting.epoch is not None  # else it has no bodies that move
    if name == "Sun":
        return np.asarray(ephemeris.sun_position(run.setting.epoch, time))
    return np.asarray(ephemeris.planet_position(name, run.setting.epoch, time))
