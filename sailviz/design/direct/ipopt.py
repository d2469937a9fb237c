"""IPOPT at work on a transcription: quiet, within a time, and heard when it is asked to stop."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from sailviz.design.direct.extra import casadi
from sailviz.design.direct.transcription import Guess, Nodes, Transcription
from sailviz.design.minimum_time.effort import Effort, Stopped

if TYPE_CHECKING:
    import casadi as ca

TOLERANCE = 1e-9
MOST_ITERATIONS = 1000
GOOD = 1e-6  # violation of the constraints of a flight
WARM = 1e-4  # IPOPT's barrier at the begin where the guess is nearly the answer
ROUGHLY = 2.0  # factor by which the durations of arcs may be off


@dataclass(frozen=True)
class Solved:
    """What an attempt ended with: the flight at the nodes, its time, iterations, the largest violation of a
    constraint, IPOPT's own word for the end, and whether that is a local optimum; stopped : by the time limit or by
    Ctrl-C, what there is may be a flight all the same."""

    nodes: Nodes
    span: float
    iterations: int
    violation: float
    status: str
    converged: bool
    stopped: bool

    @property
    def flies(self) -> bool:
        """Whether it is a flight that gets there, the fastest or not."""
        return self.violation < GOOD


def solve(
    transcription: Transcription,
    guess: Guess,
    *,
    effort: Effort,
    words: str = "",
    share: float = 0.0,
    warm: bool = False,
) -> Solved:
    """The fastest flight near a guess, or where the search for it ended, which the effort may have asked for. words,
    share : what the effort reports meanwhile. warm : the guess is nearly the answer."""
    ca = casadi()
    watch = _watch(transcription, effort, words, share)
    options = {
        "expand": True,
        "print_time": False,
        "error_on_fail": False,
        "iteration_callback": watch,
        "ipopt.print_level": 0,
        "ipopt.sb": "yes",
        "ipopt.tol": TOLERANCE,
        "ipopt.mu_strategy": "monotone",  # the adaptive one comes near and at times does not end
        "ipopt.max_iter": MOST_ITERATIONS,
    }
    low, high, z0 = transcription.z_low.copy(), transcription.z_high.copy(), transcription.packed(guess)
    if warm or transcription.question.arcs:
        options["ipopt.mu_init"] = WARM
    if transcription.question.arcs:  # known roughly: else a part may vanish in favour of a slower flight without it
        parts = slice(0, len(transcription.question.arcs))
        low[parts], high[parts] = z0[parts] / ROUGHLY, z0[parts] * ROUGHLY
    solver = ca.nlpsol("flight", "ipopt", transcription.problem, options)
    z0 = np.clip(z0, low, high)
    found = solver(x0=z0, lbx=low, ubx=high, lbg=transcription.g_low, ubg=transcription.g_high)
    if watch.pressed:
        raise KeyboardInterrupt
    stats = solver.stats()
    g = np.array(found["g"]).ravel()
    violation = float(np.max(np.maximum(transcription.g_low - g, g - transcription.g_high), initial=0.0))
    nodes = transcription.unpacked(np.array(found["x"]).ravel(), np.array(found["lam_g"]).ravel())
    return Solved(
        nodes,
        float(nodes.times[-1]),
        int(stats["iter_count"]),
        violation,
        str(stats["return_status"]),
        bool(stats["success"]) and violation < GOOD and not watch.stopped,
        watch.stopped,
    )


def _watch(transcription: Transcription, effort: Effort, words: str, share: float) -> ca.Callback:
    """What casadi calls after each iteration of IPOPT, which ends where it returns other than 0. No exception may
    leave it: casadi has none of its own for it."""
    import casadi as cas

    sizes = transcription.problem["x"].numel(), transcription.problem["g"].numel()
    shapes = {"x": sizes[0], "lam_x": sizes[0], "f": 1, "g": sizes[1], "lam_g": sizes[1], "lam_p": 0}

    class Watch(cas.Callback):
        def __init__(self) -> None:
            cas.Callback.__init__(self)
            self.count, self.stopped, self.pressed = 0, False, False
            self.construct("watch", {})

        def get_n_in(self) -> int:
            return int(cas.nlpsol_n_out())

        def get_n_out(self) -> int:
            return 1

        def get_name_in(self, i: int) -> str:
            return str(cas.nlpsol_out(i))

        def get_name_out(self, i: int) -> str:
            return "ret"

        def get_sparsity_in(self, i: int) -> ca.Sparsity:
            size = shapes[cas.nlpsol_out(i)]
            return cas.Sparsity.dense(size, 1) if size else cas.Sparsity(0, 0)

        def eval(self, arguments: list[ca.DM]) -> list[int]:
            try:
                self.count += 1
                effort.report(share, f"{words}, iteration {self.count}")
                effort.check()
            except Stopped:
                self.stopped = True
            except KeyboardInterrupt:
                self.pressed = True
            return [int(self.stopped or self.pressed)]

    return Watch()
