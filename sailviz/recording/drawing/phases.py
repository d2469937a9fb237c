"""Phases of a flight: a colour for each stretch of the trail and each piece of the lane, and their names, in space
where one begins, on the line of the moment, and in the description.
"""

from __future__ import annotations

import numpy as np

from sailviz.recording.drawing import style
from sailviz.recording.drawing.log import Color
from sailviz.recording.drawing.phrases import on_day
from sailviz.run.arrays import Event, Phase, Setting

MOST_NAMED = 4  # switches that have a name in space


def reached(setting: Setting) -> list[Phase]:
    """The phases that a flight came to; none where it has but one way to fly."""
    return [phase for phase in setting.phases if phase.reached]


def words_and_colors(setting: Setting) -> list[tuple[str, Color]]:
    """The word of a colour and the colour of each phase that was reached; phases of one name have one."""
    known = list(style.PHASES.items())
    names = [phase.name for phase in reached(setting)]
    order = {name: i for i, name in enumerate(dict.fromkeys(names))}
    return [known[order[name] % len(known)] for name in names]


def rows_at_switches(setting: Setting, time: np.ndarray) -> np.ndarray:
    """Rows, of times (n,) s, with which phases begin: of two at one time, where the velocity jumps, the later one."""
    starts = np.array([phase.start for phase in reached(setting)])
    found: np.ndarray = np.flatnonzero(np.isin(time, starts) & (np.diff(time, append=np.inf) > 0))
    return found


def names_in_rows(setting: Setting, time: np.ndarray) -> list[str]:
    """The phase of each row (n,)."""
    names = [phase.name for phase in reached(setting)]
    return [names[k] for k in setting.phase_of(time).tolist()]


def switches(setting: Setting, events: tuple[Event, ...]) -> list[tuple[str, Event]]:
    """(name of what begins, the event there) of the first switches."""
    found = []
    for before, after in zip(reached(setting), reached(setting)[1:], strict=False):
        event = next((e for e in events if e.time == after.start and e.name == f"end of {before.name}"), None)
        if event is not None:
            found.append((after.name, event))
    return found[:MOST_NAMED]


def at_a_switch(setting: Setting, event: Event) -> bool:
    """Whether an event is part of the change from a phase to the next, which has a name of its own."""
    told = setting.resolved.get("device")
    devices = ["thrust", *(device.get("name") for device in (told if isinstance(told, list) else []))]
    parts = {f"end of {phase.name}" for phase in setting.phases}
    parts |= {f"{name} {word}" for name in devices for word in ("on", "off")}
    return event.name in parts and any(event.time == phase.start for phase in reached(setting)[1:])


def phase_notes(setting: Setting, low: bool) -> list[str]:
    """What the description says: each phase with its colour and when it began; and those that never came. low : a low
    orbit, whose trail is coloured by its altitude: there the lane alone has the phases' colours."""
    if not setting.phases:
        return []
    known, first = reached(setting), setting.phases[0].start
    said: list[str] = []
    told: set[str] = set()
    for phase, (color, _) in zip(known, words_and_colors(setting), strict=True):
        if phase.name in told:
            continue
        told.add(phase.name)
        when = "" if phase is known[0] else f" from {on_day(phase.start - first, setting.duration)}"
        held = f" ({phase.words})" if phase.words else ""
        said.append(f"**{color}** {phase.name}{when}{held}")
    return [("phases in their lane: " if low else "phases: ") + ", ".join(said), *never_words(setting)]


def never_words(setting: Setting) -> list[str]:
    """Phases that the flight never came to, in a sentence."""
    never = [phase.name for phase in setting.phases if not phase.reached]
    if not never:
        return []
    last = reached(setting)[-1].name
    return [f"**{' and '.join(never)}** never began: {last} lasted until the end"]
