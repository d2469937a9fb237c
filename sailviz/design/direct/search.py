"""The fastest flight by the direct method: from several guesses, sharpened where it switches, confirmed by flying it.

Costs seconds, needs no costates and no structure, and keeps to limits on the way; it ends at a local optimum. What is
told of it is what its table of attitudes does when the ordinary propagator flies it.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np

from sailviz.constants import DAY, GRAVITY_AT_1_AU
from sailviz.design.direct import ipopt
from sailviz.design.direct.arcs import arcs_of, guess_on
from sailviz.design.direct.electric import ElectricSail
from sailviz.design.direct.film import FilmSail
from sailviz.design.direct.limits import Limits
from sailviz.design.direct.reflight import Confirmed, confirm, table_of
from sailviz.design.direct.transcription import Arc, Guess, Nodes, Question, Transcription, transcribe
from sailviz.design.minimum_time.effort import INTERRUPTED, Effort, Ending, Progress
from sailviz.design.minimum_time.replay import SteeringTable
from sailviz.design.minimum_time.state_costate import TIME_UNIT
from sailviz.propulsion.devices import ELECTRIC_SAILS
from sailviz.propulsion.solar_sail import FILMS, Film

SAME = 1e-5  # relative flight time below which two solutions are one
REFINEMENTS = 3  # meshes on the switches, each read from the one before
FLIES = 3e-3  # largest miss, canonical, of a flight that is told
SLOWER = 1e-3  # relative flight time that a sharpened flight may lose: the coarse one has thrust between its points


def sail_of(device: Film | str, characteristic_acceleration: float) -> FilmSail | ElectricSail:
    """The sail of a device, a name or a Film, and its characteristic acceleration in m/s2. ValueError for what the
    direct method has no controls for."""
    strength = characteristic_acceleration / GRAVITY_AT_1_AU
    if isinstance(device, str) and device in ELECTRIC_SAILS:
        if device != "electric-sail":
            raise ValueError(f'the direct method knows the electric sail\'s final model only, not "{device}"')
        return ElectricSail(strength)
    film = FILMS[device] if isinstance(device, str) and device in FILMS else device
    if not isinstance(film, Film):
        raise ValueError(f"{device!r} is no sail; there are {', '.join([*FILMS, *ELECTRIC_SAILS])}, or a Film")
    return FilmSail(device, film, strength)


@dataclass(frozen=True)
class DirectFlight:
    """The fastest flight that the direct method found. NaN, feasible False and a reason where it found none.

    time s; departure s after the epoch, where the question has dates; revolutions about the Sun; costates of the
    start's state in the question's axes, minus the change of the flight time with it, canonical: estimates; table : the
    attitudes; arcs : parts of full, no and partial throttle; miss : the largest of the end's conditions that the
    table's flight by the ordinary propagator leaves, canonical; error s, what that is worth in flight time; closest m;
    solutions : distinct flight times (k,) s; guesses tried, and of them converged; ending : how the search ended, and
    what it tried; epoch : UTC, of a question with dates.
    """

    device: Film | str
    characteristic_acceleration: float
    limits: Limits
    time: float
    departure: float
    revolutions: float
    costates: np.ndarray
    table: SteeringTable | None
    arcs: tuple[Arc, ...]
    miss: float
    error: float
    closest: float
    solutions: np.ndarray
    guesses: int
    converged: int
    ending: Ending
    feasible: bool
    reason: str = ""
    flown: Confirmed | None = None
    nodes: Nodes | None = None
    question: Question | None = None
    epoch: np.datetime64 | None = None

    @property
    def leaves(self) -> np.datetime64:
        """The date of departure, UTC; ValueError where the question has none."""
        if self.epoch is None:
            raise ValueError("the flight has no date")
        return self.epoch + np.timedelta64(round(self.departure * 1e9), "ns")

    @property
    def arrives(self) -> np.datetime64:
        """The date of arrival, UTC; ValueError where the question has none."""
        return self.leaves + np.timedelta64(round(self.time * 1e9), "ns")

    @property
    def position(self) -> np.ndarray:
        """(3,) m at departure."""
        assert self.table is not None, "only a flight has a place"
        return self.table.position

    @property
    def velocity(self) -> np.ndarray:
        """(3,) m/s at departure."""
        assert self.table is not None, "only a flight has a place"
        return self.table.velocity

    @property
    def days(self) -> str:
        """The flight time in days with as many digits as its flight by the ordinary propagator confirms."""
        return f"{round(float(self.time / DAY), self.digits):.{max(self.digits, 0)}f}"

    @property
    def digits(self) -> int:
        """Decimals of the flight time in days that are confirmed, negative where whole days are not."""
        if not np.isfinite(self.error):
            return 0
        return int(np.clip(np.floor(-np.log10(max(self.error / DAY, 1e-12))), -3, 6))

    @property
    def claim(self) -> str:
        """What is known of the flight time, in one sentence."""
        if not self.feasible:
            return self.reason
        others = "the only solution" if len(self.solutions) == 1 else f"the fastest of {len(self.solutions)} solutions"
        stopped = ", stopped before all were tried" if self.ending.stopped else ""
        return (
            f"Best found by the direct method: {self.days} d, {others} that {self.guesses} guesses led to "
            f"({self.converged} converged{stopped}); that none is faster is likely, not proven."
        )


def fastest(
    question: Question,
    guesses: Iterable[Guess],
    characteristic_acceleration: float,
    *,
    sharpen: bool = True,
    effort: Effort | None = None,
    progress: Progress | None = None,
    time_limit: float | None = None,
) -> DirectFlight:
    """The fastest flight that the guesses lead to. sharpen : once more on a finer mesh, or on meshes at the switches of
    a throttle. effort, progress, time_limit : as of every search; the best so far is the answer where it was stopped.
    NoCasadiError without the extra."""
    effort = Effort.of(effort, progress, time_limit)
    transcription = transcribe(question)
    found: list[ipopt.Solved] = []
    ends: list[str] = []
    listed = list(guesses)
    for i, guess in enumerate(listed):
        if effort.stopped:
            break
        effort.count("guesses of the direct method")
        share = i / (len(listed) + 1)
        solved = ipopt.solve(transcription, guess, effort=effort, words=f"direct method, {guess.words}", share=share)
        ends.append(solved.status)
        if solved.converged or (solved.stopped and solved.flies and not found):
            found.append(solved)
    if not found:
        why = {"": f"IPOPT ended with {', '.join(sorted(set(ends)))}", INTERRUPTED: "it was interrupted"}.get(
            effort.stopped, "the time limit came first"
        )
        return no_flight(question, characteristic_acceleration, f"the direct method found no flight: {why}", effort)
    found.sort(key=lambda one: one.span)
    best, at = found[0], transcription
    if sharpen and not effort.stopped and not question.turns:
        again = _sharpened if question.sail.throttles else _finer
        best, at = again(question, best, transcription, effort)
    spans = [one.span for one in found]
    distinct = [x for i, x in enumerate(spans) if i == 0 or x > spans[i - 1] * (1 + SAME)]
    return _answer(
        at, best, characteristic_acceleration, np.array(distinct) * TIME_UNIT, (len(ends), len(found)), effort
    )


def _sharpened(
    q: Question, coarse: ipopt.Solved, transcription: Transcription, effort: Effort
) -> tuple[ipopt.Solved, Transcription]:
    """The flight with its switches between intervals, their times unknowns; the coarse one where that leads nowhere."""
    best, at, latest = coarse, transcription, coarse
    for _ in range(REFINEMENTS):
        arcs = arcs_of(latest.nodes.times[1:], latest.nodes.throttles, q.intervals)
        if at.question.arcs and _kinds(arcs) == _kinds(at.question.arcs):
            break
        finer = replace(q, arcs=arcs)
        following = transcribe(finer)
        latest = ipopt.solve(
            following, guess_on(finer, latest.nodes), effort=effort, words="direct method, on the switches", share=0.9
        )
        if not latest.flies or latest.stopped or abs(latest.span / coarse.span - 1) > SLOWER:
            break
        if latest.converged:
            best, at = latest, following
    return best, at


def _finer(
    q: Question, coarse: ipopt.Solved, transcription: Transcription, effort: Effort
) -> tuple[ipopt.Solved, Transcription]:
    """The flight on twice as many intervals; the coarse one where that leads nowhere."""
    finer = replace(q, intervals=2 * q.intervals)
    following = transcribe(finer)
    guess = guess_on(finer, coarse.nodes)
    solved = ipopt.solve(following, guess, effort=effort, words="direct method, on a finer mesh", share=0.9, warm=True)
    if not solved.converged or abs(solved.span / coarse.span - 1) > SLOWER:
        return coarse, transcription
    return solved, following


def _kinds(arcs: tuple[Arc, ...]) -> list[str]:
    return [arc.kind for arc in arcs]


def _answer(
    at: Transcription,
    best: ipopt.Solved,
    characteristic_acceleration: float,
    spans: np.ndarray,
    counts: tuple[int, int],
    effort: Effort,
) -> DirectFlight:
    q, nodes = at.question, best.nodes
    table = table_of(q, nodes)
    flown = confirm(at, nodes, table, characteristic_acceleration)
    if not flown.miss < FLIES:
        reason = (
            f"the direct method's flight of {best.span * TIME_UNIT / DAY:.1f} d is none: its attitudes, flown, miss "
            f"the end by {flown.miss:.1e}"
        )
        return no_flight(q, characteristic_acceleration, reason, effort)
    place = flown.position
    cross = np.linalg.norm(np.cross(place[:-1], place[1:]), axis=1)
    swept = float(np.sum(np.arctan2(cross, np.sum(place[:-1] * place[1:], axis=1))))
    return DirectFlight(
        device=q.sail.device,
        characteristic_acceleration=characteristic_acceleration,
        limits=q.limits,
        time=best.span * TIME_UNIT,
        departure=float(nodes.start[0] * TIME_UNIT) if len(nodes.start) == 2 else 0.0,
        revolutions=swept / (2 * np.pi),
        costates=nodes.costates,
        table=table,
        arcs=q.arcs and tuple(a._replace(duration=d) for a, d in zip(q.arcs, _durations(q, nodes), strict=True)),
        miss=flown.miss,
        error=flown.error,
        closest=float(np.linalg.norm(place, axis=1).min()),
        solutions=spans,
        guesses=counts[0],
        converged=counts[1],
        ending=effort.found(),
        feasible=True,
        flown=flown,
        nodes=nodes,
        question=q,
    )


def _durations(q: Question, nodes: Nodes) -> list[float]:
    """Of the arcs, canonical."""
    bounds = np.cumsum([0, *q.lengths]) * ((len(nodes.times) - 1) // sum(q.lengths))
    return np.diff(nodes.times[bounds]).tolist()


def no_flight(q: Question, characteristic_acceleration: float, reason: str, effort: Effort) -> DirectFlight:
    """The result where no flight was found, and why."""
    nothing = np.array([])
    return DirectFlight(
        q.sail.device, characteristic_acceleration, q.limits, np.nan, np.nan, np.nan, nothing, None, (), np.nan, np.nan,
        np.nan, nothing, 0, 0, effort.not_found(), False, reason,
    )  # fmt: skip
