"""The words beside the picture: what it is, what to look for, what is drawn. Short, or the panel clips them."""

from __future__ import annotations

import textwrap
from collections.abc import Iterable

import numpy as np

from sailviz.constants import YEAR
from sailviz.recording.drawing import style
from sailviz.recording.drawing.arrival_plane import MILLI_AU
from sailviz.recording.drawing.attitude_ensembles import table_of
from sailviz.recording.drawing.phrases import LONG, clock
from sailviz.run import gaps
from sailviz.run.arrays import Event, Setting

LINE = 158  # characters of a line of the panel in a window of 1600 x 900
WALL = "the **wall on the trail** is the push: its height and brightness say how hard, its lean says which way"


def about(setting: Setting, notes: Iterable[str] = (), steady: Iterable[str] = (), aside: str = "") -> str:
    """Markdown without a heading: the title stands over the line of the moment.

    notes : what is drawn, one line each; steady : what is constant all along; aside : what is made up
    """
    constants = list(steady)
    ends = ["Steady all along: " + " · ".join(f"**{words}**" for words in constants)] if len(constants) > 1 else []
    first = " ".join(part for part in (setting.about.strip(), f"*{aside}*" if aside else "") if part)
    table = scoreboard(setting) if setting.ensembles else []
    table += table_of(setting) if setting.attitude_ensembles else []
    several = len(setting.ensembles) > 1 or len(setting.attitude_ensembles) > 1
    told = () if several else (*setting.look_for, *notes)  # the table takes their room
    hints = [f"- {hint.strip()}" for hint in told]
    parts = [[first] if first else [], table, hints, *([words] for words in ends)]
    return "\n\n".join("\n".join(part) for part in parts if part)


def lines_of(text: str) -> float:
    """How many lines the words take in the panel of a window of 1600 x 900; a gap between paragraphs is 0.6 of one."""
    plain = text.replace("*", "").strip().split("\n")
    return sum(max(1, len(textwrap.wrap(part, LINE))) if part.strip() else 0.6 for part in plain)


def gap_words(setting: Setting) -> list[str]:
    """What is missing, if anything is."""
    if not setting.gaps:
        return []
    size, word = clock(setting.duration)
    times = f"{len(setting.gaps)} times" if len(setting.gaps) > 1 else "once"
    missing = f"{gaps.total(setting.gaps) / size:.3g} {word.lower()}s"
    return [f"**no data** {times}, {missing} in all: curves break off there, a trail is dashed, what is seen is older"]


def event_line(event: Event) -> str:
    """An event with its time, in days or, early on, in a smaller unit."""
    if " at t = " in event.name:
        return event.name
    time = abs(event.time)
    if time > LONG:
        return f"year {event.time / YEAR:.4g}: {event.name}"
    if time < 3600:
        return f"{event.time:.4g} s: {event.name}"
    size, word = (86400.0, "day") if time >= 86400 else (3600.0, "hour")
    return f"{word} {event.time / size:.4g}: {event.name}"


def scoreboard(setting: Setting) -> list[str]:
    """A table: how far each ensemble ends from the flight in a calm wind, mean ± standard deviation."""
    ensembles = sorted(setting.ensembles, key=lambda ensemble: -ensemble.end_deviation[0])
    words = style.ensemble_words(setting.ensembles)
    far, whose = (1 / MILLI_AU, "0.001 au") if setting.body.name == "Sun" else (1e-3, "km")
    lines = [
        f"| colour | flights | end farther out by, {whose} | run ahead by | ensemble |",
        "|---|---|---|---|---|",
    ]
    for ensemble in ensembles:
        off = ensemble.end_mean - ensemble.nominal[-1]
        out = spread(off[0] * far, ensemble.end_deviation[0] * far)
        ahead = spread(np.degrees(off[1]), np.degrees(ensemble.end_deviation[1])).replace(" ±", "° ±") + "°"
        how = "an expansion" if ensemble.method == "polynomial-chaos" else f"{ensemble.flights:,}"
        lines.append(f"| **{words[ensemble.name]}** | {how} | {out} | {ahead} | {ensemble.name} |")
    return lines


def spread(mean: float, deviation: float) -> str:
    """Mean ± deviation, the deviation with two digits and the mean as exactly."""
    if max(abs(mean), abs(deviation)) < 1e-6:
        return "0"
    size = max(abs(deviation), 1e-3 * abs(mean), 1e-12)
    digits = int(np.clip(1 - np.floor(np.log10(size)), 0, 6))
    return f"{mean:+.{digits}f} ± {deviation:.{digits}f}".replace("-", "−")
