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
from sailviz.deorbits.question import RE_ENTRY, Question, drawn_values, scene_text, spreads
from sailviz.errors import SceneError
from sailviz.recording.views.scratch import scratch
from sailviz.scene import Scene, load_scene
from sailviz.simulation import simulate
from sailviz.sweeps import sweep
from sailviz.sweeps.censoring import AT_LEAST, Number, statistics

if TYPE_CHECKING:
    from pathlib import Path

    import pyarrow as pa


@dataclass(frozen=True)
class Draws:
    """What came of many flights. numbers : of the years until re-entry, "p5", "median", "p95" and others; flights, up :
    how many there are and how many were still up; failed : left out; within : of each rule its limit, how many are down
    within it, how many not, and of how many that is open; asked : how many should have flown."""

    numbers: dict[str, Number]
    flights: int
    up: int
    failed: int
    within: tuple[tuple[str, int, int, int], ...]
    asked: int


@dataclass(frozen=True)
class Answer:
    """flown : as asked, first, and beside it; note : what was not flown, and why; draws : None where none was asked;
    interrupted : whether this is only what there was when Ctrl-C came."""

    question: Question
    flown: tuple[Companion, ...]
    note: str
    draws: Draws | None
    interrupted: bool = False


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
    asked breaks down. Ctrl-C ends it with what there is once the flight as asked has flown.
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
        try:
            flown, note = companions_of(scene)
        except KeyboardInterrupt:
            return Answer(question, (asked,), "No flight beside it was flown to its end.", None, interrupted=True)
        told(0.3 if draws else 1.0)
        drawn = _drawn(question, scene, draws, seed, told, folder / "draws.parquet") if draws else None
    whole = drawn is None or drawn.flights + drawn.failed == drawn.asked
    return Answer(question, (asked, *flown), note, drawn, interrupted=not whole)


def _drawn(question: Question, scene: Scene, draws: int, seed: int, told: Callable[[float], None], path: Path) -> Draws:
    """Many flights over all processors, with what is not known drawn; after Ctrl-C those that have flown. path : of
    their table."""
    import pyarrow as pa
    import pyarrow.parquet as pq

    try:
        sweep(
            scene,
            spreads(question),
            draws=draws,
            seed=seed,
            report=[f"time_yr@{RE_ENTRY}"],
            values=drawn_values(),
            path=path,
            progress=lambda done, of: told(0.3 + 0.7 * done / of),
        )
    except KeyboardInterrupt:
        if not path.exists():
            return _counted(pa.table({}), draws)
    return _counted(pq.read_table(path, partitioning=None), draws)


def _counted(table: pa.Table, asked: int) -> Draws:
    """The numbers of the table of a sweep of descents, which may lack the last of them."""
    name = f"time_yr@{RE_ENTRY}"
    if name not in table.column_names:
        return Draws({}, 0, 0, 0, (), asked)
    known, least = (np.asarray(table[key].to_numpy(), float) for key in (name, name + AT_LEAST))
    flown = np.isfinite(known) | np.isfinite(least)
    known, least = known[flown], least[flown]
    within = tuple((limit, *shares_within(known * YEAR, least * YEAR, seconds)) for limit, seconds, _ in RULES)
    up = int(np.count_nonzero(np.isfinite(least)))
    failed = int(np.count_nonzero(~flown))
    return Draws(statistics(known, least), len(known), up, failed, within, asked)
