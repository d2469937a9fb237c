"""The words beside the picture: what it is, what to look for, where it comes from. Short, or the panel clips them."""

from __future__ import annotations

from sailviz.recording.drawing.ensembles import legend, scoreboard
from sailviz.run.arrays import Event, Setting


def about(setting: Setting, notes=()) -> str:
    """Markdown. No heading: height is scarce; parameters run on in a line: a narrow panel would cut a table off.

    notes : what colours mean, one line each
    """
    lines = [f"**{setting.title}**", "", setting.about.strip(), ""]
    lines += [f"- {hint.strip()}" for hint in (*setting.look_for, *notes, *legend(setting))]
    lines += scoreboard(setting)
    facts = [f"{name} **{value}**" for name, value in setting.parameters]
    if setting.thesis:
        facts.append(f"thesis, section **{setting.thesis}**")
    return "\n".join([*lines, "", " · ".join(facts)])


def event_line(event: Event) -> str:
    """An event with its time, in days or, early on, in a smaller unit."""
    time = abs(event.time)
    value, unit = (
        (event.time / 86400, "d") if time >= 86400 else (event.time / 3600, "h") if time >= 3600 else (event.time, "s")
    )
    return f"{value:.4g} {unit}: {event.name}" if " at t = " not in event.name else event.name
