"""Questions to a viewer that runs: asked again where it has much else to do, and ended in a sentence."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any, TypeVar

import numpy as np

from sailviz.errors import RecordingError
from sailviz.recording.children import Child

A = TypeVar("A")  # of an answer
WAITS = (1.0, 3.0, 0.0)  # s before each question is asked again; 0: no more


def ask(process: Child, words: str, question: Callable[[], A], whose: str = "the viewer") -> A:
    """The viewer's answer; asked again where it does not answer in time, for a machine may have much else to do.

    words : what it is asked for. RecordingError, in a sentence, where it never answers.
    """
    for wait in WAITS:
        try:
            return question()
        except (OSError, RuntimeError) as error:  # TimeoutError is an OSError
            if process.poll() is not None:
                raise RecordingError(
                    f"the viewer ended by itself with code {process.returncode} when it was asked {words}"
                ) from None
            if not wait:
                raise RecordingError(
                    f"{whose} was asked {words} three times and did not answer "
                    f"({_first_line(error)}); where much else is running, try again later"
                ) from None
            time.sleep(wait)
    raise AssertionError("the last try returns or raises")


def place_on(time_type: str, value: int) -> dict[str, Any]:
    """A moment as a viewer's `set_time` takes it. time_type : of the timeline; value : in its own counts."""
    if time_type == "duration":
        return {"duration": np.timedelta64(value, "ns")}
    if time_type == "timestamp":
        return {"timestamp": np.datetime64(value, "ns")}
    return {"sequence": value}


def _first_line(error: Exception) -> str:
    return (str(error).splitlines() or [type(error).__name__])[0]
