"""A Run in a notebook: one small table of what flew, for how long, from where to where. Plain HTML, nothing fetched."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Sequence
from html import escape
from typing import TYPE_CHECKING

import numpy as np

from sailviz.words import acceleration, angle, duration, length

if TYPE_CHECKING:
    from sailviz.run.arrays import Run

MOST_EVENTS = 12
BEYOND = 1e9  # times the distance: a semi-major axis beyond it is that of a parabola
LINE = "border-bottom: 1px solid rgba(128, 128, 128, 0.35)"  # seen on white and on black
CELL = "text-align: left; padding: 2px 14px 2px 0; border: none"


def html(run: Run) -> str:
    """The summary of a run or of a block of one."""
    setting = run.setting
    parts = [f"<b>{escape(setting.title)}</b>"]
    if setting.about:
        parts.append(emphasised(setting.about))
    parts.append(escape(span(run)))
    if setting.parameters:
        parts.append(" · ".join(f"{escape(name)} <b>{escape(value)}</b>" for name, value in setting.parameters))
    body = "".join(f'<div style="margin: 0 0 4px">{part}</div>' for part in parts)
    tables = [table(("", "first row", "last row"), ends(run))] if len(run) else []
    if setting.phases:
        spans = [(p.name, duration(p.start) if p.reached else "never", p.words) for p in setting.phases]
        tables.append(table(("phase", "from", ""), spans))
    if run.events:
        shown = [(event.name, duration(event.time)) for event in run.events[:MOST_EVENTS]]
        if len(run.events) > MOST_EVENTS:
            shown.append((f"and {len(run.events) - MOST_EVENTS:,} more", ""))
        tables.append(table(("event", "at"), shown))
    return f'<div style="color: inherit; background: none; max-width: 60em">{body}{"".join(tables)}</div>'


def span(run: Run) -> str:
    """How many rows over what time, and why it ended."""
    if not len(run):
        return "no rows"
    rows = f"{len(run):,} rows" if len(run) != 1 else "1 row"
    begin = f" from {duration(run.time[0])} on" if run.time[0] else ""
    end = f", ended by {run.ended}" if run.ended else ""
    return f"{rows} over {duration(run.time[-1] - run.time[0])}{begin}{end}{since(run.setting.epoch)}"


def since(epoch: np.datetime64 | None) -> str:
    """What t = 0 is on the calendar."""
    if epoch is None:
        return ""
    date, clock = str(epoch.astype("datetime64[s]")).split("T")
    return f", t = 0 at {date}{'' if clock == '00:00:00' else ' ' + clock} UTC"


def ends(run: Run) -> list[tuple[str, str, str]]:
    """(quantity, at the first row, at the last row)."""
    e = run.elements
    distance, speed = (np.linalg.norm(vector[[0, -1]], axis=1) for vector in (run.position, run.velocity))
    farthest = distance.max()
    rows: list[tuple[str, np.ndarray, Callable[[float], str]]] = [
        ("time", run.time, duration),
        (f"distance from the {run.setting.body.name}", distance, length),
        ("speed", speed, lambda value: f"{value / 1e3:.6g} km/s"),
        ("semi-major axis", e.semi_major_axis, lambda value: length(value) if abs(value) < BEYOND * farthest else "∞"),
        ("eccentricity", e.eccentricity, lambda value: f"{value:.6g}"),
        ("inclination", e.inclination, angle),
        ("ascending node", e.raan, angle),
        ("argument of periapsis", e.argument, angle),
        ("true anomaly", e.true_anomaly, angle),
        ("thrust acceleration", run.thrust.magnitude, acceleration),
    ]
    return [(name, say(values[0]), say(values[-1])) for name, values, say in rows]


def table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """Escaped cells under a head."""
    top = "".join(f'<th style="{CELL}; {LINE}; font-weight: normal; opacity: 0.7">{escape(word)}</th>' for word in head)
    lines = ("".join(f'<td style="{CELL}">{escape(str(word))}</td>' for word in row) for row in rows)
    body = "".join(f'<tr style="background: none">{line}</tr>' for line in lines)
    style = "border-collapse: collapse; color: inherit; margin: 6px 0; font-size: 90%"
    return f'<table style="{style}"><thead><tr style="background: none">{top}</tr></thead><tbody>{body}</tbody></table>'


def emphasised(markdown: str) -> str:
    """The one mark that scenes use, **bold**, as HTML; everything else escaped."""
    return re.sub(r"\*\*(.+?)\*\*", r"<b>\1</b>", escape(markdown))
