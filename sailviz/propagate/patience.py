"""How long an integration may go on: in pieces short enough to hear Ctrl-C, while it gets anywhere, and while there is
time.

Compiled code is deaf to signals. It returns after a number of steps, chosen by how long the last ones took; what the
caller's thread has been told meanwhile is heard then. Between two pieces three questions are asked. Is the time up?
Have more steps been made than may be? And, where the steps have become so short that the rest of the flight would
take more than may be: does that last?
"""

from __future__ import annotations

from time import perf_counter

from sailviz.compiled import inlined

MOST_STEPS = 200_000_000  # of one flight, some minutes of work; a year in a low orbit takes half a million
PIECE = 0.1  # s of wall time that a piece should take
FIRST = 4096  # steps of the first piece: at most 0.15 s with the dearest of the forces that are built in
FIRST_OF_OWN = 1  # where a user's function is called, which may take any time
MOST_OF_A_PIECE = 1_000_000
WINDOW = 200_000  # steps over which progress is measured: a close passage of a body takes some hundreds

GOES_ON, NO_PROGRESS, TOO_MANY, TIME_IS_UP = 0, 7, 8, 9  # the last three are a status of `advance`


@inlined
def first_piece(p):
    """Steps of the first piece. p : a record of PARAMETERS."""
    return FIRST_OF_OWN if p.callbacks.user_steering != 0 or p.callbacks.user_force != 0 else FIRST


class Patience:
    """Of one integration, or of several that follow each other.

    most_steps : tried, accepted or not. until : `perf_counter` at which the time is up.
    """

    def __init__(self, most_steps: int = MOST_STEPS, until: float = float("inf")):
        self.most_steps, self.until = most_steps, until
        self.step = 0.0  # s of flight that a step took on average, where there is no progress
        self.left = 0.0  # steps that the rest of the flight would have taken
        self._piece = 0  # steps; 0 before the first
        self._begun = 0.0
        self._mark: tuple[int, float] | None = None  # steps and time of flight at the beginning of the window

    def time_is_up(self) -> bool:
        """Whether the wall time is over."""
        return perf_counter() > self.until

    def next_piece(self, steps: int) -> None:
        """Let the next piece have this number of steps."""
        self._piece = steps

    def begin_piece(self) -> float:
        """Steps to try before coming back; 0 for the first piece, whose length compiled code knows: `first_piece`."""
        self._begun = perf_counter()
        return float(self._piece)

    def end_piece(self, tried: int, time: float, end: float) -> int:
        """After a piece that came back: whether to go on. time s of flight reached, end s of it wanted."""
        taken = perf_counter() - self._begun
        wanted = max(self._piece, 1) * min(PIECE / max(taken, 1e-6), 8.0)
        self._piece = int(min(max(wanted, 1), MOST_OF_A_PIECE))
        if self._begun + taken > self.until:
            return TIME_IS_UP
        if tried >= self.most_steps:
            self.step, self.left = 0.0, 0.0
            return TOO_MANY
        if self._mark is None or self._mark[1] > time or self._mark[0] > tried:  # the first time, or another flight
            self._mark = (tried, time)
        elif tried - self._mark[0] >= WINDOW:
            self.step = (time - self._mark[1]) / (tried - self._mark[0])
            self.left = (end - time) / self.step if self.step > 0.0 else float("inf")
            if self.left > self.most_steps:
                return NO_PROGRESS
            self._mark = (tried, time)
        return GOES_ON
