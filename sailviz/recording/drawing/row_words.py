"""What is said of rows that lie far apart, and of a stowed sail: what of the picture is no data."""

from __future__ import annotations

import numpy as np

from sailviz.recording.drawing.samples import SPARSE, TURNS
from sailviz.recording.drawing.story import Story


def revolutions(story: Story) -> float:
    """Revolutions on the orbits of the rows, those without data left out; 0 where orbits are open."""
    a = story.samples.run.elements.semi_major_axis
    with np.errstate(invalid="ignore", divide="ignore"):
        rate = np.where((a > 0) & np.isfinite(a), np.sqrt(story.frame.mu / np.abs(a) ** 3), 0.0) / (2 * np.pi)
    turned = 0.5 * (rate[1:] + rate[:-1]) * np.diff(story.time)
    return float(np.sum(np.delete(turned, story.breaks)))


def sparse_words(story: Story) -> list[str]:
    """How few rows there are in a revolution, and how the trail gets from one to the next."""
    turned, rows = revolutions(story), int(story.samples.number[-1])
    few = turned > SPARSE * rows
    if few and story.frame.sparse:
        apart = f"{turned / rows:.2g} revolutions apart" if turned > rows else f"{rows / turned:.1f} in a revolution"
        shown = TURNS * story.duration / story.frame.duration  # the pace is that of the planned time
        return [f"**rows are {apart}**: the picture goes round {shown:.0f} times instead of {turned:,.0f}"]
    ways = story.ways
    begin = f"**{rows / turned:.1f} rows in a revolution**" if few else f"**rows far apart** {times(ways.far)}"
    if story.frame.low or not (ways.far or ways.open):
        return [f"{begin}: what lies between them is not drawn"] if few else []
    bent = "by the thrust" if story.most > 0 else "to meet the next row"
    how = f", bent {bent}, and" if ways.bent else " and"
    words = f"{begin}: between them the trail follows gravity{how} is no data"
    if story.unknown:
        words += f"; {times(len(story.unknown))} no way is known to the next row, and it is dashed"
    elif ways.open:
        words += f"; {times(len(ways.open))} that does not lead to the next row, whose orbit is drawn instead"
    return [words]


def stowed_words(story: Story) -> list[str]:
    """What is left of a sail that is stowed."""
    return ["where the sail is **stowed** only the bus is drawn"] if story.stowed.any() else []


def times(count: int) -> str:
    """How often."""
    return {1: "once", 2: "twice"}.get(count, f"{count} times")


def plain_words(line: str) -> str:
    """A line of the description as a sentence for a terminal."""
    text = line.replace("**", "")
    return f"{text[:1].upper()}{text[1:]}."
