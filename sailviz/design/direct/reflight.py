"""A direct flight as a table of attitudes, and that table flown by the ordinary propagator: what the solution is worth.

The finite problem knows its polynomials only; between the points the sail is not held to anything. The table is what a
scene gets, and the miss of its flight is the miss that is told.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sailviz import frames
from sailviz.constants import AU, MU_SUN
from sailviz.design.direct.frames_of_state import Planar
from sailviz.design.direct.limits import heat_factor
from sailviz.design.direct.transcription import DEGREE, NODES, POINTS, Nodes, Question, Transcription
from sailviz.design.minimum_time.replay import SteeringTable
from sailviz.design.minimum_time.state_costate import SPEED_UNIT, TIME_UNIT
from sailviz.propagate import dop853, dynamics
from sailviz.propagate.events import watch
from sailviz.propulsion.devices import sail
from sailviz.steering import attitude

TABLE_ERROR = 1e-5  # rad of attitudes between the rows of a table
FINEST = 64  # rows of an interval at most
AFTER_SWITCH = 1e-3  # s from the row before a switch to the row after it
TOLERANCE = 1e-12
SAMPLES = 2000  # of a flight


def table_of(q: Question, nodes: Nodes) -> SteeringTable:
    """Pitch, clock and throttle of a flight, rows of its control's polynomials dense enough to be read linearly."""
    rows = 4
    while True:
        time, pitch, clock, throttle = _read(q, nodes, rows)
        fine = _read(q, nodes, 2 * rows)
        error = _between(fine)
        if error <= TABLE_ERROR or rows >= FINEST:
            break
        rows *= 2
    state = q.axes.cartesian(nodes.states[:1])[0]
    switches = _switches(q, nodes) * TIME_UNIT
    return SteeringTable(time, pitch, clock, throttle, error, state[:3] * AU, state[3:] * SPEED_UNIT, switches)


def _switches(q: Question, nodes: Nodes) -> np.ndarray:
    """Times (k,) at which one part of the flight with a mesh of its own ends and the next begins."""
    return nodes.times[DEGREE * np.cumsum(q.lengths)[:-1]]


def _lagrange(nodes: np.ndarray, at: np.ndarray) -> np.ndarray:
    """(m, k): values of Lagrange's polynomials on nodes (k,) at points (m,)."""
    found = np.ones((len(at), len(nodes)))
    for j, x in enumerate(nodes):
        for other in np.delete(nodes, j):
            found[:, j] *= (at - other) / (x - other)
    return found


def _read(q: Question, nodes: Nodes, rows: int) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Time s, pitch and clock rad, throttle of so many rows for each interval and one more: controls jump a little
    from interval to interval, so that there are rows before and after."""
    at = np.arange(rows + 1) / rows
    states, controls = _lagrange(NODES, at), _lagrange(POINTS, at)
    times, x, vectors, throttles = [], [], [], []
    for i in range(sum(q.lengths)):
        own, here = slice(DEGREE * i, DEGREE * (i + 1) + 1), slice(DEGREE * i, DEGREE * (i + 1))
        time = (states @ nodes.times[own]) * TIME_UNIT
        time[0] += AFTER_SWITCH * (i > 0)
        times.append(time)
        x.append(states @ nodes.states[own])
        vectors.append(states @ nodes.vectors[own] if q.turns else controls @ nodes.vectors[here])
        throttles.append(np.clip(controls @ nodes.throttles[here], 0.0, 1.0))
    time, path, throttle = np.concatenate(times), np.vstack(x), np.concatenate(throttles)
    cartesian = q.axes.cartesian(path)
    outward = cartesian[:, :3] / np.linalg.norm(cartesian[:, :3], axis=1)[:, None]
    inertial = q.axes.inertial(path, np.vstack(vectors))
    if q.turns:
        normal = inertial / np.linalg.norm(inertial, axis=1)[:, None]
    else:
        normal = q.sail.normals(outward, inertial, throttle)
    local = frames.to_frame(frames.rtn(cartesian[:, :3], cartesian[:, 3:]), normal)
    pitch, clock = _angles(local)
    pitch = _kept(q, pitch, np.linalg.norm(cartesian[:, :3], axis=1))
    return time, pitch, clock, throttle if q.sail.throttles else np.ones_like(time)


def _kept(q: Question, pitch: np.ndarray, radius: np.ndarray) -> np.ndarray:
    """Pitch angles (n,) within a question's limits at radii (n,) au: between the points where they hold the control's
    polynomials leave them a little."""
    least, most = np.zeros_like(radius), np.full_like(radius, np.pi)
    if q.limits.hottest is not None:
        least = np.arccos(np.minimum(heat_factor(q.limits.hottest, q.sail.device) * radius**2, 1.0))
    if q.limits.cone is not None:
        most = np.full_like(radius, q.limits.cone)
    return np.asarray(np.where(pitch < 0, -1.0, 1.0) * np.clip(np.abs(pitch), least, np.maximum(least, most)))


def _angles(local: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Pitch and clock rad of normals (n, 3), radial, transverse and normal; the pitch changes its sign rather than the
    clock jump by half a turn."""
    across = np.hypot(local[:, 1], local[:, 2])
    side = local[:, 1:] / np.maximum(across, np.finfo(float).tiny)[:, None]
    for i in np.nonzero(across < 1e-12)[0]:  # facing the Sun: any clock is right
        side[i] = side[i - 1] if i else [1.0, 0.0]
    sign = np.concatenate([[1.0], np.cumprod(np.where(np.sum(side[1:] * side[:-1], axis=1) < 0, -1.0, 1.0))])
    clock = np.unwrap(np.arctan2(sign * side[:, 0], sign * side[:, 1]))
    return sign * np.arctan2(across, local[:, 0]), clock


def _between(rows: tuple[np.ndarray, ...]) -> float:
    """Largest angle, rad, between normals and those read linearly from every second row, where there is thrust."""
    time, pitch, clock, throttle = rows
    if len(time) < 3:
        return 0.0
    share = (time[1:-1] - time[:-2]) / (time[2:] - time[:-2])
    even = np.abs(share - 0.5) < 0.45  # not across a switch
    read = [x[:-2] + share * (x[2:] - x[:-2]) for x in (pitch, clock)]
    a = _normals(*read)
    b = _normals(pitch[1:-1], clock[1:-1])
    wrong = np.arctan2(np.linalg.norm(np.cross(a, b), axis=1), np.sum(a * b, axis=1))
    return float(np.max(wrong, where=even & (throttle[1:-1] > 0), initial=0.0))


def _normals(pitch: np.ndarray, clock: np.ndarray) -> np.ndarray:
    return np.column_stack([np.cos(pitch), np.sin(pitch) * np.sin(clock), np.sin(pitch) * np.cos(clock)])


@dataclass(frozen=True)
class Confirmed:
    """A table's flight by the ordinary propagator: position (n, 3) m and velocity (n, 3) m/s at times (n,) s; miss, the
    largest of the end's conditions left, in units of the target or of mu = 1 and one au; error s, what the misses are
    worth in flight time."""

    time: np.ndarray
    position: np.ndarray
    velocity: np.ndarray
    miss: float
    error: float


def confirm(
    transcription: Transcription, nodes: Nodes, table: SteeringTable, characteristic_acceleration: float
) -> Confirmed:
    """Fly a table of attitudes and see how near it comes to the end that was asked for."""
    q = transcription.question
    kind, numbers = sail(q.sail.device, characteristic_acceleration)
    rows = attitude.table(table.time, table.pitch, table.clock, table.throttle)
    model = dynamics.model(MU_SUN, device=kind, device_parameters=numbers, steering=attitude.TABLE_ORBITAL, table=rows)
    end = float(nodes.times[-1] * TIME_UNIT)
    times = np.linspace(0.0, end, SAMPLES)
    out = np.empty((6, len(times)))
    state = dop853.start(0.0, table.position, table.velocity, 1.0)
    breaks = np.unique([0.0, *(t for t in table.switches if 0 < t < end)])
    status = dop853.advance(state, model, breaks, np.ones_like(breaks), watch([]), times, out, end, TOLERANCE, np.inf)
    if status != dop853.DONE:
        return Confirmed(times, out[:3].T, out[3:].T, np.inf, np.inf)
    last = _in_axes(q, out, nodes)
    moment = float(nodes.times[-1] + (nodes.start[0] if len(nodes.start) == 2 else 0.0))
    misses = np.array(transcription.conditions(last, moment, nodes.end)).ravel()
    error = float(np.abs(misses) @ np.abs(nodes.prices)) * TIME_UNIT
    return Confirmed(times, out[:3].T, out[3:].T, float(np.abs(misses).max()), error)


def _in_axes(q: Question, rows: np.ndarray, nodes: Nodes) -> np.ndarray:
    """The last of rows (6, n) m, m/s in a question's axes and units."""
    place, speed = rows[:3, -1] / AU, rows[3:, -1] / SPEED_UNIT
    if not isinstance(q.axes, Planar):
        return np.concatenate([place, speed])
    swept = float(np.unwrap(np.arctan2(rows[1], rows[0]))[-1])
    swept += 2 * np.pi * round((nodes.states[-1, 1] - swept) / (2 * np.pi))
    r = np.hypot(*place[:2])
    u = place[:2] / r
    return np.array([r, swept, u @ speed[:2], u[0] * speed[1] - u[1] * speed[0]])
