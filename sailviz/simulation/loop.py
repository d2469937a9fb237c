"""Scene -> Run: the propagator fills block after block of a plan, and each row gets what the recording shows."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from time import perf_counter
from typing import Any

import numpy as np

from sailviz import elements as orbital
from sailviz import frames
from sailviz.constants import DAY
from sailviz.errors import PropagationError, TimeLimitError
from sailviz.propagate import dynamics, stepping
from sailviz.propagate.events import STOP
from sailviz.propagate.patience import Patience
from sailviz.propulsion.devices import CALLED, THRUSTER
from sailviz.run.arrays import Attitude, EnsembleStatistics, Event, Run, Setting, Thrust, join
from sailviz.run.devices import SAILS
from sailviz.scene.loading import SceneSource, load_scene
from sailviz.simulation.beside import observed_devices, sum_of, thrust_of
from sailviz.simulation.environment_columns import axes_of_light, observe, voltages
from sailviz.simulation.integration import INTEGRATORS, begun
from sailviz.simulation.metadata import bodies, planets_in_view, setting_of
from sailviz.simulation.no_progress import too_many, too_short, too_slow
from sailviz.simulation.output_times import OutputTimes
from sailviz.simulation.plan import Plan, plan

BLOCK_ROWS = 16_384  # a recording takes this many at once


def simulate(
    scene: SceneSource, *, steering: object = None, force: object = None, time_limit: float | None = None
) -> Run:
    """Propagate a scene and return the whole Run.

    scene : a Scene, or what `load_scene` takes: a path, a shipped name ("displaced/circular") or a dict.

    steering : own attitude law, force : own additional acceleration in m/s2; each a numba.cfunc of
    sailviz.propagate.callbacks.USER_SIGNATURE or an @njit function (t, x, y, z, vx, vy, vz, m) -> three floats, SI,
    inertial. The law's direction may have any length and is made a unit vector; a zero vector is a stowed sail, without
    thrust. time_limit : s of wall time. Raises SceneError if the scene asks for something infeasible, PropagationError
    if the integration breaks down or does not get on, TimeLimitError if the time is over.
    """
    return join(list(simulate_blocks(scene, steering=steering, force=force, time_limit=time_limit)))


def simulate_blocks(
    scene: SceneSource,
    *,
    steering: object = None,
    force: object = None,
    block_rows: int = BLOCK_ROWS,
    progress: Callable[[float], None] | None = None,
    drawn: bool = True,
    time_limit: float | None = None,
) -> Iterator[Run]:
    """Like `simulate`, but yields Runs of at most block_rows rows as they are computed; memory stays flat.

    The rows do not depend on block_rows. progress is called with the fraction of the duration that is done. Before a
    PropagationError or a TimeLimitError is raised, the rows up to it are yielded; the time counts from here. Without
    drawn, planets and other bodies that a picture shows beside the craft are left out, which saves half of a short
    flight.
    """
    if time_limit is not None and not time_limit > 0.0:
        raise ValueError(f"the time limit must be a positive number of seconds, not {time_limit:g}")
    until = perf_counter() + (np.inf if time_limit is None else time_limit)
    planned = plan(load_scene(scene), steering, force)
    patience = Patience(planned.scene.limits.integration_steps, until)
    return _blocks(planned, block_rows, progress or (lambda fraction: None), drawn, patience, time_limit or np.inf)


FAILURES: dict[int, Callable[[Plan, Any, Patience], str]] = {
    stepping.UNDERFLOW: lambda p, state, patience: too_short(p, state),
    stepping.NOT_FINITE: lambda p, state, patience: "The acceleration is not a finite number",
    stepping.TOO_MANY: lambda p, state, patience: too_many(p, patience),
    stepping.NO_PROGRESS: lambda p, state, patience: too_slow(p, state, patience, INTEGRATORS[p.choice.integrator]),
}


def _blocks(
    p: Plan, block_rows: int, progress: Callable[[float], None], drawn: bool, patience: Patience, time_limit: float
) -> Iterator[Run]:
    output = OutputTimes(p.scene.propagation)
    ensembles = _ensembles(p, output) if drawn or any(item.ensemble for item in p.scene.expect) else ()
    spreads = _spreads(p)
    if spreads and output.rows > block_rows:  # a flight without rows tells where it ends: they can be streamed then
        state = begun(p)
        _fill(p, state, np.linspace(0.0, output.end, 51)[1:], [], 50, lambda share: progress(0.5 * share), patience)
        output, progress = _spread(p, state, output, progress, 0.5)
    state = begun(p)
    setting: Setting | None = None
    planets: dict[str, np.ndarray] = {}
    off_time = np.inf
    switches = list(p.schedule.switches)
    for first in range(0, output.rows, block_rows):
        times = output.between(first, min(block_rows, output.rows - first))
        due = [switch for switch in switches if switch[0] <= times[-1]]
        del switches[: len(due)]
        filled = _fill(p, state, times, due, output.rows, progress, patience)
        if spreads and output.rows <= block_rows and _ending(p, state, filled.status):
            output, progress = _spread(p, state, output, progress, stepping.time(state) / output.end)
            times, state = output.between(0, output.rows), begun(p)
            filled = _fill(p, state, times, due, output.rows, progress, patience)
        off_time = _first_end(off_time, state, filled.events)
        ended = _ending(p, state, filled.status)
        if ended:
            filled = _with_last_state(filled, state)
        if len(filled.times):
            if setting is None:
                planets = planets_in_view(p) if drawn else {}
                setting = replace(setting_of(p, planets, output.rows, ensembles, drawn), duration=output.end)
            block = _observed(p, setting, filled.times, filled.states, first, off_time)
            yield replace(
                block,
                bodies=bodies(p, planets, block.time) if drawn else {},
                approximations={name: way.positions(block.time) for name, way in p.approximations.items()},
                events=tuple(_with_known_mass(p, filled.events)),
                ended=ended,
            )
        _raise_failure(p, state, filled.status, patience, time_limit)
        if filled.status != stepping.DONE:
            break
    progress(1.0)


def _raise_failure(p: Plan, state: Any, status: int, patience: Patience, time_limit: float) -> None:
    """TimeLimitError where the time allowed is over, PropagationError where the flight cannot go on."""
    if status == stepping.TIME_IS_UP:
        reached, wanted = stepping.time(state) / DAY, p.scene.propagation.duration / DAY
        raise TimeLimitError(
            f"the time limit of {time_limit:g} s is over: the flight had reached {reached:.4g} of {wanted:.4g} d"
        )
    if status in FAILURES:
        raise PropagationError(FAILURES[status](p, state, patience), stepping.time(state), stepping.state(state))


def _first_end(off_time: float, state: Any, events: list[Event]) -> float:
    """Time, s, from which the device is off for good: what it was, or that of its last use in these events."""
    if stepping.in_use(state):
        return off_time
    return min([off_time] + [event.time for event in events if event.name == "brake off"])


def _spreads(p: Plan) -> bool:
    """Whether rows are spread over what is flown: they are a number, and something may end the run early. Ensembles,
    which are flown for as long as planned, keep to the rows that were planned."""
    ends = bool(np.any(p.watch.action == STOP)) or float(p.model.parameters["surface"]["radius"][0]) > 0.0
    scene = p.scene
    return ends and scene.propagation.output_interval is None and not (scene.ensemble or scene.chaos)


def _spread(
    p: Plan, state: Any, output: OutputTimes, progress: Callable[[float], None], done: float
) -> tuple[OutputTimes, Callable[[float], None]]:
    """Rows over what a first flight has flown, and the progress of the second, whose share is what is not done."""
    planned, end = output.end, stepping.time(state)
    ended = bool(_ending(p, state, int(state.counter[stepping.STATUS]))) and 0.0 < end < planned
    end = end if ended else planned
    return OutputTimes(p.scene.propagation, end), lambda share: progress(
        done + (1.0 - done) * min(share * planned / end, 1.0)
    )


@dataclass(frozen=True)
class Filled:
    """Rows that the propagator has filled."""

    times: np.ndarray  # (n,) s
    states: np.ndarray  # (7, n)
    events: list[Event]
    status: int  # of `propagate.stepping`


def _ending(p: Plan, state: Any, status: int) -> str:
    """Why a run stopped before its duration; "" if it did not."""
    if status == stepping.SURFACE:
        return "impact"
    return p.names[stepping.stopped_by(state)] if status == stepping.STOPPED else ""


def _with_known_mass(p: Plan, events: list[Event]) -> list[Event]:
    """Events whose state says no mass where the scene gives none: 1 kg flew, so that forces are accelerations."""
    if p.mass_known:
        return events
    return [replace(event, state=np.append(event.state[:6], np.nan)) for event in events]


def _with_last_state(filled: Filled, state: Any) -> Filled:
    """The rows with the state at the event that ended the run as the last one."""
    now = stepping.time(state)
    if len(filled.times) and filled.times[-1] >= now:
        return filled
    end = stepping.state(state)[:, None]
    return replace(filled, times=np.append(filled.times, now), states=np.hstack([filled.states, end]))


def _ensembles(p: Plan, output: OutputTimes) -> tuple[EnsembleStatistics, ...]:
    """The flights beside the scene's own; what they need is imported only where a scene has them."""
    if not p.scene.ensemble and not p.scene.chaos:
        return ()
    from sailviz.simulation.ensembles import ensembles_of

    return ensembles_of(p, output)


def _fill(
    p: Plan,
    state: Any,
    times: np.ndarray,
    switches: list[tuple[float, str]],
    output_rows: int,
    progress: Callable[[float], None],
    patience: Patience,
) -> Filled:
    """One block. Switching times are computed along with the rows."""
    run = p.scene.propagation
    moments = np.unique(np.concatenate([times, [time for time, _ in switches]])) if switches else times
    components = 7 if p.model.device in (THRUSTER, CALLED) or any(one.burns for one in p.beside) else 6
    out = np.empty((components, len(moments)))
    piece = max(1, min(len(moments), output_rows // 50))  # often enough to show progress and to hear Ctrl-C
    found: list[Event] = []
    status, filled = stepping.DONE, 0
    for first in range(0, len(moments), piece):
        part = moments[first : first + piece]
        chunk = np.empty((components, len(part)))
        while True:
            status = INTEGRATORS[p.choice.integrator].advance(
                state,
                p.model,
                p.schedule.breaks,
                p.schedule.factors,
                p.watch,
                part,
                chunk,
                run.duration,
                run.tolerance,
                run.largest_step or np.inf,
                patience,
            )
            found += [
                Event("impact" if index < 0 else p.names[index], time, y)
                for index, time, y in stepping.drain_events(state)
            ]
            if status == stepping.EVENTS_FULL and patience.time_is_up():
                status = stepping.TIME_IS_UP
            if status != stepping.EVENTS_FULL:
                break
        done = stepping.rows_done(state)
        out[:, first : first + done] = chunk[:, :done]
        filled = first + done
        progress(stepping.time(state) / run.duration)
        if status == stepping.DONE and patience.time_is_up() and first + piece < len(moments):
            status = stepping.TIME_IS_UP
        if status != stepping.DONE:
            break
    moments, out = moments[:filled], out[:, :filled]
    states = out if components == 7 else np.vstack([out, np.full((1, filled), p.mass)])
    for time, word in switches:
        at = np.searchsorted(moments, time)
        if at < filled:
            found.append(Event(word, time, states[:, at].copy()))
    found.sort(key=lambda event: event.time)
    wanted = np.isin(moments, times)
    return Filled(moments[wanted], states[:, wanted], found, status)


def _observed(p: Plan, setting: Setting, time: np.ndarray, states: np.ndarray, first: int, off_time: float) -> Run:
    """Everything that is derived from states row by row. off_time: s, when the device was switched off for good."""
    interval = np.searchsorted(p.schedule.breaks, time, side="right") - 1
    factor = np.where(time < off_time, p.schedule.factors[interval], 0.0)
    states = np.ascontiguousarray(states)
    normal, acceleration, throttle, columns = observe(p, time, states, factor)
    position, velocity = states[:3].T.copy(), states[3:6].T.copy()
    axes = frames.rtn(position, velocity)
    on = (factor * throttle != 0) & (p.model.device != dynamics.NO_DEVICE)
    devices: dict[str, Thrust] = {}
    if p.scene.place is not None:
        devices = observed_devices(p, time, states, factor, axes)
        acceleration = acceleration + sum_of(devices, p.scene.device.name)
        on = on | np.any([each.on for each in devices.values()], axis=0)
    by_light = axes_of_light(p, time, states, normal)
    pitch, cone, clock = frames.pitch_cone_clock(axes if by_light is None else by_light, normal, acceleration)
    turn = frames.quaternion(frames.body_axes(frames.stance(axes, normal), axes[..., 1]))
    stowed = ~np.any(normal, axis=1) if setting.craft.kind in SAILS else np.zeros(len(normal), bool)
    attitude = Attitude(np.where(stowed, np.nan, pitch), cone, np.where(stowed, np.nan, clock), normal, turn)
    thrust = thrust_of(acceleration, axes, on)
    environment = {}
    if len(p.schedule.breaks) > 1 or p.scene.device.active is not None:
        environment["thrust_factor"] = factor
    environment |= {name: values[interval] for name, values in p.schedule.histories.items()}
    if p.schedule.law is not None:
        environment["thrust_voltage_V"] = voltages(p.model)[interval]
    environment |= columns
    return Run(
        setting,
        first,
        time,
        position,
        velocity,
        states[6].copy() if p.mass_known else np.full(len(time), np.nan),
        attitude,
        thrust,
        orbital.elements(position, velocity, p.body.mu),
        environment,
        {},
        devices=devices,
    )
