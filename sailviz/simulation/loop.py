"""Scene -> Run: the propagator fills block after block of a plan, and each row gets what the recording shows."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace

import numpy as np

from sailviz import elements as orbital
from sailviz import frames
from sailviz.errors import PropagationError
from sailviz.propagate import dop853, dynamics, gauss_jackson
from sailviz.propagate import stepping as integration
from sailviz.propagate.choice import DOP853, GAUSS_JACKSON
from sailviz.run.arrays import Attitude, Event, Run, Thrust, join
from sailviz.scene.loading import Scene
from sailviz.simulation.environment_columns import observe, voltages
from sailviz.simulation.metadata import bodies, planets_in_view, setting_of
from sailviz.simulation.plan import Plan, plan

BLOCK_ROWS = 16_384  # a recording takes this many at once
DEFAULT_OUTPUTS = 1000
INTEGRATORS = {DOP853: dop853, GAUSS_JACKSON: gauss_jackson}


def simulate(scene: Scene, *, steering=None, force=None) -> Run:
    """Propagate a scene and return the whole Run.

    steering : own attitude law, force : own additional acceleration in m/s2; each a numba.cfunc of
    sailviz.propagate.plugs.USER_SIGNATURE or an @njit function (t, x, y, z, vx, vy, vz, m) -> three floats, SI,
    inertial. Raises SceneError if the scene asks for something infeasible, PropagationError if the integration
    breaks down.
    """
    return join(list(simulate_blocks(scene, steering=steering, force=force)))


def simulate_blocks(
    scene: Scene,
    *,
    steering=None,
    force=None,
    block_rows: int = BLOCK_ROWS,
    progress: Callable[[float], None] | None = None,
    drawn: bool = True,
) -> Iterator[Run]:
    """Like `simulate`, but yields Runs of at most block_rows rows as they are computed; memory stays flat.

    The rows do not depend on block_rows. progress is called with the fraction of the duration that is done. Before a
    PropagationError is raised, the rows up to it are yielded. Without drawn, planets and other bodies that a picture
    shows beside the craft are left out, which saves half of a short flight.
    """
    return _blocks(plan(scene, steering, force), block_rows, progress or (lambda fraction: None), drawn)


def _grid(run) -> tuple[int, float]:
    """(rows, spacing s) of even output; the last row is the end of the run, or one spacing before it."""
    if run.output_interval is not None:
        return int(np.floor(run.duration / run.output_interval * (1 + 1e-12))) + 1, run.output_interval
    rows = run.outputs or DEFAULT_OUTPUTS
    return rows, run.duration / (rows - 1)


class OutputTimes:
    """Times of all rows of a run, s: even, or closer in some windows. Even ones are computed as they are asked for."""

    def __init__(self, run):
        self.rows, self.spacing = _grid(run)
        self.run, self.uneven = run, None
        if run.dense:
            even = self.between(0, self.rows)
            windows = [np.arange(w.start, w.end + 0.5 * w.output_interval, w.output_interval) for w in run.dense]
            self.uneven = np.unique(np.minimum(np.concatenate([even, *windows]), run.duration))
            self.rows = len(self.uneven)

    def between(self, first, count):
        """The times of count rows from a first one on."""
        if self.uneven is not None:
            return self.uneven[first : first + count]
        times = np.minimum(self.spacing * np.arange(first, first + count), self.run.duration)
        if first + count == self.rows and self.run.output_interval is None:
            times[-1] = self.run.duration
        return times


def _blocks(p: Plan, block_rows, progress, drawn):
    run = p.scene.propagation
    output = OutputTimes(run)
    rows = output.rows
    ensembles = _ensembles(p, output) if drawn or any(item.ensemble for item in p.scene.expect) else ()
    integrator = INTEGRATORS[p.choice.integrator]
    state = integrator.start(0.0, p.position, p.velocity, p.mass, events=len(p.names))
    setting = None
    off_time = np.inf
    switches = list(p.schedule.switches)
    for first in range(0, rows, block_rows):
        count = min(block_rows, rows - first)
        times = output.between(first, count)
        due = [switch for switch in switches if switch[0] <= times[-1]]
        del switches[: len(due)]
        columns, found, status = _fill(p, state, times, due, rows, progress)
        if not integration.in_use(state):
            off_time = min([off_time] + [event.time for event in found if event.name == "brake off"])
        last = status != integration.DONE or first + count == rows
        ended = "impact" if status == integration.SURFACE else ""
        if status == integration.STOPPED:
            ended = p.names[integration.stopped_by(state)]
        if ended:  # the state at the event is the last row
            now = integration.time(state)
            if not len(columns[0]) or columns[0][-1] < now:
                end = integration.state(state)[:, None]
                columns = (np.append(columns[0], now), np.hstack([columns[1], end]))
        if len(columns[0]):
            if setting is None:
                planets = planets_in_view(p) if drawn else {}
                setting = setting_of(p, planets, rows, ensembles)
            block = _observed(p, *columns, first, off_time)
            yield replace(
                block,
                setting=setting,
                bodies=bodies(p, planets, block.time) if drawn else {},
                approximations={name: way.positions(block.time) for name, way in p.approximations.items()},
                events=tuple(found),
                ended=ended,
            )
        if status in (integration.UNDERFLOW, integration.NOT_FINITE):
            reason = "The step size fell below the resolution of time"
            if status == integration.NOT_FINITE:
                reason = "The acceleration is not a finite number"
            raise PropagationError(reason, integration.time(state), integration.state(state))
        if last:
            progress(1.0)
            return


def _ensembles(p: Plan, output):
    """The flights beside the scene's own; what they need is imported only where a scene has them."""
    if not p.scene.ensemble and not p.scene.chaos:
        return ()
    from sailviz.simulation.ensembles import ensembles_of

    return ensembles_of(p, output)


def _fill(p: Plan, state, times, switches, output_rows, progress):
    """((times (n,), states (7, n)), events, status) of one block. Switching times are computed along with the rows."""
    run = p.scene.propagation
    moments = np.unique(np.concatenate([times, [time for time, _ in switches]])) if switches else times
    components = 7 if p.model.device == dynamics.THRUSTER else 6
    out = np.empty((components, len(moments)))
    piece = max(1, min(len(moments), output_rows // 50))  # often enough to show progress and to hear Ctrl-C
    found, status, filled = [], integration.DONE, 0
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
            )
            found += [
                Event("impact" if index < 0 else p.names[index], time, y)
                for index, time, y in integration.drain_events(state)
            ]
            if status != integration.EVENTS_FULL:
                break
        done = integration.rows_done(state)
        out[:, first : first + done] = chunk[:, :done]
        filled = first + done
        progress(integration.time(state) / run.duration)
        if status != integration.DONE:
            break
    moments, out = moments[:filled], out[:, :filled]
    states = out if components == 7 else np.vstack([out, np.full((1, filled), p.mass)])
    for time, word in switches:
        at = np.searchsorted(moments, time)
        if at < filled:
            found.append(Event(word, time, states[:, at].copy()))
    found.sort(key=lambda event: event.time)
    wanted = np.isin(moments, times)
    return (moments[wanted], states[:, wanted]), found, status


def _observed(p: Plan, time, states, first, off_time) -> Run:
    """Everything that is derived from states row by row. off_time: s, when the device was switched off for good."""
    interval = np.searchsorted(p.schedule.breaks, time, side="right") - 1
    factor = np.where(time < off_time, p.schedule.factors[interval], 0.0)
    states = np.ascontiguousarray(states)
    normal, acceleration, throttle, columns = observe(p, time, states, factor)
    position, velocity = states[:3].T.copy(), states[3:6].T.copy()
    axes = frames.rtn(position, velocity)
    pitch, cone, clock = frames.pitch_cone_clock(axes, normal, acceleration)
    attitude = Attitude(pitch, cone, clock, normal, frames.quaternion(frames.body_axes(normal, axes[..., 1])))
    on = (factor * throttle != 0) & (p.model.device != dynamics.NO_DEVICE)
    thrust = Thrust(acceleration, frames.to_frame(axes, acceleration), np.linalg.norm(acceleration, axis=1), on)
    environment = {}
    if len(p.schedule.breaks) > 1 or p.scene.device.active is not None:
        environment["thrust_factor"] = factor
    environment |= {name: values[interval] for name, values in p.schedule.histories.items()}
    if p.schedule.law is not None:
        environment["thrust_voltage_V"] = voltages(p.model)[interval]
    environment |= columns
    return Run(
        None,
        first,
        time,
        position,
        velocity,
        states[6].copy(),
        attitude,
        thrust,
        orbital.elements(position, velocity, p.body.mu),
        environment,
        {},
    )
