"""Words about several flights in one picture: the line of the moment, and which colour is whose."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from sailviz.recording import timelines
from sailviz.recording.companions import Overlay
from sailviz.recording.drawing.flight_curves import MOMENT, apart, apart_unit
from sailviz.recording.drawing.flights import Flight
from sailviz.recording.drawing.log import Picture
from sailviz.recording.drawing.now_line import (
    BETWEEN,
    ROWS,
    altitude_words,
    distance_words,
    drag_words,
    log_lines,
    speed_words,
)
from sailviz.recording.drawing.phrases import digits, moments, on_day, push_words
from sailviz.recording.drawing.story import Story
from sailviz.run import gaps as spans
from sailviz.run.moments import run_at

NAMED = 2  # companions that are told one by one in the line of the moment
ROOM = 3  # flights up to which there is room for more words than their names
LEVEL = 0.5  # km of altitude below which two craft are as high
COUNTS = {2: "Two", 3: "Three", 4: "Four", 5: "Five", 6: "Six"}


def log_now_together(picture: Picture, flights: Sequence[Flight]) -> None:
    """Write /now: the first flight and how far the others are from it; while it does not fly, one that does."""
    story = flights[0].story
    begin, end = span_of(flights)
    some = np.linspace(0, len(story.time) - 1, min(ROWS, len(story.time))).astype(int)
    some = np.unique(np.concatenate([some, story.breaks, story.breaks + 1]))
    when = moments(story.time, story.setting.epoch, (begin, end))
    parts = [when, *first_words(flights[0]), *beside_words(flights)]
    texts = [BETWEEN.join(word for word in row if word) for row in zip(*parts, strict=True)]
    log_lines(picture, story.samples.index_of(some), [texts[k] for k in some.tolist()])
    if len(story.breaks):
        log_lines(picture, story.gap_index, gap_texts_together(flights[0], (begin, end)))
    before = [flight for flight in flights[1:] if flight.story.time[0] < story.time[0]]
    after = [flight for flight in flights[1:] if flight.story.time[-1] > story.time[-1]]
    if before:
        log_alone(picture, flights, min(before, key=lambda f: float(f.story.time[0])), True)
    if after:
        log_alone(picture, flights, max(after, key=lambda f: float(f.story.time[-1])), False)


def gap_texts_together(first: Flight, span: tuple[float, float]) -> list[str]:
    """What is said where data of the first flight ends: until when, and that what is seen of it is older."""
    story = first.story
    when = moments(spans.moments(story.gaps), story.setting.epoch, span)
    until = [on_day(end - span[0], span[1] - span[0]) for _, end in story.gaps]
    return [
        BETWEEN.join([now, f"{first.name} without data until {then}", "seen as it last was"])
        for now, then in zip(when, until, strict=True)
    ]


def span_of(flights: Sequence[Flight]) -> tuple[float, float]:
    """s, when the first of all begins and the last of all ends."""
    times = [flight.story.time for flight in flights]
    return min(float(time[0]) for time in times), max(float(time[-1]) for time in times)


def first_words(flight: Flight) -> list[list[str]]:
    """Where a flight is, how fast, what pushes it: parts of the line of each of its drawn rows."""
    story = flight.story
    if story.frame.low:
        where, rest = altitude_words(story), [speed_words(story, 2), drag_words(story)]
    else:
        where, rest = distance_words(story), [speed_words(story, 1)]
        rest += [push_words(story.push)] if story.craft.pushes else []
    return [[f"{flight.name} {words}" for words in where], *rest]


def beside_words(flights: Sequence[Flight]) -> list[list[str]]:
    """How far each companion is away in the rows of the first flight, or of many the nearest and the farthest; of low
    orbits how much higher or lower."""
    first, *others = flights
    if first.story.frame.low:
        return [
            [here or there for here, there in zip(higher_words(first, f), absent_words(flights, f), strict=True)]
            for f in others[:NAMED]
        ]
    found = [apart(first, flight) for flight in others]
    known = [float(np.nanmax(far)) for far in found if np.isfinite(far).any()]
    if not known:
        return []
    size, unit = apart_unit(first, max(known))
    decimals = 3 if unit == "au" else digits(max(known) / size)

    unit = f"× {unit}" if unit.startswith("10^") else unit

    def said(value: float) -> str:
        return f"{value / size:,.{decimals}f}"

    if len(others) <= NAMED:
        words = []
        for flight, far in zip(others, found, strict=True):
            gone = absent_words(flights, flight)
            told = [f"{flight.name} {said(d)} {unit} away" if np.isfinite(d) else "" for d in far.tolist()]
            words.append([here or there for here, there in zip(told, gone, strict=True)])
        return words
    with np.errstate(invalid="ignore"):
        far = np.stack(found, 1)
    rows = [row[np.isfinite(row)] for row in far]
    return [[f"others {said(row.min())} to {said(row.max())} {unit} away" if len(row) else "" for row in rows]]


def absent_words(flights: Sequence[Flight], flight: Flight) -> list[str]:
    """In the rows of the first flight in which another does not fly, since when or until when; "" where it does."""
    begin, end = span_of(flights)
    start, last = float(flight.story.time[0]), float(flight.story.time[-1])
    starts, ended = (
        f"{flight.name} {word} on {on_day(t - begin, end - begin)}" for word, t in (("starts", start), ("ended", last))
    )
    return [starts if t < start else ended if t > last else "" for t in flights[0].story.time.tolist()]


def higher_words(first: Flight, other: Flight) -> list[str]:
    """How much higher or lower another flight is, by their mean altitudes; "" where it does not fly."""
    own, theirs = (altitude_at(flight, first.story.time) for flight in (first, other))
    words = []
    for off in ((theirs - own) / 1e3).tolist():
        if not np.isfinite(off):
            words.append("")
        elif abs(off) < LEVEL:
            words.append(f"{other.name} as high")
        else:
            words.append(f"{other.name} {abs(off):.0f} km {'higher' if off > 0 else 'lower'}")
    return words


def altitude_at(flight: Flight, times: np.ndarray) -> np.ndarray:
    """(m,) m: the mean altitude of a low orbit at times (m,) s."""
    run = run_at(flight.run, times)
    radius = run.setting.body.radius
    return np.asarray(run.environment.get("mean_altitude_m", run.elements.semi_major_axis - radius))


def log_alone(picture: Picture, flights: Sequence[Flight], flight: Flight, early: bool) -> None:
    """What is said before the first flight starts, or after it ended. These lines have no step: the steps of the first
    flight count its rows."""
    first, story = flights[0].story, flight.story
    rows = np.flatnonzero(story.time < first.time[0] if early else story.time > first.time[-1])
    rows = rows[np.unique(np.linspace(0, len(rows) - 1, min(ROWS, len(rows))).astype(int))]
    begin, end = span_of(flights)
    when = moments(story.time, first.setting.epoch, (begin, end))
    edge = float(first.time[0] if early else first.time[-1])
    told = f"{flights[0].name} {'starts' if early else 'ended'} on {on_day(edge - begin, end - begin)}"
    parts = [when, [told] * len(when), *first_words(flight)]
    texts = [BETWEEN.join(row) for row in zip(*parts, strict=True)]
    index = timelines.between_rows(first.setting, story.time[rows])
    log_lines(picture, index, [texts[k] for k in rows.tolist()])


def about_together(overlay: Overlay, flights: Sequence[Flight], notes: Sequence[str], aside: str) -> str:
    """The words beside the picture: how the flights stand together, and which colour is whose."""
    count = COUNTS.get(len(flights), str(len(flights)))
    parts = [f"{count} flights in one picture, **{MOMENT[overlay.by_date]}**."]
    titles = (overlay.own.title, *(companion.run.setting.title for companion in overlay.companions))
    span = span_of(flights)
    told = [
        f"- **{flight.color_word}** {flight.name}: {title}, {length_words(flight.story, span)}"
        for flight, title in zip(flights, titles, strict=True)
    ]
    more = [*(farthest_words(flights) if len(flights) <= ROOM else []), *notes]
    parts.append("\n".join([*told, *(f"- {note}" for note in more)]))
    if aside:
        parts.append(f"*{aside}*")
    return "\n\n".join(parts)


def farthest_words(flights: Sequence[Flight]) -> list[str]:
    """How far each companion gets from the first flight, or of low orbits how much higher or lower, and when."""
    first, *others = flights
    begin, end = span_of(flights)
    low, time = first.story.frame.low, first.story.time
    found = []
    for flight in others[:NAMED]:
        off = altitude_at(flight, time) - altitude_at(first, time) if low else apart(first, flight)
        if not np.isfinite(off).any():
            continue
        row = int(np.nanargmax(np.abs(off)))
        far, when = float(off[row]), on_day(float(time[row]) - begin, end - begin)
        size, unit = (1e3, "km") if low else apart_unit(first, abs(far))
        unit = f"× {unit}" if unit.startswith("10^") else unit
        told = f"**{abs(far) / size:.{digits(abs(far) / size)}f} {unit}**"
        way = "away" if not low else "higher" if far > 0 else "lower"
        found.append(f"{flight.name} at most {told} {way}, on {when}")
    return found


def length_words(story: Story, span: tuple[float, float]) -> str:
    """How long a flight lasts, in the unit in which time is counted."""
    duration = on_day(story.duration, span[1] - span[0]).split()
    return f"{duration[1]} {duration[0]}s"
