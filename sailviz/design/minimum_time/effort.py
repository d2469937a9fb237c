"""How long a search may go on, what it has tried, who is told of it, and how it ended.

Every search takes an `Effort` and asks it, between pieces of compiled work of less than half a second, whether to go
on. At the end of its time, or once it was asked to end, `check` raises `Stopped` in all threads of the search; the
search catches it, and what was found until then is its answer, marked.

    effort = Effort(time_limit=60.0)
    with effort.listening():  # Ctrl-C, too, keeps the best so far; without it KeyboardInterrupt is raised as ever
        found = circle_to_circle(AU, 1.5 * AU, "ideal", 1e-3, effort=effort)
"""

from __future__ import annotations

import copy
import signal
import threading
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from time import perf_counter
from types import FrameType

import numpy as np

FOUND, NOT_FOUND, IMPOSSIBLE = "found", "not found", "impossible"  # outcomes of a search
TIME_LIMIT, INTERRUPTED = "time limit", "interrupted"  # what stopped it
STOPPED = {TIME_LIMIT: "The search was stopped by its time limit", INTERRUPTED: "The search was interrupted"}

Progress = Callable[[float, str], None]
Residuals = Callable[[np.ndarray], np.ndarray]


class Stopped(Exception):
    """The search is to end; what it found until now counts."""


@dataclass(frozen=True)
class Ending:
    """How a search ended. outcome : FOUND, NOT_FOUND (by this search, which proves nothing) or IMPOSSIBLE (proven).

    stopped : TIME_LIMIT or INTERRUPTED where it ended before it was done, else "". tried : in words, what it looked at.
    seconds : of wall time that it took. nearest : in words, the true flight that came nearest, where none was found.
    advice : what to change then, each a sentence without its full stop.
    """

    outcome: str = FOUND
    stopped: str = ""
    tried: str = ""
    seconds: float = 0.0
    nearest: str = ""
    advice: tuple[str, ...] = ()

    @property
    def mark(self) -> str:
        """The sentence that a result bears whose search was stopped, "" where it was not; a space before."""
        return f" {STOPPED[self.stopped]}: more time may find a faster flight." if self.stopped else ""


ANSWERED, UNANSWERED = Ending(FOUND), Ending(NOT_FOUND)  # of results made without a search


class Effort:
    """Of one search, or of several that follow each other: may be shared by threads.

    time_limit : s of wall time from now on, None for no limit. progress(share, words) : called now and then.
    """

    def __init__(self, time_limit: float | None = None, progress: Progress | None = None):
        if time_limit is not None and not time_limit > 0:
            raise ValueError(f"a time limit must be a positive number of seconds, got {time_limit!r}")
        self.time_limit = time_limit
        self._begun = perf_counter()
        self._until = float("inf") if time_limit is None else self._begun + time_limit
        self._progress = progress
        self._tried: Counter[str] = Counter()
        self._lock = threading.Lock()
        self._ended: list[str] = []  # why, one entry or none; shared with `part`

    @classmethod
    def of(cls, effort: Effort | None, progress: Progress | None, time_limit: float | None) -> Effort:
        """The effort given, or one of a search's own. ValueError where both are said."""
        if effort is None:
            return cls(time_limit, progress)
        if progress is not None or time_limit is not None:
            raise ValueError("an effort has a time limit and a progress of its own: give the one or the others")
        return effort

    @property
    def stopped(self) -> str:
        """What ended it before it was done, "" where nothing did."""
        return self._ended[0] if self._ended else ""

    @property
    def seconds(self) -> float:
        """Wall time since it began."""
        return perf_counter() - self._begun

    def end(self, why: str = INTERRUPTED) -> None:
        """Let every search that shares this effort end at its next `check`."""
        if not self._ended:
            self._ended.append(why)

    def check(self) -> None:
        """Stopped at the end of the time, or once the search was asked to end."""
        if perf_counter() > self._until:
            self.end(TIME_LIMIT)
        if self._ended:
            raise Stopped

    def watched(self, residuals: Residuals) -> Residuals:
        """The same residuals, of less than half a second each, which raise Stopped once the search is to end."""

        def checked(unknowns: np.ndarray) -> np.ndarray:
            self.check()
            return residuals(unknowns)

        return checked

    @contextmanager
    def stoppable(self) -> Iterator[None]:
        """Go on behind the body once the search is to end: `stopped` tells whether it came so far."""
        with suppress(Stopped):
            yield

    @contextmanager
    def listening(self) -> Iterator[None]:
        """Let the first Ctrl-C within end the search with what it has; a second one is heard as ever."""
        before = signal.getsignal(signal.SIGINT)
        if threading.current_thread() is not threading.main_thread() or not callable(before):
            yield
            return

        def interrupt(_number: int, _frame: FrameType | None) -> None:
            self.end(INTERRUPTED)
            signal.signal(signal.SIGINT, before)

        signal.signal(signal.SIGINT, interrupt)
        try:
            yield
        finally:
            signal.signal(signal.SIGINT, before)

    def report(self, share: float, words: str) -> None:
        """Tell how far the search is: a share between 0 and 1, and what it is at."""
        if self._progress is not None:
            self._progress(min(max(share, 0.0), 1.0), words)

    def part(self, begin: float, end: float) -> Effort:
        """The same effort for a search within another, whose progress goes from one share of the whole to another."""
        inner = copy.copy(self)
        outer = self._progress
        if outer is not None:
            inner._progress = lambda share, words: outer(begin + (end - begin) * share, words)
        return inner

    def count(self, what: str, n: int = 1) -> None:
        """So many more were tried of what is named in the plural, e.g. "costates flown"."""
        with self._lock:
            self._tried[what] += n

    @property
    def tried(self) -> str:
        """What was tried, in words, in the order in which it was begun."""
        return ", ".join(f"{n:,} {what}" for what, n in self._tried.items())

    def found(self) -> Ending:
        """Of a search that has an answer."""
        return Ending(FOUND, self.stopped, self.tried, self.seconds)

    def not_found(self, nearest: str = "", *advice: str) -> Ending:
        """Of a search without an answer. nearest and advice : as in `Ending`."""
        return Ending(NOT_FOUND, self.stopped, self.tried, self.seconds, nearest, advice)

    def impossible(self) -> Ending:
        """Of a question that has no answer, for a reason that proves it."""
        return Ending(IMPOSSIBLE, self.stopped, self.tried, self.seconds)
