"""Flights that are shown in one picture: what may be put together, and where each stands on the first one's clock.

The first flight decides: centre, frame, unit, camera and clock. The others, its companions, stand beside it at the same
date where all have one and fly at the same time as the first; else at the same time since each start, and then no
date is told, since each would have its own.
"""

from __future__ import annotations

import hashlib
import re
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from sailviz.errors import RecordingError
from sailviz.recording.contract import word
from sailviz.run.arrays import Run, Setting
from sailviz.words import shortened

LONGEST = 24  # letters of a name that still stands beside a craft
NAME = re.compile(r"[^\W_][\w .,+%()°/='-]*")  # what neither Markdown nor a path of entities takes for its own
WELL_MADE = "a letter or a digit, then letters, digits, spaces and .,+-%()°/='_"
MOST = 6  # flights: as many as there are colours for them, style.FLIGHTS


@dataclass(frozen=True)
class Companion:
    """A further flight. run : as it was flown; shown : the same on the first flight's clock; start : s of that clock at
    which its own time is 0."""

    name: str
    run: Run
    shown: Run
    start: float


@dataclass(frozen=True)
class Overlay:
    """Flights in one picture. setting : of the picture; own : of the first flight by itself."""

    name: str  # of the first flight
    setting: Setting
    own: Setting
    companions: tuple[Companion, ...]
    by_date: bool  # whether they stand together at the same date, rather than the same time since their starts

    @property
    def names(self) -> tuple[str, ...]:
        """Of all flights, the first one first."""
        return (self.name, *(companion.name for companion in self.companions))


def overlay_of(runs: Mapping[str, Run]) -> Overlay:
    """Put runs together, the first one first. RecordingError, with every fault, for what cannot be."""
    check_together([(name, run.setting.family, run.setting.body.name) for name, run in runs.items()])
    check_runs(runs)
    (name, first), *others = runs.items()
    starts = starts_by_date(list(runs.values()))
    by_date = starts is not None
    epoch = first.setting.epoch if by_date else None
    companions = tuple(
        Companion(other, run, shifted(run, start, epoch), start)
        for (other, run), start in zip(others, (starts or [0.0] * len(runs))[1:], strict=True)
    )
    setting = replace(
        first.setting,
        title=" and ".join(runs) if len(runs) == 2 else ", ".join(runs),
        identity=identity_of(runs),
        epoch=epoch,
        craft=replace(first.setting.craft, label=name),
        references=tuple(r for r in first.setting.references if r.role != "approximation"),
    )
    return Overlay(name, setting, first.setting, companions, by_date)


def check_together(flights: Sequence[tuple[str, str, str]]) -> None:
    """Raise RecordingError, with every fault, unless flights (name, family, central body) can be put together. What is
    known before anything is flown."""
    names = [name for name, _, _ in flights]
    faults = name_faults(names)
    kinds = {(family, body) for _, family, body in flights}
    if len(kinds) > 1:
        told = ", ".join(f"{shortened(str(name))} {family} about the {body}" for name, family, body in flights)
        faults.append(f"only flights of one family about one body are compared, and here are {told}")
    if faults:
        raise RecordingError("these flights cannot be put in one picture: " + "; ".join(faults))


def name_faults(names: Sequence[object]) -> list[str]:
    """What is wrong with how many flights there are and what they are called."""
    faults = []
    if len(names) < 2:
        faults.append(f"two are needed at least, and there is {'one' if names else 'none'}")
    if len(names) > MOST:
        faults.append(f"there are {MOST} colours for flights, and {len(names)} flights")
    for name in names:
        if not isinstance(name, str) or not name.strip():
            faults.append(f"{name!r} is no name" if not isinstance(name, str) else "a name is empty")
        elif not NAME.fullmatch(name) or name != name.strip():
            faults.append(f"the name {shortened(repr(name))} has to be {WELL_MADE}")
        elif len(name) > LONGEST:
            faults.append(f"the name {shortened(name)} has {len(name)} letters, {LONGEST} at most are read in space")
    count = Counter(word(name) for name in names if isinstance(name, str))
    for same in (known for known, number in count.items() if number > 1):
        alike = list(dict.fromkeys(str(name) for name in names if isinstance(name, str) and word(name) == same))
        both = " and ".join(map(shortened, alike))
        faults.append(f"{both} are taken for one name" if len(alike) > 1 else f"two flights are called {both}")
    return list(dict.fromkeys(faults))


def check_runs(runs: Mapping[str, Run]) -> None:
    """Raise RecordingError, with every fault, for runs that are no single flights about the same body."""
    first, *others = runs.items()
    faults = [f"{name} has no rows" for name, run in runs.items() if not len(run)]
    faults += [
        f"{name} is an ensemble of flights: only single flights are compared"
        for name, run in runs.items()
        if run.setting.ensembles or run.setting.attitude_ensembles
    ]
    faults += [
        f"the {run.setting.body.name} of {name} pulls with {run.setting.body.mu:.9g} m³/s², that of {first[0]} with "
        f"{first[1].setting.body.mu:.9g}"
        for name, run in others
        if not np.isclose(run.setting.body.mu, first[1].setting.body.mu, rtol=1e-6, atol=0.0)
    ]
    if faults:
        raise RecordingError("these flights cannot be put in one picture: " + "; ".join(faults))


def starts_by_date(runs: Sequence[Run]) -> list[float] | None:
    """s after the first one's time 0 at which that of each run lies, by their dates; None unless all have one and fly
    at the same time as the first for a while."""
    epochs = [run.setting.epoch for run in runs]
    if epochs[0] is None:
        return None
    starts = [np.nan if e is None else (e - epochs[0]) / np.timedelta64(1, "ns") * 1e-9 for e in epochs]
    begin, end = runs[0].time[[0, -1]]
    meet = [run.time[0] + start < end and run.time[-1] + start > begin for run, start in zip(runs, starts, strict=True)]
    return [float(start) for start in starts] if all(meet) else None


def shifted(run: Run, start: float, epoch: np.datetime64 | None) -> Run:
    """A run on the clock of another, whose time is `start` at its own 0, with that one's epoch."""
    setting = replace(
        run.setting,
        epoch=epoch,
        gaps=tuple((begin + start, end + start) for begin, end in run.setting.gaps),
        phases=tuple(replace(one, start=one.start + start, end=one.end + start) for one in run.setting.phases),
    )
    events = tuple(replace(event, time=event.time + start) for event in run.events)
    return replace(run, setting=setting, time=run.time + start, events=events)


def identity_of(runs: Mapping[str, Run]) -> str:
    """Hash of the names and the identities of all, hexadecimal, as long as one of theirs."""
    told = "\n".join(f"{name} {run.setting.identity}" for name, run in runs.items())
    size = len(next(iter(runs.values())).setting.identity) or 64
    return hashlib.sha256(told.encode()).hexdigest()[:size]
