"""The three ways in which a run can fail, each carrying a sentence for the person who reads it."""

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

    def __str__(self) -> str:
        place = f"{self.where} (line {self.line})" if self.line else self.where
        return f"{place}: {self.what}" + (f" {self.hint}" if self.hint else "")


class SailvizError(Exception):
    """Base of every error that sailviz raises on purpose."""


class SceneError(SailvizError):
    """A scene that cannot be run. `faults` lists everything that is wrong with it, not only the first thing."""

    def __init__(self, faults: list[Fault], source: str = "scene"):
        self.faults = faults
        self.source = source
        count = "1 fault" if len(faults) == 1 else f"{len(faults)} faults"
        super().__init__("\n".join([f"{source}: {count}"] + [f"  {fault}" for fault in faults]))


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


class RecordingError(SailvizError):
    """A recording that cannot be written or read, in one sentence."""


class OutputError(RecordingError):
    """A file that cannot be written, in one sentence; what stood under its name before is untouched."""
