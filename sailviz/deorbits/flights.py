"""The answer to a question about a descent: flown as asked, without its brake, under other Suns, and many times."""

from __future__ import annotations

import shutil
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from sailviz.constants import YEAR
from sailviz.deorbits.companions import Companion, companions_of
from sailviz.deorbits.disposal import RULES, descent_of, shares_within
from sailviz.deorbits.question import RE_ENTRY, Question, scene_text, spreads
from sailviz.errors import SceneError
from sailviz.recording.views.scratch import scratch
from sailviz.scene import Scene, load_scene
from sailviz.simulation import simulate
from sailviz.sweeps import sweep
from sailviz.sweeps.censoring import AT_LEAST, Number, statistics

if TYPE_CHECKING:
    from sailviz.sweeps.result import Sweep


@dataclass(frozen=True)
class Draws:
    """What came of many flights. numbers : of the years until re-entry, "p5", "median", "p95" and others; flights, up :
    how many there are and how many were still up; failed : left out; within : of each rule its limit, how many are down
    within it, how many not, and of how many that is open."""

    numbers: dict[str, Number]
    flights: int
    up: int
    failed: int
    within: tuple[tuple[str, int, int, int], ...]


@dataclass(frozen=True)
class Answer:
    """flown : as asked, first, and beside it; note : what was not flown, and why; draws : None where none was asked."""

    question: Question
    flown: tuple[Companion, ...]
    note: str
    draws: Draws | None


def answer(
    question: Question,
    draws: int = 0,
    *,
    seed: int = 0,
    progress: Callable[[float], None] | None = None,
) -> Answer:
    """Fly what a question asks.

    draws : flights with what is not known drawn from its distributions, 0 for none; seed : of these. progress : called
    with the fraction that is done. SceneError for what no scene can be made of, PropagationError where the flight as
    asked breaks down.
    """
    told = progress or (lambda fraction: None)
    with scratch() as folder:
        file = folder / "descent.toml"
        file.write_text(scene_text(question), encoding="utf-8")
        for beside in question.files:
            shutil.copyfile(beside, folder / beside.name)
        try:
            scene = load_scene(file)
            run = simulate(scene)
        except SceneError as error:  # of a file that is gone a moment later
            raise SceneError(error.faults, "the descent that is asked for") from None
        told(0.1 if draws else 0.3)
        asked = Companion(f"as asked, with {question.brake}", descent_of(run))
        flown, note = companions_of(scene)
        told(0.3 if draws else 1.0)
        drawn = _drawn(question, scene, draws, seed, told) if draws else None
    return Answer(question, (asked, *flown), note, drawn)


def _drawn(question: Question, scene: Scene, draws: int, seed: int, told: Callable[[float], None]) -> Draws:
    """Many flights, with what is not known drawn."""
    found = sweep(
        scene,
        spreads(question),
        draws=draws,
        seed=seed,
        report=[f"time_yr@{RE_ENTRY}"],
        progress=lambda done, of: told(0.3 + 0.7 * done / of),
    )
    return _counted(found)


def _counted(found: Sweep) -> Draws:
    """The numbers of a sweep of descents."""
    table = found.table
    name = f"time_yr@{RE_ENTRY}"
    known, least = table[name], table[name + AT_LEAST]
    flown = np.isfinite(known) | np.isfinite(least)
    known, least = known[flown], least[flown]
    within = tuple((limit, *shares_within(known * YEAR, least * YEAR, seconds)) for limit, seconds, _ in RULES)
    up = int(np.count_nonzero(np.isfinite(least)))
    return Draws(statistics(known, least), len(known), up, found.failed, within)
