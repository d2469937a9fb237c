"""A flight in phases: each is a plan of its own that takes over where the one before ended.

The whole is flown once without rows, which tells when each phase ends, to the last bit of the second flight; then once
more, with the rows of every phase, the first of which stands at its beginning.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from sailviz.propagate import stepping
from sailviz.propagate.patience import Patience
from sailviz.run.arrays import Event, Phase, Run, Setting
from sailviz.scene.phases import Phase as ScenePhase
from sailviz.scene.phases import end_of
from sailviz.simulation.accuracy import accuracy_of_phases
from sailviz.simulation.integration import begun
from sailviz.simulation.metadata import bodies, planets_in_view, setting_of
from sailviz.simulation.output_times import CLOSEST, OutputTimes
from sailviz.simulation.plan import Handover, Plan, plan
from sailviz.simulation.rows import (
    Filled,
    ending,
    fill,
    first_end,
    observed,
    raise_failure,
    with_known_mass,
)
from sailviz.simulation.turned_rows import has_tumbled

if TYPE_CHECKING:
    from sailviz.scene.loading import Scene

MOTION = "attitude/"  # before the names of its columns, among those of the environment
LOOKS = 50  # moments of a phase, flown without rows, at which progress is told and Ctrl-C heard


@dataclass(frozen=True)
class Flown:
    """A phase as it was flown."""

    name: str
    plan: Plan
    end: float  # s
    state: np.ndarray  # (7,) there
    in_use: bool  # the device, there
    farthest: float  # m from the centre, as far as was looked
    ended: str  # what ended the run there, "" where it went on or came to its end
    status: int  # of `propagate.stepping`, where the flight could not go on


def phased_blocks(
    scene: Scene,
    first: Plan,
    own: Mapping[str, object],
    block_rows: int,
    progress: Callable[[float], None],
    drawn: bool,
    patience: Patience,
    time_limit: float,
) -> Iterator[Run]:
    """Runs of at most block_rows rows, each of one phase. scene : the whole one; first : the plan of its first phase;
    own : steering and force of the user's own."""
    duration = scene.propagation.duration
    legs = list(_flown(scene, first, own, lambda time: progress(0.5 * time / duration), patience))
    end = legs[-1].end
    times = _times(scene, legs)
    setting, planets = _setting(scene, legs, sum(map(len, times)), drawn)
    columns = _columns(legs, setting)
    row, off_time, pending = 0, np.inf, list[Event]()
    for leg, moments in zip(legs, times, strict=True):
        state = begun(leg.plan)
        switches = [one for one in leg.plan.schedule.switches if leg.plan.begin < one[0] < leg.end]
        for begin in range(0, max(len(moments), 1), block_rows):
            part = moments[begin : begin + block_rows]
            over = begin + block_rows >= len(moments)
            # to its end, or to where it could not go on and says so
            until = leg.plan.limit if leg.status else leg.end
            wanted = np.append(part, until) if over and not (len(part) and part[-1] >= until) else part
            due = [one for one in switches if one[0] <= wanted[-1]]
            del switches[: len(due)]
            filled = fill(leg.plan, state, wanted, due, len(moments), _share(progress, end, duration), patience)
            off_time = first_end(off_time, state, filled.events)
            events = [*pending, *filled.events]
            pending = []
            whole = filled.status in (stepping.DONE, stepping.STOPPED, stepping.SURFACE)
            if over and whole and leg is not legs[-1]:
                pending = _at_end(scene, leg, legs, filled.events)
            filled = replace(filled, times=filled.times[: len(part)], states=filled.states[:, : len(part)])
            if len(filled.times):
                yield _block(leg, setting, planets, filled, events, row, off_time, columns, drawn, over)
                row += len(filled.times)
            else:
                pending = [*events, *pending]
            raise_failure(leg.plan, state, filled.status, patience, time_limit)
    progress(1.0)


def _share(progress: Callable[[float], None], end: float, duration: float) -> Callable[[float], None]:
    """The progress of the second flight, told in shares of the whole duration."""
    return lambda share: progress(0.5 + 0.5 * min(share * duration / end, 1.0))


def _flown(
    scene: Scene, first: Plan, own: Mapping[str, object], progress: Callable[[float], None], patience: Patience
) -> Iterator[Flown]:
    """The phases that the flight comes to, one after the other, without rows."""
    p = first
    for number, phase in enumerate(scene.phase):
        state = begun(p)
        looks = np.linspace(p.begin, p.limit, LOOKS + 1)[1:]
        filled = fill(p, state, looks, [], LOOKS, lambda share: progress(share * scene.propagation.duration), patience)
        end, now = stepping.time(state), stepping.state(state)
        ended = ending(p, state, filled.status)
        goes_on = ended == end_of(phase.name) or (
            filled.status == stepping.DONE and end < scene.propagation.duration and number + 1 < len(scene.phase)
        )
        seen = np.linalg.norm(np.column_stack([p.position, filled.states[:3], now[:3]]), axis=0)
        in_use = stepping.in_use(state)
        failed = filled.status not in (stepping.DONE, stepping.STOPPED, stepping.SURFACE)
        yield Flown(
            phase.name, p, end, now[:7], in_use, float(seen.max()), "" if goes_on else ended, filled.status * failed
        )
        if not goes_on:
            return
        turns = None
        if p.turning is not None:
            turns = replace(p.turning, motion=now[7:], tumbled=has_tumbled(state))
        p = plan(scene, **own, taken=Handover(number + 1, end, now[:3], now[3:6], float(now[6]), in_use, turns))


def _times(scene: Scene, legs: list[Flown]) -> list[np.ndarray]:
    """The times of each phase's rows, s: those of [propagation], or its own, and always its beginning; of the last,
    the end of the run too."""
    run, found = scene.propagation, []
    output = OutputTimes(run, legs[-1].end if run.output_interval is None else None)
    even = output.between(0, output.rows)
    for i, leg in enumerate(legs):
        begin, end, own = leg.plan.begin, leg.end, scene.phase[i].propagation
        if own.outputs is not None:
            inside = np.linspace(begin, end, own.outputs)
        elif own.output_interval is not None:
            inside = np.arange(begin, end, own.output_interval)
        else:
            inside = even
        last = i == len(legs) - 1
        inside = inside[(inside > begin + CLOSEST) & (inside < end - CLOSEST)]
        found.append(np.concatenate([[begin], inside, [end] if last and end > begin + CLOSEST else []]))
    return found


def _setting(scene: Scene, legs: list[Flown], rows: int, drawn: bool) -> tuple[Setting, dict[str, np.ndarray]]:
    """What a picture of the whole flight needs, and the planets in its view."""
    whole = replace(legs[0].plan, scene=scene)
    planets = planets_in_view(whole, max(leg.farthest for leg in legs)) if drawn else {}
    never = [Phase(phase.name, np.nan, np.nan) for phase in scene.phase[len(legs) :]]
    reached = [Phase(leg.name, leg.plan.begin, leg.end, _words(leg.plan, scene.phase[i])) for i, leg in enumerate(legs)]
    setting = setting_of(whole, planets, rows, (), False)
    limited = [replace(leg.plan, limit=leg.end) for leg in legs]
    return (
        replace(
            setting,
            duration=legs[-1].end,
            accuracy=accuracy_of_phases([(leg.name, p) for leg, p in zip(legs, limited, strict=True)], drawn),
            phases=(*reached, *never),
        ),
        planets,
    )


def _words(p: Plan, phase: ScenePhase) -> str:
    """What holds in a phase."""
    level = phase.state_of(p.scene.device).level
    steering = p.scene.steering
    kind = steering.kind if steering is not None else ""
    goal = getattr(steering, "goal", "")
    said = f"{kind}, {goal}" if goal else kind
    if p.scene.place is not None:
        levels = [(device.name, phase.state_of(device).level) for device in p.scene.devices]
        told = [f"{name} {'off' if share == 0.0 else f'at {100 * share:.3g} %'}" for name, share in levels if share < 1]
        return ", ".join(filter(None, [said if level else "", *told]))
    thrust = "off" if level == 0.0 else "" if level == 1.0 else f"{100 * level:.3g} % of the thrust"
    return ", ".join(filter(None, [said if level else "", thrust]))


def _at_end(scene: Scene, leg: Flown, legs: list[Flown], noted: list[Event]) -> list[Event]:
    """Events where a phase ends: that it does, where no integrator has noted it, and what that does to the thrust."""
    found = []
    if not any(event.name == end_of(leg.name) for event in noted):
        found.append(Event(end_of(leg.name), leg.end, leg.state.copy()))
    number = legs.index(leg)
    for device in scene.devices:
        before, after = (scene.phase[i].state_of(device).level > 0.0 for i in (number, number + 1))
        if before != after and leg.in_use:
            what = "thrust" if scene.place is None else device.name
            found.append(Event(f"{what} on" if after else f"{what} off", leg.end, leg.state.copy()))
    return found


def _columns(legs: list[Flown], setting: Setting) -> dict[str, np.ndarray]:
    """Name -> values of a row without data, for every column of the environment that any phase has, and of its motion:
    wheels that are not there hold nothing."""
    found: dict[str, np.ndarray] = {}
    for leg in legs:
        turns = () if leg.plan.turning is None else tuple(leg.plan.turning.motion)
        state = np.array([*leg.plan.position, *leg.plan.velocity, leg.plan.seventh, *turns])[:, None]
        one = observed(leg.plan, setting, np.array([leg.plan.begin]), state, 0, np.inf)
        for name, values in one.environment.items():
            empty: Any = np.nan if values.dtype.kind == "f" else values.dtype.type(0)
            found.setdefault(name, np.full_like(values, empty))
        for name, values in one.attitude.motion.items():
            found.setdefault(f"{MOTION}{name}", np.zeros_like(values))
    return found


def _block(
    leg: Flown,
    setting: Setting,
    planets: dict[str, np.ndarray],
    filled: Filled,
    events: list[Event],
    row: int,
    off_time: float,
    columns: dict[str, np.ndarray],
    drawn: bool,
    over: bool,
) -> Run:
    block = observed(leg.plan, setting, filled.times, filled.states, row, off_time)
    known = block.environment
    known = known | {f"{MOTION}{name}": values for name, values in block.attitude.motion.items()}
    filled_up = {name: known.get(name, np.repeat(empty, len(block), axis=0)) for name, empty in columns.items()}
    acted = {name: values for name, values in filled_up.items() if not name.startswith(MOTION)}
    motion = {name.removeprefix(MOTION): values for name, values in filled_up.items() if name.startswith(MOTION)}
    return replace(
        block,
        environment=acted,
        attitude=replace(block.attitude, motion=motion),
        bodies=bodies(leg.plan, planets, block.time) if drawn else {},
        events=tuple(with_known_mass(leg.plan, events)),
        ended=leg.ended if over else "",
    )
