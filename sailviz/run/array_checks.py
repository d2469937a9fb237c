"""Whether arrays from elsewhere make a trajectory: everything that is wrong with them, said at once."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from datetime import date, datetime
from typing import TYPE_CHECKING, Any, TypeGuard, TypeVar

import numpy as np

from sailviz.calendar import DateError
from sailviz.constants import MU_EARTH, MU_SUN, RADIUS_EARTH, RADIUS_SUN
from sailviz.errors import RecordingError
from sailviz.run import dates, resample, unit_guard
from sailviz.run import gaps as spans
from sailviz.run.arrays import Body, Event, Reference
from sailviz.run.devices import LABELS
from sailviz.words import shortened

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    Epoch = np.datetime64 | datetime | date | str  # UTC
    Curves = Mapping[str, ArrayLike] | Iterable[Reference | tuple[str, ArrayLike]]
    Events = Iterable[Event | tuple[str, float]]
    Missing = Iterable[tuple[Any, Any]]  # times, or dates, at which data ends and begins again

N = TypeVar("N", Event, Reference)
NOTHING = np.zeros(0)
BODIES = {"Sun": Body("Sun", MU_SUN, RADIUS_SUN), "Earth": Body("Earth", MU_EARTH, RADIUS_EARTH)}
INSIDE = 0.9  # of the body's radius: what lies deeper is rather in the wrong unit than in the ground
UNIT_LENGTH = 1e-2  # by which the length of a quaternion may be off 1
ONE_PLACE = 1e-6  # of the distance: two rows of one time closer than this are one place, where the velocity jumps


class TrajectoryError(RecordingError, ValueError):
    """Arrays that make no trajectory. `faults` lists everything that is wrong with them."""

    def __init__(self, faults: list[str]) -> None:
        self.faults = tuple(faults)
        count = "1 fault" if len(faults) == 1 else f"{len(faults)} faults"
        super().__init__("\n".join([f"trajectory: {count}", *(f"  {fault}" for fault in faults)]))


def is_number(value: object) -> TypeGuard[float]:
    """Whether a value is a real number, and no truth value."""
    return isinstance(value, int | float | np.integer | np.floating) and not isinstance(value, bool)


def brief(value: object) -> str:
    """A value as Python writes it, as long as a message bears it."""
    return shortened(repr(value))


def _edges(pair: object, epoch: np.datetime64 | None) -> object:
    """The two times of a gap; dates as text or datetimes become datetime64 where the run has an epoch."""
    edges = list(pair) if isinstance(pair, Iterable) and not isinstance(pair, str | bytes) else [pair]
    if epoch is not None and all(isinstance(edge, str | date | np.datetime64) for edge in edges):
        return np.array([dates.epoch_of(edge) for edge in edges], "datetime64[ns]")
    return np.array(edges)


def _gap_fault(start: float, end: float, time: np.ndarray) -> str:
    """What keeps a span from being one without data, in words; "" for nothing."""
    if not start < end:
        return "does not end after its start"
    if not time[0] <= start < end <= time[-1]:
        return f"is not within the run, {time[0]:.6g} to {time[-1]:.6g} s"
    rows = int(np.count_nonzero((time > start) & (time < end)))
    return f"has {rows} row{'s' if rows > 1 else ''} in it" if rows else ""


class ArrayChecks:
    """Gathers everything that is wrong with the arguments. What comes back beside a fault is not for use."""

    def __init__(self) -> None:
        self._faults: list[str] = []
        self._given: np.ndarray | None = None  # numbers of the rows that hold data, where some do not

    @property
    def good(self) -> bool:
        return not self._faults

    def say(self, fault: str) -> None:
        self._faults.append(fault)

    def refuse(self, fault: str) -> np.ndarray:
        """Nothing, for the argument at fault."""
        self.say(fault)
        return NOTHING

    def finish(self) -> None:
        if self._faults:
            raise TrajectoryError(self._faults)

    def with_data(self, position: ArrayLike, velocity: ArrayLike) -> np.ndarray | None:
        """Numbers of the rows that hold data, None where all do: a row whose position and velocity are all NaN does
        not."""
        try:
            states = [dates.numbers(given) for given in (position, velocity)]
        except DateError:
            return None  # what is wrong with them is said elsewhere
        if any(state.ndim != 2 or state.shape != states[0].shape for state in states):
            return None
        lost = np.all(np.isnan(np.hstack(states)), axis=1)
        if not lost.any() or lost.all():
            return None
        self._given = np.flatnonzero(~lost)
        return self._given

    def row(self, index: int) -> int:
        """The number of a row as it was given."""
        return int(index) if self._given is None else int(self._given[index])

    def array(self, name: str, values: ArrayLike, wanted: str) -> np.ndarray:
        """float64 and finite, a copy of its own."""
        try:
            found = dates.numbers(values)
        except DateError as error:
            return self.refuse(f"{name}: {str(error).removeprefix('is ')}, wanted {wanted}")
        if found.size == 0:
            return self.refuse(f"{name}: has no values, wanted {wanted}")
        if name == "time" and found.ndim != 1:
            return self.refuse(f"{name}: shape {found.shape}, wanted {wanted}")
        if not np.isfinite(found).all():
            index = np.argwhere(~np.isfinite(found))[0]
            row = f"row {self.row(index[0]) if self._by_row(found) else index[0]} " if len(index) else ""
            self.say(f"{name}: {row}is not a number ({found[tuple(index)]})")
        return found

    def _by_row(self, values: np.ndarray) -> bool:
        return self._given is not None and len(values) == len(self._given)

    def times(self, values: object, epoch: np.datetime64 | None) -> tuple[np.ndarray, np.datetime64 | None]:
        """(times (n,) s, epoch): numbers, spans of any unit, or dates, which bring an epoch along."""
        try:
            found, epoch = dates.seconds_of(values, epoch)
        except DateError as error:
            return self.refuse(f"time: {str(error).removeprefix('is ')}, wanted (n,)"), epoch
        found = self.array("time", found, "(n,)")
        if found is NOTHING or not np.isfinite(found).all():
            return found, epoch
        down = np.flatnonzero(np.diff(found) < 0)
        if len(down):
            i = int(down[0])
            before, after = self.row(i), self.row(i + 1)
            self.say(f"time: goes back from row {before} ({found[i]:.10g}) to row {after} ({found[i + 1]:.10g})")
        return found, epoch

    def reach(self, time: np.ndarray, epoch: np.datetime64 | None) -> None:
        """Whether a recording's clock reaches that far."""
        try:
            dates.span_in_reach(float(time.min()), float(time.max()), epoch)
        except DateError as error:
            self.say(f"time: {error}")

    def order(self, time: np.ndarray, position: np.ndarray) -> None:
        """Rows of one time must be one place: there the velocity jumps."""
        pairs = np.flatnonzero(np.diff(time) == 0)
        off = np.linalg.norm(position[pairs + 1] - position[pairs], axis=1)
        apart = np.flatnonzero(off > ONE_PLACE * np.linalg.norm(position[pairs], axis=1))
        if len(apart):
            row, gap = int(pairs[apart[0]]), off[apart[0]]
            self.say(
                f"time: does not increase from row {self.row(row)} to row {self.row(row + 1)} "
                f"(both {time[row]:.10g}), and they are "
                f"{gap:.4g} m apart: a jump of the velocity has one place"
            )

    def vectors(self, name: str, values: ArrayLike, rows: int | None) -> np.ndarray:
        """(n, 3) for n rows, or for any number."""
        wanted = f"({rows if rows is not None else 'n'}, 3)"
        found = self.array(name, values, wanted)
        if found is NOTHING:
            return NOTHING
        if found.ndim != 2 or found.shape[1] != 3 or (rows is not None and len(found) != rows):
            turned = ": transpose it" if found.ndim == 2 and found.T.shape == (rows, 3) else ""
            return self.refuse(f"{name}: shape {found.shape}, wanted {wanted}{turned}")
        return found

    def mass(self, values: ArrayLike | None, rows: int | None) -> np.ndarray:
        """(n,) kg from a number or a column; NaN from nothing."""
        if values is None:
            return np.full(rows or 1, np.nan)
        if np.asarray(values).dtype.kind == "b":
            return self.refuse(f"mass: {np.asarray(values).flat[0]} is a truth value, wanted a number or (n,)")
        found = self.array("mass", values, "a number or (n,)")
        if found is NOTHING or not np.isfinite(found).all():
            return NOTHING
        if found.ndim > 1 or (found.ndim == 1 and len(found) != rows):
            return self.refuse(f"mass: shape {found.shape}, wanted a number or ({rows},)")
        if (found <= 0).any():
            return self.refuse("mass: must be positive")
        return np.broadcast_to(found, rows or 1).copy()

    def body(self, name: str | None, mu: float, radius: float | None) -> Body:
        """The central body, by its name or by its mu."""
        if not is_number(mu) or not 0 < mu < np.inf:
            self.say(f"mu: must be a positive number in m3/s2, not {brief(mu)}")
            return BODIES["Sun"]
        if name is not None and not isinstance(name, str):
            self.say(f"body: must be a name, not {brief(name)}")
            return BODIES["Sun"]
        near = next((known for known in BODIES.values() if abs(mu / known.mu - 1) < 1e-3), None)
        if name in BODIES and near is not BODIES[name]:
            self.say(f"body: {name} does not go with mu = {mu:.6g} m3/s2; its own is {BODIES[name].mu:.9g}")
        if radius is not None and (not is_number(radius) or not 0 <= radius < np.inf):
            self.say(f"radius: must be a number of metres, not {brief(radius)}")
            return BODIES["Sun"]
        known = near if name is None else BODIES.get(name)
        default = known.radius if known else 0.0
        name = name or (known.name if known else "body")
        return Body(str(name), float(mu), float(default if radius is None else radius))

    def epoch(self, value: Epoch | None) -> np.datetime64 | None:
        """UTC to the nanosecond."""
        try:
            return dates.epoch_of(value)
        except DateError as error:
            self.say(f"epoch: {error}")
            return None

    def environment(self, columns: Mapping[str, ArrayLike], rows: int | None) -> dict[str, np.ndarray]:
        """(n,) or (n, 3) columns by their names; truth values stay such."""
        found: dict[str, np.ndarray] = {}
        if not isinstance(columns, Mapping):
            self.say(f"environment: wanted a mapping of names to columns, not {brief(columns)}")
            return found
        for name, values in columns.items():
            if not isinstance(name, str) or not name:
                self.say(f"environment: a column's name is text, not {brief(name)}")
                continue
            wanted = f"({rows},) or ({rows}, 3)"
            column = self.array(f"environment[{name!r}]", values, wanted)
            if column is not NOTHING and column.shape not in ((rows,), (rows, 3)):
                self.say(f"environment[{name!r}]: shape {column.shape}, wanted {wanted}")
            yes_or_no = column is not NOTHING and np.asarray(values).dtype == bool
            found[name] = column.astype(bool) if yes_or_no else column
        return found

    def references(self, curves: Curves) -> tuple[Reference, ...]:
        """Curves (k, 3) m with their names."""
        found = []
        for item in self.items("references", curves, Reference):
            name, given = (item.name, item.points) if isinstance(item, Reference) else item
            points = self.array(f"references[{name!r}]", given, "(k, 3)")
            if points is not NOTHING and (points.ndim != 2 or points.shape[1] != 3):
                self.say(f"references[{name!r}]: shape {points.shape}, wanted (k, 3)")
            found.append(Reference(name, item.role if isinstance(item, Reference) else "target", points))
        return tuple(found)

    def items(self, argument: str, given: object, kind: type[N]) -> Iterator[N | tuple[str, Any]]:
        """Things of a kind, or pairs of a name and what it names; whatever else there is is said."""
        if not isinstance(given, Iterable) or isinstance(given, str | bytes):
            self.say(f"{argument}: wanted pairs of a name and its values, not {brief(given)}")
            return
        for i, item in enumerate(given.items() if isinstance(given, Mapping) else given):
            if isinstance(item, kind):
                yield item
            elif isinstance(item, tuple | list) and len(item) == 2 and isinstance(item[0], str):
                yield item[0], item[1]
            else:
                self.say(f"{argument}: number {i}, {brief(item)}, is no pair of a name and its values")

    def events(
        self,
        events: Events,
        time: np.ndarray,
        position: np.ndarray,
        velocity: np.ndarray,
        mass: np.ndarray,
        gaps: spans.Gaps = (),
    ) -> tuple[Event, ...]:
        """Events with states, those between the rows read off a cubic, and the mass off a line; not within gaps."""
        found = []
        for item in self.items("events", events, Event):
            name, when = (item.name, item.time) if isinstance(item, Event) else item
            if not is_number(when):
                self.say(f"events: {name!r} is at a time in s, not at {brief(when)}")
                continue
            if not time[0] <= when <= time[-1]:
                self.say(f"events: {name!r} at {when!r} s is outside the run, {time[0]:.6g} to {time[-1]:.6g} s")
                continue
            if not isinstance(item, Event) and spans.inside(np.array([float(when)]), gaps).any():
                self.say(f"events: {name!r} at {when!r} s lies where there is no data: give an Event with its state")
                continue
            if isinstance(item, Event):
                if np.shape(item.state) != (7,):
                    self.say(f"events[{name!r}].state: shape {np.shape(item.state)}, wanted (7,)")
                else:
                    self.array(f"events[{name!r}].state", item.state[:6], "(7,)")  # the mass may be unknown
                found.append(item)
                continue
            state = {"position_m": position, "velocity_m_s": velocity}
            at = np.array([float(when)])
            now = [resample.at(at, column, time, values, state, gaps)[0] for column, values in state.items()]
            found.append(Event(name, float(when), np.append(np.concatenate(now), np.interp(when, time, mass))))
        return tuple(sorted(found, key=lambda event: event.time))

    def device(self, word: object) -> str:
        """A device's word."""
        if not isinstance(word, str) or word not in LABELS:
            self.say(f"device: {brief(word)} is not one of {', '.join(LABELS)}")
            return "none"
        return word

    def size(self, name: str, value: object, whole: bool = False) -> None:
        """A length or a count of the craft, if it is given."""
        if value is None:
            return
        if not is_number(value) or not 0 < value < np.inf or (whole and value != int(value)):
            self.say(f"{name}: must be a {'whole ' if whole else ''}number above 0, not {brief(value)}")

    def lines(self, name: str, values: object) -> tuple[str, ...]:
        """Lines of text; one line may stand alone."""
        if isinstance(values, str):
            return (values,)
        if not isinstance(values, Iterable):
            self.say(f"{name}: wanted lines of text, not {brief(values)}")
            return ()
        return tuple(map(str, values))

    def attitude(self, values: ArrayLike, scalar: str | None, direction: str | None, rows: int | None) -> np.ndarray:
        """Quaternions (n, 4) x y z w from body to world, of length 1, each of the sign nearer to the one before."""
        if scalar not in ("first", "last"):
            self.say('scalar: say where the scalar of a quaternion stands, "first" or "last"')
        if direction not in ("body_to_world", "world_to_body"):
            self.say('direction: say what a quaternion turns, "body_to_world" or "world_to_body"')
        wanted = f"({rows if rows is not None else 'n'}, 4)"
        found = self.array("attitude", values, wanted)
        if found is NOTHING:
            return NOTHING
        if found.ndim != 2 or found.shape[1] != 4 or (rows is not None and len(found) != rows):
            return self.refuse(f"attitude: shape {found.shape}, wanted {wanted}")
        length = np.linalg.norm(found, axis=1)
        off = np.flatnonzero(~(np.abs(length - 1.0) <= UNIT_LENGTH))
        if len(off):
            return self.refuse(f"attitude: row {self.row(off[0])} has the length {length[off[0]]:.6g}, and 1 is due")
        found = found / length[:, None]
        found = np.roll(found, -1, axis=1) if scalar == "first" else found
        found = found * [-1.0, -1.0, -1.0, 1.0] if direction == "world_to_body" else found
        turned = np.cumsum(np.sum(found[1:] * found[:-1], axis=1) < 0) % 2 == 1
        return np.asarray(np.where(np.concatenate([[False], turned])[:, None], -found, found))

    def no_zeros(self, name: str, vectors: np.ndarray) -> None:
        zero = np.flatnonzero(np.linalg.norm(vectors, axis=1) == 0)
        if len(zero):
            self.say(f"{name}: row {self.row(zero[0])} is the zero vector")

    def stowed(self, normal: np.ndarray, thrust: np.ndarray) -> None:
        """A zero normal is a stowed sail, which pushes nothing."""
        pushing = np.flatnonzero(~normal.any(axis=1) & thrust.any(axis=1))
        if len(pushing):
            self.say(f"thrust: row {self.row(pushing[0])} has a push, but a sail without a normal there is stowed")

    def gaps(self, given: Missing, time: np.ndarray, epoch: np.datetime64 | None) -> tuple[tuple[float, float], ...]:
        """Spans without data, s: those given, between rows, and those that rows without data have left."""
        found: list[tuple[float, float]] = []
        if self._given is not None:
            lost = np.flatnonzero(np.diff(self._given) > 1)
            found += [(float(time[row]), float(time[row + 1])) for row in lost]
        if not isinstance(given, Iterable) or isinstance(given, str | bytes | Mapping):
            self.say(f"gaps: wanted pairs of a start and an end, not {brief(given)}")
            return ()
        for i, pair in enumerate(given):
            try:
                edges, _ = dates.seconds_of(_edges(pair, epoch), epoch)
                start, end = edges.tolist()
            except (DateError, TypeError, ValueError):
                self.say(f"gaps: number {i}, {brief(pair)}, is no pair of times")
                continue
            fault = _gap_fault(start, end, time)
            if fault:
                self.say(f"gaps: number {i}, {start:.10g} to {end:.10g} s, {fault}")
            else:
                found.append((start, end))
        return spans.joined(found)

    def units(self, time: np.ndarray, position: np.ndarray, velocity: np.ndarray, body: Body) -> str:
        """Whether the rows are in SI -> what is strange about them though it may be so, "" for nothing."""
        wrong, strange = unit_guard.fault(time, position, velocity, body.mu)
        if wrong:
            self.say(wrong)
            return ""
        distance = np.linalg.norm(position, axis=1)
        row = int(np.argmin(distance))
        if distance[row] == 0:
            self.say(f"position: row {self.row(row)} is the centre of the {body.name}")
        elif distance[row] < INSIDE * body.radius:
            self.say(
                f"position: row {self.row(row)} lies {distance[row]:.4g} m from the centre of the {body.name}, "
                f"whose radius is {body.radius:.4g} m; are these kilometres?"
            )
        return strange
