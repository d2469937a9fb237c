"""The words beside the picture: what it is, what to look for, where it comes from. Short, or the panel clips them."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from sailviz.recording.drawing.arrival_plane import MILLI_AU
from sailviz.run.arrays import Event, Setting


def about(setting: Setting, notes: Iterable[str] = ()) -> str:
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


def scoreboard(setting: Setting) -> list[str]:
    """Lines of Markdown: how far each ensemble ends from the nominal flight, mean ± standard deviation."""
    if not setting.ensembles:
        return []
    lines = ["", "| end − nominal | r, 10⁻³ au | azimuth, ° | out, km/s | across, km/s |", "|---|---|---|---|---|"]
    factors = {0: 1 / MILLI_AU, 1: 180 / np.pi, 3: 1e-3, 4: 1e-3}
    for ensemble in setting.ensembles:
        off = ensemble.end_mean - ensemble.nominal[-1]
        cells = [spread(off[k] * factor, ensemble.end_deviation[k] * factor) for k, factor in factors.items()]
        lines.append(f"| **{ensemble.name}** | {' | '.join(cells)} |")
    return lines


def legend(setting: Setting) -> list[str]:
    """What the colours mean, one line each."""
    names = {0: "orange", 1: "green", 2: "pink", 3: "violet"}
    lines = []
    for k, ensemble in enumerate(setting.ensembles):
        flights = f"{ensemble.flights:,} flights" + (", gPC" if ensemble.method == "polynomial-chaos" else "")
        lines.append(f"**{names[k % 4]}**: {ensemble.name} ({ensemble.words}; {flights})")
    return lines


def spread(mean: float, deviation: float) -> str:
    """Mean ± deviation, the deviation with two digits and the mean as exactly."""
    if max(abs(mean), abs(deviation)) < 1e-6:
        return "0"
    size = max(abs(deviation), 1e-3 * abs(mean), 1e-12)
    digits = int(np.clip(1 - np.floor(np.log10(size)), 0, 6))
    return f"{mean:+.{digits}f} ± {deviation:.{digits}f}".replace("-", "−")
