"""The ways in which a run can fail, each carrying a sentence for the person who reads it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import numpy as np


@dataclass(frozen=True)
class Fault:
    """One thing that is wrong in a scene: where it stands, what is wrong, what was meant or allowed."""

    where: str  # dotted path in the file as the user wrote it, e.g. "start.radius_au"
    what: str
    hint: str = ""
    line: int | None = None
    given: str = ""  # key of a value put over the file's, which is at fault or has a part in it

    def __str__(self) -> str:
        return self.words()

    def words(self, option: str = "") -> str:
        """The sentence. option : by which a shell puts values over the file's, "--set"; "" in Python."""
        where = _short(self.where)
        before = f"{option} " if option else ""
        if self.given and _below(self.where, self.given):
            where = f"{before}{where}"
        elif self.given:
            where += f" (with {before}{_short(self.given)})"
        elif self.line:
            where += f" (line {self.line})"
        return f"{where}: {self.what}" + (f" {self.hint}" if self.hint else "")


def _below(where: str, key: str) -> bool:
    """Whether a place is a key or lies inside it."""
    return where == key or where.startswith((f"{key}.", f"{key}["))


def _short(word: str) -> str:
    """A word as a message bears it: on one line and not endless."""
    text = word if word.isprintable() else repr(word)[1:-1]
    return text if len(text) <= 120 else f"{text[:80]}...{text[-30:]}"


class SailvizError(Exception):
    """Base of every error that sailviz raises on purpose."""


class SceneError(SailvizError):
    """A scene that cannot be run. `faults` lists everything that is wrong with it, not only the first thing."""

    def __init__(self, faults: list[Fault], source: str = "scene"):
        self.faults = faults
        self.source = source
        super().__init__(self.words())

    def words(self, option: str = "") -> str:
        """All faults, a line each. option : as in `Fault.words`."""
        count = "1 fault" if len(self.faults) == 1 else f"{len(self.faults)} faults"
        return "\n".join([f"{_short(self.source)}: {count}"] + [f"  {fault.words(option)}" for fault in self.faults])


class PropagationError(SailvizError):
    """The integration could not go on. Says when, where and in which state.

    time : float, s since the start; state : (7,) position m, velocity m/s, mass kg.
    """

    def __init__(self, reason: str, time: float, state: Sequence[float] | np.ndarray):
        self.reason = reason
        self.time = time
        self.state = state
        r = ", ".join(f"{value:.6g}" for value in state[:3])
        v = ", ".join(f"{value:.6g}" for value in state[3:6])
        super().__init__(
            f"{reason} at t = {time:.6g} s ({time / 86400:.4g} d), "
            f"position ({r}) m, velocity ({v}) m/s, mass {state[6]:.6g} kg"
        )


class TimeLimitError(SailvizError):
    """The wall time that was allowed is over, in one sentence that says how far the work had come."""


class RecordingError(SailvizError):
    """A recording that cannot be written or read, in one sentence."""


class DamagedError(RecordingError):
    """A recording whose bytes are not those that were written. entities : those in which the damage lies, as far as
    that can be told."""

    def __init__(self, sentence: str, entities: Sequence[str] = ()):
        self.entities = tuple(entities)
        super().__init__(sentence)


class OutputError(RecordingError):
    """A file that cannot be written, in one sentence; what stood under its name before is untouched."""
