"""Blocks of rows: the propagator fills them, and each row gets what the recording shows."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from sailviz import elements as orbital
from sailviz import frames
from sailviz.constants import DAY
from sailviz.errors import PropagationError, TimeLimitError
from sailviz.propagate import dynamics, stepping
from sailviz.propagate.patience import Patience
from sailviz.propulsion.devices import CALLED, THRUSTER
from sailviz.run.arrays import Attitude, Event, Run, Setting, Thrust
from sailviz.run.devices import SAILS
from sailviz.scene.attitude import PrescribedAttitude
from sailviz.scene.film import ages
from sailviz.simulation.beside import observed_devices, sum_of, thrust_of
from sailviz.simulation.environment_columns import axes_of_light, observe, rolled, torques_of_light, voltages
from sailviz.simulation.film import film_columns
from sailviz.simulation.integration import INTEGRATORS
from sailviz.simulation.lowered import Columns
from sailviz.simulation.no_progress import too_many, too_short, too_slow
from sailviz.simulation.plan import Plan
from sailviz.simulation.turned_rows import Load, torque_needed, tumbled_once, turned_rows
from sailviz.simulation.wheel import spins, wheel_columns

FAILURES: dict[int, Callable[[Plan, Any, Patience], str]] = {
    stepping.UNDERFLOW: lambda p, state, patience: too_short(p, state),
    stepping.NOT_FINITE: lambda p, state, patience: "The acceleration is not a finite number",
    stepping.TOO_MANY: lambda p, state, patience: too_many(p, patience),
    stepping.NO_PROGRESS: lambda p, state, patience: too_slow(p, state, patience, INTEGRATORS[p.choice.integrator]),
}


def raise_failure(p: Plan, state: Any, status: int, patience: Patience, time_limit: float) -> None:
    """TimeLimitError where the time allowed is over, PropagationError where the flight cannot go on."""
    if status == stepping.TIME_IS_UP:
        reached, wanted = stepping.time(state) / DAY, p.scene.propagation.duration / DAY
        raise TimeLimitError(
            f"the time limit of {time_limit:g} s is over: the flight had reached {reached:.4g} of {wanted:.4g} d"
        )
    if status in FAILURES:
        raise PropagationError(FAILURES[status](p, state, patience), stepping.time(state), stepping.state(state))


@dataclass(frozen=True)
class Filled:
    """Rows that the propagator has filled."""

    times: np.ndarray  # (n,) s
    states: np.ndarray  # (7, n); of a craft that turns the whole of its state
    events: list[Event]
    status: int  # of `propagate.stepping`


def ending(p: Plan, state: Any, status: int) -> str:
    """Why a run stopped before its duration; "" if it did not."""
    if status == stepping.SURFACE:
        return "impact"
    return p.names[stepping.stopped_by(state)] if status == stepping.STOPPED else ""


def first_end(off_time: float, state: Any, events: list[Event]) -> float:
    """Time, s, from which the device is off for good: what it was, or that of its last use in these events."""
    if stepping.in_use(state):
        return off_time
    return min([off_time] + [event.time for event in events if event.name == "brake off"])


def with_known_mass(p: Plan, events: list[Event]) -> list[Event]:
    """Events whose state says no mass where the scene gives none: 1 kg flew, so that forces are accelerations; and the
    mass where the flight carries a dose or a drift in its place."""
    if p.mass_known and not (ages(p.scene) or spins(p.scene)):
        return events
    mass = p.scene.device.mass or np.nan
    return [replace(event, state=np.append(event.state[:6], mass)) for event in events]


def with_last_state(filled: Filled, state: Any) -> Filled:
    """The rows with the state at the event that ended the run as the last one."""
    now = stepping.time(state)
    if len(filled.times) and filled.times[-1] >= now:
        return filled
    end = stepping.state(state)[:, None]
    return replace(filled, times=np.append(filled.times, now), states=np.hstack([filled.states, end]))


def fill_piece(p: Plan, state: Any, times: np.ndarray, out: np.ndarray, patience: Patience, found: list[Event]) -> int:
    """Integrate over times (m,), states into out (6 or 7, m), events into `found` -> how it ended."""
    run = p.scene.propagation
    while True:
        status: int = INTEGRATORS[p.choice.integrator].advance(
            state,
            p.model,
            p.schedule.breaks,
            p.schedule.factors,
            p.watch,
            times,
            out,
            p.limit,
            run.tolerance,
            run.largest_step or np.inf,
            patience,
        )
        drained = [
            Event("impact" if index < 0 else p.names[index], time, y) for index, time, y in stepping.drain_events(state)
        ]
        found += drained if p.turning is None else tumbled_once(state, drained)
        if status != stepping.EVENTS_FULL:
            return status
        if patience.time_is_up():
            return stepping.TIME_IS_UP


def fill(
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
    components = components if p.turning is None else 7 + len(p.turning.motion)
    out = np.empty((components, len(moments)))
    piece = max(1, min(len(moments), output_rows // 50))  # often enough to show progress and to hear Ctrl-C
    found: list[Event] = []
    status, filled = stepping.DONE, 0
    for first in range(0, len(moments), piece):
        part = moments[first : first + piece]
        chunk = np.empty((components, len(part)))
        status = fill_piece(p, state, part, chunk, patience, found)
        done = stepping.rows_done(state)
        out[:, first : first + done] = chunk[:, :done]
        filled = first + done
        progress(stepping.time(state) / run.duration)
        if status == stepping.DONE and patience.time_is_up() and first + piece < len(moments):
            status = stepping.TIME_IS_UP
        if status != stepping.DONE:
            break
    moments, out = moments[:filled], out[:, :filled]
    states = out if components >= 7 else np.vstack([out, np.full((1, filled), p.seventh)])
    for time, word in switches:
        at = np.searchsorted(moments, time)
        if at < filled:
            found.append(Event(word, time, states[:7, at].copy()))
    found.sort(key=lambda event: event.time)
    wanted = np.isin(moments, times)
    return Filled(moments[wanted], states[:, wanted], found, status)


def observed(p: Plan, setting: Setting, time: np.ndarray, states: np.ndarray, first: int, off_time: float) -> Run:
    """Everything that is derived from states row by row. off_time: s, when the device was switched off for good."""
    interval = np.searchsorted(p.schedule.breaks, time, side="right") - 1
    factor = np.where(time < off_time, p.schedule.factors[interval], 0.0)
    states = np.ascontiguousarray(states)
    turned = None if p.turning is None else turned_rows(p, p.turning, time, states, factor)
    normal, acceleration, throttle, columns = observe(p, time, states[:7], factor, turned)
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
    body = rolled(p, frames.body_axes(frames.stance(axes, normal), axes[..., 1])) if turned is None else turned.axes
    turn = frames.quaternion(body)
    stowed = ~np.any(normal, axis=1) if setting.craft.kind in SAILS else np.zeros(len(normal), bool)
    attitude = Attitude(np.where(stowed, np.nan, pitch), cone, np.where(stowed, np.nan, clock), normal, turn)
    if turned is not None:
        attitude = replace(attitude, motion=turned.motion)
    thrust = thrust_of(acceleration, axes, on)
    environment = {}
    if len(p.schedule.breaks) > 1 or p.scene.device.active is not None or p.scene.phase:
        environment["thrust_factor"] = factor
    environment |= {name: values[interval] for name, values in p.schedule.histories.items()}
    if p.schedule.law is not None:
        environment["thrust_voltage_V"] = voltages(p.model)[interval]
    environment |= wheel_columns(p.scene, p.model, time, states[:7], factor)
    environment |= columns | (
        torques_of_light(p, time, states, factor * throttle, body) if turned is None else turned.columns
    )
    if isinstance(p.scene.attitude, PrescribedAttitude):
        environment |= _needed(p, time, states, acceleration, environment)
    return Run(
        setting,
        first,
        time,
        position,
        velocity,
        p.masses(states).copy() if p.mass_known else np.full(len(time), np.nan),
        attitude,
        thrust,
        orbital.elements(position, velocity, p.body.mu),
        environment,
        {},
        devices=devices,
        film=film_columns(p.scene, p.model, time, states, factor),
    )


def _needed(p: Plan, time: np.ndarray, states: np.ndarray, push: np.ndarray, environment: Columns) -> Columns:
    """What holding the prescribed attitude takes, in each row."""

    def axes_at(times: np.ndarray, there: np.ndarray) -> np.ndarray:
        one = np.ones(len(times))
        normal = dynamics.observe(np.ascontiguousarray(times), np.ascontiguousarray(there), one, p.model)[0]
        axes = frames.rtn(there[:3].T, there[3:6].T)
        return rolled(p, frames.body_axes(frames.stance(axes, normal), axes[..., 1]))

    loads = []
    if "light_torque_x_N_m" in environment:
        torque = np.stack([environment[f"light_torque_{axis}_N_m"] for axis in "xyz"], -1)
        loads.append(Load(p.masses(states)[:, None] * push, torque))
    if "air_torque_x_N_m" in environment:
        from sailviz.propagate import shape_air_callback as shape_air

        there = np.ascontiguousarray(states[:7])
        normal = dynamics.observe(time, there, np.ones(len(time)), p.model)[0]
        blown = shape_air.observe_air(time, there, normal, p.model.parameters)
        loads.append(Load(*(blown[first : first + 3].T for first in (shape_air.FORCE, shape_air.TORQUE))))
    return torque_needed(p, time, states, axes_at, push, loads)
