"""Scene -> Run: the propagator fills block after block of a plan, and each row gets what the recording shows."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from time import perf_counter
from typing import Any

import numpy as np

from sailviz.errors import TimeLimitError
from sailviz.propagate import stepping
from sailviz.propagate.events import STOP
from sailviz.propagate.patience import Patience
from sailviz.run.arrays import AttitudeEnsemble, EnsembleStatistics, Run, Setting, join
from sailviz.scene.loading import Scene, SceneSource, load_scene
from sailviz.simulation.integration import begun
from sailviz.simulation.metadata import bodies, planets_in_view, setting_of
from sailviz.simulation.output_times import OutputTimes
from sailviz.simulation.phases import phased_blocks
from sailviz.simulation.plan import Plan, plan
from sailviz.simulation.rows import ending, fill, first_end, observed, raise_failure, with_known_mass, with_last_state

BLOCK_ROWS = 16_384  # a recording takes this many at once
ENSEMBLES = 0.9  # of the progress, of flights that are flown one by one beside the scene's own


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
    told = progress or (lambda fraction: None)
    if planned.scene.phase:
        own = {"steering": steering, "force": force}
        return phased_blocks(load_scene(scene), planned, own, block_rows, told, drawn, patience, time_limit or np.inf)
    return _blocks(planned, block_rows, told, drawn, patience, time_limit or np.inf)


def _blocks(
    p: Plan, block_rows: int, progress: Callable[[float], None], drawn: bool, patience: Patience, time_limit: float
) -> Iterator[Run]:
    begins = [phase.start for phase in p.phases]
    output = OutputTimes(p.scene.propagation, also=begins)
    asked = drawn or any(item.ensemble for item in p.scene.expect)
    ensembles = _ensembles(p, output) if asked and p.turning is None else ()
    turning = _turning(p, output, progress, patience, time_limit) if asked and p.turning is not None else ()
    if turning:
        progress = _second(progress)
    spreads = _spreads(p)
    if spreads and output.rows > block_rows:  # a flight without rows tells where it ends: they can be streamed then
        state = begun(p)
        fill(p, state, np.linspace(0.0, output.end, 51)[1:], [], 50, lambda share: progress(0.5 * share), patience)
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
        filled = fill(p, state, times, due, output.rows, progress, patience)
        if spreads and output.rows <= block_rows and ending(p, state, filled.status):
            output, progress = _spread(p, state, output, progress, stepping.time(state) / output.end)
            times, state = output.between(0, output.rows), begun(p)
            filled = fill(p, state, times, due, output.rows, progress, patience)
        off_time = first_end(off_time, state, filled.events)
        ended = ending(p, state, filled.status)
        if ended:
            filled = with_last_state(filled, state)
        if len(filled.times):
            if setting is None:
                planets = planets_in_view(p) if drawn else {}
                setting = setting_of(p, planets, output.rows, ensembles, drawn)
                setting = replace(setting, duration=output.end, attitude_ensembles=turning)
            block = observed(p, setting, filled.times, filled.states, first, off_time)
            yield replace(
                block,
                bodies=bodies(p, planets, block.time) if drawn else {},
                approximations={name: way.positions(block.time) for name, way in p.approximations.items()},
                events=tuple(with_known_mass(p, filled.events)),
                ended=ended,
            )
        raise_failure(p, state, filled.status, patience, time_limit)
        if filled.status != stepping.DONE:
            break
    progress(1.0)


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
    ended = bool(ending(p, state, int(state.counter[stepping.STATUS]))) and 0.0 < end < planned
    end = end if ended else planned
    return OutputTimes(p.scene.propagation, end, [phase.start for phase in p.phases]), lambda share: progress(
        done + (1.0 - done) * min(share * planned / end, 1.0)
    )


def _ensembles(p: Plan, output: OutputTimes) -> tuple[EnsembleStatistics, ...]:
    """The flights beside the scene's own; what they need is imported only where a scene has them."""
    if not p.scene.ensemble and not p.scene.chaos:
        return ()
    from sailviz.simulation.ensembles import ensembles_of

    return ensembles_of(p, output)


def _turning(
    p: Plan, output: OutputTimes, progress: Callable[[float], None], patience: Patience, time_limit: float
) -> tuple[AttitudeEnsemble, ...]:
    """The same of a craft that turns, each flight by itself; together they have the time of the run."""
    if not p.scene.ensemble:
        return ()
    from sailviz.simulation.turning_ensembles import turning_ensembles

    def fly(scene: Scene) -> Iterator[Run]:
        left = patience.until - perf_counter()
        if left <= 0.0:
            raise TimeLimitError(f"the time limit of {time_limit:g} s is over: the flights of an ensemble were flown")
        try:
            yield from simulate_blocks(scene, drawn=False, time_limit=left)
        except TimeLimitError:
            words = f"the time limit of {time_limit:g} s is over: the flights of an ensemble were flown"
            raise TimeLimitError(words) from None

    return turning_ensembles(p.scene, output, fly, lambda share: progress(ENSEMBLES * share), bool(p.keep))


def _second(progress: Callable[[float], None]) -> Callable[[float], None]:
    """Progress of what comes after ensembles."""
    return lambda share: progress(ENSEMBLES + (1.0 - ENSEMBLES) * share)
