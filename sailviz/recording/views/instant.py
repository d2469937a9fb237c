"""Moments of a run as people name them: start, end, a fraction (0.6), a time since the start (120d, 0.5yr, 36h)."""

from __future__ import annotations

import re

from sailviz.errors import RecordingError
from sailviz.recording.reader import FilePath, read
from sailviz.units import UNITS
from sailviz.words import duration

TIME = UNITS["time"]
Moment = str | float  # start, end, a fraction, or a time with its unit
NAMED = {"start": 0.0, "end": 1.0}
FORM = re.compile(r"\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*([a-zA-Z]*)\s*")


def moment(text: Moment) -> float | tuple[float, str]:
    """What a moment means: a fraction of the run, or (seconds since its start, the words). RecordingError otherwise."""
    text = text if isinstance(text, str) else repr(text)
    if text.strip().lower() in NAMED:
        return NAMED[text.strip().lower()]
    found = FORM.fullmatch(text)
    if not found or (found[2] and found[2] not in TIME):
        raise RecordingError(
            f"{text!r} is no moment of a run: give start, end, a fraction such as 0.6, "
            f"or a time with its unit ({', '.join(TIME)}) such as 120d"
        )
    number = float(found[1])
    if found[2]:
        return number * TIME[found[2]], text.strip()
    if not 0 <= number <= 1:
        raise RecordingError(f"a fraction of a run lies between 0 and 1, not at {number:g}; a time needs its unit")
    return number


def fraction_of(path: FilePath, at: Moment) -> float:
    """Where a moment lies in a recording: 0 at its first row, 1 at its last; of several flights at those of any, a time
    counted from the start of the first of them."""
    wanted = moment(at)
    if isinstance(wanted, float):
        return wanted
    seconds, words = wanted
    recording = read(path)
    if "/state" not in recording or not len(recording["/state"]["time_s"]):
        raise RecordingError(f"{path} has no times of a run; give a fraction instead of {words}")
    time = recording["/state"]["time_s"]
    clocks = [time, *(recording[f"{f.path}/state"]["time_s"] + f.start for f in recording.flights[1:])]
    first, last = min(float(each[0]) for each in clocks), max(float(each[-1]) for each in clocks)
    if not first <= seconds <= last:
        raise RecordingError(f"{words} lies outside the run, which goes from {duration(first)} to {duration(last)}")
    return (seconds - first) / (last - first) if last > first else 0.0
